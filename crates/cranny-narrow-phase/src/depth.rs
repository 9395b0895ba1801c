//! How deep a region is along a direction: the least translation that parts its two pieces.
//!
//! Moving the second body by t along n parts the pieces as soon as no line along n meets the first
//! piece more than t ahead of the second. The largest such depth is attained over a vertex of one
//! piece and a face of the other, or over two edges that cross when seen along n; the curves'
//! points and segments are vertices and edges of both. They bound faces that reach beyond the
//! piece: an answer off the piece is refused. What lies over what is found by footprints, so the
//! cost is near linear in the pieces.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId};

use crate::answer::{Contact, Counters, Feature};
use crate::borders::Borders;
use crate::footprints::Footprints;
use crate::inside::is_inside;
use crate::intersection::Intersection;
use crate::nearest_on::NearestOn;
use crate::outline::Outline;
use crate::pair::{Pair, Side};
use crate::pieces::RegionPieces;

/// Which pairs of edges at most are measured for contacts; the deepest one is always found.
const MAX_EDGE_PAIRS_KEPT: usize = 4096;

/// So many vertices are looked at first where some depth is enough and a piece has more than the
/// square of this. More: they cost more than to look at all; fewer: all are looked at where a few
/// would do.
const SAMPLES: usize = 32;

/// How much farther than a depth, in multiples of what rounding makes a length off, the pieces are
/// moved to see whether it parts them. Smaller: features that touch then still meet; larger: what
/// is a little deeper counts as parted.
const BEYOND: f64 = 64.0;

/// The depths of a region along a direction: by how much the first piece is ahead of the second.
struct Depths {
    /// The largest, if the pieces overlap along the direction at all.
    deepest: Option<Contact>,
    /// Whether all are wanted, not the largest alone.
    keeps: bool,
    /// Where one is as large as this, no larger one is sought.
    enough: f64,
    /// One for every vertex of the pieces that is ahead, no more than the way is long, and for
    /// crossing edges while they are few. A vertex that comes out just beside the other piece (no
    /// farther than it is deep) counts as well: of a box that has sunk in askew, the sides lean,
    /// and three corners of four come out past the curve.
    all: Vec<Contact>,
}

/// In how many equal parts the line of a contact is divided, to see whether it leaves the overlap.
/// Fewer: it passes over gaps; more: what is deep takes longer.
const PLACES: u32 = 8;

/// A place of such a line is outside a solid where it is farther from it than this part of the
/// line's length. Smaller: lines along flush sides leave the overlap by rounding (reasoned: with 0
/// all tests pass); larger: they pass over gaps (with 0.01 over the slot of a test).
const BESIDE: f64 = 1e-3;

/// A direction that depths are measured along.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    /// Unit, from first to second, in the pair's frame.
    pub(crate) normal: DVec3,
    /// A length by which it is known to part the region: what is deeper lies behind a gap and is
    /// left out. Infinite where none is known.
    pub(crate) most: f64,
}

impl Way {
    pub(crate) fn along(normal: DVec3) -> Self {
        Self { normal, most: f64::INFINITY }
    }
}

/// A region and what measuring it along any direction needs.
pub(crate) struct MeasuredRegion<'a, 'b> {
    pub(crate) pair: &'a Pair<'b>,
    intersection: &'a Intersection,
    pub(crate) cut: &'a RegionPieces,
    /// The corners of each piece's faces, in their order.
    pub(crate) triangles: [Vec<[DVec3; 3]>; 2],
    borders: [Borders; 2],
}

impl<'a, 'b> MeasuredRegion<'a, 'b> {
    pub(crate) fn of(
        pair: &'a Pair<'b>,
        intersection: &'a Intersection,
        cut: &'a RegionPieces,
    ) -> Self {
        let triangles = Side::BOTH.map(|side| {
            let faces = cut.pieces[side.index()].faces.iter();
            faces.map(|&f| pair.triangle(side, f)).collect()
        });
        let borders = Side::BOTH.map(|side| Borders::of(side, intersection, cut));
        Self { pair, intersection, cut, triangles, borders }
    }

