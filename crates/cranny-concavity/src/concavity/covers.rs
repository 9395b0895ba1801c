//! What covers the features of a hull: facets, edges and vertices.
//!
//! The faces on a facet and its caps divide it, and where the pieces beside each other end their
//! directed edges cancel. What is left runs along the facet's rim, from corner to corner: so an
//! edge of the hull has beside it the pieces whose edges lead from its one end to the other,
//! however many there are. (Munkres 1984, sections 5 and 6, for chains that cancel.) A vertex of
//! the hull has about it the pieces that have a corner there. Needles are left out, that is, pieces
//! no wider than slabs are deep: which facet or lid one is counted to is a matter of rounding, and
//! it would hide what lies behind it.
//!
//! Where that fails, because rounding has faces reach over the rim, an edge or a vertex answers as
//! its facets do: with all that lies on them, never with less than lies there. So does an edge
//! within a facet, or between facets that are covered together: it is no edge of the body, but for
//! rounding.
//!
//! Cost: O(n log n) in the faces and caps of facets that have both, linear in the hull; 4 bytes for
//! each half-edge, vertex and facet of the hull. Answers are O(1).

use std::collections::BTreeMap;

use super::{ConcavitySet, Cover};
use crate::features::{Features, NONE};
use crate::ids::{CapId, ConcavityId};
use cranny_geometry::Mesh;
use cranny_geometry::Topology;
use cranny_geometry::hull::{ConvexHull, FacetId, HullVertexId};
use cranny_geometry::rows::rows;
use cranny_geometry::{FaceId, HalfEdgeId, VertexId};

/// What covers a feature of the hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FeatureCover<'a> {
    /// Faces of the mesh alone; or skin, where that is all that lies between them and the hull.
    Solid,
    /// Lids of this concavity alone.
    Lid(ConcavityId),
    /// Faces of the mesh and lids, or lids of several concavities.
    Mixed {
        /// Whether faces of the mesh (or skin) are among it.
        solid: bool,
        /// The concavities whose lids are, ascending.
        lids: &'a [ConcavityId],
    },
}

impl<'a> FeatureCover<'a> {
    /// Whether faces of the mesh (or skin) cover it, or some of it.
    #[must_use]
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Solid | Self::Mixed { solid: true, .. })
    }

    /// The concavities whose lids cover it, or some of it; ascending.
    pub fn lids(self) -> impl Iterator<Item = ConcavityId> + use<'a> {
        let (one, more) = match self {
            Self::Solid => (None, &[][..]),
            Self::Lid(concavity) => (Some(concavity), &[][..]),
            Self::Mixed { lids, .. } => (None, lids),
        };
        one.into_iter().chain(more.iter().copied())
    }
}

/// What covers each facet, edge and vertex of a hull.
///
/// The question is what lies *beside* an edge and *around* a vertex: a vertex of the hull is one of
/// the mesh, and so is many an edge between two lids (a [ridge](Features::ridges)).
#[derive(Clone, Debug, PartialEq)]
pub struct HullCovers {
    facets: Vec<Code>,
    /// By half-edge; those of an edge are alike.
    edges: Vec<Code>,
    vertices: Vec<Code>,
    mixed: Vec<(bool, Vec<ConcavityId>)>,
}

/// A concavity, [`SOLID`], or a place in the table of mixtures, counted down from below [`SOLID`].
type Code = u32;

/// No lid. Concavities and mixtures are fewer than features by far, so their numbers do not meet.
const SOLID: Code = u32::MAX;

impl HullCovers {
    pub(crate) fn of(
        mesh: &Mesh,
        topology: &Topology,
        hull: &ConvexHull,
        features: &Features,
        concavities: &ConcavitySet,
    ) -> Self {
        let (first_faces, faces) = rows(features.facets_of_faces(), hull.facet_count());
        let input = CoverInput { mesh, topology, hull, features, concavities, first_faces, faces };
        let mut filing = Filing::default();
        let facet_sets: Vec<Owners> = input.facets().map(|f| input.of_facet(f)).collect();
        let facets = facet_sets.iter().map(|set| filing.code(set)).collect();
        let edges = input.edges(&facet_sets, &mut filing);
        let vertices = input.vertices(&facet_sets, &mut filing);
        Self { facets, edges, vertices, mixed: filing.mixed }
    }

