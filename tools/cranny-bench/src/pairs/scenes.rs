//! The pairs that are measured, and how they move.

use std::f64::consts::{PI, TAU};

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_shapes::{GolfBall, IsoBolt, IsoNut, ShapeError, Torus};

/// Frames of a scene that is found by name.
const FRAMES: usize = 200;

/// Gaps relative to the size: near, and in contact.
const NEAR: f64 = 0.03;
const CONTACT: f64 = -0.02;

/// Bodies of that name, and the second's poses; the first rests at the origin.
pub(crate) fn scene(name: &str) -> Option<([Mesh; 2], Vec<Pose>)> {
    let built = match name {
        "golf 1k near" => golf_balls(1_000, NEAR, 0.1, FRAMES),
        "golf 10k near" => golf_balls(10_000, NEAR, 0.1, FRAMES),
        "golf 10k contact" => golf_balls(10_000, CONTACT, 0.1, FRAMES),
        "torus 10k near" => tori(10_000, NEAR, 0.1, FRAMES),
        "torus 10k contact" => tori(10_000, CONTACT, 0.1, FRAMES),
        "nut on bolt, 1.5 degrees" => nut_on_bolt(1.5, FRAMES),
        "nut on bolt, 2 degrees" => nut_on_bolt(2.0, FRAMES),
        _ => return None,
    };
    built.ok()
}

/// Two meshes, the first at rest at the origin, and the second's poses.
pub(super) type Built = Result<([Mesh; 2], Vec<Pose>), ShapeError>;

/// Balls of diameter 1; the second spins about a slanted axis while its middle stays.
pub(super) fn golf_balls(triangles: u32, gap: f64, degrees: f64, frames: usize) -> Built {
    let dimples = if triangles >= 10_000 { 336 } else { 36 };
    let ball =
        GolfBall { triangles, dimples, radius: 0.5, dimple_depth: 0.015, ..GolfBall::default() };
    let mesh = ball.build()?;
    let middle = (1.0 + gap) * DVec3::new(0.6, 0.64, 0.48);
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    Ok(([mesh.clone(), mesh], spinning(middle, DQuat::IDENTITY, axis, degrees, frames)))
}

/// Tori of diameter 1, side by side across a corner of the first's box, the second slanted and
/// turning about its own axis.
pub(super) fn tori(triangles: u32, gap: f64, degrees: f64, frames: usize) -> Built {
    // Four times as many segments around the ring as around the tube.
    let minor = (f64::from(triangles) / 8.0).sqrt().round() as u32;
    let ring = Torus {
        major_radius: 0.4,
        minor_radius: 0.1,
        major_segments: 4 * minor,
        minor_segments: minor,
    };
    let mesh = ring.build()?;
    let beside = DVec3::new(0.8, 0.6, 0.0);
    let slant = DQuat::from_axis_angle(beside, PI / 6.0);
    let poses = spinning((1.0 + gap) * beside, slant, DVec3::Z, degrees, frames);
    Ok(([mesh.clone(), mesh], poses))
}

fn spinning(middle: DVec3, slant: DQuat, axis: DVec3, degrees: f64, frames: usize) -> Vec<Pose> {
    let turn = |frame: usize| DQuat::from_axis_angle(axis, (degrees * frame as f64).to_radians());
    (0..frames)
        .map(|k| Pose { rotation: (slant * turn(k)).normalize(), translation: middle })
        .collect()
}

/// The nut screwed down its bolt along the helix, from the middle of the thread.
pub(super) fn nut_on_bolt(degrees: f64, frames: usize) -> Built {
    let (bolt, nut) = (IsoBolt::default(), IsoNut::default());
    let pitch = bolt.pitch;
    let meshes = [bolt.build()?, nut.build()?];
    let pose = |frame: usize| {
        let angle = (degrees * frame as f64).to_radians();
        let height = 12.0 + pitch * angle / TAU;
        Pose {
            rotation: DQuat::from_axis_angle(DVec3::Z, angle).normalize(),
            translation: height * DVec3::Z,
        }
    };
    Ok((meshes, (0..frames).map(pose).collect()))
}
