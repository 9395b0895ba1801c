//! What estimates of a pair leave for the next one.

use std::sync::Arc;

use cranny_concavity::Features;
use cranny_exact::{Interval, RigidMap};
use cranny_geometry::{FaceId, Model};

use super::effort::Accuracy;
use super::ground::{Ground, Nodes};
use super::hull_gap::HullWalk;
use super::refinement::Refinement;
use crate::containment::Solidity;
use crate::motion::{Ball, Motion};
use crate::pair::{Pair, Side, Whose};
use crate::pair::{bytes_of_pair, of_models};
use cranny_concavity::NodeSet;
use cranny_concavity::walk::HullFeature;

/// Memory of a pair, as far as estimates are concerned. Bounds that were certain stay so: motion widens
/// them by as much as it may have changed.
#[derive(Clone, Debug)]
pub(crate) struct Carried {
    whose: Whose,
    /// The relative pose up to which motion is counted.
    map: RigidMap,
    pub(super) refinement: Refinement,
    /// Holds the distance of the surfaces.
    pub(super) distance: Interval,
    /// The last motion took more than had been known of the distance.
    pub(super) shaken: bool,
    /// What lies inside what, where the surfaces were certainly apart.
    pub(super) apart: Option<Solidity>,
    /// Faces that met last, or were nearest.
    pub(super) faces: Option<[FaceId; 2]>,
    pub(super) hulls: HullWalk,
    pub(super) convex: Option<[Arc<OnHull>; 2]>,
}

impl Carried {
    fn new(pair: &Pair) -> Self {
        Self {
            whose: Whose::of(pair),
            map: pair.first_from_second,
            refinement: Refinement::default(),
            distance: Interval { lo: 0.0, hi: f64::INFINITY },
            shaken: false,
            apart: None,
            faces: None,
            hulls: HullWalk::default(),
            convex: None,
        }
    }

    /// What is known of this pair at its pose.
    pub(super) fn at<'c>(slot: &'c mut Option<Box<Self>>, pair: &Pair) -> &'c mut Self {
        if !slot.as_ref().is_some_and(|carried| carried.whose.are_of(pair)) {
            *slot = None;
        }
        let carried = slot.get_or_insert_with(|| Box::new(Self::new(pair)));
        carried.advance(pair);
        carried
    }

    /// Makes what a level reads besides the models, if it is not there.
    pub(super) fn prepare(&mut self, pair: &Pair, accuracy: Accuracy) {
        if matches!(accuracy, Accuracy::Hulls | Accuracy::Caps) {
            self.hulls.prepare(pair);
        }
        if accuracy == Accuracy::Caps && self.convex.is_none() {
            self.convex = Some(on_hull(pair));
        }
    }

    fn advance(&mut self, pair: &Pair) {
        self.shaken = false;
        let Some(motion) = Motion::since(&self.map, pair) else { return };
        self.map = pair.first_from_second;
        let balls = Side::BOTH.map(|side| Ball::around(&pair.model(side).bounds()));
        let step = motion.step(&balls);
        let Interval { lo, hi } = self.distance;
        self.shaken = step > hi - lo;
        // On the way of the screw that joins the poses, surfaces that do not meet change no containment.
        let way = motion.way_factor().map_or(f64::INFINITY, |factor| factor * step);
        self.apart = self.apart.filter(|_| lo > way + 4.0 * pair.culling_error());
        let lo = (lo - step).next_down().max(0.0);
        self.distance = Interval { lo, hi: (hi + step).next_up() };
        self.refinement.advance(step);
    }

    /// Whether the last estimate was about this pair at its pose.
    pub(crate) fn is_at(&self, pair: &Pair) -> bool {
        self.whose.are_of(pair) && self.map == pair.first_from_second
    }

    /// Pairs of nodes that are not opened, and how far apart they are at least.
    pub(crate) fn cut(&self, ground: &Ground) -> impl Iterator<Item = (Nodes, f64)> {
        self.refinement.entries().map(|entry| (entry.nodes, self.refinement.lower(entry, ground)))
    }

    /// Where the next walk starts.
    pub(crate) fn walked(&self) -> Option<[HullFeature; 2]> {
        self.hulls.features()
    }

    pub(crate) fn bytes(&self) -> usize {
        let convex = self.convex.as_ref().map_or(0, |pair| bytes_of_pair(pair, OnHull::bytes));
        size_of::<Self>() + self.refinement.bytes() + self.hulls.bytes() + convex
    }
}

/// Which faces of a model lie on its hull, and which nodes of its tree hold one.
#[derive(Clone, Debug)]
pub(super) struct OnHull {
    pub(super) nodes: NodeSet,
    faces: Vec<bool>,
}

impl OnHull {
    fn of(model: &Model) -> Self {
        let features = Features::of(model);
        let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
        Self {
            nodes: NodeSet::of(model.tree(), |face| features.is_convex(face)),
            faces: faces.map(|face| features.is_convex(face)).collect(),
        }
    }

    pub(super) fn has(&self, face: FaceId) -> bool {
        self.faces[face.index()]
    }

    fn bytes(&self) -> usize {
        self.nodes.bytes() + self.faces.len()
    }
}

/// What of the two models lies on their hulls. Models do not hold it.
pub(super) fn on_hull(pair: &Pair) -> [Arc<OnHull>; 2] {
    of_models(pair, OnHull::of)
}
