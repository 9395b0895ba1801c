//! Contacts as they are seen beside those of the true motion: which is which, and what is wrong.

/// A stretch of steps in which two bodies touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    first: u64,
    last: u64,
    /// The first step from which on it was deep for long enough.
    deep: Option<u64>,
}

/// Stretches, as they grow.
#[derive(Clone, Debug, Default)]
pub(super) struct Stretches {
    pub(super) all: Vec<Stretch>,
    /// Steps in a row that were deep, and how many count.
    deep_for: u64,
    pub(super) long: u64,
}

impl Stretches {
    pub(super) fn note(&mut self, step: u64, touches: bool, deep: bool) {
        self.deep_for = if touches && deep { self.deep_for + 1 } else { 0 };
        if !touches {
            return;
        }
        match self.all.last_mut().filter(|last| last.last + 1 >= step) {
            Some(last) => last.last = step,
            None => self.all.push(Stretch { first: step, last: step, deep: None }),
        }
        if let Some(last) = self.all.last_mut().filter(|_| self.deep_for >= self.long) {
            last.deep.get_or_insert(step);
        }
    }
}

/// How old a pose is when it is seen, steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) least: u64,
    pub(super) most: u64,
    /// By how much smoothing delays it beyond that.
    pub(super) lag: u64,
}

impl Window {
    /// Of a pair of two.
    pub(super) fn join(self, other: Self) -> Self {
        Self {
            least: self.least.min(other.least),
            most: self.most.max(other.most),
            lag: self.lag.max(other.lag),
        }
    }
}

/// Contacts of one way to see a body beside those of its true motion.
///
/// Each contact is that of one true one at most, in their order: as many as can be, and then the
/// latest that has begun. A pose's age is `delay` and what the device takes, without smoothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackedContacts {
    /// Contacts in all.
    pub contacts: usize,
    /// Of them those during which, and for the age of a pose before, the true motion touches
    /// nothing there, and that are not late either.
    pub spurious: usize,
    /// Of them those that are more than the true contacts which they could be.
    pub repeated: usize,
    /// Of them those that begin when the true contact has ended longer ago than a pose is old, but
    /// not longer ago than smoothing delays.
    pub late: usize,
    /// True contacts that are not reported, though they are deeper than twice the tolerance for
    /// longer than poses are apart.
    pub missed: usize,
    /// Those that are as deep, and during which the contact of another true one goes on.
    pub merged: usize,
    /// Steps from when a true contact is so deep until its contact begins, at most.
    pub latency: u64,
    /// Steps from when a true contact ends until its contact does, at most. A contact goes on while
    /// no gap of more than the tolerance is left.
    pub end_latency: u64,
}

/// Which reported contacts belong to which true ones.
struct Matching<'a> {
    truth: &'a [Stretch],
    seen: &'a [Stretch],
    window: Window,
    /// Of each seen one its true one, and the other way round.
    own: Vec<Option<usize>>,
    seen_of: Vec<Option<usize>>,
}

impl<'a> Matching<'a> {
    fn new(truth: &'a [Stretch], seen: &'a [Stretch], window: Window) -> Self {
        let (own, seen_of) = (vec![None; seen.len()], vec![None; truth.len()]);
        let mut matching = Self { truth, seen, window, own, seen_of };
        matching.take_earliest();
        matching.move_to_latest();
        matching
    }

    fn meets(&self, t: usize, s: usize) -> bool {
        let (t, s) = (&self.truth[t], &self.seen[s]);
        t.first <= s.last && s.first <= t.last + self.window.most
    }

    /// Both are in order, so that taking the earliest leaves most for those that follow.
    fn take_earliest(&mut self) {
        let mut next = 0;
        for s in 0..self.seen.len() {
            while next < self.truth.len()
                && self.truth[next].last + self.window.most < self.seen[s].first
            {
                next += 1;
            }
            if next < self.truth.len() && self.meets(next, s) {
                self.own[s] = Some(next);
                next += 1;
            }
        }
    }

    /// Of several true contacts that it may be, a contact is the last that can have made it begin.
    fn move_to_latest(&mut self) {
        let mut free_below = self.truth.len();
        for s in (0..self.seen.len()).rev() {
            let Some(first) = self.own[s] else { continue };
            let began = |t: &usize| self.truth[*t].first + self.window.least <= self.seen[s].first;
            let can_be = (first..free_below).take_while(|&t| t == first || self.meets(t, s));
            let latest = can_be.filter(began).last().unwrap_or(first);
            (self.own[s], self.seen_of[latest], free_below) = (Some(latest), Some(s), latest);
        }
    }

    /// The true contact without one of its own that a contact may be by the lag of smoothing.
    fn late(&self, s: usize) -> Option<usize> {
        let (begins, within) = (self.seen[s].first, self.window.most + self.window.lag);
        let can_be = |t: &usize| {
            let real = &self.truth[*t];
            real.first <= begins && begins <= real.last + within && self.seen_of[*t].is_none()
        };
        (0..self.truth.len()).rev().find(can_be)
    }

    /// Whether a contact goes on during a true one.
    fn covers(&self, s: usize, t: usize) -> bool {
        let (s, t, age) = (&self.seen[s], &self.truth[t], self.window.least);
        t.first + age <= s.last && s.first <= t.last + age
    }

    /// The end of the last true contact that a contact stands for.
    fn true_end(&self, s: usize, own: usize) -> u64 {
        let others = own + 1..self.truth.len();
        let others = others.take_while(|&t| self.seen_of[t].is_none() && self.covers(s, t));
        self.truth[others.last().unwrap_or(own)].last
    }
}

