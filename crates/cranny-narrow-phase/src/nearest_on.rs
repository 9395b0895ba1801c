//! The point of a body's surface that is nearest to a point: the shortest way out of a solid, from
//! wherever in it. A region's own faces may lead out farther: `way_out` keeps to the side by which
//! the other body came in.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;
use cranny_geometry::triangle_distance::{Part, closest_on_triangle};

use crate::inside::local;
use crate::pair::{Pair, Side};
use crate::search::Vicinity;
use crate::tally::Tally;

/// Finds the points of a body's surface that are nearest to points of the pair's frame: faster to
/// points that lie beside the last one.
pub(crate) struct NearestOn<'p, 'm> {
    pair: &'p Pair<'m>,
    side: Side,
    vicinity: Vicinity,
    /// The point that was found last.
    last: Option<DVec3>,
}

impl<'p, 'm> NearestOn<'p, 'm> {
    pub(crate) fn of(pair: &'p Pair<'m>, side: Side) -> Self {
        Self { pair, side, vicinity: Vicinity::default(), last: None }
    }

    /// Prepares for points within a ball of the pair's frame.
    pub(crate) fn gather(&mut self, (center, radius): (DVec3, f64), counters: &mut impl Tally) {
        let (pair, side, mut nearest) = (self.pair, self.side, f64::INFINITY);
        let ball = (local(pair, side, center).0, radius);
        let (tree, allowance) = (pair.model(side).clusters(), pair.culling_error());
        self.vicinity.gather(tree, ball, allowance, counters, |face| {
            nearest = nearest.min(NearestFace::on(pair, side, center, face).distance);
            nearest
        });
    }

    /// Ties go to the lowest face.
    pub(crate) fn to(&mut self, p: DVec3, counters: &mut impl Tally) -> NearestFace {
        let Self { pair, side, .. } = *self;
        let local = local(pair, side, p).0;
        let tree = pair.model(side).clusters();
        // The face that was found last is no farther than the point of it.
        let known = self.last.map(|last| (last - p).length() + pair.length_error());
        let (reach, allowance) = (known.unwrap_or(f64::INFINITY), pair.culling_error());
        let mut best: Option<NearestFace> = None;
        self.vicinity.for_faces_near(tree, local, (reach, allowance), counters, |face| {
            let found = NearestFace::on(pair, side, p, face);
            if best.as_ref().is_none_or(|b| (found.distance, face) < (b.distance, b.face)) {
                best = Some(found);
            }
            best.as_ref().map_or(reach, |best| best.distance.min(reach))
        });
        // A mesh has faces, so there is a nearest one.
        let best = best.unwrap_or_else(|| NearestFace::on(pair, side, p, FaceId(0)));
        self.last = Some(best.foot);
        best
    }
}

/// The point of a face nearest to a point.
pub(crate) struct NearestFace {
    pub(crate) distance: f64,
    pub(crate) foot: DVec3,
    pub(crate) part: Part,
    pub(crate) face: FaceId,
}

impl NearestFace {
    pub(crate) fn on(pair: &Pair, side: Side, p: DVec3, face: FaceId) -> Self {
        let (foot, part) = closest_on_triangle(p, &pair.triangle(side, face));
        Self { distance: (foot - p).length(), foot, part, face }
    }
}
