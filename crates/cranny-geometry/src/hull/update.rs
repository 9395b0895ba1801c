//! A hull after some of its points have moved.
//!
//! The exact surface is [repaired](super::repair) where it can be, else exchanged, and facets keep their planes where
//! nothing around them is new: all their triangles are there, and all triangles at their corners. The
//! others grow again from what is left. That holds as long as the box of the hull is the same,
//! for the tolerance of merging, and what rounding may do, follow it; a new box means new planes.
//!
//! Source: that of the repair; to keep planes is this crate's own. It is right because new vertices are held against
//! each plane that is kept, so it still has every vertex below it. Cost: with the function.

use cranny_exact::{Aabb, DVec3};

use super::facets::FacetLayer;
use super::quickhull::hull_of_some;
use super::repair::{Repair, Repaired};
use super::support::SupportGraph;
use super::{ConvexHull, HullKind, Leaving, Surface};
use crate::ids::VertexId;
use crate::late::Late;

/// A hull that follows another one.
pub(crate) struct Followed {
    pub(crate) hull: ConvexHull,
    pub(crate) facets: FacetChange,
    /// Triangles that are new or have another number; all, if it could be neither repaired nor exchanged.
    pub(crate) triangles: Vec<u32>,
    /// Number of triangles whose planes were measured.
    pub(crate) measured: usize,
    /// A point certainly in the interior, if one is known.
    pub(crate) inside: Option<DVec3>,
}

/// Which facets are others. All those that are named in neither list are the same triangles in the same plane, and
/// have their number.
#[derive(Default)]
pub(crate) struct FacetChange {
    /// Facets before whose number means no facet, or another one; ascending.
    pub(crate) gone: Vec<u32>,
    /// Facets now that are new, or have another number; ascending.
    pub(crate) fresh: Vec<u32>,
}

impl FacetChange {
    fn of_all(before: usize, now: usize) -> Self {
        Self { gone: (0..before as u32).collect(), fresh: (0..now as u32).collect() }
    }
}