    /// What covers a facet, or the facets that it is [covered
    /// together](ConcavitySet::shared_facets) with. O(1).
    ///
    /// # Panics
    ///
    /// Where the hull has no such facet; so do the functions below for their ids.
    #[must_use]
    pub fn facet(&self, facet: FacetId) -> FeatureCover<'_> {
        self.decoded(self.facets[facet.index()])
    }

    /// What covers the hull beside an edge, on both sides and all along; the same for both
    /// half-edges. An edge within a facet answers as the facet. O(1).
    #[must_use]
    pub fn edge(&self, half_edge: HalfEdgeId) -> FeatureCover<'_> {
        self.decoded(self.edges[half_edge.index()])
    }

    /// What covers the hull around a vertex. A vertex at which nothing but needles has a corner,
    /// which a lid may cover by rounding, answers as its facets. O(1).
    #[must_use]
    pub fn vertex(&self, vertex: HullVertexId) -> FeatureCover<'_> {
        self.decoded(self.vertices[vertex.index()])
    }

    fn decoded(&self, code: Code) -> FeatureCover<'_> {
        if code == SOLID {
            return FeatureCover::Solid;
        }
        match self.mixed.get((SOLID - 1 - code) as usize) {
            Some((solid, lids)) => FeatureCover::Mixed { solid: *solid, lids },
            None => FeatureCover::Lid(ConcavityId(code)),
        }
    }
}

/// Concavities, and [`NONE`] for faces and skin; ascending.
type Owners = Vec<u32>;

fn sorted(mut owners: Owners) -> Owners {
    owners.sort_unstable();
    owners.dedup();
    owners
}

/// Gives each mixture its number.
#[derive(Default)]
struct Filing {
    mixed: Vec<(bool, Vec<ConcavityId>)>,
    numbers: BTreeMap<Owners, Code>,
}

impl Filing {
    fn code(&mut self, owners: &Owners) -> Code {
        if let &[owner] = owners.as_slice() {
            return if owner == NONE { SOLID } else { owner };
        }
        if let Some(&code) = self.numbers.get(owners) {
            return code;
        }
        let lids = owners.iter().filter(|&&o| o != NONE).map(|&o| ConcavityId(o)).collect();
        self.mixed.push((owners.contains(&NONE), lids));
        let code = SOLID - self.mixed.len() as u32;
        self.numbers.insert(owners.clone(), code);
        code
    }
}

struct CoverInput<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    hull: &'a ConvexHull,
    features: &'a Features,
    concavities: &'a ConcavitySet,
    /// The faces on each facet, in rows.
    first_faces: Vec<u32>,
    faces: Vec<u32>,
}

