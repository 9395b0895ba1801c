//! Three rings that hold each other.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_narrow_phase::Fields;
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, Simulation, SimulationOptions};
use cranny_shapes::Torus;

use crate::world::{model, spec};

/// How often the centre circle of `b` passes through the disc of `a`'s, with sign: the linking
/// number of two circles of radius 1.
fn linking(a: &Pose, b: &Pose) -> i32 {
    let to_a = a.world_from_body().inverse();
    let from_b = b.world_from_body();
    let circle: Vec<DVec3> = (0..720)
        .map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 720.0).sin_cos();
            to_a.apply(from_b.apply(DVec3::new(cos, sin, 0.0)))
        })
        .collect();
    (0..circle.len())
        .map(|k| {
            let (p, q) = (circle[k], circle[(k + 1) % circle.len()]);
            if (p.z < 0.0) == (q.z < 0.0) {
                return 0;
            }
            let through = p + (q - p) * (p.z / (p.z - q.z));
            if through.truncate().length() < 1.0 { (q.z - p.z).signum() as i32 } else { 0 }
        })
        .sum()
}

#[test]
fn three_rings_stay_linked() {
    let ring = model(Torus::default());
    let options = SimulationOptions { step: 1.0 / 240.0, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let rings: Vec<BodyIndex> = (0..3)
        .map(|k| {
            // Discs through the z axis, by turns in the planes xz and yz; 0.02 of play.
            let axis = if k % 2 == 0 { DVec3::Y } else { DVec3::X };
            let rotation = DQuat::from_rotation_arc(DVec3::Z, axis);
            let translation = DVec3::new(0.0, 0.0, -1.58 * f64::from(k));
            let kind = if k == 0 { BodyKind::Fixed } else { BodyKind::Dynamic };
            let velocity = DVec3::new(0.8, 0.5, 0.0) * f64::from(k);
            let body = BodySpec {
                pose: Pose { rotation, translation },
                linear_velocity: if k == 0 { DVec3::ZERO } else { velocity },
                ..spec(&ring, kind, translation)
            };
            simulation.insert(&body).expect("a ring")
        })
        .collect();
    // Depth of whole regions.
    simulation.read_by(|_, _| Fields::regions(0.0));
    let linked = |simulation: &Simulation| {
        [0, 1].map(|k| linking(&simulation.pose(rings[k]), &simulation.pose(rings[k + 1])).abs())
    };
    assert_eq!(linked(&simulation), [1, 1], "at the start");
    let start = simulation.energy().total();
    let (mut deepest, mut touched) = (0.0f64, 0);
    for step in 0..120 {
        simulation.step();
        assert_eq!(linked(&simulation), [1, 1], "in step {step}");
        for pair in simulation.contact_pairs() {
            touched += pair.answer.contacts.len();
            for depth in pair.answer.regions.iter().filter_map(|r| r.depth) {
                deepest = deepest.max(depth);
            }
        }
    }
    assert!(touched > 100, "the rings hang on nothing");
    assert!(deepest < 0.01, "overlapping by {deepest}");
    let end = simulation.energy().total();
    assert!(end <= start + 0.01 * start.abs(), "energy {start} became {end}");
}
