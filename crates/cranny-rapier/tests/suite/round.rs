//! Cylinders, cones and segments, with a border radius and without: what they rest on, what they
//! roll over, and what is done about those that are stuck.

use cranny_exact::DVec3;
use cranny_rapier::{MeshShape, dispatcher};
use cranny_shapes::{Cup, Pyramid};
use rapier3d::geometry::ContactManifold;
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::query::PersistentQueryDispatcher;
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::RigidBodyBuilder;

use crate::world::{World, cuboid, model, ours, sheet, tessellated_slab, up};

/// What 'the right height' allows: rapier lets bodies overlap by 0.001 and holds them within its
/// prediction distance.
const NEAR: Real = 5e-3;

/// How far and by what angle a landing at 1 m/s may shift what rests: the solver takes contacts one
/// after the other. A square post of the height of the tall cylinder rocks as that one does.
const SHIFT: Real = 1e-2;
const TURN: Real = 3e-2;

/// y becomes z: parry's cylinders and cones are about y.
fn upright() -> Rotation {
    Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2 as Real)
}

fn turned(z: Real, rotation: Rotation) -> Pose {
    Pose::from_parts(Vector::new(0.0, 0.0, z), rotation)
}

/// Drops `upper` from 0.05 above `rest` on `lower`: it comes to rest there, upright as it began,
/// for either order of insertion, since rapier's order of a pair follows it.
#[track_caller]
fn rests(
    name: &str,
    lower: (&SharedShape, Pose),
    upper: &SharedShape,
    rest: Real,
    rotation: Rotation,
) {
    for upper_first in [false, true] {
        let mut world = World::new();
        let start = turned(rest + 0.05, rotation);
        let body = world.one_on_another(lower, (upper, start), upper_first);
        world.run(180);
        let early = world.at(body);
        world.run(90);
        let late = world.at(body);
        let what = format!("{name}, upper first: {upper_first}: {early} then {late}");
        assert!((late.z - rest).abs() < NEAR, "{what}: expected z = {rest}");
        assert!((late - early).length() < 0.1 * NEAR, "{what}: not at rest");
        assert!(late.truncate().length() < SHIFT, "{what}: drifted");
        let turn = world.0.bodies[body].rotation().angle_between(rotation);
        assert!(turn < TURN, "{what}: turned by {turn}");
        let body = &world.0.bodies[body];
        assert!(body.linvel().length() < NEAR, "{what}: moves by {}", body.linvel());
        assert!(body.angvel().length() < NEAR, "{what}: turns by {}", body.angvel());
    }
}

/// Shapes with how they are turned and how far their middle is above the floor.
fn uppers() -> Vec<(&'static str, SharedShape, Rotation, Real)> {
    let lying = Rotation::IDENTITY;
    vec![
        ("standing cylinder", SharedShape::cylinder(0.25, 0.4), upright(), 0.25),
        ("lying cylinder", SharedShape::cylinder(0.4, 0.2), lying, 0.2),
        ("tall cylinder", SharedShape::cylinder(0.5, 0.1), upright(), 0.5),
        ("coin", SharedShape::cylinder(0.02, 0.4), upright(), 0.02),
        ("standing cone", SharedShape::cone(0.25, 0.4), upright(), 0.25),
        ("standing round cylinder", SharedShape::round_cylinder(0.2, 0.4, 0.05), upright(), 0.25),
        ("lying round cylinder", SharedShape::round_cylinder(0.4, 0.15, 0.05), lying, 0.2),
        ("standing round cone", SharedShape::round_cone(0.2, 0.4, 0.05), upright(), 0.25),
        ("capsule", SharedShape::capsule_y(0.4, 0.2), lying, 0.2),
    ]
}

#[test]
fn they_rest_on_a_floor() {
    let slab = ours(&cuboid(4.0, 4.0, 1.0));
    let fine = ours(&tessellated_slab(20, 2.0));
    let open = ours(&sheet(2.0));
    for (name, upper, rotation, half) in uppers() {
        rests(name, (&slab, up(-0.5)), &upper, half, rotation);
        rests(&format!("{name}, fine"), (&fine, up(0.0)), &upper, half, rotation);
        rests(&format!("{name}, sheet"), (&open, up(0.0)), &upper, half, rotation);
    }
}

