//! The exact hull after some points have moved, found from the one before.
//!
//! First the vertices that have moved are taken out, at their old places, one by one. The triangles
//! around such a vertex `d` leave a hole, bounded by its *link*; all others stay what they were, triangles
//! with every point below. Whatever fills the hole is seen from `d`, and its vertices lie in the convex
//! hull of `d` and its link: a ray from `d` through one of them meets it before it meets the link's
//! own hull. So the points in the box around the old triangles are all that can come out, and the
//! filling is that part of the hull of these points and the link that `d` sees.
//!
//! Then the moved points are put in at their new places, as quickhull does: a walk along the surface
//! finds the triangle that the ray from an inner point through the new one leaves by; if that
//! triangle has the point above it, what the point sees is replaced by a fan.
//!
//! All signs are exact, and the result is checked where it is new: every edge convex or flat, every
//! vertex extreme. Cases that are not worth the care (a vertex inside a flat facet or edge comes out,
//! coincident points, a hull that collapses) are not repaired: the caller builds the hull anew.
//!
//! Source: points are put in as by Barber, Dobkin and Huhdanpaa (1996, "The quickhull algorithm for convex
//! hulls"); how they are taken out is argued above and this crate's own. Cost: for each vertex taken out a hull of
//! its link and the points in the box of its triangles, O(m log m) for m of them; for each point put in the
//! triangles that the walk passes and those that the point sees.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{Aabb, DVec3, Sign, orient3d};

use super::quickhull::{Surface, hull_of_some, next, previous};
use super::span::{Projection, Span, collinear, planar_hull, span_of};

const NONE: u32 = u32::MAX;

/// A hull in the making, over indices of points.
pub(super) struct Repair<'a> {
    points: &'a [DVec3],
    /// Old places of moved points that are still vertices.
    old: BTreeMap<u32, DVec3>,
    triangles: Vec<[u32; 3]>,
    twins: Vec<u32>,
    /// A half-edge that starts at a vertex; `NONE` for points that are none.
    leaving: Vec<u32>,
    /// Strictly inside.
    middle: DVec3,
    /// Triangles from this one on are new.
    first_new: u32,
}

/// A surface, and which triangle of the one before each of its triangles was; `NONE` of new ones.
pub(super) struct Repaired {
    pub(super) surface: Surface,
    pub(super) before: Vec<u32>,
}

impl<'a> Repair<'a> {
    /// Of a surface over indices of `points`, `old` naming the places that vertices of it had, `middle` a point
    /// certainly inside.
    pub(super) fn new(
        points: &'a [DVec3],
        old: BTreeMap<u32, DVec3>,
        surface: Surface,
        middle: DVec3,
    ) -> Self {
        let mut leaving = vec![NONE; points.len()];
        for h in 0..surface.twins.len() as u32 {
            leaving[surface.origin(h) as usize] = h;
        }
        let first_new = surface.triangles.len() as u32;
        let Surface { triangles, twins } = surface;
        Self { points, old, triangles, twins, leaving, middle, first_new }
    }

    fn at(&self, v: u32) -> DVec3 {
        self.old.get(&v).copied().unwrap_or(self.points[v as usize])
    }

    fn side_of(&self, triangle: [u32; 3], p: DVec3) -> Sign {
        let [a, b, c] = triangle.map(|v| self.at(v));
        orient3d(a, b, c, p)
    }

    fn is_alive(&self, t: u32) -> bool {
        self.triangles[t as usize][0] != NONE
    }

    fn origin(&self, h: u32) -> u32 {
        self.triangles[h as usize / 3][h as usize % 3]
    }

    /// Whether a point is a vertex.
    pub(super) fn is_vertex(&self, v: u32) -> bool {
        self.leaving[v as usize] != NONE
    }

