//! Parts of a model that are made at their first use.
//!
//! Some follow from what was read, and few callers need them: to read and check them, or to make
//! them while loading, would be time that most never get back. So they are made of the rest at
//! their first use, as building makes them. `OnceLock` sees to it that threads which come at once
//! get the same; it is a field of its owner, nothing is shared beyond that.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// Something that is there, or will be at its first use.
#[derive(Clone, Debug)]
pub(crate) struct OnDemand<T>(OnceLock<T>);

/// Not there yet.
impl<T> Default for OnDemand<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> OnDemand<T> {
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

    /// Takes it out; made now, if it is not there.
    pub(crate) fn into_made(self, make: impl FnOnce() -> T) -> T {
        self.0.into_inner().unwrap_or_else(make)
    }
}

/// Something that was read as it is stored in a file, and is rebuilt at its first use.
///
/// What is stored was checked when it was read: rebuilding cannot fail. It may take out what it
/// keeps, and the rest is given up then, so that nothing is kept twice.
#[derive(Debug)]
pub(crate) struct FromStored<F, T> {
    made: OnceLock<T>,
    /// Empty once it is rebuilt. Whoever rebuilds or copies holds it meanwhile.
    stored: Mutex<F>,
}

impl<F: Default, T> Default for FromStored<F, T> {
    fn default() -> Self {
        Self::stored(F::default())
    }
}

impl<F: Default + Clone, T: Clone> Clone for FromStored<F, T> {
    fn clone(&self) -> Self {
        let stored = self.lock();
        Self { made: self.made.clone(), stored: Mutex::new(stored.clone()) }
    }
}

impl<F: Default, T> FromStored<F, T> {
    pub(crate) fn stored(stored: F) -> Self {
        Self { made: OnceLock::new(), stored: Mutex::new(stored) }
    }

    pub(crate) fn made(value: T) -> Self {
        Self { made: OnceLock::from(value), stored: Mutex::default() }
    }

    /// Rebuilt; now, if it is not yet.
    #[inline]
    pub(crate) fn get(&self, rebuild: impl FnOnce(&mut F) -> T) -> &T {
        self.made.get().unwrap_or_else(|| self.rebuilt(rebuild))
    }

    #[cold]
    fn rebuilt(&self, rebuild: impl FnOnce(&mut F) -> T) -> &T {
        let mut stored = self.lock();
        let made = self.made.get_or_init(|| rebuild(&mut stored));
        *stored = F::default();
        drop(stored);
        made
    }

    /// Takes it out, rebuilt; now, if it is not yet.
    pub(crate) fn into_made(self, rebuild: impl FnOnce(&mut F) -> T) -> T {
        let mut stored = self.stored.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.made.into_inner().unwrap_or_else(|| rebuild(&mut stored))
    }

    fn lock(&self) -> MutexGuard<'_, F> {
        self.stored.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_is_folded_or_unfolded_as_what_it_was_copied_from() {
        let rebuild = |stored: &mut Vec<u32>| stored.iter().map(|x| 2 * x).collect::<Vec<u32>>();
        let filed = FromStored::<Vec<u32>, Vec<u32>>::stored(vec![1, 2, 3]);
        let early = filed.clone();
        assert_eq!(filed.get(rebuild), &[2, 4, 6]);
        // Not kept twice, and not rebuilt twice.
        assert!(filed.lock().is_empty());
        assert_eq!(filed.get(|_| Vec::new()), &[2, 4, 6]);
        let late = filed.clone();
        assert_eq!(late.get(rebuild), &[2, 4, 6]);
        assert_eq!(early.get(rebuild), &[2, 4, 6]);
        assert_eq!(filed.into_made(rebuild), [2, 4, 6]);
        assert_eq!(FromStored::stored(vec![4]).into_made(rebuild), [8]);
    }

    #[test]
    fn a_copy_taken_while_another_thread_unfolds_waits_for_it() {
        let filed = FromStored::<Vec<u32>, Vec<u32>>::stored(vec![1, 2, 3]);
        let (begin, has_begun) = std::sync::mpsc::channel();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                filed.get(|stored| {
                    let made = std::mem::take(stored);
                    begin.send(()).unwrap();
                    std::thread::yield_now();
                    made
                })
            });
            has_begun.recv().unwrap();
            // Nothing stored is left, and nothing may be there yet.
            let copy = filed.clone();
            assert_eq!(copy.get(|_| Vec::new()), &[1, 2, 3]);
        });
    }
}
