//! Which triangle pairs meet, and how: the exact verdict on two surfaces.

use cranny_exact::{Crossing, DVec3, Meeting, cross_triangles};
use cranny_geometry::FaceId;

use crate::answer::{Counters, Surface};
use crate::pair::{Pair, Side};

/// Two faces that share a point, and where they cross if they do so in general position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FacePair {
    pub(crate) first: FaceId,
    pub(crate) second: FaceId,
    pub(crate) meeting: Meeting,
    pub(crate) crossing: Option<Crossing>,
}

impl FacePair {
    /// How two faces meet, of these corners; `None` if they do not.
    pub(crate) fn of(
        faces: [FaceId; 2],
        triangles: [&[DVec3; 3]; 2],
        counters: &mut Counters,
    ) -> Option<Self> {
        let (meeting, crossing, by) = cross_triangles(triangles[0], triangles[1]);
        counters.judged(by);
        let [first, second] = faces;
        meeting.meets().then_some(Self { first, second, meeting, crossing })
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
    counters: &mut Counters,
) -> Option<FacePair> {
    counters.triangle_tests += 1;
    let (a, b) = (pair.triangle(Side::First, first), pair.triangle(Side::Second, second));
    FacePair::of([first, second], [&a, &b], counters)
}
