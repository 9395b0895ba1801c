//! Which facets of the hull each vertex lies on.
//!
//! The facets of an extreme vertex are those of the hull's triangles around it. Any other vertex
//! may lie in the slab of a facet, and where there are many, most lie in none, in company: so the
//! tree over the faces is searched first. A box beneath all slabs holds no vertex on the hull;
//! where that cannot be said of a box, its children look at what is left of the facets, and a
//! vertex in the end at a handful.
//!
//! Cost: near-linear; O(log n) for a vertex near the hull, less for those that lie deep.
//!
//! No source: this crate's own. What is left out is so by intervals (Moore 1966, "Interval
//! analysis") that are rounded as heights are, so no vertex in the slab and the box of a facet is
//! missed.

use std::ops::Range;

use cranny_exact::Aabb;

use super::slabs::Slabs;
use cranny_geometry::hull::{ConvexHull, HullVertexId};
use cranny_geometry::{Content, FaceTree, Mesh, Topology, VertexId, each_once};

/// A part of the tree with so few faces is not divided further: its vertices look at what it has
/// left. Fewer, and boxes are looked at in the place of vertices; more, and vertices far from a
/// facet look at it.
const FEW: usize = 8;

/// So many nodes over facets may be left before those of the next level are looked at; more are
/// kept as they are, until smaller boxes have fewer. Smaller, and large boxes look at too little to
/// say anything; larger, and they look at facets that smaller ones look at again.
const MANY: usize = 32;

/// For each vertex the facets that it lies on, ascending, in compressed rows; `tree` is that over
/// all faces.
pub(super) fn facets_of_vertices(
    mesh: &Mesh,
    topology: &Topology,
    hull: &ConvexHull,
    tree: &FaceTree,
    slabs: &Slabs,
) -> (Vec<u32>, Vec<u32>) {
    let count = mesh.vertices().len();
    // Where facets are as many, vertices lie near them as a rule, and are searched one by one as
    // quickly.
    let in_company = count - hull.vertex_count() > hull.facet_count();
    let mut found = Vec::new();
    if in_company {
        let mut settled = vec![false; count];
        hull.sources().iter().for_each(|v| settled[v.index()] = true);
        let mut finder = Finder { mesh, tree, slabs, settled, left: Vec::new(), found };
        finder.look();
        found = finder.found;
        found.sort_unstable();
    }
    let mut starts = Vec::with_capacity(count + 1);
    let mut facets = Vec::with_capacity(found.len() + 3 * hull.triangle_count());
    let (mut corners, mut others) = ((0..).zip(hull.sources()).peekable(), found.iter().peekable());
    starts.push(0);
    for v in 0..count as u32 {
        if let Some((corner, _)) = corners.next_if(|(_, source)| source.0 == v) {
            facets.extend(facets_at(hull, HullVertexId(corner)));
        } else if !in_company || topology.faces_at(VertexId(v)).is_empty() {
            slabs.around(mesh.position(VertexId(v)), &mut facets);
        }
        while let Some(&(_, facet)) = others.next_if(|(vertex, _)| *vertex == v) {
            facets.push(facet);
        }
        starts.push(facets.len() as u32);
    }
    (starts, facets)
}

/// Looks down the tree over faces for vertices in slabs.
struct Finder<'a> {
    mesh: &'a Mesh,
    tree: &'a FaceTree,
    slabs: &'a Slabs,
    /// The vertices that need not be looked at any more.
    settled: Vec<bool>,
    /// What the nodes on the way down have left of the facets, one node's behind its parent's.
    left: Vec<u32>,
    /// Vertices, and facets that they lie on.
    found: Vec<(u32, u32)>,
}

/// A node of the tree to be looked at, and what its parent has left of the facets: a range of nodes
/// of one level of the tree over facets.
struct Task {
    node: u32,
    left: Range<usize>,
    level: usize,
}

