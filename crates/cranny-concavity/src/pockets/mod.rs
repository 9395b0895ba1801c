//! Which parts of two hulls meet, and what lies in the pockets beneath: a complete way to the faces
//! that meet.
//!
//! The faces of a body are those in its concavities and the rest, which lies on the hull. Where two
//! hulls meet, each part of one body is compared with each part of the other, in three
//! [cases](PartsCase): rest against rest is contact on the hulls, rest against concavity is a probe
//! in a pocket, concavity against concavity is one pocket in another. A concavity is opened only
//! where the other body's hull may reach its faces, whether or not that crosses a lid: not where
//! the hull is beyond a lid, nor where it offends no facet of the first layer of the pocket's
//! envelope. A ball in a cup, a peg in its hole do so nearly always; in the core of the pocket,
//! beyond all planes of the layer, one plane says so, kept from the last time.
//!
//! What is open is descended by the layers of its envelope, against the boxes of the other's part
//! (`descent`): only facets that a box offends are opened. The pairs of faces that are handed
//! over hold all that meet; who gets them decides which do.
//!
//! Source: opening concavities under the features of hulls that meet, and envelopes with
//! pseudo-Voronoi cells, are after Ponamgi, Manocha and Lin (1997, "Incremental algorithms for
//! collision detection between polygonal models"); see [`Envelopes`](crate::Envelopes).
//!
//! Cost: for each body the extent of the other's hull (six support points, climbed to) and a
//! comparison of boxes with each of its concavities; two support points for each lid of those that
//! remain, and one more where the cell stays; then what is opened.

mod descent;
mod hull_extent;

use std::ops::ControlFlow;
use std::sync::Arc;

use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::{FaceId, Model};

use self::descent::{SurfacePart, for_each_pair_in_pocket};
use self::hull_extent::hull_of_guest;
use crate::envelope::{Cell, Passage, Probe};
use crate::{Concavities, ConcavityId, Envelope, LayerId, NodeSet};

/// Two parts of bodies whose hulls meet: each is a concavity, or the faces that are in none and lie
/// on the hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MetParts {
    /// A concavity of A; `None`: what of it lies on its hull.
    pub a: Option<ConcavityId>,
    /// The same of B.
    pub b: Option<ConcavityId>,
}

/// What two parts that meet are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PartsCase {
    /// Both lie on their hulls: contact is there now, or not at all.
    ConvexConvex,
    /// What lies on the one hull is in a concavity of the other, mostly through its caps.
    CapConvex,
    /// A concavity in a concavity: a link in a link.
    CapCap,
}

impl MetParts {
    /// Which of the three cases it is.
    #[must_use]
    pub fn case(self) -> PartsCase {
        match (self.a, self.b) {
            (None, None) => PartsCase::ConvexConvex,
            (Some(_), Some(_)) => PartsCase::CapCap,
            _ => PartsCase::CapConvex,
        }
    }
}

/// Two models, the second at a pose in the first's frame.
#[derive(Clone, Copy, Debug)]
pub struct PosedModels<'a> {
    /// Both.
    pub models: [&'a Model; 2],
    /// Accepted, as [`Pose::accepted`](cranny_exact::Pose::accepted) has it.
    pub first_from_second: RigidMap,
    /// By how much a point posed by the map, or its height along a unit vector, may be off. Unit:
    /// length.
    pub error: f64,
}

impl PosedModels<'_> {
    /// Into the frame of model `host` (0 or 1) from the other's.
    fn map_to(&self, host: usize) -> RigidMap {
        if host == 0 { self.first_from_second } else { self.first_from_second.inverse() }
    }
}

/// The concavities of a model, prepared for queries.
#[derive(Debug)]
pub struct PocketBody {
    concavities: Arc<Concavities>,
    /// The nodes of the tree that hold a face in no concavity.
    rest: NodeSet,
}

impl PocketBody {
    /// Of a model and its concavities. O(n).
    #[must_use]
    pub fn of(model: &Model, concavities: Arc<Concavities>) -> Self {
        let rest = NodeSet::of(model.tree(), |face| concavities.of_face(face).is_none());
        Self { concavities, rest }
    }

    /// The concavities.
    #[must_use]
    pub fn concavities(&self) -> &Concavities {
        &self.concavities
    }

    /// The nodes of the model's tree that hold a face in no concavity.
    #[must_use]
    pub fn rest(&self) -> &NodeSet {
        &self.rest
    }

    /// Whether a face is in no concavity.
    #[must_use]
    pub fn is_on_hull(&self, face: FaceId) -> bool {
        self.concavities.of_face(face).is_none()
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PocketCounters {
    /// Concavities whose faces are looked for, since the other body's hull may reach them.
    pub opened: u64,
    /// Concavities whose box overlaps that of the other hull, but none of whose faces the hull
    /// reaches.
    pub passed: u64,
    /// Facets of envelopes that a box was held against.
    pub facets_compared: u64,
}

/// What may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Near {
    /// A face of the first body and one of the second.
    Faces(FaceId, FaceId),
    /// All faces of the two bodies that are in no concavity, each against each.
    Rests,
}

/// A concavity of one body whose first layer the other's hull was held against.
#[derive(Clone, Copy, Debug)]
struct Met {
    concavity: ConcavityId,
    cell: Cell,
}

/// Which concavities of a pair are open, kept from one time to the next. Dropping it costs time,
/// never another answer.
#[derive(Clone, Debug, Default)]
pub struct Pockets {
    /// By body, ascending.
    met: [Vec<Met>; 2],
    /// By body, ascending: those of them whose faces are looked for, and those of the time before.
    open: [Vec<ConcavityId>; 2],
    open_before: [Vec<ConcavityId>; 2],
}

impl Pockets {
    /// Opens the concavities whose faces the other body may reach, and closes the others.
    ///
    /// `steps`: for each body how far points of the *other* may have gone, seen from it, since the
    /// last time; `None` where that is not known, or there was none.
    pub fn open(
        &mut self,
        pair: &PosedModels<'_>,
        bodies: [&PocketBody; 2],
        steps: Option<[f64; 2]>,
        counters: &mut PocketCounters,
    ) {
        let open = [0, 1].map(|host| {
            let before = std::mem::take(&mut self.met[host]);
            let step = steps.map(|steps| steps[host]);
            let (met, open) =
                opened_on(pair, host, bodies[host].concavities(), (&before, step), counters);
            self.met[host] = met;
            open
        });
        self.open_before = std::mem::replace(&mut self.open, open);
    }

