//! What the hulls of two bodies say of them: they hold all that the bodies are.
//!
//! Seen along a line, two support points bound from below how far the hulls are apart along it, and
//! so the surfaces and the solids (`HullGap`). A verdict needs any line that parts them
//! (`parting`), a distance the one along which they are farthest apart (`nearest`).

mod nearest;
mod parting;

use cranny_exact::DVec3;
use cranny_geometry::hull::{ConvexHull, HullVertexId};

pub(crate) use self::nearest::Simplex;
pub(crate) use self::parting::Parting;
use crate::pair::{Pair, Side};

/// Two hulls seen along a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HullGap {
    /// From the first to the second, in the first's frame, and back, in the second's; of length 1.
    pub(crate) directions: [DVec3; 2],
    /// Where the hulls reach farthest along these.
    pub(crate) tops: [HullVertexId; 2],
    /// The hulls are at least so far apart, rounding taken off; may be negative.
    pub(crate) least: f64,
    /// From the first's top to the second's.
    between: DVec3,
}

impl HullGap {
    /// Looks along a direction of length 1; `starts` are where to climb from. `None` of hulls
    /// without vertices.
    pub(crate) fn along(
        pair: &Pair,
        toward: DVec3,
        starts: [Option<HullVertexId>; 2],
    ) -> Option<Self> {
        let hulls = hulls(pair);
        let map = &pair.first_from_second;
        let directions = [toward, -(map.linear.transpose() * toward)];
        let top = |i: usize| {
            let start = starts[i].filter(|v| v.index() < hulls[i].vertex_count());
            hulls[i].support(directions[i], start)
        };
        let tops = [top(0)?, top(1)?];
        let between = map.apply(hulls[1].position(tops[1])) - hulls[0].position(tops[0]);
        // The heights of two support points round 8 times, turning the direction 11, a posed vertex
        // 32, the sums and the direction's length a dozen, each by at most half an ulp of the
        // scale: what is compared with the bound 128, where the culling error has 256.
        let least = toward.dot(between) - pair.culling_error();
        Some(Self { directions, tops, least, between })
    }
}

fn hulls<'a>(pair: &Pair<'a>) -> [&'a ConvexHull; 2] {
    Side::BOTH.map(|side| pair.model(side).hull())
}
