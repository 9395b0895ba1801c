//! From components to numbered concavities with lids, loops, outlines and sizes.
//!
//! No source: this crate's own; volumes are sums of cones, as in Mirtich (1996). Cost: passes over
//! hull, faces and caps, O(m log m) for m cap triangles and edges of rims, and k² for k facets that
//! are covered together, each of which looks at the others. What lies in what stands in `nesting`.

use std::collections::BTreeMap;

use cranny_exact::{Aabb, DVec3};

use super::components::Components;
use super::input::{Input, twice_area_vector};
use super::nesting::{self, Surface};
use super::{Border, ConcavityKind, ConcavitySet, LidRecord, MIXED, Measures, Record, SOLID, Skin};
use crate::caps::CapSurface;
use crate::features::{Features, NONE};
use crate::ids::{CapId, ConcavityId};
use cranny_geometry::hull::{FacetId, lowest_first};
use cranny_geometry::rows::{row, rows};
use cranny_geometry::{EdgeId, EdgeKind, FaceId, HalfEdgeId, Model, VertexId};

/// A lid opens nowhere if its opening is this share of its area or less: it goes around, as the
/// whole hull does, and what is left of a sum is rounding. Smaller, and the rounding of some
/// thousand caps is taken for a direction; larger, and so are lids that bend back but for a sliver
/// (`a_lid_all_around_opens_nowhere`).
pub(super) const CANCELLED: f64 = 1e-12;

/// A record that the steps below fill in.
pub(super) const BLANK: Record = Record {
    kind: ConcavityKind::Pocket,
    parent: NONE,
    first_face: 0,
    first_cap: 0,
    first_lid: 0,
    first_loop: 0,
    measures: Measures { cap_area: 0.0, face_area: 0.0, pocket_volume: 0.0, opening: DVec3::ZERO },
};

/// The first of some caps in the order of their vertices, which is the same however facets are
/// numbered.
pub(super) fn first_of_caps(
    caps: &CapSurface,
    some: impl Iterator<Item = usize>,
) -> Option<[u32; 3]> {
    some.map(|cap| lowest_first(caps.triangles[cap])).min()
}

impl ConcavitySet {
    /// Joins off-hull faces and caps.
    pub(crate) fn of(model: &Model, features: &Features, caps: CapSurface) -> Self {
        let input = Input::of(model, features);
        let components = Components::of(&input, &caps);
        let mut all = input.number(components, caps);
        input.gather_faces(&mut all);
        input.find_loops(&mut all);
        input.gather_caps(&mut all);
        input.measure(&mut all);
        input.name(&mut all);
        input.nest(&mut all);
        all
    }
}

