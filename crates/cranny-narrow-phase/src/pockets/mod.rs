//! Which parts of two hulls meet, and what lies in the pockets beneath: the second complete way to the faces that meet.
//!
//! The faces of a body are those in its concavities and the rest, which lies on the hull. Where two hulls meet, each
//! part of one body is asked against each part of the other: rest against rest is contact on the hulls, rest against
//! concavity is a thing in a pocket, concavity against concavity is one pocket in another. A concavity is opened only
//! where the other body's hull may reach its faces, whether or not that crosses a lid: not where the hull is beyond a
//! lid, nor where it offends no facet of the first layer of the pocket's envelope. A ball in a cup, a peg in its hole
//! do so nearly always; in the core of the pocket, beyond all planes of the layer, one plane says so, kept from the last
//! query.
//!
//! What is open is descended by the layers of its envelope, against the boxes of the other's part ([`descent`]): only
//! facets that a box offends are opened. Which way is taken changes the time, never the answer: the pairs of faces
//! that are handed over hold all that meet, and the exact test is the same.
//!
//! Source: opening concavities under the features of hulls that meet, and envelopes with pseudo-Voronoi cells, are after
//! Ponamgi, Manocha and Lin (1997, "Incremental algorithms for collision detection between polygonal models"); see
//! [`Envelopes`](cranny_concavity::Envelopes).
//!
//! Cost of a query: for each body the extent of the other's hull (six support points, climbed to) and a comparison of
//! boxes with each of its concavities; two support points for each lid of those that remain, and one more where the cell
//! stays; then what is opened.

mod descent;
mod hull_extent;

use std::ops::ControlFlow;
use std::sync::Arc;

use cranny_concavity::envelope::{Cell, Passage, Thing};
use cranny_concavity::{Concavities, ConcavityId, Envelope, LayerId};
use cranny_exact::{DVec3, Meeting, RigidMap};
use cranny_geometry::{FaceId, Model};

use self::descent::{Part, for_each_pair_in_pocket, for_each_pair_of_rests};
use self::hull_extent::HullExtent;
use crate::answer::Counters;
use crate::motion::{Ball, Motion};
use crate::node_set::{NodeSet, bytes_of_pair, of_models};
use crate::observe::{MetParts, PairObserver};
use crate::pair::{Pair, Side, Whose};
use crate::surface::{FacePair, looked_at};

/// A concavity of one body whose first layer the other's hull was held against.
#[derive(Clone, Copy, Debug)]
struct Met {
    concavity: ConcavityId,
    cell: Cell,
}

/// What is kept of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pockets {
    whose: Whose,
    /// The relative pose of the last query.
    map: Option<RigidMap>,
    /// By side, ascending.
    met: [Vec<Met>; 2],
    /// By side, ascending: those of them whose faces were looked for, and those of the query before.
    open: [Vec<ConcavityId>; 2],
    open_before: [Vec<ConcavityId>; 2],
    bodies: Option<[Arc<Body>; 2]>,
}

/// What a model does not hold.
#[derive(Debug)]
struct Body {
    concavities: Arc<Concavities>,
    /// The nodes of the tree that hold a face in no concavity.
    rest: NodeSet,
}

impl Body {
    fn of(model: &Model, concavities: Arc<Concavities>) -> Self {
        let rest = NodeSet::of(model.tree(), |face| concavities.of_face(face).is_none());
        Self { concavities, rest }
    }
}

impl Pockets {
    /// Takes concavities of the models that somebody has made.
    pub(crate) fn hold(&mut self, pair: &Pair, of: [&Arc<Concavities>; 2]) {
        let models = Side::BOTH.map(|side| pair.model(side));
        let body = |i: usize| Arc::new(Body::of(models[i], Arc::clone(of[i])));
        let first = body(0);
        let second = if models[0].is_same(models[1]) { Arc::clone(&first) } else { body(1) };
        let bodies = [first, second];
        *self = Self { whose: Whose::of(pair), bodies: Some(bodies), ..Self::default() };
    }

