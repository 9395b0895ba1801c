//! Vertices of a hull numbered anew, after some have come and others gone.
//!
//! They are numbered by their points, so that one that comes shifts all behind it. Where none comes
//! or goes numbers stay, and nothing is copied that does not change. No source. Cost: copying, a
//! few nanoseconds a vertex.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::ids::VertexId;

/// How vertices that there were, and those that have come, are numbered.
pub(super) struct Numbering {
    /// In the new order.
    runs: Vec<Run>,
    /// Of each vertex before and each that may have come its number now; empty where all stay as
    /// they are.
    map: Vec<u32>,
    /// Number of vertices before.
    known: usize,
}

/// A part of the new order.
pub(super) enum Run {
    /// Vertices that there were, by their numbers before.
    Kept(Range<usize>),
    /// One that has come.
    Come(u32),
}

impl Numbering {
    /// Of the first `known` of `sources`, which ascend, `gone` are gone; of the others `come`, by
    /// ascending source, have come.
    pub(super) fn of(
        sources: &[VertexId],
        known: usize,
        gone: &BTreeSet<u32>,
        come: &[u32],
    ) -> Self {
        if gone.is_empty() && come.is_empty() {
            return Self { runs: vec![Run::Kept(0..known)], map: Vec::new(), known };
        }
        let place = |v: u32| sources[..known].partition_point(|s| *s < sources[v as usize]);
        let mut cuts: Vec<(usize, Option<u32>)> =
            come.iter().map(|&v| (place(v), Some(v))).collect();
        cuts.extend(gone.iter().map(|&v| (v as usize, None)));
        // One that comes stands before the one in whose place it comes; the sort is stable.
        cuts.sort_by_key(|&(at, come)| (at, come.is_none()));
        let (mut runs, mut last) = (Vec::new(), 0);
        for (at, come) in cuts {
            if last < at {
                runs.push(Run::Kept(last..at));
            }
            last = at;
            match come {
                Some(v) => runs.push(Run::Come(v)),
                None => last = at + 1,
            }
        }
        runs.push(Run::Kept(last..known));
        let mut map = vec![u32::MAX; sources.len()];
        let mut next = 0;
        for run in &runs {
            let range = run.range();
            for (new, of) in (next..).zip(&mut map[range.clone()]) {
                *of = new;
            }
            next += range.len() as u32;
        }
        Self { runs, map, known }
    }

    /// Whether all have the numbers that they had.
    pub(super) fn is_same(&self) -> bool {
        self.map.is_empty()
    }

    pub(super) fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// The number of a vertex now.
    pub(super) fn of_vertex(&self, before: u32) -> u32 {
        if self.is_same() { before } else { self.map[before as usize] }
    }

    /// Renames corners.
    pub(super) fn apply(&self, triangles: &mut [[u32; 3]]) {
        for corner in triangles.as_flattened_mut() {
            *corner = self.map[*corner as usize];
        }
    }

    /// What belongs to the vertices before, and to those that have come, in the new order.
    pub(super) fn arranged<T: Copy>(&self, mut of: Vec<T>) -> Vec<T> {
        if self.is_same() {
            of.truncate(self.known);
            return of;
        }
        let mut arranged = Vec::with_capacity(self.known + self.runs.len());
        for run in &self.runs {
            arranged.extend_from_slice(&of[run.range()]);
        }
        arranged
    }
}

impl Run {
    pub(super) fn range(&self) -> Range<usize> {
        match self {
            Self::Kept(range) => range.clone(),
            Self::Come(v) => *v as usize..*v as usize + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_that_come_stand_where_their_points_do() {
        let sources = [2, 4, 6, 8, 5, 9, 7, 1].map(VertexId);
        let numbering = Numbering::of(&sources, 4, &BTreeSet::from([1, 3]), &[7, 4, 6, 5]);
        assert_eq!(numbering.arranged(sources.to_vec()), [1, 2, 5, 6, 7, 9].map(VertexId));
        let mut triangles = [[0, 2, 4], [5, 6, 7]];
        numbering.apply(&mut triangles);
        assert_eq!(triangles, [[1, 3, 2], [5, 4, 0]]);
        assert!(!numbering.is_same());
        let same = Numbering::of(&sources, 4, &BTreeSet::new(), &[]);
        assert!(same.is_same() && same.arranged(sources.to_vec()) == sources[..4]);
    }
}