impl Input<'_> {
    /// Numbers components by their least faces, those without by [the first](first_of_caps) of
    /// their caps, and lids by their least caps. What has no faces and covers nothing is skin and
    /// gets no number.
    fn number(&self, mut components: Components, caps: CapSurface) -> ConcavitySet {
        let (faces, count) = (self.mesh.faces().len(), caps.triangles.len());
        let mut is_skin = vec![false; count];
        let bare = (0..count).map(|cap| (cap, components.of_cap(cap)));
        let bare = bare.filter_map(|(cap, root)| Some((cap, root.checked_sub(faces)?)));
        self.skin(&caps, bare.collect(), &mut is_skin);
        let mut number_of_root = vec![NONE; faces + count];
        let mut records = Vec::new();
        let mut number = |root: usize| {
            if number_of_root[root] == NONE {
                number_of_root[root] = records.len() as u32;
                records.push(BLANK);
            }
            number_of_root[root]
        };
        let mut concavity_of_face = vec![NONE; faces];
        for face in (0..faces as u32).map(FaceId).filter(|&f| !self.features.is_convex(f)) {
            concavity_of_face[face.index()] = number(components.of_face(face));
        }
        let roots: Vec<usize> = (0..count).map(|cap| components.of_cap(cap)).collect();
        let is_skin = |root: usize| root >= faces && is_skin[root - faces];
        let mut faceless: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (cap, &root) in roots.iter().enumerate().filter(|(_, r)| **r >= faces && !is_skin(**r))
        {
            faceless.entry(root).or_default().push(cap);
        }
        let mut faceless: Vec<(Option<[u32; 3]>, usize)> = faceless
            .into_iter()
            .map(|(root, own)| (first_of_caps(&caps, own.into_iter()), root))
            .collect();
        faceless.sort_unstable();
        for (_, root) in faceless {
            number(root);
        }
        let concavity_of_cap: Vec<u32> =
            roots.iter().map(|&root| if is_skin(root) { NONE } else { number(root) }).collect();

        let mut roots: Vec<(u32, usize)> = (0..count)
            .filter(|&cap| concavity_of_cap[cap] != NONE && components.lid_of(cap) == cap)
            .map(|cap| (concavity_of_cap[cap], cap))
            .collect();
        roots.sort_unstable();
        let mut lid_of_root = vec![NONE; count];
        for (lid, &(_, root)) in roots.iter().enumerate() {
            lid_of_root[root] = lid as u32;
        }
        let lid_of_cap = (0..count)
            .map(|cap| match concavity_of_cap[cap] {
                NONE => NONE,
                _ => lid_of_root[components.lid_of(cap)],
            })
            .collect();
        let lid = |&(concavity, _): &(u32, usize)| LidRecord {
            concavity: ConcavityId(concavity),
            first_cap: 0,
            first_outline: 0,
            area: 0.0,
            opening: DVec3::ZERO,
        };
        ConcavitySet {
            records,
            lids: roots.iter().map(lid).collect(),
            concavity_of_cap,
            lid_of_cap,
            ..ConcavitySet::blank(concavity_of_face, caps)
        }
    }

    fn gather_faces(&self, all: &mut ConcavitySet) {
        let (starts, faces) = rows(&all.concavity_of_face, all.records.len());
        for (record, &start) in all.records.iter_mut().zip(&starts) {
            record.first_face = start;
        }
        all.faces = faces.into_iter().map(FaceId).collect();
    }

    /// The boundary of each concavity's faces, split into simple loops.
    fn find_loops(&self, all: &mut ConcavitySet) {
        let mut rims: Vec<(u32, [u32; 2])> = Vec::new();
        let of_face = &all.concavity_of_face;
        let edges = self.topology.edge_ids();
        if let Some(pairs) = self.topology.pairs() {
            // Nearly no edge.
            let parts = |pair: &[HalfEdgeId; 2]| {
                let [one, other] = pair.map(|h| of_face[h.face().index()]);
                one != other
            };
            let on_rims = edges.zip(pairs).filter(|(_, pair)| parts(pair));
            on_rims.for_each(|(e, _)| self.rims_at(e, of_face, &mut rims));
        } else {
            edges.for_each(|e| self.rims_at(e, of_face, &mut rims));
        }
        rims.sort_unstable();
        let mut edges = Vec::new();
        for i in 0..all.records.len() {
            let first = rims.partition_point(|&(c, _)| (c as usize) < i);
            let last = rims.partition_point(|&(c, _)| (c as usize) <= i);
            all.records[i].first_loop = all.loops.len() as u32;
            edges.clear();
            edges.extend(rims[first..last].iter().map(|&(_, e)| e));
            all.loops.split(&mut edges);
        }
        self.find_borders(all, 0);
    }

    /// The directed edges that remain, at an edge of the mesh, of the boundaries of concavities.
    pub(super) fn rims_at(
        &self,
        e: EdgeId,
        concavity_of_face: &[u32],
        rims: &mut Vec<(u32, [u32; 2])>,
    ) {
        let edge = &self.topology.edges()[e.index()];
        let around = self.topology.half_edges(e);
        let concavity = |k: usize| concavity_of_face[around[k].face().index()];
        if edge.kind == EdgeKind::Manifold && concavity(0) == concavity(1) {
            return; // nearly every edge
        }
        let inside = (1..around.len()).all(|k| concavity(k) == concavity(0));
        if edge.from == edge.to || (inside && (concavity(0) == NONE || edge.kind.is_balanced())) {
            return;
        }
        for k in 0..around.len() {
            let c = concavity(k);
            if c == NONE || (0..k).any(|j| concavity(j) == c) {
                continue;
            }
            let runs_forward = |k: &usize| {
                let h = around[*k];
                self.mesh.corners(h.face())[h.corner()] == edge.from
            };
            let own = (0..around.len()).filter(|&k| concavity(k) == c);
            let (forward, backward): (Vec<usize>, Vec<usize>) = own.partition(runs_forward);
            let net = forward.len() as i64 - backward.len() as i64;
            let (from, to) = (edge.from.0, edge.to.0);
            let ends = if net > 0 { [from, to] } else { [to, from] };
            rims.extend((0..net.abs()).map(|_| (c, ends)));
        }
    }

    /// What the edges of loops border on, from a loop on.
    pub(super) fn find_borders(&self, all: &mut ConcavitySet, first: usize) {
        for i in first..all.loops.len() {
            let row = &all.loops.vertices[all.loops.row(i)];
            for (k, &from) in row.iter().enumerate() {
                let to = row[(k + 1) % row.len()];
                all.borders.push(self.border(from.0, to.0));
            }
        }
    }

    fn border(&self, from: u32, to: u32) -> Border {
        let ends = [from.min(to), from.max(to)].map(VertexId);
        let Some(e) = self.topology.edge_between(ends) else {
            return Border::Open;
        };
        let around = self.topology.half_edges(e);
        if around.iter().any(|h| self.features.is_convex(h.face())) {
            Border::Convex
        } else if matches!(self.topology.edges()[e.index()].kind, EdgeKind::Open) {
            Border::Open
        } else {
            Border::Ridge
        }
    }

    /// Orders caps by concavity and lid, and traces the lids' outlines.
    fn gather_caps(&self, all: &mut ConcavitySet) {
        let (starts, order) = rows(&all.lid_of_cap, all.lids.len());
        let order: Vec<CapId> = order.into_iter().map(CapId).collect();
        for (i, record) in all.records.iter_mut().enumerate() {
            record.first_lid = all.lids.partition_point(|l| l.concavity.index() < i) as u32;
            record.first_cap = starts[record.first_lid as usize];
        }
        for lid in 0..all.lids.len() {
            all.lids[lid].first_cap = starts[lid];
            all.lids[lid].first_outline = all.outlines.len() as u32;
            all.trace_outlines(&order[row(&starts, lid)]);
        }
        all.cap_order = order;
        let bears_faces = self.facets_with_faces();
        let facets = 0..self.hull.facet_count() as u32;
        all.cover = facets.map(|f| self.cover(all, FacetId(f), &bears_faces)).collect();
    }

    /// Of each facet whether faces lie on it.
    pub(super) fn facets_with_faces(&self) -> Vec<bool> {
        let mut bears_faces = vec![false; self.hull.facet_count()];
        for &facet in self.features.facets_of_faces() {
            if let Some(bears) = bears_faces.get_mut(facet as usize) {
                *bears = true;
            }
        }
        bears_faces
    }

    /// What covers a facet, together with those that it shares its caps with.
    pub(super) fn cover(&self, all: &ConcavitySet, facet: FacetId, bears_faces: &[bool]) -> u32 {
        let mut owners = all.caps_over(facet).map(|cap| all.concavity_of_cap[cap.index()]);
        let Some(first) = owners.next() else { return SOLID };
        let bears_faces =
            bears_faces[facet.index()] || all.caps.sharing(facet).any(|f| bears_faces[f.index()]);
        match first == NONE || bears_faces || owners.any(|c| c != first) {
            true => MIXED,
            false => first,
        }
    }

    /// Sums areas, volumes and area vectors, of concavities, lids and skin.
    fn measure(&self, all: &mut ConcavitySet) {
        let mut skin = Skin::default();
        for t in 0..self.hull.triangle_count() {
            let corners = self.hull.corners(t);
            skin.area += 0.5 * twice_area_vector(corners).length();
            skin.volume += self.volume_below(corners);
        }
        for face in self.mesh.face_ids() {
            let corners = self.mesh.triangle(face);
            let (area, volume) =
                (0.5 * twice_area_vector(corners).length(), self.volume_below(corners));
            match all.concavity_of_face[face.index()] {
                NONE => {
                    skin.area -= area;
                    skin.volume -= volume;
                }
                concavity => {
                    let measures = &mut all.records[concavity as usize].measures;
                    measures.face_area += area;
                    measures.pocket_volume -= volume;
                }
            }
        }
        let mut gross = vec![0.0; all.lids.len()];
        let mut sign = vec![1.0; all.caps.triangles.len()];
        for cap in &all.caps.negative {
            sign[cap.index()] = -1.0;
        }
        for (cap, sign) in sign.into_iter().enumerate() {
            let corners = self.cap_triangle(&all.caps, cap);
            let opening = 0.5 * twice_area_vector(corners);
            let (area, volume) = (sign * opening.length(), self.volume_below(corners));
            let concavity = all.concavity_of_cap[cap];
            if concavity == NONE {
                skin.caps += 1;
                continue;
            }
            skin.area -= area;
            skin.volume -= volume;
            let measures = &mut all.records[concavity as usize].measures;
            measures.cap_area += area;
            measures.pocket_volume += volume;
            measures.opening += opening;
            let lid = &mut all.lids[all.lid_of_cap[cap] as usize];
            lid.area += area;
            lid.opening += opening;
            gross[all.lid_of_cap[cap] as usize] += area.abs();
        }
        for (lid, gross) in all.lids.iter_mut().zip(gross) {
            if lid.opening.length() <= CANCELLED * gross {
                lid.opening = DVec3::ZERO;
            }
        }
        all.skin = skin;
    }

    pub(super) fn name(&self, all: &mut ConcavitySet) {
        for i in 0..all.records.len() {
            let concavity = all.get(ConcavityId(i as u32));
            let closed = concavity.loops().len() == 0;
            let kind = match concavity.lids().len() {
                0 if closed && concavity.measures.pocket_volume > 0.0 => ConcavityKind::Void,
                0 => ConcavityKind::Island,
                _ if concavity.faces.is_empty() && concavity.measures.cap_area < 0.0 => {
                    ConcavityKind::Overlay
                }
                _ if concavity.faces.is_empty() => ConcavityKind::Opening,
                1 => ConcavityKind::Pocket,
                _ => ConcavityKind::Passage,
            };
            all.records[i].kind = kind;
        }
    }

    /// Finds what surrounds concavities without lids.
    pub(super) fn nest(&self, all: &mut ConcavitySet) {
        if all.len() < 2 || all.iter().all(|c| c.lids().len() > 0) {
            return;
        }
        let surface = |i: u32| {
            let concavity = all.get(ConcavityId(i));
            let faces = concavity.faces.iter().map(|&f| {
                let [a, b, c] = self.mesh.triangle(f);
                [a, c, b]
            });
            let caps = concavity.caps.iter().map(|c| self.cap_triangle(&all.caps, c.index()));
            let triangles: Vec<[DVec3; 3]> = faces.chain(caps).collect();
            Surface {
                bounds: Aabb::of_points(triangles.iter().flatten().copied()),
                is_lidded: !concavity.caps.is_empty(),
                triangles,
            }
        };
        let surfaces: Vec<Surface> = (0..all.len() as u32).map(surface).collect();
        for (record, parent) in all.records.iter_mut().zip(nesting::parents(&surfaces)) {
            record.parent = parent.map_or(NONE, |p| p as u32);
        }
    }
}