/// On what is smaller than they are: a post, a ridge under a lying one, two beams.
#[test]
fn they_rest_on_what_is_small() {
    let post = ours(&cuboid(0.3, 0.2, 1.0));
    let ridge = ours(&cuboid(0.2, 3.0, 1.0));
    for (name, upper, rotation, half) in uppers() {
        if !name.contains("lying") && name != "capsule" {
            rests(&format!("{name}, post"), (&post, up(-0.5)), &upper, half, rotation);
            rests(&format!("{name}, ridge"), (&ridge, up(-0.5)), &upper, half, rotation);
        }
    }
    // A roller across a ridge, along x.
    let across = Rotation::from_rotation_z(std::f64::consts::FRAC_PI_2 as Real);
    for (name, roller) in [
        ("cylinder", SharedShape::cylinder(0.6, 0.2)),
        ("round cylinder", SharedShape::round_cylinder(0.5, 0.1, 0.1)),
    ] {
        rests(&format!("{name} across"), (&ridge, up(-0.5)), &roller, 0.2, across);
    }
}

#[test]
fn ours_rests_on_them() {
    let cube = ours(&cuboid(1.0, 1.0, 1.0));
    let none = Rotation::IDENTITY;
    for (name, lower, rotation, top) in [
        ("column", SharedShape::cylinder(0.5, 0.3), upright(), 0.5),
        ("wide column", SharedShape::cylinder(0.5, 1.5), upright(), 0.5),
        ("round column", SharedShape::round_cylinder(0.4, 0.6, 0.1), upright(), 0.5),
        ("table on its apex", SharedShape::cone(0.5, 0.7), upright().inverse(), 0.5),
        ("round cone", SharedShape::round_cone(0.5, 0.7, 0.1), upright().inverse(), 0.6),
    ] {
        rests(name, (&lower, turned(0.0, rotation)), &cube, top + 0.5, none);
    }
    let fine = ours(&tessellated_slab(12, 0.5)); // its top is at z = 0, an apex at -0.5
    let over = Rotation::from_rotation_x(std::f64::consts::PI as Real);
    rests(
        "fine side",
        (&SharedShape::cylinder(0.5, 0.7), turned(0.0, upright())),
        &fine,
        0.5,
        over,
    );
    // Two rails, and two logs.
    let pair = |log: &SharedShape, rotation| {
        let at = |y| (Pose::from_parts(Vector::new(0.0, y, 0.0), rotation), log.clone());
        SharedShape::compound(vec![at(-0.3), at(0.3)])
    };
    let across = Rotation::from_rotation_z(std::f64::consts::FRAC_PI_2 as Real);
    let segment = SharedShape::segment(Vector::new(0.0, -2.0, 0.0), Vector::new(0.0, 2.0, 0.0));
    let (log, wire) = (SharedShape::cylinder(2.0, 0.2), SharedShape::cylinder(2.0, 0.01));
    for (name, rail, top) in [("rails", segment, 0.0), ("logs", log, 0.2), ("wires", wire, 0.01)] {
        rests(name, (&pair(&rail, across), up(0.0)), &cube, top + 0.5, none);
    }
}

/// A cup upside down over what stands in it.
#[test]
fn a_bell_hangs_on_a_cylinder_and_on_a_cone() {
    let mesh = Cup { segments: 32, ..Cup::default() }.build().expect("defaults");
    let flipped = mesh.scaled(DVec3::new(1.0, -1.0, -1.0)).expect("half a turn");
    let bell = ours(&crate::world::built(flipped));
    // The well's floor is at z = -0.1 of the bell.
    for (name, post) in [
        ("cylinder", SharedShape::cylinder(0.5, 0.2)),
        ("round", SharedShape::round_cylinder(0.45, 0.15, 0.05)),
    ] {
        rests(name, (&post, turned(0.0, upright())), &bell, 0.5 + 0.1, Rotation::IDENTITY);
    }
}

