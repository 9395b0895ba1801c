//! Which features of two clusters may make a contact.
//!
//! A vertex before a face, or before its rim; two ridges that cross as seen along their common
//! normal. The vertices of one cluster are held against the planes of the other's faces, eight at
//! once; of ridges the Gauss map decides first whether they can touch as they are turned
//! (Gregorius, 2013, GDC, "The separating axis test between convex polyhedra"), then how far apart
//! they are. What is left is a *candidate*, with a lower bound of its distance: double precision
//! decides.
//!
//! Candidates can be made to last: all that may make a contact once anything has come nearer by
//! `skin` and turned by `turn`.

use cranny_geometry::clusters::{ClusterTree, CornerLanes, FaceLanes, RidgeLanes};
use cranny_geometry::{EdgeId, FaceId, PatchId, VertexId};
use wide::f32x8;

use super::ground::{Ground, Placing, rounding};
use super::lanes::{Wide3, lane_of, lanes_of, wide, within};
use super::patch_pairs::PatchPairs;
use crate::answer::Feature;
use crate::pair::Side;

/// Two features that may make a contact, by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A vertex of the first body, a face of the second.
    CornerFace,
    /// A face of the first body, a vertex of the second.
    FaceCorner,
    /// An edge of either.
    Edges,
}

/// Two features that may make a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Which pair of patches, by its number.
    pub(crate) patches: u32,
    /// The numbers of the features, of the first body and of the second.
    pub(crate) ids: [u32; 2],
    /// No contact of theirs is nearer than this, in the second body's lengths.
    pub(crate) bound: f32,
    /// None that is farther than this counts, in lengths of the pair.
    pub(crate) reach: f32,
    pub(crate) kind: Kind,
}

impl Candidate {
    /// The features, of the first body and of the second.
    #[inline(always)]
    pub(crate) fn features(&self) -> [Feature; 2] {
        let [first, second] = self.ids;
        match self.kind {
            Kind::CornerFace => [Feature::Vertex(VertexId(first)), Feature::Face(FaceId(second))],
            Kind::FaceCorner => [Feature::Face(FaceId(first)), Feature::Vertex(VertexId(second))],
            Kind::Edges => [Feature::Edge(EdgeId(first)), Feature::Edge(EdgeId(second))],
        }
    }
}

/// For how long candidates are to last, and how far they reach: lengths of the pair, and a sine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lasting {
    pub(crate) margin: f64,
    pub(crate) skin: f64,
    pub(crate) turn: f64,
}

/// By how much a vertex may lie beside a face, as a part of its distance, and still be straight
/// before its rim. Smaller: contacts over rims are lost; larger: vertices beside faces are looked
/// at in vain.
const STRAIGHT: f32 = 1.0 / (1 << 13) as f32;

/// Single-precision inner products of unit vectors are off by no more than this; so are those whose
/// signs say that ridges touch. Smaller: contacts of edges are lost by rounding; larger: more of
/// them are compared.
const SLACK: f32 = 1e-5;

/// As `SLACK`, per blur of an edge's faces and rounding of its points.
const ERRORS: f32 = 64.0;

/// Squared sine below which two edges are parallel for certain: half of what decides, since their
/// inner products lose as much.
const PARALLEL: f32 = 0.5e-6;

/// Squares of lengths, and products of two, between this and one over it lose no digits in what is
/// made of them. Smaller, and short edges pass for parallel by underflow; larger, and more edges
/// are looked at closely.
const SMALLEST: f32 = 1.0 / (1u128 << 100) as f32;

/// The lanes of squares that are neither so small nor so large that digits are lost.
#[inline(always)]
fn in_range(squares: f32x8) -> u32 {
    let (least, most) = (f32x8::splat(SMALLEST), f32x8::splat(1.0 / SMALLEST));
    (squares.simd_ge(least) & squares.simd_le(most)).to_bitmask()
}

/// Eight faces have no more corners, nor sides, than so many blocks hold.
const MOST_BLOCKS: usize = 3;

/// A cluster of the first body, turned and scaled into the second's frame, about its own centre.
#[derive(Debug, Default)]
pub(crate) struct Turned {
    /// Which one, of which body it is.
    name: Option<u32>,
    corners: [Wide3; MOST_BLOCKS],
    faces: TurnedFaces,
    ridges: [TurnedRidges; MOST_BLOCKS],
    room: Room,
}

/// A box about the origin.
#[derive(Clone, Copy, Debug, Default)]
struct Room {
    axes: [[f32; 3]; 3],
    half: [f32; 3],
}

