//! Fast bodies and thin walls: what is named for it passes through nothing.

use cranny_exact::{DMat3, DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Query};
use cranny_primitives::{
    Ball, BodyShape, Capsule, Cylinder, HalfSpace, PlacedShape, Primitive, query_shapes,
};
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, JointSpec, MassSource, Motor, Resistance, Simulation,
    SimulationOptions, StatedMass,
};
use cranny_shapes::{Boxes, Cuboid, Hook, Torus};
use cranny_testkit::Rng;

use crate::world::{Apart, cuboid, spec};

fn built(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

/// A corrugated sheet across x, `thick` thick: its folds go back and forth by 0.4.
fn corrugated(thick: f64) -> Model {
    let folds = 24;
    let mut vertices = Vec::new();
    for i in 0..=folds {
        let x = if i % 2 == 0 { 0.2 } else { -0.2 };
        let y = f64::from(i) - 0.5 * f64::from(folds);
        for (side, z) in [(-0.5, -12.0), (-0.5, 12.0), (0.5, 12.0), (0.5, -12.0)] {
            vertices.push(DVec3::new(x + side * thick, y, z));
        }
    }
    let mut faces = Vec::new();
    let mut quad = |a: u32, b: u32, c: u32, d: u32| faces.extend([[a, b, c], [a, c, d]]);
    for i in 0..folds as u32 {
        let (p, q) = (4 * i, 4 * i + 4);
        for k in 0..4 {
            let l = (k + 1) % 4;
            quad(p + k, q + k, q + l, p + l);
        }
    }
    quad(0, 1, 2, 3);
    let end = 4 * folds as u32;
    quad(end + 3, end + 2, end + 1, end);
    let model = built(Mesh::new(vertices, faces).unwrap());
    assert!(model.mass_properties().is_some_and(|mass| mass.volume > 0.0));
    model
}

struct Throw {
    simulation: Simulation,
    body: BodyIndex,
}

fn world() -> Simulation {
    Simulation::new(SimulationOptions { gravity: DVec3::ZERO, ..SimulationOptions::default() })
}

fn of_shape(shape: &BodyShape, kind: BodyKind) -> BodySpec {
    BodySpec { shape: shape.clone(), ..spec(&cuboid(1.0, 1.0, 1.0), kind, DVec3::ZERO) }
}

/// From 3 before a wall across x, at 20 to 400 a second, tumbling.
fn thrown(wall: &BodyShape, body: &BodyShape, rng: &mut Rng) -> Throw {
    let mut simulation = world();
    simulation.insert(&of_shape(wall, BodyKind::Fixed)).expect("a wall");
    let mut vector = |size: f64| DVec3::from_array([(); 3].map(|()| size * rng.unit()));
    let from = vector(1.0) - DVec3::new(4.0, 0.0, 0.0);
    let way = (vector(2.0) * DVec3::new(0.0, 1.0, 1.0) - from).normalize();
    let angular_velocity = vector(40.0);
    let speed = 210.0 + 190.0 * rng.unit();
    let pose = Pose { rotation: rng.rotation(), translation: from };
    let thrown = BodySpec {
        pose,
        linear_velocity: speed * way,
        angular_velocity,
        ..of_shape(body, BodyKind::Dynamic)
    };
    let body = simulation.insert(&thrown).expect("a body");
    Throw { simulation, body }
}

/// What became of throws.
#[derive(Debug, Default)]
struct Thrown {
    /// Ended behind the wall.
    behind: usize,
    /// Were still held back at the end.
    hanging: usize,
    /// The deepest overlap of two meshes where one was held back, in thicknesses of the wall.
    deepest: f64,
}

fn throws(count: usize, continuous: bool) -> Thrown {
    let walls = [0.005, 0.02, 0.05].map(corrugated);
    throws_at(&walls.map(BodyShape::from), &solids(), count, continuous)
}

/// A hook, a ring and a bar.
fn solids() -> [BodyShape; 3] {
    let ring =
        Torus { major_radius: 0.5, minor_radius: 0.08, major_segments: 24, minor_segments: 8 };
    let bar = Cuboid { size: [1.5, 0.1, 0.1] };
    [Hook::default().build(), ring.build(), bar.build()].map(|m| built(m.unwrap()).into())
}

/// Each of the bodies at each of the walls, in turn.
fn throws_at(walls: &[BodyShape], bodies: &[BodyShape], count: usize, continuous: bool) -> Thrown {
    let mut rng = Rng::new(1);
    let mut found = Thrown::default();
    for i in 0..count {
        let (wall, shape) = (&walls[i / bodies.len() % walls.len()], &bodies[i % bodies.len()]);
        let Throw { mut simulation, body } = thrown(wall, shape, &mut rng);
        simulation.set_continuous(body, continuous);
        let mut crossed = None;
        for _ in 0..30 {
            simulation.step();
            // The folds reach to 0.2.
            let at = simulation.pose(body).world_from_body().apply(shape.center());
            crossed = crossed.or((at.x > 0.3).then_some(at));
            if simulation.held_back() > 0 {
                let wall = PlacedShape { shape: wall, pose: Pose::IDENTITY };
                let held = PlacedShape { shape, pose: simulation.pose(body) };
                let ask = Query::of(Demand::Regions { margin: 0.0 });
                let answer = query_shapes(wall, held, &ask, &mut PairMemory::default());
                let depth = answer.expect("poses").depth() / wall.shape.thickness();
                found.deepest = found.deepest.max(depth);
            }
        }
        // What slides beyond the wall's end passes nothing.
        found.behind += usize::from(crossed.is_some_and(|at| at.y.abs().max(at.z.abs()) < 12.0));
        found.hanging += simulation.held_back();
    }
    found
}

#[test]
fn nothing_that_is_named_passes_or_hangs_in_a_thousand_throws() {
    let found = throws(1_000, true);
    assert_eq!(found.behind, 0, "{found:?}");
    assert!(found.deepest < 0.5, "{found:?}"); // beyond, the solver may lead it to the other side
    assert!(found.hanging < 10, "{found:?}"); // 61 where nothing is braked
}

#[test]
fn much_passes_that_is_not_named() {
    let found = throws(1_000, false);
    assert!(found.behind > 400, "{found:?}"); // 470
}

/// Balls, capsules and cylinders at sheets, and whatever flies at a thin disc.
#[test]
fn primitives_pass_nothing_and_nothing_passes_them() {
    let ball = Ball { center: DVec3::ZERO, radius: 0.1 };
    let capsule = Capsule { ends: [DVec3::NEG_X * 0.4, DVec3::X * 0.4], radius: 0.06 };
    let coin = cylinder(DVec3::Y, 0.02, 0.3);
    let round: [BodyShape; 3] =
        [ball.into(), capsule.into(), coin].map(|shape: Primitive| shape.into());
    let sheets = [0.005, 0.05].map(|thick| BodyShape::from(corrugated(thick)));
    let disc = [cylinder(DVec3::X, 0.005, 20.0).into()];
    let all = [solids(), round.clone()].concat();
    for (walls, bodies, least) in [(&sheets[..], &round[..], 15), (&disc, &all, 100)] {
        let named = throws_at(walls, bodies, 300, true);
        assert_eq!(named.behind, 0, "{named:?}");
        let unnamed = throws_at(walls, bodies, 300, false);
        assert!(unnamed.behind > least && named.hanging < 20, "{unnamed:?} {named:?}");
    }
}

fn cylinder(axis: DVec3, half_height: f64, radius: f64) -> Primitive {
    Cylinder { center: DVec3::ZERO, axis, half_height, radius, border: 0.0 }.into()
}

/// A hollow cube, 4 wide outside, with walls so thick and ribs inside.
fn hollow(thick: f64) -> Model {
    let (outer, inner) = (2.0, 2.0 - thick);
    let boxes = Boxes {
        add: vec![[[-outer; 3], [outer; 3]]],
        cut: vec![
            [[-inner, -inner, -inner], [-0.5, inner, inner]],
            [[-0.5, -inner, -1.0], [0.5, inner, inner]],
            [[0.5, -inner, -inner], [inner, inner, inner]],
        ],
    };
    built(boxes.build().unwrap())
}

/// Thrown inside the hollow cube, how many are outside in the end.
fn escapes(count: usize, continuous: bool) -> usize {
    let walls = [0.01, 0.03].map(hollow);
    let ring =
        Torus { major_radius: 0.2, minor_radius: 0.04, major_segments: 16, minor_segments: 6 };
    let bodies = [ring.build(), Cuboid { size: [0.5, 0.05, 0.05] }.build()];
    let bodies = bodies.map(|mesh| built(mesh.unwrap()));
    let mut rng = Rng::new(2);
    let mut outside = 0;
    for i in 0..count {
        let (wall, model) = (&walls[i / 2 % 2], &bodies[i % 2]);
        let mut simulation = world();
        simulation.insert(&spec(wall, BodyKind::Fixed, DVec3::ZERO)).expect("a wall");
        let mut vector = |size: f64| DVec3::from_array([(); 3].map(|()| size * rng.unit()));
        let at = DVec3::Z + vector(0.3);
        let thrown = BodySpec {
            linear_velocity: vector(200.0),
            angular_velocity: vector(30.0),
            ..spec(model, BodyKind::Dynamic, at)
        };
        let body = simulation.insert(&thrown).expect("a body");
        simulation.set_continuous(body, continuous);
        (0..30).for_each(|_| simulation.step());
        let at = simulation.pose(body).translation;
        outside += usize::from(at.abs().max_element() > 2.0);
    }
    outside
}

#[test]
fn nothing_that_is_named_leaves_a_hollow() {
    assert_eq!(escapes(200, true), 0);
    let without = escapes(200, false);
    assert!(without > 150, "{without}"); // 179
}

fn flying(model: &Model, from: DVec3, velocity: DVec3) -> BodySpec {
    BodySpec { linear_velocity: velocity, ..spec(model, BodyKind::Dynamic, from) }
}

/// A sheet that flies is run through by a ball, unless one of both is named.
#[test]
fn whoever_is_named_it_holds_for_both() {
    let (sheet, ball) = (cuboid(0.02, 4.0, 4.0), cuboid(0.2, 0.2, 0.2));
    for named in [None, Some(0), Some(1)] {
        let mut simulation = world();
        let back = DVec3::new(-200.0, 0.0, 0.0);
        let sheet = simulation.insert(&flying(&sheet, DVec3::new(4.0, 0.0, 0.0), back)).unwrap();
        let ball = simulation.insert(&flying(&ball, DVec3::new(-7.0, 0.3, 0.2), -back)).unwrap();
        if let Some(named) = named {
            simulation.set_continuous([sheet, ball][named], true);
        }
        let mut held = 0;
        for _ in 0..20 {
            simulation.step();
            held += simulation.held_back();
        }
        let x = |body| simulation.pose(body).translation.x;
        assert_eq!(x(ball) > x(sheet), named.is_none(), "{named:?}: {} {}", x(ball), x(sheet));
        assert_eq!(held > 0, named.is_some());
    }
}

/// What rests and sleeps is not flown through either.
#[test]
fn a_sheet_that_sleeps_is_not_passed() {
    let (sheet, bullet) = (cuboid(0.02, 4.0, 4.0), cuboid(0.05, 0.05, 0.05));
    for named in [false, true] {
        let mut simulation = world();
        let sheet = spec(&sheet, BodyKind::Dynamic, DVec3::ZERO);
        let sheet = simulation.insert(&sheet).unwrap();
        simulation.set_continuous(sheet, named);
        (0..300).for_each(|_| simulation.step()); // two seconds make it sleep
        let far = flying(&bullet, DVec3::new(-10.0, 0.0, 0.0), DVec3::X * 390.0);
        let bullet = simulation.insert(&far).unwrap();
        (0..10).for_each(|_| simulation.step());
        let x = |body| simulation.pose(body).translation.x;
        assert_eq!(x(bullet) > x(sheet), !named, "{} {}", x(bullet), x(sheet));
    }
}

/// A piston that cannot be held runs through what it meets; bodies elsewhere go on as they went.
#[test]
fn what_cannot_be_resolved_stops_nobody_else() {
    let (piston, ball) = (cuboid(0.02, 1.0, 1.0), cuboid(0.1, 0.1, 0.1));
    let wall = cuboid(0.02, 24.0, 24.0);
    let mut simulation = world();
    let moved = BodySpec {
        linear_velocity: DVec3::X * 100.0,
        ..spec(&piston, BodyKind::Kinematic, DVec3::new(-8.0, 50.0, 0.0))
    };
    simulation.insert(&moved).unwrap();
    let met = simulation.insert(&flying(&ball, DVec3::new(0.0, 50.0, 0.0), -DVec3::X)).unwrap();
    simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let along = flying(&ball, DVec3::new(-0.5, -8.0, 0.0), DVec3::Y * 90.0);
    let along = simulation.insert(&along).unwrap();
    simulation.set_continuous(met, true);
    simulation.set_continuous(along, true);
    (0..10).for_each(|_| simulation.step());
    let at = simulation.pose(along).translation;
    assert!((at.y - 7.0).abs() < 0.01, "{at} {} held", simulation.held_back());
    assert!((simulation.velocity(along).0 - DVec3::Y * 90.0).length() < 0.01);
}

/// A rod is stopped by a wall; a ball flies behind it as fast, and ends the step within what was
/// the rod's place if the rod had not been held back.
#[test]
fn what_is_held_back_holds_others_back() {
    let (sheet, rod, ball) = (cuboid(0.02, 2.0, 2.0), cuboid(2.0, 0.1, 0.1), cuboid(0.1, 0.1, 0.1));
    let mut simulation = world();
    simulation.insert(&spec(&sheet, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let fast = |model, x: f64| flying(model, DVec3::X * x, DVec3::X * 300.0);
    let rod = simulation.insert(&fast(&rod, -3.2)).unwrap();
    let ball = simulation.insert(&fast(&ball, -6.5)).unwrap();
    simulation.set_continuous(rod, true);
    simulation.set_continuous(ball, true);
    for step in 0..10 {
        simulation.step();
        let x = |body| simulation.pose(body).translation.x;
        assert!(x(ball) + 0.05 < x(rod) - 1.0, "step {step}: {} {}", x(ball), x(rod));
        assert!(x(rod) + 1.0 < -0.01 + 1e-3, "step {step}: {}", x(rod));
    }
}

#[test]
fn what_passes_by_and_what_does_not_respond_is_not_held() {
    let (wall, ball) = (corrugated(0.02), cuboid(0.2, 0.2, 0.2));
    let mut simulation = world();
    let wall = simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let along = simulation.insert(&flying(&ball, DVec3::new(-0.5, -8.0, 0.0), DVec3::Y * 90.0));
    let through = simulation.insert(&flying(&ball, DVec3::new(-3.0, 0.1, 3.0), DVec3::X * 90.0));
    let [along, through] = [along, through].map(|body| body.unwrap());
    simulation.set_hooked(wall, true, false);
    for body in [along, through] {
        simulation.set_continuous(body, true);
    }
    for step in 0..10 {
        simulation.step_with(&Apart(wall, through));
        assert_eq!(simulation.held_back(), 0, "step {step}");
    }
    assert!(simulation.pose(along).translation.y > 6.0);
    assert!(simulation.pose(through).translation.x > 6.0);
}

/// Wherever within a step it meets the wall, it keeps what a bounce leaves it.
#[test]
fn what_bounces_keeps_its_speed() {
    let (wall, ball) = (cuboid(0.02, 4.0, 4.0), cuboid(0.1, 0.1, 0.1));
    let mut held = 0;
    for phase in 0..20 {
        let mut simulation = world();
        let bouncy = |spec| BodySpec { restitution: 1.0, ..spec };
        simulation.insert(&bouncy(spec(&wall, BodyKind::Fixed, DVec3::ZERO))).unwrap();
        let from = DVec3::X * (-8.0 - 0.25 * f64::from(phase));
        let ball = simulation.insert(&bouncy(flying(&ball, from, DVec3::X * 300.0))).unwrap();
        simulation.set_continuous(ball, true);
        for _ in 0..8 {
            simulation.step();
            held += simulation.held_back();
        }
        let speed = -simulation.velocity(ball).0.x;
        assert!(speed > 290.0, "phase {phase}: {speed}");
    }
    assert!(held > 10, "{held}");
}

/// What is very near a wall already goes away from it, or along it, as it likes.
#[test]
fn what_is_near_and_leaves_is_not_held() {
    let (wall, ball) = (cuboid(0.02, 20.0, 20.0), cuboid(0.2, 0.2, 0.2));
    for velocity in [DVec3::NEG_X, DVec3::Y] {
        let mut simulation = world();
        simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::ZERO)).unwrap();
        let at = DVec3::new(-0.01 - 0.1 - 2e-5, 0.0, 0.0);
        let ball = simulation.insert(&flying(&ball, at, 60.0 * velocity)).unwrap();
        simulation.set_continuous(ball, true);
        simulation.step();
        let travel = (simulation.pose(ball).translation - at).dot(velocity);
        assert!((travel - 1.0).abs() < 1e-3, "{velocity}: {travel}");
        assert_eq!(simulation.held_back(), 0);
    }
}

/// A blade of 2 turns by 60 degrees. A small ball is in its way, beyond the blade's box at the end.
#[test]
fn a_blade_that_turns_does_not_pass_a_named_ball() {
    let (blade, ball) = (cuboid(2.0, 0.02, 0.2), cuboid(0.02, 0.02, 0.02));
    for named in [false, true] {
        let mut simulation = world();
        let turning = BodySpec {
            angular_velocity: DVec3::Z * 63.0,
            ..spec(&blade, BodyKind::Dynamic, DVec3::ZERO)
        };
        let blade = simulation.insert(&turning).unwrap();
        let angle = 0.5_f64;
        let place = 0.97 * DVec3::new(angle.cos(), angle.sin(), 0.0);
        let ball = simulation.insert(&spec(&ball, BodyKind::Dynamic, place)).unwrap();
        simulation.set_continuous(ball, named);
        simulation.step();
        let turned =
            2.0 * simulation.pose(blade).rotation.z.atan2(simulation.pose(blade).rotation.w);
        assert_eq!(turned < angle, named, "turned by {turned}");
    }
}

/// Both are open: neither has a thickness.
#[test]
fn a_surface_without_a_volume_is_not_passed() {
    let square = |size: f64| {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = corners.map(|[y, z]| 0.5 * size * DVec3::new(0.0, y, z));
        built(Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap())
    };
    let (wall, leaf) = (square(9.0), square(0.2));
    let mass = StatedMass { mass: 1.0, center: DVec3::ZERO, inertia: 0.01 * DMat3::IDENTITY };
    for named in [false, true] {
        let mut simulation = world();
        let wall = simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::ZERO)).unwrap();
        simulation.set_continuous(wall, named);
        let from = DVec3::new(-4.0, 0.3, 0.2);
        let leaf = flying(&leaf, from, DVec3::X * 300.0);
        let leaf = BodySpec { mass: MassSource::Stated(mass), ..leaf };
        let leaf = simulation.insert(&leaf).unwrap();
        (0..2).for_each(|_| simulation.step());
        assert_eq!(simulation.pose(leaf).translation.x < 0.0, named);
    }
}

