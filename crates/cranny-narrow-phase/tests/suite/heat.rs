//! What is seen of a search is what it does: an observed query has the same answer and the same
//! counters, and what its observer sees adds up to these.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Answer, Demand, Method, PairMemory, Placed, Query, SearchHeat, query, query_observed,
};
use cranny_shapes::{Comb, Cup, Torus};
use cranny_testkit::Rng;

use crate::solids::shape;

/// Frames of a slow motion, and what it is from one to the next.
const FRAMES: usize = 12;
const STEP: f64 = 0.004;

fn demands() -> [Demand; 5] {
    [
        Demand::Intersects,
        Demand::Distance { below: None },
        Demand::contacts(0.0),
        Demand::contacts(0.05),
        Demand::Regions { margin: 0.02 },
    ]
}

/// Rings that hang in each other come together: their middles are `last` apart in the end. Below
/// 0.4 they cross.
fn frames(last: f64) -> Vec<[Pose; 2]> {
    let rotation = DQuat::from_rotation_x(1.5);
    let apart = |k: usize| last + STEP * (FRAMES - 1 - k) as f64;
    let at = |k: usize| Pose { rotation, translation: DVec3::new(apart(k), 0.03, 0.02) };
    (0..FRAMES).map(|k| [Pose::IDENTITY, at(k)]).collect()
}

fn rings() -> [Model; 2] {
    [
        shape(Torus { major_segments: 48, minor_segments: 20, ..Torus::default() }),
        shape(Torus { major_segments: 40, minor_segments: 24, ..Torus::default() }),
    ]
}

/// Asks with an observer, and checks what it sees against the counters and an unobserved query.
fn observed<'m>(
    [a, b]: [Placed<'m>; 2],
    question: &Query,
    memories: &mut [PairMemory; 2],
) -> (Answer, SearchHeat<'m>) {
    let mut heat = SearchHeat::of([a.model, b.model]);
    let [seen, unseen] = memories;
    let answer = query_observed(a, b, question, seen, &mut heat).unwrap();
    assert_eq!(answer, query(a, b, question, unseen).unwrap(), "{question:?}");
    for body in 0..2 {
        assert_eq!(heat.clusters(body).iter().sum::<u64>(), answer.counters.cluster_tests);
        assert_eq!(heat.faces(body).iter().sum::<u64>(), answer.counters.triangle_tests);
        let boxes = answer.counters.node_tests + answer.counters.front_tested;
        let only_boxes = question.demand == Demand::Intersects && question.method == Method::Boxes;
        assert!(if only_boxes { heat.boxes(body) == boxes } else { heat.boxes(body) <= boxes });
    }
    (answer, heat)
}

#[test]
fn what_is_seen_adds_up_to_the_counters_and_changes_nothing_cold_and_warm() {
    let rings = rings();
    for demand in demands() {
        for method in [Method::Boxes, Method::Envelopes] {
            let question = Query::of(demand).by(method);
            let mut memories = [PairMemory::default(), PairMemory::default()];
            let mut seen = 0;
            for poses in frames(0.38) {
                let placed = [0, 1].map(|i| Placed { model: &rings[i], pose: poses[i] });
                let (answer, _) = observed(placed, &question, &mut memories);
                seen += answer.counters.triangle_tests + answer.counters.cluster_tests;
                observed(placed, &question, &mut Default::default());
            }
            assert!(seen > 0, "{question:?}");
        }
    }
}

#[test]
fn bodies_are_seen_in_the_order_of_the_caller() {
    let (cup, comb) = (shape(Cup::default()), shape(Comb::default()));
    let mut rng = Rng::new(5);
    let question = Query::of(Demand::contacts(0.1));
    let mut looked = 0;
    for _ in 0..20 {
        let shift = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let placed = [
            Placed { model: &cup, pose: Pose::IDENTITY },
            Placed { model: &comb, pose: Pose::at(shift) },
        ];
        let [a, b] = placed;
        let (_, heat) = observed([a, b], &question, &mut Default::default());
        let (_, swapped) = observed([b, a], &question, &mut Default::default());
        for body in 0..2 {
            assert_eq!(heat.looked_at(body), swapped.looked_at(1 - body));
        }
        looked += heat.looked_at(0).iter().sum::<u64>();
    }
    assert!(looked > 0);
}

#[test]
fn frames_that_follow_others_look_at_less_than_such_from_nothing() {
    let rings = rings();
    let question = Query::of(Demand::Distance { below: None });
    let mut memories = [PairMemory::default(), PairMemory::default()];
    let mut looked = [0, 0];
    // What is kept is made in the second.
    for (k, poses) in frames(0.42).into_iter().enumerate() {
        let placed = [0, 1].map(|i| Placed { model: &rings[i], pose: poses[i] });
        let heats = [
            observed(placed, &question, &mut Default::default()).1,
            observed(placed, &question, &mut memories).1,
        ];
        for (looked, heat) in looked.iter_mut().zip(heats).filter(|_| k > 1) {
            *looked += heat.boxes(0) + heat.looked_at(0).iter().sum::<u64>();
        }
    }
    let [from_nothing, next] = looked;
    assert!(2 * next < from_nothing, "{next} beside {from_nothing}");
}