    /// What the curves enclose.
    pub(crate) fn outline(&self) -> Outline {
        Outline::of(self.intersection, &self.cut.segments)
    }

    /// How far the curves reach along a direction.
    pub(crate) fn reach_of_curves(&self, normal: DVec3) -> f64 {
        let nodes = self.cut.segments.iter().map(|&s| self.intersection.segments[s].nodes[0]);
        let (low, high) = range(nodes.map(|node| self.intersection.nodes[node].point.dot(normal)));
        high - low
    }

    /// The deepest contact along a way, of depth 0, on the curves, where there is none; and, if
    /// `keeps`, one for every inner vertex that is deep there and for crossing edges while they are
    /// few. Without these it takes less work; of equally deep contacts it may be another one.
    pub(crate) fn measure(&self, way: Way, keeps: bool) -> (Contact, Vec<Contact>) {
        let Depths { deepest, all, .. } =
            measure(&View { region: self, way }, keeps, f64::INFINITY);
        (deepest.unwrap_or_else(|| self.on_curve(way.normal)), all)
    }

    /// The deepest contact along a direction; or, where one is at least `enough` deep, any such.
    pub(crate) fn deepest_along(&self, normal: DVec3, enough: f64) -> Option<Contact> {
        measure(&View { region: self, way: Way::along(normal) }, false, enough).deepest
    }

    /// How far apart is clear of rounding.
    pub(crate) fn clear(&self) -> f64 {
        BEYOND * self.pair.length_error()
    }

    /// Whether the line between the points of a contact leaves what both solids hold, as between
    /// the turns of a thread or from one side of a slot to the other: nothing has dug in so deep.
    /// A line along a side or an edge does not leave it: of that, rounding decides.
    pub(crate) fn reaches_over_a_gap(&self, contact: &Contact) -> bool {
        let counters = &mut Counters::default();
        let beside = BESIDE * -contact.separation;
        (1..PLACES).any(|i| {
            let p = contact.point_a.lerp(contact.point_b, f64::from(i) / f64::from(PLACES));
            Side::BOTH.iter().any(|&side| {
                let mut surface = NearestOn::of(self.pair, side);
                !is_inside(self.pair, side, p, counters)
                    && surface.to(p, counters).distance > beside
            })
        })
    }

    /// A contact of depth 0 at the first point of the curves.
    pub(crate) fn on_curve(&self, normal: DVec3) -> Contact {
        let first = &self.intersection.segments[self.cut.segments[0]];
        let node = &self.intersection.nodes[first.nodes[0]];
        Contact::touching(node.features, node.point, normal)
    }
}

/// The least and the greatest of some heights.
pub(crate) fn range(heights: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    heights.into_iter().fold(none, |(low, high), height| (low.min(height), high.max(height)))
}

fn measure(view: &View, keeps: bool, enough: f64) -> Depths {
    let mut depths = Depths { deepest: None, keeps, enough, all: Vec::new() };
    let is_open = |side| {
        view.vertices_over_faces(side, &mut depths);
        !depths.is_enough()
    };
    if Side::BOTH.into_iter().all(is_open) {
        view.edges_over_edges(&mut depths);
    }
    depths
}

struct View<'g, 'a, 'b> {
    region: &'g MeasuredRegion<'a, 'b>,
    way: Way,
}

/// A face or edge with the range of its heights.
struct Ranged<T> {
    what: T,
    low: f64,
    high: f64,
}

/// A face of a piece.
type Seen<'t> = Ranged<(FaceId, &'t [DVec3; 3])>;

/// A vertex of a piece, or a point of its curves, with its height.
#[derive(Clone, Copy)]
struct Above {
    feature: Feature,
    point: DVec3,
    is_inner: bool,
    height: f64,
}

impl<T> Ranged<T> {
    fn new(what: T, heights: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = range(heights);
        Self { what, low, high }
    }
}

impl Depths {
    fn offer(&mut self, contact: Contact, keep: bool) {
        if contact.separation > 0.0 {
            return;
        }
        if self.deepest.is_none_or(|d| (contact.separation, contact.id) < (d.separation, d.id)) {
            self.deepest = Some(contact);
        }
        if keep {
            self.all.push(contact);
        }
    }