    /// Takes a vertex out; `near` tells the points that may come out, which lie in a box: no moved ones.
    /// `None` where the hole cannot be filled.
    pub(super) fn take_out(&mut self, d: u32, near: impl Fn(&Aabb) -> Vec<u32>) -> Option<()> {
        let spokes = self.spokes(d);
        let place = self.at(d);
        // Seen from outside, the link runs around counter-clockwise.
        let link: Vec<(u32, u32, u32)> = spokes
            .iter()
            .map(|&h| {
                let rim = next(h);
                (self.origin(rim), self.origin(next(rim)), self.twins[rim as usize])
            })
            .collect();
        let corners = link.iter().map(|&(from, ..)| self.at(from));
        let bounds = Aabb::of_points(corners.chain([place]));
        let mut some: BTreeSet<u32> = link.iter().map(|l| l.0).collect();
        some.extend(near(&bounds).into_iter().filter(|&v| v != d && !self.is_vertex(v)));
        let some: Vec<u32> = some.into_iter().collect();
        let places: Vec<DVec3> = some.iter().map(|&v| self.at(v)).collect();
        let filling = match span_of(&places) {
            Span::Space(_) => self.seen_from(place, &some, &places)?,
            Span::Plane(triangle) => {
                let triangle = triangle.map(|i| places[i as usize]);
                let outline = planar_hull(&places, Projection::of_plane(triangle)?);
                fan_along(&link, outline.into_iter().map(|i| some[i as usize]).collect())?
            }
            _ => return None,
        };
        for &h in &spokes {
            self.triangles[h as usize / 3] = [NONE; 3];
        }
        self.leaving[d as usize] = NONE;
        self.old.remove(&d);
        self.fill(&link, &filling)
    }

    /// The half-edges that leave a vertex, in the order in which its link runs.
    fn spokes(&self, d: u32) -> Vec<u32> {
        let first = self.leaving[d as usize];
        let mut spokes = vec![first];
        let mut h = self.twins[previous(first) as usize];
        while h != first {
            spokes.push(h);
            h = self.twins[previous(h) as usize];
        }
        spokes
    }

    /// The triangles of the hull of some points that have `eye` above them.
    fn seen_from(&self, eye: DVec3, some: &[u32], places: &[DVec3]) -> Option<Vec<[u32; 3]>> {
        let surface = hull_of_some(places)?;
        let seen = surface.triangles.iter().filter(|t| {
            let [a, b, c] = t.map(|v| places[v as usize]);
            orient3d(a, b, c, eye) == Sign::Positive
        });
        Some(seen.map(|t| t.map(|v| some[v as usize])).collect())
    }

    /// Closes a hole with triangles; `None` where its rim is not theirs. `rim`: edges of the triangles to
    /// come, and the half-edge beyond each.
    fn fill(&mut self, rim: &[(u32, u32, u32)], triangles: &[[u32; 3]]) -> Option<()> {
        let mut open: BTreeMap<(u32, u32), u32> =
            rim.iter().map(|&(from, to, beyond)| ((to, from), beyond)).collect();
        for &corners in triangles {
            let t = self.triangles.len() as u32;
            if self.side_of(corners, self.middle) != Sign::Negative {
                return None;
            }
            self.triangles.push(corners);
            self.twins.extend([NONE; 3]);
            for h in 3 * t..3 * t + 3 {
                let (from, to) = (self.origin(h), self.origin(next(h)));
                self.leaving[from as usize] = h;
                match open.remove(&(to, from)) {
                    Some(twin) => {
                        self.twins[h as usize] = twin;
                        self.twins[twin as usize] = h;
                    }
                    // An edge run twice the same way is no surface.
                    None if open.insert((from, to), h).is_some() => return None,
                    None => {}
                }
            }
        }
        open.is_empty().then_some(())
    }

    /// Puts a point in at its new place, if it is outside; `start` is a triangle to walk from. Returns one
    /// to walk from next, or `None` where the point lies in the place of a vertex that it would have to
    /// replace.
    pub(super) fn put_in(&mut self, v: u32, start: Option<u32>) -> Option<u32> {
        let p = self.points[v as usize];
        let seen = self.triangle_towards(p, start)?;
        let corners = self.triangles[seen as usize];
        if self.side_of(corners, p) != Sign::Positive {
            let same = corners.into_iter().find(|&c| self.at(c) == p);
            return same.is_none_or(|c| c < v).then_some(seen);
        }
        let mut visible = BTreeSet::from([seen]);
        let mut front = vec![seen];
        let mut horizon = Vec::new();
        while let Some(t) = front.pop() {
            for h in 3 * t..3 * t + 3 {
                let twin = self.twins[h as usize];
                if visible.contains(&(twin / 3)) {
                    continue;
                }
                if self.side_of(self.triangles[twin as usize / 3], p) == Sign::Positive {
                    visible.insert(twin / 3);
                    front.push(twin / 3);
                }
            }
        }
        for &t in &visible {
            for h in 3 * t..3 * t + 3 {
                let twin = self.twins[h as usize];
                if !visible.contains(&(twin / 3)) {
                    horizon.push((self.origin(h), self.origin(next(h)), twin));
                }
            }
        }
        for &t in &visible {
            for corner in std::mem::replace(&mut self.triangles[t as usize], [NONE; 3]) {
                self.leaving[corner as usize] = NONE;
            }
        }
        // What is left of the vertices lies on the horizon.
        for &(_, to, beyond) in &horizon {
            self.leaving[to as usize] = beyond;
        }
        let fan: Vec<[u32; 3]> = horizon.iter().map(|&(from, to, _)| [from, to, v]).collect();
        self.fill(&horizon, &fan)?;
        Some(self.triangles.len() as u32 - 1)
    }

