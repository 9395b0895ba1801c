//! Which triangle pairs meet, and how: the exact verdict on two surfaces.

use std::ops::ControlFlow;

use cranny_exact::{Meeting, classify_triangles};
use cranny_geometry::FaceId;

use crate::answer::{Counters, Surface};
use crate::descent::for_each_near_pair;
use crate::pair::{Pair, Side};

/// Two faces that share a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FacePair {
    pub(crate) first: FaceId,
    pub(crate) second: FaceId,
    pub(crate) meeting: Meeting,
}

/// All pairs of faces that meet, by ascending ids.
pub(crate) fn meeting_pairs(pair: &Pair, counters: &mut Counters) -> Vec<FacePair> {
    let mut found = Vec::new();
    for_each_near_pair(pair, 0.0, counters, |first, second, counters| {
        let meeting = classified(pair, first, second, counters);
        if meeting.meets() {
            found.push(FacePair { first, second, meeting });
        }
        ControlFlow::Continue(())
    });
    found.sort_unstable();
    found
}

/// The verdict alone, and what it needs of the touching pairs; ends at the first crossing, which
/// comes with them.
pub(crate) fn surface_verdict(pair: &Pair, counters: &mut Counters) -> (Surface, Vec<FacePair>) {
    let (mut surface, mut touching) = (Meeting::None, Vec::new());
    for_each_near_pair(pair, 0.0, counters, |first, second, counters| {
        let meeting = classified(pair, first, second, counters);
        surface = surface.max(meeting);
        if meeting.meets() {
            touching.push(FacePair { first, second, meeting });
        }
        if meeting == Meeting::Cross { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    touching.sort_unstable();
    (surface, touching)
}

/// The strongest meeting among pairs.
pub(crate) fn strongest(pairs: &[FacePair]) -> Surface {
    pairs.iter().map(|p| p.meeting).max().unwrap_or(Meeting::None)
}

fn classified(pair: &Pair, first: FaceId, second: FaceId, counters: &mut Counters) -> Meeting {
    counters.triangle_tests += 1;
    classify_triangles(&pair.triangle(Side::First, first), &pair.triangle(Side::Second, second))
}
