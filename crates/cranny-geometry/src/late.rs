//! Parts of a model that are made when somebody first asks for them.
//!
//! Some follow from what was read, and few ask for them: to read and check them, or to make them while loading,
//! would be time that most never get back. So they are made of the rest at the first question, as building makes
//! them. `OnceLock` sees to it that threads which ask at once get the same; it is a field of its owner, nothing
//! is shared beyond that.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

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

    /// Takes it out; made now, if it is not there.
    pub(crate) fn into_made(self, make: impl FnOnce() -> T) -> T {
        self.0.into_inner().unwrap_or_else(make)
    }
}

/// Something that was read folded, as it stands in a file, and is unfolded at the first question.
///
/// What is folded was checked when it was read: unfolding cannot fail. It may take what it keeps out, and the rest is
/// given up then, so that nothing is kept twice.
#[derive(Debug)]
pub(crate) struct Unfolding<F, T> {
    made: OnceLock<T>,
    /// Empty once it is unfolded. Whoever unfolds or copies holds it meanwhile.
    folded: Mutex<F>,
}

impl<F: Default, T> Default for Unfolding<F, T> {
    fn default() -> Self {
        Self::folded(F::default())
    }
}

impl<F: Default + Clone, T: Clone> Clone for Unfolding<F, T> {
    fn clone(&self) -> Self {
        let folded = self.lock();
        Self { made: self.made.clone(), folded: Mutex::new(folded.clone()) }
    }
}

impl<F: Default, T> Unfolding<F, T> {
    pub(crate) fn folded(folded: F) -> Self {
        Self { made: OnceLock::new(), folded: Mutex::new(folded) }
    }

    pub(crate) fn made(value: T) -> Self {
        Self { made: OnceLock::from(value), folded: Mutex::default() }
    }

    /// Unfolded; now, if it is not yet.
    #[inline]
    pub(crate) fn get(&self, unfold: impl FnOnce(&mut F) -> T) -> &T {
        self.made.get().unwrap_or_else(|| self.unfolded(unfold))
    }

    #[cold]
    fn unfolded(&self, unfold: impl FnOnce(&mut F) -> T) -> &T {
        let mut folded = self.lock();
        let made = self.made.get_or_init(|| unfold(&mut folded));
        *folded = F::default();
        drop(folded);
        made
    }

    /// Takes it out, unfolded; now, if it is not yet.
    pub(crate) fn into_made(self, unfold: impl FnOnce(&mut F) -> T) -> T {
        let mut folded = self.folded.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.made.into_inner().unwrap_or_else(|| unfold(&mut folded))
    }

    fn lock(&self) -> MutexGuard<'_, F> {
        self.folded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_is_folded_or_unfolded_as_what_it_was_copied_from() {
        let unfold = |folded: &mut Vec<u32>| folded.iter().map(|x| 2 * x).collect::<Vec<u32>>();
        let filed = Unfolding::<Vec<u32>, Vec<u32>>::folded(vec![1, 2, 3]);
        let early = filed.clone();
        assert_eq!(filed.get(unfold), &[2, 4, 6]);
        // Not kept twice, and not unfolded twice.
        assert!(filed.lock().is_empty());
        assert_eq!(filed.get(|_| Vec::new()), &[2, 4, 6]);
        let late = filed.clone();
        assert_eq!(late.get(unfold), &[2, 4, 6]);
        assert_eq!(early.get(unfold), &[2, 4, 6]);
        assert_eq!(filed.into_made(unfold), [2, 4, 6]);
        assert_eq!(Unfolding::folded(vec![4]).into_made(unfold), [8]);
    }

    #[test]
    fn a_copy_taken_while_another_thread_unfolds_waits_for_it() {
        let filed = Unfolding::<Vec<u32>, Vec<u32>>::folded(vec![1, 2, 3]);
        let (begin, has_begun) = std::sync::mpsc::channel();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                filed.get(|folded| {
                    let made = std::mem::take(folded);
                    begin.send(()).unwrap();
                    std::thread::yield_now();
                    made
                })
            });
            has_begun.recv().unwrap();
            // Nothing is folded any more, and nothing may be there yet.
            let copy = filed.clone();
            assert_eq!(copy.get(|_| Vec::new()), &[1, 2, 3]);
        });
    }
}
