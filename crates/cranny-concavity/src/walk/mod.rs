//! Hull against hull: closest features, followed from frame to frame.
//!
//! # The story
//!
//! [`walk_hulls`] starts from last frame's feature pair ([`WalkState`], owned by the caller).
//! Mostly the pair is still the closest, and `certificate` proves it in constant time: a direction
//! along which the supports are apart, and two witness points as far apart as that. If not,
//! `voronoi` walks over exterior Voronoi regions to the pair that is (Lin and Canny 1991, Mirtich
//! 1998), and the same certificate judges where it ended. Where the hulls overlap, the walk goes on
//! inside: `portal` finds the pseudo-internal region of the *pair* that holds the origin, with a
//! proof of overlap that the next frame repeats in constant time, and `depth` the features where
//! the hulls are to be parted. What rounding leaves open is decided by `exhaustive`, on exact
//! predicates, and counted.
//!
//! # Promises
//!
//! - [`HullAnswer::separation`] holds the signed separation, whatever the state handed in: its ends
//!   are proved, with the thickness of merged facets and all rounding accounted for. Proofs do not
//!   rely on the walk.
//! - `Separated` and `Penetrating` are certain: for the exact hulls, and for the second's vertices
//!   posed by [`RigidMap::apply`] and rounded. Where the two sets differ (a few units in the last
//!   place about touching) the exact predicates judge the rounded ones.
//! - Every walk ends: it finds a pair that is closest, reaches inside, or returns to a pair.
//!
//! # Non-promises
//!
//! - The depth is bounded above by a *local* minimum; below only by a ball that was shown to be in
//!   the overlap, usually a small one.
//! - Of features that are equally near, any may be named; it may depend on history.
//!
//! ```
//! use cranny_exact::{DVec3, RigidMap};
//! use cranny_geometry::ConvexHull;
//! use cranny_concavity::walk::{FeatureGraph, Relation, WalkCounters, WalkHull, WalkState, walk_hulls};
//!
//! let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
//! let hull = ConvexHull::of_points(&(0..8).map(corner).collect::<Vec<_>>());
//! let graph = FeatureGraph::new(&hull)?;
//! let cube = WalkHull { hull: &hull, graph: &graph };
//!
//! let (mut state, mut counters) = (WalkState::default(), WalkCounters::default());
//! let beside = RigidMap { translation: DVec3::new(1.5, 0.25, 0.25), ..RigidMap::IDENTITY };
//! let answer = walk_hulls(cube, cube, &beside, &mut state, &mut counters)?;
//! assert_eq!(answer.relation, Relation::Separated);
//! assert!(answer.separation.contains(0.5) && answer.separation.width() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod certificate;
mod depth;
mod exhaustive;
mod graph;
mod nearest;
mod observer;
mod portal;
mod sides;
mod voronoi;

use cranny_exact::{DVec3, Interval, Meeting, RigidMap};
use cranny_geometry::hull::HullVertexId;
use thiserror::Error;

use certificate::{Certificate, Effort, certify, lower_bound};
use exhaustive::exhaust;
pub use graph::{FeatureGraph, GraphError, HullEdgeId, HullFeature};
use observer::Trail;
pub use observer::WalkObserver;
use portal::{Portal, Search};
use sides::Sides;
pub use sides::WalkHull;
use voronoi::{End, walk};

/// Why hulls could not be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WalkError {
    /// The motion has a coordinate that is `NaN` or infinite.
    #[error("the motion between the two frames is not finite: check the poses it was made from")]
    NotFinite,
}

/// What is remembered of a pair from frame to frame. Saves time only; what it says is never
/// believed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WalkState {
    pair: Option<[HullFeature; 2]>,
    /// Direction that last parted the hulls, in the first's frame; zero if none did.
    axis: DVec3,
    portal: Option<Portal>,
}

impl WalkState {
    /// A walk that starts at a pair of features, whichever they are.
    #[must_use]
    pub fn starting_at(pair: [HullFeature; 2]) -> Self {
        Self { pair: Some(pair), ..Self::default() }
    }

    /// The pair that the next walk starts at.
    #[must_use]
    pub fn features(&self) -> Option<[HullFeature; 2]> {
        self.pair
    }
}

