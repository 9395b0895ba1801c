//! Each partner on ours, and ours on each partner: at rest at the right height.

use cranny_shapes::Cup;
use rapier3d::math::{IVector, Pose, Real, Vector};
use rapier3d::parry::shape::{RoundShape, SharedShape};

use crate::world::{World, cuboid, model, ours, up};

/// Height of our slab's top, of the fall, and what 'the right height' allows: rapier lets bodies
/// overlap by 0.001 and holds them within its prediction distance.
const TOP: Real = 0.5;
const FALL: Real = 0.05;
const NEAR: Real = 1e-2;

/// A hexagonal prism of half height 0.25 along z.
fn hexagon() -> SharedShape {
    let corner = |k: u32, z: Real| {
        let (sin, cos) = (k as Real * (std::f64::consts::FRAC_PI_3 as Real)).sin_cos();
        Vector::new(0.4 * cos, 0.4 * sin, z)
    };
    let points: Vec<Vector> = (0..6).flat_map(|k| [corner(k, -0.25), corner(k, 0.25)]).collect();
    SharedShape::convex_hull(&points).expect("a volume")
}

fn round_hexagon() -> SharedShape {
    let hexagon = hexagon();
    let inner_shape = hexagon.as_convex_polyhedron().expect("a hull").clone();
    SharedShape::new(RoundShape { inner_shape, border_radius: 0.05 })
}

/// Three by three cells of half a unit, in the middle, without the one at a corner.
fn voxels() -> SharedShape {
    let cells = (-1..=1).flat_map(|x| (-1..=1).map(move |y| IVector::new(x, y, 0)));
    let cells: Vec<IVector> = cells.filter(|c| (c.x, c.y) != (1, 1)).collect();
    let corner = SharedShape::voxels(Vector::splat(0.5), &cells);
    // Cells begin at multiples of their size.
    SharedShape::compound(vec![(Pose::translation(-0.25, -0.25, -0.25), corner)])
}

/// A large triangle through the origin that looks up, with a border radius or without.
fn triangle(radius: Real) -> SharedShape {
    let [a, b, c] = [[-3.0, -2.0], [3.0, -2.0], [0.0, 4.0]].map(|[x, y]| Vector::new(x, y, 0.0));
    match radius {
        0.0 => SharedShape::triangle(a, b, c),
        radius => SharedShape::round_triangle(a, b, c, radius),
    }
}

/// Two rails.
fn segments() -> SharedShape {
    let rail = |y: Real| {
        let ends = [-2.0, 2.0].map(|x| Vector::new(x, y, 0.0));
        (Pose::IDENTITY, SharedShape::segment(ends[0], ends[1]))
    };
    SharedShape::compound(vec![rail(-0.3), rail(0.3)])
}

fn parry_mesh(x: f64, y: f64, z: f64) -> SharedShape {
    let model = cuboid(x, y, z);
    let mesh = cranny_rapier::Detector::RapierTrimesh.shape(&model, 0);
    mesh.expect("parry takes a cuboid")
}

/// Drops `upper` from a little above `rest` on `lower` and looks where it comes to rest, for either
/// order of insertion, since rapier's order of a pair follows it.
#[track_caller]
fn rests(name: &str, lower: &SharedShape, upper: &SharedShape, rest: Real) {
    for upper_first in [false, true] {
        let mut world = World::new();
        let start = up(rest + FALL);
        let lower = (lower, Pose::IDENTITY);
        let body = world.one_on_another(lower, (upper, start), upper_first);
        world.run(60);
        let early = world.at(body);
        world.run(90);
        let late = world.at(body);
        let what = format!("{name}, upper first: {upper_first}: {early} then {late}");
        assert!((late.z - rest).abs() < NEAR, "{what}: expected z = {rest}");
        assert!((late - early).length() < 0.1 * NEAR, "{what}: not at rest");
        assert!(late.truncate().length() < NEAR, "{what}: drifted");
        let velocity = world.0.bodies[body].linvel();
        assert!(velocity.length() < NEAR, "{what}: moves by {velocity}");
    }
}

