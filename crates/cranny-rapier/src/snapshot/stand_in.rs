//! What stands in for our shape in a snapshot: rapier's serde cannot read a shape that it does not
//! know.

use std::fmt;
use std::sync::{Mutex, PoisonError};
use std::thread::{self, ThreadId};

use rapier3d::math::Real;
use rapier3d::parry::shape::{Ball, Shape, TypedShape};

use crate::shape::MeshShape;

/// Radius of the ball that stands for our shape: no other has it.
const NO_BALL: Real = -1.0;

/// A ball that is none, shown to a thread that writes a snapshot in place of the shape. Everybody
/// else sees the shape, so that what is written without a snapshot is refused by rapier's serde,
/// and never comes back as a ball.
pub(crate) struct StandIn {
    ball: Ball,
    /// Once for each snapshot that is being written.
    writers: Mutex<Vec<ThreadId>>,
}

impl Default for StandIn {
    fn default() -> Self {
        Self { ball: Ball::new(NO_BALL), writers: Mutex::default() }
    }
}

/// A copy is not being written.
impl Clone for StandIn {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for StandIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("StandIn")
    }
}

impl StandIn {
    /// What this thread sees in place of the shape, if it writes a snapshot.
    pub(crate) fn shown(&self) -> Option<TypedShape<'_>> {
        let writers = self.writers.lock().unwrap_or_else(PoisonError::into_inner);
        writers.contains(&thread::current().id()).then_some(TypedShape::Ball(&self.ball))
    }

    fn change(&self, change: impl FnOnce(&mut Vec<ThreadId>)) {
        change(&mut self.writers.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// A shape that this thread writes, until this is dropped.
pub(super) struct Writing<'a>(&'a StandIn);

impl<'a> Writing<'a> {
    pub(super) fn new(shape: &'a MeshShape) -> Self {
        let stand_in = shape.stand_in();
        stand_in.change(|writers| writers.push(thread::current().id()));
        Self(stand_in)
    }
}

impl Drop for Writing<'_> {
    fn drop(&mut self) {
        let own = thread::current().id();
        self.0.change(|writers| {
            let found = writers.iter().position(|writer| *writer == own);
            found.map(|index| writers.swap_remove(index));
        });
    }
}

/// Whether a shape that was read is what stands for ours.
pub(super) fn is_stand_in(shape: &dyn Shape) -> bool {
    shape.as_ball().is_some_and(|ball| ball.radius.to_bits() == NO_BALL.to_bits())
}