/// What was done, added up over calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkCounters {
    /// Calls of [`walk_hulls`].
    pub queries: u64,
    /// Calls answered by a proof on last frame's pair or portal alone.
    pub proved_at_once: u64,
    /// Feature pairs that the walk looked at.
    pub steps: u64,
    /// Walks that came back to a pair that they had left.
    pub cycles: u64,
    /// Searches for a pseudo-internal region from its beginning.
    pub searches: u64,
    /// Portals looked at in them.
    pub portals: u64,
    /// Calls that looked at all exact triangles: what rounding left open.
    pub exhausted: u64,
}

/// How two closed hulls lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Relation {
    /// They share no point.
    Separated,
    /// They share a point, but no interior point was shown to be common: surfaces touch, exactly.
    Touching,
    /// Their interiors meet; or, of hulls without an interior, the insides of two faces.
    Penetrating,
}

/// What is known of two hulls. Everything is in the first's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullAnswer {
    /// How they lie.
    pub relation: Relation,
    /// Holds the signed separation: the distance, or where the hulls overlap minus the penetration
    /// depth (the least translation that parts them). Narrow where they are separated: rounding and
    /// the thickness of facets. Where they overlap, its lower end stems from a local minimum.
    pub separation: Interval,
    /// From the first to the second, of length 1: along it the supports are apart by the lower end
    /// of `separation`. (A lower end of 0 may stem from exact predicates on triangles instead.)
    pub normal: DVec3,
    /// Nearest points, or deepest ones: on the first hull and on the second, to within rounding and
    /// the thickness of the facet named.
    pub points: [DVec3; 2],
    /// The features that hold them.
    pub features: [HullFeature; 2],
}

/// Compares two hulls, the second moved by `first_from_second` (a rotation to rounding and a
/// translation, as [`RigidMap::between`] makes them). Start from `WalkState::default()`, then hand
/// in what the last call left.
///
/// Constant time where the same features are still the closest; else as many steps as features were
/// passed. Allocates only where it is counted by [`WalkCounters::exhausted`].
///
/// # Errors
///
/// [`WalkError::NotFinite`].
pub fn walk_hulls(
    first: WalkHull,
    second: WalkHull,
    first_from_second: &RigidMap,
    state: &mut WalkState,
    counters: &mut WalkCounters,
) -> Result<HullAnswer, WalkError> {
    walk_hulls_observed(first, second, first_from_second, state, counters, &mut ())
}

/// The same, and shows an observer each state that it comes to.
///
/// # Errors
///
/// [`WalkError::NotFinite`].
pub fn walk_hulls_observed(
    first: WalkHull,
    second: WalkHull,
    first_from_second: &RigidMap,
    state: &mut WalkState,
    counters: &mut WalkCounters,
    observer: &mut impl WalkObserver,
) -> Result<HullAnswer, WalkError> {
    if !(first_from_second.linear.is_finite() && first_from_second.translation.is_finite()) {
        return Err(WalkError::NotFinite);
    }
    let sides = Sides::new([first, second], first_from_second);
    counters.queries += 1;
    let trail = Trail { counters, observer, shift: DVec3::ZERO };
    let mut query = Query { sides: &sides, state, trail };
    Ok(query.answer())
}

struct Query<'a, O> {
    sides: &'a Sides<'a>,
    state: &'a mut WalkState,
    trail: Trail<'a, O>,
}

