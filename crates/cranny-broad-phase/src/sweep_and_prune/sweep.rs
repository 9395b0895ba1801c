//! Finding the pairs of boxes that have just come: one walk along a sorted axis.

use super::axis::{Axis, End};
use crate::slots::{Slot, Slots};
use cranny_exact::{Aabb, DVec3};

/// The faces of a box along the two axes that are not walked, side by side for fast scanning.
#[derive(Clone, Copy, Debug)]
struct Open {
    slot: Slot,
    lower: [f64; 2],
    upper: [f64; 2],
}

impl Open {
    fn new(slot: Slot, aabb: &Aabb, walked: usize) -> Self {
        let across = |v: DVec3| match walked {
            0 => [v.y, v.z],
            1 => [v.x, v.z],
            _ => [v.x, v.y],
        };
        Self { slot, lower: across(aabb.min), upper: across(aabb.max) }
    }

    fn overlaps(&self, other: &Self) -> bool {
        // `&` rather than `&&`: four independent comparisons are cheaper than guessed branches.
        (self.lower[0] <= other.upper[0])
            & (other.lower[0] <= self.upper[0])
            & (self.lower[1] <= other.upper[1])
            & (other.lower[1] <= self.upper[1])
    }
}

/// The boxes whose lower end has been passed and whose upper end has not.
#[derive(Debug, Default)]
struct Front {
    open: Vec<Open>,
    /// Index in `open` by slot.
    seat: Vec<u32>,
}

impl Front {
    fn with_slots(slots: usize) -> Self {
        Self { open: Vec::new(), seat: vec![0; slots] }
    }

    fn enter(&mut self, open: Open) {
        self.seat[open.slot.index()] = seat_number(self.open.len());
        self.open.push(open);
    }

    fn leave(&mut self, slot: Slot) {
        let seat = self.seat[slot.index()];
        self.open.swap_remove(seat as usize);
        if let Some(moved) = self.open.get(seat as usize) {
            self.seat[moved.slot.index()] = seat;
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "there are fewer than 2^32 slots")]
fn seat_number(seat: usize) -> u32 {
    seat as u32
}

/// Calls `found` once for every overlapping pair of listed boxes of which at least one is fresh and
/// which can be a pair. Returns the number of box tests.
///
/// The axes must be sorted. The one is walked on which the fewest intervals meet; that number is
/// counted, not guessed (three walks without any test).
pub(super) fn sweep(
    axes: &[Axis; 3],
    slots: &Slots,
    is_fresh: &[bool],
    mut found: impl FnMut(Slot, Slot),
) -> u64 {
    let meetings = [0, 1, 2].map(|axis| count_meetings(axes[axis].ends(), is_fresh));
    let walked = (0..3).min_by_key(|&axis| meetings[axis]).unwrap_or(0);
    let mut fresh = Front::with_slots(is_fresh.len());
    let mut settled = Front::with_slots(is_fresh.len());
    for &end in axes[walked].ends() {
        let slot = end.slot();
        let fresh_here = is_fresh[slot.index()];
        if end.is_upper() {
            if fresh_here {
                fresh.leave(slot);
            } else {
                settled.leave(slot);
            }
            continue;
        }
        let open = Open::new(slot, &slots.boxes[slot.index()], walked);
        let others: &[Open] = if fresh_here { &settled.open } else { &[] };
        for other in fresh.open.iter().chain(others) {
            if open.overlaps(other) && slots.can_pair(slot, other.slot) {
                found(slot, other.slot);
            }
        }
        if fresh_here { fresh.enter(open) } else { settled.enter(open) }
    }
    meetings[walked]
}

/// How many intervals meet a fresh one along a sorted axis, each two counted once.
fn count_meetings(ends: &[End], is_fresh: &[bool]) -> u64 {
    let (mut fresh, mut settled, mut meetings) = (0u64, 0u64, 0);
    for end in ends {
        let here = is_fresh[end.slot().index()];
        let open = if here { &mut fresh } else { &mut settled };
        if end.is_upper() {
            *open -= 1;
        } else {
            *open += 1;
            meetings += if here { fresh - 1 + settled } else { fresh };
        }
    }
    meetings
}
