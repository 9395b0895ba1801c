//! Which triangle pairs meet, and how: the exact verdict on two surfaces.

use cranny_exact::{Crossing, DVec3, Meeting, cross_triangles};
use cranny_geometry::FaceId;
use cranny_geometry::triangle_distance::triangle_distance;

use crate::answer::{Feature, Surface, Witness};
use crate::intersection::first_node;
use crate::pair::{Pair, Side};
use crate::tally::Tally;

/// Two faces that share a point: a face of the first body, one of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FacePair {
    /// The first body's.
    pub first: FaceId,
    /// The second body's.
    pub second: FaceId,
    /// How they meet; never [`Meeting::None`].
    pub meeting: Meeting,
    /// Which edges cross which face, if the faces cross in general position.
    pub crossing: Option<Crossing>,
}

impl FacePair {
    /// Classifies two faces, exactly for these corners in the pair's frame; `None` if they share no
    /// point. Counts which arithmetic decided, and no test.
    #[must_use]
    pub fn of(
        faces: [FaceId; 2],
        triangles: [&[DVec3; 3]; 2],
        counters: &mut impl Tally,
    ) -> Option<Self> {
        let (meeting, crossing, by) = cross_triangles(triangles[0], triangles[1]);
        counters.judged(by);
        let [first, second] = faces;
        meeting.meets().then_some(Self { first, second, meeting, crossing })
    }

    /// The face of a body.
    pub(crate) fn face(&self, side: Side) -> FaceId {
        match side {
            Side::First => self.first,
            Side::Second => self.second,
        }
    }

    /// A point that the faces share, to rounding, in the pair's frame: an end of their
    /// intersection, or a corner of their overlap; and the features that hold it.
    pub(crate) fn shared_point(&self, pair: &Pair) -> (DVec3, (Feature, Feature)) {
        if let Some(node) = first_node(pair, self) {
            return (node.point, node.features);
        }
        let [a, b] = Side::BOTH.map(|side| pair.triangle(side, self.face(side)));
        let features = (Feature::Face(self.first), Feature::Face(self.second));
        (triangle_distance(&a, &b).points[0], features)
    }

    /// A point that the faces share, to rounding, as a witness on A and one on B: an end of their
    /// intersection, or a corner of their overlap. World coordinates.
    #[must_use]
    pub fn witnesses(&self, pair: &Pair) -> [Witness; 2] {
        let (point, features) = self.shared_point(pair);
        pair.ordered(pair.world_witness(point, features.0), pair.world_witness(point, features.1))
    }
}

/// The strongest meeting among pairs.
pub(crate) fn strongest(pairs: &[FacePair]) -> Surface {
    pairs.iter().map(|p| p.meeting).max().unwrap_or(Meeting::None)
}

/// How two faces of a pair meet; `None` if they do not.
pub(crate) fn looked_at(
    pair: &Pair,
    first: FaceId,
    second: FaceId,
    counters: &mut impl Tally,
) -> Option<FacePair> {
    counters.faces([first, second]);
    let (a, b) = (pair.triangle(Side::First, first), pair.triangle(Side::Second, second));
    FacePair::of([first, second], [&a, &b], counters)
}