#[test]
fn groups_that_do_not_meet_pass_each_other() {
    let (wall, ball) = (cuboid(0.02, 4.0, 4.0), cuboid(0.2, 0.2, 0.2));
    let mut simulation = world();
    simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let other = BodySpec { groups: 2, ..flying(&ball, DVec3::X * -4.0, DVec3::X * 300.0) };
    let ball = simulation.insert(&other).unwrap();
    simulation.set_continuous(ball, true);
    (0..3).for_each(|_| simulation.step());
    assert!(simulation.pose(ball).translation.x > 4.0);
}

/// A link is where its joints say, whatever it meets: it is stopped by contacts alone.
#[test]
fn links_of_a_tree_are_not_held_back() {
    let (arm, wall) = (cuboid(1.0, 0.05, 0.05), cuboid(0.02, 1.0, 1.0));
    let mut simulation = world();
    let post = simulation.insert(&spec(&arm, BodyKind::Fixed, DVec3::Z)).unwrap();
    let swings = spec(&arm, BodyKind::Dynamic, DVec3::new(0.5, 0.0, 0.0));
    let link = simulation.insert(&swings).unwrap();
    let motor = Motor { velocity: 60.0, ..Motor::default() };
    let hinge = JointSpec::Revolute { axis: DVec3::Z, limits: None, motor: Some(motor) };
    let anchors = [Pose::at(-DVec3::Z), Pose::at(DVec3::new(-0.5, 0.0, 0.0))];
    let joint = simulation.join_reduced([post, link], anchors, &hinge, Resistance::default(), 0.0);
    simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::new(0.0, 0.7, 0.0))).unwrap();
    simulation.set_continuous(link, true);
    for _ in 0..20 {
        simulation.step();
        assert_eq!(simulation.held_back(), 0);
        let end = simulation.pose(link).world_from_body().apply(DVec3::new(-0.5, 0.0, 0.0));
        assert!(end.length() < 1e-3, "the hinge is at {end}");
    }
    assert!(simulation.joint_position(joint).is_some());
}

