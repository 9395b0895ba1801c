//! One axis: the end points of all boxes along it, kept sorted by insertion sort.

use crate::InvariantError;
use crate::slots::Slot;

/// One end of a box along an axis: `2 * slot`, plus 1 for the upper end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct End(u32);

impl End {
    pub(super) fn lower(slot: Slot) -> Self {
        Self(slot.0 << 1)
    }

    pub(super) fn upper(slot: Slot) -> Self {
        Self(slot.0 << 1 | 1)
    }

    pub(super) fn is_upper(self) -> bool {
        self.0 & 1 == 1
    }

    pub(super) fn slot(self) -> Slot {
        Slot(self.0 >> 1)
    }

    fn index(self) -> usize {
        self.0 as usize
    }
}

/// Two ends of different boxes and unlike kinds that changed places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// The intervals meet along this axis now, and did not before.
    Met,
    /// The intervals are apart along this axis now, and were not before: a pair ends here if the
    /// boxes overlapped. The header of `pairs` says what becomes of it.
    Parted,
}

/// The order along an axis. Among equal values a lower end comes before an upper one, so that
/// intervals which only touch count as meeting.
fn precedes(a: (f64, End), b: (f64, End)) -> bool {
    a.0 < b.0 || (a.0 == b.0 && !a.1.is_upper() && b.1.is_upper())
}

/// One bit for each place. Reading marks in order costs a word for 64 places, less than sorting
/// even a short list of places does.
#[derive(Clone, Debug, Default)]
struct Marks(Vec<u64>);

impl Marks {
    fn set(&mut self, place: usize) {
        self.0[place / 64] |= 1 << (place % 64);
    }

    fn resize(&mut self, places: usize) {
        self.0.resize(places.div_ceil(64), 0);
    }

    /// The marked places in order; all are unmarked.
    fn drain(&mut self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter_mut().enumerate().flat_map(|(word, bits)| {
            let mut bits = std::mem::take(bits);
            std::iter::from_fn(move || {
                (bits != 0).then(|| {
                    let bit = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    word * 64 + bit
                })
            })
        })
    }
}

/// Sorted end points in two flat arrays, and where each end stands.
///
/// Values are never `NaN`, and zeros are +0 (see `checked_box`).
#[derive(Clone, Debug, Default)]
pub(super) struct Axis {
    values: Vec<f64>,
    ends: Vec<End>,
    /// By [`End::index`]; meaningless for ends that are not listed.
    places: Vec<u32>,
    /// The ends that were given a greater value, and a lesser one, since the last sort.
    rising: Marks,
    falling: Marks,
}

impl Axis {
    pub(super) fn ends(&self) -> &[End] {
        &self.ends
    }

    /// Writes new values for the two ends of a listed slot, at most once between two sorts. The
    /// order is stale until [`sort`](Self::sort).
    pub(super) fn set(&mut self, slot: Slot, lower: f64, upper: f64) {
        for (end, value) in [(End::lower(slot), lower), (End::upper(slot), upper)] {
            let place = self.places[end.index()] as usize;
            if value > self.values[place] {
                self.rising.set(place);
            } else if value < self.values[place] {
                self.falling.set(place);
            }
            self.values[place] = value;
        }
    }

    /// Restores the order after any number of [`set`](Self::set)s, and calls `visit` for every two
    /// unlike ends that change places. Returns the number of swaps.
    ///
    /// Each inversion between the stale and the new order is swapped exactly once: bodies that move
    /// together cost nothing. To that end the rising ends are moved first, from the top, then the
    /// falling ones, from the bottom. An end in the way is compared by its new value, be it moved
    /// already or not. Why the first pass sorts all but the falling ends among each other: a rising
    /// end e can stop early only at a falling end d that is not less than e by now; what stands
    /// above d and does not fall is not less than d was, hence not less than e. The second pass is
    /// then a plain insertion sort.
    ///
    /// Gives up, with `None`, when there are more than `budget` swaps: the lists are
    /// then consistent but not sorted, and [`sort_anew`](Self::sort_anew) is due.
    pub(super) fn sort(
        &mut self,
        budget: u64,
        mut visit: impl FnMut(Slot, Slot, Crossing),
    ) -> Option<u64> {
        let ends = &self.ends;
        let rising: Vec<End> = self.rising.drain().map(|place| ends[place]).collect();
        let falling: Vec<End> = self.falling.drain().map(|place| ends[place]).collect();
        let mut swaps = 0;
        for end in rising.into_iter().rev() {
            swaps += self.raise(end, &mut visit);
            if swaps > budget {
                return None;
            }
        }
        for end in falling {
            swaps += self.lower(end, &mut visit);
            if swaps > budget {
                return None;
            }
        }
        Some(swaps)
    }

