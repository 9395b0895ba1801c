//! Which facet of the hull each face of the mesh lies on, if any.
//!
//! A face lies on a facet when its three corners lie in the facet's [slab](super::slabs) and it
//! does not look the other way. Of several such facets it takes the one whose normal agrees best
//! with its own, and of those that do so but for rounding the first [by its vertices](FacetOrder):
//! a face without area, along an edge of the hull, agrees with either side, and the numbers of
//! facets are others once the hull has followed moved vertices. A face whose corners are all on the
//! hull, but on no facet together, crosses the interior: it belongs to a concavity.
//!
//! A face that equals a triangle of the hull lies on that triangle's facet, whichever agrees
//! better: so both cancel where caps are made.
//!
//! A *needle*, not wider than the slab is deep, has a normal made of rounding. It goes where the
//! face across its longest edge went, for there it belongs whichever way it was rounded.
//!
//! The rules are this crate's own; that planes of given thickness, not exact ones, decide what is
//! coplanar is common among hull codes (Barber, Dobkin, Huhdanpaa 1996, "The quickhull algorithm
//! for convex hulls", on facets that are thick by rounding).
//!
//! Cost: near-linear, most of it for the facets of vertices (`vertices`).

use std::cmp::Ordering;
use std::collections::BTreeMap;

use cranny_exact::DVec3;

use super::slabs::Slabs;
use super::vertices::facets_of_vertices;
use cranny_geometry::hull::FacetOrder;
use cranny_geometry::rows::{replaced, row};
use cranny_geometry::{FaceId, HalfEdgeId, Mesh, Model, Topology, VertexId, each_once};

/// 'On no facet'.
pub(crate) const NONE: u32 = u32::MAX;

/// A list of facets this long is not searched but replaced by a question to the tree: a corner of
/// very many facets, an apex, must not make a quadratic time of the faces around it.
const LONG: usize = 64;

/// One vertex in so many may have moved since rows were written. More often, and rows are written
/// anew for little; more seldom, and vertices are looked up in a large tree.
const FULL: usize = 16;

/// Facets agree as well with a face whose agreements differ by no more than this share of its area.
/// Smaller, and the rounding of normals decides, which is other once a hull has followed moved
/// vertices; larger, and facets are tied that turn by more than rounding.
const TIED: f64 = 8.0 * f64::EPSILON;

/// The facets of vertices and faces.
#[derive(Clone, Debug)]
pub(crate) struct Assignment {
    /// The facet that each face lies on, or [`NONE`].
    pub(crate) facet_of_face: Vec<u32>,
    starts: Vec<u32>,
    facets: Vec<u32>,
    /// The facets of vertices that have moved since the rows above were written.
    pub(super) moved: BTreeMap<u32, Vec<u32>>,
    pub(super) slabs: Slabs,
}

impl Assignment {
    /// Judges every vertex and face.
    pub(crate) fn of(model: &Model) -> Self {
        let (mesh, hull) = (model.mesh(), model.hull());
        let mut slabs = Slabs::of(hull);
        slabs.prepare_finder(hull);
        let (starts, facets) =
            facets_of_vertices(mesh, model.topology(), hull, model.tree(), &slabs);
        let facet_of_face = vec![NONE; mesh.faces().len()];
        let mut assignment = Self { facet_of_face, starts, facets, moved: BTreeMap::new(), slabs };
        let on_hull = assignment.vertices_on_hull();
        // Nearly none of a body whose hull is small.
        let is_on_hull = |f: &FaceId| mesh.corners(*f).iter().all(|v| on_hull[v.index()]);
        assignment.assign_faces(model, mesh.face_ids().filter(is_on_hull));
        assignment
    }

    /// The facets that a vertex lies on, ascending; none off the hull. Of an extreme vertex those
    /// of the triangles around it.
    pub(crate) fn facets_of(&self, vertex: VertexId) -> &[u32] {
        if !self.moved.is_empty()
            && let Some(facets) = self.moved.get(&vertex.0)
        {
            return facets;
        }
        &self.facets[row(&self.starts, vertex.index())]
    }

    /// For each vertex whether it lies on a facet.
    pub(super) fn vertices_on_hull(&self) -> Vec<bool> {
        let mut on_hull: Vec<bool> = self.starts.windows(2).map(|row| row[0] < row[1]).collect();
        for (&v, facets) in &self.moved {
            on_hull[v as usize] = !facets.is_empty();
        }
        on_hull
    }

    /// The least depth of a slab: what is thinner is flat.
    pub(crate) fn depth(&self) -> f64 {
        self.slabs.depth()
    }

    /// Whether a point of the hull is on a facet, or beside it, no deeper than its slab.
    pub(crate) fn is_on(&self, facet: u32, p: DVec3) -> bool {
        self.slabs.holds(facet, p)
    }

    /// The facets on which a segment between two vertices lies, ascending.
    pub(crate) fn facets_of_segment(&self, mesh: &Mesh, [a, b]: [VertexId; 2]) -> Vec<u32> {
        let holds = |f: u32, v: VertexId| self.slabs.holds(f, mesh.position(v));
        let of_a = self.facets_of(a);
        if of_a.is_empty() {
            return Vec::new(); // nearly every vertex
        }
        let of_b = self.facets_of(b);
        if of_b.is_empty() {
            return Vec::new();
        }
        let mut common = Vec::new();
        if of_a.len().min(of_b.len()) > LONG {
            self.slabs.around(0.5 * (mesh.position(a) + mesh.position(b)), &mut common);
            common.retain(|&f| holds(f, a) && holds(f, b));
            return common;
        }
        for (list, other) in [(of_a, b), (of_b, a)] {
            if list.len() <= LONG {
                common.extend(list.iter().copied().filter(|&f| holds(f, other)));
            }
        }
        each_once(common)
    }

