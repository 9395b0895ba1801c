//! How deep: an upper bound of the penetration depth and the features that meet there.
//!
//! Any direction bounds the depth: moved by the overlap of the two supports along it, the hulls are
//! apart. From last frame's direction the bound goes down by *moving apart and walking*: the second
//! hull is shifted along the direction until the hulls are apart, the exterior walk finds the
//! closest features there, and the direction between these is the next one. A direction that
//! returns itself is a local minimum: its features, a vertex and a facet or two edges, are faces of
//! the set of differences that have the origin straight below. Nothing says that there is no lower
//! minimum elsewhere.

use cranny_exact::DVec3;

use super::certificate::{Effort, certify, lower_bound};
use super::graph::HullFeature;
use super::observer::{Trail, WalkObserver};
use super::sides::Sides;
use super::voronoi::{End, walk};

/// By how much, relative to the overlap, the hulls are moved further than apart. Smaller, and the
/// walk meets hulls that touch to rounding; larger, and directions turn less at each round.
const CLEARANCE: f64 = 0.25;

/// Where two overlapping hulls are to be parted.
pub(super) struct Parting {
    /// The hulls are apart after a translation of this length along `normal`.
    pub(super) depth: f64,
    pub(super) normal: DVec3,
    /// Deepest points, each on its hull, in the first's frame.
    pub(super) points: [DVec3; 2],
    pub(super) pair: [HullFeature; 2],
}

/// The local minimum reached from a direction (of length 1) and the pair expected there. Ends since
/// the bound falls by more than rounding each round, among finitely many features.
pub(super) fn parting(
    sides: &Sides,
    start: DVec3,
    hints: [HullFeature; 2],
    trail: &mut Trail<impl WalkObserver>,
) -> Option<Parting> {
    let mut normal = start;
    let mut pair = hints;
    let mut depth = -lower_bound(sides, normal, pair)?;
    loop {
        let shift = ((1.0 + CLEARANCE) * depth.max(0.0) + 8.0 * sides.resolution()) * normal;
        let apart = sides.moved(shift);
        trail.shift = shift;
        let reached = certify(&apart, pair, Effort::Glance).filter(|c| c.parts(&apart)).or_else(
            || match walk(&apart, pair, trail) {
                End::Closest(pair) | End::Cycle(pair) => certify(&apart, pair, Effort::Thorough),
                End::Inside(_) => None,
            },
        );
        let Some(reached) = reached else {
            let points = [0, 1].map(|i| sides.vertex_in(0, i, sides.corner_of(i, pair[i])));
            return Some(Parting { depth, normal, points, pair });
        };
        let points = [reached.points[0], reached.points[1] - shift];
        pair = reached.pair;
        let next = -lower_bound(sides, reached.normal, pair)?;
        if next >= depth - sides.rounding {
            return Some(Parting { depth, normal, points, pair });
        }
        (depth, normal) = (next, reached.normal);
    }
}