impl CoverInput<'_> {
    fn facets(&self) -> impl Iterator<Item = FacetId> + use<> {
        (0..self.hull.facet_count() as u32).map(FacetId)
    }

    /// The facets that a facet is covered together with, itself among them.
    fn group(&self, facet: FacetId) -> Vec<FacetId> {
        let shared: Vec<FacetId> = self.concavities.caps.sharing(facet).collect();
        if shared.is_empty() { vec![facet] } else { shared }
    }

    fn faces_on(&self, facet: FacetId) -> impl Iterator<Item = FaceId> + '_ {
        let row = self.first_faces[facet.index()]..self.first_faces[facet.index() + 1];
        self.faces[row.start as usize..row.end as usize].iter().map(|&f| FaceId(f))
    }

    /// Whether a triangle is wider, across its longest side, than slabs are deep.
    fn is_wide(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|v| self.mesh.position(VertexId(v)));
        let longest = (b - a).length_squared().max((c - b).length_squared());
        let longest = longest.max((a - c).length_squared());
        let depth = self.features.slab_depth();
        (b - a).cross(c - a).length_squared() > depth * depth * longest
    }

    fn owner(&self, cap: u32) -> u32 {
        self.concavities.concavity_of_cap[cap as usize]
    }

    fn of_facet(&self, facet: FacetId) -> Owners {
        match self.concavities.cover(facet) {
            Cover::Solid => vec![NONE],
            Cover::Lid(concavity) => vec![concavity.0],
            Cover::Mixed(_) => {
                let caps = self.concavities.caps_over(facet).map(|CapId(cap)| self.owner(cap));
                let bears_faces =
                    self.group(facet).iter().any(|&f| self.faces_on(f).next().is_some());
                sorted(caps.chain(bears_faces.then_some(NONE)).collect())
            }
        }
    }

    /// The codes of half-edges.
    fn edges(&self, facet_sets: &[Owners], filing: &mut Filing) -> Vec<Code> {
        let count = 3 * self.hull.triangle_count();
        let mut beside: Vec<Option<Owners>> = vec![None; count];
        for facet in self.facets().filter(|f| facet_sets[f.index()].len() > 1) {
            let group = self.group(facet);
            if group[0] == facet {
                self.trace(&group, &mut beside);
            }
        }
        let side = |h: HalfEdgeId| {
            let facet = self.hull.facet_of_triangle(h.index() / 3);
            beside[h.index()].as_ref().unwrap_or(&facet_sets[facet.index()])
        };
        let mut codes = vec![SOLID; count];
        for h in (0..count as u32).map(HalfEdgeId) {
            let twin = self.hull.twin(h);
            if h <= twin {
                let (one, other) = (side(h), side(twin));
                let code = match one == other {
                    true => filing.code(one),
                    false => filing.code(&sorted([&one[..], other].concat())),
                };
                codes[h.index()] = code;
                codes[twin.index()] = code;
            }
        }
        codes
    }

    /// Finds what lies beside each edge on the rim of facets that are covered together.
    fn trace(&self, group: &[FacetId], beside: &mut [Option<Owners>]) {
        let mut pieces: Vec<([u32; 3], u32)> = Vec::new();
        for &facet in group {
            let faces = self.faces_on(facet).map(|f| (self.mesh.faces()[f.index()], NONE));
            pieces.extend(faces.filter(|(corners, _)| self.is_wide(*corners)));
            let caps = self.concavities.caps.of_facet(facet);
            let caps = caps.map(|c| (self.concavities.caps.triangles[c as usize], self.owner(c)));
            pieces.extend(caps.filter(|(corners, _)| self.is_wide(*corners)));
        }
        let rim = left_over(&pieces);
        let is_inner = |h: HalfEdgeId| {
            group.contains(&self.hull.facet_of_triangle(self.hull.twin(h).index() / 3))
        };
        let triangles = group.iter().flat_map(|&f| self.hull.facet(f).triangles);
        let half_edges = triangles.flat_map(|&t| (3 * t..3 * t + 3).map(HalfEdgeId));
        for h in half_edges.filter(|&h| !is_inner(h)) {
            let corners = self.hull.triangle(h.index() / 3).map(|v| self.hull.source(v).0);
            let ends = [corners[h.index() % 3], corners[(h.index() + 1) % 3]];
            beside[h.index()] = owners_along(&rim, ends);
        }
    }

    /// The codes of vertices.
    fn vertices(&self, facet_sets: &[Owners], filing: &mut Filing) -> Vec<Code> {
        let of_source = |v: u32| self.hull.vertex_of_source(VertexId(v));
        let mut around: Vec<(u32, u32)> = Vec::new();
        for cap in 0..self.concavities.cap_count() as u32 {
            let corners = self.concavities.caps.triangles[cap as usize];
            if !self.is_wide(corners) {
                continue;
            }
            let corners = corners.into_iter().filter_map(of_source);
            around.extend(corners.map(|v| (v.0, self.owner(cap))));
        }
        around.sort_unstable();
        around.dedup();
        let mut caps = around.as_slice();
        let own = |v: usize| {
            let (own, rest) = caps.split_at(caps.partition_point(|&(at, _)| at as usize == v));
            caps = rest;
            let mut owners: Owners = own.iter().map(|&(_, owner)| owner).collect();
            let faces = self.topology.faces_at(self.hull.sources()[v]);
            let is_solid = |f: &FaceId| {
                self.features.is_convex(*f) && self.is_wide(self.mesh.faces()[f.index()])
            };
            if faces.iter().any(is_solid) {
                owners.push(NONE);
            }
            sorted(owners)
        };
        let mut sets: Vec<Owners> = (0..self.hull.vertex_count()).map(own).collect();
        self.add_of_facets(&mut sets, facet_sets);
        sets.iter().map(|set| filing.code(set)).collect()
    }

    /// Gives vertices at which nothing wide has a corner what lies on their facets.
    fn add_of_facets(&self, sets: &mut [Owners], facet_sets: &[Owners]) {
        let is_bare: Vec<bool> = sets.iter().map(Vec::is_empty).collect();
        for t in 0..self.hull.triangle_count() {
            let facet = self.hull.facet_of_triangle(t);
            for v in self.hull.triangle(t).into_iter().filter(|v| is_bare[v.index()]) {
                let both = [&sets[v.index()][..], &facet_sets[facet.index()]].concat();
                sets[v.index()] = sorted(both);
            }
        }
    }
}

