//! Open combs: every prong of one passes closely over every prong of the other, so that all pairs
//! are near, and few touch. What a frame costs with memory must follow the few.

use std::f64::consts::FRAC_PI_2;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_shapes::Comb;

use crate::solids::shape;

const PITCH: f64 = 0.2;
const GAP: f64 = 0.1;
const BAR: f64 = 0.2;
const DEPTH: f64 = 0.1;

fn comb(teeth: u32) -> Model {
    shape(Comb {
        teeth,
        tooth_length: PITCH * f64::from(teeth),
        gap: GAP,
        bar: BAR,
        depth: DEPTH,
        ..Comb::default()
    })
}

/// The second comb across the first, its nearest prong `gap` above, the others rising by `tilt`
/// radians.
fn across(teeth: u32, gap: f64, tilt: f64, slide: f64) -> Pose {
    let width = PITCH * f64::from(teeth) - GAP;
    let turn = DQuat::from_rotation_x(tilt) * DQuat::from_rotation_z(FRAC_PI_2);
    let lift = DEPTH + gap + 0.5 * width * tilt;
    // Half a gap from the bars, which touch nothing.
    let beyond = BAR + 0.5 * (GAP + width);
    Pose { rotation: turn.normalize(), translation: DVec3::new(beyond + slide, beyond, lift) }
}

/// What a frame of a slow slide costs, and what it finds.
#[derive(Debug)]
struct Cost {
    tests: u64,
    contacts: usize,
    regions: usize,
}

/// The mean of twenty frames, after as many to get used to the motion.
fn cost(teeth: u32, gap: f64, tilt: f64, demand: Demand) -> Cost {
    let model = comb(teeth);
    let mut memory = PairMemory::default();
    let mut cost = Cost { tests: 0, contacts: 0, regions: 0 };
    for frame in 0..40 {
        let a = Placed { model: &model, pose: Pose::IDENTITY };
        let b = Placed { model: &model, pose: across(teeth, gap, tilt, 1e-4 * f64::from(frame)) };
        let answer = query(a, b, &Query::of(demand), &mut memory).unwrap();
        if frame >= 20 {
            cost.tests += answer.counters.node_tests + answer.counters.triangle_tests;
        }
        (cost.contacts, cost.regions) = (answer.contacts.len(), answer.regions.len());
    }
    cost.tests /= 20;
    cost
}

const DEMANDS: [Demand; 4] = [
    Demand::Intersects,
    Demand::Distance { below: None },
    Demand::contacts(0.012),
    Demand::Regions { margin: 0.0 },
];

/// The nearest prong alone touches, or nearly: n places among n² pairs of prongs. Of 16 and 64
/// prongs, regions take 156 and 844 tests, more than five times as many; 32 and 128 take 392 and
/// 1,871.
#[test]
fn the_cost_of_open_combs_follows_their_contacts_not_their_prongs_squared() {
    for gap in [0.01, -0.001] {
        for demand in DEMANDS {
            let [few, many] = [32, 128].map(|teeth| cost(teeth, gap, 0.02, demand));
            let found = format!("{demand:?}, {gap} apart: {few:?}, then {many:?}");
            assert!(many.tests <= 5 * few.tests.max(8), "four times the prongs; {found}");
            if let Demand::Regions { .. } = demand {
                let expected = if gap < 0.0 { [32, 128] } else { [0, 0] };
                assert_eq!([few.regions, many.regions], expected, "{found}");
            }
            if let Demand::Contacts { .. } = demand {
                assert!(few.contacts >= 32 && many.contacts >= 128, "{found}");
                assert!(many.contacts <= 5 * few.contacts, "{found}");
            }
        }
    }
}

/// The honest worst case: all n² places touch, and are reported; a verdict stays as quick as it
/// was.
#[test]
fn combs_that_touch_everywhere_cost_what_they_tell() {
    let [few, many] =
        [8, 32].map(|teeth| cost(teeth, -0.001, 0.0, Demand::Regions { margin: 0.0 }));
    assert_eq!([few.regions, many.regions], [64, 1024]);
    assert!(many.tests <= 20 * few.tests, "sixteen times the places: {few:?}, then {many:?}");
    let verdict = cost(32, -0.001, 0.0, Demand::Intersects);
    assert!(verdict.tests <= 8, "{verdict:?}");
}
