//! The pairs that are measured, and how they move.

use std::f64::consts::{PI, TAU};

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_narrow_phase::Demand;
use cranny_shapes::{GolfBall, IsoBolt, IsoNut, ShapeError, Torus};

/// Two bodies, the first at rest at the origin, and the second's poses.
pub(super) struct Scene {
    pub(super) name: String,
    pub(super) meshes: [Mesh; 2],
    pub(super) poses: Vec<Pose>,
    pub(super) demands: Vec<Demand>,
}

const NEAR: &[Demand] = &[Demand::Intersects, Demand::Distance { below: None }];

/// Contacts for a solver within 0.2 % of the size.
const CONTACT: &[Demand] =
    &[Demand::Intersects, Demand::Regions { margin: 0.0 }, Demand::contacts(0.002)];

/// As far as the gap between the flanks.
const THREAD: Demand = Demand::contacts(0.05);

/// The scenes whose name contains `only`; what cannot be built is left out.
pub(super) fn scenes(quick: bool, only: &str) -> Vec<Scene> {
    let frames = if quick { 200 } else { 1_000 };
    let sizes: &[u32] = if quick { &[1_000, 10_000] } else { &[1_000, 10_000, 100_000] };
    let mut out: Vec<(String, Builder, Vec<Demand>)> = Vec::new();
    for &size in sizes {
        for (what, gap, demands) in [("near", 0.03, NEAR), ("contact", -0.02, CONTACT)] {
            let sized = |shape: &str| format!("{shape} {}k {what}", size / 1_000);
            let balls = move || golf_balls(size, gap, 0.1, frames);
            out.push((sized("golf"), Box::new(balls), demands.to_vec()));
            let rings = move || tori(size, gap, 0.1, frames);
            out.push((sized("torus"), Box::new(rings), demands.to_vec()));
        }
    }
    for degrees in [0.01, 0.03, 0.3, 1.0, 3.0, 10.0] {
        for (what, gap, demands) in [("near", 0.03, NEAR), ("contact", -0.02, CONTACT)] {
            let name = format!("torus 10k {what}, {degrees} degrees");
            let rings = move || tori(10_000, gap, degrees, frames);
            out.push((name, Box::new(rings), demands.to_vec()));
        }
    }
    for (degrees, demand) in [
        (0.1, Demand::Intersects),
        (0.5, Demand::Intersects),
        (2.0, Demand::Intersects),
        (1.5, THREAD),
    ] {
        let name = format!("nut on bolt, {degrees} degrees");
        let thread = move || nut_on_bolt(degrees, frames.min(300));
        out.push((name, Box::new(thread), vec![demand]));
    }
    out.into_iter()
        .filter(|(name, ..)| name.contains(only))
        .filter_map(|(name, built, demands)| {
            let (meshes, poses) = built().ok()?;
            Some(Scene { name, meshes, poses, demands })
        })
        .collect()
}

pub(super) type Built = Result<([Mesh; 2], Vec<Pose>), ShapeError>;

/// A scene, built when its turn comes.
type Builder = Box<dyn Fn() -> Built>;

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
