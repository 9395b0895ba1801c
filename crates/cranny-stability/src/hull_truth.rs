//! What is so of two hulls, in exact rationals: whether they meet, and how far they are apart.

use cranny_exact::{Aabb, DVec3, Meeting, RigidMap};
use cranny_geometry::hull::HullKind;
use cranny_testkit::{Q, Q3, rational_distance_squared, rational_meeting};

use crate::hull_judge::Body;

/// How two hulls lie.
#[derive(Clone, Debug)]
pub struct HullTruth {
    /// Whether they share a point.
    pub meets: bool,
    /// The square of their distance; 0 where they meet.
    pub squared: Q,
}

impl HullTruth {
    /// Of the first's vertices as stored and the second's as posed and rounded.
    ///
    /// Triangles are constructed in rationals, pair by pair, nearest first, until the rest is
    /// certainly farther. `towards`, of length 1 or so, roughly from the first to the second,
    /// bounds by how far a pair is apart along it: a wrong one costs time, never the answer.
    #[must_use]
    pub fn of(a: &Body, b: &Body, map: &RigidMap, towards: DVec3) -> Self {
        let (first, second) = (a.triangles(&RigidMap::IDENTITY), b.triangles(map));
        let one_holds = || holds(a, &first, second[0][0]) || holds(b, &second, first[0][0]);
        if surfaces_meet(&first, &second) || one_holds() {
            return Self { meets: true, squared: Q::ZERO };
        }
        Self { meets: false, squared: least_squared(&first, &second, towards) }
    }

    /// Rounded.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.squared.to_f64().value().sqrt()
    }
}

/// Boxes of points do not round: what they leave out shares no point.
fn surfaces_meet(first: &[[DVec3; 3]], second: &[[DVec3; 3]]) -> bool {
    let boxes = |triangles: &[[DVec3; 3]]| -> Vec<Aabb> {
        triangles.iter().map(|t| Aabb::of_points(*t)).collect()
    };
    let (boxes_a, boxes_b) = (boxes(first), boxes(second));
    first.iter().zip(&boxes_a).any(|(t, box_a)| {
        let mut near = second.iter().zip(&boxes_b).filter(|(_, box_b)| box_a.overlaps(box_b));
        near.any(|(s, _)| rational_meeting(t, s) != Meeting::None)
    })
}

/// Whether a point lies below all triangles of a volume.
fn holds(body: &Body, triangles: &[[DVec3; 3]], p: DVec3) -> bool {
    let p = Q3::exactly(p);
    let below = |t: &[DVec3; 3]| {
        let [a, b, c] = t.map(Q3::exactly);
        (&b - &a).cross(&(&c - &a)).dot(&(&p - &a)) < Q::ZERO
    };
    body.hull.kind() == HullKind::Volume && triangles.iter().all(below)
}

/// Of surfaces that do not meet.
fn least_squared(first: &[[DVec3; 3]], second: &[[DVec3; 3]], towards: DVec3) -> Q {
    let mut order = Vec::with_capacity(first.len() * second.len());
    for t in first {
        for s in second {
            order.push((apart_at_least(t, s, towards), t, s));
        }
    }
    order.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut least: Option<Q> = None;
    for (low, t, s) in order {
        let low = Q::try_from(low).unwrap_or(Q::ZERO);
        if least.as_ref().is_some_and(|least| *least <= &low * &low) {
            break;
        }
        let found = rational_distance_squared(t, s);
        if least.as_ref().is_none_or(|least| found < *least) {
            least = Some(found);
        }
    }
    least.unwrap_or(Q::ZERO)
}

/// Along the axes of their boxes and along a direction, less by more than what is rounded.
fn apart_at_least(t: &[DVec3; 3], s: &[DVec3; 3], towards: DVec3) -> f64 {
    let [a, b] = [t, s].map(|t| Aabb::of_points(*t));
    let apart = (a.min - b.max).max(b.min - a.max).max(DVec3::ZERO);
    let top = t.iter().map(|p| towards.dot(*p)).fold(f64::MIN, f64::max);
    let low = s.iter().map(|p| towards.dot(*p)).fold(f64::MAX, f64::min);
    let size = [a.min, a.max, b.min, b.max].into_iter().fold(DVec3::ZERO, |x, p| x.max(p.abs()));
    let along = (low - top) / towards.length() - 16.0 * f64::EPSILON * size.length();
    (apart.length().max(along) * (1.0 - 16.0 * f64::EPSILON)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull_judge::{at, brute_force, cuboid, platonic_solids, random_map};
    use cranny_testkit::Rng;

    #[test]
    fn boxes_touch_hold_each_other_and_part_as_they_were_put() {
        let (a, b) = (cuboid(DVec3::ONE), cuboid(DVec3::splat(0.5)));
        let hair = f64::EPSILON;
        for (x, meets, squared) in [
            (0.0, true, 0.0),
            (1.0, true, 0.0),
            (1.5, true, 0.0),
            (1.5 + hair, false, hair * hair),
            (3.5, false, 4.0),
        ] {
            for towards in [DVec3::X, -DVec3::X, DVec3::new(0.6, 0.0, 0.8)] {
                let found = HullTruth::of(&a, &b, &at(x, 0.25, 0.25), towards);
                let exact = Q::try_from(squared).expect("a number");
                assert_eq!((found.meets, found.squared), (meets, exact), "{x} {towards}");
            }
        }
    }

    #[test]
    fn brute_force_in_floating_point_agrees_to_rounding() {
        let (mut rng, bodies) = (Rng::new(3), platonic_solids());
        for i in 0..20 {
            let (a, b) = (&bodies[i % 5], &bodies[(i / 5) % 5]);
            let map = random_map(&mut rng, 3.0);
            let found = HullTruth::of(a, b, &map, map.translation.normalize());
            let (meets, distance) = brute_force(a, b, &map);
            assert_eq!(found.meets, meets);
            assert!(meets || (found.distance() - distance).abs() < 1e3 * f64::EPSILON);
        }
    }
}
