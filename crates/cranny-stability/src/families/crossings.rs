//! Edge against edge, at right angles and nearly parallel.

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_narrow_phase::{PairMemory, Placed};

use super::contacts::lift;
use super::{DISTANCE_ERROR, PAIR_FAILS};
use crate::bodies::{ridges, tetrahedron_over, two_to_minus};
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "crossings",
    question: "The edge of a blade lies across the ridges of a block, at a slope of 1 to 2^-20 to them, lifted by 2^-10 \
            to 2^-50, touching in one point, or sunk in by as much; or it just misses the ridge's end.",
    made: "Coordinates are dyadic, so nothing rounds; then all is turned anyhow and rounded before meshes are built. \
           Exact rationals judge both.",
    fails: PAIR_FAILS,
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let Some(block) = trial.model("ridges", ridges()) else { return };
    let mut memory = PairMemory::default();
    for _ in 0..trial.variants {
        for k in (10..=50).step_by(4) {
            for side in [1.0, 0.0, -1.0] {
                let j = trial.rng.between(0, 20) as u32;
                let slope = two_to_minus(j);
                let along = DVec3::new(slope, 0.0, 1.0);
                let aside = 0.5 * DVec3::X;
                let [p, q] = [-along, along];
                let blade = tetrahedron_over([p, q, DVec3::Y + aside, DVec3::Y - aside]);
                let Some(blade) = blade.and_then(|mesh| trial.model("blade", mesh)) else {
                    continue;
                };
                // From −9/8 to 9/8 of the way to the blade's ends: beyond them, it misses.
                let shift = 0.125 * f64::from(trial.rng.between(-9, 9)) * slope;
                let ridge = *trial.pick(&[1.0, 3.0]);
                let height = 2.0 + side * two_to_minus(k);
                let z = *trial.pick(&[0.0, 2.0, 4.0]);
                let pose = Pose::at(DVec3::new(ridge + shift, height, z));
                let a = Placed { model: &block, pose: Pose::IDENTITY };
                let b = Placed { model: &blade, pose };
                let name = format!("slope 2^-{j}, {}", lift(side, k));
                trial.pair(name.clone(), a, b, None, &mut memory);

                let frame = trial.frame();
                let mut turned = |mesh, by| {
                    let moved = trial.baked(&name, mesh, DMat3::IDENTITY, by)?;
                    let turned = trial.baked(&name, &moved, frame, DVec3::ZERO)?;
                    trial.model(&name, turned)
                };
                let ground = turned(block.mesh(), DVec3::ZERO);
                let edge = turned(blade.mesh(), pose.translation);
                let (Some(a), Some(b)) = (ground, edge) else { continue };
                let here = |model| Placed { model, pose: Pose::IDENTITY };
                trial.pair(format!("{name}, turned"), here(&a), here(&b), None, &mut memory);
            }
        }
    }
}
