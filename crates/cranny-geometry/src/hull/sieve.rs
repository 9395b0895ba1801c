//! Setting points aside that are certainly interior, before the hull is built.
//!
//! The hull of a small sample holds an ellipsoid; what lies strictly inside it lies strictly inside
//! the hull of all points, and no test of a triangle is spent on it (in the spirit of Akl and Toussaint
//! 1978). Of a full body's points few remain; of a surface's, all, at the cost of the sample's hull.
//!
//! # Why it is certain
//!
//! Coordinates are scaled by the extents `w` of the box of all points; `q = (p − c) / w`. Take a
//! triangle of the sample's hull, its exact normal `N`, the rounded one `n`, and `β` the bound of
//! [`Side`], which covers both the rounding of the determinant at `c` and `Σ |N − n| w`. With `h` the
//! computed determinant at `c`, the exact one at `p` is at most
//! `h + β + |N ∘ w| |q| <= h + β + (|n ∘ w| + β) |q|`, which is negative while `|q| < ρ`, the least of
//! `(−h − β) / (|n ∘ w| + β)` over all triangles. What `ρ` and `|q|` themselves lose to rounding,
//! [`SHRINK`] covers.

use cranny_exact::{Aabb, DVec3};

use super::quickhull::{self, Surface};
use super::side::Side;
use super::span::{Span, span_of};

/// Every so-manieth point makes the sample: about what the hull of a surface's points pays in vain.
/// Smaller, and surfaces pay more; larger, and more inner points are left. A prime, so that rows of a
/// grid do not come into step with it.
const STRIDE: usize = 17;

/// Fewer points than these are not sieved: their sample would hold next to nothing.
const LEAST: usize = 256;

/// What is taken off the squared radius: the dozen or so roundings of computing it and of measuring
/// against it, with room. Smaller, and the proof above fails; larger, and a few more points are left.
const SHRINK: f64 = 64.0 * f64::EPSILON;

/// Least radius, in extents, that is worth a pass over the points; far above what underflow of a square
/// could falsify.
const WORTHWHILE: f64 = 0.125;

/// Indices of the points that are not certainly interior, ascending; `None` where all should be kept.
pub(super) fn outer_points(points: &[DVec3]) -> Option<Vec<u32>> {
    if points.len() < LEAST {
        return None;
    }
    let sample: Vec<DVec3> = points.iter().step_by(STRIDE).copied().collect();
    let Span::Space(simplex) = span_of(&sample) else { return None };
    let (surface, _) = quickhull::triangulate(&sample, simplex);
    let inner = Ellipsoid::within(&sample, &surface, Aabb::of_points(points.iter().copied()))?;
    let kept: Vec<u32> =
        (0..points.len() as u32).filter(|&i| !inner.holds(points[i as usize])).collect();
    (kept.len() < points.len()).then_some(kept)
}

/// An ellipsoid with axes along the coordinates.
struct Ellipsoid {
    centre: DVec3,
    /// Reciprocal extents of the box of all points.
    scale: DVec3,
    /// In extents.
    radius_squared: f64,
}

impl Ellipsoid {
    /// The largest about the mean of the vertices of a hull; `None` if it is small. `bounds` is the box
    /// of all points to be asked about, the hull's own among them.
    fn within(positions: &[DVec3], surface: &Surface, bounds: Aabb) -> Option<Self> {
        let extent = bounds.max - bounds.min;
        let corners = || surface.triangles.iter().flatten().map(|&v| positions[v as usize]);
        let sum: DVec3 = corners().map(|p| p - bounds.min).sum();
        let mean = bounds.min + sum / (3 * surface.triangles.len()) as f64;
        let centre = mean.clamp(bounds.min, bounds.max);
        let radius = surface.triangles.iter().fold(f64::INFINITY, |least, triangle| {
            let side = Side::new(triangle.map(|v| positions[v as usize]), extent);
            let below = -side.height(centre) - side.margin();
            least.min(below / (length(side.normal * extent) + side.margin()))
        });
        (radius >= WORTHWHILE && radius.is_finite()).then(|| Self {
            centre,
            scale: extent.recip(),
            radius_squared: radius * radius * (1.0 - SHRINK),
        })
    }

    /// Whether a point of the box lies strictly inside.
    fn holds(&self, p: DVec3) -> bool {
        ((p - self.centre) * self.scale).length_squared() < self.radius_squared
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
    fn the_ellipsoid_of_a_cube_touches_its_sides() {
        let corners: Vec<DVec3> = lattice(1).into_iter().filter(|p| p.abs() == DVec3::ONE).collect();
        let Span::Space(simplex) = span_of(&corners) else { unreachable!("a cube is a solid") };
        let (surface, _) = quickhull::triangulate(&corners, simplex);
        let bounds = Aabb::of_points(corners.iter().copied());
        let inner = Ellipsoid::within(&corners, &surface, bounds).expect("a cube is round enough");
        // Triangles count their corners unevenly: the centre may lie off the middle.
        let reach = inner.radius_squared.sqrt() * 2.0;
        let room = 1.0 - inner.centre.abs().max_element();
        assert!((reach / room - 1.0).abs() < 1e-12, "{reach} of {room}");
        assert!(!inner.holds(DVec3::X) && inner.holds(inner.centre));
    }

    #[test]
    fn flat_samples_and_small_sets_are_kept_whole() {
        assert_eq!(outer_points(&lattice(2)), None);
        let sheet: Vec<DVec3> = lattice(6).into_iter().map(|p| DVec3::new(p.x, p.y, 0.0)).collect();
        assert_eq!(outer_points(&sheet), None);
    }
}
