//! The line along which two hulls are farthest apart: that between their nearest points.
//!
//! The hulls' difference is the set of all q − p, its point nearest to the origin their distance. A
//! simplex of it is kept, at most a tetrahedron of differences of vertices; its nearest point gives
//! a direction, and the support along that joins what of the simplex holds the point (Gilbert,
//! Johnson and Keerthi, 'A fast procedure for computing the distance between complex objects in
//! three-dimensional space', 1988). Each direction proves a lower bound of the distance on its own,
//! so rounding costs a thinner bound at worst.
//!
//! Cost: two support points a step, climbed to from the last; few steps from a start nearby. No
//! heap.

use cranny_exact::DVec3;
use cranny_geometry::hull::HullVertexId;

use super::{HullGap, hulls};
use crate::pair::Pair;
use cranny_geometry::triangle_distance::{Part, closest_on_segments, closest_on_triangle};

/// Steps at most. Fewer: hulls of many facets are seen along a line that is a little off; more:
/// what rounding keeps from ending is repeated.
const MOST_STEPS: u32 = 32;

impl HullGap {
    /// The line along which the hulls were seen farthest apart, from this one on; `accuracy` is by
    /// what share of the distance it may fall short. Begins at the simplex where the last search
    /// ended, and leaves the one where this does.
    pub(crate) fn farthest(self, pair: &Pair, accuracy: f64, simplex: &mut Simplex) -> Self {
        let (mut best, mut seen) = (self, self);
        simplex.place(pair);
        simplex.join(&seen);
        let mut length = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let nearest = simplex.reduce();
            let shorter = nearest.length();
            if !(shorter < length && best.least < shorter * (1.0 - accuracy)) {
                break;
            }
            length = shorter;
            let Some(toward) = nearest.try_normalize() else { break };
            let Some(next) = Self::along(pair, toward, seen.tops.map(Some)) else { break };
            seen = next;
            if seen.least > best.least {
                best = seen;
            }
            if !simplex.join(&seen) {
                break;
            }
        }
        best
    }
}

/// At most four points of the hulls' difference, and the vertices that they are the differences of.
/// Of a former query, a guess to begin with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex {
    points: [DVec3; 4],
    tops: [[HullVertexId; 2]; 4],
    len: usize,
}

impl Default for Simplex {
    fn default() -> Self {
        Self { points: [DVec3::ZERO; 4], tops: [[HullVertexId(0); 2]; 4], len: 0 }
    }
}

impl Simplex {
    /// Where the points are at this pose; forgets vertices of other hulls.
    fn place(&mut self, pair: &Pair) {
        let hulls = hulls(pair);
        // A tetrahedron around the origin holds it; the next is begun from a face.
        self.len = self.len.min(3);
        for at in 0..self.len {
            let [v, w] = self.tops[at];
            if v.index() >= hulls[0].vertex_count() || w.index() >= hulls[1].vertex_count() {
                self.len = 0;
                return;
            }
            let [p, q] = [hulls[0].position(v), hulls[1].position(w)];
            self.points[at] = pair.first_from_second.apply(q) - p;
        }
    }

    /// Takes in a point; whether it was not there.
    fn join(&mut self, seen: &HullGap) -> bool {
        let is_new = !self.tops[..self.len].contains(&seen.tops);
        if is_new {
            (self.points[self.len], self.tops[self.len]) = (seen.between, seen.tops);
            self.len += 1;
        }
        is_new
    }

    /// Its point nearest to the origin, which is outside; leaves the corners of what holds that.
    fn reduce(&mut self) -> DVec3 {
        match self.len {
            0 | 1 => self.points[0],
            2 => {
                let [a, b, ..] = self.points;
                let t = closest_on_segments(&[a, b], &[DVec3::ZERO; 2]).0;
                if t <= 0.0 {
                    self.keep([0])
                } else if t >= 1.0 {
                    self.keep([1])
                } else {
                    a + (b - a) * t
                }
            }
            3 => self.keep_nearest(&[[0, 1, 2]]),
            _ => self.keep_nearest(&[[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 2]]),
        }
    }

    /// Leaves some of the points; returns the first.
    fn keep<const N: usize>(&mut self, which: [usize; N]) -> DVec3 {
        let (points, tops) = (which.map(|i| self.points[i]), which.map(|i| self.tops[i]));
        self.points[..N].copy_from_slice(&points);
        self.tops[..N].copy_from_slice(&tops);
        self.len = N;
        points[0]
    }

    /// Of some of its faces, leaves the part of the nearest one that holds the point nearest to the
    /// origin; returns that.
    fn keep_nearest(&mut self, faces: &[[usize; 3]]) -> DVec3 {
        let mut best = (f64::INFINITY, [0; 3], DVec3::ZERO, Part::Inside);
        for &face in faces {
            let (point, part) = closest_on_triangle(DVec3::ZERO, &face.map(|i| self.points[i]));
            if point.length_squared() < best.0 {
                best = (point.length_squared(), face, point, part);
            }
        }
        let (_, face, point, part) = best;
        match part {
            Part::Corner(i) => self.keep([face[usize::from(i)]]),
            Part::Edge(i) => self.keep([face[usize::from(i)], face[(usize::from(i) + 1) % 3]]),
            Part::Inside => self.keep(face),
        };
        point
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brute_force::brute_force;
    use crate::query::Placed;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cuboid, GolfBall, Shape};
    use cranny_testkit::Rng;

    /// Of convex bodies the hulls' distance is that of the surfaces; a simplex of other bodies to
    /// begin with.
    #[test]
    fn the_line_between_nearest_points_is_found() {
        let ball = GolfBall { triangles: 320, dimples: 0, ..GolfBall::default() };
        let shapes: [Shape; 3] =
            [Cuboid { size: [2.0, 1.0, 0.1] }.into(), Cuboid::default().into(), ball.into()];
        let bodies =
            shapes.map(|s| Model::build(s.build().unwrap(), &BuildOptions::default()).unwrap().0);
        let (mut rng, mut simplex, mut apart) = (Rng::new(3), Simplex::default(), 0);
        for round in 0..600 {
            let [a, b] = [&bodies[rng.below(3)], &bodies[rng.below(3)]];
            let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let rotation = match round % 3 {
                0 => DQuat::IDENTITY,
                _ => DQuat::from_scaled_axis(3.0 * vector()).normalize(),
            };
            let translation = [0.9, 1.1, 4.0][round % 3] * vector().normalize_or(DVec3::X);
            let (a, b) = (
                Placed { model: a, pose: Pose::IDENTITY },
                Placed { model: b, pose: Pose { rotation, translation } },
            );
            let distance = brute_force(a, b).unwrap().distance;
            let pair = Pair::of_accepted(a, b);
            let way = pair.first_from_second.translation.normalize();
            let start = HullGap::along(&pair, way, [None; 2]).unwrap();
            let found = start.farthest(&pair, 1e-6, &mut simplex);
            assert!(found.least >= start.least && found.least <= distance, "round {round}");
            if distance > 0.0 && start.least > 0.0 {
                assert!(found.least > distance * (1.0 - 2e-6), "round {round}: {found:?}");
                apart += 1;
            }
        }
        assert!(apart > 200, "{apart}");
    }
}
