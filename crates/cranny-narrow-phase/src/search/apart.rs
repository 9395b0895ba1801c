//! How far apart triangles are at least, eight pairs at once.
//!
//! The points of two triangles that are nearest lie in two edges, or a corner faces the inside of a
//! triangle. In that case the triangles' planes, which were tried before, give the distance. In the
//! other one the nearest points of some two edges do: the way between them is a direction along
//! which the triangles are as far apart as they are at all. The bound is how far they are apart
//! along the shortest such way; so it is certain however badly the points themselves are known.

use cranny_geometry::FaceId;
use cranny_geometry::clusters::LANES;
use wide::f32x8;

use super::crossings::Crossings;
use super::faces::Faced;
use super::lanes::Wide3;

/// Squared sines of angles between edges below this part are taken for it: the nearest points of
/// edges that are nearly parallel are wrong, and their bound poor, but no number overflows.
const PARALLEL: f32 = 1e-6;

/// A square of a length that no edge has which is worth comparing.
const NO_LENGTH: f32 = 1e-36;

/// Pairs of faces, side by side.
pub(crate) struct FacePairs {
    count: usize,
    ids: [[FaceId; 2]; LANES],
    /// Corner by corner, first the first's; each pair about a point of its own.
    corners: [[[f32; LANES]; 3]; 6],
    /// Lower bounds that are known, and what bounds may be off by.
    known: [f32; LANES],
    error: [f32; LANES],
}

impl FacePairs {
    pub(crate) fn new() -> Self {
        Self {
            count: 0,
            ids: [[FaceId(0); 2]; LANES],
            corners: [[[0.0; LANES]; 3]; 6],
            known: [0.0; LANES],
            error: [0.0; LANES],
        }
    }

    #[inline(always)]
    pub(crate) fn is_full(&self) -> bool {
        self.count == LANES
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Adds two faces; there must be room.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        faced: &Faced,
        (lane, own): (usize, &[[f32; 3]; 3]),
        (other, its): (usize, &[[[f32; LANES]; 3]; 3]),
        known: f32,
    ) {
        let at = self.count;
        self.count += 1;
        self.ids[at] = faced.ids(lane, other);
        self.known[at] = known;
        self.error[at] = faced.error();
        for i in 0..3 {
            for axis in 0..3 {
                self.corners[i][axis][at] = own[i][axis];
                self.corners[3 + i][axis][at] = its[i][axis][other];
            }
        }
    }

    /// Takes all pairs out, with certain lower bounds of their distances in the first's lengths:
    /// negative where nothing is known.
    pub(crate) fn take(&mut self) -> impl Iterator<Item = ([FaceId; 2], f32)> {
        let gaps = self.gaps();
        let count = std::mem::take(&mut self.count);
        self.ids.into_iter().zip(gaps).take(count)
    }

    /// Forgets all pairs.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// The bits of the pairs.
    #[inline(always)]
    pub(crate) fn lanes(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// The faces of a pair.
    #[inline(always)]
    pub(crate) fn faces(&self, lane: usize) -> [FaceId; 2] {
        self.ids[lane]
    }

    /// Certain lower bounds of distances in the first's lengths: negative where nothing is known.
    pub(crate) fn gaps(&self) -> [f32; LANES] {
        let [own, its] = self.triangles();
        let gap = apart(&own, &its);
        let gap = gap.fast_max(f32x8::from(self.known)) - f32x8::from(self.error);
        // Of what overflowed nothing is certain.
        gap.to_array().map(|gap| gap.max(f32::NEG_INFINITY))
    }

    /// Which certainly cross, and which certainly do not meet.
    pub(crate) fn crossings(&self) -> Crossings {
        let [own, its] = self.triangles();
        Crossings::of(&own, &its, f32x8::from(self.error))
    }

    #[inline(always)]
    fn triangles(&self) -> [[Wide3; 3]; 2] {
        let corner = |i: usize| {
            let [x, y, z] = self.corners[i];
            Wide3 { x: f32x8::from(x), y: f32x8::from(y), z: f32x8::from(z) }
        };
        [[corner(0), corner(1), corner(2)], [corner(3), corner(4), corner(5)]]
    }
}

/// Edges of triangles: from corner `i` to the next.
struct Edges {
    start: [Wide3; 3],
    along: [Wide3; 3],
    squared: [f32x8; 3],
    over_squared: [f32x8; 3],
}

impl Edges {
    #[inline(always)]
    fn of([p, q, r]: &[Wide3; 3]) -> Self {
        let along = [q.minus(p), r.minus(q), p.minus(r)];
        let [a, b, c] = &along;
        let least = f32x8::splat(NO_LENGTH);
        let squared =
            [a.dot(a).fast_max(least), b.dot(b).fast_max(least), c.dot(c).fast_max(least)];
        let one = f32x8::splat(1.0);
        let over_squared = [one / squared[0], one / squared[1], one / squared[2]];
        Self { start: [*p, *q, *r], along, squared, over_squared }
    }
}

/// From zero to one.
#[inline(always)]
fn clamped(x: f32x8) -> f32x8 {
    x.fast_max(f32x8::splat(0.0)).fast_min(f32x8::splat(1.0))
}

/// From the first edge to the second between their nearest points, or nearly.
#[inline(always)]
fn way(a: &Edges, i: usize, b: &Edges, j: usize) -> Wide3 {
    let (u, v) = (&a.along[i], &b.along[j]);
    let from = b.start[j].minus(&a.start[i]);
    let (cosine, c, f) = (u.dot(v), u.dot(&from), v.dot(&from));
    let squares = a.squared[i] * b.squared[j];
    let sine = (squares - cosine * cosine).fast_max(squares * f32x8::splat(PARALLEL));
    let s = clamped((c * b.squared[j] - cosine * f) / sine);
    let t = clamped((cosine * s - f) * b.over_squared[j]);
    let s = clamped((cosine * t + c) * a.over_squared[i]);
    from.plus(&v.times(t)).minus(&u.times(s))
}

/// A lower bound of the distances of triangles, but for rounding.
fn apart(a: &[Wide3; 3], b: &[Wide3; 3]) -> f32x8 {
    let (own, its) = (Edges::of(a), Edges::of(b));
    let mut shortest = way(&own, 0, &its, 0);
    let mut least = shortest.dot(&shortest);
    for (i, j) in [(0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1), (2, 2)] {
        let way = way(&own, i, &its, j);
        let squared = way.dot(&way);
        let is_shorter = squared.simd_lt(least);
        least = squared.fast_min(least);
        shortest = Wide3 {
            x: is_shorter.select(way.x, shortest.x),
            y: is_shorter.select(way.y, shortest.y),
            z: is_shorter.select(way.z, shortest.z),
        };
    }
    let along = shortest.times(f32x8::splat(1.0) / least.sqrt());
    let [p, q, r] = a;
    let most = along.dot(p).fast_max(along.dot(q)).fast_max(along.dot(r));
    let [p, q, r] = b;
    along.dot(p).fast_min(along.dot(q)).fast_min(along.dot(r)) - most
}
