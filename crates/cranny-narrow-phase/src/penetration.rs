//! The direction along which a region of overlap parts, and how deep it is along it.

use cranny_exact::{DVec3, RigidMap};

use crate::answer::{Contact, Region};
use crate::depth::{MeasuredRegion, deepest_along};
use crate::intersection::{Intersection, intersect};
use crate::pair::{Pair, PosedVertices, Side};
use crate::pieces::{RegionPieces, cut};
use crate::special_position::{in_general_position, settled};
use crate::surface::FacePair;
use crate::tally::Tally;

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

/// How two bodies overlap in one region: the least that is needed to lead them out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Unit direction from A to B, world: that of the area that the curves enclose, or of the least
    /// depth where they enclose none. As [`Region::normal`].
    pub normal: DVec3,
    /// The deepest contact along it, world; its separation is below 0, or 0 on the curve.
    pub deepest: Contact,
}

impl Penetration {
    /// That of a region which has a depth: of one where closed solids overlap.
    #[must_use]
    pub fn of(region: &Region) -> Option<Self> {
        region.depth.map(|_| Self { normal: region.normal, deepest: region.deepest })
    }

    /// The same with the bodies' names exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self { normal: -self.normal, deepest: self.deepest.swapped() }
    }

    /// The same in another frame.
    #[must_use]
    pub fn moved(self, map: &RigidMap) -> Self {
        Self { normal: map.apply_vector(self.normal), deepest: self.deepest.moved(map) }
    }

    /// The least translation along the normal that parts the region, >= 0.
    #[must_use]
    pub fn depth(&self) -> f64 {
        -self.deepest.separation
    }
}

/// The overlaps of two closed solids, a region each. In world coordinates and the caller's order.
pub(crate) fn overlaps(
    pair: &Pair,
    posed: &mut PosedVertices,
    pairs: &[FacePair],
    counters: &mut impl Tally,
) -> Vec<Penetration> {
    let of_regions = |pair: &Pair, intersection: &Intersection| {
        let pieces = cut(pair, intersection);
        pieces.iter().map(|pieces| of_region(pair, intersection, pieces)).collect()
    };
    let here = intersect(pair, pairs);
    let depth = |found: &(DVec3, Contact)| -found.1.separation;
    let (found, _) = in_general_position(pair, posed, &here, counters, of_regions, depth);
    let finish = |(normal, deepest)| {
        let deepest = if here.generic { deepest } else { settled(pair, deepest) };
        Penetration { normal: pair.world_normal(normal), deepest: pair.world_contact(deepest) }
    };
    found.into_iter().map(finish).collect()
}

/// The direction of a region and its deepest contact along it, in the pair's frame.
fn of_region(pair: &Pair, intersection: &Intersection, pieces: &RegionPieces) -> (DVec3, Contact) {
    let region = MeasuredRegion::of(pair, intersection, pieces);
    let normal = Outline::of(intersection, &pieces.segments).direction(pair, &region);
    let deepest = deepest_along(&region, normal, f64::INFINITY);
    (normal, deepest.unwrap_or_else(|| on_curve(intersection, pieces, normal)))
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
