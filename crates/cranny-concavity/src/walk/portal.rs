//! The walk inside: pseudo-internal Voronoi regions of the pair, and the proof that hulls overlap.
//!
//! Two hulls overlap where the origin lies in the set of all differences `p − q` of their points (p
//! of the first, q of the second, both in the first's frame), a convex polytope whose features are
//! feature pairs. Its pseudo-internal regions are the cones from an interior point, the difference
//! of the centres, to its features. A *portal*, three of its vertices, each a support pair, is such
//! a region's base: the ray from the centre through the origin passes it. Portals are moved outward
//! until the origin lies before one (overlap), or beyond the supporting plane of the set (apart).
//! Portals were introduced by Snethen (2008); seeking and refining them is his method, the proofs
//! and the endings are not.
//!
//! The proof: about the centre the set holds the ball whose radius is the sum of the two hulls'
//! inner radii; with a point of the portal it holds their convex hull; and a ball about the origin
//! in that is the overlap, and a lower bound of its depth. It takes no support, so last frame's
//! portal is judged in constant time.

use cranny_exact::DVec3;
use cranny_geometry::hull::HullVertexId;

use super::observer::{Trail, WalkObserver};
use super::sides::Sides;

/// A vertex of the first hull and one of the second.
pub(super) type SupportPair = [HullVertexId; 2];

/// Three vertices of the set of differences.
pub(super) type Portal = [SupportPair; 3];

/// How the search ended.
#[derive(Clone, Copy, Debug)]
pub(super) enum Search {
    /// The hulls overlap, by at least this depth.
    Overlap(Portal, f64),
    /// A direction along which the supports, at this pair, are apart, as computed.
    Apart(DVec3, SupportPair),
    /// The origin lies on the boundary of the set, as nearly as f64 can say; about there a
    /// direction.
    Boundary(DVec3),
}

/// Depth by which a portal proves that the hulls overlap; `None` where it does not.
///
/// With `c` the centre, `r` the inner radius about it and `y` a point of the portal, write the
/// origin as `c + s (y − c) + e`, `0 <= s < 1`. The convex hull of ball and `y` holds the ball
/// about `c + s (y − c)` of radius `(1 − s) r`, hence the ball about the origin of radius
/// `(1 − s) r − |e|`. Every choice of `s` and `y` is valid; rounding can spoil the choice, not the
/// proof.
pub(super) fn proved_depth(sides: &Sides, portal: &Portal) -> Option<f64> {
    let radius = sides.graph(0).inner_radius + sides.graph(1).inner_radius;
    let center = center_of(sides);
    let spokes = portal.map(|pair| difference(sides, pair) - center);
    let weights = weights(spokes, -center);
    let share = weights.element_sum();
    let reached = weights.x * spokes[0] + weights.y * spokes[1] + weights.z * spokes[2];
    let depth = (1.0 - share) * radius - (reached + center).length();
    // Center, portal and arithmetic are each within `rounding` of points of the exact set.
    let depth = depth - 3.0 * sides.rounding;
    (depth > 0.0 && share < 1.0).then_some(depth)
}

/// The depth of overlap that the inner balls alone prove.
pub(super) fn depth_of_balls(sides: &Sides) -> Option<f64> {
    let radius = sides.graph(0).inner_radius + sides.graph(1).inner_radius;
    let depth = radius - center_of(sides).length() - 3.0 * sides.rounding;
    (depth > 0.0).then_some(depth)
}

/// Non-negative weights of the spokes whose weighted sum is `target`, or near it.
fn weights([a, b, c]: [DVec3; 3], target: DVec3) -> DVec3 {
    let normal = b.cross(c);
    let determinant = a.dot(normal);
    let exact = DVec3::new(target.dot(normal), a.dot(target.cross(c)), a.dot(b.cross(target)))
        / determinant;
    if exact.is_finite() {
        return exact.max(DVec3::ZERO);
    }
    let alone = target.dot(a) / a.length_squared();
    if alone.is_finite() { DVec3::new(alone.max(0.0), 0.0, 0.0) } else { DVec3::ZERO }
}

fn center_of(sides: &Sides) -> DVec3 {
    sides.graph(0).center - sides.point_in(0, 1, sides.graph(1).center)
}

fn difference(sides: &Sides, pair: SupportPair) -> DVec3 {
    sides.vertex_in(0, 0, pair[0]) - sides.vertex_in(0, 1, pair[1])
}

#[derive(Clone, Copy, Debug)]
struct Corner {
    pair: SupportPair,
    at: DVec3,
}

fn support(sides: &Sides, direction: DVec3, near: Option<SupportPair>) -> Corner {
    let second = -sides.second_direction(direction);
    let pair = [
        sides.support(0, direction, near.map(|pair| pair[0])),
        sides.support(1, second, near.map(|pair| pair[1])),
    ];
    Corner { pair, at: difference(sides, pair) }
}