impl Finder<'_> {
    fn look(&mut self) {
        let Some(level) = self.slabs.top() else { return };
        self.left.extend(self.slabs.nodes(level).map(|at| at as u32));
        let mut tasks = vec![Task { node: 0, left: 0..self.left.len(), level }];
        while let Some(Task { node, left, mut level }) = tasks.pop() {
            self.left.truncate(left.end);
            let bounds = self.tree.node(node).bounds;
            let mut left = self.reached(&bounds, level, left, |at| at..at + 1);
            while level > 0 && left.len() <= MANY {
                level -= 1;
                let slabs = self.slabs;
                left = self.reached(&bounds, level, left, |at| slabs.beneath(level, at));
            }
            if left.is_empty() {
                continue;
            }
            match self.tree.content(node) {
                Content::Inner { left: one, right: other }
                    if self.tree.surely_has_more(node, FEW)
                        || self.tree.beneath(node).1.len() > FEW =>
                {
                    tasks.extend([other, one].map(|node| Task { node, left: left.clone(), level }));
                }
                _ => self.settle(self.tree.beneath(node).1, level, left),
            }
        }
    }

    /// Appends those of some nodes of a level whose slabs reach into a box: all that `of` makes of
    /// what stands in a range. Where they stand.
    fn reached(
        &mut self,
        bounds: &Aabb,
        level: usize,
        from: Range<usize>,
        of: impl Fn(usize) -> Range<usize>,
    ) -> Range<usize> {
        let start = self.left.len();
        for place in from {
            for at in of(self.left[place] as usize) {
                // Taken back where it does not reach: without a branch that nobody can predict.
                self.left.push(at as u32);
                let reaches = self.slabs.may_reach(level, at, bounds);
                self.left.truncate(self.left.len() - usize::from(!reaches));
            }
        }
        start..self.left.len()
    }

    /// Looks at each vertex of some faces, given the nodes over facets that reach into their box.
    fn settle(&mut self, faces: Range<usize>, level: usize, left: Range<usize>) {
        let mut around = Vec::new();
        for &face in &self.tree.faces()[faces] {
            for v in self.mesh.corners(face) {
                if std::mem::replace(&mut self.settled[v.index()], true) {
                    continue;
                }
                let p = self.mesh.position(v);
                if level > 0 {
                    self.slabs.around(p, &mut around);
                    self.found.extend(around.drain(..).map(|facet| (v.0, facet)));
                    continue;
                }
                for &at in &self.left[left.clone()] {
                    if let Some(facet) = self.slabs.facet_around(at as usize, p) {
                        self.found.push((v.0, facet));
                    }
                }
            }
        }
    }
}

/// The facets of the triangles around a corner of the hull, ascending, each once.
pub(super) fn facets_at(hull: &ConvexHull, corner: HullVertexId) -> Vec<u32> {
    each_once(hull.triangles_at(corner).map(|t| hull.facet_of_triangle(t).0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    #[test]
    fn every_vertex_lies_on_the_facets_that_it_is_told_of_alone() {
        // A tent of 400 sides over a pit, rings of vertices half-way up and half-way down, and a
        // vertex on a side that no face names.
        let n = 400;
        let base = (0..n).map(|k| {
            let (y, x) = (f64::from(k) * std::f64::consts::TAU / f64::from(n)).sin_cos();
            DVec3::new(x, y, 0.0)
        });
        let base: Vec<DVec3> = base.collect();
        let half_way = base.iter().map(|&p| 0.5 * (p + DVec3::Z));
        let others = [DVec3::Z, 0.25 * DVec3::Z, 0.25 * base[7] + 0.75 * DVec3::Z];
        let deep = base.iter().map(|&p| 0.5 * p + 0.125 * DVec3::Z);
        let vertices = base.iter().copied().chain(half_way).chain(deep).chain(others).collect();
        let faces = (0..n).flat_map(|k| {
            let (a, b) = (k, (k + 1) % n);
            let (p, q, up, down) = (2 * n + a, 2 * n + b, 3 * n, 3 * n + 1);
            let above = [[a, b, n + a], [b, n + b, n + a], [n + a, n + b, up]];
            above.into_iter().chain([[b, a, p], [b, p, q], [q, p, down]])
        });
        let mesh = Mesh::new(vertices, faces.collect()).unwrap();
        let (topology, hull) = (Topology::of(&mesh), ConvexHull::of_points(mesh.vertices()));
        let mut slabs = Slabs::of(&hull);
        slabs.prepare_finder(&hull);
        let tree = FaceTree::of(&mesh, 1);
        let (starts, facets) = facets_of_vertices(&mesh, &topology, &hull, &tree, &slabs);
        let row = |v: u32| {
            let [start, end] = [starts[v as usize], starts[v as usize + 1]];
            &facets[start as usize..end as usize]
        };
        for v in
            (0..mesh.vertices().len() as u32).filter(|&v| !hull.sources().contains(&VertexId(v)))
        {
            let mut around = Vec::new();
            slabs.around(mesh.position(VertexId(v)), &mut around);
            assert_eq!(row(v), around, "vertex {v}");
        }
        assert!(
            (n..2 * n).all(|v| !row(v).is_empty()) && (2 * n..3 * n).all(|v| row(v).is_empty())
        );
        assert_eq!((row(3 * n).len(), row(3 * n + 1).len()), (n as usize, 0));
        assert!(!row(3 * n + 2).is_empty());
        assert!(mesh.vertices().len() - hull.vertex_count() > hull.facet_count(), "in company");
    }
}
