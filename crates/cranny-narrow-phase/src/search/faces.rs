//! Which faces of two clusters may be near each other.
//!
//! The planes of the faces part them, and boxes along one frame: for each face of the first cluster
//! all of the second's at once. What is left is for [`apart`](super::apart) or double precision to
//! decide.

use cranny_geometry::FaceId;
use cranny_geometry::clusters::{Cluster, LANES, Lanes3};
use wide::f32x8;

use super::ground::{Ground, rounding};
use super::lanes::{Wide3, wide, within};
use crate::pair::Side;

/// How far eight faces reach along a direction.
struct Sight {
    axis: Wide3,
    least: f32x8,
    most: f32x8,
}

/// The least and the most of three.
#[inline(always)]
fn extremes(x: f32x8, y: f32x8, z: f32x8) -> (f32x8, f32x8) {
    (x.fast_min(y).fast_min(z), x.fast_max(y).fast_max(z))
}

impl Sight {
    #[inline(always)]
    fn of(axis: [f32; 3], [p, q, r]: &[Wide3; 3]) -> Self {
        let axis = Wide3::all(axis);
        let (least, most) = extremes(axis.dot(p), axis.dot(q), axis.dot(r));
        Self { axis, least, most }
    }

    #[inline(always)]
    fn along_box([u, v, w]: [[f32; 3]; 3], corners: &[Wide3; 3]) -> [Self; 3] {
        [Self::of(u, corners), Self::of(v, corners), Self::of(w, corners)]
    }

    /// Squares of the gaps between a face and the eight.
    #[inline(always)]
    fn gap_squared(&self, [p, q, r]: &[Wide3; 3]) -> f32x8 {
        let (least, most) = extremes(self.axis.dot(p), self.axis.dot(q), self.axis.dot(r));
        let gap = (self.least - most).fast_max(least - self.most).fast_max(f32x8::splat(0.0));
        gap * gap
    }
}

/// How far a face and the eight are apart, seen along three directions at right angles.
#[inline(always)]
fn seen_apart([u, v, w]: &[Sight; 3], face: &[Wide3; 3]) -> f32x8 {
    (u.gap_squared(face) + v.gap_squared(face) + w.gap_squared(face)).sqrt()
}

/// One of eight, eight times.
#[inline(always)]
fn lane_of(lanes: &Lanes3, lane: usize) -> Wide3 {
    Wide3::all(lanes.get(lane))
}

/// The faces of two clusters, in the first's frame and lengths, about its own cluster's centre.
pub(crate) struct Faced<'a> {
    a: &'a Cluster,
    b: &'a Cluster,
    /// Of the second's faces.
    corners: [Wide3; 3],
    normal: Wide3,
    top: f32x8,
    bottom: f32x8,
    along_box: [Sight; 3],
    /// What bounds may be off by.
    error: f32,
    unit: f64,
}

impl<'a> Faced<'a> {
    #[inline(always)]
    pub(crate) fn of(ground: &Ground<'a>, [a, b]: [u32; 2]) -> Self {
        let (first, second) = (ground.tree(Side::First), ground.tree(Side::Second));
        let (a, b) = (&first.clusters()[a as usize], &second.clusters()[b as usize]);
        let placing = ground.into(Side::First);
        let offset = ground.between(Side::First, a, b);
        let (ratio, unit) = (placing.ratio(), first.unit());
        let scale =
            a.bounds.radius + b.bounds.radius * ratio + offset.iter().map(|x| x.abs()).sum::<f32>();
        let shift = Wide3::all(offset);
        let ratio = f32x8::splat(ratio);
        let place =
            |corner: &Lanes3| placing.turned_all(&Wide3::of(corner).times(ratio)).plus(&shift);
        let [p, q, r] = &b.faces.corners;
        let corners = [place(p), place(q), place(r)];
        let normal = placing.turned_all(&Wide3::of(&b.faces.normal));
        let level = normal.dot(&shift);
        Self {
            a,
            b,
            normal,
            top: wide(&b.faces.top) * ratio + level,
            bottom: wide(&b.faces.bottom) * ratio + level,
            along_box: Sight::along_box(a.bounds.axes, &corners),
            corners,
            error: rounding(scale) + ground.posing_in(Side::First),
            unit,
        }
    }

    /// How many faces the first has.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.a.faces.count as usize
    }

    /// The faces of two lanes.
    #[inline(always)]
    pub(crate) fn ids(&self, lane: usize, other: usize) -> [FaceId; 2] {
        [self.a.faces.ids[lane], self.b.faces.ids[other]]
    }

    /// What bounds may be off by, in the first's lengths.
    #[inline(always)]
    pub(crate) fn error(&self) -> f32 {
        self.error
    }

    /// The corners of a face of the first cluster.
    #[inline(always)]
    pub(crate) fn own(&self, lane: usize) -> [[f32; 3]; 3] {
        let [p, q, r] = &self.a.faces.corners;
        [p.get(lane), q.get(lane), r.get(lane)]
    }

    /// The corners of all faces of the second.
    #[inline(always)]
    pub(crate) fn its(&self) -> [[[f32; LANES]; 3]; 3] {
        let [p, q, r] = self.corners;
        [p.to_arrays(), q.to_arrays(), r.to_arrays()]
    }

    /// A reach as a bound for [`near`](Self::near).
    #[inline(always)]
    pub(crate) fn bound(&self, reach: f64) -> f32 {
        ((reach / self.unit) as f32).next_up() + self.error
    }

    /// A certain lower bound in lengths of the pair.
    #[inline(always)]
    pub(crate) fn certain(&self, gap: f32) -> f64 {
        // Of what overflowed nothing is certain.
        (f64::from(gap - self.error).next_down() * self.unit).max(f64::NEG_INFINITY)
    }

    /// The lanes of the second's faces that may be within a bound of a face of the first, and lower
    /// bounds in the first's lengths, but for the error.
    #[inline(always)]
    pub(crate) fn near(&self, lane: usize, bound: f32) -> (u32, f32x8) {
        let (own, mask) = (&self.a.faces, self.b.faces.mask());
        let bound = f32x8::splat(bound);
        let face = [
            lane_of(&own.corners[0], lane),
            lane_of(&own.corners[1], lane),
            lane_of(&own.corners[2], lane),
        ];
        let [p, q, r] = &face;
        // Along the normals of the second's faces.
        let normal = &self.normal;
        let (least, most) = extremes(normal.dot(p), normal.dot(q), normal.dot(r));
        let mut gap = (least - self.top).fast_max(self.bottom - most);
        if within(gap, bound) & mask == 0 {
            return (0, gap);
        }
        // Along that of the first's face.
        let normal = lane_of(&own.normal, lane);
        let [p, q, r] = &self.corners;
        let (least, most) = extremes(normal.dot(p), normal.dot(q), normal.dot(r));
        gap = gap
            .fast_max(least - f32x8::splat(own.top.0[lane]))
            .fast_max(f32x8::splat(own.bottom.0[lane]) - most);
        if within(gap, bound) & mask == 0 {
            return (0, gap);
        }
        gap = gap.fast_max(seen_apart(&self.along_box, &face));
        (within(gap, bound) & mask, gap)
    }
}
