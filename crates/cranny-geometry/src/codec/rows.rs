//! Rows that were read: who owns what, and that nobody owns it twice.

use super::{Flaw, check};
use crate::rows::NOBODY;

/// Whether starts of rows, as many as rows and one more, cover `count` members in order.
pub(crate) fn check_rows(starts: &[u32], rows: usize, count: usize) -> Result<(), Flaw> {
    check(starts.len() == rows + 1, "there are too many or too few rows")?;
    check(starts[0] == 0, "the first row does not begin at 0")?;
    check(starts[rows] as usize == count, "the last row does not end at the end")?;
    check(starts.is_sorted(), "rows overlap")
}

/// Of each of `count` things the row that names it, or [`NOBODY`]; none may be named twice. There
/// are `rows` rows, given by their starts and one more, and each ascends.
pub(crate) fn owners_of_rows(
    starts: &[u32],
    rows: usize,
    members: &[u32],
    count: usize,
) -> Result<Vec<u32>, Flaw> {
    check_rows(starts, rows, members.len())?;
    let mut owners = vec![NOBODY; count];
    let (mut is_there, mut is_ascending, mut from) = (true, true, 0);
    for (row, &end) in (0..).zip(&starts[1..]) {
        // One more than the member before.
        let mut least = 0;
        for &member in &members[from as usize..end as usize] {
            is_ascending &= member >= least;
            least = member.wrapping_add(1);
            match owners.get_mut(member as usize) {
                Some(owner) => *owner = row,
                None => is_there = false,
            }
        }
        from = end;
    }
    check(is_ascending, "a row is not ascending")?;
    check(is_there, "a row names what is not there")?;
    let owned = owners.iter().filter(|&&owner| owner != NOBODY).count();
    check(owned == members.len(), "rows name something twice")?;
    Ok(owners)
}

/// That as many members as there are things name each of them once.
pub(crate) fn check_each_once(
    members: impl ExactSizeIterator<Item = u32>,
    count: usize,
) -> Result<(), Flaw> {
    check(members.len() == count, "too many or too few are named")?;
    let mut is_named = vec![0u8; count];
    let mut is_there = true;
    for member in members {
        match is_named.get_mut(member as usize) {
            Some(own) => *own = 1,
            None => is_there = false,
        }
    }
    check(is_there, "a row names what is not there")?;
    // As many were named as there are.
    check(is_named.iter().fold(1, |all, own| all & own) == 1, "rows name something twice")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_named_once() {
        let owned = |starts: &[u32], members: &[u32]| {
            owners_of_rows(starts, starts.len() - 1, members, 5).ok()
        };
        assert_eq!(owned(&[0], &[]), Some(vec![NOBODY; 5]));
        assert_eq!(owned(&[0, 2, 2, 3], &[0, 4, 3]), Some(vec![0, NOBODY, NOBODY, 2, 0]));
        for wrong in [&[1, 2, 2][..], &[0, 5, 4], &[0, 1, u32::MAX]] {
            assert_eq!(owned(&[0, 2, 3], wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn rows_ascend_each_by_itself() {
        let ascend = |starts: &[u32], members: &[u32]| {
            owners_of_rows(starts, starts.len() - 1, members, 8).is_ok()
        };
        assert!(ascend(&[0], &[]) && ascend(&[0, 0], &[]) && ascend(&[0, 1], &[7]));
        assert!(ascend(&[0, 2, 2, 2, 4], &[3, 5, 1, 4]) && ascend(&[0, 1, 2], &[1, 2]));
        assert!(!ascend(&[0, 4], &[3, 5, 1, 4]) && !ascend(&[0, 3, 4], &[3, 5, 1, 4]));
        assert!(!ascend(&[0, 2], &[3, 3]) && !ascend(&[0, 0, 3], &[2, 3, 1]));
        assert!(!ascend(&[0, 1], &[8]) && !ascend(&[0, 2], &[7, u32::MAX]));
        assert_eq!(owners_of_rows(&[0, 0, 2], 2, &[0, 2], 3).ok(), Some(vec![1, NOBODY, 1]));
    }

    #[test]
    fn rows_cover_all() {
        assert!(check_rows(&[0, 2, 2, 3], 3, 3).is_ok());
        for wrong in [&[0, 2, 3][..], &[1, 2, 2, 3], &[0, 2, 2, 2], &[0, 3, 2, 3]] {
            assert!(check_rows(wrong, 3, 3).is_err(), "{wrong:?}");
        }
    }
}
