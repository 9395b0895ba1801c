//! Several bodies that move at once: how far each goes before any of them meets another.
//!
//! Of bodies that meet, those are held back, to the earliest of their meetings, that would meet
//! otherwise; as that changes ways, they are held against each other again. What has not come to
//! an end after [`ROUNDS`] stops at one common time, up to which nothing met anything, and so does
//! what meets it then.

use std::collections::BTreeMap;

use cranny_exact::DVec3;

use crate::motion::Motion;

/// How often ways are held against each other anew. More: a pile that is hit hard takes longer;
/// fewer: bodies stop that would have gone on.
const ROUNDS: usize = 4;

/// The share of its way below which a body that is in the way of what does not give way stays where
/// it is. Larger: it stays though it could go on; smaller: that is known later.
const SHORTEST: f64 = 1.0 / 64.0;

/// What a body does within a step, and up to which share of it the body goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The whole of it.
    pub motion: Motion,
    /// From 0 to 1.
    pub until: f64,
}

impl Way {
    /// All of a motion.
    #[must_use]
    pub fn whole(motion: Motion) -> Self {
        Self { motion, until: 1.0 }
    }

    /// Whether it leads anywhere.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.motion.travel != DVec3::ZERO || self.motion.turn != DVec3::ZERO
    }

    /// Whether the body stops before its end.
    #[must_use]
    pub fn is_shortened(&self) -> bool {
        self.until < 1.0 && self.moves()
    }

    /// The motion as far as the body goes.
    #[must_use]
    pub fn motion(&self) -> Motion {
        self.motion.part(self.until)
    }
}

/// Shortens ways until nobody meets anybody on them.
///
/// `pairs` are those that may meet, and all their bodies have ways. `gives_way` says whether a body
/// may be held back; of two that may not, neither is, and what stands still where such a body comes
/// is run into. `meeting` says at which share of two motions, from 0 to 1, their bodies meet or are
/// as near as they are let; `None` where they do not.
pub fn shorten<B: Copy + Ord>(
    ways: &mut BTreeMap<B, Way>,
    pairs: &[[B; 2]],
    gives_way: impl Fn(B) -> bool,
    meeting: impl Fn([B; 2], [Motion; 2]) -> Option<f64>,
) {
    let mut settling = Settling { ways, groups: Groups::default() };
    let mut due: Vec<[B; 2]> = pairs.to_vec();
    for _ in 0..=ROUNDS {
        let before = settling.ways.clone();
        for &pair in &due {
            let motions = pair.map(|body| before[&body].motion());
            let Some(time) = meeting(pair, motions) else {
                continue;
            };
            let held = match pair.map(&gives_way) {
                [true, true] => needed(motions, time, |motions| meeting(pair, motions).is_none()),
                gives => gives,
            };
            for (body, _) in pair.into_iter().zip(held).filter(|(_, is_held)| *is_held) {
                settling.hold(body, time * before[&body].until);
            }
        }
        due = settling.touched_since(&before, pairs);
        if due.is_empty() {
            return;
        }
    }
    settling.settle(pairs, gives_way, meeting);
}

/// Which of two that meet has to be held at a share of its motion: the one that goes farther, or
/// the other one, where they do not meet then; else both. A body that runs after another does not
/// stop it.
fn needed(motions: [Motion; 2], share: f64, are_free: impl Fn([Motion; 2]) -> bool) -> [bool; 2] {
    let held = |k: usize| {
        let mut motions = motions;
        motions[k] = motions[k].part(share);
        are_free(motions)
    };
    let [first, second] = motions.map(|motion| motion.travel.length());
    let order = if first >= second { [0, 1] } else { [1, 0] };
    order.into_iter().find(|&k| held(k)).map_or([true; 2], |k| [k == 0, k == 1])
}

/// Ways that are being shortened.
struct Settling<'a, B> {
    ways: &'a mut BTreeMap<B, Way>,
    groups: Groups<B>,
}

