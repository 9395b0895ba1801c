//! Compressed rows: the members of each owner, one owner behind the other.
//!
//! Source: they are filled by counting (Knuth 1973, section 5.2). Cost: O(n). Where few rows
//! change, the others are copied in one piece between them.

use std::collections::BTreeMap;
use std::ops::Range;

/// In a list of owners: nobody.
pub const NOBODY: u32 = u32::MAX;

/// Where the members of row `i` stand, given where rows begin.
#[inline]
pub fn row(starts: &[u32], i: usize) -> Range<usize> {
    starts[i] as usize..starts[i + 1] as usize
}

/// Where the row of each of `count` owners begins, and one more, where the last ends; and the
/// members, ascending within each row. `owners` names the owner of each member; those of [`NOBODY`]
/// are left out.
///
/// While the owner stays the same, as it often does, its count and place stay in registers: from
/// one member to the next they would have to come back from memory. O(n).
pub fn rows(owners: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; count + 1];
    for run in owners.chunk_by(|a, b| a == b).filter(|run| run[0] != NOBODY) {
        starts[run[0] as usize + 1] += run.len() as u32;
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut members = vec![0; starts[count] as usize];
    let mut fill = starts.clone();
    let (mut current, mut place) = (NOBODY, 0);
    for (member, &owner) in (0..).zip(owners).filter(|&(_, &owner)| owner != NOBODY) {
        if owner != current {
            if let Some(left) = fill.get_mut(current as usize) {
                *left = place;
            }
            (current, place) = (owner, fill[owner as usize]);
        }
        members[place as usize] = member;
        place += 1;
    }
    (starts, members)
}

/// A part of rows that are put together from others.
pub(crate) enum Piece<'a, T> {
    /// These of the rows before.
    Kept(Range<usize>),
    /// A row that is new.
    New(&'a [T]),
}

/// Rows put together from pieces of some, whose members become what `map` says. Cost: copying.
pub(crate) fn joined<'a, T: Copy + 'a>(
    starts: &[u32],
    members: &[T],
    pieces: impl Iterator<Item = Piece<'a, T>>,
    map: impl Fn(T) -> T,
) -> (Vec<u32>, Vec<T>) {
    let mut new_starts = Vec::with_capacity(starts.len() + 1);
    let mut new_members = Vec::with_capacity(members.len() + 1);
    new_starts.push(0);
    for piece in pieces {
        let end = new_members.len() as u32;
        match piece {
            Piece::Kept(rows) => {
                let first = starts[rows.start];
                let shifted = starts[rows.start + 1..=rows.end].iter().map(|s| s - first + end);
                new_starts.extend(shifted);
                let row = first as usize..starts[rows.end] as usize;
                new_members.extend(members[row].iter().map(|&m| map(m)));
            }
            Piece::New(row) => {
                new_members.extend_from_slice(row);
                new_starts.push(new_members.len() as u32);
            }
        }
    }
    (new_starts, new_members)
}

/// The first `count` rows, those in `changed` being others; rows beyond those before must be among
/// them.
pub fn replaced<T: Copy>(
    starts: &[u32],
    members: &[T],
    count: usize,
    changed: &BTreeMap<u32, Vec<T>>,
    map: impl Fn(T) -> T,
) -> (Vec<u32>, Vec<T>) {
    let mut pieces = Vec::new();
    let mut next = 0;
    for (&row, new) in changed.range(..count as u32) {
        pieces.push(Piece::Kept(next..row as usize));
        pieces.push(Piece::New(&new[..]));
        next = row as usize + 1;
    }
    if next < count {
        pieces.push(Piece::Kept(next..count));
    }
    pieces.retain(|piece| !matches!(piece, Piece::Kept(rows) if rows.is_empty()));
    joined(starts, members, pieces.into_iter(), map)
}

/// As [`replaced`]; where each row that is another is as long as it was, nothing is copied but
/// these.
pub(crate) fn overwritten<T: Copy>(
    starts: Vec<u32>,
    mut members: Vec<T>,
    count: usize,
    changed: &BTreeMap<u32, Vec<T>>,
) -> (Vec<u32>, Vec<T>) {
    let old = |i: u32| row(&starts, i as usize);
    let fits = |(&i, new): (&u32, &Vec<T>)| old(i).len() == new.len();
    if starts.len() != count + 1 || !changed.iter().all(fits) {
        return replaced(&starts, &members, count, changed, |m| m);
    }
    for (&i, new) in changed {
        members[old(i)].copy_from_slice(new);
    }
    (starts, members)
}

/// Compacts a list: which members move where, so that it has no gaps. Of `before` members those in
/// `free`, ascending, are gone, and `new` have been appended. The new ones, and then the last of
/// the others, take the places that are free. Pairs of places, in that order.
pub(crate) fn compaction_moves(before: u32, free: &[u32], new: &[u32]) -> Vec<(u32, u32)> {
    let count = before + new.len() as u32 - free.len() as u32;
    let others = (count..before).filter(|i| free.binary_search(i).is_err());
    let places = free.iter().copied().filter(|&i| i < count).chain(before..count);
    new.iter().copied().chain(others).zip(places).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_replaced_appended_and_cut_off() {
        let (starts, members) = (vec![0, 2, 2, 5, 6], vec![1, 2, 3, 4, 5, 6]);
        let changed = BTreeMap::from([(1, vec![7]), (2, vec![]), (4, vec![8, 9])]);
        let (s, m) = replaced(&starts, &members, 5, &changed, |m| 10 * m);
        assert_eq!((s, m), (vec![0, 2, 3, 3, 4, 6], vec![10, 20, 7, 60, 8, 9]));
        let same = BTreeMap::from([(2, vec![7, 8, 9])]);
        let (s, m) = overwritten(starts.clone(), members.clone(), 4, &same);
        assert_eq!((s, m), (starts.clone(), vec![1, 2, 7, 8, 9, 6]));
        let (s, m) = overwritten(starts.clone(), members.clone(), 5, &changed);
        assert_eq!((s, m), (vec![0, 2, 3, 3, 4, 6], vec![1, 2, 7, 6, 8, 9]));
        let (s, m) = replaced(&starts, &members, 3, &changed, |m| m);
        assert_eq!((s, m), (vec![0, 2, 3, 3], vec![1, 2, 7]));
    }

    #[test]
    fn gaps_are_filled() {
        assert_eq!(compaction_moves(5, &[1, 3], &[5, 7]), [(5, 1), (7, 3)]);
        assert_eq!(compaction_moves(5, &[1], &[6, 7]), [(6, 1), (7, 5)]);
        assert_eq!(compaction_moves(5, &[1, 4], &[5]), [(5, 1)]);
        assert_eq!(compaction_moves(5, &[0, 1, 4], &[5]), [(5, 0), (3, 1)]);
        assert_eq!(compaction_moves(5, &[0], &[]), [(4, 0)]);
    }

    #[test]
    fn members_stand_by_owner_ascending() {
        let (starts, members) = rows(&[2, 2, NOBODY, 0, 2, 0, 0], 4);
        assert_eq!((starts, members), (vec![0, 3, 3, 6, 6], vec![3, 5, 6, 0, 1, 4]));
        assert_eq!(rows(&[], 0), (vec![0], vec![]));
        assert_eq!(rows(&[NOBODY; 2], 1), (vec![0, 0], vec![]));
    }
}
