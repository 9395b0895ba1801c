//! The nearest of the faces that were measured.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

use crate::answer::Feature;
use crate::pair::{Pair, Side};
use crate::tally::Tally;
use cranny_geometry::triangle_distance::{Nearest, Prepared, triangle_distance};

/// The nearest points of two faces, one of each body.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    /// Between the points.
    pub distance: f64,
    /// In the pair's frame: on the first, on the second.
    pub points: [DVec3; 2],
    /// The least features that hold them.
    pub features: [Feature; 2],
    /// The faces: of the first body, of the second.
    pub faces: [FaceId; 2],
}

/// Keeps the nearest of the pairs of faces that are offered. Ties go to the lowest faces, so the
/// order of offers does not matter.
pub struct NearestFaces<'p, 'm> {
    pair: &'p Pair<'m>,
    below: f64,
    /// No pair of faces farther apart than this can win.
    limit: f64,
    best: Option<([FaceId; 2], Nearest)>,
    /// Unit, from the first to the second between the nearest faces measured, be they near enough
    /// or not: what keeps these apart keeps most others apart.
    toward: DVec3,
    least_measured: f64,
}

impl<'p, 'm> NearestFaces<'p, 'm> {
    /// Looks for faces less than `below` apart; infinity is no bound.
    #[must_use]
    pub fn less_than(pair: &'p Pair<'m>, below: f64) -> Self {
        let (best, toward) = (None, DVec3::ZERO);
        Self { pair, below, limit: below, best, toward, least_measured: f64::INFINITY }
    }

    pub(crate) fn pair(&self) -> &'p Pair<'m> {
        self.pair
    }

    /// No pair of faces that is farther apart than this can win: the least distance so far, or the
    /// bound given.
    #[must_use]
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Of length 1, from the first to the second between the nearest faces measured; `None` before
    /// any were, or where they touch.
    pub(crate) fn toward(&self) -> Option<DVec3> {
        (self.toward != DVec3::ZERO).then_some(self.toward)
    }

    /// Measures a face of the first body and one of the second, unless they are farther apart than
    /// the [limit](Self::limit) along the last witness direction, and keeps them if they are
    /// nearest. Returns a lower bound of their distance.
    pub fn offer(&mut self, f: FaceId, g: FaceId, counters: &mut impl Tally) -> f64 {
        let (pair, error) = (self.pair, self.pair.length_error());
        let (first, second) = (pair.triangle(Side::First, f), pair.triangle(Side::Second, g));
        let along = |p: &DVec3| self.toward.dot(*p);
        let highest = first.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        let gap = second.iter().map(along).fold(f64::INFINITY, f64::min) - highest - error;
        if gap > self.limit {
            return gap;
        }
        counters.faces([f, g]);
        // The first are measured whole: from them comes the direction that keeps others apart.
        if self.best.is_some() {
            let most = self.limit + error;
            let found = Prepared::of(&first).nearest_within(most, &Prepared::of(&second));
            // What wins is reported as if nothing had been left out.
            if !self.would_win([f, g], &found) {
                return found.squared.sqrt().min(self.limit) - error;
            }
        }
        self.take([f, g], triangle_distance(&first, &second)) - error
    }

    /// Whether what was measured between two faces is nearer than all before, or as near between
    /// lower faces.
    pub(crate) fn would_win(&self, pair: [FaceId; 2], nearest: &Nearest) -> bool {
        match &self.best {
            None => nearest.squared.sqrt() < self.below,
            Some((faces, n)) => {
                nearest.squared < n.squared || (nearest.squared <= n.squared && pair < *faces)
            }
        }
    }

    /// Takes note of what was measured between two faces; returns their distance.
    pub(crate) fn take(&mut self, pair: [FaceId; 2], nearest: Nearest) -> f64 {
        let distance = nearest.squared.sqrt();
        if distance < self.least_measured {
            self.least_measured = distance;
            self.toward = (nearest.points[1] - nearest.points[0]).normalize_or_zero();
        }
        let wins = self.would_win(pair, &nearest);
        if wins {
            self.limit = distance;
            self.best = Some((pair, nearest));
        }
        distance
    }

