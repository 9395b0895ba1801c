//! A ring that slips out of another is told in the summary.

use std::f64::consts::FRAC_PI_2;

use cranny_ecs::{PartedSummary, PluginOptions, Ring, RunOptions, SceneApp};
use cranny_exact::{DQuat, DVec3};
use cranny_world::description::BodyKind;

use crate::build::{cube, scene};

/// Unit circles: one lies, one stands with its centre at x = 0.875 + t, so that it passes through
/// the plane of the first at x = t - 0.125 and 2 farther on. From t = 1.25, the end of step 5, both
/// are outside.
#[test]
fn a_ring_that_leaves_another_is_told_with_its_step() {
    let mut standing = cube("standing", BodyKind::Kinematic, DVec3::new(0.875, 0.0, 0.0), DVec3::X);
    standing.pose.rotation = DQuat::from_rotation_x(FRAC_PI_2);
    let lying = cube("lying", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
    let far = cube("far", BodyKind::Fixed, DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO);
    let ring = |name: &str| Ring { body: name.into(), radius: 1.0 };
    let rings = ["lying", "standing", "far"].map(ring).to_vec();
    let plugins = PluginOptions { rings, ..PluginOptions::default() };
    let options =
        RunOptions { step: Some(0.25), duration: Some(2.0), plugins, ..RunOptions::default() };
    let mut app = SceneApp::new(&scene(vec![lying, standing, far], &[]), &options).unwrap();
    while app.step().unwrap() {}
    let links = app.finish().unwrap().links.unwrap();
    assert_eq!(links.at_start, 1);
    let parted = PartedSummary { a: "lying".into(), b: "standing".into(), step: 5 };
    assert_eq!(links.parted, [parted]);
}
