//! The merged layer: nearly coplanar triangles become polygonal facets with a measured thickness.
//!
//! A triangle that clearly bends away from all its neighbours is a facet. The other facets grow
//! from the largest triangle not yet taken, over shared edges, as long as a triangle's corners lie
//! within the tolerance below the facet's supporting plane. Then the plane is fitted again (area
//! vector of what was gathered) and the growth repeated, for a small seed has a crooked normal.
//!
//! A triangle joins only where the facet stays a disk. Nothing is lost by that, in any order of
//! joining: the part of a convex surface above a plane is a disk, and every disk can be completed
//! triangle by triangle from any start (Danaraj and Klee 1978).
//!
//! A *needle*, not wider than the tolerance, has a normal made of rounding; it may join any facet
//! whose plane it is near, whatever its own normal says.
//!
//! Source: planes of a measured thickness in place of exact ones are quickhull's merged facets
//! (Barber, Dobkin and Huhdanpaa 1996); how facets grow is this crate's own. It is right whichever
//! triangles it takes, for every plane is made supporting, and its thickness measured, afterwards.
//! Cost: O(n log n) to order the seeds; then for each facet a few passes over its triangles and a
//! few support queries, which begin on the facet.

mod planes;

use cranny_exact::{Aabb, DVec3};

use self::planes::unit;
use super::outline::Outlines;
use super::quickhull::{HullSurface, previous};
use super::shapes::Shapes;
use super::support::SupportGraph;
use super::{HullKind, HullVertexId};
use crate::rows::{row, rows};
use crate::typed_index;

/// The default tolerance of merging, relative to the largest coordinate magnitude, with which
/// rounding scales. Smaller, and a cube turned and rounded to `f64` has more than six facets;
/// larger, and real features of the shape melt into their neighbours
/// (`a_turned_and_rounded_subdivided_cube_has_six_facets`, `real_creases_are_not_merged`).
pub const FLATNESS: f64 = 64.0 * f64::EPSILON;

/// How often a facet's plane is fitted anew before growth stops. Each round but the last enlarges
/// the facet, nearly all of it in the first; smaller, and facets seeded by slim triangles stay
/// incomplete.
const REFITS: usize = 4;

pub(super) const UNASSIGNED: u32 = u32::MAX;

typed_index! {
    /// A facet of the merged layer, numbered from 0 in no order that means anything.
    FacetId
}

/// A polygon of nearly coplanar triangles: a disk with one outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet<'a> {
    /// Outward, of length 1 to rounding.
    pub normal: DVec3,
    /// Every point `p` of the hull has `normal · p <= offset`, in real arithmetic: rounded outward.
    pub offset: f64,
    /// Every vertex `v` of the facet's triangles has `normal · v >= offset - thickness`, in real
    /// arithmetic. A few roundings where the facet is exactly planar.
    pub thickness: f64,
    /// Outline, counter-clockwise seen from outside, at least three. Vertices within the hull's
    /// [`flatness`](super::ConvexHull::flatness) of the line between their neighbours are left out,
    /// on both sides of an edge alike.
    pub corners: &'a [HullVertexId],
    /// The facet across the edge from `corners[i]` to the next corner.
    pub neighbours: &'a [FacetId],
    /// The triangles merged into it, ascending.
    pub triangles: &'a [u32],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
    pub(super) thickness: f64,
}

/// All facets of a hull.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FacetLayer {
    pub(super) tolerance: f64,
    pub(super) planes: Vec<Plane>,
    pub(super) facet_of: Vec<u32>,
    pub(super) triangle_starts: Vec<u32>,
    pub(super) triangles: Vec<u32>,
    pub(super) outlines: Outlines,
}

impl FacetLayer {
    pub(super) fn new(
        kind: HullKind,
        positions: &[DVec3],
        surface: &HullSurface,
        graph: &SupportGraph,
        flatness: f64,
    ) -> Self {
        let largest = positions.iter().fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        let tolerance = flatness.max(0.0) * largest;
        let shapes = Shapes::new(positions, surface, tolerance);
        let bounds = Aabb::of_points(positions.iter().copied());
        let none = vec![UNASSIGNED; surface.triangles.len()];
        let mut growth =
            Growth::new(positions, surface, graph, tolerance, shapes, none, Vec::new(), &bounds);
        if kind == HullKind::Polygon {
            growth.take_both_sides();
        } else {
            growth.run(0..surface.triangles.len() as u32);
        }
        let Growth { facet_of, planes, .. } = growth;
        let (triangle_starts, triangles) = rows(&facet_of, planes.len());
        let rows = [&*triangle_starts, &*triangles];
        let outlines = Outlines::new(positions, surface, &facet_of, rows, tolerance);
        Self { tolerance, planes, facet_of, triangle_starts, triangles, outlines }
    }

    pub(super) fn len(&self) -> usize {
        self.planes.len()
    }

    pub(super) fn of_triangle(&self, triangle: usize) -> FacetId {
        FacetId(self.facet_of[triangle])
    }

    pub(super) fn facet(&self, facet: FacetId) -> Facet<'_> {
        let Plane { normal, offset, thickness } = self.planes[facet.index()];
        let triangles = &self.triangles[row(&self.triangle_starts, facet.index())];
        let (corners, neighbours) = self.outlines.of(facet);
        Facet { normal, offset, thickness, corners, neighbours, triangles }
    }
}

pub(super) struct Growth<'a> {
    positions: &'a [DVec3],
    surface: &'a HullSurface,
    graph: &'a SupportGraph,
    tolerance: f64,
    extent: DVec3,
    triangles: Shapes,
    pub(super) facet_of: Vec<u32>,
    pub(super) planes: Vec<Plane>,
    round: u32,
    face_round: Vec<u32>,
    vertex_round: Vec<u32>,
}

