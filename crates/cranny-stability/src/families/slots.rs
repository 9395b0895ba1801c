//! Bodies that fit exactly: pegs in slots, rakes in rakes, boxes flush with boxes.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_narrow_phase::{PairMemory, Placed};
use cranny_testkit::bodies::{block_without, channel, cuboid, quarter_turns, rake};

use super::{DISTANCE_ERROR, PAIR_FAILS};
use crate::bodies::two_to_minus;
use crate::family::Family;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "slots",
    question: "A peg as wide as its slot, or 2^-10 to 2^-50 narrower or wider, slides along the walls; a rake's teeth \
            fill the gaps of another; boxes slide in one plane and past each other's edges.",
    made: "Faces are co-planar by construction, all coordinates dyadic, poses turn axes to axes; exact rationals \
           judge.",
    fails: PAIR_FAILS,
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let turns = quarter_turns();
    let mut memory = PairMemory::default();
    for _ in 0..trial.variants {
        for k in (10..=50).step_by(4) {
            let hair = two_to_minus(k);
            for (what, play) in [("exact", 0.0), ("narrow", hair), ("wide", -hair)] {
                let world = *trial.pick(&turns);
                let aside = *trial.pick(&[0.0, hair, -hair, 0.5 * hair]);
                peg(trial, world, play, aside, &format!("peg, {what}, 2^-{k}"), &mut memory);
            }
            let aside = *trial.pick(&[0.0, hair, -hair]);
            let world = *trial.pick(&turns);
            rakes(trial, world, aside, &format!("rakes, aside by {aside:e}"), &mut memory);
            boxes(trial, world, hair, k, &mut memory);
        }
    }
}

/// Both turned the same way: B's place is given in A's frame.
fn placed_in(world: DQuat, at: DVec3) -> [Pose; 2] {
    let map = Pose { rotation: world, translation: DVec3::ZERO }.world_from_body();
    [DVec3::ZERO, map.apply(at)].map(|translation| Pose { rotation: world, translation })
}

fn peg(
    trial: &mut Trial<'_>,
    world: DQuat,
    play: f64,
    aside: f64,
    name: &str,
    memory: &mut PairMemory,
) {
    let peg = cuboid([0.0; 3], [1.0 - play, 1.5, 1.0]);
    // Above the floor, on it; half-way along, flush with the end, half out.
    let (y, z) = (*trial.pick(&[1.0, 1.25, 2.0]), *trial.pick(&[0.5, 1.0, 1.5]));
    let (slot, at) = match trial.rng.below(2) {
        0 => (channel(), DVec3::new(1.0 + aside, y, z)),
        _ => (block_without([3, 3, 2], &[[1, 1, 1]]), DVec3::new(1.0 + aside, 1.0, 1.0)),
    };
    let (Some(slot), Some(peg)) = (trial.model("slot", slot), trial.model("peg", peg)) else {
        return;
    };
    let [pose_a, pose_b] = placed_in(world, at);
    let (a, b) = (Placed { model: &slot, pose: pose_a }, Placed { model: &peg, pose: pose_b });
    trial.pair(name.to_owned(), a, b, None, memory);
}

fn rakes(trial: &mut Trial<'_>, world: DQuat, aside: f64, name: &str, memory: &mut PairMemory) {
    let Some(rake) = trial.model("rake", rake()) else { return };
    // Turned over about z, the other rake's teeth point down, into the gaps.
    let over = DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0);
    let y = *trial.pick(&[4.0, 4.5, 6.0]);
    let at = DVec3::new(6.0 + aside, y, *trial.pick(&[0.0, 0.5, 1.0]));
    let [pose_a, pose_b] = placed_in(world, at);
    let pose_b = Pose { rotation: (world * over).normalize(), ..pose_b };
    let (a, b) = (Placed { model: &rake, pose: pose_a }, Placed { model: &rake, pose: pose_b });
    trial.pair(name.to_owned(), a, b, None, memory);
}

/// Beside each other on one plane: face to face, past an edge by a hair, corner to corner.
fn boxes(trial: &mut Trial<'_>, world: DQuat, hair: f64, k: u32, memory: &mut PairMemory) {
    let unit = cuboid([0.0; 3], [1.0; 3]);
    let Some(unit) = trial.model("box", unit) else { return };
    let mut step = || *trial.pick(&[0.0, 0.5, 1.0, 1.0 + hair, 1.0 - hair]);
    let at = DVec3::new(step(), step(), step());
    let [pose_a, pose_b] = placed_in(world, at);
    let (a, b) = (Placed { model: &unit, pose: pose_a }, Placed { model: &unit, pose: pose_b });
    let steps = at.to_array().map(|s| match s {
        1.0 => "1".to_owned(),
        s if s > 1.0 => format!("1 + 2^-{k}"),
        s if s > 0.5 => format!("1 - 2^-{k}"),
        s => s.to_string(),
    });
    trial.pair(format!("boxes, moved by {}", steps.join(", ")), a, b, None, memory);
}
