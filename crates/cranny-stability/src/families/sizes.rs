//! Small and large, near the origin and far from it, small on large.

use cranny_exact::{DVec3, Pose};
use cranny_narrow_phase::{PairMemory, Placed};

use super::{DISTANCE_ERROR, PAIR_FAILS};
use crate::bodies::{hollows, small_bodies};
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "sizes",
    question: "A small convex body at a corner, an edge or a face of one with concavities, both 10^-6 to 10^6 large; both \
            up to 10^6 of their sizes away from the origin; or one up to 10^12 times as large as the other.",
    made: "Turned anyhow, scaled, moved and rounded, then meshes are built, so that poses round nothing; exact \
           rationals judge.",
    fails: PAIR_FAILS,
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let mut memory = PairMemory::default();
    for _ in 0..trial.variants {
        for power in -6..=6 {
            let size = 10f64.powi(power);
            one(trial, [size, size], 0.0, &format!("size 10^{power}"), &mut memory);
            let far = 10f64.powi(trial.rng.between(0, 6));
            one(trial, [size, size], far, &format!("10^{power}, {far:.0e} sizes off"), &mut memory);
            one(trial, [1e6, size], 0.0, &format!("10^{power} on 10^6"), &mut memory);
            one(trial, [size, 1e6], 0.0, &format!("10^6 on 10^{power}"), &mut memory);
        }
    }
}

/// A feature of the second on a feature of the first, some gap between them.
fn one(trial: &mut Trial<'_>, sizes: [f64; 2], far: f64, name: &str, memory: &mut PairMemory) {
    let (name_a, a) = trial.pick(&hollows()).clone();
    let small = small_bodies(trial);
    let (name_b, b) = trial.pick(&small).clone();
    let (frame_a, frame_b) = (trial.frame(), trial.frame());
    let face = a.faces()[trial.rng.below(a.faces().len())].map(|v| a.vertices()[v as usize]);
    let on = match trial.rng.below(3) {
        0 => face[0],
        1 => 0.5 * (face[0] + face[1]),
        _ => 0.5 * face[0] + 0.25 * (face[1] + face[2]),
    };
    // B's corner that is lowest over the face.
    let up = frame_a * (face[1] - face[0]).cross(face[2] - face[0]).normalize();
    let height = |p: &DVec3| (frame_b * *p).dot(up);
    let lowest = b.vertices().iter().copied().min_by(|p, q| height(p).total_cmp(&height(q)));
    let at = lowest.unwrap_or(DVec3::ZERO);
    let least = sizes[0].min(sizes[1]);
    let gap = match trial.rng.below(4) {
        0 => 0.0,
        _ => least * 10f64.powi(trial.rng.between(-16, -1)) * trial.rng.unit(),
    };
    let direction = trial.rng.direction();
    let by = far * least * direction;
    // The place where they meet is at `by`: what is small there keeps its coordinates.
    let name = format!("{name}: {name_b} at {name_a}, {:.0e} off", gap / least);
    let lift = gap * up;
    let a = trial.mapped(&name, &a, |p| by + sizes[0] * (frame_a * (p - on)));
    let b = trial.mapped(&name, &b, |p| by + (sizes[1] * (frame_b * (p - at)) + lift));
    let (Some(a), Some(b)) = (a, b) else { return };
    let models = (trial.model(&name, a), trial.model(&name, b));
    let (Some(a), Some(b)) = models else { return };
    let here = |model| Placed { model, pose: Pose::IDENTITY };
    trial.pair(name, here(&a), here(&b), None, memory);
}
