//! Which faces of two surfaces meet.

use std::ops::ControlFlow;

use cranny_exact::{Arithmetic, Crossing, Meeting};
use cranny_geometry::FaceId;

use super::apart::FacePairs;
use super::closing::Closing;
use super::cut::Cut;
use super::descent::{Order, Visitor, descend};
use super::faces::Faced;
use super::ground::Ground;
use super::lanes::lanes_of;
use crate::answer::{Surface, Witness};
use crate::pair::{Pair, Side};
use crate::surface::{FacePair, looked_at};
use crate::tally::Tally;
use cranny_geometry::triangle_distance::triangle_distance;

/// Faces are worth measuring where they are apart by more than so many steps. Fewer: they are
/// measured again and again; more: clusters are looked at in every query that could rest.
const WORTH: f64 = 4.0;

/// Queries in which they are not measured after it was not worth it.
const HURRY: u8 = 24;

/// What of faces that do not meet is wanted.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Wants {
    Nothing,
    /// How far apart they are, where single precision says it.
    Bounds,
    /// How far apart they are.
    Distances,
}

struct Meetings<'g, 'p, 'm> {
    ground: &'g Ground<'m>,
    pair: &'p Pair<'m>,
    /// The first crossing ends the search.
    ends_at_crossing: bool,
    surface: Surface,
    found: Vec<FacePair>,
    /// That planes do not part, and that are to be looked at: of several clusters where nothing is
    /// wanted of them at once.
    pairs: FacePairs,
}

impl<'g, 'p, 'm> Meetings<'g, 'p, 'm> {
    fn new(pair: &'p Pair<'m>, ground: &'g Ground<'m>, meets: Meets) -> Self {
        let ends_at_crossing = meets == Meets::UpToCrossing;
        let (surface, found, pairs) = (Meeting::None, Vec::new(), FacePairs::new());
        Self { ground, pair, ends_at_crossing, surface, found, pairs }
    }

    /// The verdict, and the faces that meet by ascending ids.
    fn finish(mut self, counters: &mut impl Tally) -> (Surface, Vec<FacePair>) {
        self.judge(0.0, Wants::Nothing, counters);
        let Self { surface, mut found, .. } = self;
        found.sort_unstable_by_key(|pair| u64::from(pair.first.0) << 32 | u64::from(pair.second.0));
        (surface, found)
    }

    fn is_done(&self) -> bool {
        self.ends_at_crossing && self.surface == Meeting::Cross
    }

    /// Takes note of two faces that meet; whether they do.
    fn look(&mut self, f: FaceId, g: FaceId, counters: &mut impl Tally) -> bool {
        let found = looked_at(self.pair, f, g, counters);
        self.surface = found.map_or(self.surface, |found| self.surface.max(found.meeting));
        self.found.extend(found);
        found.is_some()
    }

    /// Takes note of two faces that certainly cross.
    fn cross(
        &mut self,
        [first, second]: [FaceId; 2],
        crossing: Option<Crossing>,
        counters: &mut impl Tally,
    ) {
        counters.faces([first, second]);
        counters.judged(Arithmetic::Filter);
        self.surface = Meeting::Cross;
        self.found.push(FacePair { first, second, meeting: Meeting::Cross, crossing });
    }

    /// A lower bound of how far two faces that do not meet are apart.
    fn measured(&self, f: FaceId, g: FaceId, counters: &mut impl Tally) -> f64 {
        counters.faces([f, g]);
        let (a, b) = (self.pair.triangle(Side::First, f), self.pair.triangle(Side::Second, g));
        let apart = triangle_distance(&a, &b).squared.sqrt() - self.pair.length_error();
        apart.max(0.0)
    }

    /// Looks at two clusters; returns a lower bound of how far apart they are, up to `reach`. Faces
    /// that `wants` does not have measured count as meeting, unless single precision parts them.
    fn separation(
        &mut self,
        clusters: [u32; 2],
        (reach, wants): (f64, Wants),
        counters: &mut impl Tally,
    ) -> f64 {
        let faced = Faced::of(self.ground, clusters);
        let (mut least, mut its) = (reach, None);
        let is_judged_at_once = wants > Wants::Nothing || self.ends_at_crossing;
        for lane in 0..faced.count() {
            let (near, gaps) = faced.near(lane, faced.bound(least));
            if near == 0 {
                continue;
            }
            let (own, gaps) = (faced.own(lane), gaps.to_array());
            for other in lanes_of(near) {
                let gap = faced.certain(gaps[other]);
                if gap > 0.0 {
                    // What is farther than what was seen does not matter any more.
                    least = least.min(gap);
                    continue;
                }
                if its.is_none() && is_judged_at_once {
                    // What is left of other clusters.
                    self.judge(0.0, Wants::Nothing, counters);
                }
                let its = its.get_or_insert_with(|| faced.its());
                self.pairs.push(&faced, (lane, &own), (other, its), gaps[other]);
                if !is_judged_at_once {
                    // They count as meeting, and nothing is nearer.
                    least = 0.0;
                }
                if self.pairs.is_full() {
                    least = self.judge(least, wants, counters);
                }
            }
        }
        match its {
            Some(_) if is_judged_at_once => self.judge(least, wants, counters),
            _ => least,
        }
    }

