//! What is asked of a front: which faces meet, and which are nearest.

use cranny_exact::{Arithmetic, DVec3, Meeting};
use cranny_geometry::FaceId;

use super::Quest;
use crate::answer::{Counters, Surface};
use crate::closest::NearestFaces;
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use crate::triangle_distance::triangle_distance;

/// The pairs of faces that meet.
pub(super) struct Meetings<'p, 'm> {
    pair: &'p Pair<'m>,
    /// The first crossing is enough.
    only_verdict: bool,
    pub(super) surface: Surface,
    pub(super) found: Vec<FacePair>,
}

impl<'p, 'm> Meetings<'p, 'm> {
    pub(super) fn new(pair: &'p Pair<'m>, only_verdict: bool) -> Self {
        Self { pair, only_verdict, surface: Meeting::None, found: Vec::new() }
    }

    /// Looks at two faces; returns a lower bound of their separation.
    fn look(&mut self, first: FaceId, second: FaceId, counters: &mut Counters) -> f64 {
        let error = self.pair.length_error();
        let triangles =
            [self.pair.triangle(Side::First, first), self.pair.triangle(Side::Second, second)];
        counters.triangle_tests += 1;
        // A gap beyond rounding along either normal is proof enough, and gives slack.
        let gap = gap_along_normals(&triangles) - error;
        if gap > 0.0 {
            counters.judged(Arithmetic::Filter);
            return gap;
        }
        let corners = [&triangles[0], &triangles[1]];
        if let Some(found) = FacePair::of([first, second], corners, counters) {
            self.surface = self.surface.max(found.meeting);
            self.found.push(found);
            return 0.0;
        }
        triangle_distance(&triangles[0], &triangles[1]).squared.sqrt() - error
    }
}

impl Quest for Meetings<'_, '_> {
    fn limit(&self) -> f64 {
        0.0
    }

    fn leaves(&mut self, first: &[FaceId], second: &[FaceId], counters: &mut Counters) -> f64 {
        let mut least = f64::INFINITY;
        for &f in first {
            for &g in second {
                least = least.min(self.look(f, g, counters));
            }
        }
        least.max(0.0)
    }

    fn is_done(&self) -> bool {
        self.only_verdict && self.surface == Meeting::Cross
    }
}

/// How far apart two triangles are along the normal of either; 0 or less if they overlap along both.
pub(crate) fn gap_along_normals(triangles: &[[DVec3; 3]; 2]) -> f64 {
    let along = triangles.iter().map(|[a, b, c]| {
        let normal = (*b - *a).cross(*c - *a).normalize_or_zero();
        let [first, second] = triangles.map(|t| t.map(|p| normal.dot(p)));
        (least(second) - most(first)).max(least(first) - most(second))
    });
    along.fold(f64::NEG_INFINITY, f64::max)
}

fn least([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

fn most([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}

/// The nearest faces.
impl Quest for NearestFaces<'_, '_> {
    fn limit(&self) -> f64 {
        NearestFaces::limit(self)
    }

    fn leaves(&mut self, first: &[FaceId], second: &[FaceId], counters: &mut Counters) -> f64 {
        let mut least = f64::INFINITY;
        for &f in first {
            for &g in second {
                least = least.min(self.offer(f, g, counters));
            }
        }
        least.max(0.0)
    }

    fn is_done(&self) -> bool {
        false
    }
}