/// What lands, slides and rolls is not held by the floor that it is on.
#[test]
fn what_is_named_slides_and_rolls_as_it_would_unnamed() {
    let (floor, up) = (cuboid(400.0, 20.0, 0.2), DVec3::Z);
    let ball = Ball { center: DVec3::ZERO, radius: 0.5 };
    let wheel = cylinder(DVec3::Y, 0.2, 0.5);
    let [cube, small] = [1.0, 0.1].map(|size| BodyShape::from(cuboid(size, size, size)));
    let ball = BodyShape::from(Primitive::from(ball));
    let cases = [
        (&ball, 0.5, 20.0, 0.5),
        (&ball, 1.5, 15.0, 0.0),
        (&BodyShape::from(wheel), 0.5, 20.0, 0.5),
        (&cube, 0.5, 20.0, 0.0),
        (&small, 0.05, 1.0, 0.0),
        (&small, 0.05, 20.0, 0.0),
    ];
    for (case, (shape, height, speed, friction)) in cases.into_iter().enumerate() {
        let travelled = |named: bool| {
            let gravity = -10.0 * up;
            let options = SimulationOptions { gravity, ..SimulationOptions::default() };
            let mut simulation = Simulation::new(options);
            let ground = spec(&floor, BodyKind::Fixed, DVec3::new(190.0, 0.0, -0.1));
            simulation.insert(&BodySpec { friction, ..ground }).unwrap();
            let rolls = friction > 0.0;
            let moving = BodySpec {
                pose: Pose::at(height * up),
                linear_velocity: DVec3::X * speed,
                angular_velocity: if rolls { DVec3::Y * speed / 0.5 } else { DVec3::ZERO },
                friction,
                ..of_shape(shape, BodyKind::Dynamic)
            };
            let body = simulation.insert(&moving).unwrap();
            simulation.set_continuous(body, named);
            (0..120).for_each(|_| simulation.step());
            simulation.pose(body).translation.x
        };
        let (named, unnamed) = (travelled(true), travelled(false));
        assert!((named - unnamed).abs() < 0.02 * unnamed, "{case}: {named}, not {unnamed}");
    }
}