    fn largest(&self) -> f64 {
        self.deepest.map_or(0.0, |d| -d.separation)
    }

    fn is_enough(&self) -> bool {
        self.largest() >= self.enough
    }

    /// What is less deep is not wanted.
    fn floor(&self) -> f64 {
        if self.keeps { 0.0 } else { self.largest() }
    }
}

impl View<'_, '_, '_> {
    fn height(&self, p: DVec3) -> f64 {
        self.way.normal.dot(p)
    }

    /// For each vertex of `side`'s piece the face of the other that it is deepest behind.
    fn vertices_over_faces(&self, side: Side, depths: &mut Depths) {
        let MeasuredRegion { cut, .. } = *self.region;
        let other = side.other();
        // How far ahead of the second body the first is: a vertex of the first wants low faces.
        let sign = if side == Side::First { 1.0 } else { -1.0 };
        let corners = &self.region.triangles[other.index()];
        let mut faces: Vec<Seen> = (cut.pieces[other.index()].faces.iter().zip(corners))
            .map(|(&f, t)| Ranged::new((f, t), t.map(|p| sign * self.height(p))))
            .collect();
        let mut vertices: Vec<Above> = self.vertices(side, sign).collect();
        let by_height = |x: &Above, y: &Above| x.height.total_cmp(&y.height);
        let Some(&highest) = vertices.iter().max_by(|x, y| by_height(x, y)) else { return };
        if !depths.keeps {
            // The highest is the deepest or nearly so: few others are left. Where some depth is
            // enough, a few vertices mostly have it.
            let is_worth = depths.enough < f64::INFINITY && vertices.len() > SAMPLES * SAMPLES;
            let stride = if is_worth { vertices.len() / SAMPLES + 1 } else { usize::MAX };
            let some = vertices.iter().skip(stride / 2).step_by(stride);
            for &vertex in std::iter::once(&highest).chain(some) {
                self.offer_depth(side, vertex, faces.iter(), depths);
                if depths.is_enough() {
                    return;
                }
            }
            let floor = depths.floor();
            let lowest = faces.iter().map(|f| f.low).fold(f64::INFINITY, f64::min);
            vertices.retain(|v| v.height - lowest >= floor);
            faces.retain(|f| highest.height - f.low >= floor);
        }
        faces.sort_unstable_by(|x, y| x.low.total_cmp(&y.low).then(x.what.0.cmp(&y.what.0)));
        let footprints = Footprints::of(self.way.normal, faces.iter().map(|f| f.what.1.as_slice()));
        let mut over: Vec<u32> = Vec::new();
        for vertex in vertices {
            if depths.is_enough() {
                return;
            }
            let floor = depths.floor();
            let low_enough = faces.partition_point(|f| vertex.height - f.low >= floor);
            footprints.beside(&[vertex.point], low_enough, &mut over);
            self.offer_depth(side, vertex, over.iter().map(|&i| &faces[i as usize]), depths);
        }
    }

    /// Vertices of a side's piece, and of its curves.
    fn vertices(&self, side: Side, sign: f64) -> impl Iterator<Item = Above> {
        let MeasuredRegion { pair, intersection, cut, .. } = *self.region;
        let vertices = cut.pieces[side.index()].vertices.iter();
        let inner = vertices.map(move |&v| (Feature::Vertex(v), pair.position(side, v), true));
        // Every node of closed curves is the start of a segment.
        let rim = cut.segments.iter().map(move |&s| {
            let node = &intersection.nodes[intersection.segments[s].nodes[0]];
            let feature = if side == Side::First { node.features.0 } else { node.features.1 };
            (feature, node.point, false)
        });
        inner.chain(rim).map(move |(feature, point, is_inner)| {
            let height = sign * self.height(point);
            Above { feature, point, is_inner, height }
        })
    }

    /// Offers a vertex's largest depth over the faces that may be beneath it, by ascending lows for
    /// speed.
    fn offer_depth<'f>(
        &self,
        side: Side,
        vertex: Above,
        faces: impl Iterator<Item = &'f Seen<'f>>,
        depths: &mut Depths,
    ) {
        let other = side.other();
        let sign = if side == Side::First { 1.0 } else { -1.0 };
        let borders = &self.region.borders[other.index()];
        let (p, keep) = (vertex.point, vertex.is_inner && depths.keeps);
        let mut best: Option<(f64, FaceId, DVec3)> = None;
        let mut beside: Option<(f64, FaceId, DVec3)> = None;
        for face in faces {
            let (id, triangle) = face.what;
            if vertex.height - face.low <= best.map_or(0.0, |b| b.0) {
                continue;
            }
            let Some(foot) = self.foot(p, triangle) else { continue };
            let depth = vertex.height - sign * self.height(foot);
            if depth <= best.map_or(0.0, |b| b.0) || depth > self.way.most {
                continue;
            }
            let off = borders.off_piece(self.region.pair, other, id, foot);
            if off == 0.0 {
                best = Some((depth, id, foot));
            } else if keep && off <= depth && beside.is_none_or(|b| depth < b.0) {
                beside = Some((depth, id, foot));
            }
        }
        let contact = |(depth, face, foot): (f64, FaceId, DVec3)| {
            let features = [vertex.feature, Feature::Face(face)];
            side.contact(features, [p, foot], sign * self.way.normal, -depth)
        };
        if let Some(best) = best {
            depths.offer(contact(best), keep);
        } else if let Some(beside) = beside {
            depths.all.push(contact(beside));
        }
    }

    fn edges_over_edges(&self, depths: &mut Depths) {
        let ranged = |side: Side| -> Vec<Ranged<(Feature, [DVec3; 2])>> {
            self.edges(side)
                .map(|(feature, ends)| Ranged::new((feature, ends), ends.map(|p| self.height(p))))
                .collect()
        };
        let (mut first, mut second) = (ranged(Side::First), ranged(Side::Second));
        let few = first.len().saturating_mul(second.len()) <= MAX_EDGE_PAIRS_KEPT;
        let keep = few && depths.keeps;
        let least = |depths: &Depths| if keep { 0.0 } else { depths.largest() };
        // What cannot be deeper than what is known need not be sought.
        let floor = least(depths);
        let highest = first.iter().map(|e| e.high).fold(f64::NEG_INFINITY, f64::max);
        let lowest = second.iter().map(|g| g.low).fold(f64::INFINITY, f64::min);
        first.retain(|e| e.high - lowest > floor);
        second.retain(|g| highest - g.low > floor);
        first.sort_unstable_by(|x, y| y.high.total_cmp(&x.high).then(x.what.0.cmp(&y.what.0)));
        second.sort_unstable_by(|x, y| x.low.total_cmp(&y.low).then(x.what.0.cmp(&y.what.0)));
        let footprints =
            Footprints::of(self.way.normal, second.iter().map(|g| g.what.1.as_slice()));
        let mut beside: Vec<u32> = Vec::new();
        for e in &first {
            // Edges are by ascending lows: those before this one are low enough.
            let floor = least(depths);
            let low_enough = second.partition_point(|g| e.high - g.low > floor);
            if low_enough == 0 || depths.is_enough() {
                break;
            }
            footprints.beside(&e.what.1, low_enough, &mut beside);
            for g in beside.iter().map(|&i| &second[i as usize]) {
                if e.high - g.low <= least(depths) {
                    break;
                }
                let Some((p, q)) = self.crossing(&e.what.1, &g.what.1) else { continue };
                let depth = self.height(p) - self.height(q);
                if depth > 0.0 && depth <= self.way.most {
                    let features = [e.what.0, g.what.0];
                    let contact = Side::First.contact(features, [p, q], self.way.normal, -depth);
                    depths.offer(contact, keep);
                }
            }
        }
    }

    /// Edges of a piece and the curve segments that bound it.
    fn edges(&self, side: Side) -> impl Iterator<Item = (Feature, [DVec3; 2])> {
        let MeasuredRegion { intersection, cut, .. } = *self.region;
        let edge = |&(e, ends): &(EdgeId, [DVec3; 2])| (Feature::Edge(e), ends);
        let rim = move |&s: &usize| {
            let s = &intersection.segments[s];
            (Feature::Face(s.faces[side.index()]), s.nodes.map(|n| intersection.nodes[n].point))
        };
        cut.pieces[side.index()].edges.iter().map(edge).chain(cut.segments.iter().map(rim))
    }

    /// Where the line through `p` along the normal meets a triangle.
    fn foot(&self, p: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
        let area = |u: DVec3, v: DVec3| self.way.normal.dot((u - p).cross(v - p));
        let (wa, wb, wc) = (area(*b, *c), area(*c, *a), area(*a, *b));
        let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
        let sum = wa + wb + wc;
        // A face seen edge-on has no foot; its edges are measured.
        (inside && sum != 0.0).then(|| (*a * wa + *b * wb + *c * wc) / sum)
    }

    /// Where two segments cross when seen along the normal.
    fn crossing(&self, e: &[DVec3; 2], g: &[DVec3; 2]) -> Option<(DVec3, DVec3)> {
        let (d, f, r) = (e[1] - e[0], g[1] - g[0], g[0] - e[0]);
        let denominator = self.way.normal.dot(d.cross(f));
        if denominator == 0.0 {
            return None;
        }
        let s = self.way.normal.dot(r.cross(f)) / denominator;
        let t = self.way.normal.dot(r.cross(d)) / denominator;
        let within = |x: f64| (0.0..=1.0).contains(&x);
        (within(s) && within(t)).then(|| (e[0] + d * s, g[0] + f * t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cup, GolfBall, Shape, Sphere, Torus};
    use cranny_testkit::Rng;

    use crate::answer::Counters;
    use crate::intersection::intersect;
    use crate::pieces::cut;
    use crate::query::Placed;
    use crate::search::meeting_pairs;

    fn shape(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    #[test]
    fn the_deepest_is_the_largest_of_all_and_enough_ends_the_search_only_beyond_it() {
        let bodies = [
            shape(GolfBall { dimples: 12, triangles: 320, ..GolfBall::default() }),
            shape(Torus { major_segments: 16, minor_segments: 9, ..Torus::default() }),
            shape(Cup { segments: 9, ..Cup::default() }),
            // Half of it has vertices enough for some to be looked at first.
            shape(Sphere { radius: 0.5, segments: 96, rings: 48 }),
        ];
        let mut rng = Rng::new(5);
        let (mut measured, mut sampled) = (0, 0);
        for round in 0..200 {
            let fine = round % 20 == 0;
            let [a, b] = [0; 2].map(|_| &bodies[if fine { 3 } else { rng.below(3) }]);
            let rotation = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
            let reach = if fine { 0.2 } else { 1.0 };
            let translation = reach * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let place = |model, pose| Placed { model, pose };
            let (a, b) = (place(a, Pose::IDENTITY), place(b, Pose { rotation, translation }));
            let pair = Pair::of_accepted(a, b);
            let intersection = intersect(&pair, &meeting_pairs(&pair, &mut Counters::default()));
            for cut in &cut(&pair, &intersection) {
                let region = MeasuredRegion::of(&pair, &intersection, cut);
                let normal = DVec3::new(rng.unit(), rng.unit(), rng.unit()).normalize();
                let largest = -region.measure(Way::along(normal), true).0.separation;
                let depth = |c: Option<Contact>| c.map_or(0.0, |c| -c.separation);
                let alone = |enough| depth(region.deepest_along(normal, enough));
                assert_eq!(alone(f64::INFINITY), largest);
                assert_eq!(alone(largest.next_up()), largest);
                let half = alone(0.5 * largest);
                assert!(half <= largest && half >= 0.5 * largest, "{half} of {largest}");
                measured += usize::from(largest > 0.0);
                let many = |side: Side| cut.pieces[side.index()].vertices.len() > SAMPLES * SAMPLES;
                sampled += usize::from(largest > 0.0 && many(Side::First));
            }
        }
        assert!(measured > 100 && sampled > 3, "{measured} {sampled}");
    }
}
