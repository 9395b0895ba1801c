//! Leaves of patches' trees: what they have, in their body's frame, found once and kept from query to query; and
//! where their points are in the pair's frame, for the body whose frame that is not, in the present query.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{Edge, VertexId};

use super::facet::{Facet, is_beneath, ones};
use super::features::{Corner, Segment, Span};
use super::gauss_map::Arc;
use super::oriented::{Extent, Oriented};
use super::ownership::{Owned, Ownership};
use super::posed::{Node, are_apart};
use crate::pair::{Pair, Side};

/// Which range of a list.
#[derive(Clone, Copy, Debug, Default)]
struct Range {
    start: u32,
    end: u32,
}

impl Range {
    fn since(start: usize, now: usize) -> Self {
        Self { start: start as u32, end: now as u32 }
    }

    #[inline]
    fn of<T>(self, list: &[T]) -> &[T] {
        &list[self.start as usize..self.end as usize]
    }
}

/// A leaf that was met, the corners of its faces each once.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    /// Its node in the arena of all patches' trees.
    node: u32,
    points: Range,
    /// Empty until they are asked for, as the following are.
    facets: Range,
    corners: Range,
    edges: Range,
    has_features: bool,
    /// Of which query the points are, and the boxes of corners and edges.
    posed: u32,
    boxed: u32,
    bounds: Aabb,
    corner_bounds: Aabb,
    edge_bounds: Aabb,
}

/// The leaves of one body that searches came across.
#[derive(Clone, Debug)]
pub(super) struct Leaves {
    side: Side,
    /// The present query; none is 0.
    query: u32,
    leaves: Vec<Leaf>,
    names: Vec<VertexId>,
    points: Vec<DVec3>,
    facets: Vec<Facet>,
    corners: Vec<Corner>,
    edges: Vec<Segment>,
    /// Of each edge, as the following: in the body's frame.
    arcs: Vec<Arc>,
    /// In the pair's frame.
    spans: Vec<Span>,
    /// Of each facet and of each edge, across the box that lies along their leaf.
    facet_extents: Vec<Extent>,
    edge_extents: Vec<Extent>,
}

/// More leaves than this beyond twice those that were opened lately are not kept. Fewer: what moves on forgets what it
/// comes back to; more: what has moved on keeps what it left.
const SPARE: usize = 64;

/// In so many queries is lately. Fewer: what is searched now and then, since what was near is known, is forgotten
/// between; more: what has moved on keeps what it left.
const LATELY: u32 = 16;

impl Leaves {
    pub(super) fn new(side: Side) -> Self {
        Self {
            side,
            query: 0,
            leaves: Vec::new(),
            names: Vec::new(),
            points: Vec::new(),
            facets: Vec::new(),
            corners: Vec::new(),
            edges: Vec::new(),
            arcs: Vec::new(),
            spans: Vec::new(),
            facet_extents: Vec::new(),
            edge_extents: Vec::new(),
        }
    }

    /// Begins a query.
    pub(super) fn begin(&mut self, query: u32) {
        self.query = query;
    }

    /// Whether most of what is kept was not opened lately; asked now and then, it says.
    pub(super) fn are_stale(&self) -> bool {
        let is_recent = |leaf: &&Leaf| leaf.posed > 0 && leaf.posed + LATELY > self.query;
        self.query.is_multiple_of(LATELY)
            && self.leaves.len() > 2 * self.leaves.iter().filter(is_recent).count() + SPARE
    }

    pub(super) fn bytes(&self) -> usize {
        self.leaves.capacity() * size_of::<Leaf>()
            + self.names.capacity() * size_of::<VertexId>()
            + self.points.capacity() * size_of::<DVec3>()
            + self.facets.capacity() * size_of::<Facet>()
            + self.corners.capacity() * size_of::<Corner>()
            + self.edges.capacity() * size_of::<Segment>()
            + self.arcs.capacity() * size_of::<Arc>()
            + self.spans.capacity() * size_of::<Span>()
            + (self.facet_extents.capacity() + self.edge_extents.capacity()) * size_of::<Extent>()
    }

    /// Takes in a leaf, given by its node in the arena of all patches' trees; tells its number.
    pub(super) fn add(&mut self, pair: &Pair, node: u32) -> u32 {
        let start = self.names.len();
        for &face in pair.model(self.side).patches().trees().arena().leaf_faces(node) {
            for vertex in pair.mesh(self.side).corners(face) {
                // Few: to look for it costs less than to pose it again.
                if !self.names[start..].contains(&vertex) {
                    self.names.push(vertex);
                }
            }
        }
        self.points.resize(self.names.len(), DVec3::ZERO);
        let (points, empty) = (Range::since(start, self.names.len()), Range::default());
        self.leaves.push(Leaf {
            node,
            points,
            facets: empty,
            corners: empty,
            edges: empty,
            has_features: false,
            posed: 0,
            boxed: 0,
            bounds: Aabb::EMPTY,
            corner_bounds: Aabb::EMPTY,
            edge_bounds: Aabb::EMPTY,
        });
        self.leaves.len() as u32 - 1
    }