/// At rest on the floor of a room that is one mesh, then kicked at its wall.
#[test]
fn what_stands_on_a_floor_is_held_by_the_wall_of_the_same_body() {
    let room = Boxes {
        add: vec![[[-4.0, -4.0, -4.0], [4.0, 4.0, 4.0]]],
        cut: vec![[[-3.95, -3.95, -3.95], [3.95, 3.95, 3.95]]],
    };
    let room = built(room.build().unwrap());
    for size in [0.3, 1.0] {
        for speed in [100.0, 300.0, 1_000.0] {
            let gravity = DVec3::Z * -10.0;
            let options = SimulationOptions { gravity, ..SimulationOptions::default() };
            let mut simulation = Simulation::new(options);
            simulation.insert(&spec(&room, BodyKind::Fixed, DVec3::ZERO)).unwrap();
            let at = DVec3::Z * (0.5 * size - 3.95);
            let cube = spec(&cuboid(size, size, size), BodyKind::Dynamic, at);
            let cube = simulation.insert(&cube).unwrap();
            simulation.set_continuous(cube, true);
            (0..90).for_each(|_| simulation.step());
            simulation.set_velocity(cube, DVec3::X * speed, DVec3::ZERO);
            for step in 0..30 {
                simulation.step();
                let at = simulation.pose(cube).translation;
                assert!(at.abs().max_element() < 4.0, "{size} at {speed}, {step}: {at}");
            }
        }
    }
}