    fn raise(&mut self, end: End, visit: &mut impl FnMut(Slot, Slot, Crossing)) -> u64 {
        let start = self.places[end.index()] as usize;
        let value = self.values[start];
        let mut place = start;
        while let Some(&next) = self.ends.get(place + 1) {
            let next_value = self.values[place + 1];
            if !precedes((next_value, next), (value, end)) {
                break;
            }
            self.put(place, next_value, next);
            match (end.is_upper(), next.is_upper()) {
                (true, false) => visit(end.slot(), next.slot(), Crossing::Met),
                (false, true) => visit(end.slot(), next.slot(), Crossing::Parted),
                _ => {}
            }
            place += 1;
        }
        self.put(place, value, end);
        (place - start) as u64
    }

    fn lower(&mut self, end: End, visit: &mut impl FnMut(Slot, Slot, Crossing)) -> u64 {
        let start = self.places[end.index()] as usize;
        let value = self.values[start];
        let mut place = start;
        while place > 0 {
            let (next_value, next) = (self.values[place - 1], self.ends[place - 1]);
            if !precedes((value, end), (next_value, next)) {
                break;
            }
            self.put(place, next_value, next);
            match (end.is_upper(), next.is_upper()) {
                (false, true) => visit(end.slot(), next.slot(), Crossing::Met),
                (true, false) => visit(end.slot(), next.slot(), Crossing::Parted),
                _ => {}
            }
            place -= 1;
        }
        self.put(place, value, end);
        (start - place) as u64
    }

    fn put(&mut self, place: usize, value: f64, end: End) {
        self.values[place] = value;
        self.ends[place] = end;
        self.places[end.index()] = place_number(place);
    }

    /// Sorts from any order.
    pub(super) fn sort_anew(&mut self) {
        self.rising.0.fill(0);
        self.falling.0.fill(0);
        let mut listed: Vec<_> =
            self.values.iter().copied().zip(self.ends.iter().copied()).collect();
        sort_ends(&mut listed);
        for (place, (value, end)) in listed.into_iter().enumerate() {
            self.put(place, value, end);
        }
    }

    /// Lists more ends. `added` need not be sorted; the ends listed so far must be.
    pub(super) fn merge(&mut self, mut added: Vec<(f64, End)>) {
        sort_ends(&mut added);
        let mut old = self.values.len();
        let total = old + added.len();
        self.values.resize(total, 0.0);
        self.ends.resize(total, End(0));
        self.rising.resize(total);
        self.falling.resize(total);
        if let Some(highest) = added.iter().map(|(_, end)| end.index()).max() {
            self.places.resize(self.places.len().max(highest + 1), 0);
        }
        // From the top down, so that an old end is moved before its place is taken.
        for place in (0..total).rev() {
            let Some(&last) = added.last() else { break };
            let take_old = old > 0 && precedes(last, (self.values[old - 1], self.ends[old - 1]));
            let (value, end) = if take_old {
                old -= 1;
                (self.values[old], self.ends[old])
            } else {
                added.pop();
                last
            };
            self.put(place, value, end);
        }
    }

    /// Takes the ends of all slots off the list for which `keep` is false; the order stays.
    pub(super) fn retain(&mut self, keep: impl Fn(Slot) -> bool) {
        let mut kept = 0;
        for place in 0..self.ends.len() {
            let (value, end) = (self.values[place], self.ends[place]);
            if keep(end.slot()) {
                self.put(kept, value, end);
                kept += 1;
            }
        }
        self.values.truncate(kept);
        self.ends.truncate(kept);
        self.rising.resize(kept);
        self.falling.resize(kept);
    }