impl<B: Copy + Ord> Settling<'_, B> {
    fn hold(&mut self, body: B, until: f64) {
        if let Some(way) = self.ways.get_mut(&body) {
            way.until = way.until.min(until);
        }
    }

    /// Before what does not give way.
    fn hold_shorter(&mut self, body: B) {
        let half = 0.5 * self.ways[&body].until;
        self.hold(body, if half < SHORTEST { 0.0 } else { half });
    }

    /// Pairs of which a way is another than it was.
    fn touched_since(&self, before: &BTreeMap<B, Way>, pairs: &[[B; 2]]) -> Vec<[B; 2]> {
        let is_other = |body: &B| self.ways[body].until != before[body].until;
        pairs.iter().copied().filter(|pair| pair.iter().any(is_other)).collect()
    }

    /// Stops whoever met at one time, up to which none of them has met another; and whoever meets
    /// these then, with them.
    fn settle(
        &mut self,
        pairs: &[[B; 2]],
        gives_way: impl Fn(B) -> bool,
        meeting: impl Fn([B; 2], [Motion; 2]) -> Option<f64>,
    ) {
        let mut due = pairs.to_vec();
        while !due.is_empty() {
            self.stop_together();
            let before = self.ways.clone();
            for pair in due {
                if self.groups.of(pair[0]) == self.groups.of(pair[1]) {
                    continue; // at one time, they are where nothing met anything
                }
                if meeting(pair, pair.map(|body| before[&body].motion())).is_none() {
                    continue;
                }
                match pair.map(&gives_way) {
                    [true, true] => self.groups.join(pair),
                    [true, false] => self.hold_shorter(pair[0]),
                    [false, true] => self.hold_shorter(pair[1]),
                    [false, false] => {}
                }
            }
            self.stop_together();
            due = self.touched_since(&before, pairs);
        }
    }

    fn stop_together(&mut self) {
        let mut earliest: BTreeMap<B, f64> = BTreeMap::new();
        for (&body, way) in &*self.ways {
            let first = earliest.entry(self.groups.of(body)).or_insert(1.0);
            *first = first.min(way.until);
        }
        for (&body, way) in &mut *self.ways {
            way.until = earliest[&self.groups.of(body)];
        }
    }
}

/// Bodies that met each other, by the lowest of each group.
struct Groups<B>(BTreeMap<B, B>);

impl<B> Default for Groups<B> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<B: Copy + Ord> Groups<B> {
    fn of(&self, body: B) -> B {
        let mut at = body;
        while let Some(&next) = self.0.get(&at) {
            at = next;
        }
        at
    }

