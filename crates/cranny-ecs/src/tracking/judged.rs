//! Contacts as they are seen beside those of the true motion: which is which, and what is wrong.

use serde::Serialize;

/// A stretch of steps in which two bodies touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    first: u64,
    last: u64,
}

/// Stretches, as they grow.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Stretches {
    pub(super) all: Vec<Stretch>,
    /// The last step that was noted.
    until: u64,
}

impl Stretches {
    pub(super) fn note(&mut self, step: u64, touches: bool) {
        self.until = step;
        if !touches {
            return;
        }
        match self.all.last_mut().filter(|last| last.last + 1 >= step) {
            Some(last) => last.last = step,
            None => self.all.push(Stretch { first: step, last: step }),
        }
    }
}

/// Contacts of the true motion, as they grow.
#[derive(Clone, Debug)]
pub(super) struct TrueContacts {
    pub(super) stretches: Stretches,
    /// Of each the first step from which on it was deep for long enough.
    deep: Vec<Option<u64>>,
    /// Steps in a row that were deep, and how many count.
    deep_for: u64,
    long: u64,
}

impl TrueContacts {
    /// None yet; `long` steps in a row that are deep count.
    pub(super) fn new(long: u64) -> Self {
        Self { stretches: Stretches::default(), deep: Vec::new(), deep_for: 0, long }
    }

    pub(super) fn note(&mut self, step: u64, touches: bool, deep: bool) {
        self.stretches.note(step, touches);
        self.deep.resize(self.stretches.all.len(), None);
        self.deep_for = if touches && deep { self.deep_for + 1 } else { 0 };
        if let Some(last) = self.deep.last_mut().filter(|_| self.deep_for >= self.long) {
            last.get_or_insert(step);
        }
    }

    /// Those that count as deep, each with the step from which on it does.
    fn deep(&self) -> impl Iterator<Item = (usize, u64)> {
        self.deep.iter().enumerate().filter_map(|(t, deep)| Some((t, (*deep)?)))
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
/// Each seen contact is matched to at most one true contact, in order: first as many as possible,
/// then the latest that has begun. A pose's age is that of the pose at which the body is seen, at
/// most, where none is missing; smoothing does not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TrackedContacts {
    /// Contacts in all.
    pub contacts: usize,
    /// Of them those during which, and for the age of a pose before, the true motion touches
    /// nothing there, and that are not late either.
    pub spurious: usize,
    /// Of them those that are more than the true contacts which they could be.
    pub repeated: usize,
    /// Of them those that end while the true motion touches, whatever age of a pose is assumed.
    pub cut_short: usize,
    /// Of them those that begin when the true contact has ended longer ago than a pose is old, but
    /// not longer ago than smoothing delays.
    pub late: usize,
    /// True contacts that are not reported, though they are deeper than twice the tolerance for
    /// longer than poses are apart.
    pub missed: usize,
    /// Those that are as deep, and during which the contact of another true one goes on.
    pub merged: usize,
    /// Steps from when a true contact is so deep until its contact begins, at most.
    pub latency_steps: u64,
    /// Steps from when a true contact ends until its contact does, at most. A contact goes on while
    /// no gap of more than the tolerance is left.
    pub end_latency_steps: u64,
}

impl TrackedContacts {
    /// Of both: sums, and the greater latencies.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        Self {
            contacts: self.contacts + other.contacts,
            spurious: self.spurious + other.spurious,
            repeated: self.repeated + other.repeated,
            cut_short: self.cut_short + other.cut_short,
            late: self.late + other.late,
            missed: self.missed + other.missed,
            merged: self.merged + other.merged,
            latency_steps: self.latency_steps.max(other.latency_steps),
            end_latency_steps: self.end_latency_steps.max(other.end_latency_steps),
        }
    }
}

