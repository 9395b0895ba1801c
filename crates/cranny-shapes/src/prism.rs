//! Right prisms over polygons, and the exact triangulation of their ends.

use cranny_exact::{DVec2, Sign, orient2d};
use cranny_geometry::Mesh;

use crate::{
    builder::MeshBuilder,
    error::{Checked, ShapeError},
};

/// A prism along z. The region is given twice: by its boundary, for the sides, and cut into simple
/// polygons that share whole edges, for the ends.
pub(crate) struct Prism {
    pub(crate) points: Vec<DVec2>,
    /// Boundary loops: counter-clockwise outside, clockwise around holes.
    pub(crate) loops: Vec<Vec<u32>>,
    /// Counter-clockwise simple polygons that tile the region.
    pub(crate) pieces: Vec<Vec<u32>>,
}

impl Prism {
    /// A prism over one polygon without holes.
    pub(crate) fn simple(points: Vec<DVec2>) -> Self {
        let outline: Vec<u32> = (0..points.len() as u32).collect();
        Self { points, loops: vec![outline.clone()], pieces: vec![outline] }
    }

    /// From `z = -height / 2` to `z = height / 2`.
    pub(crate) fn build(self, checked: &Checked, height: f64) -> Result<Mesh, ShapeError> {
        let shape = checked.shape;
        let mut builder = MeshBuilder::default();
        for z in [-0.5 * height, 0.5 * height] {
            for p in &self.points {
                builder.vertex(p.extend(z));
            }
        }
        let top = self.points.len() as u32;
        for outline in &self.loops {
            for (k, &i) in outline.iter().enumerate() {
                let j = outline[(k + 1) % outline.len()];
                builder.quad(i, j, top + j, top + i);
            }
        }
        for piece in self.pieces {
            for [a, b, c] in clip_ears(&self.points, piece).ok_or(ShapeError::Outline { shape })? {
                builder.triangle(a, c, b);
                builder.triangle(top + a, top + b, top + c);
            }
        }
        builder.finish(shape)
    }
}

/// Triangulates a simple counter-clockwise polygon by clipping ears (Meisters, 1975), among them
/// always the one with the shortest diagonal. `None` where no ear is left: the polygon crosses
/// itself.
///
/// A corner is an ear only if its triangle is strictly counter-clockwise and no other corner lies
/// in the *closed* triangle. So collinear corners never give a triangle without area: the diagonal
/// meets no other corner, and what remains is again a simple polygon.
fn clip_ears(points: &[DVec2], mut polygon: Vec<u32>) -> Option<Vec<[u32; 3]>> {
    let mut triangles = Vec::with_capacity(polygon.len().saturating_sub(2));
    while polygon.len() > 3 {
        let n = polygon.len();
        let at = |k: usize| points[polygon[k % n] as usize];
        let diagonal = |k: &usize| at(k + n - 1).distance_squared(at(k + 1));
        let ear = (0..n)
            .filter(|&k| is_ear(points, &polygon, k))
            .min_by(|k, l| diagonal(k).total_cmp(&diagonal(l)))?;
        triangles.push(corners(&polygon, ear));
        polygon.remove(ear);
    }
    is_ear(points, &polygon, 1).then(|| triangles.push(corners(&polygon, 1)))?;
    Some(triangles)
}

/// A corner of the polygon between its neighbours.
fn corners(polygon: &[u32], k: usize) -> [u32; 3] {
    let n = polygon.len();
    [polygon[(k + n - 1) % n], polygon[k], polygon[(k + 1) % n]]
}

fn is_ear(points: &[DVec2], polygon: &[u32], k: usize) -> bool {
    let ids = corners(polygon, k);
    let [a, b, c] = ids.map(|i| points[i as usize]);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let inside = |p: DVec2| {
        // The box first, by comparisons, which are exact and cheap.
        low.cmple(p).all()
            && p.cmple(high).all()
            && [(a, b), (b, c), (c, a)].iter().all(|&(s, t)| orient2d(s, t, p) != Sign::Negative)
    };
    orient2d(a, b, c) == Sign::Positive
        && !polygon.iter().any(|i| !ids.contains(i) && inside(points[*i as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[DVec2], [a, b, c]: [u32; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
        0.5 * (b - a).perp_dot(c - a)
    }

    #[test]
    fn collinear_corners_give_no_flat_triangle() {
        let points = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 3), (1, 3), (0, 3)]
            .map(|(x, y)| DVec2::new(x.into(), y.into()));
        let triangles = clip_ears(&points, (0..7).collect()).unwrap();
        assert_eq!(triangles.len(), 5);
        assert!(triangles.iter().all(|&t| area(&points, t) > 0.0));
        assert_eq!(triangles.iter().map(|&t| area(&points, t)).sum::<f64>(), 9.0);
    }

    #[test]
    fn a_clockwise_or_crossing_polygon_is_refused() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert!(clip_ears(&square, vec![0, 1, 2, 3]).is_some());
        assert!(clip_ears(&square, vec![3, 2, 1, 0]).is_none());
        assert!(clip_ears(&square, vec![0, 2, 1, 3]).is_none());
    }
}
