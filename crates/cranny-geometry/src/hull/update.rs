//! A hull after some of its points have moved.
//!
//! The exact surface is [repaired](super::repair) where it can be, and facets keep their planes where
//! nothing around them is new: all their triangles are there, and all triangles at their corners. The
//! others grow again from what is left. That holds as long as the box of the hull is the same,
//! for the tolerance of merging, and what rounding may do, follow it; a new box means new planes.
//!
//! Source: that of the repair; to keep planes is this crate's own. It is right because new vertices are held against
//! each plane that is kept, so it still has every vertex below it. Cost: with the function.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{Aabb, DVec3};

use super::facets::FacetLayer;
use super::repair::{Repair, Repaired};
use super::support::SupportGraph;
use super::{ConvexHull, HullKind, Surface};
use crate::ids::VertexId;
use crate::late::Late;

/// No facet.
pub(crate) const GONE: u32 = u32::MAX;

/// A hull that follows another one.
pub(crate) struct Followed {
    pub(crate) hull: ConvexHull,
    /// The facet that each facet before has become: the same triangles in the same plane; [`GONE`] where
    /// there is none.
    pub(crate) facets: Vec<u32>,
    /// Number of triangles whose planes were measured.
    pub(crate) measured: usize,
    /// A point certainly in the interior, if one is known.
    pub(crate) inside: Option<DVec3>,
}

impl ConvexHull {
    /// The hull of `points`, of which those in `moved`, ascending, were elsewhere when this hull was
    /// built. `near` names the points that lie in a box, in any order; `inside` is certainly in the interior of
    /// this hull.
    ///
    /// Cost: O(m log m) for the m triangles and points around those that moved in or out, and passes of a
    /// few nanoseconds over all vertices and triangles. O(n log n) where the surface cannot be repaired.
    pub(crate) fn followed(
        &self,
        points: &[DVec3],
        moved: &[VertexId],
        inside: Option<DVec3>,
        flatness: f64,
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Followed {
        let repaired = inside.and_then(|inside| self.repaired(points, moved, inside, near));
        let Some(Repaired { surface, before }) = repaired else {
            let hull = Self::with_flatness(points, flatness);
            let (measured, inside) = (hull.triangle_count(), hull.inner_point());
            return Followed { hull, facets: vec![GONE; self.facet_count()], measured, inside };
        };
        let mut is_vertex = vec![false; points.len()];
        surface.triangles.iter().flatten().for_each(|&v| is_vertex[v as usize] = true);
        let vertices: Vec<u32> =
            (0..points.len() as u32).filter(|&v| is_vertex[v as usize]).collect();
        let fresh = |v: &&u32| {
            moved.binary_search(&VertexId(**v)).is_ok()
                || self.vertex_of_source(VertexId(**v)).is_none()
        };
        let fresh: Vec<DVec3> =
            vertices.iter().filter(fresh).map(|&v| points[v as usize]).collect();
        let (positions, surface) = renumbered(points, &vertices, surface);
        let graph = SupportGraph::new(&positions, &surface);
        let same_box = Aabb::of_points(positions.iter().copied()) == self.bounds();
        let (facets, map, measured) = if same_box {
            self.facets.followed(&before, &positions, &surface, &graph, &fresh)
        } else {
            let kind = HullKind::Volume;
            let facets = FacetLayer::new(kind, &positions, &surface, &graph, flatness);
            (facets, vec![GONE; self.facet_count()], surface.triangles.len())
        };
        let hull = Self {
            kind: HullKind::Volume,
            sources: vertices.into_iter().map(VertexId).collect(),
            positions,
            surface,
            graph: Late::made(graph),
            facets,
            excluded: Vec::new(),
        };
        Followed { hull, facets: map, measured, inside }
    }

    fn repaired(
        &self,
        points: &[DVec3],
        moved: &[VertexId],
        inside: DVec3,
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Option<Repaired> {
        if self.kind != HullKind::Volume {
            return None;
        }
        let is_moved = |v: VertexId| moved.binary_search(&v).is_ok();
        let leaving: Vec<u32> =
            moved.iter().filter(|&&v| self.vertex_of_source(v).is_some()).map(|v| v.0).collect();
        let place = |v: u32| (v, self.vertex_of_source(VertexId(v)).map(|h| self.position(h)));
        let old: BTreeMap<u32, DVec3> =
            leaving.iter().map(|&v| place(v)).filter_map(|(v, p)| Some((v, p?))).collect();
        let source = |v: u32| self.sources[v as usize].0;
        let triangles = self.surface.triangles.iter().map(|t| t.map(source)).collect();
        let surface = Surface { triangles, twins: self.surface.twins.clone() };
        let mut repair = Repair::new(points, old, surface, inside);
        let unmoved = |bounds: &Aabb| -> Vec<u32> {
            let found: BTreeSet<VertexId> = near(bounds).into_iter().collect();
            found.into_iter().filter(|&v| !is_moved(v)).map(|v| v.0).collect()
        };
        for &v in &leaving {
            repair.take_out(v, unmoved)?;
        }
        // Moved points lie side by side, as a rule: each walk begins where the last one ended.
        let mut start = None;
        for &v in moved {
            start = Some(repair.put_in(v.0, start)?);
        }
        repair.finish()
    }
}

/// The places of some points, and a surface over these.
pub(super) fn renumbered(
    points: &[DVec3],
    vertices: &[u32],
    mut surface: Surface,
) -> (Vec<DVec3>, Surface) {
    let mut local = vec![0; points.len()];
    for (id, &v) in vertices.iter().enumerate() {
        local[v as usize] = id as u32;
    }
    for corner in surface.triangles.iter_mut().flatten() {
        *corner = local[*corner as usize];
    }
    (vertices.iter().map(|&v| points[v as usize]).collect(), surface)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in −1..1 that look random.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn point(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next())
        }

        fn below(&mut self, count: usize) -> usize {
            ((self.next() + 1.0) * 0.5 * count as f64) as usize % count
        }
    }

