//! Which faces of two surfaces meet.

use std::ops::ControlFlow;

use cranny_exact::Meeting;
use cranny_geometry::FaceId;
use cranny_geometry::clusters::LANES;

use super::apart::FacePairs;
use super::closing::Closing;
use super::cut::Cut;
use super::descent::{Pending, Visitor, descend};
use super::faces::Faced;
use super::ground::Ground;
use super::lanes::lanes_of;
use crate::answer::Surface;
use crate::pair::{Pair, Side};
use crate::surface::{FacePair, looked_at};
use crate::tally::Tally;
use cranny_geometry::triangle_distance::triangle_distance;

/// Faces are worth measuring where they are apart by more than so many steps. Fewer: they are
/// measured again and again; more: clusters are looked at in every query that could rest.
const WORTH: f64 = 4.0;

/// Queries in which they are not measured after it was not worth it.
const HURRY: u8 = 24;

struct Meetings<'g, 'p, 'm> {
    ground: &'g Ground<'m>,
    pair: &'p Pair<'m>,
    /// The first crossing ends the search.
    ends_at_crossing: bool,
    surface: Surface,
    found: Vec<FacePair>,
    /// That planes do not part, and that are to be looked at.
    pairs: FacePairs,
}

impl<'g, 'p, 'm> Meetings<'g, 'p, 'm> {
    fn new(pair: &'p Pair<'m>, ground: &'g Ground<'m>, ends_at_crossing: bool) -> Self {
        let (surface, found, pairs) = (Meeting::None, Vec::new(), FacePairs::new());
        Self { ground, pair, ends_at_crossing, surface, found, pairs }
    }

    /// The verdict, and the faces that meet by ascending ids.
    fn into_found(self) -> (Surface, Vec<FacePair>) {
        let Self { surface, mut found, .. } = self;
        found.sort_unstable();
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

    /// A lower bound of how far two faces that do not meet are apart.
    fn measured(&self, f: FaceId, g: FaceId, counters: &mut impl Tally) -> f64 {
        counters.faces([f, g]);
        let (a, b) = (self.pair.triangle(Side::First, f), self.pair.triangle(Side::Second, g));
        let apart = triangle_distance(&a, &b).squared.sqrt() - self.pair.length_error();
        apart.max(0.0)
    }

    /// Looks at two clusters; returns a lower bound of how far apart they are, up to `reach`. Faces
    /// that nothing parts in single precision are measured for it where `measures`, and count as
    /// meeting where not.
    fn separation(
        &mut self,
        clusters: [u32; 2],
        (reach, measures): (f64, bool),
        counters: &mut impl Tally,
    ) -> f64 {
        let faced = Faced::of(self.ground, clusters);
        let (mut least, mut its) = (reach, None);
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
                let its = its.get_or_insert_with(|| faced.its());
                self.pairs.push(&faced, (lane, &own), (other, its), gaps[other]);
                if self.pairs.is_full() {
                    least = self.judge(least, measures, counters);
                }
            }
        }
        if self.pairs.is_empty() { least } else { self.judge(least, measures, counters) }
    }

    /// Looks at the faces that were noted, of two clusters that are `least` apart but for these;
    /// returns how far apart they are with these.
    fn judge(&mut self, mut least: f64, measures: bool, counters: &mut impl Tally) -> f64 {
        let unit = self.ground.tree(Side::First).unit();
        let mut near = [(0.0, [FaceId(0); 2]); LANES];
        let mut count = 0;
        for (faces, gap) in self.pairs.take() {
            let gap = f64::from(gap.next_down()) * unit;
            if gap > 0.0 {
                least = least.min(gap);
            } else {
                near[count] = (gap, faces);
                count += 1;
            }
        }
        let near = &mut near[..count];
        if self.ends_at_crossing {
            // What seems to overlap most is likeliest to cross.
            near.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        }
        for &(_, [f, g]) in near.iter() {
            if self.is_done() {
                break;
            }
            let meet = self.look(f, g, counters);
            let measures = measures && !meet && least > 0.0;
            least = if measures { least.min(self.measured(f, g, counters)) } else { 0.0 };
        }
        least
    }
}