    /// The nearest faces, if any were measured below the bound.
    #[must_use]
    pub fn faces(&self) -> Option<[FaceId; 2]> {
        self.best.map(|(faces, _)| faces)
    }

    /// The nearest points of the nearest faces.
    #[must_use]
    pub fn found(&self) -> Option<Closest> {
        let (faces, nearest) = self.best?;
        let feature = |side: Side| {
            let i = side.index();
            Feature::of_part(nearest.parts[i], self.pair.model(side), faces[i])
        };
        Some(Closest {
            distance: nearest.squared.sqrt(),
            points: nearest.points,
            features: Side::BOTH.map(feature),
            faces,
        })
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_testkit::Rng;

    use super::*;
    use crate::answer::Counters;
    use crate::query::Placed;

    /// A sheet of needles and of fair triangles, on a lattice but for `rough`.
    fn sheet(rng: &mut Rng, rough: f64) -> Model {
        let mut vertices = Vec::new();
        for i in 0..5 {
            for j in 0..5 {
                let (x, y) = (f64::from(i * i) * 0.25, f64::from(j));
                vertices.push(DVec3::new(x, y, rough * rng.unit()));
            }
        }
        let corner = |i: u32, j: u32| 5 * i + j;
        let mut faces = Vec::new();
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            faces.push([corner(i, j), corner(i + 1, j), corner(i, j + 1)]);
            faces.push([corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
        }
        Model::build(Mesh::new(vertices, faces).unwrap(), &BuildOptions::default()).unwrap().0
    }

    /// Sheets that are parallel, so that nearly all is equally near, and tilted ones: whatever is
    /// offered first, the nearest faces are those of all pairs measured whole.
    #[test]
    fn corners_that_are_left_out_are_not_the_nearest() {
        let mut rng = Rng::new(11);
        for round in 0..60 {
            let rough = [0.0, 1e-9, 0.05][round % 3];
            let tilt = [0.0, 1e-12, 0.1][round / 3 % 3];
            let (a, b) = (sheet(&mut rng, rough), sheet(&mut rng, rough));
            let rotation = DQuat::from_rotation_x(tilt * rng.unit());
            let translation = DVec3::new(rng.unit(), rng.unit(), 0.3 + tilt);
            let pair = Pair::of_accepted(
                Placed { model: &a, pose: Pose::IDENTITY },
                Placed { model: &b, pose: Pose { rotation, translation } },
            );
            let count = |side| pair.mesh(side).faces().len() as u32;
            let mut all: Vec<[FaceId; 2]> = (0..count(Side::First))
                .flat_map(|f| (0..count(Side::Second)).map(move |g| [FaceId(f), FaceId(g)]))
                .collect();
            let measured = |&[f, g]: &[FaceId; 2]| {
                let [p, q] = [pair.triangle(Side::First, f), pair.triangle(Side::Second, g)];
                triangle_distance(&p, &q)
            };
            let nearer = |x: &[FaceId; 2], y: &[FaceId; 2]| {
                measured(x).squared.total_cmp(&measured(y).squared).then(x.cmp(y))
            };
            let best = *all.iter().min_by(|x, y| nearer(x, y)).unwrap();
            for _ in 0..5 {
                rng.shuffle(&mut all);
                let mut nearest = NearestFaces::less_than(&pair, f64::INFINITY);
                for &[f, g] in &all {
                    let least = nearest.offer(f, g, &mut Counters::default());
                    assert!(least <= measured(&[f, g]).squared.sqrt(), "round {round}");
                }
                let found = nearest.found().unwrap();
                assert_eq!(found.faces, best, "round {round}");
                assert_eq!(found.points, measured(&best).points, "round {round}");
            }
        }
    }
}
