//! Which triangle pairs meet, and how: the exact verdict on two surfaces.

use std::ops::ControlFlow;

use cranny_exact::{Crossing, DVec3, Meeting, cross_triangles};
use cranny_geometry::FaceId;

use crate::answer::{Counters, Surface};
use crate::descent::for_each_near_pair;
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

/// All pairs of faces that meet, by ascending ids.
pub(crate) fn meeting_pairs(pair: &Pair, counters: &mut Counters) -> Vec<FacePair> {
    let mut found = Vec::new();
    for_each_near_pair(pair, 0.0, counters, |first, second, counters| {
        found.extend(looked_at(pair, first, second, counters));
        ControlFlow::Continue(())
    });
    found.sort_unstable();
    found
}

/// The verdict alone, and what it needs of the touching pairs; ends at the first crossing, which
/// comes with them. `None` where `most` pairs of faces were looked at, and no crossing was found.
pub(crate) fn surface_verdict(
    pair: &Pair,
    most: u64,
    counters: &mut Counters,
) -> Option<(Surface, Vec<FacePair>)> {
    let (mut surface, mut touching, mut left) = (Meeting::None, Vec::new(), Some(most));
    for_each_near_pair(pair, 0.0, counters, |first, second, counters| {
        left = left.and_then(|left| left.checked_sub(1));
        if left.is_none() {
            return ControlFlow::Break(());
        }
        if let Some(found) = looked_at(pair, first, second, counters) {
            surface = surface.max(found.meeting);
            touching.push(found);
        }
        if surface == Meeting::Cross { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    left?;
    touching.sort_unstable();
    Some((surface, touching))
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
