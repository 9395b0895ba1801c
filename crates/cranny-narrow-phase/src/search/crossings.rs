//! Which triangles cross, eight pairs at once, as far as single precision is certain.
//!
//! An edge pierces a triangle where its ends lie on two sides of the plane, and its line goes round
//! all three sides of the triangle the same way. Both are signs of determinants of four corners,
//! and a sign is certain where the determinant is larger than what it may be off by. Triangles of
//! which no edge pierces the other do not meet. Else, in general position, two edges do, and the
//! triangles cross between these. What is not certain is left to exact arithmetic.
//!
//! How lines go round each other: Plücker coordinates, as Shevtsov, Soupikov and Kapustin (2007)
//! use them for rays.

use cranny_exact::{Crossing, CrossingEnd};
use wide::f32x8;

use super::lanes::Wide3;

/// A corner that is off moves a determinant by as much times twice the area of the other three, so
/// no more than an edge times the way across, for each of four corners; coordinates are rounded no
/// more coarsely than corners are known
/// ([`ROUNDING`](cranny_geometry::clusters::ROUNDING)), which adds a fourth of that. Smaller: signs
/// that are not certain count; larger: exact arithmetic decides what is clear.
const OFF: f32 = 2.5;

/// Determinants of less are not compared: their products lose digits. Smaller: what underflows
/// counts as certain; larger: exact arithmetic decides about small faces that are clear.
const LEAST: f32 = 1e-30;

/// The lanes in which a determinant is certainly above zero, and those in which it is below.
#[derive(Clone, Copy)]
struct Signs {
    above: u32,
    below: u32,
}

impl Signs {
    #[inline(always)]
    fn of(determinant: f32x8, error: f32x8) -> Self {
        // What is no number is neither.
        Self {
            above: determinant.simd_gt(error).to_bitmask(),
            below: determinant.simd_lt(-error).to_bitmask(),
        }
    }
}

/// A triangle's edges, from corner `i` to the next, as lines.
struct Lines {
    along: [Wide3; 3],
    moment: [Wide3; 3],
    normal: Wide3,
    /// Of its plane.
    level: f32x8,
    /// The longest edge with what it may be off by.
    length: f32x8,
}

impl Lines {
    #[inline(always)]
    fn of([p, q, r]: &[Wide3; 3], off: f32x8) -> Self {
        let along = [q.minus(p), r.minus(q), p.minus(r)];
        let moment = [p.cross(q), q.cross(r), r.cross(p)];
        let normal = along[0].cross(&along[1]);
        let [u, v, w] = &along;
        let length = u.dot(u).fast_max(v.dot(v)).fast_max(w.dot(w)).sqrt() + off;
        Self { level: normal.dot(p), along, moment, normal, length }
    }

    /// On which side of the plane three points are; determinants are off by `error`.
    #[inline(always)]
    fn sides(&self, [p, q, r]: &[Wide3; 3], error: f32x8) -> [Signs; 3] {
        let side = |point: &Wide3| Signs::of(self.normal.dot(point) - self.level, error);
        [side(p), side(q), side(r)]
    }

    /// In which sense an edge goes round the other triangle's.
    #[inline(always)]
    fn turn(&self, i: usize, other: &Self, j: usize, error: f32x8) -> Signs {
        let turn = self.along[i].dot(&other.moment[j]) + self.moment[i].dot(&other.along[j]);
        Signs::of(turn, error)
    }
}

/// What is certain of eight pairs of triangles, as bits of their lanes.
pub(crate) struct Crossings {
    apart: u32,
    crossing: u32,
    /// Of each triangle the edges that pierce the other.
    piercing: [[u32; 3]; 2],
    /// Those that go from the other's back to its front.
    rising: [[u32; 3]; 2],
}

