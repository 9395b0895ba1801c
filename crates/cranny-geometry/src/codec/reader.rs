//! Bytes in: never more than there are.

use super::{Coded, Flaw, Plain, check};

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

    /// The bytes of a list whose items have `size` bytes: as many as are said to be there, if they are.
    fn list_bytes(&mut self, size: usize) -> Result<&'a [u8], Flaw> {
        let count: u64 = self.one()?;
        let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
        self.take(bytes.ok_or("a list is longer than memory")?)
    }

    /// A list.
    pub(crate) fn list<T: Plain>(&mut self) -> Result<Vec<T>, Flaw> {
        Ok(self.list_bytes(T::SIZE)?.chunks_exact(T::SIZE).map(T::get).collect())
    }

    /// A list of variants.
    pub(crate) fn codes<T: Coded>(&mut self) -> Result<Vec<T>, Flaw> {
        let codes = self.list_bytes(1)?;
        let all: Option<Vec<T>> = codes.iter().map(|&code| T::of_code(code)).collect();
        Ok(all.ok_or("a byte stands for nothing known")?)
    }

    /// One variant.
    pub(crate) fn code<T: Coded>(&mut self) -> Result<T, Flaw> {
        Ok(T::of_code(self.one()?).ok_or("a byte stands for nothing known")?)
    }

    /// The section that comes next, by its tag.
    pub(crate) fn section(&mut self, tag: [u8; 4]) -> Result<Self, Flaw> {
        let found: [u8; 4] = self.one()?;
        check(found == tag, "another section stands in its place")?;
        Ok(Self::new(self.list_bytes(1)?))
    }

    /// That nothing is left.
    pub(crate) fn end(&self) -> Result<(), Flaw> {
        check(self.rest.is_empty(), "something follows its end")
    }
}
