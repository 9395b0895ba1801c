//! Certified bounds of a separation, from a direction and from witness points.
//!
//! For any direction `d` the least height of the second hull along `d`, less the greatest height of
//! the first, divided by `|d|`, is at most the distance. The heights are read where a feature pair
//! says that they are attained, and *proved* there:
//!
//! - at vertices: what lies above any plane hangs together over the edges of a convex polytope (the
//!   simplex method's argument). So where a set of vertices that hangs together is higher than all
//!   its neighbours, by more than rounding, its highest vertex is the highest of all;
//! - at a facet: its supporting plane is stored, rounded outward;
//! - where rounding leaves that open:
//!   [`ConvexHull::support`](cranny_geometry::ConvexHull::support).
//!
//! Nothing is assumed of the walk that found the pair. A wrong pair makes a wide interval, not a
//! wrong one.

use cranny_exact::DVec3;
use cranny_geometry::hull::{FacetId, HullVertexId};

use super::graph::HullFeature;
use super::nearest::{Witnesses, second_choice, witnesses};
use super::sides::Sides;

/// Twice the rounding of a height, relative to direction and reach: a height takes three products
/// and two sums, each within `3 u` of the sum of magnitudes; two of them, and the computing of the
/// bound. Smaller, and the argument of the head fails; larger, and supports are searched more
/// often.
const TWO_HEIGHTS: f64 = 4.0 * f64::EPSILON;

/// How much of a direction may lie across a facet's normal for its plane to serve, relative. Such a
/// rest is paid for with the whole reach of the hull, so it must be rounding.
const ALIGNED: f64 = 16.0 * f64::EPSILON;

/// How hard to try where a pair turns out not to hold the supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Give up: the pair is last frame's, and the walk will find a better one.
    Glance,
    /// Search the supports: a bound is wanted, if a wide one.
    Thorough,
}

/// Whether a height is the greatest.
enum Peak {
    Proved(f64),
    /// A neighbour is higher, rounding and all.
    Refuted,
    /// A neighbour is as high, as far as f64 can say.
    Open,
}

/// Bounds of the separation of two hulls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Certificate {
    /// The hulls are at least this far apart along `normal`; not positive where that does not show.
    pub(super) lo: f64,
    /// They are at most this far apart.
    pub(super) hi: f64,
    /// From the first to the second, of length 1, in the first's frame.
    pub(super) normal: DVec3,
    /// In the first's frame.
    pub(super) points: [DVec3; 2],
    pub(super) pair: [HullFeature; 2],
}

impl Certificate {
    /// Whether the bounds meet as closely as arithmetic allows, and say that the hulls are apart.
    pub(super) fn parts(&self, sides: &Sides) -> bool {
        self.lo > 0.0 && self.hi - self.lo <= sides.resolution()
    }

    /// Whether zero lies within the bounds and these meet: only exact predicates can decide then.
    pub(super) fn straddles(&self, sides: &Sides) -> bool {
        self.lo <= 0.0
            && self.hi <= sides.resolution()
            && self.hi - self.lo <= 2.0 * sides.resolution()
    }
}

/// Bounds read at a feature pair. `None` where the pair has no nearest points within the features,
/// or at a glance where it does not hold the supports.
#[inline]
pub(super) fn certify(
    sides: &Sides,
    pair: [HullFeature; 2],
    effort: Effort,
) -> Option<Certificate> {
    let found = witnesses(sides, pair)?;
    let Witnesses { points, direction, slack } = found;
    let hi = (points[1] - points[0]).length() + slack + sides.rounding;
    let mut best = (bound_along(sides, direction, pair, effort)?, direction);
    if best.0 < hi - sides.resolution()
        && let Some(other) = second_choice(sides, pair, &found)
        && let Some(lo) = lower_bound(sides, other, pair).filter(|&lo| lo > best.0)
    {
        best = (lo, other);
    }
    let (lo, direction) = best;
    Some(Certificate { lo, hi, normal: direction * (1.0 / direction.length()), points, pair })
}

