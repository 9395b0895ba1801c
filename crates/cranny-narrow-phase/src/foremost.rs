//! The nearest faces of bodies that a plane parts: they are among those that lie foremost.
//!
//! Along any direction d (of length 1, from the first body to the second), let the hulls be apart
//! by L, and some pair of faces by D. Points p and q no farther from each other than D have
//! d · (q − p) <= D. No point of the first body lies higher than its hull's top, none of the second
//! lower than its hull's bottom. So p lies in the *layer* of the first body that reaches D − L
//! below the top, q in that of the second, and their difference leaves d sideways by at most the
//! root of D² − L². Along the line between the nearest points of convex parts D = L, and the layers
//! are two features of the hulls: last frame's, or some beside them. Wherever they face each other,
//! faces are measured: every face that reaches there, whatever it is part of. So the answer is that
//! of a search of all.
//!
//! Where a lid is foremost D is more than L, the layers hold much, and the search is left to the
//! trees.
//!
//! Cost: two support points, climbed to from the last ones; the vertices of the hulls in the
//! layers; a descent of each tree to one place; the pairs of faces found. No heap, once lists have
//! grown.

mod layer;
#[cfg(test)]
mod tests;

use cranny_exact::{Aabb, DVec2, DVec3, RigidMap};
use cranny_geometry::hull::HullVertexId;
use cranny_geometry::{Content, FaceId};

use self::layer::Layer;
use crate::backoff::Backoff;
use crate::closest::NearestFaces;
use crate::hulls::{HullGap, Simplex};
use crate::pair::{Pair, Side};
use crate::tally::Tally;
use cranny_geometry::triangle_distance::{Prepared, triangle_distance};

/// Faces of a body that are looked at, at most. Fewer: where a vertex has more faces, all is
/// searched; more: over lids a search of the trees is cheaper.
const MOST_FACES: usize = 64;

/// What is kept of where two bodies were nearest. All of it is a guess to begin with.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foremost {
    /// Where the hulls reached farthest towards each other.
    tops: [Option<HullVertexId>; 2],
    /// Where the search for the line ended along which they are farthest apart.
    simplex: Simplex,
    backoff: Backoff,
    /// Scratch.
    layers: [Layer; 2],
    faces: [Vec<Face>; 2],
    stack: Vec<u32>,
}

/// By what part of the distance known the hulls may be nearer for the layers to be looked at as
/// they are. Larger: they hold more; smaller: a better direction is sought in vain.
const SETTLED: f64 = 1e-6;

impl Foremost {
    /// Offers all pairs of faces that may be as near as the nearest that were offered before;
    /// whether these were few enough. `parting` is a direction along which the bodies are apart,
    /// for the first query; of no length if there is none.
    pub(crate) fn offer(
        &mut self,
        pair: &Pair,
        parting: DVec3,
        nearest: &mut NearestFaces,
        counters: &mut impl Tally,
    ) -> bool {
        if !self.backoff.is_due() {
            return false;
        }
        let found = self.search(pair, parting, nearest, counters).is_some();
        match found {
            true => self.backoff.succeeded(),
            false => self.backoff.failed(),
        }
        found
    }

    /// Offers what there is to offer; `None` where that is too much, or no line parts the hulls.
    fn search(
        &mut self,
        pair: &Pair,
        parting: DVec3,
        nearest: &mut NearestFaces,
        counters: &mut impl Tally,
    ) -> Option<()> {
        let sight = self.sight(pair, parting, nearest)?;
        self.tops = sight.tops.map(Some);
        if nearest.limit() == f64::INFINITY {
            let at = |side: Side| {
                let i = side.index();
                let vertex = pair.model(side).hull().source(sight.tops[i]);
                pair.topology(side).faces_at(vertex).first().copied()
            };
            nearest.offer(at(Side::First)?, at(Side::Second)?, counters);
        }
        // As if the bodies were no farther apart than their hulls, and if they are, as far as is
        // known then.
        let close = (sight.least * (1.0 + SETTLED)).min(nearest.limit());
        self.gather(pair, &sight, close, counters)?;
        self.measure(pair, &sight, nearest, counters);
        if nearest.limit() > close {
            self.gather(pair, &sight, nearest.limit(), counters)?;
            self.measure(pair, &sight, nearest, counters);
        }
        Some(())
    }

