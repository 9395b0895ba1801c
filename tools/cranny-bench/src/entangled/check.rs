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

/// The distance, found without memory.
fn gap(stage: &Stage, frame: usize, pair: usize) -> f64 {
    let [a, b] = stage.placed(frame, pair);
    let whole = Query::of(Demand::Distance { below: None });
    let answer = query(a, b, &whole, &mut PairMemory::default());
    answer.ok().and_then(|answer| answer.distance).unwrap_or(f64::INFINITY)
}