/// No inner edge is felt: what slides or rolls over a fine floor keeps its normal and its height.
#[test]
fn a_fine_floor_is_flat() {
    let floor = ours(&tessellated_slab(40, 2.0));
    // Friction topples the tall one.
    let all = uppers().into_iter().filter(|(name, ..)| !name.contains("tall"));
    for (name, shape, rotation, half) in all {
        let mut world = World::new();
        world.fixed(&floor, Pose::IDENTITY);
        let start = Pose::from_parts(Vector::new(-1.5, 0.03, half + 1e-3), rotation);
        let moving = RigidBodyBuilder::dynamic().pose(start).linvel(Vector::new(2.0, 0.3, 0.0));
        let body = world.insert(moving, &shape);
        let mut contacts = 0;
        for step in 0..60 {
            world.run(1);
            for manifold in world.manifolds() {
                let normal = manifold.local_n1;
                contacts += manifold.points.len();
                if manifold.points.iter().any(|p| p.dist < 1e-4) {
                    assert!(normal.z > 1.0 - 1e-5, "{name} in step {step}: {normal}");
                }
            }
            let z = world.at(body).z;
            // What stands tilts as friction brakes it.
            assert!(z > half - NEAR && z < half + 0.02, "{name} in step {step}: {z}");
        }
        assert!(contacts >= 60, "{name}: {contacts} contacts in all");
        assert!(world.at(body).x > -1.15, "{name} got stuck at {}", world.at(body));
    }
}

/// Those that begin inside the material are pushed out.
#[test]
fn what_starts_inside_is_pushed_out() {
    for (name, shape, rotation, half) in uppers() {
        let mut world = World::new();
        world.fixed(&ours(&cuboid(4.0, 4.0, 1.0)), up(-0.5));
        for depth in [0.3 * half, 1.2 * half] {
            let body = world.dynamic(&shape, turned(half - depth, rotation));
            world.run(400);
            let at = world.at(body);
            assert!(at.z > half.min(0.02) - NEAR, "{name}, {depth} deep: {at}");
            assert!(at.z < 0.6, "{name}, {depth} deep, was thrown: {at}");
            world.0.remove_body(body);
        }
    }
}

fn contacts(mesh: &MeshShape, partner: &SharedShape, pose: &Pose) -> Vec<ContactManifold> {
    let mut manifolds = Vec::new();
    dispatcher()
        .contact_manifolds(pose, mesh, &*partner.0, 0.1, &mut manifolds, &mut None)
        .expect("a partner that is known");
    manifolds
}

/// By hand: a cylinder that stands on a spike, lies on it, and leans with its rim into a floor.
#[test]
fn contacts_are_those_of_the_solid() {
    let spike = MeshShape::new(&model(Pyramid::default()), 0).expect("parry takes it");
    let floor = MeshShape::new(&cuboid(4.0, 4.0, 1.0), 0).expect("parry takes it");
    let cylinder = SharedShape::cylinder(0.5, 0.3);
    let apex = 0.75; // of the pyramid, above its centroid
    let gaps: [Real; 2] = [0.01, -0.01];
    for gap in gaps {
        let standing = turned(apex + 0.5 + gap, upright());
        let lying = turned(apex + 0.3 + gap, Rotation::IDENTITY);
        for (name, pose) in [("standing", standing), ("lying", lying)] {
            let found = contacts(&spike, &cylinder, &pose);
            let points: Vec<_> = found.iter().flat_map(|m| &m.points).collect();
            assert_eq!(points.len(), 1, "{name}");
            assert!((points[0].dist - gap).abs() < 1e-6, "{name}: {}", points[0].dist);
            assert!((found[0].local_n1 - Vector::Z).length() < 1e-6, "{name}");
        }
        // Leaning by 30 degrees: the rim's lowest point is 0.5 cos 30 + 0.3 sin 30 below the
        // middle.
        let lean = std::f64::consts::FRAC_PI_6 as Real;
        let (s, c) = lean.sin_cos();
        let rotation = Rotation::from_rotation_y(lean) * upright();
        let pose = turned(0.5 + 0.5 * c + 0.3 * s + gap, rotation);
        let found = contacts(&floor, &cylinder, &pose);
        let lowest = found.iter().flat_map(|m| &m.points).map(|p| p.dist).fold(1.0, Real::min);
        assert!((lowest - gap).abs() < 1e-6, "leaning: {lowest}");
        assert!(found.iter().all(|m| (m.local_n1 - Vector::Z).length() < 1e-6), "leaning");
        let deepest = found.iter().flat_map(|m| &m.points).find(|p| p.dist == lowest).expect("one");
        let x = 0.3 * c - 0.5 * s; // of the lowest point, on whichever side it is
        assert!((deepest.local_p1.x.abs() - x.abs()).abs() < 1e-5, "{}", deepest.local_p1);
    }
}

