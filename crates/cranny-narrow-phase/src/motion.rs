//! How far a body can have moved, seen from the other, between two poses of a pair.
//!
//! What counts is the step `(M₁ − M₀) x + (t₁ − t₀)` of a point `x` of the second body, in the first's
//! frame; no angle is taken out of it. For points within `r` of `c` it is at most the step of `c` plus
//! `‖M₁ − M₀‖ r`, and the difference of two rotations stretches by its Frobenius norm over √2: it is
//! a half turn's share of a rotation in one plane and nothing along the third axis.
//!
//! Either body may be thought to move. A point of the first steps, seen from the second, as far as
//! the point of the second's frame that is where it is: so the bound of whichever ball is smaller, or
//! nearer to the axis, holds.

use cranny_exact::{Aabb, DMat3, DVec3, RigidMap};

use crate::pair::{Pair, Side};

/// By how much the Frobenius norm of a difference of two accepted rotation matrices may exceed that of
/// the rotations which they round. Smaller, and a step could be underestimated; larger, and bodies
/// that move by less than that spend slack for nothing.
pub(crate) const MATRIX_ERROR: f64 = 128.0 * f64::EPSILON;

/// What lies within a distance of a point of a body's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
}

impl Ball {
    /// Around a box; its roundings are part of the step's error.
    pub(crate) fn around(bounds: &Aabb) -> Self {
        Self { center: bounds.center(), radius: 0.5 * bounds.diagonal() }
    }
}

/// The motion of a pair from one query to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    turn: DMat3,
    shift: DVec3,
    stretch: f64,
    second_from_first: RigidMap,
    error: f64,
}

impl Motion {
    /// From the relative pose `before` to that of the pair; `None` where they are the same.
    pub(crate) fn since(before: &RigidMap, pair: &Pair) -> Option<Self> {
        let now = pair.first_from_second;
        if *before == now {
            return None;
        }
        let turn = now.linear - before.linear;
        let columns = [turn.x_axis, turn.y_axis, turn.z_axis];
        let frobenius = columns.map(DVec3::length_squared).iter().sum::<f64>().sqrt();
        let reach = before.translation.length() + now.translation.length();
        Some(Self {
            turn,
            shift: now.translation - before.translation,
            stretch: frobenius * 0.5f64.sqrt() + MATRIX_ERROR,
            second_from_first: now.inverse(),
            // Both poses round; so do matrices, which then are no more than nearly rigid.
            error: 2.0 * pair.culling_error() + MATRIX_ERROR * reach,
        })
    }

    /// By how much a unit direction of one body has turned at most, seen from the other.
    pub(crate) fn stretch(&self) -> f64 {
        self.stretch
    }

    /// How much farther than [`step`](Self::step) a point may be displaced on the screw that joins the poses,
    /// as a factor; `None` for a turn so large that nothing is said.
    ///
    /// An arc of angle θ is longer than its chord by (θ/2) / sin(θ/2), and `stretch` is 2 sin(θ/2): the
    /// factor is below 1 + stretch² / 16 up to a stretch of 1 (a turn of 60 degrees), doubled here.
    pub(crate) fn way_factor(&self) -> Option<f64> {
        (self.stretch <= 1.0).then_some(1.0 + 0.125 * self.stretch * self.stretch)
    }

    /// No point of a ball of one body has gone farther than this, seen from the other body.
    pub(crate) fn step_of(&self, side: Side, ball: &Ball) -> f64 {
        let center = match side {
            Side::First => self.second_from_first.apply(ball.center),
            Side::Second => ball.center,
        };
        (self.turn * center + self.shift).length() + self.stretch * ball.radius + self.error
    }

    /// No point of the balls, of the first body and of the second, has come nearer to the other body
    /// by more than this.
    pub(crate) fn step(&self, balls: &[Ball; 2]) -> f64 {
        self.step_of(Side::First, &balls[0]).min(self.step_of(Side::Second, &balls[1]))
    }
}
