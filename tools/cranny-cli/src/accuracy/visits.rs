//! Which poses a method answers at: all of interest, or as many as there is time for.
//!
//! One that keeps no memory is queried at poses that are evenly spread. One that does must see the
//! motion as it is: it is queried at stretches of consecutive poses, evenly spread, and led into
//! each by the poses before.

/// Poses of a stretch that are reported. Fewer: more of the time goes into leading in; more: fewer
/// places of the motion are seen.
const STRETCH: usize = 8;

/// Poses that lead into a stretch: one to which memory has come from afar, one to which it has
/// followed.
const LEAD: usize = 2;

/// A pose that a method answers at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Visit {
    pub(super) pose: usize,
    /// Whether it is reported, or leads to one that is.
    pub(super) counts: bool,
}

/// Visits of `candidates`, ascending poses, of which so many can be afforded.
pub(super) fn visits(candidates: &[usize], warm: bool, affordable: usize) -> Vec<Visit> {
    let all = candidates.len();
    if affordable >= all {
        return led(candidates.iter().copied(), warm);
    }
    if !warm {
        return led(centers(all, affordable.max(1)).map(|i| candidates[i]), false);
    }
    let length = affordable.saturating_sub(LEAD).clamp(1, STRETCH.min(all));
    let stretches = (affordable / (length + LEAD)).max(1);
    let mut chosen: Vec<usize> = centers(all - length + 1, stretches)
        .flat_map(|start| start..start + length)
        .map(|i| candidates[i])
        .collect();
    chosen.sort_unstable();
    chosen.dedup();
    led(chosen.into_iter(), true)
}

/// The middles of so many equal parts of `0..all`.
pub(super) fn centers(all: usize, parts: usize) -> impl Iterator<Item = usize> {
    let parts = parts.clamp(1, all.max(1));
    (0..parts).map(move |i| (2 * i + 1) * all / (2 * parts))
}

fn led(chosen: impl Iterator<Item = usize>, warm: bool) -> Vec<Visit> {
    let mut visits = Vec::new();
    let mut next = 0;
    for pose in chosen {
        let lead = if warm { LEAD } else { 0 };
        let before = next.max(pose.saturating_sub(lead))..pose;
        visits.extend(before.map(|pose| Visit { pose, counts: false }));
        visits.push(Visit { pose, counts: true });
        next = pose + 1;
    }
    visits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poses(visits: &[Visit], counts: bool) -> Vec<usize> {
        visits.iter().filter(|visit| visit.counts == counts).map(|visit| visit.pose).collect()
    }

    #[test]
    fn all_are_visited_where_there_is_time() {
        let all: Vec<usize> = (0..50).collect();
        for warm in [false, true] {
            let visits = visits(&all, warm, 50);
            assert_eq!((poses(&visits, true), poses(&visits, false)), (all.clone(), vec![]));
        }
    }

    #[test]
    fn without_memory_some_are_visited_evenly_spread() {
        let all: Vec<usize> = (0..100).collect();
        assert_eq!(poses(&visits(&all, false, 4), true), [12, 37, 62, 87]);
        assert_eq!(poses(&visits(&all, false, 0), true), [50]);
    }

    #[test]
    fn memory_sees_the_motion_step_by_step() {
        let all: Vec<usize> = (0..300).collect();
        let visits = visits(&all, true, 30);
        assert!(visits.len() <= 30, "{visits:?}");
        assert_eq!((poses(&visits, true).len(), poses(&visits, false).len()), (24, 6));
        // Each pose reported was come to from the one before.
        for pair in visits.windows(2).filter(|pair| pair[1].counts) {
            assert_eq!(pair[1].pose, pair[0].pose + 1, "{visits:?}");
        }
        assert!(!visits[0].counts);
    }

    #[test]
    fn what_is_of_interest_is_led_to_and_nothing_else_visited() {
        let visits_of = visits(&[0, 1, 10, 11, 13], true, 99);
        assert_eq!(poses(&visits_of, false), [8, 9, 12]);
        assert_eq!(poses(&visits_of, true), [0, 1, 10, 11, 13]);
        assert_eq!(poses(&visits(&[7], true, 0), true), [7]);
        assert!(visits(&[], true, 5).is_empty() && visits(&[], false, 0).is_empty());
        // More stretches than fit beside each other are all poses, each once.
        let crowded = visits(&(0..11).collect::<Vec<_>>(), true, 10);
        assert_eq!(poses(&crowded, true).len(), 8);
    }
}