    /// Looks at the faces that were noted, of two clusters that are `least` apart but for these;
    /// returns how far apart they are with these.
    fn judge(&mut self, mut least: f64, wants: Wants, counters: &mut impl Tally) -> f64 {
        if self.pairs.is_empty() {
            return least;
        }
        let mut left = self.pairs.lanes();
        if wants > Wants::Nothing {
            left = self.part(left, &mut least);
        }
        if left != 0 {
            let crossings = self.pairs.crossings();
            for lane in lanes_of(left & crossings.crossing()) {
                self.cross(self.pairs.faces(lane), crossings.at(lane), counters);
                if self.ends_at_crossing {
                    break;
                }
            }
            let mut unknown = left & !crossings.crossing() & !crossings.apart();
            if unknown != 0 && wants == Wants::Nothing && !self.is_done() {
                unknown = self.part(unknown, &mut least);
            }
            if left & crossings.crossing() != 0 || wants < Wants::Distances {
                least = 0.0;
            }
            for lane in lanes_of(left & crossings.apart() | unknown) {
                let [f, g] = self.pairs.faces(lane);
                if self.is_done() {
                    break;
                }
                if unknown >> lane & 1 != 0 && self.look(f, g, counters) {
                    least = 0.0;
                }
                if least > 0.0 {
                    least = least.min(self.measured(f, g, counters));
                }
            }
        }
        self.pairs.clear();
        least
    }

    /// Leaves out pairs that single precision parts, and notes by how much.
    fn part(&self, mut lanes: u32, least: &mut f64) -> u32 {
        let unit = self.ground.tree(Side::First).unit();
        let gaps = self.pairs.gaps();
        for lane in lanes_of(lanes) {
            let gap = f64::from(gaps[lane].next_down()) * unit;
            if gap > 0.0 {
                *least = least.min(gap);
                lanes &= !(1 << lane);
            }
        }
        lanes
    }
}

/// The verdict on the surfaces, and the pairs of faces that meet, by ascending ids. `apart`: they
/// are likely to be, and no crossing is looked for first.
pub(crate) fn meeting_faces(
    pair: &Pair,
    ground: &Ground,
    (meets, apart): (Meets, bool),
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>) {
    let first = meets == Meets::UpToCrossing && !apart;
    let search = if first { near_clusters::<true> } else { near_clusters::<false> };
    search(pair, ground, (None, meets), &mut Vec::new(), counters)
}

/// All pairs of faces that meet, by ascending ids, for a caller that searches once.
pub(crate) fn meeting_pairs(pair: &Pair, counters: &mut impl Tally) -> Vec<FacePair> {
    meeting_faces(pair, &Ground::of(pair), (Meets::All, false), counters).1
}

/// One point shared by two crossing surfaces, as a witness on A and one on B; `None` if they do not
/// cross. It depends on models and poses alone: it lies where a search from the top first comes
/// across a crossing.
#[must_use]
pub fn common_point(pair: &Pair, counters: &mut impl Tally) -> Option<[Witness; 2]> {
    let (_, found) = meeting_faces(pair, &Ground::of(pair), (Meets::UpToCrossing, false), counters);
    let crossing = found.iter().find(|faces| faces.meeting == Meeting::Cross);
    crossing.map(|faces| faces.witnesses(pair))
}

/// Which faces that meet are wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meets {
    None,
    All,
    /// Those that the verdict on the solids needs: all that touch, or some up to the first that
    /// crosses.
    UpToCrossing,
}

/// Lists pairs of clusters within reach, and finds the faces that meet, where wanted. `FIRST`: what
/// is likeliest to cross is looked at first.
struct Listing<'s, 'g, 'p, 'm, const FIRST: bool> {
    meetings: Meetings<'g, 'p, 'm>,
    lists: Option<Lists<'s>>,
    meets: Meets,
    listed: &'s mut Vec<[u32; 2]>,
}

impl<const FIRST: bool> Visitor for Listing<'_, '_, '_, '_, FIRST> {
    const ORDER: Order = if FIRST { Order::Crossing } else { Order::Any };

