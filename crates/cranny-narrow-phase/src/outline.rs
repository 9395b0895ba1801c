//! What the curves of a region enclose.

use cranny_exact::DVec3;

use crate::intersection::Intersection;

/// Below this ratio of enclosed area to perimeter squared, curves enclose nothing (a peg through a
/// plate: the two rims cancel).
const ENCLOSES_NOTHING: f64 = 1e-6;

/// A region whose curves enclose at least this share of the area that they would if they were flat
/// has one normal; others are read direction by direction.
const FLAT: f64 = 0.9;

/// What closed curves enclose.
pub(crate) struct Outline {
    area_vector: DVec3,
    /// Sum of the areas of the triangles from a middle point to the segments, on either side.
    fan_area: f64,
    perimeter: f64,
}

impl Outline {
    /// By Stokes, the area vector of the first body's piece is that of its border; the piece's
    /// outward normals point from the first body into the second.
    pub(crate) fn of(intersection: &Intersection, segments: &[usize]) -> Self {
        let ends = |&s: &usize| intersection.segments[s].nodes.map(|n| intersection.nodes[n].point);
        let middle = segments.iter().map(|s| ends(s)[0]).sum::<DVec3>() / segments.len() as f64;
        let mut outline = Self { area_vector: DVec3::ZERO, fan_area: 0.0, perimeter: 0.0 };
        for s in segments {
            let [p, q] = ends(s);
            let part = 0.5 * (p - middle).cross(q - middle);
            outline.area_vector += part;
            outline.fan_area += part.length();
            outline.perimeter += (q - p).length();
        }
        outline
    }

    pub(crate) fn normal(&self) -> Option<DVec3> {
        let area = self.area_vector.length();
        (area > ENCLOSES_NOTHING * self.perimeter * self.perimeter).then(|| self.area_vector / area)
    }

    /// The area that the curves enclose, seen along a direction.
    pub(crate) fn area_along(&self, normal: DVec3) -> f64 {
        self.area_vector.dot(normal).abs()
    }

    pub(crate) fn is_flat(&self) -> bool {
        self.area_vector.length() >= FLAT * self.fan_area
    }
}
