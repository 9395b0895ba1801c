//! Which faces hang together. Source and cost stand with [`DisjointSets`].

use crate::codec::{Flaw, check};
use crate::ids::{ComponentId, FaceId};

/// Faces that hang together over edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Component {
    /// Its least face.
    pub first_face: FaceId,
    /// Number of faces.
    pub faces: u32,
    /// Every edge is balanced: the component bounds a region of space.
    pub closed: bool,
}

/// Numbers the sets of faces that hang together, by their least members; all closed, for now. Where
/// there is one, no face is listed with its own.
pub(super) fn components(sets: &DisjointSets) -> (Vec<ComponentId>, Vec<Component>) {
    let mut components: Vec<Component> = Vec::new();
    let mut component_of: Vec<ComponentId> = Vec::with_capacity(sets.0.len());
    for (face, &before) in (0..).map(FaceId).zip(&sets.0) {
        let component = component_of.get(before as usize).copied().unwrap_or_else(|| {
            components.push(Component { first_face: face, faces: 0, closed: true });
            ComponentId(components.len() as u32 - 1)
        });
        component_of.push(component);
    }
    for run in component_of.chunk_by(|a, b| a == b) {
        components[run[0].index()].faces += run.len() as u32;
    }
    let is_one = components.len() == 1;
    (if is_one { Vec::new() } else { component_of }, components)
}

/// The same from the components of faces in a row, each with its number of faces.
pub(super) fn components_of_runs(
    runs: &[[u32; 2]],
    faces: usize,
) -> Result<(Vec<ComponentId>, Vec<Component>), Flaw> {
    let total: u64 = runs.iter().map(|&[_, count]| u64::from(count)).sum();
    check(total == faces as u64, "components hold too many or too few faces")?;
    let is_apart = |a: &[u32; 2], b: &[u32; 2]| a[0] != b[0];
    let is_whole = runs.is_sorted_by(is_apart) && runs.iter().all(|&[_, count]| count > 0);
    check(is_whole, "faces of a component are not listed together")?;
    if let &[[0, count]] = runs {
        let one = Component { first_face: FaceId(0), faces: count, closed: true };
        return Ok((Vec::new(), vec![one]));
    }
    let mut components: Vec<Component> = Vec::new();
    let mut component_of: Vec<ComponentId> = Vec::with_capacity(faces);
    for &[component, count] in runs {
        if component as usize == components.len() {
            let first_face = FaceId(component_of.len() as u32);
            components.push(Component { first_face, faces: 0, closed: true });
        }
        let own = components.get_mut(component as usize);
        own.ok_or("components are not in order")?.faces += count;
        component_of.resize(component_of.len() + count as usize, ComponentId(component));
    }
    Ok((component_of, components))
}

/// Union–find with path halving; the representative of a set is its least member, and each member
/// but that leads to a lesser one.
///
/// Source: Tarjan and van Leeuwen (1984, "Worst-case analysis of set union algorithms"). Cost:
/// O(log n) a call at most, on average over all calls: sets are joined by number, not by rank.
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// `count` sets of one member each.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The least member of the set of `i < count`.
    pub fn find(&mut self, mut i: usize) -> usize {
        while self.0[i] as usize != i {
            let parent = self.0[i] as usize;
            self.0[i] = self.0[parent];
            i = self.0[i] as usize;
        }
        i
    }

    /// Makes one set of the sets of `i` and `j`.
    #[inline]
    pub fn union(&mut self, i: usize, j: usize) {
        // As often as not, it is one already.
        if self.0[i] == self.0[j] {
            return;
        }
        let (i, j) = (self.find(i), self.find(j));
        self.0[i.max(j)] = i.min(j) as u32;
    }

    /// The number of each member's set, from 0 by their least members, and how many sets there are.
    #[must_use]
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut count = 0;
        let mut numbers: Vec<u32> = Vec::with_capacity(self.0.len());
        for member in 0..self.0.len() {
            // Of a set's least member there is no number yet.
            let known = numbers.get(self.find(member)).copied();
            numbers.push(known.unwrap_or(count));
            count += u32::from(known.is_none());
        }
        (numbers, count as usize)
    }

    /// The members of each set, ascending; the sets by their least members.
    #[must_use]
    pub fn groups(self) -> Vec<Vec<usize>> {
        let (numbers, count) = self.numbered();
        let mut groups = vec![Vec::new(); count];
        for (member, group) in numbers.into_iter().enumerate() {
            groups[group as usize].push(member);
        }
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_numbered_by_their_least_members() {
        let mut sets = DisjointSets::new(7);
        for [i, j] in [[6, 2], [5, 1], [2, 4], [4, 6]] {
            sets.union(i, j);
        }
        assert_eq!(sets.clone().numbered(), (vec![0, 1, 2, 3, 2, 1, 2], 4));
        assert_eq!(sets.groups(), [vec![0], vec![1, 5], vec![2, 4, 6], vec![3]]);
        assert_eq!(DisjointSets::new(0).numbered(), (vec![], 0));
    }

    #[test]
    fn components_are_read_from_runs_or_refused() {
        let read = |runs: &[[u32; 2]]| components_of_runs(runs, 6).map_err(|Flaw(what)| what);
        let (of_faces, all) = read(&[[0, 1], [1, 2], [0, 1], [2, 2]]).unwrap();
        assert_eq!(of_faces, [0, 1, 1, 0, 2, 2].map(ComponentId));
        let found: Vec<_> = all.iter().map(|c| (c.first_face.0, c.faces)).collect();
        assert_eq!(found, [(0, 2), (1, 2), (4, 2)]);
        for (runs, flaw) in [
            (&[[0, 5]][..], "too few"),
            (&[[0, 3], [1, u32::MAX]], "too many"),
            (&[[0, 3], [0, 3]], "not listed together"),
            (&[[0, 6], [1, 0]], "not listed together"),
            (&[[1, 6]], "not in order"),
            (&[[0, 3], [2, 3]], "not in order"),
        ] {
            let error = read(runs).unwrap_err();
            assert!(error.contains(flaw), "{runs:?}: {error}");
        }
    }
}