/// A half-space is as thick as can be, and bodies do not sink into it.
#[test]
fn half_spaces_hold_what_is_named() {
    let ball = Primitive::from(Ball { center: DVec3::ZERO, radius: 0.1 });
    let shapes = [ball.into(), cylinder(DVec3::Z, 0.02, 0.3).into(), cuboid(0.2, 0.2, 0.2).into()];
    for (shape, speed) in shapes.iter().zip([100.0, 400.0, 1_000.0]) {
        let shape: &BodyShape = shape;
        let mut simulation = world();
        let ground = HalfSpace { point: DVec3::ZERO, normal: DVec3::Z };
        let ground = BodyShape::from(Primitive::from(ground));
        simulation.insert(&of_shape(&ground, BodyKind::Fixed)).unwrap();
        let falling = BodySpec {
            pose: Pose::at(DVec3::Z * 5.0),
            linear_velocity: DVec3::Z * -speed,
            ..of_shape(shape, BodyKind::Dynamic)
        };
        let body = simulation.insert(&falling).unwrap();
        simulation.set_continuous(body, true);
        for step in 0..20 {
            simulation.step();
            let z = simulation.pose(body).translation.z;
            assert!(z > 0.0, "{speed}, {step}: {z}");
        }
    }
}

/// What has sunk into a floor a little leaves it, and slides over its triangles.
#[test]
fn what_has_sunk_in_leaves_and_slides_over_a_fine_floor() {
    let floor = cranny_shapes::Floor { size: [40.0, 4.0, 0.2], squares: [160, 16] };
    let floor = built(floor.build().unwrap());
    let top = floor.bounds().max.z;
    let cube = cuboid(1.0, 1.0, 1.0);
    let slanting = [DVec3::new(1.0, 0.5, 15.0), DVec3::new(15.0, 1.0, 0.0)];
    for velocity in [DVec3::Z * 12.0, DVec3::X * 15.0, slanting[0], slanting[1]] {
        let moved = |named: bool| {
            let mut simulation = world();
            let ground = BodySpec { friction: 0.0, ..spec(&floor, BodyKind::Fixed, DVec3::ZERO) };
            simulation.insert(&ground).unwrap();
            let at = DVec3::new(-15.0, 0.1, top + 0.5 - 1e-3);
            let body = BodySpec { friction: 0.0, ..flying(&cube, at, velocity) };
            let body = simulation.insert(&body).unwrap();
            simulation.set_continuous(body, named);
            (0..60).for_each(|_| simulation.step());
            simulation.pose(body).translation - at
        };
        let (named, unnamed) = (moved(true), moved(false));
        let apart = named.distance(unnamed);
        assert!(apart < 0.02 * unnamed.length(), "{velocity}: {named}, not {unnamed}");
    }
}

