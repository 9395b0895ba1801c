//! The name of a prepared model.

use std::sync::{Arc, Weak};

use super::Model;
use super::parts::Parts;

/// Names one prepared model without keeping it alive: for memories that hold numbers of its faces
/// and nodes. A clone of the model has the same name; an equal one that was built apart has
/// another, and so does what a deformation makes of it.
#[derive(Clone, Debug)]
pub struct ModelTag(Weak<Parts>);

impl ModelTag {
    /// The name of a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self(Arc::downgrade(&model.0))
    }

    /// Whether this is the model's name.
    #[must_use]
    pub fn is_of(&self, model: &Model) -> bool {
        // The tag holds on to the place, so no other model can have come to stand there.
        std::ptr::eq(self.0.as_ptr(), Arc::as_ptr(&model.0))
    }
}