impl Crossings {
    /// Of triangles about one point; their corners are off by `error`.
    #[inline(always)]
    pub(crate) fn of(a: &[Wide3; 3], b: &[Wide3; 3], error: f32x8) -> Self {
        let two = f32x8::splat(2.0);
        let (own, its) = (Lines::of(a, two * error), Lines::of(b, two * error));
        let between = b[0].minus(&a[0]);
        let across = between.dot(&between).sqrt() + two * error + own.length + its.length;
        let off = f32x8::splat(OFF) * error;
        let least = f32x8::splat(LEAST);
        let of_plane = |length: f32x8| (off * length * (length + two * across)).fast_max(least);
        let of_turn = (off * (own.length + its.length) * across).fast_max(least);
        // One by one: as maps over arrays they are calls.
        let turns = |i: usize| {
            let turn = |j: usize| own.turn(i, &its, j, of_turn);
            [turn(0), turn(1), turn(2)]
        };
        let [u, v, w] = [turns(0), turns(1), turns(2)];
        let seen_from_its = |j: usize| [u[j], v[j], w[j]];
        let seen_from_its = [seen_from_its(0), seen_from_its(1), seen_from_its(2)];
        let of_own = PiercingEdges::of(its.sides(a, of_plane(its.length)), [u, v, w]);
        let of_its = PiercingEdges::of(own.sides(b, of_plane(own.length)), seen_from_its);
        let certain = of_own.certain & of_its.certain;
        let pierced = of_own.pierced() | of_its.pierced();
        Self {
            apart: certain & !pierced,
            crossing: certain & pierced & of_own.clear & of_its.clear,
            piercing: [of_own.piercing, of_its.piercing],
            rising: [of_own.rising, of_its.rising],
        }
    }

    /// The lanes of triangles that certainly do not meet.
    pub(crate) fn apart(&self) -> u32 {
        self.apart
    }

    /// The lanes of triangles that certainly cross in general position.
    pub(crate) fn crossing(&self) -> u32 {
        self.crossing
    }

    /// Where the triangles of a lane cross, which is one of [`crossing`](Self::crossing).
    pub(crate) fn at(&self, lane: usize) -> Option<Crossing> {
        let mut ends =
            (0..2u8).flat_map(|owner| (0..3u8).map(move |edge| CrossingEnd { owner, edge }));
        let bit = |of: &[[u32; 3]; 2], end: CrossingEnd| {
            of[usize::from(end.owner)][usize::from(end.edge)] >> lane & 1 != 0
        };
        let mut next = || ends.find(|&end| bit(&self.piercing, end));
        let (one, other) = (next()?, next()?);
        Some(Crossing::of([one, other], bit(&self.rising, one)))
    }
}

/// The edges of one of two triangles, with the other.
struct PiercingEdges {
    piercing: [u32; 3],
    rising: [u32; 3],
    /// Of all three edges it is certain whether they pierce.
    certain: u32,
    /// No corner lies in the other's plane.
    clear: u32,
}

impl PiercingEdges {
    /// By the sides of the corners about the other's plane, and how each edge goes round the
    /// other's.
    #[inline(always)]
    fn of(corners: [Signs; 3], turns: [[Signs; 3]; 3]) -> Self {
        let (mut piercing, mut rising) = ([0; 3], [0; 3]);
        let (mut certain, mut clear) = (u32::MAX, u32::MAX);
        for i in 0..3 {
            let (from, to, [u, v, w]) = (corners[i], corners[(i + 1) % 3], turns[i]);
            rising[i] = from.below & to.above;
            let straddles = rising[i] | from.above & to.below;
            let (above, below) = (u.above | v.above | w.above, u.below | v.below | w.below);
            let round = u.above & v.above & w.above | u.below & v.below & w.below;
            piercing[i] = straddles & round;
            let aside = from.above & to.above | from.below & to.below | above & below;
            certain &= piercing[i] | aside;
            clear &= from.above | from.below;
        }
        Self { piercing, rising, certain, clear }
    }

    fn pierced(&self) -> u32 {
        self.piercing[0] | self.piercing[1] | self.piercing[2]
    }
}