impl Room {
    /// The lanes of points that are within reach of it.
    #[inline(always)]
    fn near(&self, points: &Wide3, reach: f32) -> u32 {
        // The normal first: it rejects most.
        let beside = |i: usize| {
            within(points.dot(&Wide3::all(self.axes[i])).abs(), f32x8::splat(self.half[i] + reach))
        };
        let near = beside(2);
        if near == 0 { 0 } else { near & beside(0) & beside(1) }
    }

    /// The lanes of segments, of which the middles and halves are given, that are within reach of
    /// it.
    #[inline(always)]
    fn near_segments(&self, middles: &Wide3, halves: &Wide3, reach: f32) -> u32 {
        let beside = |i: usize| {
            let axis = Wide3::all(self.axes[i]);
            let gap = middles.dot(&axis).abs() - halves.dot(&axis).abs();
            within(gap, f32x8::splat(self.half[i] + reach))
        };
        let near = beside(2);
        if near == 0 { 0 } else { near & beside(0) & beside(1) }
    }
}

#[derive(Debug, Default)]
struct TurnedFaces {
    normal: Wide3,
    top: f32x8,
    bottom: f32x8,
    sides: [Wide3; 3],
    ends: [f32x8; 3],
}

/// Ridges of a block, by vectors and numbers of eight.
#[derive(Debug, Default)]
struct Ridges<V, N> {
    starts: V,
    spans: V,
    squares: N,
    along: V,
    left: V,
    right: V,
    blur: N,
}

type TurnedRidges = Ridges<Wide3, f32x8>;

impl TurnedFaces {
    fn own(faces: &FaceLanes) -> Self {
        Self {
            normal: Wide3::of(&faces.normal),
            top: wide(&faces.top),
            bottom: wide(&faces.bottom),
            sides: faces.sides.each_ref().map(Wide3::of),
            ends: faces.ends.each_ref().map(wide),
        }
    }

    fn turned(faces: &FaceLanes, placing: &Placing) -> Self {
        let (own, ratio) = (Self::own(faces), f32x8::splat(placing.ratio()));
        Self {
            normal: placing.turned_all(&own.normal),
            top: own.top * ratio,
            bottom: own.bottom * ratio,
            sides: own.sides.each_ref().map(|side| placing.turned_all(side)),
            ends: own.ends.map(|end| end * ratio),
        }
    }
}

impl<V, N> Ridges<V, N> {
    /// The same in another form.
    #[inline(always)]
    fn map<W, M>(&self, vector: impl Fn(&V) -> W, number: impl Fn(&N) -> M) -> Ridges<W, M> {
        Ridges {
            starts: vector(&self.starts),
            spans: vector(&self.spans),
            squares: number(&self.squares),
            along: vector(&self.along),
            left: vector(&self.left),
            right: vector(&self.right),
            blur: number(&self.blur),
        }
    }
}

impl TurnedRidges {
    /// In place: a block is large.
    fn turn(&mut self, ridges: &RidgeLanes, placing: &Placing) {
        let ratio = f32x8::splat(placing.ratio());
        let turned = |lanes| placing.turned_all(&Wide3::of(lanes));
        let scaled = |lanes| placing.turned_all(&Wide3::of(lanes).times(ratio));
        self.starts = scaled(&ridges.starts);
        self.spans = scaled(&ridges.spans);
        self.squares = wide(&ridges.squares) * ratio * ratio;
        self.along = turned(&ridges.along);
        self.left = turned(&ridges.left);
        self.right = turned(&ridges.right);
        self.blur = wide(&ridges.blur) / ratio;
    }
}

impl Turned {
    /// Turns a cluster, unless it is the one that was turned last.
    fn set(&mut self, tree: &ClusterTree, name: u32, placing: &Placing) {
        if self.name == Some(name) {
            return;
        }
        self.name = Some(name);
        let cluster = &tree.clusters()[name as usize];
        let ratio = f32x8::splat(placing.ratio());
        for (i, own) in tree.corners(cluster).iter().enumerate() {
            self.corners[i] = placing.turned_all(&Wide3::of(&own.points).times(ratio));
        }
        self.faces = TurnedFaces::turned(&cluster.faces, placing);
        for (i, own) in tree.ridges(cluster).iter().enumerate() {
            self.ridges[i].turn(own, placing);
        }
        self.room = Room {
            axes: cluster.bounds.axes.map(|axis| placing.turned(axis)),
            half: cluster.bounds.half.map(|half| half * placing.ratio()),
        };
    }
}

/// What all comparisons of two clusters need, in the second body's lengths.
#[derive(Clone, Copy)]
struct Limits {
    /// What is farther makes no contact.
    reach: f32,
    /// What may come about, with what single precision is off by.
    skin: f32,
    error: f32,
    turn: f32,
    /// What a point of the pair may be off by.
    posing: f32,
}

