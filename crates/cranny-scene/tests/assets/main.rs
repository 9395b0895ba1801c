//! The committed assets are what their generators make, and the scenes are what they claim to be.
//!
//! `CRANNY_BLESS=1 cargo test -p cranny-scene --test assets` writes them anew.

mod arm;
mod cell;
mod crowds;
mod generated;
mod house;
mod meeting;
mod physical;
mod vehicles;
mod walks;
mod worlds;

use std::fs;
use std::path::PathBuf;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_scene::{LoadedScene, MeshFormat, decode_mesh, load_scene, read_robot};
use cranny_world::description::{BodyKind, Effect, JointDescription, SceneDescription};

fn assets() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

fn scene(name: &str) -> LoadedScene {
    load_scene(&assets().join("scenes").join(name)).unwrap()
}

/// Sine and cosine may differ in the last bits between platforms; nothing else may.
fn same_mesh(a: &Mesh, b: &Mesh) -> bool {
    let near = |(p, q): (&DVec3, &DVec3)| p.distance(*q) <= 1e-12;
    a.faces() == b.faces()
        && a.vertices().len() == b.vertices().len()
        && a.vertices().iter().zip(b.vertices()).all(near)
}

#[test]
fn committed_assets_are_what_the_generators_make() {
    let bless = std::env::var_os("CRANNY_BLESS").is_some();
    let files = generated::files();
    assert!(files.len() >= 12);
    for (name, content) in files {
        let path = assets().join(&name);
        if bless {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, &content).unwrap();
        }
        let committed = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
        if name.ends_with(".obj") {
            let read = |text: &str| decode_mesh(text.as_bytes(), MeshFormat::Obj).unwrap().mesh;
            assert!(same_mesh(&read(&committed), &read(&content)), "{name} differs");
        } else {
            assert_eq!(committed, content, "{name} differs");
        }
    }
}

fn names(scene: &SceneDescription) -> Vec<&str> {
    scene.bodies.iter().map(|body| body.name.as_str()).collect()
}

/// No two bodies that may meet do so at the start.
fn assert_apart(scene: &SceneDescription) {
    for b in 0..scene.bodies.len() {
        for a in 0..b {
            let (p, q) = (&scene.bodies[a], &scene.bodies[b]);
            let move_at_all = p.kind != BodyKind::Fixed || q.kind != BodyKind::Fixed;
            if move_at_all && !scene.excluded_pairs.contains(&(a, b)) {
                let meets =
                    meeting::surfaces_meet((&p.collision, &p.pose), (&q.collision, &q.pose));
                assert!(!meets, "{} meets {}", p.name, q.name);
            }
        }
    }
}

#[test]
fn the_ring_is_closed_linked_and_apart() {
    let loaded = scene("ring_of_tori.ron");
    let scene = &loaded.description;
    let expected: Vec<String> = (0..12).map(|i| format!("torus_{i}")).collect();
    assert_eq!(names(scene), expected);
    assert_eq!(scene.effects, [Effect::Response, Effect::Contacts { margin: 0.01 }]);
    assert_eq!((scene.duration, scene.gravity), (5.0, DVec3::new(0.0, 0.0, -9.81)));
    assert!((scene.step - 1.0 / 240.0).abs() < 1e-15);
    for (i, body) in scene.bodies.iter().enumerate() {
        assert_eq!(body.collision.faces().len(), 2048);
        assert_eq!(body.kind == BodyKind::Fixed, i == 0);
    }
    // Distances of the tubes' core circles; meshes deviate from the tubes by less than 0.002.
    let cores: Vec<Vec<DVec3>> = scene.bodies.iter().map(|body| core(&body.pose)).collect();
    for i in 0..12 {
        for j in 0..i {
            let neighbours = i - j == 1 || i - j == 11;
            assert_eq!(crossings(&scene.bodies[i].pose, &cores[j]) % 2 == 1, neighbours, "{i} {j}");
            let gap = cores[i]
                .iter()
                .flat_map(|p| cores[j].iter().map(move |q| p.distance(*q)))
                .fold(f64::INFINITY, f64::min)
                - 0.4;
            assert!(gap > 0.1, "{i} {j}: {gap}");
        }
    }
}

/// Points of a torus's core circle, radius 1, 0.01 apart.
fn core(pose: &Pose) -> Vec<DVec3> {
    let at = |k: u32| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 720.0).sin_cos();
        pose.world_from_body().apply(DVec3::new(cos, sin, 0.0))
    };
    (0..720).map(at).collect()
}