impl<O: WalkObserver> Query<'_, O> {
    fn answer(&mut self) -> HullAnswer {
        if let Some(depth) = self.still_overlapping() {
            self.trail.counters.proved_at_once += 1;
            return self.penetrating(depth);
        }
        let start = self.start();
        self.trail.observer.kept_pair(start);
        if let Some(certificate) = certify(self.sides, start, Effort::Glance) {
            if certificate.parts(self.sides) {
                self.trail.counters.proved_at_once += 1;
                return self.separated(&certificate);
            }
            if certificate.straddles(self.sides) {
                return self.exhaustively(certificate.normal);
            }
        }
        if let Some(answer) = self.walked(start) {
            return answer;
        }
        self.trail.counters.searches += 1;
        match portal::search(self.sides, &mut self.trail) {
            Search::Overlap(portal, depth) => {
                self.state.portal = Some(portal);
                self.penetrating(depth)
            }
            Search::Apart(axis, pair) => {
                let start = pair.map(HullFeature::Vertex);
                self.walked(start).unwrap_or_else(|| self.exhaustively(axis))
            }
            Search::Boundary(axis) => self.exhaustively(axis),
        }
    }

    /// The depth of overlap that the inner balls or last frame's portal prove.
    fn still_overlapping(&mut self) -> Option<f64> {
        let portal = self.state.portal.as_ref()?;
        let known = |i: usize, v: HullVertexId| self.sides.graph(i).has(HullFeature::Vertex(v));
        if !portal.iter().all(|pair| known(0, pair[0]) && known(1, pair[1])) {
            return None;
        }
        let depth = portal::depth_of_balls(self.sides)
            .or_else(|| portal::proved_depth(self.sides, portal))?;
        self.trail.observer.kept_portal(*portal, depth);
        Some(depth)
    }

    /// Last frame's pair; without one, the supports along the line of centres.
    fn start(&self) -> [HullFeature; 2] {
        let known = |pair: &[HullFeature; 2]| (0..2).all(|i| self.sides.graph(i).has(pair[i]));
        self.state.pair.filter(known).unwrap_or_else(|| {
            let axis = self.line_of_centers();
            let first = self.sides.support(0, axis, None);
            let second = self.sides.support(1, -self.sides.second_direction(axis), None);
            [first, second].map(HullFeature::Vertex)
        })
    }

    fn line_of_centers(&self) -> DVec3 {
        self.sides.point_in(0, 1, self.sides.graph(1).center) - self.sides.graph(0).center
    }

    /// Walks. Returns an answer if a proof, or the exact predicates, decide at the pair where it
    /// ends.
    fn walked(&mut self, start: [HullFeature; 2]) -> Option<HullAnswer> {
        let pair = match walk(self.sides, start, &mut self.trail) {
            End::Closest(pair) => pair,
            End::Cycle(pair) => {
                self.trail.counters.cycles += 1;
                pair
            }
            End::Inside(_) => return None,
        };
        let certificate = certify(self.sides, pair, Effort::Thorough)?;
        if certificate.parts(self.sides) {
            return Some(self.separated(&certificate));
        }
        certificate.straddles(self.sides).then(|| self.exhaustively(certificate.normal))
    }

    fn separated(&mut self, certificate: &Certificate) -> HullAnswer {
        let Certificate { lo, hi, normal, points, pair } = *certificate;
        *self.state = WalkState { pair: Some(pair), axis: normal, portal: None };
        HullAnswer {
            relation: Relation::Separated,
            separation: Interval { lo, hi: hi.max(lo) },
            normal,
            points,
            features: pair,
        }
    }

    /// The hulls overlap at least so deep; how deep at most?
    fn penetrating(&mut self, depth: f64) -> HullAnswer {
        let axis = match self.state.axis {
            DVec3::ZERO => self.line_of_centers().normalize_or(DVec3::X),
            axis => axis,
        };
        let hints = self.start();
        let parting = depth::parting(self.sides, axis, hints, &mut self.trail);
        let (normal, points, pair, most) = match parting {
            Some(p) => (p.normal, p.points, p.pair, p.depth),
            None => (axis, [self.sides.graph(0).center; 2], hints, f64::INFINITY),
        };
        self.state.pair = Some(pair);
        self.state.axis = normal;
        HullAnswer {
            relation: Relation::Penetrating,
            separation: Interval { lo: -most.max(depth), hi: -depth },
            normal,
            points,
            features: pair,
        }
    }

    /// Judged by exact predicates on all triangles near a direction's supports.
    fn exhaustively(&mut self, axis: DVec3) -> HullAnswer {
        self.trail.exhausted(axis);
        let found = exhaust(self.sides, axis);
        self.state.portal = None;
        if found.meeting == Meeting::Cross {
            self.state.axis = axis.normalize_or_zero();
            return self.penetrating(0.0);
        }
        let [p, q] = found.points;
        let best = [
            certify(self.sides, found.pair, Effort::Thorough).map(|c| c.normal),
            Some(axis),
            Some(q - p),
        ]
        .into_iter()
        .flatten()
        .filter_map(|d| Some((lower_bound(self.sides, d, found.pair)?, d)))
        .reduce(|best, next| if next.0 > best.0 { next } else { best });
        let (lo, normal) = best.unwrap_or((f64::NEG_INFINITY, DVec3::X));
        let normal = normal.normalize_or(DVec3::X);
        let distance = (q - p).length() + self.sides.rounding;
        let (relation, separation) = match found.meeting {
            Meeting::None => {
                let lo = lo.max(0.0);
                (Relation::Separated, Interval { lo, hi: distance.max(lo) })
            }
            _ => (Relation::Touching, Interval { lo: lo.min(0.0), hi: 0.0 }),
        };
        *self.state = WalkState { pair: Some(found.pair), axis: normal, portal: None };
        HullAnswer { relation, separation, normal, points: [p, q], features: found.pair }
    }
}