/// Set down flat, on an edge or on a corner, on floors of two triangles a side and of many and on a
/// half-space: what slides, tips over and tumbles goes as far as it does unnamed.
#[test]
fn what_tips_over_goes_as_far_as_unnamed() {
    let fine = cranny_shapes::Floor { size: [80.0, 80.0, 0.2], squares: [60, 60] };
    let half_space = Primitive::from(HalfSpace { point: DVec3::ZERO, normal: DVec3::Z });
    let floors: [BodyShape; 4] = [
        cuboid(80.0, 80.0, 0.02).into(),
        cuboid(80.0, 80.0, 1.0).into(),
        built(fine.build().unwrap()).into(),
        half_space.into(),
    ];
    let coin = BodyShape::from(cylinder(DVec3::Z, 0.05, 0.4));
    let bodies = [cuboid(1.0, 1.0, 1.0).into(), cuboid(0.3, 0.3, 0.3).into(), coin];
    let mut rng = Rng::new(4);
    let (mut named, mut unnamed, mut strayed) = (0.0, 0.0, Vec::new());
    for round in 0..96 {
        let (floor, body) = (&floors[round % floors.len()], &bodies[round / 4 % bodies.len()]);
        let rotation = match round / 12 % 3 {
            0 => DQuat::from_rotation_z(3.0 * rng.unit()),
            1 => DQuat::from_rotation_y(rng.unit()) * DQuat::from_rotation_z(3.0 * rng.unit()),
            _ => rng.rotation(),
        };
        let turned = Pose { rotation, translation: DVec3::ZERO };
        let top = floor.model().map_or(0.0, |model| model.bounds().max.z);
        let low = body.bounds(&turned.world_from_body()).min.z;
        let at = DVec3::new(2.0 * rng.unit() - 8.0, 2.0 * rng.unit(), top - low + 1e-4);
        let velocity = DVec3::new(10.0 + 8.0 * rng.unit(), 2.0 * rng.unit(), 0.0);
        let way = |is_named: bool| {
            let gravity = DVec3::Z * -10.0;
            let options = SimulationOptions { gravity, ..SimulationOptions::default() };
            let mut simulation = Simulation::new(options);
            let ground = BodySpec { friction: 0.0, ..of_shape(floor, BodyKind::Fixed) };
            simulation.insert(&ground).unwrap();
            let moving = BodySpec {
                pose: Pose { rotation, translation: at },
                linear_velocity: velocity,
                friction: 0.0,
                ..of_shape(body, BodyKind::Dynamic)
            };
            let body = simulation.insert(&moving).unwrap();
            simulation.set_continuous(body, is_named);
            (0..90).for_each(|_| simulation.step());
            (simulation.pose(body).translation - at).truncate().length()
        };
        let ways = [way(true), way(false)];
        named += ways[0];
        unnamed += ways[1];
        if (ways[0] - ways[1]).abs() > 0.1 * ways[1] {
            strayed.push((round, ways));
        }
    }
    assert!((named - unnamed).abs() < 0.01 * unnamed, "{named}, not {unnamed}: {strayed:?}");
    assert!(strayed.len() <= 2, "{strayed:?}");
}