/// How often a closed curve crosses the unit disc of a torus: odd where they are linked.
fn crossings(disc: &Pose, curve: &[DVec3]) -> usize {
    let body_from_world = disc.world_from_body().inverse();
    let local: Vec<DVec3> = curve.iter().map(|&p| body_from_world.apply(p)).collect();
    (0..local.len())
        .filter(|&k| {
            let (p, q) = (local[k], local[(k + 1) % local.len()]);
            let hit = p + (q - p) * (p.z / (p.z - q.z));
            (p.z < 0.0) != (q.z < 0.0) && hit.truncate().length() < 1.0
        })
        .count()
}

#[test]
fn the_nut_starts_free_on_its_bolt() {
    let loaded = scene("nut_on_bolt.ron");
    let scene = &loaded.description;
    assert_eq!(names(scene), ["bolt", "nut"]);
    let [bolt, nut] = [&scene.bodies[0], &scene.bodies[1]];
    assert_eq!((bolt.kind, nut.kind), (BodyKind::Fixed, BodyKind::Dynamic));
    assert!((nut.angular_velocity - DVec3::Z * std::f64::consts::TAU).length() < 1e-7);
    assert_eq!((bolt.material.friction, nut.material.friction), (0.0, 0.0));
    assert!(bolt.collision.faces().len() > 20_000 && nut.collision.faces().len() > 20_000);
    // The nut's axis is the bolt's, it surrounds the thread, and does not touch it.
    let (bolt_box, nut_box) = (bolt.collision.bounds(), nut.collision.bounds());
    assert!(nut.pose.translation.z + nut_box.min.z > 0.0);
    assert!(nut.pose.translation.z + nut_box.max.z < bolt_box.max.z);
    assert_apart(scene);
}

#[test]
fn the_piles_have_their_bodies_in_their_box() {
    for (file, count, half) in [("mixed_pile.ron", 500, 5.0), ("mixed_pile_50.ron", 50, 2.5)] {
        let loaded = scene(file);
        let scene = &loaded.description;
        let (walls, pieces) = scene.bodies.split_at(5);
        assert_eq!(pieces.len(), count, "{file}");
        assert!(walls.iter().all(|wall| wall.kind == BodyKind::Fixed));
        assert_eq!((pieces[0].name.as_str(), loaded.files.len()), ("piece_0", 2));
        let mut shapes: Vec<usize> = Vec::new();
        for piece in pieces {
            let faces = piece.collision.faces().len();
            assert!((396..=1536).contains(&faces), "{faces}");
            shapes.push(faces);
            let world = piece.pose.world_from_body();
            let inside = |p: DVec3| p.x.abs() < half && p.y.abs() < half && p.z > 0.0;
            assert!(piece.collision.vertices().iter().all(|&p| inside(world.apply(p))));
        }
        shapes.sort_unstable();
        shapes.dedup();
        assert_eq!(shapes.len(), 6, "six kinds of bodies");
        if count == 50 {
            assert_apart(scene);
        }
    }
}

#[test]
fn the_arm_has_six_axes_and_meets_the_mug() {
    let robot = read_robot(&assets().join("robots/arm/arm.urdf")).unwrap();
    assert_eq!(robot.notes, Vec::<String>::new());
    let free =
        robot.joints.iter().filter(|joint| joint.limits().is_some() && joint.mimic.is_none());
    assert_eq!(free.count(), 7, "six axes and a gripper");
    let loaded = scene("robot_arm.ron");
    let scene = &loaded.description;
    assert_apart(scene);
    let body = |name: &str| scene.bodies.iter().find(|body| body.name == name).unwrap();
    assert_eq!(body("arm/base").kind, BodyKind::Fixed);
    assert_eq!(body("arm/turret").kind, BodyKind::Dynamic);
    let upper = robot.links[robot.link("upper_arm").unwrap()].mass.unwrap();
    let described = body("arm/upper_arm");
    assert!((described.mass.unwrap().mass - upper).abs() < 1e-9);
    // On its way from where it starts to where its motors hold it, the gripper runs into the mug.
    let mug = body("mug");
    let meets_at = |fraction: f64| {
        let position = |joint: &JointDescription| {
            let name = joint.name.strip_prefix("arm/")?.to_owned();
            let target = joint.motor?.position?;
            let from = if name == "axis_1" { -0.4 } else { target };
            Some((name, from + fraction * (target - from)))
        };
        let positions = scene.joints.iter().filter_map(position).collect();
        let poses = robot.forward_kinematics(&positions).unwrap();
        robot.links.iter().zip(&poses).any(|(link, pose)| {
            let world = body("arm/base").pose.compose(pose);
            let mesh = link.collision.as_ref();
            mesh.is_some_and(|mesh| {
                meeting::surfaces_meet((mesh, &world), (&mug.collision, &mug.pose))
            })
        })
    };
    assert!(!meets_at(0.0) && !meets_at(1.0), "the mug is on the way, not at its ends");
    assert!((1..40).any(|k| meets_at(f64::from(k) / 40.0)), "the arm passes the mug by");
}
