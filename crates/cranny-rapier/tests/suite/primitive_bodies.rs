//! Bodies that are primitives, placed anywhere in their frames: at rest in and on meshes and on
//! each other, with the masses of closed formulas.

use std::f64::consts::PI;

use cranny_exact::{DMat3, DQuat, DVec3, Pose};
use cranny_primitives::{Ball, BodyShape, Capsule, Cone, Cylinder, HalfSpace, Primitive};
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, MassSource, Normals, Simulation, SimulationOptions, StatedMass,
};
use cranny_shapes::Cup;

use crate::world::{cuboid, model, spec, tessellated_slab};

fn of(shape: impl Into<BodyShape>, kind: BodyKind, at: DVec3) -> BodySpec {
    BodySpec { shape: shape.into(), ..spec(&cuboid(1.0, 1.0, 1.0), kind, at) }
}

fn simulation(step: f64) -> Simulation {
    Simulation::new(SimulationOptions {
        step,
        length_unit: 0.1,
        gravity: DVec3::Z * -9.81,
        ..SimulationOptions::default()
    })
}

fn ball(radius: f64) -> Primitive {
    Ball { center: DVec3::ZERO, radius }.into()
}

fn ground() -> Primitive {
    HalfSpace { point: DVec3::ZERO, normal: DVec3::Z }.into()
}

fn settle(simulation: &mut Simulation, body: BodyIndex, seconds: f64) -> Pose {
    let steps = (seconds / simulation.parameters_mut().dt as f64) as usize;
    for _ in 0..steps {
        simulation.step();
    }
    let (linear, _) = simulation.velocity(body);
    assert!(linear.length() < 0.02, "it is at rest: {linear}");
    simulation.pose(body)
}

