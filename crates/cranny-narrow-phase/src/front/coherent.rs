//! What a pair remembers of its last query, and how the next one uses it.
//!
//! Three things: the front; the faces that crossed last, looked at first where a verdict is enough;
//! the faces that were nearest last, whose distance bounds the next one. And while surfaces part, on
//! a way that the front proves free of meetings, what lies inside what stays.

use cranny_exact::{DVec3, Meeting, judge_triangles};
use cranny_geometry::FaceId;

use super::quests::Meetings;
use super::{Front, Nodes, Quest};
use crate::answer::{Counters, Surface};
use crate::closest::{Closest, NearestFaces, search};
use crate::contacts::{Kept, meetings_of_patches};
use crate::containment::{Solidity, solidity};
use crate::foremost::Foremost;
use crate::pair::{Pair, Side, Whose};
use crate::patience::Patience;
use crate::surface::{FacePair, meeting_pairs, strongest, surface_verdict};

/// Crossing faces that are kept at most. More: more to look at before giving up; fewer: a search
/// whenever the last of them have parted.
const KEPT_CROSSINGS: usize = 8;

/// Pairs of faces that a verdict looks at before it is sought among patches, whose planes part what boxes
/// cannot. Fewer: patches are posed where boxes would have told as soon; more: a nut on its bolt, where
/// boxes leave 150,000, pays for them first.
const MOST_FACES: u64 = 2_000;

/// A search among patches that compares fewer pairs of nodes than this shows that boxes would do again.
const FEW_NODES: u64 = 4_000;

/// When a front is worth building: not for a single query, and not while motion outruns it.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    asked: bool,
    patience: Patience,
}

impl Pace {
    fn allows_front(&mut self) -> bool {
        let waited = self.patience.is_over();
        std::mem::replace(&mut self.asked, true) && waited
    }
}

/// What is kept of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coherent {
    whose: Whose,
    front: Option<Front>,
    /// The front's odometers show this query's pose.
    advanced: bool,
    /// Pairs of nodes of a front that was let go because it had grown too fine.
    too_fine: u64,
    crossing: Vec<[FaceId; 2]>,
    /// Whether to look at them: in vain, where motion is so fast that none crosses for a second time.
    following: Patience,
    /// The last crossing was found from the top: motion is too fast to follow it from face to face.
    searched: bool,
    nearest: Option<[FaceId; 2]>,
    foremost: Foremost,
    /// Boxes do not part the surfaces, the planes of patches do.
    slanted: bool,
    patches: Kept,
    /// What lies inside what, at the front's pose, where the surfaces did not meet.
    apart: Option<Solidity>,
    pace: Pace,
}

impl Coherent {
    /// Begins a query; forgets what was known of other models.
    pub(crate) fn begin(&mut self, pair: &Pair) {
        if !self.whose.are_of(pair) {
            *self = Self { whose: Whose::of(pair), ..Self::default() };
        }
        self.advanced = false;
    }

    /// Whether faces are known that crossed in the last query: looking at them comes first then.
    pub(crate) fn has_crossed(&self) -> bool {
        !self.crossing.is_empty()
    }

    /// The front, moved to this pose; `None` if there is none that is worth its while.
    fn ready(&mut self, pair: &Pair, limit: f64, counters: &mut Counters) -> Option<&mut Front> {
        let front = self.front.as_mut()?;
        if !self.advanced {
            front.advance(pair);
            self.advanced = true;
        }
        if front.is_exhausted(pair, limit) {
            counters.bypassed += 1;
            self.pace.patience.failed();
            self.front = None;
        } else if front.is_sparse() {
            self.too_fine = front.held();
            self.front = None;
        } else {
            self.pace.patience.succeeded();
        }
        self.front.as_mut()
    }

    /// Descends from the top and keeps where that ends, unless that is more than is worth keeping.
    fn keep_front(&mut self, pair: &Pair, quest: &mut impl Quest, counters: &mut Counters) {
        self.front = Front::of(pair, quest, counters);
        counters.front_merged += std::mem::take(&mut self.too_fine).saturating_sub(self.held());
        self.advanced = true;
        if self.front.is_none() && !quest.is_done() {
            self.pace.patience.failed();
        }
    }

