//! What a level may open of the pairs of nodes.

use std::sync::Arc;

use cranny_geometry::{Content, FaceId};

use super::carried::OnHull;
use super::findings::Findings;
use super::ground::{Ground, Nodes};
use crate::descent::{Opened, opened};
use crate::pair::Side;

/// A level, as far as it concerns trees.
pub(super) enum Scope {
    /// All nodes and faces.
    Whole,
    /// Nodes to a depth.
    Depth(u8),
    /// Nodes that hold faces on the hull, and those faces.
    Convex([Arc<OnHull>; 2]),
}

/// What there is to do about a pair of nodes.
pub(super) enum Step {
    /// Its boxes are to be tested again, bodies having moved.
    Test,
    /// Two pairs take its place; the depths of their nodes.
    Open([(Nodes, [u8; 2]); 2]),
    /// Its faces are to be looked at, or those of them that the level admits.
    Look {
        /// It admits all; so many pairs.
        all: bool,
        pairs: u64,
    },
    /// Nothing at this level.
    Close,
    /// Nothing: it was looked at.
    Rest,
}

impl Step {
    /// What it costs at most.
    pub(super) fn tests(&self) -> u64 {
        match self {
            Self::Test => 1,
            Self::Open(_) => 2,
            Self::Look { pairs, .. } => Findings::TESTS_A_LOOK * pairs,
            Self::Close | Self::Rest => 0,
        }
    }
}

impl Scope {
    pub(super) fn step(&self, ground: &Ground, nodes: Nodes, depths: [u8; 2]) -> Step {
        let [a, b] = nodes;
        let [first, second] = ground.trees;
        let contents = [first.content(a), second.content(b)];
        let may_open = |side: usize| match self {
            Self::Whole => true,
            Self::Depth(most) => depths[side] < *most,
            Self::Convex(convex) => convex[0].nodes.has(a) && convex[1].nodes.has(b),
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
            ([true, true], _) => {
                let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
                match opened(contents[0], contents[1], box_a, box_b) {
                    Opened::First(left, right) => left_side(left, right),
                    Opened::Second(left, right) => right_side(left, right),
                    Opened::Neither => Step::Close,
                }
            }
            ([true, false], [Content::Inner { left, right }, _]) => left_side(left, right),
            ([false, true], [_, Content::Inner { left, right }]) => right_side(left, right),
            _ if is_inner(0) || is_inner(1) => Step::Close,
            _ => self.look(ground, nodes),
        }
    }

    fn look(&self, ground: &Ground, [a, b]: Nodes) -> Step {
        let faces = [ground.trees[0].leaf_faces(a), ground.trees[1].leaf_faces(b)];
        let admitted = Side::BOTH
            .map(|side| faces[side.index()].iter().filter(|&&f| self.admits(side, f)).count());
        match admitted[0] * admitted[1] {
            0 => Step::Close,
            pairs => {
                let all = admitted == faces.map(<[FaceId]>::len);
                Step::Look { all, pairs: pairs as u64 }
            }
        }
    }

    /// Whether a face may be looked at.
    pub(super) fn admits(&self, side: Side, face: FaceId) -> bool {
        match self {
            Self::Convex(convex) => convex[side.index()].has(face),
            _ => true,
        }
    }
}
