//! Fast bodies and thin walls: what is named for it passes through nothing.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, Simulation, SimulationOptions};
use cranny_shapes::{Cuboid, Hook, Torus};
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

/// From 3 before a wall across x, at 20 to 400 a second, tumbling.
fn thrown(wall: &Model, body: &Model, rng: &mut Rng) -> Throw {
    let mut simulation = world();
    simulation.insert(&spec(wall, BodyKind::Fixed, DVec3::ZERO)).expect("a wall");
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
        ..spec(body, BodyKind::Dynamic, DVec3::ZERO)
    };
    let body = simulation.insert(&thrown).expect("a body");
    Throw { simulation, body }
}

/// Of so many throws, how many end behind the wall.
fn behind(throws: usize, continuous: bool) -> usize {
    let walls = [0.005, 0.02, 0.05].map(corrugated);
    let ring =
        Torus { major_radius: 0.5, minor_radius: 0.08, major_segments: 24, minor_segments: 8 };
    let bar = Cuboid { size: [1.5, 0.1, 0.1] };
    let bodies = [Hook::default().build(), ring.build(), bar.build()].map(|m| built(m.unwrap()));
    let mut rng = Rng::new(1);
    let throws = (0..throws).filter(|i| {
        let (wall, model) = (&walls[i / 3 % 3], &bodies[i % 3]);
        let Throw { mut simulation, body } = thrown(wall, model, &mut rng);
        simulation.set_continuous(body, continuous);
        (0..15).for_each(|_| simulation.step());
        let center = model.mass_properties().expect("a solid").center;
        // The folds reach to 0.2.
        simulation.pose(body).world_from_body().apply(center).x > 0.3
    });
    throws.count()
}

#[test]
fn nothing_that_is_named_passes_in_a_thousand_throws() {
    assert_eq!(behind(1_000, true), 0);
}

#[test]
fn much_passes_that_is_not_named() {
    let passed = behind(1_000, false);
    assert!(passed > 200, "{passed}");
}

fn flying(model: &Model, from: DVec3, velocity: DVec3) -> BodySpec<'_> {
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

/// Three in a row: the second is stopped by the third, so the first by the second.
#[test]
fn what_is_held_back_holds_others_back() {
    let sheet = cuboid(0.02, 2.0, 2.0);
    let mut simulation = world();
    let wall = simulation.insert(&spec(&sheet, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let fast = |x: f64, speed: f64| flying(&sheet, DVec3::X * x, DVec3::X * speed);
    let second = simulation.insert(&fast(-1.0, 120.0)).unwrap();
    let first = simulation.insert(&fast(-3.0, 300.0)).unwrap();
    simulation.set_continuous(first, true);
    simulation.set_continuous(second, true);
    for _ in 0..30 {
        simulation.step();
        let x = |body| simulation.pose(body).translation.x;
        assert!(x(first) < x(second) && x(second) < x(wall), "{} {}", x(first), x(second));
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
