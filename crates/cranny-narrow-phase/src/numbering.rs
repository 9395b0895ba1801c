//! Numbers for keys, by the order in which they are first named.
//!
//! What few features of large meshes a query comes across gets numbers of its own, so that what is
//! known of them stands in arrays as long as they are many. Open addressing; no order but that of
//! the numbers is ever read, so the scatter of keys cannot show in an answer.

/// A slot without a key.
const EMPTY: u32 = u32::MAX;

/// Spreads keys that differ in few bits (Knuth 1973, section 6.4: 2^64 over the golden ratio).
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// Keys that have been named, and their numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbering {
    /// Keys and numbers, a power of two of them, at most half of them taken.
    slots: Vec<(u64, u32)>,
    len: u32,
}

impl Numbering {
    /// With room for so many keys.
    pub(crate) fn for_keys(count: usize) -> Self {
        let size = (2 * count + 2).next_power_of_two();
        Self { slots: vec![(0, EMPTY); size], len: 0 }
    }

    /// The number of a key, and whether it was named for the first time: it then is the number of
    /// keys named before.
    #[inline]
    pub(crate) fn number(&mut self, key: u64) -> (u32, bool) {
        if 2 * (self.len as usize + 1) > self.slots.len() {
            self.grow();
        }
        let at = self.slot_of(key);
        let (_, number) = self.slots[at];
        if number != EMPTY {
            return (number, false);
        }
        self.slots[at] = (key, self.len);
        self.len += 1;
        (self.len - 1, true)
    }

    /// The number of a key that was named.
    #[inline]
    pub(crate) fn get(&self, key: u64) -> Option<u32> {
        if self.slots.is_empty() {
            return None;
        }
        let (_, number) = self.slots[self.slot_of(key)];
        (number != EMPTY).then_some(number)
    }

    /// The slot that holds a key, or the empty one where it belongs.
    #[inline]
    fn slot_of(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = (key.wrapping_mul(SPREAD) >> 32) as usize & mask;
        while self.slots[at].1 != EMPTY && self.slots[at].0 != key {
            at = (at + 1) & mask;
        }
        at
    }

    #[cold]
    fn grow(&mut self) {
        let size = (2 * self.slots.len()).max(64);
        let old = std::mem::replace(&mut self.slots, vec![(0, EMPTY); size]);
        for (key, number) in old.into_iter().filter(|slot| slot.1 != EMPTY) {
            let at = self.slot_of(key);
            self.slots[at] = (key, number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_numbered_as_they_come() {
        let mut numbering = Numbering::default();
        assert_eq!(numbering.get(7), None);
        let keys = [7, 0, u64::MAX, 1 << 40, 2 << 40];
        for (i, key) in (0..).zip(keys) {
            assert_eq!(numbering.number(key), (i, true));
            assert_eq!(numbering.number(key), (i, false));
        }
        // Far more than fit at first, many of them sharing their slot's bits.
        for i in 0..5_000u64 {
            assert_eq!(numbering.number((i << 45) | 3), (i as u32 + 5, true));
        }
        assert!(keys.iter().zip(0..).all(|(&key, i)| numbering.get(key) == Some(i)));
        assert_eq!(numbering.get((4_999 << 45) | 3), Some(5_004));
        assert_eq!(numbering.get((5_000 << 45) | 3), None);
    }
}