impl ConvexHull {
    /// The hull of `points`, of which those in `moved`, ascending, were elsewhere when this hull was
    /// built. `near` names the points that lie in a box, in any order; `inside` is certainly in the interior of
    /// this hull.
    ///
    /// Cost: O(m log m) for the m triangles and points around those that moved in or out; a look at the plane of each
    /// facet, and copying. Where vertices come or go, all corners are renamed. O(n log n) where the surface cannot be
    /// repaired; where the box is another, O(n) for facets.
    pub(crate) fn followed(
        mut self,
        points: &[DVec3],
        moved: &[VertexId],
        inside: Option<DVec3>,
        flatness: f64,
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Followed {
        let before = self.facet_count();
        let bounds = self.bounds();
        let kind = HullKind::Volume;
        let facets = std::mem::take(&mut self.facets);
        let graph = std::mem::take(&mut self.graph)
            .into_made(|| SupportGraph::new(&self.positions, &self.surface));
        let repaired = inside.filter(|_| self.kind == kind);
        let repaired = repaired.and_then(|inside| self.repaired(points, moved, inside, near));
        let Some(repaired) = repaired else {
            let hull = Self::with_flatness(points, flatness);
            let (measured, inside) = (hull.triangle_count(), hull.inner_point());
            let facets = FacetChange::of_all(before, hull.facet_count());
            let triangles = (0..measured as u32).collect();
            return Followed { hull, facets, triangles, measured, inside };
        };
        let Repaired { positions, surface, leaving, numbering, fresh, .. } = &repaired;
        let mut touched: Vec<u32> =
            fresh.iter().flat_map(|&t| surface.triangles[t as usize]).collect();
        touched.sort_unstable();
        touched.dedup();
        let new_bounds = Aabb::of_points(positions.iter().copied());
        let same_box = new_bounds == bounds;
        let graph =
            graph.followed(positions, surface, leaving, numbering, &touched, &bounds, same_box);
        let (facets, change, measured) = if same_box {
            facets.followed(&repaired, &touched, &graph, &bounds)
        } else {
            let facets = FacetLayer::new(kind, positions, surface, &graph, flatness);
            let change = FacetChange::of_all(before, facets.len());
            (facets, change, surface.triangles.len())
        };
        let Repaired { sources, positions, surface, leaving, fresh, moved, .. } = repaired;
        let triangles = fresh.into_iter().chain(moved.into_values()).collect();
        let hull = Self {
            kind,
            sources,
            positions,
            surface,
            graph: Late::made(graph),
            leaving: Leaving(Late::made(leaving)),
            facets,
            bounds: Late::made(new_bounds),
            excluded: Vec::new(),
        };
        Followed { hull, facets: change, triangles, measured, inside }
    }

    fn repaired(
        self,
        points: &[DVec3],
        moved: &[VertexId],
        inside: DVec3,
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Option<Repaired> {
        let mut repair = Repair::new(points, self, inside);
        let mut is_repaired = repair.move_points(moved, near).is_some() && repair.is_sound();
        is_repaired = is_repaired && repair.make_canonical().is_some();
        if !is_repaired {
            repair.undo();
            repair.exchange(&hull_of_some(points)?, moved)?;
            if !repair.is_sound() {
                return None;
            }
        }
        Some(repair.finish())
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
    use super::super::Facet;
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
        hull.clone().followed(points, moved, hull.inner_point(), super::super::FLATNESS, near)
    }

    /// Everything but numbers of triangles and facets is the same, bit for bit.
    fn assert_same(followed: &ConvexHull, rebuilt: &ConvexHull, what: &str) {
        assert_eq!(followed.sources(), rebuilt.sources(), "{what}");
        assert_eq!(followed.positions(), rebuilt.positions(), "{what}");
        let told = |hull: &ConvexHull| {
            let facet = |f: Facet<'_>| {
                let mut triangles: Vec<_> =
                    f.triangles.iter().map(|&t| hull.triangle(t as usize)).collect();
                triangles.sort_unstable();
                let mut corners = f.corners.to_vec();
                let lowest = (0..corners.len()).min_by_key(|&i| corners[i]);
                corners.rotate_left(lowest.unwrap_or(0));
                let plane = [f.normal.x, f.normal.y, f.normal.z, f.offset, f.thickness];
                (triangles, corners, plane.map(f64::to_bits))
            };
            let mut facets: Vec<_> = hull.facets().map(facet).collect();
            facets.sort_unstable();
            facets
        };
        assert_eq!(told(followed), told(rebuilt), "{what}");
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
            assert_same(&followed.hull, &rebuilt, &format!("step {step}"));
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
    fn what_cannot_be_repaired_is_exchanged_where_it_changes() {
        // Points of a lattice in a ball: its sides are polygons of many corners, triangulated one way or another, and
        // have vertices in their middle, which come out and go in again.
        let radius = 9i32;
        let range = || -radius..=radius;
        let lattice =
            range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
        let in_ball = lattice.filter(|p| p.iter().map(|x| x * x).sum::<i32>() <= radius * radius);
        let mut points: Vec<DVec3> = in_ball.map(|p| DVec3::from_array(p.map(f64::from))).collect();
        let mut hull = ConvexHull::of_points(&points);
        let first = hull.triangle_count();
        let is_away = |p: DVec3| p.abs().max_element() < f64::from(radius);
        let corners: Vec<VertexId> =
            hull.sources().iter().copied().filter(|v| is_away(points[v.index()])).collect();
        let (mut measured, mut all) = (0, 0);
        for pair in corners.chunks_exact(2).step_by(3) {
            let there = pair.iter().map(|v| points[v.index()]).collect::<Vec<_>>();
            for scale in [1.01, 1.0, 0.875, 1.0] {
                for (v, place) in pair.iter().zip(&there) {
                    points[v.index()] = scale * place;
                }
                let followed = follow(&hull, &points, pair);
                assert_eq!(followed.hull.validate(&points), []);
                assert_same(&followed.hull, &ConvexHull::of_points(&points), "");
                measured += followed.measured;
                all += followed.hull.triangle_count();
                hull = followed.hull;
            }
        }
        assert_eq!(hull.triangle_count(), first);
        assert!(2 * measured < all, "{measured} of {all}");
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