    /// Sorted; each place on record; `slots` boxes listed with their faces `(lower, upper)` as
    /// given by `faces`, which is `None` for slots that must not be listed.
    pub(super) fn validate(
        &self,
        name: char,
        slots: usize,
        faces: impl Fn(Slot) -> Option<(f64, f64)>,
    ) -> Result<(), InvariantError> {
        let (n, m) = (self.values.len(), self.ends.len());
        InvariantError::unless(n == m && n == 2 * slots, || {
            format!("axis {name} lists {n} values and {m} ends for {slots} boxes")
        })?;
        let marked = self.rising.0.iter().chain(&self.falling.0).any(|&word| word != 0);
        InvariantError::unless(!marked, || {
            format!("axis {name} has marks left over from the last sort")
        })?;
        for (place, (&value, &end)) in self.values.iter().zip(&self.ends).enumerate() {
            let at = self.places[end.index()] as usize;
            InvariantError::unless(at == place, || {
                format!("axis {name}: {end:?} stands at {place}, on record at {at}")
            })?;
            let face = faces(end.slot()).map(|f| if end.is_upper() { f.1 } else { f.0 });
            InvariantError::unless(face == Some(value), || {
                format!("axis {name}: {end:?} is listed with {value}, its face is {face:?}")
            })?;
            let sorted = place == 0
                || !precedes((value, end), (self.values[place - 1], self.ends[place - 1]));
            InvariantError::unless(sorted, || format!("axis {name} is not sorted at {place}"))?;
        }
        Ok(())
    }
}

/// Sorts as [`precedes`] says. Ends of one kind and value may come in any order: no pair depends on
/// it.
fn sort_ends(ends: &mut [(f64, End)]) {
    ends.sort_unstable_by(|a, b| {
        a.0.total_cmp(&b.0).then_with(|| a.1.is_upper().cmp(&b.1.is_upper()))
    });
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "there are fewer than 2^32 ends: see MAX_SLOTS"
)]
fn place_number(place: usize) -> u32 {
    place as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis_of(intervals: &[(f64, f64)]) -> Axis {
        let mut axis = Axis::default();
        let mut added = Vec::new();
        for (slot, &(lower, upper)) in (0..).map(Slot).zip(intervals) {
            added.extend([(lower, End::lower(slot)), (upper, End::upper(slot))]);
        }
        axis.merge(added);
        axis
    }

    fn crossings(axis: &mut Axis) -> Vec<(u32, u32, Crossing)> {
        let mut seen = Vec::new();
        axis.sort(u64::MAX, |a, b, crossing| {
            seen.push((a.0.min(b.0), a.0.max(b.0), crossing));
        });
        seen
    }

    #[test]
    fn intervals_that_touch_have_met() {
        let mut axis = axis_of(&[(0.0, 1.0), (2.0, 3.0)]);
        axis.set(Slot(1), 1.0, 2.0);
        assert_eq!(crossings(&mut axis), [(0, 1, Crossing::Met)]);
        axis.set(Slot(0), 0.0, 1.0f64.next_down());
        assert_eq!(crossings(&mut axis), [(0, 1, Crossing::Parted)]);
        // And when they touch from the start, the lower end stands first.
        let axis = axis_of(&[(0.0, 1.0), (1.0, 2.0)]);
        assert_eq!(axis.ends()[1], End::lower(Slot(1)));
    }

    #[test]
    fn what_moves_together_swaps_nothing() {
        let mut axis = axis_of(&[(0.0, 1.0), (0.5, 3.0), (2.0, 2.0)]);
        for (slot, (lower, upper)) in [(0.0, 1.0), (0.5, 3.0), (2.0, 2.0)].iter().enumerate() {
            axis.set(Slot(slot as u32), lower + 100.0, upper + 100.0);
        }
        assert_eq!(axis.sort(0, |_, _, _| panic!("no crossing")), Some(0));
    }

    #[test]
    fn an_exhausted_budget_leaves_a_list_that_can_be_sorted_anew() {
        let mut axis = axis_of(&[(0.0, 0.5), (1.0, 1.5), (2.0, 2.5), (3.0, 3.5)]);
        let reversed = [(3.0, 3.5), (2.0, 2.5), (1.0, 1.5), (0.0, 0.5)];
        for (slot, (lower, upper)) in reversed.into_iter().enumerate() {
            axis.set(Slot(slot as u32), lower, upper);
        }
        assert_eq!(axis.sort(3, |_, _, _| {}), None);
        axis.sort_anew();
        axis.validate('x', 4, |slot| reversed.get(slot.0 as usize).copied()).expect("sorted");
    }
}