    /// The line along which to look: that between the nearest faces known, if hulls are as far
    /// apart along it as these are.
    fn sight(&mut self, pair: &Pair, parting: DVec3, nearest: &NearestFaces) -> Option<HullGap> {
        let known = nearest.toward().and_then(|toward| HullGap::along(pair, toward, self.tops));
        let limit = nearest.limit();
        if let Some(sight) = known.filter(|s| limit - s.least <= SETTLED * s.least) {
            return Some(sight);
        }
        let start = match known.filter(|sight| sight.least > 0.0) {
            Some(sight) => sight,
            None => HullGap::along(pair, parting, self.tops)?,
        };
        Some(start.farthest(pair, SETTLED, &mut self.simplex)).filter(|sight| sight.least > 0.0)
    }

    /// Offers the pairs of faces that were gathered, but those that are certainly not as near as
    /// what is known.
    fn measure(
        &self,
        pair: &Pair,
        sight: &HullGap,
        nearest: &mut NearestFaces,
        counters: &mut impl Tally,
    ) {
        let rounding = pair.culling_error() + 2.0 * pair.length_error();
        let [first, second] = &self.faces;
        for f in first {
            for g in second {
                let (most, along) = (nearest.limit() + rounding, sight.least + f.depth + g.depth);
                if along > most {
                    break;
                }
                if along * along + f.aside_squared(g) > most * most
                    || f.is_beyond(&g.posed, most)
                    || g.is_beyond(&f.posed, most)
                {
                    continue;
                }
                counters.faces([f.face, g.face]);
                let found = f.triangle.nearest(f.corners, &g.triangle, g.corners);
                // What wins is reported as whenever faces are measured, whatever was left out here.
                if nearest.would_win([f.face, g.face], &found) {
                    nearest.take([f.face, g.face], triangle_distance(&f.posed, &g.posed));
                }
            }
        }
    }

    /// Finds the faces that may be no farther apart than `limit`; `None` where they are many.
    fn gather(
        &mut self,
        pair: &Pair,
        sight: &HullGap,
        limit: f64,
        counters: &mut impl Tally,
    ) -> Option<()> {
        let hulls = Side::BOTH.map(|side| pair.model(side).hull());
        let map = &pair.first_from_second;
        let &HullGap { directions, tops, least, .. } = sight;
        // The limit may be off by a constructed length, and the distance sought by another.
        let error = pair.culling_error();
        let most = limit + 2.0 * pair.length_error() + error;
        for i in 0..2 {
            let top = directions[i].dot(hulls[i].position(tops[i]));
            let floor = top - (most - least) - error;
            if !self.layers[i].fill(hulls[i], directions[i], tops[i], floor, error) {
                return None;
            }
        }
        let aside = ((most - least) * (most + least)).sqrt() + 2.0 * error;
        let back = map.inverse();
        let maps = [[&RigidMap::IDENTITY, map], [&back, &RigidMap::IDENTITY]];
        for side in Side::BOTH {
            let i = side.index();
            // The other's layer, moved over this one's by L: from there, points at most D apart are
            // no farther than the root of D² − L², since (s − L)² + D² − s² is no more for a part
            // s >= L along the line.
            let [own, its] = [i, 1 - i].map(|j| self.layers[j].bounds(maps[i][j]));
            let over = least * directions[i];
            let place = Aabb { min: its.min - over, max: its.max - over }.grown(aside);
            if !place.overlaps(&own) {
                // Nothing can be nearer than what is known.
                self.faces[i].clear();
                continue;
            }
            let place = Aabb { min: place.min.max(own.min), max: place.max.min(own.max) };
            self.find(pair, side, [directions[i], directions[0]], &place, counters);
        }
        for faces in &mut self.faces {
            if faces.len() > MOST_FACES {
                return None;
            }
            faces.sort_unstable_by(|f, g| f.depth.total_cmp(&g.depth));
        }
        Some(())
    }