    fn reach(&self) -> f64 {
        self.lists.map_or(0.0, |lists| lists.reach)
    }

    fn closing(&self) -> Option<&Closing> {
        self.lists.and_then(|lists| lists.closing)
    }

    fn clusters(
        &mut self,
        clusters: [u32; 2],
        gap: f64,
        counters: &mut impl Tally,
    ) -> ControlFlow<()> {
        self.listed.extend(self.lists.map(|_| clusters));
        if self.meets != Meets::None && gap <= 0.0 {
            counters.clusters(clusters);
            if !self.meetings.ground.are_parted_by_normals(clusters) {
                self.meetings.separation(clusters, (0.0, Wants::Nothing), counters);
            }
        }
        if self.meetings.is_done() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What a list of pairs of clusters is to hold.
#[derive(Clone, Copy)]
pub(crate) struct Lists<'a> {
    /// All that are as near as this.
    pub(crate) reach: f64,
    /// But those whose contacts count less far, and are farther.
    pub(crate) closing: Option<&'a Closing>,
}

impl Lists<'_> {
    /// Whether two clusters count that are no nearer than `gap`.
    fn hold(&self, ground: &Ground, clusters: [u32; 2], gap: f64) -> bool {
        let within = |closing: &Closing| gap <= closing.of_clusters(ground, clusters);
        gap <= self.reach && (gap <= 0.0 || self.closing.is_none_or(within))
    }
}

/// Lists pairs of clusters, from the top, and finds the faces that meet. A list is whole unless
/// `meets` ends at a crossing.
pub(crate) fn near_clusters<const FIRST: bool>(
    pair: &Pair,
    ground: &Ground,
    (lists, meets): (Option<Lists>, Meets),
    listed: &mut Vec<[u32; 2]>,
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>) {
    let meetings = Meetings::new(pair, ground, meets);
    let mut listing = Listing::<FIRST> { meetings, lists, meets, listed };
    // Who ends it knows.
    let _ = descend(ground, &mut listing, counters);
    listing.meetings.finish(counters)
}

/// The same as [`near_clusters`] among the clusters that a cut holds. `step` is how far anything
/// has moved since the last query, at most. Where faces are wanted, also returns whether surfaces
/// are certain not to have met on the way from the last pose to this one, each vertex moving
/// straight: what lies inside what is then as it was.
pub(crate) fn near_in(
    cut: &mut Cut,
    pair: &Pair,
    ground: &Ground,
    (lists, meets, step): (Option<Lists>, Meets, f64),
    listed: &mut Vec<[u32; 2]>,
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>, bool) {
    debug_assert!(lists.is_none() || meets != Meets::UpToCrossing);
    let mut meetings = Meetings::new(pair, ground, meets);
    let (reach, posing, far) = (cut.reach(), ground.posing(), lists.map_or(0.0, |l| l.reach));
    let (mut stayed_apart, held) = (cut.held_leaves().is_some(), cut.held_leaves().unwrap_or(0));
    let (leaves, spent) = cut.leaves();
    for (i, leaf) in leaves.iter_mut().enumerate() {
        let left = spent.left(leaf);
        if left > far {
            continue;
        }
        counters.clusters(leaf.pair);
        let was_parted = leaf.is_parted;
        let (gap, parts) = ground.cluster_gap(leaf, far);
        spent.note_along(leaf, gap, posing);
        listed.extend(lists.filter(|l| l.hold(ground, leaf.pair, gap)).map(|_| leaf.pair));
        if left > 0.0 || meets == Meets::None {
            continue;
        }
        if gap > 0.0 {
            // Parted along one direction at both ends of the way is parted along it all the way;
            // and what was as far at one end as it is at the other did not meet while motion spent
            // less than both.
            stayed_apart &= i >= held || was_parted && parts || gap - 2.0 * posing + left > 0.0;
            continue;
        }
        let wants = match (leaf.hurry, leaf.met) {
            (0, _) => Wants::Distances,
            (_, false) => Wants::Bounds,
            (_, true) => Wants::Nothing,
        };
        leaf.hurry = leaf.hurry.saturating_sub(1);
        let separation = meetings.separation(leaf.pair, (reach, wants), counters);
        // The same.
        stayed_apart &= i >= held || separation - 2.0 * posing + left > 0.0;
        spent.note(leaf, separation, posing);
        if wants == Wants::Distances {
            leaf.met = separation <= 0.0;
            leaf.hurry = if separation <= WORTH * step { HURRY } else { 0 };
        }
        if meetings.is_done() {
            break;
        }
    }
    let (surface, found) = meetings.finish(counters);
    (surface, found, stayed_apart && meets != Meets::None)
}