/// A number that the separation is not below, along a direction of the first's frame (of any
/// length). `hints` say where the supports are expected. `None` for a direction without length.
pub(super) fn lower_bound(sides: &Sides, direction: DVec3, hints: [HullFeature; 2]) -> Option<f64> {
    bound_along(sides, direction, hints, Effort::Thorough)
}

#[inline]
fn bound_along(
    sides: &Sides,
    direction: DVec3,
    hints: [HullFeature; 2],
    effort: Effort,
) -> Option<f64> {
    let length = direction.length();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    let turned = -sides.second_direction(direction);
    let first = height(sides, 0, direction, length, hints[0], effort)?;
    let second = height(sides, 1, turned, length, hints[1], effort)?;
    let gap = direction.dot(sides.from[0].translation) - second - first;
    Some(gap / length - sides.rounding)
}

/// The greatest height of a hull along a direction of its own frame, up to the rounding that
/// [`Sides::rounding`] accounts for. `None` where a glance shows that it is not at the hint.
#[inline]
fn height(
    sides: &Sides,
    side: usize,
    direction: DVec3,
    length: f64,
    hint: HullFeature,
    effort: Effort,
) -> Option<f64> {
    let graph = sides.graph(side);
    let slack = TWO_HEIGHTS * length * graph.reach;
    let peak = match hint {
        HullFeature::Vertex(v) => peak(sides, side, direction, slack, [v, v]),
        HullFeature::Edge(e) => {
            let h = &graph.half_edges[e.index()];
            if h.is_exact { peak(sides, side, direction, slack, h.ends) } else { Peak::Open }
        }
        HullFeature::Facet(f) => below_plane(sides, side, direction, length, f),
    };
    match peak {
        Peak::Proved(height) => Some(height),
        Peak::Refuted if effort == Effort::Glance => None,
        Peak::Refuted | Peak::Open => {
            let top = sides.support(side, direction, Some(sides.corner_of(side, hint)));
            Some(direction.dot(sides.hulls[side].hull.position(top)))
        }
    }
}

/// The height of the higher of two adjacent vertices (or of one), if all their other neighbours are
/// lower than both. Two vertices must be neighbours on the exact hull.
#[inline]
fn peak(sides: &Sides, side: usize, direction: DVec3, slack: f64, set: [HullVertexId; 2]) -> Peak {
    let graph = sides.graph(side);
    let [a, b] = set.map(|v| direction.dot(sides.hulls[side].hull.position(v)));
    let floor = a.min(b) - slack;
    let highest_around = |v: HullVertexId| {
        let outside = |(w, p): &(HullVertexId, DVec3)| {
            if *w == set[0] || *w == set[1] { f64::NEG_INFINITY } else { direction.dot(*p) }
        };
        graph
            .rim(v)
            .iter()
            .map(outside)
            .fold(f64::NEG_INFINITY, |most, h| if h > most { h } else { most })
    };
    let mut around = highest_around(set[0]);
    if set[0] != set[1] {
        around = around.max(highest_around(set[1]));
    }
    if around < floor {
        Peak::Proved(a.max(b))
    } else if around > a.max(b) + slack {
        Peak::Refuted
    } else {
        Peak::Open
    }
}

/// A facet's supporting plane, for a direction that is its normal to rounding.
#[inline]
fn below_plane(sides: &Sides, side: usize, direction: DVec3, length: f64, facet: FacetId) -> Peak {
    let graph = sides.graph(side);
    let plane = &graph.facets[facet.index()];
    let along = direction.dot(plane.normal);
    let across = (direction - along * plane.normal).length();
    if along > 0.0 && across <= ALIGNED * length {
        Peak::Proved(along * plane.offset + across * graph.reach)
    } else {
        Peak::Open
    }
}
