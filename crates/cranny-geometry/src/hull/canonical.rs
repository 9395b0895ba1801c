//! The one triangulation of a hull that its points alone decide.
//!
//! Where more than three extreme points lie in one plane, how their polygon is triangulated is left
//! open by the points, and quickhull leaves it to the order in which it met them; a hull that
//! follows moved points meets them in another. Whatever rounds over triangles, or grows from one to
//! the next, would differ between the two. So a surface is brought into one form: each exactly
//! planar polygon is [halved], from its lowest vertex on, and each triangle names its lowest vertex
//! first.
//!
//! Halving, and no fan: a vertex of a polygon of n corners gets O(log n) edges, so a climb over
//! neighbours stays quick.
//!
//! No source: this crate's own. Cost: O(n) for polygons of n corners in all.

use super::quickhull::{HullSurface, next};

/// The corners of a triangle from each of them on.
pub(super) const TURNED: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// The corner of a triangle, 0 to 2, from which on its vertices are listed: the lowest. Without
/// branches, which nobody could foretell.
#[inline]
pub(super) fn lowest_corner([a, b, c]: [u32; 3]) -> u32 {
    u32::from(b < a.min(c)) + 2 * u32::from(c < a.min(b))
}

/// A triangle, from its lowest vertex on.
pub fn lowest_first(mut triangle: [u32; 3]) -> [u32; 3] {
    let first = lowest_corner(triangle) as usize;
    triangle.rotate_left(first);
    triangle
}

/// The triangles of a convex polygon of so many corners, at least three, as indices of corners
/// `[i, m, k]`, ascending: each stands on the chord from `i` to `k`, the first on the edge from the
/// last corner to corner 0.
pub(super) fn halved(corners: u32) -> impl Iterator<Item = [u32; 3]> {
    let mut chords = vec![[0, corners - 1]];
    std::iter::from_fn(move || {
        let [from, to] = chords.pop()?;
        let middle = u32::midpoint(from, to);
        let halves = [[middle, to], [from, middle]];
        chords.extend(halves.into_iter().filter(|[from, to]| to - from > 1));
        Some([from, middle, to])
    })
}

/// Brings a surface, all vertices of which are extreme and lowest first in their triangles, into
/// the one form; `flat` are the half-edges of all its flat edges, one of each.
pub(super) fn canonical(mut surface: HullSurface, flat: &[u32]) -> HullSurface {
    if flat.is_empty() {
        return surface;
    }
    let mut is_flat = vec![false; surface.twins.len()];
    for &h in flat {
        is_flat[h as usize] = true;
        is_flat[surface.twins[h as usize] as usize] = true;
    }
    let mut is_done = vec![false; surface.triangles.len()];
    let mut polygon = Polygon::default();
    for &h in flat {
        if !is_done[h as usize / 3] {
            polygon.gather(&surface, h / 3, &is_flat, &mut is_done);
            polygon.retriangulate(&mut surface);
        }
    }
    surface
}

/// A polygon of a surface.
#[derive(Default)]
struct Polygon {
    triangles: Vec<u32>,
    /// Corners, counter-clockwise, from the lowest on; and the half-edge beyond the edge from each
    /// to the next.
    rim: Vec<(u32, u32)>,
}

impl Polygon {
    /// All that lies in one plane with a triangle; what is flat is marked by half-edge.
    fn gather(
        &mut self,
        surface: &HullSurface,
        first: u32,
        is_flat: &[bool],
        is_done: &mut [bool],
    ) {
        self.triangles.clear();
        self.rim.clear();
        self.triangles.push(first);
        is_done[first as usize] = true;
        let mut looked_at = 0;
        let mut on_rim = None;
        while let Some(&t) = self.triangles.get(looked_at) {
            looked_at += 1;
            for h in 3 * t..3 * t + 3 {
                let beside = surface.twins[h as usize] / 3;
                if !is_flat[h as usize] {
                    on_rim = Some(h);
                } else if !std::mem::replace(&mut is_done[beside as usize], true) {
                    self.triangles.push(beside);
                }
            }
        }
        self.triangles.sort_unstable();
        let following = |h: u32| {
            let mut h = next(h);
            while is_flat[h as usize] {
                h = next(surface.twins[h as usize]);
            }
            h
        };
        let corner = |h: u32| (surface.origin(h), surface.twins[h as usize]);
        if let Some(first) = on_rim {
            self.rim.push(corner(first));
            let mut h = following(first);
            while h != first {
                self.rim.push(corner(h));
                h = following(h);
            }
        }
        let lowest = (0..self.rim.len()).min_by_key(|&i| self.rim[i].0);
        self.rim.rotate_left(lowest.unwrap_or(0));
    }

    /// Puts the triangles of the one form in the places of those that are there.
    fn retriangulate(&self, surface: &mut HullSurface) {
        // A disk of extreme points: two triangles fewer than corners.
        debug_assert_eq!(self.triangles.len() + 2, self.rim.len());
        let count = self.rim.len() as u32;
        let mut waiting = vec![[0, count - 1, self.rim[self.rim.len() - 1].1]];
        for (&t, [i, m, k]) in self.triangles.iter().zip(halved(count)) {
            let corners = [i, m, k].map(|c| self.rim[c as usize].0);
            let shift = lowest_corner(corners);
            // The half-edge that leaves `i`, `m` or `k`.
            let leaves = |corner: u32| 3 * t + (corner + 3 - shift) % 3;
            surface.triangles[t as usize] = lowest_first(corners);
            let mut link = |h: u32, beyond: u32| {
                surface.twins[h as usize] = beyond;
                surface.twins[beyond as usize] = h;
            };
            if let Some([.., beyond]) = waiting.pop() {
                link(leaves(2), beyond);
            }
            for [from, to, h] in [[m, k, leaves(1)], [i, m, leaves(0)]] {
                if to - from > 1 {
                    waiting.push([from, to, h]);
                } else {
                    link(h, self.rim[from as usize].1);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_is_halved_over_all_its_edges() {
        for corners in 3..40 {
            let triangles: Vec<[u32; 3]> = halved(corners).collect();
            assert_eq!(triangles.len() as u32, corners - 2);
            let mut edges: Vec<[u32; 2]> =
                triangles.iter().flat_map(|&[i, m, k]| [[i, m], [m, k], [i, k]]).collect();
            assert!(triangles.iter().all(|[i, m, k]| i < m && m < k));
            edges.sort_unstable();
            let twice = edges.windows(2).filter(|pair| pair[0] == pair[1]).count() as u32;
            assert_eq!(twice, corners - 3, "chords have two triangles");
            edges.dedup();
            let is_outer = |e: &&[u32; 2]| e[1] - e[0] == 1 || **e == [0, corners - 1];
            assert_eq!(edges.iter().filter(is_outer).count() as u32, corners);
            let degree = |v: u32| edges.iter().filter(|e| e.contains(&v)).count() as u32;
            let most = (0..corners).map(degree).max().unwrap_or(0);
            assert!(most <= 2 * corners.ilog2() + 2, "{most} edges at a corner of {corners}");
        }
    }
}
