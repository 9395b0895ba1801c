//! Whether a point of a face lies on the piece that an intersection cuts out of its surface.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

use crate::intersection::Intersection;
use crate::pair::{Pair, Side};
use crate::pieces::RegionPieces;
use cranny_geometry::triangle_distance::closest_on_segment;

/// Where the curves run through each face, so that a point of the face can be judged on or off the
/// piece: it is on the side of the nearest curve segment that the piece lies on. By ascending face.
pub(crate) struct Borders(Vec<(FaceId, [DVec3; 2])>);

impl Borders {
    pub(crate) fn of(side: Side, intersection: &Intersection, cut: &RegionPieces) -> Self {
        let border = |&s: &usize| {
            let s = &intersection.segments[s];
            let [p, q] = s.nodes.map(|n| intersection.nodes[n].point);
            // Seen against its own normal, the first's piece is left of the segment; the second's
            // right.
            (s.faces[side.index()], side.ordered(p, q))
        };
        let mut borders: Vec<_> = cut.segments.iter().map(border).collect();
        borders.sort_by_key(|border| border.0);
        Self(borders)
    }

    /// How far a point of a face is from the piece, within that face; 0 if it is on it.
    pub(crate) fn off_piece(&self, pair: &Pair, side: Side, face: FaceId, p: DVec3) -> f64 {
        let start = self.0.partition_point(|border| border.0 < face);
        let segments = self.0[start..].iter().take_while(|border| border.0 == face);
        let apart = |ends| (p - closest_on_segment(p, ends)).length_squared();
        let nearest =
            segments.map(|(_, ends)| (apart(ends), ends)).min_by(|x, y| x.0.total_cmp(&y.0));
        let is_on =
            |[a, b]: &[DVec3; 2]| pair.area_vector(side, face).dot((*b - *a).cross(p - *a)) >= 0.0;
        match nearest {
            Some((squared, ends)) if !is_on(ends) => squared.sqrt().max(f64::MIN_POSITIVE),
            _ => 0.0,
        }
    }
}
