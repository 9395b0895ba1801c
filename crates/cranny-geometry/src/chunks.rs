//! Parts of a mesh's faces or vertices of which something is kept, so that what has moved touches
//! few of them.
//!
//! No source: this crate's own. Cost: O(moved).

use std::ops::Range;

/// Faces or vertices in a chunk. Fewer, and there is more to add up or compare; more, and more are
/// looked at again for each one that has moved.
pub(crate) const CHUNK: usize = 128;

/// The chunks, by number, in which some of `count` have `moved` (ascending), each with the range
/// that it is.
pub(crate) fn touched(
    moved: impl Iterator<Item = usize>,
    count: usize,
) -> impl Iterator<Item = (usize, Range<usize>)> {
    let mut last = None;
    let chunks = moved.map(|i| i / CHUNK).filter(move |&chunk| last.replace(chunk) != Some(chunk));
    chunks.map(move |chunk| (chunk, CHUNK * chunk..(CHUNK * (chunk + 1)).min(count)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_chunk_is_told_once_and_ends_where_all_do() {
        let moved = [3, 5, CHUNK - 1, 2 * CHUNK, 2 * CHUNK + 9];
        let found: Vec<_> = touched(moved.into_iter(), 2 * CHUNK + 10).collect();
        assert_eq!(found, [(0, 0..CHUNK), (2, 2 * CHUNK..2 * CHUNK + 10)]);
        assert_eq!(touched(std::iter::empty(), 7).count(), 0);
    }
}
