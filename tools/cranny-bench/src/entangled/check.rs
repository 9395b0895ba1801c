//! Warm answers beside cold ones, verdicts and distances beside Coal's.

use cranny_narrow_phase::{Demand, PairMemory, Query, query};
use serde_json::Value;

use super::demand::Asked;
use super::ours::Outcome;
use super::stage::Stage;

/// Coal calls surfaces nearer than 1e-6 meeting, and its distances are measured between posed
/// triangles, relative to their coordinates. Smaller: such a gap fails. Larger: less is checked.
const COAL_TOLERANCE: f64 = 4e-6;

/// Frames whose answers differ.
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

/// What Coal says otherwise, beyond its tolerance.
pub(super) fn beside_coal(
    stage: &Stage,
    asked: Asked,
    ours: &[Option<Outcome>],
    coal: &[Option<Vec<Value>>],
) -> Option<String> {
    for (frame, (ours, coal)) in ours.iter().zip(coal).enumerate() {
        let (Some(ours), Some(coal)) = (ours, coal) else { continue };
        for ((&pair, k), coal) in stage.near[frame].iter().zip(0..).zip(coal) {
            let differs = match asked {
                Asked::Verdict => coal
                    .as_bool()
                    .filter(|&meets| meets != ours.meets[k])
                    .filter(|&meets| !meets || gap(stage, frame, pair) > COAL_TOLERANCE)
                    .map(|meets| format!("Coal says that they meet: {meets}")),
                Asked::Distance => ours.distances[k].zip(coal.as_f64()).and_then(|(own, coal)| {
                    let far = (own - coal.max(0.0)).abs() > COAL_TOLERANCE;
                    far.then(|| format!("distance {own}, Coal says {coal}"))
                }),
                Asked::Contacts | Asked::Regions => None,
            };
            if let Some(what) = differs {
                return Some(format!("frame {frame}, pair {pair}: {what}"));
            }
        }
    }
    None
}

/// Of a hundred verdicts of a peer, those that are not ours; `None` where it gave none.
pub(super) fn otherwise(ours: &[Option<Outcome>], peer: &[Option<Vec<bool>>]) -> Option<f64> {
    let (mut all, mut others) = (0, 0);
    for (ours, peer) in ours.iter().zip(peer) {
        let (Some(ours), Some(peer)) = (ours, peer) else { continue };
        all += peer.len();
        others += ours.meets.iter().zip(peer).filter(|(ours, peer)| ours != peer).count();
    }
    (all > 0).then(|| 100.0 * others as f64 / all as f64)
}

/// The distance, found without memory.
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
    }

    #[test]
    fn coal_is_believed_but_for_the_narrowest_gaps() {
        let cube = Cuboid { size: [1.0; 3] }.build().unwrap();
        let poses = [1.0 + 1e-6, 1.01].map(|x| Pose::at(DVec3::X * x)).into();
        let stage = Stage::new(Motion::of_twins(cube, poses, 0.1)).unwrap();
        let said = |asked, ours: &[Option<Outcome>], coal: Value| {
            let all = coal.as_array().unwrap().iter();
            let coal: Vec<_> = all.map(|one| Some(vec![one.clone()])).collect();
            beside_coal(&stage, asked, ours, &coal)
        };
        let apart = [outcome(0, false, Some(1e-6)), outcome(0, false, Some(0.01))];
        assert_eq!(said(Asked::Verdict, &apart, json!([true, false])), None);
        let told = said(Asked::Verdict, &apart, json!([true, true])).unwrap();
        assert!(told.starts_with("frame 1"), "{told}");
        assert_eq!(said(Asked::Distance, &apart, json!([-1.0, 0.01])), None);
        assert!(said(Asked::Distance, &apart, json!([0.0, 0.011])).is_some());
        let meet = [outcome(0, true, Some(0.0)), None];
        assert!(said(Asked::Verdict, &meet, json!([false, false])).is_some());
        assert_eq!(otherwise(&apart, &[Some(vec![true]), Some(vec![false])]), Some(50.0));
    }
}