    /// The verdict on the surfaces, and what the verdict on the solids needs of the touching pairs.
    /// `build`: nothing finer will be asked, so a front may be built for it.
    pub(crate) fn verdict(
        &mut self,
        pair: &Pair,
        build: bool,
        counters: &mut Counters,
    ) -> (Surface, Vec<FacePair>) {
        let crossed = !self.crossing.is_empty();
        if self.still_cross(pair, counters) {
            self.apart = None;
            return (Meeting::Cross, Vec::new());
        }
        let mut quest = Meetings::new(pair, true);
        let unbroken = if let Some(front) = self.ready(pair, 0.0, counters) {
            front.refresh(pair, &mut quest, counters)
        } else if build && !crossed && !self.slanted && self.pace.allows_front() {
            self.keep_front(pair, &mut quest, counters);
            false
        } else {
            self.apart = None;
            let (surface, touching) = self.verdict_from_the_top(pair, counters);
            self.searched = crossed;
            if surface == Meeting::Cross {
                self.remember_crossings(&touching);
            }
            return (surface, touching);
        };
        self.apart = self.apart.filter(|_| unbroken);
        let (surface, mut found) = (quest.surface, quest.found);
        found.sort_unstable();
        if surface == Meeting::Cross {
            self.remember_crossings(&found);
        }
        (surface, found)
    }

    /// By boxes, or by the planes of patches where boxes do not tell.
    fn verdict_from_the_top(
        &mut self,
        pair: &Pair,
        counters: &mut Counters,
    ) -> (Surface, Vec<FacePair>) {
        if !self.slanted {
            if let Some(told) = surface_verdict(pair, MOST_FACES, counters) {
                return told;
            }
            self.slanted = true;
        }
        let before = counters.node_tests;
        let touching = meetings_of_patches(pair, true, &mut self.patches, counters);
        let surface = strongest(&touching);
        let few = counters.node_tests - before < FEW_NODES;
        self.slanted = !few || surface == Meeting::Cross;
        if !self.slanted {
            self.patches.let_go();
        }
        (surface, touching)
    }

    /// Lets go of what is of use only while patches are near each other.
    pub(crate) fn let_go(&mut self) {
        self.patches.let_go();
    }

    /// All pairs of faces that meet, by ascending ids.
    pub(crate) fn meetings(&mut self, pair: &Pair, counters: &mut Counters) -> Vec<FacePair> {
        let mut quest = Meetings::new(pair, false);
        let unbroken = if let Some(front) = self.ready(pair, 0.0, counters) {
            front.refresh(pair, &mut quest, counters)
        } else if self.pace.allows_front() {
            self.keep_front(pair, &mut quest, counters);
            false
        } else {
            self.apart = None;
            return meeting_pairs(pair, counters);
        };
        self.apart = self.apart.filter(|_| unbroken);
        let mut found = quest.found;
        found.sort_unstable();
        self.remember_crossings(&found);
        found
    }

    /// What the surfaces' meeting means for the solids.
    pub(crate) fn solidity(
        &mut self,
        pair: &Pair,
        surface: Surface,
        touching: &[FacePair],
        counters: &mut Counters,
    ) -> Solidity {
        if surface != Meeting::None {
            self.apart = None;
            return solidity(pair, surface, touching, counters);
        }
        *self.apart.get_or_insert_with(|| solidity(pair, surface, touching, counters))
    }

