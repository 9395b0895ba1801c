//! Setting points aside that are certainly interior, before the hull is built.
//!
//! All directions from the mean are cut into cells. The farthest points of the cells span a
//! polytope, it holds an ellipsoid, and what lies strictly inside that lies strictly inside the
//! hull: no test of a triangle is spent on it (in the spirit of Akl and Toussaint 1978). Of a full
//! body's points few remain. Of a surface's all do, which is noticed before the polytope is built.
//!
//! # Why it is certain
//!
//! Coordinates are scaled by the extents `w` of the box of all points; `q = (p − c) / w`. Take a
//! triangle of the polytope, its exact normal `N`, the rounded one `n`, and `β` the bound of
//! [`Side`], which covers both the rounding of the determinant at `c` and `Σ |N − n| w`. With `h`
//! the computed determinant at `c`, the exact one at `p` is at most
//! `h + β + |N ∘ w| |q| <= h + β + (|n ∘ w| + β) |q|`, which is negative while `|q| < ρ`, the least
//! of `(−h − β) / (|n ∘ w| + β)` over all triangles. What `ρ` and `|q|` themselves lose to
//! rounding, [`SHRINK`] covers.
//!
//! # Cost
//!
//! O(n), and the hull of about n / [`CROWD`] points.

use cranny_exact::{Aabb, DVec3};

use super::quickhull::{self, HullSurface};
use super::side::Side;
use super::span::{Span, span_of};

/// Points a cell, about. Smaller, and the polytope costs more than it saves; larger, and it is so
/// coarse that more inner points are left.
const CROWD: usize = 32;

/// Fewer points than these are not sieved. Smaller, and the polytope of a ball of 1,000 points
/// costs more than it saves; larger, and one of 3,000 points is built more slowly than with it.
const LEAST: usize = 2048;

/// What is taken off the squared radius: the dozen or so roundings of computing it and of measuring
/// against it, with room. Smaller, and the proof above fails; larger, and a few more points are
/// left.
const SHRINK: f64 = 64.0 * f64::EPSILON;

/// Least radius, in extents, that is worth a pass over the points; far above what underflow of a
/// square could falsify.
const WORTHWHILE: f64 = 0.125;

/// A point whose squared distance from the middle is this share of that of every cell's farthest
/// point is likely to fall through the sieve. Larger, and roundings of a sphere count as depth;
/// smaller, and thick shells are not sieved.
const DEEP: f64 = 0.75;

/// Indices of the points that are not certainly interior, ascending; `None` where all should be
/// kept. O(n), and the hull of n / [`CROWD`] points.
pub(super) fn outer_points(points: &[DVec3]) -> Option<Vec<u32>> {
    if points.len() < LEAST {
        return None;
    }
    let frame = CloudFrame::of(points);
    let champions = frame.champions(points)?;
    let polytope: Vec<DVec3> = champions.iter().map(|&i| points[i as usize]).collect();
    let Span::Space(simplex) = span_of(&polytope) else { return None };
    let (surface, _) = quickhull::of_all(&polytope, simplex);
    let radius = frame.radius_within(&polytope, &surface);
    if !(WORTHWHILE..1.0).contains(&radius) {
        return None;
    }
    let limit = radius * radius * (1.0 - SHRINK);
    let is_inner = |i: u32| frame.scaled(points[i as usize]).length_squared() < limit;
    Some((0..points.len() as u32).filter(|&i| !is_inner(i)).collect())
}

/// The mean of the points, and the extents of their box.
struct CloudFrame {
    bounds: Aabb,
    centre: DVec3,
    /// Reciprocal extents.
    scale: DVec3,
}

impl CloudFrame {
    fn of(points: &[DVec3]) -> Self {
        let bounds = Aabb::of_points(points.iter().copied());
        let mean = points.iter().sum::<DVec3>() / points.len() as f64;
        let centre = mean.clamp(bounds.min, bounds.max);
        Self { bounds, centre, scale: (bounds.max - bounds.min).recip() }
    }

    /// `q` of the proof above.
    fn scaled(&self, p: DVec3) -> DVec3 {
        (p - self.centre) * self.scale
    }

