//! A plane that parts the hulls of two bodies, followed from query to query: what is beyond it need
//! not be looked for.
//!
//! The hulls hold all vertices, so whatever lies between two hulls along a direction lies between
//! the surfaces too, and between the solids; nothing can then contain anything. The direction that
//! parted the hulls last mostly parts them still: two support points, climbed to from the last
//! ones, prove it. If not, it is mirrored at the difference of the support points, which brings it
//! nearer to one that parts them, if any does (Chung and Wang, 'Quick elimination of
//! non-interference polytopes in virtual environments', 1996). To part them by more than a margin,
//! that is taken off their gap as if the bodies had grown.
//!
//! Where hulls overlap, as a nut's and its bolt's do for good, no direction parts them: what is not
//! found after a few turns is left to the search among faces, and sought again after twice as long
//! a wait. So memory decides who answers, never what: each proof stands on its own, with all
//! rounding on its safe side.
//!
//! Cost: two support points a query where the last plane still parts; a search from the line of
//! centres in the first. No heap. The walk over features of `cranny-concavity` finds the hulls'
//! distance as well, which a verdict does not need, and wants tables of its own for each hull.

use cranny_exact::DVec3;
use cranny_geometry::hull::HullVertexId;

use super::HullGap;
use crate::backoff::Backoff;
use crate::pair::{Pair, Side};
use crate::tally::Tally;

/// Directions tried in one query. Fewer: hulls that are just apart are parted later, since the
/// search goes on in the next query; more: hulls that overlap cost more before that is given up.
const MOST_TRIALS: u32 = 8;

/// Directions tried in the first query: the line of centres, and one more. Fewer: the first query
/// searches among faces where centres mislead; more: a query without memory about hulls that
/// overlap, where a trial climbs across both, pays for nothing.
const FIRST_TRIALS: u32 = 2;

/// Cosine between two directions below which a climb begins anew, not at the last support point.
/// Smaller: climbs across half the hull; larger: climbs from a distant vertex where the last one
/// was near.
const SAME_SIDE: f64 = 0.75;

/// What is kept of the plane between two hulls. All of it is a guess to begin with.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Parting {
    /// Of length 1, from the first body to the second, in the first's frame; zero before the first
    /// query.
    direction: DVec3,
    /// Where the hulls reach farthest towards each other.
    tops: [Option<HullVertexId>; 2],
    backoff: Backoff,
}

impl Parting {
    /// A lower bound of how far the surfaces are apart, or 0 if none was found; no bound beyond
    /// `wanted` is sought.
    ///
    /// What it returns exceeds every rounding of the pair: no computed distance is below it.
    pub(crate) fn gap(&mut self, pair: &Pair, wanted: f64, counters: &mut impl Tally) -> f64 {
        if !self.backoff.is_due() {
            return 0.0;
        }
        let (mut direction, mut tops, mut trials) = (self.direction, self.tops, MOST_TRIALS);
        if direction == DVec3::ZERO {
            let [a, b] = Side::BOTH.map(|side| pair.model(side).bounds().center());
            let centers = pair.first_from_second.apply(b) - a;
            (direction, trials) = (centers.normalize_or(DVec3::X), FIRST_TRIALS);
        }
        let (mut best, goal) = (0.0f64, wanted + pair.culling_error());
        for _ in 0..trials {
            let Some(seen) = HullGap::along(pair, direction, tops) else { return 0.0 };
            counters.counters().planes_tried += 1;
            tops = seen.tops.map(Some);
            best = best.max(seen.least);
            if seen.least > wanted {
                (self.direction, self.tops) = (direction, tops);
                self.backoff.succeeded();
                counters.counters().planes_parted += 1;
                return seen.least;
            }
            let rest = (seen.between - goal * direction).normalize_or_zero();
            let before = direction;
            direction = (before - 2.0 * before.dot(rest) * rest).normalize_or_zero();
            if direction == DVec3::ZERO {
                break;
            }
            if direction.dot(before) < SAME_SIDE {
                tops = [None; 2];
            }
        }
        // The search goes on from here.
        (self.direction, self.tops) = (direction, tops);
        self.backoff.failed();
        best
    }

