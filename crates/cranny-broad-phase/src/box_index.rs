//! Boxes in a tree that is built once, for questions about a place.

use std::fmt;

use cranny_exact::{Aabb, DVec3};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

use crate::box_tree::{rounded, unrounded};

/// Boxes by number, in a tree that leads to those which a region reaches. It does not follow what
/// moves: whoever moves a box builds it anew, which costs n log n.
///
/// ```
/// use cranny_broad_phase::BoxIndex;
/// use cranny_exact::{Aabb, DVec3};
///
/// let cube_at = |x: f64| Aabb { min: DVec3::new(x, 0.0, 0.0), max: DVec3::new(x + 1.0, 1.0, 1.0) };
/// let index = BoxIndex::of([cube_at(0.0), cube_at(3.0), cube_at(6.0)]);
/// let around = cube_at(2.5);
/// assert_eq!(index.reached(|held| held.overlaps(&around)).collect::<Vec<_>>(), [1]);
/// ```
#[derive(Clone, Default)]
pub struct BoxIndex {
    tree: Bvh,
    /// Of the boxes, by leaf: the tree's leaves have no gaps.
    numbers: Vec<usize>,
}

impl BoxIndex {
    /// Of boxes that are numbered from 0. A box with a face that is not a number is everywhere; one
    /// that is empty is nowhere.
    #[must_use]
    pub fn of(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let boxes = boxes.into_iter().map(everywhere_if_unknown).enumerate();
        let present = boxes.filter(|(_, aabb)| !aabb.is_empty());
        let (numbers, leaves): (Vec<usize>, Vec<_>) =
            present.map(|(number, aabb)| (number, rounded(&aabb))).unzip();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves), numbers }
    }

    /// The numbers of the boxes that a region reaches, in no particular order.
    ///
    /// `reaches` is a test of boxes: what it accepts, it accepts in any larger box too. It gets
    /// boxes in single precision, rounded outward, so a few more may be reached than it accepts
    /// among those given; none of these is left out. It may turn stricter between two numbers.
    pub fn reached<'a>(
        &'a self,
        reaches: impl Fn(&Aabb) -> bool + 'a,
    ) -> impl Iterator<Item = usize> + 'a {
        let leaves = self.tree.leaves(move |node| reaches(&unrounded(&node.aabb())));
        leaves.map(|leaf| self.numbers[leaf as usize])
    }
}

impl fmt::Debug for BoxIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BoxIndex").field("boxes", &self.numbers.len()).finish()
    }
}

fn everywhere_if_unknown(aabb: Aabb) -> Aabb {
    if aabb.min.is_nan() || aabb.max.is_nan() {
        return Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    }
    aabb
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes of all sizes, some of them beyond single precision, some unbounded.
    fn boxes() -> Vec<Aabb> {
        let mut state = 1u64;
        let mut unit = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut vector = move |size: f64| DVec3::new(unit(), unit(), unit()) * size;
        let mut boxes: Vec<Aabb> = (0..400)
            .map(|i| {
                let at = vector(100.0);
                Aabb { min: at, max: at + vector(if i % 9 == 0 { 40.0 } else { 1.0 }) }
            })
            .collect();
        let far = DVec3::splat(1e15);
        boxes.push(Aabb { min: far, max: far + DVec3::ONE });
        boxes.push(Aabb { min: DVec3::NEG_INFINITY, max: DVec3::new(f64::INFINITY, 5.0, 1e300) });
        boxes
    }

    #[test]
    fn whatever_overlaps_is_reached_and_little_else() {
        let boxes = boxes();
        let index = BoxIndex::of(boxes.iter().copied());
        let mut more = 0;
        for around in &boxes {
            let mut reached: Vec<usize> = index.reached(|held| held.overlaps(around)).collect();
            reached.sort_unstable();
            let overlaps = (0..boxes.len()).filter(|&i| boxes[i].overlaps(around));
            let missed = overlaps.clone().find(|i| reached.binary_search(i).is_err());
            assert_eq!(missed, None, "{around:?}");
            more += reached.len() - overlaps.count();
        }
        assert!(more < 10, "{more} reached for nothing");
    }

    #[test]
    fn a_box_without_numbers_is_everywhere_and_an_empty_one_nowhere() {
        let unknown = Aabb { min: DVec3::NAN, max: DVec3::ONE };
        let unit = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let index = BoxIndex::of([unit, Aabb::EMPTY, unknown]);
        let around = Aabb { min: DVec3::splat(7.0), max: DVec3::splat(8.0) };
        assert_eq!(index.reached(|held| held.overlaps(&around)).collect::<Vec<_>>(), [2]);
        assert_eq!(BoxIndex::of([]).reached(|_| true).count(), 0);
        assert_eq!(BoxIndex::of([unit]).reached(|held| held.overlaps(&unit)).count(), 1);
    }

    /// A search for the nearest shrinks as it goes.
    #[test]
    fn a_test_may_turn_stricter_on_the_way() {
        let boxes = boxes();
        let index = BoxIndex::of(boxes.iter().copied());
        let at = Aabb::of_points([DVec3::splat(50.0)]);
        let away = |aabb: &Aabb| aabb.distance_squared_lower(&at);
        let least = std::cell::Cell::new(f64::INFINITY);
        let mut looked_at = 0;
        for number in index.reached(|held| away(held) <= least.get()) {
            looked_at += 1;
            least.set(least.get().min(away(&boxes[number])));
        }
        assert_eq!(least.get(), boxes.iter().map(away).fold(f64::INFINITY, f64::min));
        assert!(looked_at < boxes.len() / 4, "{looked_at} of {}", boxes.len());
    }
}
