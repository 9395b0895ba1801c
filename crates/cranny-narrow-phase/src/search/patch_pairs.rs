//! Candidates by pairs of patches.

use cranny_geometry::PatchId;

use super::features::Candidate;
use crate::numbering::Numbering;

/// Pairs of patches, numbered as they come, and how many candidates each has.
#[derive(Debug, Default)]
pub(crate) struct PatchPairs {
    numbering: Numbering,
    all: Vec<([PatchId; 2], u32)>,
    /// The number that was given last: mostly the next is the same.
    last: u32,
}

impl PatchPairs {
    /// The number of the patches of one candidate more.
    #[inline]
    pub(super) fn one_more(&mut self, patches: [PatchId; 2]) -> u32 {
        if self.all.get(self.last as usize).is_none_or(|(last, _)| *last != patches) {
            let key = u64::from(patches[0].0) << 32 | u64::from(patches[1].0);
            let (number, is_new) = self.numbering.number(key);
            if is_new {
                self.all.push((patches, 0));
            }
            self.last = number;
        }
        self.all[self.last as usize].1 += 1;
        self.last
    }

    /// Puts candidates of the same patches side by side, by ascending patches; returns the patches,
    /// each with the end of its candidates.
    ///
    /// Cost: linear in the candidates, each of which moves to its place once; no memory but a
    /// number for each pair of patches.
    pub(crate) fn gather(&self, candidates: &mut [Candidate]) -> Vec<([PatchId; 2], u32)> {
        let mut order: Vec<u32> = (0..self.all.len() as u32).collect();
        order.sort_unstable_by_key(|&pair| self.all[pair as usize].0);
        let mut next = vec![0; self.all.len()];
        let mut ends = Vec::with_capacity(order.len());
        let mut end = 0;
        for &pair in &order {
            let (patches, count) = self.all[pair as usize];
            next[pair as usize] = end;
            end += count;
            ends.push((patches, end));
        }
        for (&pair, &(_, end)) in order.iter().zip(&ends) {
            while next[pair as usize] < end {
                let at = next[pair as usize];
                let home = candidates[at as usize].patches;
                if home != pair {
                    candidates.swap(at as usize, next[home as usize] as usize);
                }
                next[home as usize] += 1;
            }
        }
        ends
    }
}
