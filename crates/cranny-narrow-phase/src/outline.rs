//! What the curves of a region of overlap enclose, and the direction that follows from it.

use cranny_exact::DVec3;

use crate::answer::Contact;
use crate::depth::{MeasuredRegion, deepest_along};
use crate::intersection::Intersection;
use crate::pair::{Pair, Side};
use crate::pieces::RegionPieces;

/// Below this ratio of enclosed area to perimeter squared, curves enclose nothing (a peg through a
/// plate: the two rims cancel).
const ENCLOSES_NOTHING: f64 = 1e-6;

/// A region whose curves enclose at least this share of the area that they would if they were flat
/// has one normal; others are read direction by direction.
const FLAT: f64 = 0.9;

/// The cosine of how far from a direction a face may look that stops what comes along it: 60
/// degrees.
const LOOKS_ALONG: f64 = 0.5;

/// Faces of a curved region whose normals are tried as its direction, at most, a side; of more,
/// these are evenly spread. More: the least depth is found more often; fewer: regions of thousands
/// of faces take less time.
const MAX_DIRECTIONS: usize = 64;

/// The cosine of how nearly square to a direction a face is that counts as steep: 78 degrees.
const STEEP: f64 = 0.2;

/// The cosine of how nearly opposite to each other two faces are that a hair of overlap lies
/// between: 25 degrees off.
const OPPOSITE: f64 = 0.9;

/// Whether sides of the two bodies face each other in a region, square to a direction. What overlaps
/// there by a hair reaches along the direction as far as the sides do: no body has dug in so deep.
pub(crate) fn sides_meet(pair: &Pair, region: &MeasuredRegion, normal: DVec3) -> bool {
    let [first, second] = Side::BOTH.map(|side| {
        let faces = region.cut.pieces[side.index()].faces.iter();
        let normals = faces.map(|&face| pair.normal(side, face));
        normals.filter(|n| n.dot(normal).abs() < STEEP).collect::<Vec<_>>()
    });
    first.iter().any(|n| second.iter().any(|m| n.dot(*m) < -OPPOSITE))
}

/// A contact of depth 0 at the first point of a region's curves.
pub(crate) fn on_curve(
    intersection: &Intersection,
    pieces: &RegionPieces,
    normal: DVec3,
) -> Contact {
    let first = &intersection.segments[pieces.segments[0]];
    let node = &intersection.nodes[first.nodes[0]];
    Contact { id: node.features, point_a: node.point, point_b: node.point, normal, separation: 0.0 }
}

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

    /// The normal, or where the curves name none, the direction of the least depth.
    pub(crate) fn direction(&self, pair: &Pair, region: &MeasuredRegion) -> DVec3 {
        self.normal().unwrap_or_else(|| least_deep_direction(pair, region))
    }

    /// The area that the curves enclose, seen along a direction.
    pub(crate) fn area_along(&self, normal: DVec3) -> f64 {
        self.area_vector.dot(normal).abs()
    }

    pub(crate) fn is_flat(&self) -> bool {
        self.area_vector.length() >= FLAT * self.fan_area
    }
}

/// Where the curves name no direction: of the pieces' own face normals, and the line between the
/// bodies, the one along which the least translation parts them.
fn least_deep_direction(pair: &Pair, region: &MeasuredRegion) -> DVec3 {
    let centers = pair.bounds(Side::Second).center() - pair.bounds(Side::First).center();
    let mut candidates: Vec<DVec3> = vec![centers.try_normalize().unwrap_or(DVec3::Z)];
    for side in Side::BOTH {
        let sign = if side == Side::First { 1.0 } else { -1.0 };
        let mut faces = region.cut.pieces[side.index()].faces.clone();
        faces.sort_unstable();
        let stride = faces.len().div_ceil(MAX_DIRECTIONS).max(1);
        for &f in faces.iter().step_by(stride) {
            let n = sign * pair.normal(side, f);
            if n != DVec3::ZERO && candidates.iter().all(|c| c.dot(n) < FLAT) {
                candidates.push(n);
            }
        }
    }
    // Rays do not measure a piece along a direction that none of its faces looks along.
    if candidates.iter().any(|&n| face_each_other(pair, region, n)) {
        candidates.retain(|&n| face_each_other(pair, region, n));
    }
    let mut best = (f64::INFINITY, candidates[0]);
    for n in candidates {
        if let Some(deepest) = deepest_along(region, n, best.0)
            && -deepest.separation < best.0
        {
            best = (-deepest.separation, n);
        }
    }
    best.1
}

/// Whether some face of the first body's piece looks along `n`, and some of the second's against
/// it, within 60 degrees.
fn face_each_other(pair: &Pair, region: &MeasuredRegion, n: DVec3) -> bool {
    Side::BOTH.iter().zip([1.0, -1.0]).all(|(&side, sign)| {
        let faces = &region.cut.pieces[side.index()].faces;
        faces.iter().any(|&f| sign * pair.normal(side, f).dot(n) >= LOOKS_ALONG)
    })
}