    /// Calls `visit` with what may meet, of what is [open](Self::open): all faces that meet are
    /// among it. The visitor may end it early.
    pub fn for_each_near(
        &self,
        pair: &PosedModels<'_>,
        bodies: [&PocketBody; 2],
        counters: &mut PocketCounters,
        mut visit: impl FnMut(Near) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let parts = [0, 1].map(|i| {
            let open = self.open[i].iter();
            let pockets = open.filter_map(|&id| SurfacePart::pocket(bodies[i], id));
            let rest = SurfacePart::rest(pair.models[i], bodies[i]);
            rest.into_iter().chain(pockets).collect::<Vec<_>>()
        });
        let [ours, theirs] = &parts;
        for (first, second) in ours.iter().flat_map(|f| theirs.iter().map(move |s| (f, s))) {
            match (first.concavity, second.concavity) {
                (Some(id), _) => {
                    let pocket = (bodies[0].concavities().envelopes(), id);
                    let visit = |f, g| visit(Near::Faces(f, g));
                    for_each_pair_in_pocket(pair, 0, pocket, second, counters, visit)?;
                }
                (None, Some(id)) => {
                    let pocket = (bodies[1].concavities().envelopes(), id);
                    let visit = |f, g| visit(Near::Faces(g, f));
                    for_each_pair_in_pocket(pair, 1, pocket, first, counters, visit)?;
                }
                (None, None) => visit(Near::Rests)?,
            }
        }
        ControlFlow::Continue(())
    }

    /// The parts of the two bodies that are compared with each other; `None` is what lies in no
    /// concavity.
    pub fn parts(
        &self,
        bodies: [&PocketBody; 2],
    ) -> impl Iterator<Item = [Option<ConcavityId>; 2]> + '_ {
        let parts = [0, 1].map(|i| {
            let rest = bodies[i].rest.has(0).then_some(None);
            rest.into_iter().chain(self.open[i].iter().copied().map(Some)).collect::<Vec<_>>()
        });
        let [ours, theirs] = parts;
        ours.into_iter().flat_map(move |f| theirs.clone().into_iter().map(move |s| [f, s]))
    }

    /// The concavities of a body (0 or 1) that were opened and those that were closed, the last
    /// time.
    #[must_use]
    pub fn changed(&self, body: usize) -> [Vec<ConcavityId>; 2] {
        let (now, before) = (&self.open[body], &self.open_before[body]);
        let only = |these: &[ConcavityId], those: &[ConcavityId]| -> Vec<ConcavityId> {
            these.iter().copied().filter(|id| those.binary_search(id).is_err()).collect()
        };
        [only(now, before), only(before, now)]
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let met = self.met.iter().map(|met| met.capacity() * size_of::<Met>()).sum::<usize>();
        let open = self.open.iter().chain(&self.open_before).map(Vec::capacity).sum::<usize>();
        met + open * size_of::<ConcavityId>()
    }
}

/// Whether a probe may offend a facet of a layer: not where its box misses that of the faces
/// beneath, either, though it comes below the plane elsewhere, as a long peg does.
fn offends<F: Fn(DVec3) -> f64>(envelope: &Envelope, layer: LayerId, probe: &Probe<F>) -> bool {
    let mut offends = false;
    envelope.offended(layer, probe, |_| offends = true);
    offends
}

/// The concavities of a body that the other's hull is held against, and those of them that it may
/// offend. `step`: how far points of the other may have gone since the cells before were found, if
/// there are any.
fn opened_on(
    pair: &PosedModels<'_>,
    host: usize,
    concavities: &Concavities,
    (before, step): (&[Met], Option<f64>),
    counters: &mut PocketCounters,
) -> (Vec<Met>, Vec<ConcavityId>) {
    let (mut met, mut open) = (Vec::new(), Vec::new());
    if concavities.is_empty() {
        return (met, open);
    }
    let probe = hull_of_guest(pair, 1 - host);
    for (index, concavity) in concavities.iter().enumerate() {
        let envelope = concavities.envelopes().envelope(index);
        if !probe.bounds().overlaps(envelope.bounds()) {
            continue;
        }
        let Some(layer) = envelope.first_layer() else { continue };
        let id = concavity.id();
        if matches!(envelope.passage(&probe), Passage::Beyond(_) | Passage::Apart) {
            counters.passed += 1;
            continue;
        }
        let known = before.binary_search_by_key(&id, |met| met.concavity).ok();
        let earlier = known.zip(step).map(|(known, step)| (&before[known].cell, step));
        let cell = envelope.track(layer, &probe, earlier);
        met.push(Met { concavity: id, cell });
        if cell.slack > 0.0 || !offends(&envelope, layer, &probe) {
            counters.passed += 1;
        } else {
            counters.opened += 1;
            open.push(id);
        }
    }
    (met, open)
}
