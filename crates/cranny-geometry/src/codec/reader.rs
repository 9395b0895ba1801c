//! Bytes in: never more than there are.

use super::{Flaw, Plain, check};

/// What remains of a file or a section.
#[derive(Clone, Debug)]
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Flaw> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or("it ends too early")?;
        self.rest = rest;
        Ok(taken)
    }

    /// One thing.
    pub(crate) fn one<T: Plain>(&mut self) -> Result<T, Flaw> {
        self.take(T::SIZE).map(T::get)
    }

    /// The bytes of `count` items of `size` bytes, if they are there.
    fn bytes_of(&mut self, count: u64, size: usize) -> Result<&'a [u8], Flaw> {
        let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
        self.take(bytes.ok_or("a list is longer than memory")?)
    }

    /// A list: how many, then each.
    pub(crate) fn list<T: Plain>(&mut self) -> Result<Vec<T>, Flaw> {
        let count = self.one()?;
        self.items(count)
    }

    /// As many things as are said to follow, if they do.
    pub(crate) fn items<T: Plain>(&mut self, count: u64) -> Result<Vec<T>, Flaw> {
        Ok(T::get_all(self.bytes_of(count, T::SIZE)?))
    }

    /// The section that comes next, by its tag.
    pub(crate) fn section(&mut self, tag: [u8; 4]) -> Result<Self, Flaw> {
        let found: [u8; 4] = self.one()?;
        check(found == tag, "another section stands in its place")?;
        let length = self.one()?;
        Ok(Self::new(self.bytes_of(length, 1)?))
    }

    /// That nothing is left.
    pub(crate) fn end(&self) -> Result<(), Flaw> {
        check(self.rest.is_empty(), "something follows its end")
    }
}