/// How one way to see a body did.
pub(super) fn judged(truth: &[Stretch], seen: &[Stretch], window: Window) -> TrackedContacts {
    let mut matching = Matching::new(truth, seen, window);
    let mut judged = TrackedContacts { contacts: seen.len(), ..TrackedContacts::default() };
    for s in (0..seen.len()).filter(|&s| matching.own[s].is_none()).collect::<Vec<_>>() {
        if (0..truth.len()).any(|t| matching.meets(t, s)) {
            judged.repeated += 1;
        } else if let Some(t) = matching.late(s) {
            judged.late += 1;
            (matching.own[s], matching.seen_of[t]) = (Some(t), Some(s));
        } else {
            judged.spurious += 1;
        }
    }
    for (t, deep) in truth.iter().enumerate().filter_map(|(t, real)| Some((t, real.deep?))) {
        match matching.seen_of[t] {
            Some(s) => judged.latency = judged.latency.max(seen[s].first.saturating_sub(deep)),
            None if (0..seen.len()).any(|s| matching.covers(s, t)) => judged.merged += 1,
            None => judged.missed += 1,
        }
    }
    for (s, own) in matching.own.iter().enumerate().filter_map(|(s, own)| Some((s, (*own)?))) {
        let after = seen[s].last.saturating_sub(matching.true_end(s, own));
        judged.end_latency = judged.end_latency.max(after);
    }
    judged
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretches(all: &[(u64, u64)], deep: Option<u64>) -> Vec<Stretch> {
        all.iter().map(|&(first, last)| Stretch { first, last, deep }).collect()
    }

    fn aged(most: u64) -> Window {
        Window { most, ..Window::default() }
    }

    const NONE: TrackedContacts = TrackedContacts {
        contacts: 0,
        spurious: 0,
        repeated: 0,
        late: 0,
        missed: 0,
        merged: 0,
        latency: 0,
        end_latency: 0,
    };

    #[test]
    fn what_is_spurious_repeated_and_missed_is_told_apart() {
        let truth = [stretches(&[(10, 20), (40, 50)], None), stretches(&[(70, 80)], Some(72))];
        let truth = truth.concat();
        let judged = |seen: &[(u64, u64)]| judged(&truth, &stretches(seen, None), aged(3));
        assert_eq!(judged(&[]), TrackedContacts { missed: 1, ..NONE });
        // As it was, a little later; the slight ones as one.
        let kept = judged(&[(12, 52), (75, 83)]);
        assert_eq!(kept, TrackedContacts { contacts: 2, latency: 3, end_latency: 3, ..NONE });
        // In pieces, and where there is nothing.
        let shaken = judged(&[(2, 3), (9, 11), (13, 13), (15, 18), (23, 24), (24, 25), (71, 90)]);
        let expected =
            TrackedContacts { contacts: 7, spurious: 2, repeated: 3, end_latency: 10, ..NONE };
        assert_eq!(shaken, expected);
    }

    #[test]
    fn a_contact_that_never_ends_hides_no_second_one() {
        let truth = [(10, 12), (40, 42)];
        let truth = truth.map(|(first, deep)| stretches(&[(first, first + 10)], Some(deep)));
        let held = judged(&truth.concat(), &stretches(&[(12, 1000)], None), aged(3));
        let expected = TrackedContacts { contacts: 1, merged: 1, end_latency: 950, ..NONE };
        assert_eq!(held, expected);
    }

    #[test]
    fn a_contact_is_that_of_the_last_true_one_that_has_begun() {
        let truth = [stretches(&[(10, 20)], Some(12)), stretches(&[(30, 40)], None)].concat();
        let one = judged(&truth, &stretches(&[(35, 45)], None), aged(82));
        assert_eq!(one, TrackedContacts { contacts: 1, missed: 1, end_latency: 5, ..NONE });
        // Of poses that are 10 steps old at least, the second cannot have made it begin.
        let old = Window { least: 10, ..aged(82) };
        let one = judged(&truth, &stretches(&[(35, 45)], None), old);
        assert_eq!((one.missed, one.latency), (0, 23));
        // And where there are two, each is one.
        let two = judged(&truth, &stretches(&[(35, 36), (38, 45)], None), aged(82));
        assert_eq!(two, TrackedContacts { contacts: 2, latency: 23, end_latency: 16, ..NONE });
    }

    #[test]
    fn what_smoothing_delays_too_long_is_late_and_no_more_is_excused() {
        let truth = stretches(&[(10, 20)], Some(12));
        let smoothed = Window { lag: 10, ..aged(3) };
        let at = |first, window| judged(&truth, &stretches(&[(first, first + 1)], None), window);
        let late = TrackedContacts { contacts: 1, latency: 12, end_latency: 5, ..NONE };
        assert_eq!(at(24, smoothed), TrackedContacts { late: 1, ..late });
        let spurious = TrackedContacts { contacts: 1, spurious: 1, missed: 1, ..NONE };
        assert_eq!(at(24, aged(3)), spurious);
        assert_eq!(at(34, smoothed), spurious);
    }

    #[test]
    fn a_contact_is_deep_once_it_was_so_for_long_enough() {
        let mut known = Stretches { long: 2, ..Stretches::default() };
        let depths =
            [None, Some(false), Some(true), Some(false), Some(true), Some(true), None, Some(true)];
        for (step, depth) in (0..).zip(depths) {
            known.note(step, depth.is_some(), depth == Some(true));
        }
        let expected = [
            Stretch { first: 1, last: 5, deep: Some(5) },
            Stretch { first: 7, last: 7, deep: None },
        ];
        assert_eq!(known.all, expected);
    }
}
