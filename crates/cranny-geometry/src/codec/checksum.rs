//! What distinguishes a damaged file from a whole one, at the speed of memory.
//!
//! The bytes, filled up with zeros to a multiple of 64, are words of 64 bits, dealt out in turn to
//! eight lanes. A lane takes a word by exclusive or, is multiplied by [`FACTOR`] and turned by half
//! its bits; lane `i` begins with `(i + 1)` times the factor. In the end one more lane, beginning
//! with 0, takes the eight.
//!
//! Each step can be undone, so whatever happens within one word of eight bytes changes the sum for
//! certain; all else escapes notice once in 2^64. Against whoever wants to deceive it does nothing.
//!
//! No source: this crate's own, for the reason above; the factor is Knuth's (1973, section 6.4).
//! Cost: a multiplication for each word of eight bytes.

/// 2^64 divided by the golden ratio, rounded to an odd number.
const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;

const LANES: usize = 8;

/// The checksum of some bytes.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let mut lanes: [u64; LANES] = std::array::from_fn(|i| FACTOR.wrapping_mul(i as u64 + 1));
    let (blocks, rest) = bytes.as_chunks::<{ 8 * LANES }>();
    for block in blocks {
        take(&mut lanes, block);
    }
    if !rest.is_empty() {
        let mut block = [0; 8 * LANES];
        block[..rest.len()].copy_from_slice(rest);
        take(&mut lanes, &block);
    }
    lanes.into_iter().fold(0, step)
}

fn take(lanes: &mut [u64; LANES], block: &[u8; 8 * LANES]) {
    let (words, _) = block.as_chunks::<8>();
    for (lane, &word) in lanes.iter_mut().zip(words) {
        *lane = step(*lane, u64::from_le_bytes(word));
    }
}

fn step(lane: u64, word: u64) -> u64 {
    (lane ^ word).wrapping_mul(FACTOR).rotate_left(32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_counts() {
        let bytes: Vec<u8> = (0..200).map(|i| (i * i) as u8).collect();
        let sum = checksum(&bytes);
        for bit in 0..8 * bytes.len() {
            let mut other = bytes.clone();
            other[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(checksum(&other), sum, "bit {bit}");
        }
    }

    #[test]
    fn words_are_not_exchanged_unnoticed() {
        let bytes: Vec<u8> = (0..=255).collect();
        for (a, b) in [(0, 8), (0, 64), (64, 192), (8, 248)] {
            let mut other = bytes.clone();
            for i in 0..8 {
                other.swap(a + i, b + i);
            }
            assert_ne!(checksum(&other), checksum(&bytes), "words at {a} and {b}");
        }
    }

    #[test]
    fn no_bytes_leave_the_lanes_as_they_begin() {
        let lanes = (1..=8u64).map(|i| FACTOR.wrapping_mul(i));
        assert_eq!(checksum(&[]), lanes.fold(0, step));
        // Zeros that fill up are words like others: the file's length distinguishes them.
        assert_eq!(checksum(&[7]), checksum(&[7, 0]));
        assert_ne!(checksum(&[]), checksum(&[0]));
    }
}
