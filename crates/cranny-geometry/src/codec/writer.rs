//! Bytes out.

use super::Plain;

/// A growing file.
#[derive(Debug, Default)]
pub(crate) struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// One thing.
    pub(crate) fn one<T: Plain>(&mut self, item: T) {
        item.put(&mut self.bytes);
    }

    /// A list: how many, then each.
    pub(crate) fn list<T: Plain>(&mut self, items: &[T]) {
        self.items(items.len(), items.iter().copied());
    }

    /// A list of `count` things that are made while they are written.
    pub(crate) fn items<T: Plain>(&mut self, count: usize, items: impl Iterator<Item = T>) {
        self.one(count as u64);
        self.bytes.reserve(count * T::SIZE);
        items.for_each(|item| item.put(&mut self.bytes));
    }

    /// A section: tag, length of the body, body.
    pub(crate) fn section(&mut self, tag: [u8; 4], body: impl FnOnce(&mut Self)) {
        self.one(tag);
        let place = self.bytes.len();
        self.one(0u64);
        body(self);
        let length = (self.bytes.len() - place - 8) as u64;
        self.bytes[place..place + 8].copy_from_slice(&length.to_le_bytes());
    }

    /// All that was written.
    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}
