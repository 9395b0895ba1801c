//! Candidates by pairs of patches, and how long they last.
//!
//! A list is made with a *skin*: it holds every pair of features that may make a contact once
//! bodies have come nearer by that, and turned by a little. Until they have, the list is evaluated
//! again and nothing is searched (as neighbour lists in molecular dynamics: Verlet, 1967). A list
//! that does not last is made without a skin, which is cheaper.

use cranny_exact::RigidMap;
use cranny_geometry::{EdgeId, FaceId, PatchId, VertexId};

use super::feature_pair::{Stand, edge_edge, vertex_face, vertex_rim};
use super::nearer;
use super::wanted::Wanted;
use crate::answer::{Contact, Feature, Surface};
use crate::backoff::Backoff;
use crate::coherent::Coherent;
use crate::motion::RelativeMotion;
use crate::pair::{Pair, PairTag, Side};
use crate::search::{
    Candidate, Closing, Ground, Kind, Lasting, Lists, Meets, PatchPairs, Turned, add_candidates,
};
use crate::surface::FacePair;
use crate::tally::Tally;
use cranny_geometry::triangle_distance::Part;

/// A skin is meant to last for so many steps like the last. Smaller: lists are made again and
/// again; larger: they are long.
const SKIN_STEPS: f64 = 8.0;

/// A skin is at least this part of the margin, so that bodies at rest keep their list.
const LEAST_SKIN: f64 = 0.125;

/// It is at most this part of the margin, except where faces are long ([`OF_FACE`]).
const MOST_SKIN: f64 = 0.5;

/// A skin is at most this part of a face's length where that is more than [`MOST_SKIN`] allows.
/// Larger: lists hold what never comes near.
const OF_FACE: f64 = 0.15;

/// A skin that lasts for fewer steps than this is not worth its list.
const WORTH: f64 = 3.0;

/// Turns for which a list lasts at most: the sine by which what faces what may change. Larger: more
/// edges are listed.
const MOST_TURN: f64 = 0.1;
const LEAST_TURN: f64 = 1e-4;

/// Lists of more candidates than this are not kept. Larger: memory of wide margins grows without a
/// bound.
const MOST_KEPT: usize = 1 << 14;

/// Candidates of one pair of patches.
#[derive(Clone, Debug)]
struct Range {
    patches: [PatchId; 2],
    start: u32,
    end: u32,
    /// Which of them won last.
    winner: u32,
}

/// For how long a list lasts.
#[derive(Clone, Debug)]
struct Skin {
    since: RigidMap,
    reach: f64,
    turn: f64,
    margin: f64,
}

/// What searches for contacts keep for the next one.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactMemory {
    tag: PairTag,
    candidates: Vec<Candidate>,
    ranges: Vec<Range>,
    /// `None`: the list is that of one pose.
    skin: Option<Skin>,
    /// How much nearer anything has come since the list was made.
    moved: f64,
    /// The winners of a list that is gone, in the order of patches.
    winners: Vec<Winner>,
    backoff: Backoff,
    last: Option<RigidMap>,
}

/// Which candidate won in a pair of patches.
#[derive(Clone, Copy, Debug)]
struct Winner {
    patches: [PatchId; 2],
    ids: [u32; 2],
    kind: Kind,
}