    /// Whether the points of a leaf are there.
    #[inline]
    pub(super) fn is_open(&self, number: u32) -> bool {
        self.leaves[number as usize].posed == self.query
    }

    /// Opens a leaf: its points are posed.
    pub(super) fn open(&mut self, pair: &Pair, number: u32) {
        let leaf = &mut self.leaves[number as usize];
        // The first body's do not move.
        if self.side == Side::Second || leaf.posed == 0 {
            let range = leaf.points.start as usize..leaf.points.end as usize;
            let mut bounds = Aabb::EMPTY;
            for (point, &vertex) in self.points[range.clone()].iter_mut().zip(&self.names[range]) {
                let p = pair.position(self.side, vertex);
                bounds = Aabb { min: least(bounds.min, p), max: most(bounds.max, p) };
                *point = p;
            }
            leaf.bounds = bounds;
        }
        leaf.posed = self.query;
    }

    /// Whether what an opened leaf has is there, its features among it if asked for.
    #[inline]
    pub(super) fn is_filled(&self, number: u32, with_features: bool) -> bool {
        let leaf = &self.leaves[number as usize];
        if with_features { leaf.boxed == self.query } else { leaf.facets.end > 0 }
    }

    /// Makes what an opened leaf has, if it is not there. `ownership` tells what is looked at from its faces; without
    /// it nothing is.
    pub(super) fn fill(
        &mut self,
        pair: &Pair,
        number: u32,
        local: &Oriented,
        ownership: Option<&Ownership>,
    ) {
        let at = number as usize;
        if self.leaves[at].facets.end == 0 {
            self.make_facets(pair, at, local);
        }
        let Some(ownership) = ownership else { return };
        let is_new = !self.leaves[at].has_features;
        if is_new {
            self.make_features(pair, at, local, ownership);
        }
        let leaf = &mut self.leaves[at];
        if is_new || self.side == Side::Second {
            let points = leaf.points.of(&self.points);
            let mut bounds = Aabb::EMPTY;
            for corner in leaf.corners.of(&self.corners) {
                let p = corner.at(points);
                bounds = Aabb { min: least(bounds.min, p), max: most(bounds.max, p) };
            }
            leaf.corner_bounds = bounds;
            let mut bounds = Aabb::EMPTY;
            let range = leaf.edges.start as usize..leaf.edges.end as usize;
            for at in range {
                let [p, q] = self.edges[at].ends(points);
                let around = Aabb { min: least(p, q), max: most(p, q) };
                let (min, max) = (least(bounds.min, around.min), most(bounds.max, around.max));
                bounds = Aabb { min, max };
                let arc = match self.side {
                    Side::First => self.arcs[at],
                    Side::Second => self.arcs[at].turned(&pair.first_from_second.linear),
                };
                self.spans[at] = Span { bounds: around, arc };
            }
            leaf.edge_bounds = bounds;
        }
        leaf.boxed = self.query;
    }

    fn make_facets(&mut self, pair: &Pair, at: usize, local: &Oriented) {
        let leaf = &mut self.leaves[at];
        let (mesh, start) = (pair.mesh(self.side), self.facets.len());
        let names = leaf.points.of(&self.names);
        for &face in pair.model(self.side).patches().trees().arena().leaf_faces(leaf.node) {
            let places = mesh.corners(face).map(|vertex| place(names, vertex));
            let corners = mesh.triangle(face);
            self.facets.push(Facet::of(face, &corners, places));
            self.facet_extents.push(Extent::of(corners.map(|p| local.within(p))));
        }
        leaf.facets = Range::since(start, self.facets.len());
    }

    fn make_features(&mut self, pair: &Pair, at: usize, local: &Oriented, ownership: &Ownership) {
        let (side, leaf) = (self.side, &mut self.leaves[at]);
        let starts = [self.corners.len(), self.edges.len()];
        let names = leaf.points.of(&self.names);
        for facet in leaf.facets.of(&self.facets) {
            let Owned { corners, ridges, .. } = ownership.of(pair, side, facet.face);
            for i in ones(corners) {
                let vertex = pair.corner(side, facet.face, i);
                self.corners.push(Corner { vertex, at: facet.places[i] });
            }
            for i in ones(ridges) {
                let edge = pair.edge(side, facet.face, i);
                let Edge { from, to, .. } = pair.topology(side).edges()[edge.index()];
                self.edges.push(Segment { edge, ends: [from, to].map(|v| place(names, v)) });
                let ends = [from, to].map(|v| local.within(pair.mesh(side).position(v)));
                self.edge_extents.push(Extent::of(ends));
                let arc = Arc::of(pair.mesh(side), pair.topology(side), edge);
                self.arcs.push(arc);
                self.spans.push(Span { bounds: Aabb::EMPTY, arc });
            }
        }
        leaf.corners = Range::since(starts[0], self.corners.len());
        leaf.edges = Range::since(starts[1], self.edges.len());
        leaf.has_features = true;
    }