/// The directed edges of some triangles that do not cancel, sorted, with whose they are.
fn left_over(pieces: &[([u32; 3], u32)]) -> Vec<([u32; 2], u32)> {
    let edges_of = |&([a, b, c], owner): &([u32; 3], u32)| {
        [[a, b], [b, c], [c, a]].map(|ends: [u32; 2]| (ends, owner))
    };
    let mut edges: Vec<([u32; 2], u32)> = pieces.iter().flat_map(edges_of).collect();
    let key = |&([a, b], _): &([u32; 2], u32)| [a.min(b), a.max(b)];
    let is_forward = |&([a, b], _): &([u32; 2], u32)| a < b;
    edges.sort_unstable_by_key(key);
    let mut left = Vec::new();
    for row in edges.chunk_by(|a, b| key(a) == key(b)) {
        let forward = row.iter().filter(|e| is_forward(e)).count();
        if 2 * forward != row.len() {
            let stays = 2 * forward > row.len();
            left.extend(row.iter().filter(|e| is_forward(e) == stays));
        }
    }
    left.sort_unstable();
    left.dedup();
    left
}

/// Whose the edges are that lead from one vertex to another; `None` where no way leads there, or
/// several.
fn owners_along(rim: &[([u32; 2], u32)], [mut at, end]: [u32; 2]) -> Option<Owners> {
    let mut owners = Vec::new();
    for _ in 0..rim.len() {
        let first = rim.partition_point(|&([from, _], _)| from < at);
        let count = rim[first..].partition_point(|&([from, _], _)| from == at);
        let steps = &rim[first..first + count];
        let to = steps.first()?.0[1];
        if steps.iter().any(|&([_, other], _)| other != to) {
            return None;
        }
        owners.extend(steps.iter().map(|&(_, owner)| owner));
        at = to;
        if at == end {
            return Some(sorted(owners));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rim_is_followed_from_corner_to_corner() {
        // A square of four corners; 4 divides the first edge. A lid over its one end, faces
        // elsewhere.
        let lid = 5;
        let pieces = [([0, 4, 3], lid), ([4, 1, 2], NONE), ([4, 2, 3], NONE)];
        let rim = left_over(&pieces);
        assert_eq!(rim.len(), 5);
        assert_eq!(owners_along(&rim, [0, 1]), Some(vec![lid, NONE]));
        assert_eq!(owners_along(&rim, [1, 2]), Some(vec![NONE]));
        assert_eq!(owners_along(&rim, [3, 0]), Some(vec![lid]));
        assert_eq!(owners_along(&rim, [0, 9]), None);
    }

    #[test]
    fn a_rim_that_forks_is_not_followed() {
        let pieces = [([0, 1, 2], NONE), ([0, 3, 4], 1)];
        assert_eq!(owners_along(&left_over(&pieces), [0, 1]), None);
        assert_eq!(owners_along(&left_over(&pieces), [1, 0]), Some(vec![NONE]));
    }

    #[test]
    fn mixtures_are_told_apart_from_concavities() {
        let mut filing = Filing::default();
        let codes = [vec![NONE], vec![3], vec![0, NONE], vec![0, 1], vec![0, NONE], vec![]]
            .map(|owners| filing.code(&owners));
        let mixed = filing.mixed;
        let covers = HullCovers { facets: codes.to_vec(), edges: vec![], vertices: vec![], mixed };
        let decoded = |f| covers.facet(FacetId(f));
        let both = [ConcavityId(0), ConcavityId(1)];
        assert_eq!(decoded(0), FeatureCover::Solid);
        assert_eq!(decoded(1), FeatureCover::Lid(ConcavityId(3)));
        assert_eq!(decoded(2), FeatureCover::Mixed { solid: true, lids: &both[..1] });
        assert_eq!(decoded(3), FeatureCover::Mixed { solid: false, lids: &both });
        assert_eq!(decoded(4), decoded(2));
        assert_eq!(decoded(5), FeatureCover::Mixed { solid: false, lids: &[] });
        assert!(decoded(2).is_solid() && !decoded(1).is_solid());
        assert_eq!(
            decoded(1).lids().chain(decoded(3).lids()).map(|c| c.0).collect::<Vec<_>>(),
            [3, 0, 1]
        );
    }
}
