//! Two proxies whose fat boxes overlap: whether they are a pair, and until when they will be.

use crate::index::Found;
use crate::slots::{Slot, Slots};
use cranny_exact::Aabb;

/// The part of a slack that is counted on: sums of steps, and the slack itself, are rounded. Larger
/// than one less rounding would be wrong, and much smaller wastes tests.
const COUNTED_ON: f64 = 0.999;

/// Two proxies whose fat boxes overlap and whose kinds can be a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// The lower slot first.
    pub(super) slots: [Slot; 2],
    /// Whether the boxes overlapped when they were last judged.
    pub(super) held: bool,
    /// The travel at which they may cease to overlap, or begin to.
    due: f64,
}

impl Candidate {
    /// A new candidate, judged; a pair is added to `found`.
    pub(super) fn found(a: Slot, b: Slot, travel: f64, slots: &Slots, found: &mut Found) -> Self {
        let mut candidate = Self { slots: [a.min(b), a.max(b)], held: false, due: travel };
        candidate.judge(travel, slots);
        found.counters.box_tests += 1;
        if candidate.held {
            found.began.push(slots.key(a, b));
        }
        candidate
    }

    pub(super) fn is_due(&self, travel: f64) -> bool {
        // No number, from infinite boxes: always.
        travel >= self.due || self.due.is_nan()
    }

    /// Looks at the boxes, and how far they can go before it is worth looking again.
    pub(super) fn judge(&mut self, travel: f64, slots: &Slots) {
        let [a, b] = self.slots.map(|slot| &slots.boxes[slot.index()]);
        let overlap = overlap(a, b);
        // Infinite boxes may have none that is a number.
        self.held = if overlap.is_nan() { a.overlaps(b) } else { overlap >= 0.0 };
        // Both may move: towards each other, or apart.
        self.due = travel + 0.5 * COUNTED_ON * overlap.abs();
    }
}

/// By how much two boxes overlap along the axis on which they do least; negative where they are
/// apart. Rounding never changes its sign.
fn overlap(a: &Aabb, b: &Aabb) -> f64 {
    let overlaps = a.max.min(b.max) - a.min.max(b.min);
    // Of `NaN` and a number, `min` takes the number.
    let [x, y, z] = overlaps.to_array();
    if overlaps.is_nan() { f64::NAN } else { x.min(y).min(z) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    #[test]
    fn the_least_overlap_counts() {
        let a = Aabb { min: DVec3::ZERO, max: DVec3::new(4.0, 4.0, 4.0) };
        let b =
            |x: f64, y: f64| Aabb { min: DVec3::new(x, y, 1.0), max: DVec3::new(9.0, 9.0, 2.0) };
        assert_eq!(overlap(&a, &b(3.5, 2.0)), 0.5);
        assert_eq!(overlap(&a, &b(4.0, 2.0)), 0.0);
        assert_eq!(overlap(&a, &b(6.0, 5.0)), -2.0);
        let far = Aabb { min: DVec3::INFINITY, max: DVec3::INFINITY };
        assert!(overlap(&far, &far).is_nan() && far.overlaps(&far));
    }
}