/// Adds the candidates of two clusters.
pub(crate) fn add_candidates(
    ground: &Ground,
    pair: [u32; 2],
    lasting: Lasting,
    turned: &mut Turned,
    (patches, found): (&mut PatchPairs, &mut Vec<Candidate>),
) {
    let trees = ground.trees;
    let placing = ground.into(Side::Second);
    turned.set(trees[0], pair[0], placing);
    let (a, b) = (&trees[0].clusters()[pair[0] as usize], &trees[1].clusters()[pair[1] as usize]);
    // From the second's centre to the first's.
    let offset = ground.between(Side::Second, b, a);
    let unit = trees[1].unit();
    let scale = a.bounds.radius * placing.ratio()
        + b.bounds.radius
        + offset.iter().map(|x| x.abs()).sum::<f32>();
    let far = (lasting.margin as f32).next_up();
    let posing = (ground.posing() / unit) as f32;
    let error = rounding(scale) + posing;
    let skin = (lasting.skin / unit) as f32 + error;
    let reach = ((lasting.margin / unit) as f32).next_up() + skin;
    let limits = Limits { reach, skin, error, turn: lasting.turn as f32, posing };
    let forth = Wide3::all(offset);
    let back = Wide3::all(offset.map(|x| -x));
    let faces = &turned.faces;
    let mut add = |kind: Kind, of: [PatchId; 2], ids: [u32; 2], bound: f32| {
        let patches = patches.one_more(of);
        found.push(Candidate { patches, ids, bound, reach: far, kind });
    };
    // The first's vertices before the second's faces.
    let its = TurnedFaces::own(&b.faces);
    let room = Room { axes: b.bounds.axes, half: b.bounds.half };
    for (block, points) in trees[0].corners(a).iter().zip(&turned.corners) {
        let before = Before { lanes: &b.faces, faces: &its, room: &room };
        before.corners(block, &points.plus(&forth), limits, |lane, face, bound| {
            let of = [block.patches[lane], b.faces.patches[face]];
            add(Kind::CornerFace, of, [block.ids[lane].0, b.faces.ids[face].0], bound);
        });
    }
    for block in trees[1].corners(b) {
        let before = Before { lanes: &a.faces, faces, room: &turned.room };
        let points = Wide3::of(&block.points).plus(&back);
        before.corners(block, &points, limits, |lane, face, bound| {
            let of = [a.faces.patches[face], block.patches[lane]];
            add(Kind::FaceCorner, of, [a.faces.ids[face].0, block.ids[lane].0], bound);
        });
    }
    let others = trees[1].ridges(b);
    if others.is_empty() {
        return;
    }
    for (block, ridges) in trees[0].ridges(a).iter().zip(&turned.ridges) {
        let half = f32x8::splat(0.5);
        let starts = ridges.starts.plus(&forth);
        let halves = ridges.spans.times(half);
        let near = room.near_segments(&starts.plus(&halves), &halves, limits.reach);
        let near = near & ((1 << block.count) - 1);
        if near == 0 {
            continue;
        }
        let mut own = ridges.map(|v| v.to_arrays(), |x| x.to_array());
        own.starts = starts.to_arrays();
        for lane in lanes_of(near) {
            let edge = own.map(|v| lane_of(v, lane), |x| f32x8::splat(x[lane]));
            for other in others {
                edge.before(other, limits, |k, bound| {
                    let of = [block.patches[lane], other.patches[k]];
                    add(Kind::Edges, of, [block.ids[lane].0, other.ids[k].0], bound);
                });
            }
        }
    }
}

/// A bound less what it may be off by; of what overflowed nothing is certain.
#[inline(always)]
fn at_least(bound: f32, error: f32) -> f32 {
    (bound - error).max(f32::NEG_INFINITY)
}

/// Faces that vertices stand before.
struct Before<'a> {
    lanes: &'a FaceLanes,
    faces: &'a TurnedFaces,
    room: &'a Room,
}