impl Visitor for Meetings<'_, '_, '_> {
    fn reach(&self) -> f64 {
        0.0
    }

    fn clusters(
        &mut self,
        clusters: [u32; 2],
        _: f64,
        counters: &mut impl Tally,
    ) -> ControlFlow<()> {
        counters.clusters(clusters);
        if self.ground.are_parted_by_normals(clusters) {
            return ControlFlow::Continue(());
        }
        self.separation(clusters, (0.0, false), counters);
        if self.is_done() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn search(
    pair: &Pair,
    ground: &Ground,
    ends_at_crossing: bool,
    stack: &mut Vec<Pending>,
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>) {
    let mut meetings = Meetings::new(pair, ground, ends_at_crossing);
    // Who ends it knows.
    let _ = descend(ground, stack, &mut meetings, counters);
    meetings.into_found()
}

/// All pairs of faces that meet, by ascending ids.
pub(crate) fn meeting_faces(
    pair: &Pair,
    ground: &Ground,
    stack: &mut Vec<Pending>,
    counters: &mut impl Tally,
) -> Vec<FacePair> {
    search(pair, ground, false, stack, counters).1
}

/// The verdict on the surfaces, and the pairs that meet which the verdict on the solids needs: all
/// that touch, or some up to the first that crosses; by ascending ids.
pub(crate) fn first_meeting(
    pair: &Pair,
    ground: &Ground,
    stack: &mut Vec<Pending>,
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>) {
    search(pair, ground, true, stack, counters)
}

/// The same as [`meeting_faces`], for whoever asks once.
pub(crate) fn meeting_pairs(pair: &Pair, counters: &mut impl Tally) -> Vec<FacePair> {
    meeting_faces(pair, &Ground::of(pair), &mut Vec::new(), counters)
}

/// Whether surfaces are certain not to have met on a way from the last pose to this one, each
/// vertex moving straight: what lies inside what is then as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StayedApart(pub(crate) bool);

/// The same as [`meeting_faces`], or with `ends_at_crossing` as [`first_meeting`], among the
/// clusters that a cut lists. `step` is how far anything has moved since the last query, at most.
pub(crate) fn meetings_in(
    cut: &mut Cut,
    pair: &Pair,
    ground: &Ground,
    (ends_at_crossing, step): (bool, f64),
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>, StayedApart) {
    let mut meetings = Meetings::new(pair, ground, ends_at_crossing);
    let (reach, posing) = (cut.reach(), ground.posing());
    let (mut stayed_apart, held) = (cut.held_leaves().is_some(), cut.held_leaves().unwrap_or(0));
    let (leaves, spent) = cut.leaves();
    for (i, leaf) in leaves.iter_mut().enumerate() {
        let left = spent.left(leaf);
        if left > 0.0 {
            continue;
        }
        counters.clusters(leaf.pair);
        let (direction, was_parted) = (leaf.direction, leaf.is_parted);
        let gap = ground.cluster_gap(leaf, 0.0);
        if gap > 0.0 {
            spent.note_along(leaf, gap, posing);
            // Parted along one direction at both ends of the way is parted along it all the way.
            stayed_apart &= i >= held || was_parted && leaf.direction == direction;
            continue;
        }
        let measures = leaf.hurry == 0;
        leaf.hurry = leaf.hurry.saturating_sub(1);
        let separation = meetings.separation(leaf.pair, (reach, measures), counters);
        // So far as they were at one end of the way, and are at the other, they cannot have met
        // while motion spent less than both.
        stayed_apart &= i >= held || separation - 2.0 * posing + left > 0.0;
        spent.note(leaf, separation, posing);
        if measures && separation <= WORTH * step {
            leaf.hurry = HURRY;
        }
        if meetings.is_done() {
            break;
        }
    }
    let (surface, found) = meetings.into_found();
    (surface, found, StayedApart(stayed_apart))
}

/// Lists pairs of clusters within reach, and finds all faces that meet where asked for.
struct Listing<'s, 'g, 'p, 'm> {
    meetings: Meetings<'g, 'p, 'm>,
    lists: Option<f64>,
    closing: Option<&'s Closing>,
    meets: bool,
    listed: &'s mut Vec<[u32; 2]>,
}

impl Visitor for Listing<'_, '_, '_, '_> {
    const IN_ORDER: bool = false;

    fn reach(&self) -> f64 {
        self.lists.unwrap_or(0.0)
    }

    fn closing(&self) -> Option<&Closing> {
        self.closing
    }

    fn clusters(
        &mut self,
        clusters: [u32; 2],
        gap: f64,
        counters: &mut impl Tally,
    ) -> ControlFlow<()> {
        if self.lists.is_some() {
            self.listed.push(clusters);
        }
        if self.meets && gap <= 0.0 {
            return self.meetings.clusters(clusters, gap, counters);
        }
        ControlFlow::Continue(())
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

/// Lists pairs of clusters, from the top; finds all faces that meet, where `meets`.
pub(crate) fn near_clusters(
    pair: &Pair,
    ground: &Ground,
    (lists, meets): (Option<Lists>, bool),
    stack: &mut Vec<Pending>,
    listed: &mut Vec<[u32; 2]>,
    counters: &mut impl Tally,
) -> (Surface, Vec<FacePair>) {
    let meetings = Meetings::new(pair, ground, false);
    let (closing, lists) = (lists.and_then(|lists| lists.closing), lists.map(|lists| lists.reach));
    let mut listing = Listing { meetings, lists, closing, meets, listed };
    // Nothing ends it.
    let _ = descend(ground, stack, &mut listing, counters);
    listing.meetings.into_found()
}

/// Lists pairs of clusters of a cut.
pub(crate) fn list_near(
    cut: &mut Cut,
    ground: &Ground,
    lists: Lists,
    listed: &mut Vec<[u32; 2]>,
    counters: &mut impl Tally,
) {
    let (posing, reach) = (ground.posing(), lists.reach);
    let counts = |pair, gap: f64| {
        gap <= 0.0 || lists.closing.is_none_or(|closing| gap <= closing.of_clusters(ground, pair))
    };
    let (leaves, spent) = cut.leaves();
    for leaf in leaves {
        if spent.left(leaf) > reach {
            continue;
        }
        counters.clusters(leaf.pair);
        let gap = ground.cluster_gap(leaf, reach);
        spent.note_along(leaf, gap, posing);
        if gap <= reach && counts(leaf.pair, gap) {
            listed.push(leaf.pair);
        }
    }
}