    /// The direction that was tried last; zero before the first query.
    pub(crate) fn direction(&self) -> DVec3 {
        self.direction
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::brute_force::brute_force;
    use crate::query::Placed;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_shapes::{Cuboid, Cup, GolfBall, Torus};

    fn model(mesh: Mesh) -> Model {
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    fn gap(parting: &mut Parting, a: Placed, b: Placed, wanted: f64) -> (f64, Counters) {
        let mut counters = Counters::default();
        let pair = Pair::of_accepted(a, b);
        (parting.gap(&pair, wanted, &mut counters), counters)
    }

    /// Numbers in [-1, 1) from a counter.
    fn some(k: u32) -> impl FnMut() -> f64 {
        let mut state = u64::from(k).wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// At poses of all kinds, one plane handed on from pair to pair.
    #[test]
    fn a_gap_is_never_more_than_the_distance() {
        let ball = GolfBall { triangles: 180, dimples: 0, ..GolfBall::default() };
        let torus = Torus { major_segments: 14, minor_segments: 6, ..Torus::default() };
        let bodies = [
            model(Cuboid::default().build().unwrap()),
            model(Cup { segments: 10, ..Cup::default() }.build().unwrap()),
            model(ball.build().unwrap()),
            model(torus.build().unwrap()),
            model(Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap()),
        ];
        let mut parting = Parting::default();
        let (mut parted, mut overlapping) = (0, 0);
        for k in 0..400 {
            let mut next = some(k);
            let mut vector = || DVec3::new(next(), next(), next());
            let [a, b] = [k as usize % 5, (k as usize / 5) % 5].map(|i| &bodies[i]);
            let turn = DQuat::from_scaled_axis(3.0 * vector());
            let far = [0.4, 0.8, 1.1][k as usize % 3] * (a.radius() + b.radius());
            let pose = Pose { rotation: turn, translation: far * vector().normalize() };
            let (a, b) = (Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose });
            let slow = brute_force(a, b).unwrap();
            for wanted in [0.0, 0.2, 10.0] {
                // The plane is handed on, the waiting is not.
                parting.backoff = Backoff::default();
                let (gap, counters) = gap(&mut parting, a, b, wanted);
                assert!(gap <= slow.distance, "pose {k}: {gap} of {}", slow.distance);
                parted += u32::from(gap > 0.0);
                overlapping += u32::from(gap == 0.0 && counters.planes_tried > 0);
            }
        }
        assert!(parted > 150 && overlapping > 50, "{parted} {overlapping}");
    }

    /// Cubes face to face, edge to face and corner to face: touching is no gap, nor is what
    /// rounding could have made.
    #[test]
    fn gaps_below_rounding_are_none_and_those_above_are_found() {
        let cube = model(Cuboid { size: [2.0; 3] }.build().unwrap());
        let corner = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::X);
        for (turn, reach) in [
            (DQuat::IDENTITY, 1.0),
            (DQuat::from_axis_angle(DVec3::Z, 0.25 * std::f64::consts::PI), 2f64.sqrt()),
            (corner, 3f64.sqrt()),
        ] {
            for exponent in 10..=60 {
                for sign in [-1.0, 0.0, 1.0] {
                    let between = sign * 0.5f64.powi(exponent);
                    let pose =
                        Pose { rotation: turn, translation: (1.0 + reach + between) * DVec3::X };
                    let (a, b) = (
                        Placed { model: &cube, pose: Pose::IDENTITY },
                        Placed { model: &cube, pose },
                    );
                    let (gap, _) = gap(&mut Parting::default(), a, b, 0.0);
                    let slow = brute_force(a, b).unwrap();
                    assert!(gap == 0.0 || gap < slow.distance, "{exponent} {sign}: {gap}");
                    assert_eq!(gap > 0.0, sign > 0.0 && exponent <= 42, "{exponent} {sign}: {gap}");
                }
            }
        }
    }

    #[test]
    fn hulls_that_are_apart_are_parted_within_a_few_queries() {
        let bodies = [Cuboid { size: [2.0, 1.0, 0.2] }, Cuboid { size: [0.3, 3.0, 1.0] }]
            .map(|c| model(c.build().unwrap()));
        let mut parted = 0;
        for k in 0..300 {
            let mut next = some(k);
            let mut vector = || DVec3::new(next(), next(), next());
            let turn = DQuat::from_scaled_axis(3.0 * vector());
            let pose = Pose { rotation: turn, translation: 1.5 * vector().normalize() };
            let (a, b) = (
                Placed { model: &bodies[0], pose: Pose::IDENTITY },
                Placed { model: &bodies[1], pose },
            );
            // Bodies that are convex are parted where they are apart, if by a hundredth of their
            // size.
            if brute_force(a, b).unwrap().distance < 0.03 {
                continue;
            }
            let mut parting = Parting::default();
            let found = (0..8).position(|_| gap(&mut parting, a, b, 0.0).0 > 0.0);
            assert!(found.is_some(), "pose {k}");
            parted += 1;
        }
        assert!(parted > 100, "{parted}");
    }

    #[test]
    fn where_no_plane_parts_ever_longer_waits_pass() {
        let cube = model(Cuboid::default().build().unwrap());
        let at = |x: f64| Placed { model: &cube, pose: Pose::at(DVec3::new(x, 0.1, 0.2)) };
        let mut parting = Parting::default();
        let tried =
            (0..300).filter(|_| gap(&mut parting, at(0.0), at(0.3), 0.0).1.planes_tried > 0);
        assert!((5..15).contains(&tried.count()));
    }
}