impl Before<'_> {
    /// Calls `found` with the lane of each vertex and of each face before which it may make a
    /// contact, and a lower bound.
    #[inline(always)]
    fn corners(
        &self,
        block: &CornerLanes,
        points: &Wide3,
        limits: Limits,
        mut found: impl FnMut(usize, usize, f32),
    ) {
        let Limits { reach, skin, error, turn, .. } = limits;
        let near = self.room.near(points, reach) & ((1 << block.count) - 1);
        if near == 0 {
            return;
        }
        let faces = self.faces;
        let zero = f32x8::splat(0.0);
        let arrays = points.to_arrays();
        for lane in lanes_of(near) {
            let p = lane_of(&arrays, lane);
            let height = faces.normal.dot(&p);
            let above = (height - faces.top).fast_max(faces.bottom - height).fast_max(zero);
            let out = |i: usize| faces.sides[i].dot(&p) - faces.ends[i];
            let [x, y, z] = [out(0), out(1), out(2)];
            let beside = x.fast_max(y).fast_max(z).fast_max(zero);
            let far = f32x8::splat(reach);
            let mut near = within(above, far) & within(beside, far) & self.lanes.mask();
            if near == 0 {
                continue;
            }
            // Over the inside, or straight before the rim, and not behind; or a tip beyond a side
            // of which something counts to the face: the nearest point lies on a side like that.
            // As bodies turn, what is before a face shifts beside it.
            let shift = skin + turn * reach;
            let slack = f32x8::splat(shift);
            let over = within(beside, f32x8::splat(shift + STRAIGHT * reach))
                & within(faces.bottom - height, slack);
            let [a, b, c] = self.lanes.rims;
            let rims = || within(-x, slack) & a | within(-y, slack) & b | within(-z, slack) & c;
            near &= over | if block.tips >> lane & 1 != 0 { rims() } else { 0 };
            if near == 0 {
                continue;
            }
            let apart = (above * above + beside * beside).sqrt().to_array();
            for face in lanes_of(near) {
                if apart[face] <= reach || apart[face].is_nan() {
                    found(lane, face, at_least(apart[face], error));
                }
            }
        }
    }
}

impl TurnedRidges {
    /// Of one ridge, eight times: calls `found` with the lane of each ridge that it may touch, and
    /// a lower bound of their distance.
    #[inline(always)]
    fn before(&self, others: &RidgeLanes, limits: Limits, mut found: impl FnMut(usize, f32)) {
        let Limits { reach, error, turn, posing, .. } = limits;
        // Arcs that cross on the sphere of directions: four inner products, all of one sign.
        let blur = self.blur + wide(&others.blur);
        let slack = f32x8::splat(SLACK + turn) + blur * f32x8::splat(ERRORS * posing);
        let along = Wide3::of(&others.along);
        let (p, q) = (self.left.dot(&along), self.right.dot(&along));
        let (least, most) = (p.fast_min(q), p.fast_max(q));
        let mut near = (within(most, slack) | within(-least, slack)) & ((1 << others.count) - 1);
        if near == 0 {
            return;
        }
        let (r, s) =
            (Wide3::of(&others.left).dot(&self.along), Wide3::of(&others.right).dot(&self.along));
        let (least, most) = (least.fast_min(r).fast_min(s), most.fast_max(r).fast_max(s));
        near &= within(most, slack) | within(-least, slack);
        if near == 0 {
            return;
        }
        // The nearest points of the two segments.
        let (zero, one) = (f32x8::splat(0.0), f32x8::splat(1.0));
        let span = Wide3::of(&others.spans);
        let between = self.starts.minus(&Wide3::of(&others.starts));
        let (a, e) = (self.squares, wide(&others.squares));
        let (b, c, f) = (self.spans.dot(&span), self.spans.dot(&between), span.dot(&between));
        let whole = a * e;
        let raw = whole - b * b;
        let is_now = limits.turn == 0.0;
        let known = in_range(a) & in_range(e) & in_range(whole);
        if is_now {
            near &= !(within(raw, f32x8::splat(PARALLEL) * whole) & known);
        }
        let across = raw.fast_max(f32x8::splat(PARALLEL) * whole);
        let bend = whole / across;
        let s = (b * f - c * e) / across;
        if is_now {
            // Where lines are nearest lies within both edges, but for lost digits.
            let blur = f32x8::splat(2.0 * error) * bend + f32x8::splat(error);
            let t = (b * s + f) / e;
            let (over_s, over_t) = (blur / a.sqrt(), blur / e.sqrt());
            let inside =
                within((s - one).fast_max(-s), over_s) & within((t - one).fast_max(-t), over_t);
            near &= inside | !known;
            if near == 0 {
                return;
            }
        }
        let s = s.fast_max(zero).fast_min(one);
        let t = ((b * s + f) / e).fast_max(zero).fast_min(one);
        let s = ((b * t - c) / a).fast_max(zero).fast_min(one);
        let apart = between.plus(&self.spans.times(s)).minus(&span.times(t));
        let apart = apart.dot(&apart).sqrt();
        // Where they are nearly parallel, the parameters lose digits.
        let fuzz = f32x8::splat(error) * bend.sqrt();
        let bound = apart - fuzz;
        near &= within(bound, f32x8::splat(reach)) | !known;
        if near == 0 {
            return;
        }
        let bound = bound.to_array();
        for lane in lanes_of(near) {
            let bound = if known >> lane & 1 != 0 { bound[lane] } else { f32::NEG_INFINITY };
            found(lane, at_least(bound, error));
        }
    }
}
