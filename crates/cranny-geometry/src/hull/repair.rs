//! The exact hull after some points have moved, found from the one before.
//!
//! First the vertices that have moved are taken out, at their old places, one by one. The facets
//! around such a vertex `d`, whole planes of triangles, leave a hole; all others stay what they
//! were, triangles with every point below. Whatever fills the hole is seen from `d` or lies in a
//! plane of these, and its vertices lie in the convex hull of `d` and the rim: a ray from `d`
//! through one of them meets it before it meets the rim's own hull. So the points in the box around
//! the old triangles are all that can come out. Every edge of the rim is bent, and bent more when
//! `d` is gone; so it is an edge of the hull of these points and the rim too, and the filling is
//! that part of it that the rim encloses. (Were triangles of the same plane left standing, their
//! edges need not be edges of that hull.)
//!
//! Then the moved points are put in at their new places, as quickhull does: a walk along the
//! surface finds the triangle that the ray from an inner point through the new one leaves by; if
//! that triangle has the point above it, what the point sees is replaced by a fan.
//!
//! All signs are exact, and the result is checked where it is new: every edge convex or flat, every
//! vertex extreme. Where that fails (a vertex inside a flat facet or edge comes out, points
//! coincide), all is undone and the surface is [exchanged](exchange) for one that was built anew.
//!
//! Source: points are put in as by Barber, Dobkin and Huhdanpaa (1996, "The quickhull algorithm for
//! convex hulls"); how they are taken out is argued above and this crate's own. Cost: for each
//! vertex taken out a hull of its link and the points in the box of its triangles, O(m log m) for m
//! of them; for each point put in the triangles that the walk passes and those that the point sees.

mod exchange;
mod filling;
mod finish;

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{Aabb, DVec3, Sign, orient3d};

use self::filling::{fan_along, within};
pub(super) use self::finish::Repaired;
use super::ConvexHull;
use super::canonical::lowest_corner;
use super::quickhull::{HullSurface, hull_of_some, previous};
use super::span::{Span, axis_of_plane, planar_hull, span_of};
use crate::ids::VertexId;

const NONE: u32 = u32::MAX;

/// A hull in the making. Vertices of the hull before keep their numbers, and their places even
/// where they have moved; whatever comes in, moved points among them, gets a number behind these.
pub(super) struct HullRepair<'a> {
    points: &'a [DVec3],
    sources: Vec<VertexId>,
    positions: Vec<DVec3>,
    /// Number of vertices before.
    known: usize,
    /// The numbers of points that were no vertices.
    extra: BTreeMap<u32, u32>,
    surface: HullSurface,
    /// A half-edge that starts at a vertex; `NONE` for points that are none.
    leaving: Vec<u32>,
    /// Strictly inside.
    middle: DVec3,
    /// Triangles from this one on are new.
    first_new: u32,
    /// Triangles that are gone, and what their corners were.
    dead: Vec<(u32, [u32; 3])>,
    /// Twins of triangles before that were replaced, and what they were.
    replaced: Vec<(u32, u32)>,
}

impl<'a> HullRepair<'a> {
    /// Of the surface of a hull whose points are now at `points`, `middle` a point certainly inside
    /// it.
    pub(super) fn new(points: &'a [DVec3], hull: ConvexHull, middle: DVec3) -> Self {
        let leaving = hull.leaving.0.into_made(|| hull.surface.leaving(hull.positions.len()));
        Self {
            points,
            known: hull.sources.len(),
            sources: hull.sources,
            positions: hull.positions,
            extra: BTreeMap::new(),
            first_new: hull.surface.triangles.len() as u32,
            surface: hull.surface,
            leaving,
            middle,
            dead: Vec::new(),
            replaced: Vec::new(),
        }
    }

    /// Everything is as it was. O(n).
    pub(super) fn undo(&mut self) {
        let before = self.first_new as usize;
        self.surface.triangles.truncate(before);
        self.surface.twins.truncate(3 * before);
        for (t, corners) in self.dead.drain(..).filter(|d| (d.0 as usize) < before) {
            self.surface.triangles[t as usize] = corners;
        }
        for (h, twin) in self.replaced.drain(..).rev() {
            self.surface.twins[h as usize] = twin;
        }
        self.sources.truncate(self.known);
        self.positions.truncate(self.known);
        self.extra.clear();
        self.leaving = self.surface.leaving(self.sources.len());
    }