#[test]
fn every_partner_rests_on_ours() {
    let slab = ours(&cuboid(4.0, 4.0, 1.0));
    let partners = [
        ("ball", SharedShape::ball(0.4), 0.4),
        ("lying capsule", SharedShape::capsule_x(0.3, 0.2), 0.2),
        ("cuboid", SharedShape::cuboid(0.3, 0.4, 0.25), 0.25),
        ("convex polyhedron", hexagon(), 0.25),
        ("triangle mesh", parry_mesh(0.6, 0.6, 0.5), 0.25),
        ("ours", ours(&cuboid(0.6, 0.8, 0.5)), 0.25),
        ("round cuboid", SharedShape::round_cuboid(0.3, 0.2, 0.15, 0.1), 0.25),
        ("round hexagon", round_hexagon(), 0.3),
        ("voxels", voxels(), 0.25),
    ];
    for (name, upper, half) in partners {
        rests(name, &slab, &upper, TOP + half);
    }
}

#[test]
fn ours_rests_on_every_partner() {
    let cube = ours(&cuboid(1.0, 1.0, 1.0));
    let partners = [
        ("half-space", SharedShape::halfspace(Vector::Z), 0.0),
        ("cuboid", SharedShape::cuboid(2.0, 2.0, 0.5), TOP),
        ("small cuboid", SharedShape::cuboid(0.2, 0.2, 0.5), TOP),
        ("convex polyhedron", hexagon(), 0.25),
        ("triangle mesh", parry_mesh(4.0, 4.0, 1.0), TOP),
        ("ours", ours(&cuboid(4.0, 4.0, 1.0)), TOP),
        ("triangle", triangle(0.0), 0.0),
        ("round triangle", triangle(0.1), 0.1),
        ("round cuboid", SharedShape::round_cuboid(2.0, 2.0, 0.3, 0.2), TOP),
        ("small round cuboid", SharedShape::round_cuboid(0.2, 0.2, 0.3, 0.2), TOP),
        ("voxels", voxels(), 0.25),
        ("segments", segments(), 0.0),
    ];
    for (name, lower, top) in partners {
        rests(name, &lower, &cube, top + 0.5);
    }
}

/// A cup upside down over a round head: it hangs by the floor of its well like a bell.
#[test]
fn a_bell_hangs_on_a_ball_and_on_a_capsule() {
    let mesh = Cup { segments: 32, ..Cup::default() }.build().expect("defaults");
    let flipped = mesh.scaled(cranny_exact::DVec3::new(1.0, -1.0, -1.0)).expect("half a turn");
    let bell = ours(&crate::world::built(flipped));
    // The well's floor is at z = −0.1 of the bell; the heads' tops are at 0.25 and 0.5.
    rests("ball", &SharedShape::ball(0.25), &bell, 0.25 + 0.1);
    rests("capsule", &SharedShape::capsule_z(0.3, 0.2), &bell, 0.5 + 0.1);
}

#[test]
fn an_open_sheet_holds_what_falls_on_it() {
    let sheet = ours(&crate::world::sheet(2.0));
    for (name, upper, half) in [
        ("ball", SharedShape::ball(0.4), 0.4),
        ("capsule", SharedShape::capsule_x(0.3, 0.2), 0.2),
        ("cuboid", SharedShape::cuboid(0.3, 0.4, 0.25), 0.25),
        ("ours", ours(&cuboid(0.6, 0.8, 0.5)), 0.25),
    ] {
        rests(name, &sheet, &upper, half);
    }
}

#[test]
fn a_changed_shape_is_the_one_that_rests() {
    let mut world = World::new();
    world.fixed(&ours(&cuboid(4.0, 4.0, 1.0)), Pose::IDENTITY);
    let body = world.dynamic(&SharedShape::cuboid(0.2, 0.2, 0.2), up(TOP + 0.2));
    world.run(30);
    let collider = world.0.bodies[body].colliders()[0];
    world.0.colliders[collider].set_shape(SharedShape::cuboid(0.3, 0.3, 0.4));
    world.0.bodies[body].set_position(up(TOP + 0.4 + FALL), true);
    world.run(120);
    assert!((world.at(body).z - (TOP + 0.4)).abs() < NEAR, "{}", world.at(body));
}

#[test]
fn a_torus_lies_flat() {
    let torus = cranny_shapes::Torus { minor_segments: 16, ..Default::default() };
    let slab = SharedShape::cuboid(2.0, 2.0, 0.5);
    rests("torus", &slab, &ours(&model(torus)), TOP + 0.2);
}