impl<'a> Growth<'a> {
    pub(super) fn new(
        positions: &'a [DVec3],
        surface: &'a HullSurface,
        graph: &'a SupportGraph,
        tolerance: f64,
        triangles: Shapes,
        facet_of: Vec<u32>,
        planes: Vec<Plane>,
        bounds: &Aabb,
    ) -> Self {
        Self {
            positions,
            surface,
            graph,
            tolerance,
            extent: bounds.max - bounds.min,
            triangles,
            facet_of,
            planes,
            round: 0,
            face_round: vec![0; surface.triangles.len()],
            vertex_round: vec![0; positions.len()],
        }
    }

    /// A plate: its front and its back.
    fn take_both_sides(&mut self) {
        let half = self.surface.triangles.len() as u32 / 2;
        for side in [0..half, half..2 * half] {
            let side: Vec<u32> = side.collect();
            let largest = side
                .iter()
                .copied()
                .max_by(|&a, &b| self.triangles.area(a).total_cmp(&self.triangles.area(b)));
            if let Some(largest) = largest {
                let fitted =
                    unit(self.sum_of_areas(&side)).unwrap_or_else(|| self.normal_of(largest));
                let plane = self.supporting_plane(fitted, &side);
                self.take(&side, plane);
            }
        }
    }

    /// Makes facets of some triangles, ascending.
    pub(super) fn run(&mut self, left: impl Iterator<Item = u32>) {
        let mut seeds = Vec::new();
        for t in left {
            if self.triangles.is_apart(t) {
                let plane = self.plane_of_one(t, self.normal_of(t));
                self.take(&[t], plane);
            } else {
                seeds.push((self.triangles.area(t), t));
            }
        }
        // Where areas are the same, their vertices decide: numbers of triangles mean nothing.
        let corners = |t: u32| self.surface.triangles[t as usize];
        seeds.sort_unstable_by(|a: &(f64, u32), b| {
            b.0.total_cmp(&a.0).then_with(|| corners(a.1).cmp(&corners(b.1)))
        });
        for (_, seed) in seeds {
            if self.facet_of[seed as usize] == UNASSIGNED {
                let (region, plane) = self.facet_from(seed);
                self.take(&region, plane);
            }
        }
    }

    fn take(&mut self, region: &[u32], plane: Plane) {
        let facet = self.planes.len() as u32;
        for &t in region {
            self.facet_of[t as usize] = facet;
        }
        self.planes.push(plane);
    }

    /// The best facet that contains the seed, of the triangles that are left.
    fn facet_from(&mut self, seed: u32) -> (Vec<u32>, Plane) {
        let normal = self.normal_of(seed);
        let mut region = vec![seed];
        let mut plane = self.supporting_plane(normal, &region);
        for _ in 0..REFITS {
            let grown = self.grow(seed, &plane);
            let larger = grown.len() > region.len();
            if larger {
                region = grown;
            }
            let own = self.supporting_plane(plane.normal, &region);
            plane = own;
            let refitted = unit(self.sum_of_areas(&region)).filter(|n| n.dot(normal) > 0.0);
            if let Some(n) = refitted {
                let fitted = self.supporting_plane(n, &region);
                if fitted.thickness < own.thickness {
                    plane = fitted;
                }
            }
            if !larger || plane == own {
                break;
            }
        }
        (region, plane)
    }

    /// The triangles around `seed` that lie within the tolerance below the plane, gathered so that
    /// they form a disk at every moment.
    fn grow(&mut self, seed: u32, plane: &Plane) -> Vec<u32> {
        self.round += 1;
        let strict = self.triangles.is_needle(seed);
        let mut region = Vec::new();
        let mut queue = std::collections::VecDeque::from([seed]);
        while let Some(t) = queue.pop_front() {
            let fits = t == seed
                || (self.facet_of[t as usize] == UNASSIGNED
                    && self.face_round[t as usize] != self.round
                    && self.lies_near(t, plane)
                    && self.faces_along(t, plane, strict)
                    && self.keeps_a_disk(t));
            if !fits || self.face_round[t as usize] == self.round {
                continue;
            }
            self.face_round[t as usize] = self.round;
            for v in self.surface.triangles[t as usize] {
                self.vertex_round[v as usize] = self.round;
            }
            region.push(t);
            let open = (3 * t..3 * t + 3).filter(|&h| !self.triangles.bends(h));
            queue.extend(open.map(|h| self.surface.twins[h as usize] / 3));
        }
        region
    }

    fn lies_near(&self, t: u32, plane: &Plane) -> bool {
        let floor = plane.offset - self.tolerance;
        self.surface.triangles[t as usize]
            .iter()
            .all(|&v| plane.normal.dot(self.positions[v as usize]) >= floor)
    }

    fn faces_along(&self, t: u32, plane: &Plane, strict: bool) -> bool {
        self.triangles.area_vector(t).dot(plane.normal) > 0.0
            || (!strict && self.triangles.is_needle(t))
    }

    /// Whether a disk stays one when `t` joins: over one edge with a new vertex, or over two edges.
    fn keeps_a_disk(&self, t: u32) -> bool {
        let joined =
            |h: u32| self.face_round[self.surface.twins[h as usize] as usize / 3] == self.round;
        let mut edges = (3 * t..3 * t + 3).filter(|&h| joined(h));
        match (edges.next(), edges.count()) {
            (Some(h), 0) => {
                let apex = self.surface.origin(previous(h));
                self.vertex_round[apex as usize] != self.round
            }
            (Some(_), 1) => true,
            _ => false,
        }
    }

    fn sum_of_areas(&self, region: &[u32]) -> DVec3 {
        region.iter().map(|&t| self.triangles.area_vector(t)).sum()
    }
}
