//! What an estimate of a pair leaves for the next one.

use cranny_concavity::walk::HullFeature;
use cranny_concavity::{Features, NodeSet};
use cranny_exact::{Interval, RigidMap};
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::operations::{Pair, PairTag, PerModel, RelativeMotion, Solidity};

use crate::effort::Accuracy;
use crate::hull_gap::HullWalk;
use crate::refinement::Refinement;
use crate::trees::{NodePair, PairTrees};

/// A motion longer than this share of the smaller body's diagonal is a jump: what was opened before
/// is near no longer, and to test it again costs more than to begin anew (a hundred times more
/// where bodies overlap, which a new search finds at once). Larger: unrelated poses pay for their
/// memory; smaller: fast motion begins anew in each frame.
const JUMP: f64 = 0.0625;

/// The bounds of the last estimate. Motion widens them by the most that distances may have changed,
/// so they stay certain.
#[derive(Clone, Debug)]
pub(crate) struct WarmStart {
    tag: PairTag,
    /// The relative pose up to which motion is counted.
    map: RigidMap,
    pub(crate) refinement: Refinement,
    /// Holds the distance between the surfaces.
    pub(crate) distance: Interval,
    /// A motion since the last estimate with a budget was longer than the interval of the distance.
    pub(crate) outrun: bool,
    /// The solidity of surfaces that were certainly apart.
    pub(crate) apart: Option<Solidity>,
    /// Faces that met last, or were nearest.
    pub(crate) faces: Option<[FaceId; 2]>,
    pub(crate) hulls: HullWalk,
    pub(crate) hull_faces: Option<PerModel<HullFaces>>,
}

impl WarmStart {
    fn new(pair: &Pair) -> Self {
        Self {
            tag: PairTag::of(pair),
            map: *pair.first_from_second(),
            refinement: Refinement::default(),
            distance: Interval { lo: 0.0, hi: f64::INFINITY },
            outrun: false,
            apart: None,
            faces: None,
            hulls: HullWalk::default(),
            hull_faces: None,
        }
    }

    /// The bounds of this pair at its pose; blank, if the slot holds those of other models.
    pub(crate) fn at<'c>(slot: &'c mut Option<Box<Self>>, pair: &Pair) -> &'c mut Self {
        if !slot.as_ref().is_some_and(|warm| warm.tag.is_of(pair)) {
            *slot = None;
        }
        let warm = slot.get_or_insert_with(|| Box::new(Self::new(pair)));
        warm.advance(pair);
        warm
    }

    /// Makes what a level reads besides the models, if it is missing.
    pub(crate) fn prepare(&mut self, pair: &Pair, accuracy: Accuracy) {
        if matches!(accuracy, Accuracy::Hulls | Accuracy::Caps) {
            self.hulls.prepare(pair);
        }
        if accuracy == Accuracy::Caps && self.hull_faces.is_none() {
            self.hull_faces = Some(hull_faces(pair));
        }
    }

    fn advance(&mut self, pair: &Pair) {
        let Some(motion) = RelativeMotion::since(&self.map, pair) else { return };
        self.map = *pair.first_from_second();
        let step = motion.step(pair.models());
        let Interval { lo, hi } = self.distance;
        self.outrun |= step > hi - lo;
        // Surfaces that do not meet on the screw that joins the poses change no containment.
        let way = motion.arc_over_chord().map_or(f64::INFINITY, |factor| factor * step);
        self.apart = self.apart.filter(|_| lo > way + 4.0 * pair.culling_error());
        let lo = (lo - step).next_down().max(0.0);
        self.distance = Interval { lo, hi: (hi + step).next_up() };
        let [first, second] = pair.models().map(|model| model.bounds().diagonal());
        if step > JUMP * first.min(second) {
            (self.refinement, self.faces) = (Refinement::default(), None);
            self.hulls.start_anew();
        }
        self.refinement.advance(step);
    }

    /// Whether the last estimate was about this pair at its pose.
    pub(crate) fn is_at(&self, pair: &Pair) -> bool {
        self.tag.is_of(pair) && self.map == *pair.first_from_second()
    }

    /// Pairs of nodes that are not opened, with lower bounds of their distances.
    pub(crate) fn cut(&self, trees: &PairTrees) -> impl Iterator<Item = (NodePair, f64)> {
        self.refinement.entries().map(|entry| (entry.nodes, self.refinement.lower(entry, trees)))
    }

    /// Where the next walk starts.
    pub(crate) fn walked(&self) -> Option<[HullFeature; 2]> {
        self.hulls.features()
    }

    pub(crate) fn bytes(&self) -> usize {
        let hull_faces = self.hull_faces.as_ref().map_or(0, |faces| faces.bytes(HullFaces::bytes));
        size_of::<Self>() + self.refinement.bytes() + self.hulls.bytes() + hull_faces
    }
}

/// Which faces of a model lie on its hull, and which nodes of its tree hold one.
#[derive(Clone, Debug)]
pub(crate) struct HullFaces {
    pub(crate) nodes: NodeSet,
    faces: Vec<bool>,
}

impl HullFaces {
    fn of(model: &Model) -> Self {
        let features = Features::of(model);
        let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
        Self {
            nodes: NodeSet::of(model.tree(), |face| features.is_convex(face)),
            faces: faces.map(|face| features.is_convex(face)).collect(),
        }
    }

    pub(crate) fn has(&self, face: FaceId) -> bool {
        self.faces[face.index()]
    }

    fn bytes(&self) -> usize {
        self.nodes.bytes() + self.faces.len()
    }
}

/// The faces on the hulls of a pair. Models do not hold them.
pub(crate) fn hull_faces(pair: &Pair) -> PerModel<HullFaces> {
    PerModel::of(pair, |side| HullFaces::of(pair.model(side)))
}