    fn follow(hull: &ConvexHull, points: &[DVec3], moved: &[VertexId]) -> Followed {
        let near = |bounds: &Aabb| {
            let all = (0..).map(VertexId).zip(points);
            all.filter(|(_, p)| bounds.contains_point(**p)).map(|(v, _)| v).collect()
        };
        hull.followed(points, moved, hull.inner_point(), super::super::FLATNESS, near)
    }

    /// Moves points again and again; returns how many triangles were measured, and how many there were.
    fn knead(
        mut points: Vec<DVec3>,
        noise: &mut Noise,
        at_once: usize,
        mut to: impl FnMut(&mut Noise, DVec3) -> DVec3,
    ) -> (usize, usize) {
        let mut hull = ConvexHull::of_points(&points);
        let (mut measured, mut all) = (0, 0);
        for step in 0..40 {
            let mut moved: Vec<VertexId> =
                (0..at_once).map(|_| VertexId(noise.below(points.len()) as u32)).collect();
            moved.sort_unstable();
            moved.dedup();
            for v in &moved {
                points[v.index()] = to(noise, points[v.index()]);
            }
            let followed = follow(&hull, &points, &moved);
            let rebuilt = ConvexHull::of_points(&points);
            assert_eq!(followed.hull.validate(&points), [], "step {step}");
            assert_eq!(followed.hull.sources(), rebuilt.sources(), "step {step}");
            assert_eq!(followed.hull.facet_count(), rebuilt.facet_count(), "step {step}");
            measured += followed.measured;
            all += followed.hull.triangle_count();
            hull = followed.hull;
        }
        (measured, all)
    }

    #[test]
    fn a_ball_of_points_is_kneaded_and_stays_the_hull() {
        let mut noise = Noise(1);
        let mut ball: Vec<DVec3> = Vec::new();
        while ball.len() < 400 {
            let p = noise.point();
            ball.extend(Some(p).filter(|p| p.length() < 1.0));
        }
        // Corners that never move keep the box.
        ball.extend((0..6).map(|i| DVec3::AXES[i / 2] * if i % 2 == 0 { 2.0 } else { -2.0 }));
        let inward = |noise: &mut Noise, p: DVec3| {
            if p.length() == 2.0 {
                p
            } else {
                (p * (1.0 + 0.5 * noise.next())).clamp_length_max(1.9)
            }
        };
        let (measured, all) = knead(ball, &mut noise, 5, inward);
        assert!(5 * measured < 4 * all, "{measured} of {all}");
    }

    #[test]
    fn a_smooth_hull_is_repaired_where_it_is_dented_and_bumped() {
        let mut noise = Noise(2);
        let mut sphere: Vec<DVec3> = (0..2000).map(|_| noise.point().normalize()).collect();
        sphere.extend(DVec3::AXES.into_iter().flat_map(|a| [1.2 * a, -1.2 * a]));
        let nudge = |noise: &mut Noise, p: DVec3| {
            if p.length() > 1.1 { p } else { p * (1.0 + 0.02 * noise.next()) }
        };
        let (measured, all) = knead(sphere, &mut noise, 1, nudge);
        assert!(100 * measured < 3 * all, "{measured} of {all}");
    }

    #[test]
    fn points_of_a_lattice_come_out_in_planes_and_on_top_of_each_other() {
        let mut noise = Noise(3);
        let cell = |i: i32| f64::from(i % 5 - 2);
        let lattice = (0..125).map(|i| DVec3::new(cell(i), cell(i / 5), cell(i / 25))).collect();
        let onto = |noise: &mut Noise, _: DVec3| (2.4 * noise.point()).round();
        knead(lattice, &mut noise, 3, onto);
    }

    #[test]
    fn a_vertex_pushed_in_brings_out_what_lay_beneath() {
        // An octahedron with a smaller one inside.
        let corners = |r: f64| DVec3::AXES.into_iter().flat_map(move |a| [r * a, -r * a]);
        let mut points: Vec<DVec3> = corners(1.0).chain(corners(0.75)).collect();
        let hull = ConvexHull::of_points(&points);
        assert_eq!(hull.vertex_count(), 6);
        points[0] = DVec3::ZERO;
        let Followed { hull, .. } = follow(&hull, &points, &[VertexId(0)]);
        assert_eq!(hull.validate(&points), []);
        assert_eq!(hull.sources(), [1, 2, 3, 4, 5, 6].map(VertexId));
        assert!(!hull.contains_point(0.8 * DVec3::X) && hull.contains_point(0.75 * DVec3::X));
    }
}