/// Seen contacts matched with true ones.
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

    /// Whether a contact ends at a pose at which the true motion touches, however old that is. What
    /// goes on as the run ends has not ended.
    fn is_cut_short(&self, seen: &Stretch, until: u64) -> bool {
        let (end, Window { least, most, lag }) = (seen.last + 1, self.window);
        let touches = |real: &Stretch| real.first + most + lag <= end && end <= real.last + least;
        seen.last < until && self.truth.iter().any(touches)
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
pub(super) fn judged(truth: &TrueContacts, seen: &Stretches, window: Window) -> TrackedContacts {
    let (real, until, seen) = (&truth.stretches.all, seen.until, &seen.all);
    let mut matching = Matching::new(real, seen, window);
    let mut judged = TrackedContacts { contacts: seen.len(), ..TrackedContacts::default() };
    judged.cut_short = seen.iter().filter(|seen| matching.is_cut_short(seen, until)).count();
    for s in (0..seen.len()).filter(|&s| matching.own[s].is_none()).collect::<Vec<_>>() {
        if (0..real.len()).any(|t| matching.meets(t, s)) {
            judged.repeated += 1;
        } else if let Some(t) = matching.late(s) {
            judged.late += 1;
            (matching.own[s], matching.seen_of[t]) = (Some(t), Some(s));
        } else {
            judged.spurious += 1;
        }
    }
    for (t, deep) in truth.deep() {
        match matching.seen_of[t] {
            Some(s) => {
                let latency = seen[s].first.saturating_sub(deep);
                judged.latency_steps = judged.latency_steps.max(latency);
            }
            None if (0..seen.len()).any(|s| matching.covers(s, t)) => judged.merged += 1,
            None => judged.missed += 1,
        }
    }
    for (s, own) in matching.own.iter().enumerate().filter_map(|(s, own)| Some((s, (*own)?))) {
        let after = seen[s].last.saturating_sub(matching.true_end(s, own));
        judged.end_latency_steps = judged.end_latency_steps.max(after);
    }
    judged
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One at a time, in order, until long after.
    fn seen(all: &[(u64, u64)]) -> Stretches {
        let all = all.iter().map(|&(first, last)| Stretch { first, last }).collect();
        Stretches { all, until: 10_000 }
    }

    /// With the step from which on it is deep.
    fn truth(all: &[(u64, u64, Option<u64>)]) -> TrueContacts {
        let stretches: Vec<_> = all.iter().map(|&(first, last, _)| (first, last)).collect();
        let deep = all.iter().map(|&(_, _, deep)| deep).collect();
        TrueContacts { stretches: seen(&stretches), deep, ..TrueContacts::new(1) }
    }

    fn aged(most: u64) -> Window {
        Window { most, ..Window::default() }
    }

    const NONE: TrackedContacts = TrackedContacts {
        contacts: 0,
        spurious: 0,
        repeated: 0,
        cut_short: 0,
        late: 0,
        missed: 0,
        merged: 0,
        latency_steps: 0,
        end_latency_steps: 0,
    };

    #[test]
    fn spurious_repeated_and_missed_contacts_are_counted_separately() {
        let truth = truth(&[(10, 20, None), (40, 50, None), (70, 80, Some(72))]);
        let judged = |all: &[(u64, u64)]| judged(&truth, &seen(all), aged(3));
        assert_eq!(judged(&[]), TrackedContacts { missed: 1, ..NONE });
        // As it was, a little later; the slight ones as one.
        let kept = judged(&[(12, 52), (75, 83)]);
        let expected =
            TrackedContacts { contacts: 2, latency_steps: 3, end_latency_steps: 3, ..NONE };
        assert_eq!(kept, expected);
        // In pieces, and where there is nothing.
        let shaken = judged(&[(2, 3), (9, 11), (13, 13), (15, 18), (23, 24), (24, 25), (71, 90)]);
        let wrong = TrackedContacts { spurious: 2, repeated: 3, cut_short: 2, ..NONE };
        let expected = TrackedContacts { contacts: 7, end_latency_steps: 10, ..wrong };
        assert_eq!(shaken, expected);
    }

    #[test]
    fn a_contact_that_ends_at_a_pose_that_touches_is_cut_short() {
        let truth = truth(&[(10, 20, None)]);
        let cut = |last, window| judged(&truth, &seen(&[(12, last)]), window).cut_short;
        assert_eq!([15, 19, 20].map(|last| cut(last, Window::default())), [1, 1, 0]);
        // The pose of step 13 is of step 9 at least, at which nothing touches.
        assert_eq!([12, 13].map(|last| cut(last, aged(4))), [0, 1]);
        // And that of step 23 is of step 20 at most.
        let old = Window { least: 3, most: 4, lag: 0 };
        assert_eq!([22, 23].map(|last| cut(last, old)), [1, 0]);
        assert_eq!([17, 18].map(|last| cut(last, Window { lag: 5, ..old })), [0, 1]);
        let going_on = Stretches { until: 15, ..seen(&[(12, 15)]) };
        assert_eq!(judged(&truth, &going_on, Window::default()).cut_short, 0);
    }

    #[test]
    fn a_contact_that_never_ends_hides_no_second_one() {
        let truth = truth(&[(10, 20, Some(12)), (40, 50, Some(42))]);
        let held = judged(&truth, &seen(&[(12, 1000)]), aged(3));
        let expected = TrackedContacts { contacts: 1, merged: 1, end_latency_steps: 950, ..NONE };
        assert_eq!(held, expected);
    }

    #[test]
    fn a_contact_is_that_of_the_last_true_one_that_has_begun() {
        let truth = truth(&[(10, 20, Some(12)), (30, 40, None)]);
        let one = judged(&truth, &seen(&[(35, 45)]), aged(82));
        assert_eq!(one, TrackedContacts { contacts: 1, missed: 1, end_latency_steps: 5, ..NONE });
        // Of poses that are 10 steps old at least, the second cannot have made it begin.
        let old = Window { least: 10, ..aged(82) };
        let one = judged(&truth, &seen(&[(35, 45)]), old);
        assert_eq!((one.missed, one.latency_steps), (0, 23));
        // And where there are two, each is one.
        let two = judged(&truth, &seen(&[(35, 36), (38, 45)]), aged(82));
        let expected =
            TrackedContacts { contacts: 2, latency_steps: 23, end_latency_steps: 16, ..NONE };
        assert_eq!(two, expected);
    }

    #[test]
    fn what_smoothing_delays_too_long_is_late_and_no_more_is_excused() {
        let truth = truth(&[(10, 20, Some(12))]);
        let smoothed = Window { lag: 10, ..aged(3) };
        let at = |first, window| judged(&truth, &seen(&[(first, first + 1)]), window);
        let late = TrackedContacts { contacts: 1, latency_steps: 12, end_latency_steps: 5, ..NONE };
        assert_eq!(at(24, smoothed), TrackedContacts { late: 1, ..late });
        let spurious = TrackedContacts { contacts: 1, spurious: 1, missed: 1, ..NONE };
        assert_eq!(at(24, aged(3)), spurious);
        assert_eq!(at(34, smoothed), spurious);
    }

    #[test]
    fn a_contact_is_deep_once_it_was_so_for_long_enough() {
        let mut known = TrueContacts::new(2);
        let depths =
            [None, Some(false), Some(true), Some(false), Some(true), Some(true), None, Some(true)];
        for (step, depth) in (0..).zip(depths) {
            known.note(step, depth.is_some(), depth == Some(true));
        }
        assert_eq!(
            known.stretches.all,
            [(1, 5), (7, 7)].map(|(first, last)| Stretch { first, last })
        );
        assert_eq!(known.deep, [Some(5), None]);
    }
}