    /// Writes the facets of moved vertices into the rows, where these are many: a look-up is
    /// quicker there.
    pub(super) fn settle(&mut self) {
        if FULL * self.moved.len() < self.starts.len() {
            return;
        }
        let moved = std::mem::take(&mut self.moved);
        let count = self.starts.len() - 1;
        (self.starts, self.facets) = replaced(&self.starts, &self.facets, count, &moved, |f| f);
    }

    /// Places faces, ascending: each where the triangle of the hull that it is lies, or else on the
    /// facet that holds it best; needles last.
    pub(super) fn assign_faces(&mut self, model: &Model, faces: impl Iterator<Item = FaceId>) {
        let (mesh, hull) = (model.mesh(), model.hull());
        let (mut order, mut needles) = (FacetOrder::of(hull), Vec::new());
        for f in faces {
            let equal = hull.triangle_of(mesh.corners(f)).map(|t| hull.facet_of_triangle(t).0);
            self.facet_of_face[f.index()] = equal.unwrap_or(NONE);
            if equal.is_none() && self.may_lie_on_a_facet(mesh, f) {
                if self.is_needle(mesh, f) {
                    needles.push(f);
                } else {
                    self.facet_of_face[f.index()] = self.best_facet(mesh, f, &mut order);
                }
            }
        }
        self.assign_needles(mesh, model.topology(), &needles, &mut order);
    }

    /// Whether every corner is on the hull.
    pub(super) fn may_lie_on_a_facet(&self, mesh: &Mesh, face: FaceId) -> bool {
        mesh.corners(face).iter().all(|&v| !self.facets_of(v).is_empty())
    }

    /// Each needle follows the faces across longest edges to the first that is none.
    fn assign_needles(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        needles: &[FaceId],
        order: &mut FacetOrder<'_>,
    ) {
        let mut settled = vec![false; needles.len()];
        for (first, &needle) in needles.iter().enumerate() {
            let mut trail = Vec::new();
            let (mut at, mut place) = (needle, Some(first));
            while let Some(i) = place.filter(|&i| !settled[i]) {
                settled[i] = true;
                trail.push(at);
                let Some(twin) = topology.twin(longest_side(mesh, at)) else { break };
                at = twin.face();
                place = needles.binary_search(&at).ok();
            }
            let mut followed = self.facet_of_face[at.index()];
            for &face in trail.iter().rev() {
                if followed == NONE || !self.holds_face(mesh, followed, face) {
                    followed = self.best_facet(mesh, face, order);
                }
                self.facet_of_face[face.index()] = followed;
            }
        }
    }

    fn holds_face(&self, mesh: &Mesh, facet: u32, face: FaceId) -> bool {
        mesh.triangle(face).iter().all(|&p| self.slabs.holds(facet, p))
    }

    /// Whether a face is no wider than the slabs are deep.
    pub(super) fn is_needle(&self, mesh: &Mesh, face: FaceId) -> bool {
        let [a, b, c] = mesh.triangle(face);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        2.0 * mesh.area_vector(face).length() <= self.slabs.depth() * longest
    }

    /// The facet that a face lies on and agrees with best, or [`NONE`].
    fn best_facet(&self, mesh: &Mesh, face: FaceId, order: &mut FacetOrder<'_>) -> u32 {
        let lists = mesh.corners(face).map(|v| self.facets_of(v));
        let shortest = lists.into_iter().min_by_key(|l| l.len()).unwrap_or_default();
        let few = if shortest.len() <= LONG { shortest } else { &[] };
        let found = self.best_of(mesh, face, few, order);
        if found != NONE {
            return found;
        }
        // The face may lie on a facet of whose triangles no corner is one: beside an edge.
        let [a, b, c] = mesh.triangle(face);
        let mut around = Vec::new();
        self.slabs.around((a + b + c) / 3.0, &mut around);
        self.best_of(mesh, face, &around, order)
    }

    fn best_of(
        &self,
        mesh: &Mesh,
        face: FaceId,
        facets: &[u32],
        order: &mut FacetOrder<'_>,
    ) -> u32 {
        let area_vector = mesh.area_vector(face);
        let tilted = self.is_needle(mesh, face);
        let agreement = |facet: u32| self.slabs.normal(facet).dot(area_vector);
        let lies_on = |facet: u32, agreement: f64| {
            (agreement >= 0.0 || tilted) && self.holds_face(mesh, facet, face)
        };
        let mut best = (f64::NEG_INFINITY, NONE);
        for &facet in facets {
            let agreement = agreement(facet);
            if agreement > best.0 && lies_on(facet, agreement) {
                best = (agreement, facet);
            }
        }
        let (most, mut first) = best;
        if first == NONE {
            return NONE;
        }
        let tied = most - TIED * area_vector.length();
        for &facet in facets.iter().filter(|&&facet| facet != best.1) {
            let agreement = agreement(facet);
            if agreement >= tied
                && lies_on(facet, agreement)
                && order.compare(facet, first) == Ordering::Less
            {
                first = facet;
            }
        }
        first
    }
}

/// The longest side of a face, the first of equals.
fn longest_side(mesh: &Mesh, face: FaceId) -> HalfEdgeId {
    let [a, b, c] = mesh.triangle(face);
    let lengths = [b - a, c - b, a - c].map(DVec3::length_squared);
    HalfEdgeId::of(face, DVec3::from_array(lengths).max_position())
}
