//! Warm answers beside cold ones, verdicts and distances beside Coal's.

use cranny_narrow_phase::{Demand, PairMemory, Query, query};
use serde_json::Value;

use super::demand::DemandKind;
use super::ours::Outcome;
use super::stage::Stage;

/// Largest difference of distances, and gap at which Coal may report a collision: it does so for
/// gaps below 1e-6. Smaller: such gaps fail. Larger: errors of ours pass.
const COAL_TOLERANCE: f64 = 4e-6;

/// Returns the number of frames that both answered about.
pub(super) fn compared<A, B>(ours: &[Option<A>], others: &[Option<B>]) -> usize {
    ours.iter().zip(others).filter(|(a, b)| a.is_some() && b.is_some()).count()
}

/// Returns the frames whose answers differ.
pub(super) fn warm_beside_cold(
    warm: &[Option<Outcome>],
    cold: &[Option<Outcome>],
) -> Option<String> {
    let differs = |(w, c): (&Option<Outcome>, &Option<Outcome>)| {
        w.as_ref().zip(c.as_ref()).is_some_and(|(w, c)| w.digest != c.digest)
    };
    let frames: Vec<usize> =
        (0..warm.len()).filter(|&frame| differs((&warm[frame], &cold[frame]))).collect();
    (!frames.is_empty()).then(|| format!("warm answers differ from cold ones in frames {frames:?}"))
}

/// Returns the first answer of Coal that differs beyond its tolerance.
pub(super) fn beside_coal(
    stage: &Stage,
    kind: DemandKind,
    ours: &[Option<Outcome>],
    coal: &[Option<Vec<Value>>],
) -> Option<String> {
    for (frame, (ours, coal)) in ours.iter().zip(coal).enumerate() {
        let (Some(ours), Some(coal)) = (ours, coal) else { continue };
        for ((&pair, k), coal) in stage.near[frame].iter().zip(0..).zip(coal) {
            let differs = match kind {
                DemandKind::Verdict => coal
                    .as_bool()
                    .filter(|&meets| meets != ours.meets[k])
                    .filter(|&meets| !meets || gap(stage, frame, pair) > COAL_TOLERANCE)
                    .map(|meets| format!("surfaces meet in Coal: {meets}")),
                DemandKind::Distance => {
                    ours.distances[k].zip(coal.as_f64()).and_then(|(own, coal)| {
                        let far = (own - coal.max(0.0)).abs() > COAL_TOLERANCE;
                        far.then(|| format!("distance {own}, in Coal {coal}"))
                    })
                }
                DemandKind::Contacts | DemandKind::Regions => None,
            };
            if let Some(what) = differs {
                return Some(format!("frame {frame}, pair {pair}: {what}"));
            }
        }
    }
    None
}

/// Returns the percentage of a peer's verdicts that differ from ours; `None` without verdicts.
pub(super) fn otherwise(ours: &[Option<Outcome>], peer: &[Option<Vec<bool>>]) -> Option<f64> {
    let (mut all, mut others) = (0, 0);
    for (ours, peer) in ours.iter().zip(peer) {
        let (Some(ours), Some(peer)) = (ours, peer) else { continue };
        all += peer.len();
        others += ours.meets.iter().zip(peer).filter(|(ours, peer)| ours != peer).count();
    }
    (all > 0).then(|| 100.0 * others as f64 / all as f64)
}

/// Returns the distance, computed without memory.
fn gap(stage: &Stage, frame: usize, pair: usize) -> f64 {
    let [a, b] = stage.placed(frame, pair);
    let whole = Query::of(Demand::Distance { below: None });
    let answer = query(a, b, &whole, &mut PairMemory::default());
    answer.ok().and_then(|answer| answer.distance).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entangled::stage::Motion;
    use cranny_exact::{DVec3, Pose};
    use cranny_shapes::Cuboid;
    use serde_json::json;

    fn outcome(digest: u64, meets: bool, distance: Option<f64>) -> Option<Outcome> {
        Some(Outcome {
            digest,
            meets: vec![meets],
            distances: vec![distance],
            ..Outcome::default()
        })
    }

    #[test]
    fn frames_whose_hashes_differ_are_named() {
        let warm = [outcome(1, true, None), outcome(2, true, None), outcome(3, true, None)];
        let cold = [None, outcome(2, true, None), outcome(4, true, None)];
        assert!(warm_beside_cold(&warm, &cold).unwrap().ends_with("[2]"));
        assert_eq!(warm_beside_cold(&warm, &warm), None);
        assert_eq!(compared(&warm, &cold), 2);
    }

    #[test]
    fn only_the_narrowest_gaps_may_meet_in_coal() {
        let cube = Cuboid { size: [1.0; 3] }.build().unwrap();
        let poses = [1.0 + 1e-6, 1.01].map(|x| Pose::at(DVec3::X * x)).into();
        let stage = Stage::new(Motion::of_twins(cube, poses, 0.1)).unwrap();
        let difference = |kind, ours: &[Option<Outcome>], coal: Value| {
            let all = coal.as_array().unwrap().iter();
            let coal: Vec<_> = all.map(|one| Some(vec![one.clone()])).collect();
            beside_coal(&stage, kind, ours, &coal)
        };
        let apart = [outcome(0, false, Some(1e-6)), outcome(0, false, Some(0.01))];
        assert_eq!(difference(DemandKind::Verdict, &apart, json!([true, false])), None);
        let found = difference(DemandKind::Verdict, &apart, json!([true, true])).unwrap();
        assert!(found.starts_with("frame 1"), "{found}");
        assert_eq!(difference(DemandKind::Distance, &apart, json!([-1.0, 0.01])), None);
        assert!(difference(DemandKind::Distance, &apart, json!([0.0, 0.011])).is_some());
        let meet = [outcome(0, true, Some(0.0)), None];
        assert!(difference(DemandKind::Verdict, &meet, json!([false, false])).is_some());
        assert_eq!(otherwise(&apart, &[Some(vec![true]), Some(vec![false])]), Some(50.0));
    }
}