/// Seeks the portal before which the origin lies, or the plane beyond which it does. Every portal
/// is a set of vertices and lies further out than the one before; where rounding says otherwise,
/// the origin is on the boundary as far as f64 can say. So the search ends.
pub(super) fn search(sides: &Sides, trail: &mut Trail<impl WalkObserver>) -> Search {
    let center = center_of(sides);
    if let Some(depth) = depth_of_balls(sides) {
        let any = support(sides, -center, None).pair;
        return Search::Overlap([any; 3], depth);
    }
    let first = support(sides, -center, None);
    if first.at.dot(-center) < 0.0 {
        return Search::Apart(-center, first.pair);
    }
    let across = first.at.cross(center);
    if across == DVec3::ZERO {
        return overlap_or_boundary(sides, [first; 3], -center);
    }
    let second = support(sides, across, Some(first.pair));
    if second.at.dot(across) < 0.0 {
        return Search::Apart(across, second.pair);
    }
    let portal = match seek(sides, center, [first, second], trail) {
        Ok(portal) => portal,
        Err(end) => return end,
    };
    refine(sides, center, portal, trail)
}

/// Turns a third corner about the ray until the ray passes between the three.
fn seek(
    sides: &Sides,
    center: DVec3,
    [mut a, mut b]: [Corner; 2],
    trail: &mut Trail<impl WalkObserver>,
) -> Result<[Corner; 3], Search> {
    let mut direction = (a.at - center).cross(b.at - center);
    if direction.dot(center) > 0.0 {
        (a, b) = (b, a);
        direction = -direction;
    }
    let mut turns = Turns::default();
    loop {
        let c = support(sides, direction, Some(b.pair));
        trail.portal([a.pair, b.pair, c.pair]);
        if c.at.dot(direction) < 0.0 {
            return Err(Search::Apart(direction, c.pair));
        }
        if turns.returned([a.pair, b.pair, c.pair]) || direction == DVec3::ZERO {
            return Err(overlap_or_boundary(sides, [a, b, c], direction));
        }
        if a.at.cross(c.at).dot(center) < 0.0 {
            b = c;
        } else if c.at.cross(b.at).dot(center) < 0.0 {
            a = c;
        } else {
            return Ok([a, b, c]);
        }
        direction = (a.at - center).cross(b.at - center);
    }
}

/// Moves the portal outward until the origin lies before it, or beyond the support.
fn refine(
    sides: &Sides,
    center: DVec3,
    portal: [Corner; 3],
    trail: &mut Trail<impl WalkObserver>,
) -> Search {
    let [mut a, mut b, mut c] = portal;
    let mut turns = Turns::default();
    loop {
        let mut normal = (b.at - a.at).cross(c.at - a.at);
        if normal.dot(a.at - center) < 0.0 {
            (b, c) = (c, b);
            normal = -normal;
        }
        let pairs = [a.pair, b.pair, c.pair];
        trail.portal(pairs);
        if normal.dot(a.at) >= 0.0
            && let Some(depth) = proved_depth(sides, &pairs)
        {
            return Search::Overlap(pairs, depth);
        }
        let further = support(sides, normal, Some(a.pair));
        if further.at.dot(normal) < 0.0 {
            return Search::Apart(normal, further.pair);
        }
        if pairs.contains(&further.pair) || turns.returned(pairs) || normal == DVec3::ZERO {
            return overlap_or_boundary(sides, [a, b, c], normal);
        }
        // The new corner and the ray span a plane; the origin's side of it keeps two of the old
        // ones.
        let split = further.at.cross(center);
        if a.at.dot(split) > 0.0 {
            if b.at.dot(split) > 0.0 { a = further } else { c = further }
        } else if c.at.dot(split) > 0.0 {
            b = further;
        } else {
            a = further;
        }
    }
}

fn overlap_or_boundary(sides: &Sides, corners: [Corner; 3], direction: DVec3) -> Search {
    let portal = corners.map(|corner| corner.pair);
    match proved_depth(sides, &portal) {
        Some(depth) => Search::Overlap(portal, depth),
        None => Search::Boundary(direction),
    }
}

/// Detects that a portal comes back: each is compared with one that is kept, each time for twice as
/// long (Brent 1980).
#[derive(Default)]
struct Turns {
    kept: Option<Portal>,
    age: u64,
    lifetime: u64,
}

impl Turns {
    fn returned(&mut self, portal: Portal) -> bool {
        if self.kept == Some(portal) {
            return true;
        }
        if self.age == self.lifetime {
            (self.kept, self.age, self.lifetime) = (Some(portal), 0, 2 * self.lifetime + 1);
        }
        self.age += 1;
        false
    }
}