/// Whoever lies on a floor and is thrown at a fence of the same body, at 400 a second.
fn passes_along(ground: &Model, of: &Model, at: DVec3, is_beyond: impl Fn(DVec3) -> bool) -> bool {
    let gravity = DVec3::Z * -10.0;
    let mut simulation =
        Simulation::new(SimulationOptions { gravity, ..SimulationOptions::default() });
    simulation.insert(&spec(ground, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let body = simulation.insert(&flying(of, at, DVec3::X * 400.0)).unwrap();
    simulation.set_continuous(body, true);
    let center = of.mass_properties().expect("a solid").center;
    (0..30).any(|_| {
        simulation.step();
        is_beyond(simulation.pose(body).world_from_body().apply(center))
    })
}

/// Tips above a flat side, faces that coincide, fins on thick blocks: whatever a body's surface
/// looks like, some core of it or of the other body holds it.
#[test]
fn bodies_of_any_make_are_held() {
    let boxes = |add: Vec<[[f64; 3]; 2]>| built(Boxes { add, cut: vec![] }.build().unwrap());
    let fence =
        boxes(vec![[[-8.0, -8.0, -0.2], [8.0, 8.0, 0.0]], [[0.0, -8.0, 0.0], [0.1, 8.0, 4.0]]]);
    let arrow = [[0.0, 0.3, 0.0], [0.0, -0.3, 0.0], [0.0, 0.0, 0.4], [2.0, 0.0, 0.0]];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let arrow = built(Mesh::new(arrow.map(DVec3::from_array).to_vec(), faces).unwrap());
    // Two cubes side by side, whose sides coincide.
    let cube = Cuboid { size: [0.5; 3] }.build().unwrap();
    let (count, moved) = (cube.vertices().len() as u32, DVec3::Y * 0.5);
    let vertices =
        [0.0, 1.0].into_iter().flat_map(|k| cube.vertices().iter().map(move |p| p + moved * k));
    let faces =
        [0, count].into_iter().flat_map(|k| cube.faces().iter().map(move |f| f.map(|v| v + k)));
    let pair = built(Mesh::new(vertices.collect(), faces.collect()).unwrap());
    for (body, lift) in [(&arrow, 0.0), (&pair, 0.25)] {
        for gap in [0.0, 1e-3, -1e-4] {
            let at = DVec3::new(-3.0, 0.0, lift + gap);
            assert!(!passes_along(&fence, body, at, |center| center.x > 0.2), "{lift} {gap}");
        }
    }
    let cube = cuboid(1.5, 1.5, 1.5);
    for thick in [0.02, 0.005] {
        let lane = boxes(vec![
            [[-20.0, -6.0, -5.0], [20.0, 6.0, 0.0]],
            [[-20.0, 0.0, 0.0], [20.0, thick, 3.0]],
            [[19.5, -6.0, 0.0], [20.0, 6.0, 5.0]],
        ]);
        for gap in [0.0, 1e-3] {
            let at = DVec3::new(15.1, thick + 0.75 + gap, 0.75);
            assert!(!passes_along(&lane, &cube, at, |center| center.x > 20.0), "{thick} {gap}");
        }
    }
}
