//! How two bodies may come nearer until contacts are found again.
//!
//! A solver needs the contacts that bodies come to in a step. A margin alone has to be as wide as
//! the fastest point moves, whichever way it moves: a nut that turns on its bolt looks along both
//! flanks of the whole thread, and comes to nothing. So beyond a margin contacts count only as far
//! as their own motion closes them.

use cranny_exact::{DMat3, DVec3, RigidMap};

use crate::evaluate::QueryError;

/// How body A may move until contacts are found again, as B sees it: contacts beyond a margin count
/// if this closes them.
///
/// A point of A that is at `p` moves by `linear`, give or take what `spread` holds, and by
/// `swing + turn × p`. All in the frame of the query's poses, in its length; `turn` in radians.
/// Turning that leads away is not relied on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Contacts farther apart than this are not found, however bodies move.
    pub within: f64,
    /// How A moves but for its turning.
    pub linear: DVec3,
    /// By how much that may differ: half the edges of a parallelepiped, as columns.
    pub spread: DMat3,
    /// The turn, along its axis.
    pub turn: DVec3,
    /// Where the turn takes the point at the frame's origin: of a turn about `c`, `c × turn`.
    pub swing: DVec3,
}

impl Approach {
    /// By how much a contact closes at most: at a point, along a normal from A to B.
    #[must_use]
    pub fn closing(&self, point: DVec3, normal: DVec3) -> f64 {
        let spread = (self.spread.transpose() * normal).abs().element_sum();
        let turning = (self.swing + self.turn.cross(point)).dot(normal);
        self.linear.dot(normal) + spread + turning.max(0.0)
    }

    /// Whether all its numbers are numbers, and its reach is a length.
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        let Self { within, linear, spread, turn, swing } = self;
        if !(*within >= 0.0 && within.is_finite()) {
            return Err(QueryError::Length { what: "within", value: *within });
        }
        let is_finite =
            linear.is_finite() && spread.is_finite() && turn.is_finite() && swing.is_finite();
        if is_finite { Ok(()) } else { Err(QueryError::Approach) }
    }

    /// In another frame.
    pub(crate) fn moved(&self, map: &RigidMap) -> Self {
        let turn = map.apply_vector(self.turn);
        Self {
            within: self.within,
            linear: map.apply_vector(self.linear),
            spread: map.linear * self.spread,
            turn,
            swing: map.apply_vector(self.swing) - turn.cross(map.translation),
        }
    }

    /// How B may move as A sees it. The normal turns round as well, so that as much closes.
    pub(crate) fn swapped(&self) -> Self {
        Self { linear: -self.linear, turn: -self.turn, swing: -self.swing, ..*self }
    }
}
