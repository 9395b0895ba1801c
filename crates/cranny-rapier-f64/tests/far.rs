//! What single precision cannot: a ring that falls into another a hundred kilometres from the
//! origin moves as it does at the origin.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Model};
use cranny_rapier_f64::{BodyKind, BodySpec, MassSource, Normals, Simulation, SimulationOptions};
use cranny_shapes::Torus;

/// Far enough that steps of f32 are 0.008 there.
const FAR: DVec3 = DVec3::new(1e5, -1e5, 5e4);

/// Where the lower of two linked rings is in each step, seen from `origin`.
fn falls(origin: DVec3) -> Vec<Pose> {
    let ring = Torus::default().build().expect("a torus");
    let (ring, _) = Model::build(ring, &BuildOptions::default()).expect("a torus");
    let options = SimulationOptions { step: 1.0 / 240.0, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let body = |kind, axis, at| BodySpec {
        shape: (&ring).into(),
        kind,
        pose: Pose { rotation: DQuat::from_rotation_arc(DVec3::Z, axis), translation: origin + at },
        linear_velocity: DVec3::ZERO,
        angular_velocity: DVec3::ZERO,
        mass: MassSource::Density(1.0),
        friction: 0.5,
        restitution: 0.0,
        normals: Normals::Flat,
        groups: 1,
    };
    let upper = body(BodyKind::Fixed, DVec3::Y, DVec3::ZERO);
    let lower =
        body(BodyKind::Dynamic, DVec3::new(0.96, 0.224, 0.168), DVec3::new(0.137, 0.071, -1.5));
    simulation.insert(&upper).expect("a ring");
    let lower = simulation.insert(&lower).expect("a ring");
    (0..60)
        .map(|_| {
            simulation.step();
            let Pose { rotation, translation } = simulation.pose(lower);
            Pose { rotation, translation: translation - origin }
        })
        .collect()
}

#[test]
fn a_ring_falls_far_away_as_it_does_at_the_origin() {
    let (here, there) = (falls(DVec3::ZERO), falls(FAR));
    let free = 0.5 * 9.81 * (60.0 / 240.0f64).powi(2);
    let sunk = -1.5 - here[59].translation.z;
    assert!(sunk > 0.05 && sunk < 0.9 * free, "caught after {sunk}, where {free} is free fall");
    for (step, (a, b)) in here.iter().zip(&there).enumerate() {
        let off = (a.translation - b.translation).length();
        assert!(off < 1e-6 && a.rotation.dot(b.rotation).abs() > 1.0 - 1e-9, "{step}: {off:e}");
    }
}