#[test]
fn a_ball_comes_to_rest_on_the_floor_of_a_cup() {
    let cup = Cup::default();
    let mut simulation = simulation(1.0 / 240.0);
    let cup_model = model(cup);
    let floor = cup_model.bounds().min.z + cup.floor;
    simulation.insert(&of(&cup_model, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let radius = 0.2 * cup.radius;
    let above = DVec3::new(0.3 * cup.radius, 0.0, cup_model.bounds().max.z + 2.0 * radius);
    let falling = of(ball(radius), BodyKind::Dynamic, above);
    let falling = simulation.insert(&falling).unwrap();
    let rest = settle(&mut simulation, falling, 4.0);
    let height = rest.translation.z - radius;
    assert!((height - floor).abs() < 0.02 * cup.wall.max(radius), "{height} over {floor}");
    assert!(rest.translation.truncate().length() < cup.radius - cup.wall);
}

#[test]
fn primitives_anywhere_in_their_frames_rest_as_high_as_they_are_on_mesh_and_half_space() {
    let aside = DVec3::new(0.3, -0.2, 0.1);
    let cases: [(Primitive, f64); 4] = [
        (Ball { center: aside, radius: 0.25 }.into(), 0.25),
        (Capsule { ends: [aside, aside + 0.5 * DVec3::X], radius: 0.2 }.into(), 0.2),
        (
            Cylinder { center: aside, axis: DVec3::Z, half_height: 0.3, radius: 0.2, border: 0.0 }
                .into(),
            0.3,
        ),
        (
            Cone { center: aside, axis: DVec3::Z, half_height: 0.3, radius: 0.2, border: 0.05 }
                .into(),
            0.35,
        ),
    ];
    let slab = tessellated_slab(6, 4.0);
    for below in [BodyShape::from(&slab), ground().into()] {
        for (primitive, height) in cases {
            let mut simulation = simulation(1.0 / 120.0);
            simulation.insert(&of(&below, BodyKind::Fixed, DVec3::ZERO)).unwrap();
            let dropped = of(primitive, BodyKind::Dynamic, DVec3::Z * (height - aside.z + 0.02));
            let dropped = simulation.insert(&dropped).unwrap();
            let rest = settle(&mut simulation, dropped, 2.0);
            let above = rest.world_from_body().apply(aside).z;
            assert!((above - height).abs() < 2e-3, "{primitive:?}: {above}, not {height}");
            let points = simulation.solved_points(BodyIndex(0), dropped);
            assert!(!points.is_empty());
            assert!(points.iter().all(|p| p.point.z.abs() < 5e-3), "on the floor: {points:?}");
        }
    }
}

#[test]
fn primitives_rest_on_each_other() {
    let mut simulation = simulation(1.0 / 240.0);
    simulation.insert(&of(ground(), BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let drum = Cylinder {
        center: DVec3::ZERO,
        axis: DVec3::Z,
        half_height: 0.25,
        radius: 0.5,
        border: 0.0,
    };
    let lower = of(Primitive::from(drum), BodyKind::Dynamic, DVec3::Z * 0.26);
    simulation.insert(&lower).unwrap();
    let upper = simulation.insert(&of(ball(0.2), BodyKind::Dynamic, DVec3::Z * 0.72)).unwrap();
    let rest = settle(&mut simulation, upper, 2.0);
    assert!((rest.translation.z - 0.7).abs() < 2e-3, "{rest:?}");
}

#[test]
fn masses_are_those_of_closed_formulas_and_stated_ones_count() {
    let mut simulation = simulation(1.0 / 60.0);
    let (h, r) = (0.4, 0.3);
    let at = DVec3::new(1.0, 2.0, 3.0);
    let cone = Cone { center: at, axis: DVec3::X, half_height: h, radius: r, border: 0.0 };
    let cases: [(Primitive, f64, DVec3); 3] = [
        (Ball { center: at, radius: r }.into(), 4.0 / 3.0 * PI * r * r * r, at),
        (cone.into(), PI * r * r * 2.0 * h / 3.0, at - 0.5 * h * DVec3::X),
        (
            Capsule { ends: [at, at + DVec3::Y], radius: r }.into(),
            PI * r * r * (1.0 + 4.0 / 3.0 * r),
            at + 0.5 * DVec3::Y,
        ),
    ];
    for (primitive, volume, center) in cases {
        let spec = BodySpec {
            mass: MassSource::Density(2.0),
            ..of(primitive, BodyKind::Dynamic, DVec3::ZERO)
        };
        let body = simulation.insert(&spec).unwrap();
        assert!((simulation.mass(body) / (2.0 * volume) - 1.0).abs() < 1e-5);
        let turned = DQuat::from_rotation_arc(DVec3::Z, DVec3::Y);
        simulation.set_pose(body, Pose { rotation: turned, translation: DVec3::ZERO });
        simulation.step();
        assert!((simulation.center_of_mass(body) - center).length() < 1e-5);
        assert!((primitive.center() - center).length() < 1e-9);
    }
    let stated = StatedMass { mass: 5.0, center: DVec3::X, inertia: DMat3::IDENTITY };
    let mass = MassSource::Stated(stated);
    let spec = BodySpec { mass, ..of(cases[1].0, BodyKind::Dynamic, DVec3::ZERO) };
    let body = simulation.insert(&spec).unwrap();
    assert_eq!(simulation.mass(body), 5.0);
    assert!((simulation.center_of_mass(body) - DVec3::X).length() < 1e-5);
}

#[test]
fn a_body_changes_between_mesh_and_primitive_and_lies_lower_then() {
    let mut simulation = simulation(1.0 / 120.0);
    simulation.insert(&of(ground(), BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let cube = cuboid(1.0, 1.0, 1.0);
    let body = simulation.insert(&of(&cube, BodyKind::Dynamic, DVec3::Z * 0.5)).unwrap();
    assert!((settle(&mut simulation, body, 1.0).translation.z - 0.5).abs() < 2e-3);
    simulation.set_shape(body, ball(0.25), Normals::Flat, 1.0).unwrap();
    assert!((settle(&mut simulation, body, 1.0).translation.z - 0.25).abs() < 2e-3);
    simulation.set_shape(body, &cube, Normals::Flat, 1.0).unwrap();
    assert!((simulation.mass(body) - 1.0).abs() < 1e-6);
}

#[test]
fn a_fast_ball_is_seen_by_the_plate_in_its_way() {
    for speed in [20.0, 60.0] {
        let mut simulation = simulation(1.0 / 240.0);
        let plate = cuboid(4.0, 4.0, 0.3);
        simulation.insert(&of(&plate, BodyKind::Fixed, DVec3::ZERO)).unwrap();
        let velocity = DVec3::Z * -speed;
        let thrown = of(ball(0.3), BodyKind::Dynamic, DVec3::Z * 1.7);
        let thrown = BodySpec { linear_velocity: velocity, ..thrown };
        let thrown = simulation.insert(&thrown).unwrap();
        let mut lowest = f64::INFINITY;
        for _ in 0..120 {
            simulation.step();
            lowest = lowest.min(simulation.pose(thrown).translation.z);
        }
        assert!(lowest > 0.4, "at {speed} it went {lowest} low");
    }
}

#[test]
fn a_continuous_ball_does_not_pass_through_a_thin_plate() {
    let lowest = |speed: f64| {
        let mut simulation = simulation(1.0 / 60.0);
        let plate = cuboid(8.0, 8.0, 0.01);
        simulation.insert(&of(&plate, BodyKind::Fixed, DVec3::ZERO)).unwrap();
        let thrown = of(ball(0.1), BodyKind::Dynamic, DVec3::new(0.3, 0.2, 20.0));
        let thrown = BodySpec { linear_velocity: DVec3::Z * -speed, ..thrown };
        let thrown = simulation.insert(&thrown).unwrap();
        simulation.set_continuous(thrown, true);
        let mut lowest = f64::INFINITY;
        for _ in 0..60 {
            simulation.step();
            lowest = lowest.min(simulation.pose(thrown).translation.z);
        }
        lowest
    };
    for speed in [50.0, 200.0, 1_000.0] {
        let lowest = lowest(speed);
        assert!(lowest > 0.0 && lowest < 20.0, "at {speed} it went {lowest} low");
    }
}

#[test]
fn what_rapier_cannot_have_is_refused_with_the_reason() {
    let mut simulation = simulation(1.0 / 60.0);
    let mut refused = |spec: &BodySpec| simulation.insert(spec).unwrap_err().to_string();
    let falling = of(ground(), BodyKind::Dynamic, DVec3::ZERO);
    assert_eq!(refused(&falling), "a half-space has no mass: make the body fixed or kinematic");
    let point = of(ball(0.0), BodyKind::Dynamic, DVec3::ZERO);
    assert!(refused(&point).contains("no positive mass"));
    let wrong = of(ball(-1.0), BodyKind::Fixed, DVec3::ZERO);
    assert!(refused(&wrong).contains("radius is -1"));
    let smooth = Normals::Smooth { crease_angle: 0.3 };
    let smooth = BodySpec { normals: smooth, ..of(ball(1.0), BodyKind::Fixed, DVec3::ZERO) };
    assert!(refused(&smooth).contains("a ball has no facets to smooth"));
    assert!(simulation.is_empty());
}
