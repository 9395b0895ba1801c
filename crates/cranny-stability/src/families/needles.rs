//! Needles and slivers: closed bodies a million times longer than they are wide, and more.

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_narrow_phase::{PairMemory, Placed};

use super::{DISTANCE_ERROR, PAIR_FAILS};
use crate::bodies::{hollows, tetrahedron_over};
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "needles",
    question: "Needles (two of three sides short) and slivers (flat), 10^3 to 10^9 times as long as thin, near, in or \
            through each other and bodies with concavities, a tip or an edge 10^-15 to 1 lengths away, or on them.",
    made: "Turned anyhow and rounded, then meshes are built, so that poses round nothing; exact rationals judge.",
    fails: PAIR_FAILS,
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let hollows = hollows();
    let mut memory = PairMemory::default();
    for _ in 0..trial.variants {
        for power in 3..=9 {
            let width = 10f64.powi(-power);
            for kind in 0..4 {
                let (Some(thin), frame) = (thin(trial, width, kind < 2), trial.frame()) else {
                    continue;
                };
                let (other, what) = if kind % 2 == 0 {
                    let needle = trial.rng.below(2) == 0;
                    let other = self::thin(trial, width, needle);
                    (other, "thin")
                } else {
                    let (what, body) = trial.pick(&hollows).clone();
                    (trial.mapped(what, &body, |p| 0.25 * p), what)
                };
                let Some(other) = other else { continue };
                let other_frame = trial.frame();
                let baked = (
                    trial.baked(what, &other, other_frame, DVec3::ZERO),
                    trial.baked("thin", &thin, frame, DVec3::ZERO),
                );
                let (Some(other), Some(thin)) = baked else { continue };
                let (on, up) = spot(trial, &other);
                let at = lowest(trial, &thin, up);
                let gap = match trial.rng.below(4) {
                    0 => 0.0,
                    _ => 10f64.powi(trial.rng.between(-15, 0)) * trial.rng.unit(),
                };
                let name = format!(
                    "{} of 10^-{power} at {what}, {gap:.0e} off",
                    ["needle", "needle", "sliver", "sliver",][kind]
                );
                let moved = trial.baked(&name, &thin, DMat3::IDENTITY, on - at + gap * up);
                let Some(thin) = moved else { continue };
                let models = (trial.model(&name, other), trial.model(&name, thin));
                let (Some(a), Some(b)) = models else { continue };
                let here = |model| Placed { model, pose: Pose::IDENTITY };
                trial.pair(name, here(&a), here(&b), None, &mut memory);
            }
        }
    }
}

/// The corner that is lowest along a direction, or a point on an edge to the next one.
fn lowest(trial: &mut Trial<'_>, mesh: &Mesh, up: DVec3) -> DVec3 {
    let mut corners = mesh.vertices().to_vec();
    corners.sort_by(|p, q| p.dot(up).total_cmp(&q.dot(up)));
    match trial.rng.below(2) {
        0 => corners[0],
        _ => corners[0].lerp(corners[1], 0.5),
    }
}

/// A tetrahedron of length 1: a needle as wide as thick, or a sliver as wide as long.
fn thin(trial: &mut Trial<'_>, width: f64, needle: bool) -> Option<Mesh> {
    let mut random = || trial.rng.unit();
    let breadth = if needle { width } else { 1.0 };
    let mut corner = |x: f64| DVec3::new(x, breadth * random(), width * random());
    tetrahedron_over([corner(0.0), corner(1.0), corner(0.5), corner(0.25)])
}

/// A corner, the middle of an edge or of a face (rounded), and the face's normal.
fn spot(trial: &mut Trial<'_>, mesh: &Mesh) -> (DVec3, DVec3) {
    let [i, j, k] = mesh.faces()[trial.rng.below(mesh.faces().len())];
    let [p, q, r] = [i, j, k].map(|v| mesh.vertices()[v as usize]);
    let on = match trial.rng.below(3) {
        0 => p,
        1 => 0.5 * (p + q),
        _ => (p + q + r) / 3.0,
    };
    (on, (q - p).cross(r - p).normalize_or(DVec3::Z))
}
