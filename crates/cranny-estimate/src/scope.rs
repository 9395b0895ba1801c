//! Which pairs of nodes a level may open.

use cranny_geometry::{Content, FaceId, PairedStep};
use cranny_narrow_phase::operations::{PerModel, Side};

use crate::findings::Findings;
use crate::trees::{NodePair, PairTrees};
use crate::warm_start::HullFaces;

/// The limits that a level sets to the opening of nodes.
pub(crate) enum Scope {
    /// All nodes and faces.
    Whole,
    /// Nodes above a depth.
    Depth(u8),
    /// Nodes that hold faces on the hull, and those faces.
    HullFaces(PerModel<HullFaces>),
}

/// The next step at a pair of nodes.
pub(crate) enum Step {
    /// Test its boxes again, since the bodies have moved.
    Test,
    /// Replace it by two pairs, each with the depths of its nodes.
    Open([(NodePair, [u8; 2]); 2]),
    /// Test those of its faces that the level admits.
    TestFaces {
        /// The level admits all faces of the two leaves.
        all: bool,
        /// How many pairs it admits.
        pairs: u64,
    },
    /// Leave it closed: the level admits no more.
    Close,
    /// Leave it: those of its faces that the level admits were tested at this pose.
    Rest {
        /// They are all faces of the two leaves.
        all: bool,
    },
}

impl Step {
    /// The most tests that it takes.
    pub(crate) fn tests(&self) -> u64 {
        match self {
            Self::Test => 1,
            Self::Open(_) => 2,
            Self::TestFaces { pairs, .. } => Findings::TESTS_A_PAIR * pairs,
            Self::Close | Self::Rest { .. } => 0,
        }
    }
}

impl Scope {
    pub(crate) fn step(&self, trees: &PairTrees, nodes: NodePair, depths: [u8; 2]) -> Step {
        let [a, b] = nodes;
        let [first, second] = trees.sides;
        let contents = [first.content(a), second.content(b)];
        let may_open = |side: usize| match self {
            Self::Whole => true,
            Self::Depth(most) => depths[side] < *most,
            Self::HullFaces(faces) => {
                let [of_first, of_second] = faces.both();
                of_first.nodes.has(a) && of_second.nodes.has(b)
            }
        };
        let is_inner = |side: usize| matches!(contents[side], Content::Inner { .. });
        let opens = [0, 1].map(|side| is_inner(side) && may_open(side));
        let [x, y] = depths;
        let left_side = |left, right| {
            let depths = [x.saturating_add(1), y];
            Step::Open([([left, b], depths), ([right, b], depths)])
        };
        let right_side = |left, right| {
            let depths = [x, y.saturating_add(1)];
            Step::Open([([a, left], depths), ([a, right], depths)])
        };
        match (opens, contents) {
            ([true, true], _) => match PairedStep::of_larger(trees.sides, nodes) {
                PairedStep::First(left, right) => left_side(left, right),
                PairedStep::Second(left, right) => right_side(left, right),
                PairedStep::Leaves => Step::Close,
            },
            ([true, false], [Content::Inner { left, right }, _]) => left_side(left, right),
            ([false, true], [_, Content::Inner { left, right }]) => right_side(left, right),
            _ if is_inner(0) || is_inner(1) => Step::Close,
            _ => self.test_faces(trees, nodes),
        }
    }

    fn test_faces(&self, trees: &PairTrees, [a, b]: NodePair) -> Step {
        let faces = [trees.sides[0].leaf_faces(a), trees.sides[1].leaf_faces(b)];
        let admitted = Side::BOTH
            .map(|side| faces[side.index()].iter().filter(|&&f| self.admits(side, f)).count());
        match admitted[0] * admitted[1] {
            0 => Step::Close,
            pairs => {
                let all = admitted == faces.map(<[FaceId]>::len);
                Step::TestFaces { all, pairs: pairs as u64 }
            }
        }
    }

    /// Whether a face may be tested.
    pub(crate) fn admits(&self, side: Side, face: FaceId) -> bool {
        match self {
            Self::HullFaces(faces) => faces.both()[side.index()].has(face),
            _ => true,
        }
    }
}
