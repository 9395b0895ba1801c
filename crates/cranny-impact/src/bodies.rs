//! Two moving bodies in canonical order, and where they are at a moment.
//!
//! The frame has world axes and moves with the first body's pivot, so that only what is relative is
//! seen of the translations. A point of a body is its *arm* (from the body's pivot, turned as the
//! body is), plus, for the second body, the *offset* of the pivots.

use cranny_exact::{Aabb, DMat3, DVec3, Pose};
use cranny_geometry::{FaceId, FaceTree, Model};
use cranny_narrow_phase::operations::Side;

use crate::impact::ImpactError;
use crate::motion::{Motion, Moving};

/// Rounding of a position in this frame against the exact motion, plus that of a query at
/// [`Motion::pose_at`]'s rounded pose, in ulps of the lengths that take part: rotations are off by
/// at most 64 ulps a radian (48 for the exponential, the rest for products and the matrix), on
/// either side; sums of coordinates and projections by some 40.
const ROUNDING: f64 = 256.0;

/// Two moving bodies.
pub(crate) struct Bodies<'a> {
    models: [&'a Model; 2],
    motions: [Motion; 2],
    /// Second pivot minus first, at time 0.
    offset: DVec3,
    /// How fast the offset changes.
    pub(crate) drift: DVec3,
    /// Directions of the spins, zero where there is none.
    pub(crate) axes: [DVec3; 2],
    /// How far a position may be from the exact motion, both bodies together; it covers a query at
    /// the rounded pose as well.
    pub(crate) rounding: f64,
    /// The first in canonical order is the caller's B.
    swapped: bool,
}

impl<'a> Bodies<'a> {
    /// Puts the bodies in order: by digest, then by motion.
    pub(crate) fn new(a: Moving<'a>, b: Moving<'a>) -> Result<Self, ImpactError> {
        a.motion.check('A')?;
        b.motion.check('B')?;
        let key = |m: &Moving| (m.model.digest(), m.motion.bits());
        let swapped = key(&b) < key(&a);
        let (first, second) = if swapped { (b, a) } else { (a, b) };
        let lengths = |m: &Moving| {
            let arm = m.model.radius() + m.motion.pivot.length();
            let world = m.motion.start.translation.length() + m.motion.travel.length();
            (1.0 + m.motion.turn.length()) * arm + world
        };
        Ok(Self {
            models: [first.model, second.model],
            motions: [first.motion, second.motion],
            offset: second.motion.pivot_at_start() - first.motion.pivot_at_start(),
            drift: second.motion.travel - first.motion.travel,
            axes: [first.motion.turn, second.motion.turn].map(DVec3::normalize_or_zero),
            rounding: ROUNDING * f64::EPSILON * (lengths(&first) + lengths(&second)),
            swapped,
        })
    }

    pub(crate) fn model(&self, side: Side) -> &'a Model {
        self.models[side.index()]
    }

    pub(crate) fn tree(&self, side: Side) -> &'a FaceTree {
        self.models[side.index()].tree()
    }

    /// Rotation vector of a body's whole motion, world axes: its angular velocity.
    pub(crate) fn spin(&self, side: Side) -> DVec3 {
        self.motions[side.index()].turn
    }

    /// The bodies at a time.
    pub(crate) fn at(&self, time: f64) -> Moment {
        Moment {
            time,
            rotations: self.motions.map(|m| m.rotation_at(time)),
            offset: self.offset + time * self.drift,
        }
    }

    /// Corners of a face in the frame.
    pub(crate) fn triangle(&self, side: Side, face: FaceId, moment: &Moment) -> [DVec3; 3] {
        self.arms(side, face, moment).map(|arm| arm + moment.origin(side))
    }

    /// Corners of a face, from the body's pivot.
    pub(crate) fn arms(&self, side: Side, face: FaceId, moment: &Moment) -> [DVec3; 3] {
        let (rotation, pivot) = (moment.rotations[side.index()], self.motions[side.index()].pivot);
        self.models[side.index()].mesh().triangle(face).map(|p| rotation * (p - pivot))
    }

    /// A box of a body, from its pivot.
    pub(crate) fn posed_box(&self, side: Side, bounds: &Aabb, moment: &Moment) -> PosedBox {
        let rotation = moment.rotations[side.index()];
        let h = bounds.half_extents();
        PosedBox {
            center: rotation * (bounds.center() - self.motions[side.index()].pivot),
            axes: [rotation.x_axis * h.x, rotation.y_axis * h.y, rotation.z_axis * h.z],
        }
    }

    /// From the frame at a time into world coordinates.
    pub(crate) fn world_point(&self, p: DVec3, time: f64) -> DVec3 {
        p + (self.motions[0].pivot_at_start() + time * self.motions[0].travel)
    }

    /// From (first, second) to the caller's (A, B).
    pub(crate) fn ordered<T>(&self, first: T, second: T) -> [T; 2] {
        if self.swapped { [second, first] } else { [first, second] }
    }

    /// From first to second, as the caller wants it: from A to B.
    pub(crate) fn ordered_normal(&self, n: DVec3) -> DVec3 {
        if self.swapped { -n } else { n }
    }

    /// The caller's poses at the start.
    pub(crate) fn starts(&self) -> [Pose; 2] {
        let [first, second] = self.motions.map(|m| m.pose_at(0.0));
        self.ordered(first, second)
    }
}

/// The bodies at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) rotations: [DMat3; 2],
    /// Second pivot minus first.
    pub(crate) offset: DVec3,
}

impl Moment {
    /// A body's pivot in the frame.
    pub(crate) fn origin(&self, side: Side) -> DVec3 {
        match side {
            Side::First => DVec3::ZERO,
            Side::Second => self.offset,
        }
    }
}

/// A turned box, from its body's pivot: its middle, and its axes, each half the box long.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PosedBox {
    pub(crate) center: DVec3,
    pub(crate) axes: [DVec3; 3],
}

impl PosedBox {
    /// Half of the diagonal.
    pub(crate) fn radius(&self) -> f64 {
        self.axes.iter().map(|a| a.length_squared()).sum::<f64>().sqrt()
    }
}
