//! Corners, edges and faces that come down on corners, edges and faces of bodies with concavities.

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::{FaceId, Mesh, Model};
use cranny_narrow_phase::{PairMemory, Placed};
use cranny_testkit::bodies::{channel, cuboid, quarter_turns};
use cranny_testkit::rational_verdict;

use super::{DISTANCE_ERROR, PAIR_FAILS};
use crate::bodies::{hollows, small_bodies, two_to_minus};
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "contacts",
    question: "A small convex body rests with its lowest corner, edge or face on a corner, an edge or a face of a body \
            with concavities: lifted by 2^-10 to 2^-50, touching exactly, or sunk in by as much.",
    made: "Coordinates and poses are dyadic, so nothing rounds; the truth is that of exact rationals. Where a body \
           sinks into the middle of a face, its depth is known by construction.",
    fails: PAIR_FAILS,
    figure: DISTANCE_ERROR,
    cases,
};

const KINDS: [&str; 3] = ["corner", "edge", "face"];

fn cases(trial: &mut Trial<'_>) {
    let hollows = models(trial, hollows());
    let small = small_bodies(trial);
    let small = models(trial, small);
    let turns = quarter_turns();
    let mut memory = PairMemory::default();
    for round in 0..trial.variants {
        for k in (10..=50).step_by(4) {
            let Some(place) = place(trial, &hollows, &small, &turns) else { continue };
            for side in [1.0, 0.0, -1.0] {
                let lifted = place.on + side * two_to_minus(k) * place.up;
                let name = format!("{}, {}", place.name, lift(side, k));
                let a = Placed { model: place.a, pose: place.pose_a };
                let pose = Pose { translation: lifted, ..place.pose_b };
                trial.pair(name, a, Placed { model: place.b, pose }, None, &mut memory);
            }
            sunk(trial, &small[(round as usize + k as usize / 4) % small.len()], k, &mut memory);
        }
    }
}

/// Where a body rests on another.
struct Resting<'m> {
    name: String,
    a: &'m Model,
    b: &'m Model,
    pose_a: Pose,
    pose_b: Pose,
    /// B's translation, and a direction away from the face of A.
    on: DVec3,
    up: DVec3,
}

/// Tries so many places, one of which mostly is where the bodies only touch.
const TRIES: usize = 40;

/// A place where two bodies touch and do not overlap.
fn place<'m>(
    trial: &mut Trial<'_>,
    hollows: &'m [(&'static str, Model)],
    small: &'m [(&'static str, Model)],
    turns: &[DQuat],
) -> Option<Resting<'m>> {
    (0..TRIES).find_map(|_| {
        let (name_a, a) = &hollows[trial.rng.below(hollows.len())];
        let (name_b, b) = &small[trial.rng.below(small.len())];
        let (kind, turn_a, turn_b) = (trial.rng.below(3), *trial.pick(turns), *trial.pick(turns));
        let pose_a = Pose { rotation: turn_a, translation: DVec3::ZERO };
        let (spot, up) = spot(trial, a.mesh(), &pose_a, kind)?;
        let on = spot - lowest(trial, b.mesh(), turn_b, up);
        let pose_b = Pose { rotation: turn_b, translation: on };
        let verdict = rational_verdict(a.mesh(), &pose_a, b.mesh(), &pose_b);
        let name = format!("{name_b} on {} of {name_a}", KINDS[kind]);
        let rests = verdict.surface == Meeting::Touch && !verdict.solid;
        rests.then_some(Resting { name, a, b, pose_a, pose_b, on, up })
    })
}

pub(super) fn models(
    trial: &mut Trial<'_>,
    meshes: Vec<(&'static str, Mesh)>,
) -> Vec<(&'static str, Model)> {
    let build = |(name, mesh)| Some((name, trial.model(name, mesh)?));
    meshes.into_iter().filter_map(build).collect()
}

pub(super) fn lift(side: f64, k: u32) -> String {
    match side {
        0.0 => "touching".to_owned(),
        side if side > 0.0 => format!("2^-{k} above"),
        _ => format!("2^-{k} too deep"),
    }
}

/// A point of a face, in its middle, on an edge or at a corner, and a direction with entries −1, 0
/// and 1 away from it; `None` where the face's normal is no multiple of one.
fn spot(trial: &mut Trial<'_>, mesh: &Mesh, pose: &Pose, kind: usize) -> Option<(DVec3, DVec3)> {
    let face = FaceId(trial.rng.below(mesh.faces().len()) as u32);
    let (map, mut corners) = (pose.world_from_body(), mesh.triangle(face));
    corners.rotate_left(trial.rng.below(3));
    let [p, q, r] = corners.map(|p| map.apply(p));
    let normal = (q - p).cross(r - p);
    let up = DVec3::select(normal.cmpeq(DVec3::ZERO), DVec3::ZERO, normal.signum());
    let on = match kind {
        0 => p,
        1 => 0.5 * (p + q),
        _ => 0.5 * p + 0.25 * (q + r),
    };
    (normal.cross(up) == DVec3::ZERO).then_some((on, up))
}

/// A corner that is lowest along a direction, or half-way between two that are.
fn lowest(trial: &mut Trial<'_>, mesh: &Mesh, turn: DQuat, up: DVec3) -> DVec3 {
    let map = Pose { rotation: turn, translation: DVec3::ZERO }.world_from_body();
    let points: Vec<DVec3> = mesh.vertices().iter().map(|&p| map.apply(p)).collect();
    let least = points.iter().map(|p| p.dot(up)).fold(f64::INFINITY, f64::min);
    let low: Vec<DVec3> = points.into_iter().filter(|p| p.dot(up) == least).collect();
    0.5 * (*trial.pick(&low) + *trial.pick(&low))
}

/// Sunk into the middle of a slab's top or a channel's floor: as deep as it is low.
fn sunk(
    trial: &mut Trial<'_>,
    (name, small): &(&'static str, Model),
    k: u32,
    memory: &mut PairMemory,
) {
    let grounds = [
        ("slab", cuboid([0.0; 3], [4.0, 1.0, 4.0]), DVec3::new(2.0, 1.0, 2.0)),
        ("channel's floor", channel(), DVec3::new(1.5, 1.0, 1.0)),
    ];
    let tiny = trial.mapped(name, small.mesh(), |p| 0.5 * p);
    let Some(tiny) = tiny.and_then(|mesh| trial.model(name, mesh)) else { return };
    for (ground_name, ground, middle) in grounds {
        let Some(ground) = trial.model(ground_name, ground) else { continue };
        let box_of = tiny.bounds();
        let foot = DVec3::new(box_of.center().x, box_of.min.y, box_of.center().z);
        let depth = two_to_minus(k);
        let a = Placed { model: &ground, pose: Pose::IDENTITY };
        let b = Placed { model: &tiny, pose: Pose::at(middle - foot - depth * DVec3::Y) };
        let name = format!("{name} sunk into {ground_name}, 2^-{k}");
        trial.pair(name, a, b, Some(depth), memory);
    }
}