    fn at(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    fn side_of(&self, triangle: [u32; 3], p: DVec3) -> Sign {
        let [a, b, c] = triangle.map(|v| self.at(v));
        orient3d(a, b, c, p)
    }

    fn is_alive(&self, t: u32) -> bool {
        self.surface.triangles[t as usize][0] != NONE
    }

    /// The number of a vertex that the hull before had.
    pub(super) fn known(&self, point: VertexId) -> Option<u32> {
        self.sources[..self.known].binary_search(&point).ok().map(|i| i as u32)
    }

    /// The number of a point, which has one now.
    fn entered(&mut self, point: u32) -> u32 {
        let (number, place) = (self.sources.len() as u32, self.points[point as usize]);
        *self.extra.entry(point).or_insert_with(|| {
            self.sources.push(VertexId(point));
            self.positions.push(place);
            self.leaving.push(NONE);
            number
        })
    }

    fn kill(&mut self, t: u32) {
        let corners = std::mem::replace(&mut self.surface.triangles[t as usize], [NONE; 3]);
        self.dead.push((t, corners));
    }

    /// Takes the vertices that have moved out, and puts all points that have moved, ascending, in
    /// at their new places; `near` returns the points that lie in a box. `None` where that cannot
    /// be done.
    pub(super) fn move_points(
        &mut self,
        moved: &[VertexId],
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Option<()> {
        let is_moved = |v: VertexId| moved.binary_search(&v).is_ok();
        let unmoved = |bounds: &Aabb| -> Vec<u32> {
            let mut found = near(bounds);
            found.retain(|&v| !is_moved(v));
            found.into_iter().map(|v| v.0).collect()
        };
        for &v in moved {
            if let Some(known) = self.known(v) {
                self.take_out(known, unmoved)?;
            }
        }
        // Moved points lie side by side, as a rule: each walk begins where the last one ended, the
        // first at what was made last.
        let mut start = None;
        for &v in moved {
            start = Some(self.put_in(v.0, start)?);
        }
        Some(())
    }

    /// Takes a vertex of the hull before out; `near` returns the points that may come out, which
    /// lie in a box: no moved ones. `None` where the hole cannot be filled.
    fn take_out(&mut self, d: u32, near: impl Fn(&Aabb) -> Vec<u32>) -> Option<()> {
        let region = self.facets_around(d);
        let rim = self.rim_of(&region)?;
        let bounds = {
            let corners = region.iter().flat_map(|&t| self.surface.triangles[t as usize]);
            Aabb::of_points(corners.map(|v| self.at(v)))
        };
        let mut some: Vec<u32> = rim.iter().map(|edge| edge.0).collect();
        for v in near(&bounds) {
            let number = match self.known(VertexId(v)) {
                Some(number) => number,
                None => self.entered(v),
            };
            if number != d && self.leaving[number as usize] == NONE {
                some.push(number);
            }
        }
        some.sort_unstable_by_key(|&v| self.sources[v as usize]);
        some.dedup();
        let places: Vec<DVec3> = some.iter().map(|&v| self.at(v)).collect();
        let filling = match span_of(&places) {
            Span::Space(_) => within(&hull_of_some(&places)?, &some, &rim)?,
            Span::Plane(triangle) => {
                let triangle = triangle.map(|i| places[i as usize]);
                let outline = planar_hull(&places, axis_of_plane(triangle)?);
                fan_along(&rim, outline.into_iter().map(|i| some[i as usize]).collect())?
            }
            _ => return None,
        };
        for t in region {
            self.kill(t);
        }
        self.leaving[d as usize] = NONE;
        self.fill(&rim, &filling)
    }

    /// The triangles around a vertex, and those that lie in one plane with one of them and hang
    /// together with it.
    fn facets_around(&self, d: u32) -> BTreeSet<u32> {
        self.facets_of(self.surface.spokes(self.leaving[d as usize]).map(|h| h / 3).collect())
    }

    /// Some triangles, and those that lie in one plane with one of them and hang together with it.
    fn facets_of(&self, front: Vec<u32>) -> BTreeSet<u32> {
        let is_flat = |h: u32| {
            let apex = self.at(self.surface.origin(previous(self.surface.twins[h as usize])));
            self.side_of(self.surface.triangles[h as usize / 3], apex) == Sign::Zero
        };
        self.surface.hanging_together(front, is_flat)
    }

    /// The edges of some triangles that lie between them and others, each with the half-edge
    /// beyond it.
    fn edges_around(
        &self,
        triangles: impl IntoIterator<Item = u32>,
        is_one: impl Fn(u32) -> bool,
    ) -> Vec<(u32, u32, u32)> {
        let half_edges = triangles.into_iter().flat_map(|t| 3 * t..3 * t + 3);
        let edge = |h: u32| {
            let [from, to] = self.surface.ends(h);
            (from, to, self.surface.twins[h as usize])
        };
        half_edges.map(edge).filter(|&(.., beyond)| !is_one(beyond / 3)).collect()
    }

    /// The edges around triangles that hang together, each with the half-edge beyond it, in their
    /// order; `None` where they are not one loop.
    fn rim_of(&self, region: &BTreeSet<u32>) -> Option<Vec<(u32, u32, u32)>> {
        let mut edges = BTreeMap::new();
        for edge in self.edges_around(region.iter().copied(), |t| region.contains(&t)) {
            let is_second = edges.insert(edge.0, edge).is_some();
            if is_second {
                return None;
            }
        }
        let mut rim = vec![*edges.first_key_value()?.1];
        while rim.len() < edges.len() {
            let following = *edges.get(&rim[rim.len() - 1].1)?;
            if following.0 == rim[0].0 {
                return None;
            }
            rim.push(following);
        }
        Some(rim)
    }

    /// A triangle from the corner on whose point is the lowest.
    fn lowest_first(&self, mut corners: [u32; 3]) -> [u32; 3] {
        let points = corners.map(|v| self.sources[v as usize].0);
        corners.rotate_left(lowest_corner(points) as usize);
        corners
    }

    /// Closes a hole with triangles; `None` where its rim is not theirs. `rim`: edges of the
    /// triangles to come, and the half-edge beyond each.
    fn fill(&mut self, rim: &[(u32, u32, u32)], triangles: &[[u32; 3]]) -> Option<()> {
        let mut open: BTreeMap<(u32, u32), u32> =
            rim.iter().map(|&(from, to, beyond)| ((to, from), beyond)).collect();
        for &corners in triangles {
            let t = self.surface.triangles.len() as u32;
            if self.side_of(corners, self.middle) != Sign::Negative {
                return None;
            }
            let corners = self.lowest_first(corners);
            self.surface.triangles.push(corners);
            self.surface.twins.extend([NONE; 3]);
            for h in 3 * t..3 * t + 3 {
                let [from, to] = self.surface.ends(h);
                self.leaving[from as usize] = h;
                match open.remove(&(to, from)) {
                    Some(twin) => {
                        self.surface.twins[h as usize] = twin;
                        let former = std::mem::replace(&mut self.surface.twins[twin as usize], h);
                        if twin / 3 < self.first_new {
                            self.replaced.push((twin, former));
                        }
                    }
                    // An edge run twice the same way is no surface.
                    None if open.insert((from, to), h).is_some() => return None,
                    None => {}
                }
            }
        }
        open.is_empty().then_some(())
    }

    /// Puts a point in at its new place, if it is outside; `start` is a triangle to walk from.
    /// Returns one to walk from next, or `None` where the point lies in the place of a vertex that
    /// it would have to replace.
    fn put_in(&mut self, point: u32, start: Option<u32>) -> Option<u32> {
        let p = self.points[point as usize];
        let seen = self.triangle_towards(p, start)?;
        let corners = self.surface.triangles[seen as usize];
        if self.side_of(corners, p) != Sign::Positive {
            let same = corners.into_iter().find(|&c| self.at(c) == p);
            let is_first = |c: u32| self.sources[c as usize].0 < point;
            return same.is_none_or(is_first).then_some(seen);
        }
        let v = self.entered(point);
        let is_seen = |h: u32| {
            let beside = self.surface.twins[h as usize] / 3;
            self.side_of(self.surface.triangles[beside as usize], p) == Sign::Positive
        };
        let visible = self.surface.hanging_together(vec![seen], is_seen);
        let horizon = self.edges_around(visible.iter().copied(), |t| visible.contains(&t));
        for &t in &visible {
            for corner in self.surface.triangles[t as usize] {
                self.leaving[corner as usize] = NONE;
            }
            self.kill(t);
        }
        // What is left of the vertices lies on the horizon.
        for &(_, to, beyond) in &horizon {
            self.leaving[to as usize] = beyond;
        }
        let fan: Vec<[u32; 3]> = horizon.iter().map(|&(from, to, _)| [from, to, v]).collect();
        self.fill(&horizon, &fan)?;
        Some(self.surface.triangles.len() as u32 - 1)
    }

    /// The triangle through which the ray from the middle towards a point leaves.
    fn triangle_towards(&self, p: DVec3, start: Option<u32>) -> Option<u32> {
        let any = || (0..self.surface.triangles.len() as u32).rev().find(|&t| self.is_alive(t));
        let start = start.filter(|&t| self.is_alive(t)).or_else(any)?;
        let found = self.surface.walk(start, |h| self.lies_beyond(h, p));
        // Where the walk has run into itself, all are looked at.
        let holds =
            |&t: &u32| self.is_alive(t) && (3 * t..3 * t + 3).all(|h| !self.lies_beyond(h, p));
        found.map(|(t, _)| t).or_else(|| (0..self.surface.triangles.len() as u32).find(holds))
    }

    /// Whether a point lies beyond the plane through the middle and a half-edge, seen from its
    /// triangle.
    fn lies_beyond(&self, h: u32, p: DVec3) -> bool {
        let [a, b] = self.surface.ends(h).map(|v| self.at(v));
        orient3d(self.middle, a, b, p) == Sign::Negative
    }
}