    /// A leaf that was opened.
    #[inline]
    pub(super) fn outline<'a>(&'a self, node: &'a Node, number: u32) -> Outline<'a> {
        let leaf = &self.leaves[number as usize];
        Outline { node, points: leaf.points.of(&self.points), bounds: &leaf.bounds }
    }

    /// What a leaf has, which was made.
    #[inline]
    pub(super) fn parts<'a>(&'a self, node: &'a Node, number: u32) -> Parts<'a> {
        Parts { node, leaf: &self.leaves[number as usize], all: self }
    }

    /// Lets go of room for much more than there is.
    pub(super) fn shrink(&mut self) {
        shrink(&mut self.leaves);
        shrink(&mut self.names);
        shrink(&mut self.points);
        shrink(&mut self.facets);
        shrink(&mut self.corners);
        shrink(&mut self.edges);
        shrink(&mut self.arcs);
        shrink(&mut self.spans);
        shrink(&mut self.facet_extents);
        shrink(&mut self.edge_extents);
    }
}

/// Leaves room for an eighth more than there is, where there is room for more than a quarter: lists that grow double.
pub(super) fn shrink<T>(list: &mut Vec<T>) {
    let len = list.len();
    if list.capacity() > len + len / 4 {
        list.shrink_to(len + len / 8);
    }
}

/// Which of a leaf's points a vertex is, which is among them.
fn place(names: &[VertexId], vertex: VertexId) -> u16 {
    names.iter().take_while(|&&name| name != vertex).count() as u16
}

/// Coordinate by coordinate, for numbers that are no NaN.
#[inline]
fn least(a: DVec3, b: DVec3) -> DVec3 {
    let less = |a: f64, b: f64| if b < a { b } else { a };
    DVec3::new(less(a.x, b.x), less(a.y, b.y), less(a.z, b.z))
}

#[inline]
fn most(a: DVec3, b: DVec3) -> DVec3 {
    let more = |a: f64, b: f64| if b > a { b } else { a };
    DVec3::new(more(a.x, b.x), more(a.y, b.y), more(a.z, b.z))
}

/// An opened leaf: all its points, a box around them, and a plane over them.
#[derive(Clone, Copy)]
pub(super) struct Outline<'a> {
    node: &'a Node,
    points: &'a [DVec3],
    bounds: &'a Aabb,
}

impl Outline<'_> {
    /// Whether two leaves are certainly more than `reach` apart: what tells is that all points of one lie over
    /// the other's plane.
    #[inline]
    pub(super) fn is_apart_from(&self, other: &Self, reach: f64) -> bool {
        are_apart(self.bounds, other.bounds, reach)
            || self.is_beneath(other.points, reach)
            || other.is_beneath(self.points, reach)
    }

    /// Whether all of some points lie higher over the leaf than `reach`.
    fn is_beneath(&self, points: &[DVec3], reach: f64) -> bool {
        let (normal, height) = self.node.oriented().top();
        is_beneath(normal, height, points, reach)
    }
}

/// What an opened leaf has.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    node: &'a Node,
    leaf: &'a Leaf,
    all: &'a Leaves,
}

impl<'a> Parts<'a> {
    pub(super) fn side(&self) -> Side {
        self.all.side
    }

    pub(super) fn bounds(&self) -> &Aabb {
        &self.leaf.bounds
    }

    pub(super) fn points(&self) -> &'a [DVec3] {
        self.leaf.points.of(&self.all.points)
    }

    pub(super) fn oriented(&self) -> &'a Oriented {
        self.node.oriented()
    }

    pub(super) fn facet_extents(&self) -> &'a [Extent] {
        self.leaf.facets.of(&self.all.facet_extents)
    }

    pub(super) fn edge_extents(&self) -> &'a [Extent] {
        self.leaf.edges.of(&self.all.edge_extents)
    }

    pub(super) fn facets(&self) -> &'a [Facet] {
        self.leaf.facets.of(&self.all.facets)
    }

    /// Corners that are looked at from here.
    pub(super) fn corners(&self) -> &'a [Corner] {
        self.leaf.corners.of(&self.all.corners)
    }

    pub(super) fn corner_bounds(&self) -> &Aabb {
        &self.leaf.corner_bounds
    }

    /// Edges that are looked at from here and may cross others.
    #[inline]
    pub(super) fn edges(&self) -> &'a [Segment] {
        self.leaf.edges.of(&self.all.edges)
    }

    /// Where they are.
    #[inline]
    pub(super) fn spans(&self) -> &'a [Span] {
        self.leaf.edges.of(&self.all.spans)
    }

    pub(super) fn edge_bounds(&self) -> &Aabb {
        &self.leaf.edge_bounds
    }
}