    fn join(&mut self, [a, b]: [B; 2]) {
        let [a, b] = [self.of(a), self.of(b)];
        if a != b {
            self.0.insert(a.max(b), a.min(b));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::Pose;
    use cranny_testkit::Rng;

    /// Points on a line that stay 1 apart.
    fn met(_: [u32; 2], [a, b]: [Motion; 2]) -> Option<f64> {
        let (gap, closing) =
            (b.start.translation.x - a.start.translation.x, a.travel.x - b.travel.x);
        let time = (gap - 1.0) / closing;
        (closing > 0.0 && time < 1.0).then_some(time.max(0.0))
    }

    fn ways(places: &[(f64, f64)]) -> BTreeMap<u32, Way> {
        let way = |&(at, travel): &(f64, f64)| {
            Way::whole(Motion::straight(Pose::at(DVec3::X * at), DVec3::X * travel))
        };
        (0..).zip(places.iter().map(way)).collect()
    }

    fn ends(ways: &BTreeMap<u32, Way>) -> Vec<f64> {
        let end = |way: &Way| way.motion.start.translation.x + way.motion().travel.x;
        ways.values().map(end).collect()
    }

    #[test]
    fn who_meets_nobody_goes_all_the_way_and_who_gives_way_stops() {
        let mut both = ways(&[(0.0, 4.0), (5.0, -4.0), (20.0, -1.0)]);
        shorten(&mut both, &[[0, 1], [1, 2]], |_| true, met);
        assert_eq!(ends(&both), [2.0, 3.0, 19.0]);
        let mut one = ways(&[(0.0, 4.0), (5.0, -1.0)]);
        shorten(&mut one, &[[0, 1]], |body| body == 0, met);
        let stopped = ends(&one)[0];
        assert!((1.0..=3.0).contains(&stopped), "{one:?}"); // before the other's end
        assert!(ends(&one)[1] == 4.0 && !one[&1].is_shortened());
        let mut none = ways(&[(0.0, 4.0), (5.0, -4.0)]);
        shorten(&mut none, &[[0, 1]], |_| false, met);
        assert_eq!(ends(&none), [4.0, 1.0]);
    }

    /// Rows at random, in which some give way and others do not: of two that give way none passes
    /// the other, and who gives way passes none that does not, unless it stays where it is.
    #[test]
    fn in_rows_at_random_nobody_passes() {
        let mut random = Rng::new(7);
        for round in 0..4_000 {
            let count = 2 + round % 14;
            let mut x = 0.0;
            let mut place = || {
                x += 1.0 + 1e-3 + 3.0 * random.unit().abs().powi(3);
                (x, 20.0 * random.unit() * random.unit().abs())
            };
            let places: Vec<(f64, f64)> = (0..count).map(|_| place()).collect();
            let share = [0.0, 0.3][round % 2];
            let is_stiff: Vec<bool> = (0..count).map(|_| random.unit().abs() < share).collect();
            let mut row = ways(&places);
            let numbers = 0..count as u32;
            let pairs: Vec<[u32; 2]> =
                numbers.clone().flat_map(|i| (i + 1..count as u32).map(move |j| [i, j])).collect();
            shorten(&mut row, &pairs, |body| !is_stiff[body as usize], met);
            let ends = ends(&row);
            for [i, j] in pairs {
                let gives = [i, j].map(|body| !is_stiff[body as usize]);
                let stays = |k: usize| gives[k] && row[&[i, j][k]].until == 0.0;
                let apart = ends[j as usize] - ends[i as usize] > 1.0 - 1e-9;
                let is_run_into =
                    gives != [true; 2] && (stays(0) || stays(1) || gives == [false; 2]);
                assert!(apart || is_run_into, "{places:?} {is_stiff:?} {ends:?} {i} {j}");
            }
        }
    }

    /// One that runs after another is held, and the other goes on.
    #[test]
    fn who_is_pursued_goes_on() {
        for row in [[(0.0, 2.0), (1.5, 1.0)], [(0.0, -1.0), (1.5, -2.0)]] {
            let mut both = ways(&row);
            shorten(&mut both, &[[0, 1]], |_| true, met);
            let kept: Vec<f64> = both.values().map(|way| way.until).collect();
            let pursued = if row[0].1 > 0.0 { 1 } else { 0 };
            assert!(kept[pursued] == 1.0 && kept[1 - pursued] < 1.0, "{kept:?}");
            assert!(ends(&both)[1] - ends(&both)[0] > 1.0 - 1e-9);
        }
    }

    /// A row that runs into a wall stops one behind the other.
    #[test]
    fn a_row_stops_without_passing() {
        let places: Vec<(f64, f64)> =
            (0..12).map(|i| (1.5 * f64::from(i), if i < 11 { 9.0 } else { 0.0 })).collect();
        let mut row = ways(&places);
        let pairs: Vec<[u32; 2]> = (0..11).map(|i| [i, i + 1]).collect();
        shorten(&mut row, &pairs, |body| body < 11, met);
        let ends = ends(&row);
        assert!(ends.windows(2).all(|w| w[1] - w[0] > 1.0 - 1e-9), "{ends:?}");
    }
}
