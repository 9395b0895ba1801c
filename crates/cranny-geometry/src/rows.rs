//! Compressed rows: the members of each owner, one owner behind the other.
//!
//! Source: they are filled by counting (Knuth 1973, section 5.2). Cost: O(n).

/// In a list of owners: nobody.
pub(crate) const NOBODY: u32 = u32::MAX;

/// Where the row of each of `count` owners begins, and one more, where the last ends; and the members,
/// ascending within each row. `owners` names the owner of each member; those of [`NOBODY`] are left out.
///
/// While the owner stays the same, as it often does, its count and place stay in registers: from one member to
/// the next they would have to come back from memory. O(n).
pub(crate) fn rows(owners: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_stand_by_owner_ascending() {
        let (starts, members) = rows(&[2, 2, NOBODY, 0, 2, 0, 0], 4);
        assert_eq!((starts, members), (vec![0, 3, 3, 6, 6], vec![3, 5, 6, 0, 1, 4]));
        assert_eq!(rows(&[], 0), (vec![0], vec![]));
        assert_eq!(rows(&[NOBODY; 2], 1), (vec![0, 0], vec![]));
    }
}
