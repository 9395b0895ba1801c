//! Leaves of patches' trees in the pair's frame: first their points, which may tell that two of them are out of
//! reach, then what in them can make contacts.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{EdgeId, VertexId};

use super::facet::Facet;
use super::posed::{Node, are_apart};

/// Which range of a list.
#[derive(Clone, Copy)]
pub(super) struct Range {
    start: u32,
    end: u32,
}

impl Range {
    pub(super) fn since(start: usize, now: usize) -> Self {
        Self { start: start as u32, end: now as u32 }
    }

    pub(super) fn of<T>(self, list: &[T]) -> &[T] {
        &list[self.start as usize..self.end as usize]
    }
}

/// A leaf that was opened: the corners of its faces, each once.
#[derive(Clone, Copy)]
pub(super) struct Leaf {
    pub(super) points: Range,
    /// The first of its faces among places.
    pub(super) faces: u32,
    pub(super) bounds: Aabb,
    /// The number of what it has, once that is made.
    pub(super) parts: u32,
}

/// What a leaf has: corners and edges are those that are looked at from its faces.
#[derive(Clone, Copy)]
pub(super) struct LeafParts {
    pub(super) facets: Range,
    pub(super) corners: Range,
    pub(super) edges: Range,
    pub(super) corner_bounds: Aabb,
    pub(super) edge_bounds: Aabb,
}

/// An opened leaf: all its points, a box around them, and a plane over them.
#[derive(Clone, Copy)]
pub(super) struct Outline<'a> {
    pub(super) node: &'a Node,
    pub(super) points: &'a [DVec3],
    pub(super) bounds: &'a Aabb,
}

impl Outline<'_> {
    /// Whether the leaf is certainly more than `reach` away from what another node holds.
    #[inline]
    pub(super) fn is_apart_from_node(&self, other: &Node, reach: f64) -> bool {
        are_apart(self.bounds, &other.bounds, reach) || other.is_beneath(self.points, reach)
    }

    /// Whether two leaves are certainly more than `reach` apart: what tells is that all points of one lie over
    /// the other's plane.
    #[inline]
    pub(super) fn is_apart_from(&self, other: &Self, reach: f64) -> bool {
        are_apart(self.bounds, other.bounds, reach)
            || self.node.is_beneath(other.points, reach)
            || other.node.is_beneath(self.points, reach)
    }
}

/// What an opened leaf has.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    pub(super) node: &'a Node,
    pub(super) bounds: &'a Aabb,
    pub(super) points: &'a [DVec3],
    pub(super) facets: &'a [Facet],
    /// Corners that are looked at from here.
    pub(super) corners: &'a [Corner],
    pub(super) corner_bounds: &'a Aabb,
    /// Edges that are looked at from here and may cross others.
    pub(super) edges: &'a [Segment],
    pub(super) edge_bounds: &'a Aabb,
}

impl Parts<'_> {
    /// Whether any of a leaf's corners or edges, in this box, may be within reach.
    pub(super) fn is_near(&self, bounds: &Aabb, reach: f64) -> bool {
        !are_apart(bounds, self.bounds, reach)
    }

    /// Whether what lies between some points, in a box around them, may be within reach of the leaf.
    #[inline]
    pub(super) fn may_reach(&self, points: &[DVec3], bounds: &Aabb, reach: f64) -> bool {
        !are_apart(bounds, self.bounds, reach) && !self.node.is_beneath(points, reach)
    }
}

/// A vertex that is looked at.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) vertex: VertexId,
    pub(super) at: DVec3,
}

/// An edge that is looked at.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    pub(super) edge: EdgeId,
    pub(super) ends: [DVec3; 2],
    pub(super) bounds: Aabb,
}