    /// The triangle through which the ray from the middle towards a point leaves.
    fn triangle_towards(&self, p: DVec3, start: Option<u32>) -> Option<u32> {
        let any = || (0..self.triangles.len() as u32).rev().find(|&t| self.is_alive(t));
        let mut t = start.filter(|&t| self.is_alive(t)).or_else(any)?;
        let mut visited = BTreeSet::from([t]);
        loop {
            let beyond = |h: &u32| self.lies_beyond(*h, p);
            let out: Vec<u32> = (3 * t..3 * t + 3).filter(beyond).collect();
            if out.is_empty() {
                return Some(t);
            }
            let across = out.into_iter().map(|h| self.twins[h as usize] / 3);
            match across.into_iter().find(|next| !visited.contains(next)) {
                Some(next) => t = next,
                // The walk has run into itself.
                None => break,
            }
            visited.insert(t);
        }
        let holds =
            |&t: &u32| self.is_alive(t) && (3 * t..3 * t + 3).all(|h| !self.lies_beyond(h, p));
        (0..self.triangles.len() as u32).find(holds)
    }

    /// Whether a point lies beyond the plane through the middle and a half-edge, seen from its triangle.
    fn lies_beyond(&self, h: u32, p: DVec3) -> bool {
        let (a, b) = (self.at(self.origin(h)), self.at(self.origin(next(h))));
        orient3d(self.middle, a, b, p) == Sign::Negative
    }

    /// The surface, where all that is new is sound; its vertices are exactly the extreme points.
    pub(super) fn finish(self) -> Option<Repaired> {
        let touched: BTreeSet<u32> = (self.first_new..self.triangles.len() as u32)
            .filter(|&t| self.is_alive(t))
            .flat_map(|t| self.triangles[t as usize])
            .collect();
        for &v in &touched {
            let mut convex = 0;
            for h in self.spokes(v) {
                let apex = self.origin(previous(self.twins[h as usize]));
                match self.side_of(self.triangles[h as usize / 3], self.at(apex)) {
                    Sign::Positive => return None,
                    Sign::Negative => convex += 1,
                    Sign::Zero => {}
                }
            }
            if convex < 3 {
                return None;
            }
        }
        let alive: Vec<u32> =
            (0..self.triangles.len() as u32).filter(|&t| self.is_alive(t)).collect();
        let flat = |t: u32| {
            let [a, b, c] = self.triangles[t as usize].map(|v| self.at(v));
            collinear(a, b, c)
        };
        if alive.iter().any(|&t| t >= self.first_new && flat(t)) {
            return None;
        }
        let mut number = vec![NONE; self.triangles.len()];
        for (new, &old) in (0..).zip(&alive) {
            number[old as usize] = new;
        }
        let mut surface = Surface::default();
        for &t in &alive {
            surface.triangles.push(self.triangles[t as usize]);
            let twins = &self.twins[3 * t as usize..3 * t as usize + 3];
            surface.twins.extend(twins.iter().map(|h| 3 * number[*h as usize / 3] + h % 3));
        }
        let before = alive.into_iter().map(|t| if t < self.first_new { t } else { NONE }).collect();
        Some(Repaired { surface, before })
    }
}

/// Triangles over a convex outline in a plane, turned so that they fit into a link; `None` where the link
/// has other vertices.
fn fan_along(link: &[(u32, u32, u32)], outline: Vec<u32>) -> Option<Vec<[u32; 3]>> {
    let rim: Vec<u32> = link.iter().map(|l| l.0).collect();
    if outline.len() != rim.len() || !outline.iter().all(|v| rim.contains(v)) {
        return None;
    }
    Some((2..rim.len()).map(|i| [rim[0], rim[i - 1], rim[i]]).collect())
}