impl ContactMemory {
    /// Lets go of what is of use only while bodies are near each other.
    pub(crate) fn let_go(&mut self) {
        if self.last.is_some() {
            *self = Self::default();
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.candidates.capacity() * size_of::<Candidate>()
            + self.ranges.capacity() * size_of::<Range>()
            + self.winners.capacity() * size_of::<Winner>()
    }

    /// Sees to it that the list is that of the pair's pose, and finds all faces that meet, unless
    /// `meets` is none.
    pub(super) fn search(
        &mut self,
        pair: &Pair,
        wanted: &Wanted,
        meets: Meets,
        coherent: &mut Coherent,
        counters: &mut impl Tally,
    ) -> (Surface, Vec<FacePair>) {
        let ground = Ground::of(pair);
        let lasting = self.prepare(pair, wanted);
        let closing = wanted.closing(pair, &ground);
        let lists = lasting.map(|lasting| Lists {
            reach: lasting.margin + lasting.skin,
            closing: closing.as_ref(),
        });
        if meets == Meets::None && lists.is_none() {
            return (Surface::None, Vec::new());
        }
        let mut clusters = Vec::new();
        let found = coherent.near(pair, &ground, (lists, &mut clusters), meets, counters);
        if let Some(lasting) = lasting {
            self.make(pair, &ground, (lasting, closing.as_ref()), &mut clusters, counters);
        }
        found
    }

    /// How a new list is to last; `None` where the one that is there does.
    fn prepare(&mut self, pair: &Pair, wanted: &Wanted) -> Option<Lasting> {
        let margin = wanted.farthest();
        if !self.tag.is_of(pair) {
            *self = Self { tag: PairTag::of(pair), ..Self::default() };
        }
        let models = pair.models();
        let since = |map: &RigidMap| {
            RelativeMotion::since(map, pair)
                .map_or((0.0, 0.0), |motion| (motion.step(models), motion.stretch()))
        };
        let step = self.last.as_ref().map(since);
        self.last = Some(pair.first_from_second);
        if let Some(skin) = &self.skin {
            let (moved, turned) = since(&skin.since);
            let posing = 2.0 * pair.culling_error();
            if margin <= skin.margin && moved + posing <= skin.reach && turned <= skin.turn {
                self.moved = moved + posing;
                self.backoff.succeeded();
                return None;
            }
            if self.moved == 0.0 {
                self.backoff.failed();
            }
        }
        let now = Lasting { margin, skin: 0.0, turn: 0.0 };
        // The next motion closes others.
        if wanted.is_of_motion() {
            return Some(now);
        }
        let Some((moved, turned)) = step.filter(|_| self.backoff.is_due()) else {
            return Some(now);
        };
        let length = Side::BOTH.map(|side| face_length(pair, side));
        let most = (OF_FACE * length[0].min(length[1])).max(MOST_SKIN * margin);
        let skin = (SKIN_STEPS * moved).max(LEAST_SKIN * margin).min(most);
        if skin < WORTH * moved || skin <= 0.0 {
            return Some(now);
        }
        let steps = if moved > 0.0 { (skin / moved).min(50.0) } else { 50.0 };
        let turn = (turned * steps).clamp(LEAST_TURN, MOST_TURN);
        Some(Lasting { margin, skin, turn })
    }

    /// Makes the list from pairs of clusters within reach.
    fn make(
        &mut self,
        pair: &Pair,
        ground: &Ground,
        (lasting, closing): (Lasting, Option<&Closing>),
        clusters: &mut [[u32; 2]],
        counters: &mut impl Tally,
    ) {
        self.note_winners();
        self.candidates.clear();
        // About as many as it will hold.
        self.candidates.reserve(2 * clusters.len());
        clusters.sort_unstable();
        let (mut patches, mut turned) = (PatchPairs::default(), Turned::default());
        for &pair in clusters.iter() {
            counters.clusters(pair);
            let margin =
                closing.map_or(lasting.margin, |closing| closing.of_clusters(ground, pair));
            let lasting = Lasting { margin, ..lasting };
            let found = (&mut patches, &mut self.candidates);
            add_candidates(ground, pair, lasting, &mut turned, found);
        }
        self.moved = 0.0;
        self.skin = None;
        if lasting.skin > 0.0 {
            if self.candidates.len() <= MOST_KEPT {
                let Lasting { margin, skin: reach, turn } = lasting;
                self.skin = Some(Skin { since: pair.first_from_second, reach, turn, margin });
            } else {
                self.backoff.failed();
            }
        }
        self.divide(&patches);
    }

    /// Lets go of a list of one pose, once it is evaluated: but for those who won.
    pub(super) fn end(&mut self) {
        if self.skin.is_none() {
            self.note_winners();
            (self.candidates, self.ranges) = Default::default();
            self.winners.shrink_to_fit();
        }
    }

    /// Remembers who won in each pair of patches.
    fn note_winners(&mut self) {
        let Self { candidates, ranges, winners, .. } = self;
        let won = ranges.iter().filter(|range| range.winner < range.end);
        winners.extend(won.map(|range| {
            let Candidate { ids, kind, .. } = candidates[range.winner as usize];
            Winner { patches: range.patches, ids, kind }
        }));
        ranges.clear();
    }

    /// Puts candidates of the same patches side by side, and finds last query's winners among them.
    fn divide(&mut self, patches: &PatchPairs) {
        let Self { candidates, ranges, winners, .. } = self;
        let mut known = winners.iter().peekable();
        let mut start = 0;
        for (patches, end) in patches.gather(candidates) {
            while known.next_if(|won| won.patches < patches).is_some() {}
            let group = &candidates[start as usize..end as usize];
            let won = known
                .next_if(|won| won.patches == patches)
                .and_then(|won| group.iter().position(|c| c.ids == won.ids && c.kind == won.kind));
            let winner = won.map_or(u32::MAX, |at| start + at as u32);
            ranges.push(Range { patches, start, end, winner });
            start = end;
        }
        *winners = Vec::new();
        if self.skin.is_some() {
            self.candidates.shrink_to_fit();
            self.ranges.shrink_to_fit();
        }
    }

    /// Calls `each` with each pair of patches that has candidates.
    pub(super) fn each_group<T: Tally>(
        &mut self,
        pair: &Pair,
        wanted: &Wanted,
        counters: &mut T,
        mut each: impl FnMut(&mut Group<T>),
    ) {
        let unit = pair.model(Side::Second).clusters().unit();
        let Self { candidates, ranges, moved, .. } = self;
        for range in ranges {
            let list = &candidates[range.start as usize..range.end as usize];
            let mut group = Group { pair, list, range, unit, moved: *moved, wanted, counters };
            each(&mut group);
        }
    }
}

/// A length of the faces of a body.
fn face_length(pair: &Pair, side: Side) -> f64 {
    let model = pair.model(side);
    let patches = model.patches().patches();
    let area: f64 = patches.iter().map(|patch| patch.area).sum();
    (2.0 * area / model.mesh().faces().len() as f64).sqrt()
}

/// The candidates of a pair of patches.
pub(super) struct Group<'s, 'p, 'm, T> {
    pair: &'p Pair<'m>,
    list: &'s [Candidate],
    range: &'s mut Range,
    unit: f64,
    moved: f64,
    wanted: &'s Wanted,
    counters: &'s mut T,
}

