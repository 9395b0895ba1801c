//! States to the bit: the same in every profile, and by a file or by code.

use std::path::PathBuf;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_scene::load_scene;
use cranny_world::description::{JointDescription, Normals, SceneDescription};

/// State hashes of scenes of `assets/` after so many seconds, and of which meshes. A change of what
/// is computed replaces them; `cranny run SCENE --duration SECONDS --format json` of a release
/// build says the same.
const HASHES: [(&str, f64, u64, &str); 5] = [
    (
        "robot_arm",
        0.25,
        0x5398_3151_f7f8_9e6e,
        "f97a641fb33bd7fa6edd08fda1b8736f9a0896b53e3d4f3fd61af08099a3a314",
    ),
    (
        "mixed_pile",
        0.1,
        0x994c_00b4_5c9f_53e5,
        "607c425a06a386e14c2ee9a2200f3cec4ff43419803216cdb17df85b12083f4b",
    ),
    (
        "stack_of_cups",
        0.25,
        0x6156_fa8e_5ebe_e8f0,
        "7ba72b95297ea5d9820bd590ff2d4b6f9a1a22f439279cc3179a5f59769911d6",
    ),
    (
        "nut_under_gravity_smooth",
        0.1,
        0xb656_682d_1e75_6550,
        "599778b6e014733864394a8a81602625388a4545f883c62163e6d57e6acd5d3d",
    ),
    (
        "budgeted_triggers",
        0.5,
        0x1c30_fc69_5017_6568,
        "00f40a0fd3461149f72b6bb1895b11d265732e4d665ca85ace10397f1c50f081",
    ),
];

/// A number for the meshes of a scene.
fn meshes(scene: &SceneDescription) -> u64 {
    let vertices = scene.bodies.iter().flat_map(|body| body.collision.vertices());
    number(vertices.flat_map(|p| p.to_array()))
}

/// [`sines`] where the states were stored.
const SINES: u64 = 0xe1cb_0be3_25ad_5315;

/// A number for the sines and cosines of the platform, of which generators make their meshes:
/// another platform may round them otherwise, and then states differ.
fn sines() -> u64 {
    let angles = (1..4096).map(|k| std::f64::consts::TAU * f64::from(k) / 4096.0);
    number(angles.flat_map(|angle| <[f64; 2]>::from(angle.sin_cos())))
}

fn number(values: impl Iterator<Item = f64>) -> u64 {
    values.map(f64::to_bits).fold(0xcbf2_9ce4_8422_2325, |hash: u64, bits| {
        (hash ^ bits).wrapping_mul(0x100_0000_01b3).rotate_left(17)
    })
}

fn scene(name: &str) -> SceneDescription {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let loaded = load_scene(&folder.join(format!("{name}.ron")));
    loaded.unwrap_or_else(|error| panic!("{error}")).description
}

#[expect(clippy::print_stderr, reason = "a skipped test says so")]
fn say_skipped(name: &str) {
    eprintln!("skipped {name}: this platform rounds sines otherwise ({:#x})", sines());
}

#[test]
fn scenes_end_in_the_stored_states_in_every_profile() {
    let mut wrong = Vec::new();
    for (name, seconds, of_meshes, stored) in HASHES {
        let scene = scene(name);
        let found = meshes(&scene);
        if sines() != SINES {
            say_skipped(name);
            continue;
        }
        let options = RunOptions { duration: Some(seconds), ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &options).unwrap();
        while app.step().unwrap() {}
        let hash = app.finish().unwrap().state_hash;
        if (found, &*hash) != (of_meshes, stored) {
            wrong.push(format!("({name:?}, {seconds:?}, {found:#x}, {hash:?}),"));
        }
    }
    assert!(wrong.is_empty(), "other states:\n{}", wrong.join("\n"));
}

fn vec3(v: DVec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// Spawns by components what a file described, as an app would that builds it by code.
fn spawn(world: &mut World, scene: &SceneDescription) {
    let mut bodies = Vec::new();
    for body in &scene.bodies {
        let collider = match &body.shape {
            Some(shape) => Collider::from(shape.clone()),
            None => Collider::from_mesh((*body.collision).clone()).unwrap(),
        };
        let mut entity = world.spawn((
            RigidBody::from(body.kind),
            collider,
            transform_of(&body.pose),
            LinearVelocity(vec3(body.linear_velocity)),
            AngularVelocity(vec3(body.angular_velocity)),
            Friction::new(body.material.friction as f32),
            Restitution::new(body.material.restitution as f32),
            Density(body.material.density),
        ));
        if let Some(mass) = body.mass {
            entity.insert(Mass(mass));
        }
        if let Normals::Smooth { crease_angle } = body.normals {
            entity.insert(SmoothNormals { crease_angle });
        }
        assert!(body.effects.is_empty() && body.path.is_none() && !body.sensor, "{}", body.name);
        bodies.push(entity.id());
    }
    let joints: Vec<Entity> = scene.joints.iter().map(|_| world.spawn_empty().id()).collect();
    let number = |name: &str| scene.joints.iter().position(|joint| joint.name == name).unwrap();
    for (joint, &entity) in scene.joints.iter().zip(&joints) {
        let JointDescription { parent_anchor, child_anchor, motor, resistance, .. } = *joint;
        let follows = joint.mimic.as_ref().map(|mimic| Follows {
            joint: joints[number(&mimic.joint)],
            multiplier: mimic.multiplier,
            offset: mimic.offset,
        });
        world.entity_mut(entity).insert(Joint {
            parent_anchor,
            child_anchor,
            kind: joint.kind,
            motor,
            resistance,
            follows,
            reduced: joint.reduced,
            start: joint.start,
            ..Joint::fixed(bodies[joint.parent], bodies[joint.child])
        });
    }
    for &(a, b) in &scene.excluded_pairs {
        world.spawn((NeverMeet, BodyPair { a: bodies[a], b: bodies[b] }));
    }
}

#[test]
fn a_robot_and_a_pile_end_in_the_same_state_by_file_and_by_code() {
    const STEPS: usize = 40;
    for name in ["robot_arm", "mixed_pile", "stack_of_cups"] {
        let scene = scene(name);
        let length_unit = Some(0.01);
        let plugins = PluginOptions { length_unit, ..PluginOptions::default() };
        let options = RunOptions { plugins: plugins.clone(), ..RunOptions::default() };
        let mut by_file = SceneApp::new(&scene, &options).unwrap();
        let start = state_hash(by_file.app().world());
        let mut by_code = App::empty();
        let added = CrannyPlugins::new(scene.step).unwrap().options(&plugins);
        by_code.add_plugins(added.gravity(scene.gravity).effects(&scene.effects).unwrap());
        let world = by_code.world_mut();
        spawn(world, &scene);
        for _ in 0..STEPS {
            assert!(by_file.step().unwrap());
            world.run_schedule(CrannyStep);
        }
        assert!(!world.resource::<Failure>().is_set());
        let ends = [by_file.app().world(), &*world].map(state_hash);
        assert_eq!(ends[0], ends[1], "{name}");
        assert_ne!(ends[0], start, "{name} moves");
    }
}