/// By hand: where contacts are of what stands askew on a small post, lies across a ridge, and is
/// stuck in a cube.
#[test]
fn contacts_span_what_is_shared() {
    let shape = |x, y| MeshShape::new(&cuboid(x, y, 1.0), 0).expect("parry takes it");
    let places = |found: &[ContactManifold]| -> Vec<Vector> {
        found.iter().flat_map(|m| &m.points).map(|p| p.local_p1).collect()
    };
    // Askew by 0.01: the corners on the higher side bear soon, too.
    let lean = Rotation::from_rotation_y(0.01) * upright();
    let found = contacts(&shape(0.3, 0.2), &SharedShape::cylinder(0.25, 0.4), &turned(0.752, lean));
    for (x, y) in [(0.15, 0.1), (-0.15, 0.1), (-0.15, -0.1), (0.15, -0.1)] {
        let corner = Vector::new(x, y, 0.5);
        let has = places(&found).iter().any(|p| (*p - corner).length() < 1e-5);
        assert!(has, "no contact at {corner}: {:?}", places(&found));
    }
    // Deeper than it is near: on the ridge, not at the ends beyond it.
    let across = Rotation::from_rotation_z(std::f64::consts::FRAC_PI_2 as Real);
    let roller = SharedShape::cylinder(0.6, 0.2);
    for width in [0.2, 1.1] {
        let found = contacts(&shape(width, 3.0), &roller, &turned(0.69, across));
        assert!(!found.is_empty());
        for p in places(&found) {
            let half = 0.5 * width as Real + 1e-5;
            assert!(p.x.abs() < half && p.y.abs() < 1e-5, "beside the ridge: {p}");
        }
    }
    // A wire without thickness, in a cube's lower side.
    let wire = SharedShape::segment(Vector::new(-2.0, 0.1, 0.0), Vector::new(2.0, 0.1, 0.0));
    let found = contacts(&shape(1.0, 1.0), &wire, &up(-0.49));
    let points: Vec<_> = found.iter().flat_map(|m| &m.points).collect();
    assert!(points.iter().all(|p| (p.dist + 0.01).abs() < 1e-5), "all are 0.01 deep");
    assert!(found.iter().all(|m| (m.local_n1 + Vector::Z).length() < 1e-5), "all lead down");
    for x in [-0.5, 0.5] {
        let has = places(&found).iter().any(|p| (p.x - x).abs() < 1e-5);
        assert!(has, "none where the wire leaves the cube at {x}: {:?}", places(&found));
    }
}

/// A disc with a border is as thick as the border is wide: 3e-7 before a cube's corner it touches
/// nothing yet, wherever the faces there look.
#[test]
fn a_thick_disc_just_before_a_corner_is_apart() {
    let (half, radius, border, gap) = (0.25, 0.5, 0.1, 3e-7);
    let cube =
        MeshShape::new(&cuboid(2.0 * half, 2.0 * half, 2.0 * half), 0).expect("parry takes it");
    let disc = SharedShape::round_cylinder(0.0, radius as Real, border as Real);
    let normal = DVec3::new(0.9, 0.3, 0.3).normalize();
    let rim = DVec3::splat(half) + normal * (border + gap);
    let middle = rim + radius * normal.with_z(0.0).normalize();
    let middle = Vector::new(middle.x as Real, middle.y as Real, middle.z as Real);
    let found = contacts(&cube, &disc, &Pose::from_parts(middle, upright()));
    let apart: Vec<Real> = found.iter().flat_map(|m| &m.points).map(|p| p.dist).collect();
    assert!(!apart.is_empty());
    assert!(apart.iter().all(|d| (0.0..0.1).contains(d)), "{apart:?}");
    assert!(apart.iter().any(|d| *d < 1e-6), "{apart:?}");
}