    /// Lists the faces of a body that reach into its layer at a place, a box in its own frame; more
    /// than enough are not listed.
    fn find(
        &mut self,
        pair: &Pair,
        side: Side,
        [direction, toward]: [DVec3; 2],
        place: &Aabb,
        counters: &mut impl Tally,
    ) {
        let (tree, mesh) = (pair.model(side).tree(), pair.mesh(side));
        let (faces, stack) = (&mut self.faces[side.index()], &mut self.stack);
        let axes: [DVec3; 2] = toward.any_orthonormal_pair().into();
        let Layer { top, floor, .. } = self.layers[side.index()];
        faces.clear();
        stack.clear();
        stack.push(0);
        while let Some(node) = stack.pop() {
            counters.counters().node_tests += 1;
            if !tree.node(node).bounds.overlaps(place) {
                continue;
            }
            match tree.content(node) {
                Content::Inner { left, right } => stack.extend([left, right]),
                Content::Leaf { .. } => {
                    for &face in tree.leaf_faces(node) {
                        let heights = mesh.triangle(face).map(|p| direction.dot(p));
                        let [a, b, c] = heights.map(|height| u8::from(height >= floor));
                        let corners = a | b << 1 | c << 2;
                        if corners != 0 {
                            let [a, b, c] = heights;
                            let posed = pair.triangle(side, face);
                            faces.push(Face {
                                face,
                                corners,
                                depth: top - a.max(b).max(c),
                                across: across(axes, &posed),
                                triangle: Prepared::of(&posed),
                                normal: (posed[1] - posed[0])
                                    .cross(posed[2] - posed[0])
                                    .normalize_or_zero(),
                                posed,
                            });
                        }
                    }
                    if faces.len() > MOST_FACES {
                        return;
                    }
                }
            }
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        let faces = self.faces.iter().map(|faces| faces.capacity() * size_of::<Face>());
        faces.sum::<usize>()
            + self.layers.iter().map(Layer::bytes).sum::<usize>()
            + self.stack.capacity() * size_of::<u32>()
    }
}

/// A face that reaches into the layer of its body.
#[derive(Clone, Debug)]
struct Face {
    face: FaceId,
    /// Its corners that do, a bit each.
    corners: u8,
    /// How far below the hull's top it ends.
    depth: f64,
    /// Its least and greatest coordinates across the direction, in the pair's frame.
    across: [DVec2; 2],
    posed: [DVec3; 3],
    normal: DVec3,
    triangle: Prepared,
}

impl Face {
    /// Square of a lower bound of how far the difference of two points leaves the direction
    /// sideways.
    fn aside_squared(&self, other: &Self) -> f64 {
        let [gap, back] = [other.across[0] - self.across[1], self.across[0] - other.across[1]];
        gap.max(back).max(DVec2::ZERO).length_squared()
    }

    /// Whether a triangle lies farther off along the face's normal, on one side, than `most`. A
    /// needle's normal may be noise: what the face reaches along it counts.
    fn is_beyond(&self, its: &[DVec3; 3], most: f64) -> bool {
        let range = |corners: &[DVec3; 3]| {
            let [a, b, c] = corners.map(|p| self.normal.dot(p - self.posed[0]));
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let ([low, high], [least, greatest]) = (range(&self.posed), range(its));
        least - high > most || low - greatest > most
    }
}

fn across([u, v]: [DVec3; 2], triangle: &[DVec3; 3]) -> [DVec2; 2] {
    let [a, b, c] = triangle.map(|p| DVec2::new(u.dot(p), v.dot(p)));
    [a.min(b).min(c), a.max(b).max(c)]
}
