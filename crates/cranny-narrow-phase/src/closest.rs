//! The nearest of the faces that were measured.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

use crate::answer::Feature;
use crate::pair::{Pair, Side};
use crate::tally::Tally;
use cranny_geometry::triangle_distance::{Nearest, triangle_distance};

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
    error: f64,
}

impl<'p, 'm> NearestFaces<'p, 'm> {
    /// Looks for faces less than `below` apart; infinity is no bound.
    #[must_use]
    pub fn less_than(pair: &'p Pair<'m>, below: f64) -> Self {
        let (limit, error) = (below, pair.length_error());
        Self {
            pair,
            below,
            limit,
            best: None,
            toward: DVec3::ZERO,
            least_measured: f64::INFINITY,
            error,
        }
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
        let pair = self.pair;
        let (first, second) = (pair.triangle(Side::First, f), pair.triangle(Side::Second, g));
        let along = |p: &DVec3| self.toward.dot(*p);
        let highest = first.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        let gap = second.iter().map(along).fold(f64::INFINITY, f64::min) - highest - self.error;
        if gap > self.limit {
            return gap;
        }
        counters.faces([f, g]);
        self.take([f, g], triangle_distance(&first, &second)) - self.error
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
