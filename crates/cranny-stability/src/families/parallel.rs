//! Faces that are nearly parallel.

use cranny_exact::{DMat3, DQuat, DVec3, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::{PairMemory, Placed};
use cranny_testkit::bodies::{angle, channel, cuboid};

use super::{DISTANCE_ERROR, PAIR_FAILS};
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "parallel",
    question: "A box over a slab, in a channel or in the corner of an L, turned by 10^-12 to 10^-3 radians from flush, so \
            near that the angle decides whether it touches: both as a pose, and turned before the mesh was built.",
    made: "Of a posed pair, the first in the pair's own order stays where its mesh has it, so that the oracle reads \
           the same rounded points; exact rationals judge.",
    fails: PAIR_FAILS,
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let grounds = [
        ("slab", cuboid([-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]), DVec3::ZERO),
        ("channel", channel(), DVec3::new(1.5, 1.0, 1.0)),
        ("L", angle(), DVec3::new(1.5, 1.0, 0.5)),
    ];
    let placed = |(name, mesh, on)| Some((name, trial.mapped(name, &mesh, |p| p - on)?));
    let grounds: Vec<(&str, Mesh)> = grounds.into_iter().filter_map(placed).collect();
    let half = 0.375;
    let cube = cuboid([-half, 0.0, -half], [half, 2.0 * half, half]);
    let mut memory = PairMemory::default();
    for _ in 0..trial.variants {
        for power in (3..=12).flat_map(|power| [power; 2]) {
            let angle = 10f64.powi(-power) * (1.5 + trial.rng.unit());
            let (ground_name, ground) = trial.pick(&grounds).clone();
            let world = trial.frame();
            let turn = trial.tilt(angle);
            // The lowest corner comes to lie on the ground, a few roundings off, or as far as the
            // angle lifts.
            let lowest = cube.vertices().iter().map(|&p| (turn * p).y).fold(0.0, f64::min);
            let hair = f64::from(trial.rng.between(-4, 4)) * 0.25 * f64::EPSILON;
            let gap = *trial.pick(&[0.0, 0.0, 0.0, -1.0, -0.5, 0.5]) * lowest.abs() - lowest + hair;
            let aside = 0.1 * DVec3::new(trial.rng.unit(), 0.0, trial.rng.unit());
            let by = aside + gap * DVec3::Y;
            let name = format!("{angle:.0e} rad over {ground_name}, {gap:.1e} off");

            let tilted = trial.mapped(&name, &cube, |p| world * (turn * p + by));
            let turned = trial.baked(&name, &ground, world, DVec3::ZERO);
            let tilted = tilted.and_then(|mesh| trial.model(&name, mesh));
            let turned = turned.and_then(|mesh| trial.model(&name, mesh));
            if let (Some(a), Some(b)) = (turned, tilted) {
                let here = |model| Placed { model, pose: Pose::IDENTITY };
                trial.pair(format!("{name}, baked"), here(&a), here(&b), None, &mut memory);
            }

            let models = (trial.model(&name, ground), trial.model(&name, cube.clone()));
            if let (Some(a), Some(b)) = models {
                let pose = Pose { rotation: turn, translation: by };
                let [a, b] = first_at_rest(&a, &b, pose);
                trial.pair(format!("{name}, posed"), a, b, None, &mut memory);
            }
        }
    }
}

/// The pair at a relative pose, such that the first in the pair's own order, that of digests, is at
/// rest.
fn first_at_rest<'a>(a: &'a Model, b: &'a Model, a_from_b: Pose) -> [Placed<'a>; 2] {
    if a.digest() < b.digest() {
        return [Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose: a_from_b }];
    }
    let back: DQuat = a_from_b.rotation.conjugate();
    let inverse = DMat3::from_quat(back) * -a_from_b.translation;
    [
        Placed { model: a, pose: Pose { rotation: back, translation: inverse } },
        Placed { model: b, pose: Pose::IDENTITY },
    ]
}