    /// The pairs of faces that meet, by ascending ids. `only_verdict`: ends at the first that cross, which is then
    /// among them.
    pub(crate) fn meetings(
        &mut self,
        pair: &Pair,
        only_verdict: bool,
        counters: &mut Counters,
    ) -> Vec<FacePair> {
        if !self.whose.are_of(pair) {
            *self = Self { whose: Whose::of(pair), ..Self::default() };
        }
        let bodies = self.bodies(pair, counters);
        let open = self.opened(pair, &bodies, counters);
        let parts = Side::BOTH.map(|side| {
            let Body { concavities, rest } = &*bodies[side.index()];
            let pockets = open[side.index()].iter().filter_map(|&id| Part::pocket(concavities, id));
            let rest = Part::rest(pair.model(side), concavities, rest);
            rest.into_iter().chain(pockets).collect::<Vec<_>>()
        });
        let envelopes = [0, 1].map(|i| bodies[i].concavities.envelopes());
        let mut found = Vec::new();
        let mut look = |f: FaceId, g: FaceId, counters: &mut Counters| {
            let meeting = looked_at(pair, f, g, counters);
            found.extend(meeting);
            let ends = only_verdict && meeting.is_some_and(|m| m.meeting == Meeting::Cross);
            if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut meet = |first: &Part, second: &Part| match (first.concavity, second.concavity) {
            (Some(id), _) => {
                let pocket = (envelopes[0], id);
                for_each_pair_in_pocket(pair, Side::First, pocket, second, counters, &mut look)
            }
            (None, Some(id)) => {
                let pocket = (envelopes[1], id);
                let look = |f, g, c: &mut Counters| look(g, f, c);
                for_each_pair_in_pocket(pair, Side::Second, pocket, first, counters, look)
            }
            (None, None) => for_each_pair_of_rests(pair, [first, second], counters, &mut look),
        };
        let [ours, theirs] = &parts;
        let all = ours.iter().flat_map(|first| theirs.iter().map(move |second| (first, second)));
        // Whether all was looked at does not matter to whoever wants a verdict.
        let _ = { all }.try_for_each(|(first, second)| meet(first, second));
        found.sort_unstable();
        found
    }

    /// By side, the concavities whose faces the other body may reach.
    fn opened(
        &mut self,
        pair: &Pair,
        bodies: &[Arc<Body>; 2],
        counters: &mut Counters,
    ) -> [Vec<ConcavityId>; 2] {
        let before = self.map.replace(pair.first_from_second);
        let motion = before.map(|before| Motion::since(&before, pair));
        let open = Side::BOTH.map(|side| {
            let guest = Ball::around(&pair.model(side.other()).bounds());
            let step_of = |motion: &Motion| motion.step_of(side.other(), &guest);
            let step = motion.as_ref().map(|motion| motion.as_ref().map_or(0.0, step_of));
            let before = std::mem::take(&mut self.met[side.index()]);
            let concavities = &bodies[side.index()].concavities;
            let (met, open) = opened_on(pair, side, concavities, (&before, step), counters);
            self.met[side.index()] = met;
            open
        });
        self.open_before = std::mem::replace(&mut self.open, open.clone());
        open
    }

    /// What the models do not hold; made now, where nobody has.
    fn bodies(&mut self, pair: &Pair, counters: &mut Counters) -> [Arc<Body>; 2] {
        let bodies = self.bodies.get_or_insert_with(|| {
            let bodies = of_models(pair, |model| Body::of(model, Arc::new(Concavities::of(model))));
            counters.concavities_made += if Arc::ptr_eq(&bodies[0], &bodies[1]) { 1 } else { 2 };
            bodies
        });
        bodies.clone()
    }

    /// Whether the last query was about these models at this pose.
    fn is_at(&self, pair: &Pair) -> bool {
        self.whose.are_of(pair) && self.map.is_some_and(|map| map == pair.first_from_second)
    }

    /// Shows what the last query, if it was this one, has opened and closed, and which parts it asked against each other.
    pub(crate) fn show(&self, pair: &Pair, observer: &mut impl PairObserver) {
        let [ours, theirs] = Side::BOTH.map(|side| pair.bounds(side));
        let Some(bodies) = self.bodies.as_ref().filter(|_| self.is_at(pair)) else { return };
        if !ours.overlaps(&theirs) {
            return;
        }
        let rests = [0, 1].map(|i| bodies[i].rest.has(0));
        let parts = Side::BOTH.map(|side| {
            let index = side.index();
            let rest = rests[index].then_some(None);
            rest.into_iter().chain(self.open[index].iter().copied().map(Some)).collect::<Vec<_>>()
        });
        for &first in &parts[0] {
            for &second in &parts[1] {
                let [a, b] = pair.ordered(first, second);
                observer.parts(MetParts { a, b });
            }
        }
        for side in Side::BOTH {
            let index = side.index();
            let [is_first, is_second] = [side == Side::First, side == Side::Second];
            let body = usize::from(pair.ordered(is_first, is_second)[1]);
            let (now, before) = (&self.open[index], &self.open_before[index]);
            let only = |these: &[ConcavityId], those: &[ConcavityId]| -> Vec<ConcavityId> {
                these.iter().copied().filter(|id| those.binary_search(id).is_err()).collect()
            };
            only(now, before).into_iter().for_each(|id| observer.opened(body, id));
            only(before, now).into_iter().for_each(|id| observer.closed(body, id));
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        let met = self.met.iter().map(|met| met.capacity() * size_of::<Met>()).sum::<usize>();
        let open = self.open.iter().chain(&self.open_before).map(Vec::capacity).sum::<usize>();
        met + open * size_of::<ConcavityId>()
            + self.bodies.as_ref().map_or(0, |pair| bytes_of_pair(pair, |body| body.rest.bytes()))
    }
}

/// Whether a thing may offend a facet of a layer: not where its box misses that of the faces beneath, either, though it
/// comes below the plane elsewhere, as a long peg does.
fn offends<F: Fn(DVec3) -> f64>(envelope: &Envelope, layer: LayerId, thing: &Thing<F>) -> bool {
    let mut offends = false;
    envelope.offended(layer, thing, |_| offends = true);
    offends
}

/// The concavities of a body that the other's hull is held against, and those of them that it may offend. `step`: how far
/// points of the other may have gone since the cells before were found, if there are any.
fn opened_on(
    pair: &Pair,
    side: Side,
    concavities: &Concavities,
    (before, step): (&[Met], Option<f64>),
    counters: &mut Counters,
) -> (Vec<Met>, Vec<ConcavityId>) {
    let (mut met, mut open) = (Vec::new(), Vec::new());
    if concavities.is_empty() {
        return (met, open);
    }
    let hull = HullExtent::of(pair, side.other());
    let thing = hull.thing();
    for (index, concavity) in concavities.iter().enumerate() {
        let envelope = concavities.envelopes().envelope(index);
        if !thing.bounds().overlaps(envelope.bounds()) {
            continue;
        }
        let Some(layer) = envelope.first_layer() else { continue };
        let id = concavity.id();
        if matches!(envelope.passage(&thing), Passage::Beyond(_) | Passage::Apart) {
            counters.pockets_passed += 1;
            continue;
        }
        let known = before.binary_search_by_key(&id, |met| met.concavity).ok();
        let earlier = known.zip(step).map(|(known, step)| (&before[known].cell, step));
        let cell = envelope.track(layer, &thing, earlier);
        met.push(Met { concavity: id, cell });
        if cell.slack > 0.0 || !offends(&envelope, layer, &thing) {
            counters.pockets_passed += 1;
        } else {
            counters.pockets_opened += 1;
            open.push(id);
        }
    }
    (met, open)
}
