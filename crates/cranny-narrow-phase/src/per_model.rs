//! One value for the model of each body of a pair, made once where both bodies have one model.

use std::sync::Arc;

use crate::pair::{Pair, Side};

/// One value for the model of each body; bodies of one model share it, and so do clones.
#[derive(Debug)]
pub struct PerModel<T>([Arc<T>; 2]);

impl<T> Clone for PerModel<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<T> PerModel<T> {
    /// Makes the value of each model; calls `make` for the first alone where both bodies have the
    /// [same](cranny_geometry::Model::is_same) model.
    pub fn of(pair: &Pair, make: impl Fn(Side) -> T) -> Self {
        let [a, b] = pair.models();
        let first = Arc::new(make(Side::First));
        let second = match a.is_same(b) {
            true => Arc::clone(&first),
            false => Arc::new(make(Side::Second)),
        };
        Self([first, second])
    }

    /// The values of the first body's model and of the second's.
    #[must_use]
    pub fn both(&self) -> [&T; 2] {
        [&self.0[0], &self.0[1]]
    }

    /// How many values there are: 1 or 2.
    #[must_use]
    pub fn count(&self) -> usize {
        if Arc::ptr_eq(&self.0[0], &self.0[1]) { 1 } else { 2 }
    }

    /// Sum of the heap bytes of each value, a shared one counted once.
    pub fn bytes(&self, bytes: impl Fn(&T) -> usize) -> usize {
        self.0[..self.count()].iter().map(|value| bytes(value)).sum()
    }
}