    /// The farthest point of each cell; `None` where too few points lie farther in than all of
    /// these to be worth more work. Cells are the squares of a grid on each side of a cube.
    fn champions(&self, points: &[DVec3]) -> Option<Vec<u32>> {
        let side = ((points.len() / (6 * CROWD)) as f64).sqrt().ceil();
        let row = side as usize;
        let mut cells = vec![(0.0f64, 0u32); 6 * row * row];
        let mut distances = Vec::with_capacity(points.len());
        for (i, &p) in (0u32..).zip(points) {
            let q = self.scaled(p);
            let distance = q.length_squared();
            distances.push(distance);
            let a = q.abs();
            let (face, u, v, w) = if a.x >= a.y && a.x >= a.z {
                (0, q.y, q.z, q.x)
            } else if a.y >= a.z {
                (1, q.z, q.x, q.y)
            } else {
                (2, q.x, q.y, q.z)
            };
            // In the middle itself 0 / 0 becomes cell 0: any will do.
            let half = 0.5 * side / w.abs();
            let step = |x: f64| ((x * half + 0.5 * side) as usize).min(row - 1);
            let cell =
                &mut cells[((2 * face + usize::from(w < 0.0)) * row + step(u)) * row + step(v)];
            if distance > cell.0 {
                *cell = (distance, i);
            }
        }
        cells.retain(|cell| cell.0 > 0.0);
        let nearest = cells.iter().fold(f64::INFINITY, |least, cell| least.min(cell.0));
        let inner = distances.into_iter().filter(|&d| d < DEEP * nearest).count();
        (inner > points.len() / 8).then(|| cells.into_iter().map(|(_, i)| i).collect())
    }

    /// `ρ` of the proof above. May be negative, infinite or `NaN`, which all mean nothing.
    fn radius_within(&self, positions: &[DVec3], surface: &HullSurface) -> f64 {
        let extent = self.bounds.max - self.bounds.min;
        surface.triangles.iter().fold(f64::INFINITY, |least, triangle| {
            let side = Side::new(triangle.map(|v| positions[v as usize]), extent);
            let below = -side.height(self.centre) - side.margin();
            least.min(below / (length(side.normal * extent) + side.margin()))
        })
    }
}

/// The length of a vector whose squares might underflow.
fn length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if largest > 0.0 { largest * (v / largest).length() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(n: i32) -> Vec<DVec3> {
        let range = move || -n..=n;
        range()
            .flat_map(|x| range().flat_map(move |y| range().map(move |z| (x, y, z))))
            .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
            .collect()
    }

    #[test]
    fn a_full_lattice_loses_its_middle_and_keeps_its_sides() {
        for scale in [1.0, 2f64.powi(-190), 2f64.powi(100)] {
            let points: Vec<DVec3> = lattice(6).into_iter().map(|p| p * scale).collect();
            let kept = outer_points(&points).expect("a full body");
            assert!(kept.len() < points.len() * 5 / 6, "{} of {}", kept.len(), points.len());
            for (i, p) in points.iter().enumerate() {
                let is_kept = kept.binary_search(&(i as u32)).is_ok();
                assert!(is_kept || p.abs().max_element() < 6.0 * scale);
            }
            assert!(kept.binary_search(&(points.len() as u32 / 2)).is_err(), "the middle");
        }
    }

    #[test]
    fn the_ellipsoid_of_a_box_touches_its_sides() {
        let corners: Vec<DVec3> = lattice(1)
            .into_iter()
            .filter(|p| p.abs() == DVec3::ONE)
            .map(|p| p * DVec3::new(1.0, 4.0, 16.0))
            .collect();
        let Span::Space(simplex) = span_of(&corners) else { unreachable!("a box is a solid") };
        let (surface, _) = quickhull::of_all(&corners, simplex);
        let radius = CloudFrame::of(&corners).radius_within(&corners, &surface);
        assert!(radius <= 0.5 && radius > 0.5 - 1e-14, "{radius}");
    }

    #[test]
    fn points_next_to_the_surface_are_kept() {
        // Directions all around, each with a point on the sphere and one just below it.
        let mut points = Vec::new();
        for p in lattice(6).into_iter().filter(|p| p.length_squared() > 0.0) {
            points.extend([p.normalize(), p.normalize() * 0.999, p * 0.01]);
        }
        let kept = outer_points(&points).expect("a full body");
        let inner = (0..points.len() as u32).filter(|i| kept.binary_search(i).is_err());
        let most = inner.map(|i| points[i as usize].length()).fold(0.0, f64::max);
        assert!(most > 0.1 && most < 0.999, "{most}");
        assert!(kept.len() <= 2 * points.len() / 3 + 1);
    }

    #[test]
    fn surfaces_flat_and_small_sets_are_kept_whole() {
        let sphere: Vec<DVec3> = lattice(6).into_iter().filter_map(|p| p.try_normalize()).collect();
        assert_eq!(outer_points(&sphere), None);
        assert_eq!(outer_points(&lattice(2)), None);
        let sheet: Vec<DVec3> = lattice(6).into_iter().map(|p| DVec3::new(p.x, p.y, 0.0)).collect();
        assert_eq!(outer_points(&sheet), None);
    }
}