    /// The nearest points of surfaces that do not meet, if they are less than `below` apart. `parting`: along which the
    /// hulls are apart, of no length if that is not known.
    pub(crate) fn closest(
        &mut self,
        pair: &Pair,
        below: f64,
        parting: DVec3,
        counters: &mut Counters,
    ) -> Option<Closest> {
        let mut nearest = NearestFaces::less_than(pair, below);
        if let Some([f, g]) = self.nearest {
            nearest.offer(f, g, counters);
        }
        if self.foremost.offer(pair, parting, &mut nearest, counters) {
            // All that could be nearer was measured.
        } else if let Some(front) = self.ready(pair, nearest.limit(), counters) {
            front.refresh(pair, &mut nearest, counters);
        } else if nearest.limit() < f64::INFINITY && self.pace.allows_front() {
            self.keep_front(pair, &mut nearest, counters);
        } else {
            self.pace.asked = true;
            search(pair, &mut nearest, counters);
        }
        let found = nearest.found();
        self.nearest = found.map(|f| f.faces).or(self.nearest);
        found
    }

    /// Whether faces that crossed before still do, or some beside them: a curve in which surfaces cross
    /// leaves a face for one that shares a corner with it, mostly while the other face stays.
    fn still_cross(&mut self, pair: &Pair, counters: &mut Counters) -> bool {
        if self.crossing.is_empty() {
            return false;
        }
        if !self.following.is_over() {
            self.crossing.clear();
            return false;
        }
        let found = self.followed_crossing(pair, counters);
        match found {
            true => self.following.succeeded(),
            false => self.following.failed(),
        }
        found
    }

    fn followed_crossing(&mut self, pair: &Pair, counters: &mut Counters) -> bool {
        let mut crosses = |&[f, g]: &[FaceId; 2]| {
            counters.triangle_tests += 1;
            let (first, second) = (pair.triangle(Side::First, f), pair.triangle(Side::Second, g));
            let (meeting, by) = judge_triangles(&first, &second);
            counters.judged(by);
            meeting == Meeting::Cross
        };
        if let Some(i) = self.crossing.iter().position(&mut crosses) {
            self.crossing.drain(..i);
            self.searched = false;
            return true;
        }
        let beside = |side: Side, face: FaceId| {
            let corners = pair.mesh(side).corners(face);
            corners.into_iter().flat_map(move |v| pair.topology(side).faces_at(v).iter().copied())
        };
        let followed = self.crossing.first().filter(|_| !self.searched);
        let found = followed.and_then(|&[f, g]| {
            let mut neighbours = beside(Side::First, f)
                .map(|f| [f, g])
                .chain(beside(Side::Second, g).map(|g| [f, g]));
            neighbours.find(&mut crosses)
        });
        self.crossing.clear();
        self.crossing.extend(found);
        found.is_some()
    }

    /// Keeps some of the crossing pairs, evenly spread.
    fn remember_crossings(&mut self, pairs: &[FacePair]) {
        let crossing = || pairs.iter().filter(|p| p.meeting == Meeting::Cross);
        let stride = crossing().count().div_ceil(KEPT_CROSSINGS).max(1);
        self.crossing.clear();
        self.crossing.extend(crossing().step_by(stride).map(|p| [p.first, p.second]));
    }

    /// Pairs of nodes of the front.
    pub(crate) fn held(&self) -> u64 {
        self.front.as_ref().map_or(0, Front::held)
    }

    /// The front, if the last query was about this pair at its pose and used one.
    pub(crate) fn front_at(&self, pair: &Pair) -> Option<impl Iterator<Item = (Nodes, f64)> + '_> {
        let is_used = self.advanced && self.whose.are_of(pair);
        let front = self.front.as_ref().filter(|front| is_used && front.is_at(pair))?;
        Some(front.entries())
    }

    /// Faces that crossed last.
    pub(crate) fn crossing_of(&self, pair: &Pair) -> &[[FaceId; 2]] {
        if self.whose.are_of(pair) { &self.crossing } else { &[] }
    }

    /// Faces that were nearest last.
    pub(crate) fn nearest_of(&self, pair: &Pair) -> Option<[FaceId; 2]> {
        self.nearest.filter(|_| self.whose.are_of(pair))
    }

    pub(crate) fn bytes(&self) -> usize {
        self.front.as_ref().map_or(0, Front::bytes)
            + self.crossing.capacity() * size_of::<[FaceId; 2]>()
            + self.patches.bytes()
            + self.foremost.bytes()
    }
}
