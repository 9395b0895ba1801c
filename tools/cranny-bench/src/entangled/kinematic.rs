//! Pairs whose hulls overlap, moved so many degrees a frame.

use std::f64::consts::{FRAC_PI_2, TAU};

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_shapes::{Cup, GolfBall, IsoBolt, IsoNut, ShapeError, Sphere, Torus};

use super::stage::Motion;

/// Margin of contacts of bodies of size 1.
const MARGIN: f64 = 0.002;

/// Margin of contacts on a thread: the gap between its flanks.
const THREAD_MARGIN: f64 = 0.05;

/// Two linked tori of tube radius 0.2 and ring radius 1, `gap` apart (overlapping where negative).
/// The second spins about its own axis and sways about the line between their tubes.
pub(super) fn linked_tori(
    thousands: u32,
    gap: f64,
    degrees: f64,
    frames: usize,
) -> Result<Motion, ShapeError> {
    let (major_segments, minor_segments) = match thousands {
        1 => (44, 12),
        10 => (144, 36),
        _ => (450, 112),
    };
    let ring = Torus { major_radius: 1.0, minor_radius: 0.2, major_segments, minor_segments };
    let pose = |frame: usize| {
        let f = frame as f64;
        let sway = DQuat::from_rotation_x(FRAC_PI_2 + 0.3 * (0.04 * degrees * f).sin());
        let spin = DQuat::from_rotation_z((degrees * f).to_radians());
        // The tubes are nearest where the first's inner side faces the second's.
        let apart = 1.6 - gap + 0.2 * gap.abs() * (0.1 * degrees * f).sin();
        Pose { rotation: (sway * spin).normalize(), translation: apart * DVec3::X }
    };
    let poses = (0..frames).map(pose).collect();
    Ok(Motion::of_twins(ring.build()?, poses, 2.4 * MARGIN))
}

/// Two golf balls of diameter 1, `gap` apart; the second spins about a slanted axis.
pub(super) fn golf_balls(
    thousands: u32,
    gap: f64,
    degrees: f64,
    frames: usize,
) -> Result<Motion, ShapeError> {
    let triangles = 1_000 * thousands;
    let dimples = if triangles >= 10_000 { 336 } else { 36 };
    let ball =
        GolfBall { triangles, dimples, radius: 0.5, dimple_depth: 0.015, ..GolfBall::default() };
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let pose = |frame: usize| Pose {
        rotation: DQuat::from_axis_angle(axis, (degrees * frame as f64).to_radians()),
        translation: (1.0 + gap) * DVec3::new(0.6, 0.64, 0.48),
    };
    Ok(Motion::of_twins(ball.build()?, (0..frames).map(pose).collect(), MARGIN))
}

/// A ball that goes around in a cup of inner radius 0.9, `gap` off its wall, turning as it goes.
pub(super) fn ball_in_cup(gap: f64, degrees: f64, frames: usize) -> Result<Motion, ShapeError> {
    let cup = Cup { radius: 1.0, height: 2.0, wall: 0.1, floor: 0.1, segments: 96 };
    let ball = Sphere { radius: 0.4, segments: 48, rings: 24 };
    let away = 0.9 - 0.4 - gap;
    let pose = |frame: usize| {
        let angle = degrees.to_radians() * frame as f64;
        Pose {
            rotation: DQuat::from_axis_angle(DVec3::ONE.normalize(), 2.0 * angle),
            translation: DVec3::new(away * angle.cos(), away * angle.sin(), 1.0),
        }
    };
    let poses = (0..frames).map(pose).collect();
    Ok(Motion::of_pair(cup.build()?, ball.build()?, poses, 2.0 * MARGIN))
}

/// Our M16 nut on its bolt.
pub(super) fn nut(way: Way, degrees: f64, frames: usize) -> Result<Motion, ShapeError> {
    let (bolt, nut) = (IsoBolt::default(), IsoNut::default());
    let thread = Thread {
        pitch: bolt.pitch,
        radius: 8.0,
        start: 12.0,
        play: 0.05 * bolt.pitch,
        middle: 0.0,
    };
    Ok(on_thread(bolt.build()?, nut.build()?, thread, way, degrees, frames))
}

/// A nut's way along its bolt's thread.
#[derive(Clone, Copy, Debug)]
pub(super) enum Way {
    /// Screwed: its flanks slide along the bolt's.
    Along,
    /// Pushed along the axis, to and fro: its flanks come near the bolt's and enter them.
    Across,
}

/// A thread, and where a nut is on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thread {
    pub(super) pitch: f64,
    pub(super) radius: f64,
    /// Height of the nut, along the thread in the first frame.
    pub(super) start: f64,
    /// Amplitude across, to either side of the middle between the flanks.
    pub(super) play: f64,
    /// Height of that middle above `start`.
    pub(super) middle: f64,
}

/// A nut on a bolt along z. Across, a frame is as long as its degrees are at the thread's radius.
pub(super) fn on_thread(
    bolt: Mesh,
    nut: Mesh,
    thread: Thread,
    way: Way,
    degrees: f64,
    frames: usize,
) -> Motion {
    let pose = |frame: usize| {
        let angle = (degrees * frame as f64).to_radians();
        match way {
            Way::Along => Pose {
                rotation: DQuat::from_rotation_z(angle),
                translation: (thread.start + thread.pitch * angle / TAU) * DVec3::Z,
            },
            Way::Across => {
                let shift = to_and_fro(thread.radius * angle, thread.play);
                Pose::at((thread.start + thread.middle + shift) * DVec3::Z)
            }
        }
    };
    Motion::of_pair(bolt, nut, (0..frames).map(pose).collect(), THREAD_MARGIN)
}

/// At constant speed from 0 to `most`, to `-most` and back.
fn to_and_fro(way: f64, most: f64) -> f64 {
    let phase = (way / most + 1.0).rem_euclid(4.0);
    most * (if phase < 2.0 { phase - 1.0 } else { 3.0 - phase })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_to_and_fro_turns_at_its_ends() {
        let at = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|way| to_and_fro(way, 2.0));
        assert_eq!(at, [0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0]);
    }

    #[test]
    fn nuts_follow_the_helix() {
        let motion = nut(Way::Along, 90.0, 5).unwrap();
        let heights: Vec<f64> = motion.frames.iter().map(|poses| poses[1].translation.z).collect();
        assert_eq!(heights[0], 12.0);
        assert!((heights[4] - 14.0).abs() < 1e-12, "one pitch a turn: {heights:?}");
    }
}
