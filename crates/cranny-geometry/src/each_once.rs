//! Lists as sets: sorted, and nothing twice.
//!
//! No source. Cost: O(n log n); a list that is given as such keeps its memory.

/// Some things in ascending order, each once.
pub fn each_once<T: Ord>(things: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut things: Vec<T> = things.into_iter().collect();
    things.sort_unstable();
    things.dedup();
    things
}
