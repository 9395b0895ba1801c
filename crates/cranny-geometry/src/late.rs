//! Parts of a model that are made when somebody first asks for them.
//!
//! Some follow from what was read, and few ask for them: to read and check them, or to make them while loading,
//! would be time that most never get back. So they are made of the rest at the first question, as building makes
//! them. `OnceLock` sees to it that threads which ask at once get the same; it is a field of its owner, nothing
//! is shared beyond that.

use std::sync::OnceLock;

/// Something that is there, or will be once it is asked for.
#[derive(Clone, Debug)]
pub(crate) struct Late<T>(OnceLock<T>);

/// Not there yet.
impl<T> Default for Late<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> Late<T> {
    /// What is there already.
    pub(crate) fn made(value: T) -> Self {
        Self(OnceLock::from(value))
    }

    /// What is there; made now, if it is not. `make` must give the same whenever it is called.
    pub(crate) fn get(&self, make: impl FnOnce() -> T) -> &T {
        self.0.get_or_init(make)
    }

    /// What is there, if it is.
    pub(crate) fn if_made(&self) -> Option<&T> {
        self.0.get()
    }

    /// Takes it out, if it is there.
    pub(crate) fn if_taken(self) -> Option<T> {
        self.0.into_inner()
    }

    /// Takes it out; made now, if it is not there.
    pub(crate) fn into_made(self, make: impl FnOnce() -> T) -> T {
        self.0.into_inner().unwrap_or_else(make)
    }
}