impl<T: Tally> Group<'_, '_, '_, T> {
    pub(super) fn patches(&self) -> [PatchId; 2] {
        self.range.patches
    }

    /// How near the contact of a candidate can be.
    fn bound(&self, candidate: &Candidate) -> f64 {
        f64::from(candidate.bound) * self.unit - self.moved
    }

    /// The contact of a candidate, no farther than `limit` and than motion may close it.
    fn contact(&self, candidate: &Candidate, limit: f64) -> Option<Contact> {
        contact(self.pair, candidate, limit.min(candidate.reach.into()))
    }

    /// The nearest contact, if it counts.
    pub(super) fn nearest(&mut self) -> Option<Contact> {
        let mut best: Option<Contact> = None;
        let mut limit = self.wanted.farthest();
        let first = self.first();
        for at in std::iter::once(first).chain((0..self.list.len()).filter(|&at| at != first)) {
            let candidate = &self.list[at];
            if self.bound(candidate) > limit {
                continue;
            }
            self.counters.features(candidate.features());
            if let Some(found) = self.contact(candidate, limit)
                && best.is_none_or(|best| nearer(&found, &best).is_lt())
            {
                limit = found.separation.max(0.0);
                best = Some(found);
                self.range.winner = self.range.start + at as u32;
            }
        }
        best.filter(|contact| self.wanted.holds(contact))
    }

    /// The candidate that won last, or one of the least bound.
    fn first(&self) -> usize {
        let won = (self.range.winner as usize).wrapping_sub(self.range.start as usize);
        if won < self.list.len() {
            return won;
        }
        let bounds = self.list.iter().map(|candidate| candidate.bound).enumerate();
        bounds.min_by(|x, y| x.1.total_cmp(&y.1)).map_or(0, |(at, _)| at)
    }

    /// All contacts that count.
    pub(super) fn all(&mut self, all: &mut Vec<Contact>) {
        let farthest = self.wanted.farthest();
        for candidate in self.list {
            if self.bound(candidate) > farthest {
                continue;
            }
            self.counters.features(candidate.features());
            let found = self.contact(candidate, farthest);
            all.extend(found.filter(|contact| self.wanted.holds(contact)));
        }
    }
}

/// The contact of a candidate, no farther than `below`, and not behind by more than rounding.
pub(super) fn contact(pair: &Pair, candidate: &Candidate, below: f64) -> Option<Contact> {
    let [first, second] = candidate.ids;
    let found = match candidate.kind {
        Kind::CornerFace => corner(pair, Side::First, VertexId(first), FaceId(second), below),
        Kind::FaceCorner => corner(pair, Side::Second, VertexId(second), FaceId(first), below),
        Kind::Edges => edge_edge(pair, EdgeId(first), EdgeId(second), below)
            .filter(|contact| contact.separation >= -pair.length_error()),
    };
    found.filter(|contact| contact.separation <= below)
}

/// The contact of a vertex before a face, or before what of its rim counts to it.
fn corner(pair: &Pair, side: Side, vertex: VertexId, face: FaceId, below: f64) -> Option<Contact> {
    let other = side.other();
    let at = pair.position(side, vertex);
    match vertex_face(pair, side, (vertex, at), (face, &pair.triangle(other, face)), below) {
        Stand::Over(found) => found,
        Stand::Beside(part) => {
            let model = pair.model(other);
            let owned = model.clusters().owned(face);
            let is_owned = match part {
                Part::Corner(i) => owned.corners >> i & 1 != 0,
                Part::Edge(i) => owned.sides >> i & 1 != 0,
                Part::Inside => false,
            };
            let rim = Feature::of_part(part, model, face);
            // Two vertices are one pair, found from the first.
            let twice = side == Side::Second && matches!(rim, Feature::Vertex(_));
            if is_owned && !twice { vertex_rim(pair, side, vertex, rim, below) } else { None }
        }
    }
}
