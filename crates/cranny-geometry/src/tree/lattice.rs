//! Boxes on a coarse lattice, to plan trees with.
//!
//! Which boxes to part from which is a matter of taste, so rounded boxes may decide it: eight
//! numbers of 16 bits, a quarter of the exact ones, joined by one operation. The tree's own boxes
//! are exact all the same; they are made from the faces when the tree's shape is known.
//!
//! No source: this crate's own. Cost: O(1) to round a box or to join two.

use cranny_exact::{Aabb, DVec3};

/// Steps of the lattice along the longest side of a frame. Twice as many, and the sum of two
/// coordinates no longer fits 16 bits; fewer, and frames are laid anew more often.
const STEPS: f64 = 16_383.0;

/// Where a lattice lies. All its sides have the same step, so that areas keep their proportions.
#[derive(Clone, Copy)]
pub(super) struct LatticeFrame {
    low: DVec3,
    /// Steps a unit of length; 0 where the frame has no size.
    pub(super) scale: f64,
}

impl LatticeFrame {
    /// That of boxes within `bounds`.
    pub(super) fn of(bounds: &Aabb) -> Self {
        let scale = STEPS / (bounds.max - bounds.min).max_element();
        Self { low: bounds.min, scale: if scale.is_finite() { scale } else { 0.0 } }
    }

    /// The nearest box of the lattice, by name.
    pub(super) fn item(&self, bounds: &Aabb, name: u32) -> LatticeItem {
        let step = |p: DVec3| (self.scale * (p - self.low)).to_array().map(|x| (x + 0.5) as i16);
        let ([a, b, c], [x, y, z]) = (step(bounds.min), step(bounds.max));
        LatticeItem(LatticeBox([a, b, c, name as i16, -x, -y, -z, (name >> 16) as i16]))
    }
}

/// A box as numbers of which the least counts: the least corner, and the greatest one negated; the
/// fourth and the eighth are spare. So two boxes are joined by one kind of operation on the whole.
#[derive(Clone, Copy)]
#[repr(align(16))]
pub(super) struct LatticeBox([i16; 8]);

impl LatticeBox {
    pub(super) const NONE: Self = Self([i16::MAX; 8]);

    pub(super) fn join(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(other.0) {
            *own = other.min(*own);
        }
    }

    /// Twice the middle, as a box.
    fn center(&self) -> Self {
        let [a, b, c, d, x, y, z, w] = self.0;
        let turned = [x, y, z, w, a, b, c, d];
        Self(std::array::from_fn(|k| self.0[k].wrapping_sub(turned[k])))
    }

    /// The box of (twice) the middles of some items.
    pub(super) fn of_centers(items: &[LatticeItem]) -> Self {
        let mut centers = Self::NONE;
        items.iter().for_each(|item| centers.join(&item.0.center()));
        centers
    }

    pub(super) fn low(&self, axis: usize) -> i32 {
        i32::from(self.0[axis])
    }

    pub(super) fn size(&self, axis: usize) -> i32 {
        -i32::from(self.0[axis + 4]) - i32::from(self.0[axis])
    }

    /// Along each axis. Not by `map`, which is not always compiled in place.
    fn sizes(&self) -> [i32; 3] {
        [self.size(0), self.size(1), self.size(2)]
    }

    /// The axis along which it is longest, the first of equal ones.
    pub(super) fn longest(&self) -> usize {
        let [x, y, z] = self.sizes();
        if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        }
    }

    /// Half the area of the lattice's cells around it, so that flat ones count too.
    pub(super) fn half_area(&self) -> u64 {
        let [x, y, z] = self.sizes();
        let [x, y, z] = [x as u32 + 1, y as u32 + 1, z as u32 + 1];
        u64::from(x * y + y * z + z * x)
    }
}

/// Something on its way into a leaf: its box, and its name in the spare places. The highest bit of
/// the name distinguishes one thing from two.
#[derive(Clone, Copy)]
pub(super) struct LatticeItem(LatticeBox);

impl LatticeItem {
    pub(super) fn bounds(&self) -> &LatticeBox {
        &self.0
    }

    pub(super) fn name(&self) -> usize {
        let [.., low, _, _, _, high] = self.0.0;
        usize::from(low as u16) | usize::from(high as u16) << 16
    }

    /// How many things it is.
    pub(super) fn things(&self) -> u32 {
        1 + u32::from(self.0.0[7] < 0)
    }

    /// Twice the middle of its box along an axis: at least 0.
    pub(super) fn center(&self, axis: usize) -> i32 {
        i32::from(self.0.0[axis]) - i32::from(self.0.0[axis + 4])
    }
}

/// Some items: their box, and the box of (twice) their middles.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub(super) bounds: LatticeBox,
    pub(super) centers: LatticeBox,
    /// Of items.
    pub(super) count: u32,
    /// What the items are, one or two each.
    pub(super) things: u32,
}

impl Extent {
    pub(super) const NONE: Self =
        Self { bounds: LatticeBox::NONE, centers: LatticeBox::NONE, count: 0, things: 0 };

    pub(super) fn of(items: &[LatticeItem]) -> Self {
        let mut extent = Self::NONE;
        items.iter().for_each(|item| extent.add(item));
        extent
    }

    #[inline]
    pub(super) fn add(&mut self, item: &LatticeItem) {
        self.bounds.join(&item.0);
        self.centers.join(&item.0.center());
        self.count += 1;
        self.things += item.things();
    }

    pub(super) fn of_all(parts: &[Self]) -> Self {
        let mut all = Self::NONE;
        for part in parts {
            all.bounds.join(&part.bounds);
            all.centers.join(&part.centers);
            all.count += part.count;
            all.things += part.things;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(min: [f64; 3], max: [f64; 3]) -> Aabb {
        Aabb { min: DVec3::from_array(min), max: DVec3::from_array(max) }
    }

    #[test]
    fn an_item_on_a_lattice_of_units_by_hand() {
        let frame = LatticeFrame::of(&boxed([-100.0, 1.0, 1.0], [16_283.0, 9.0, 5.0]));
        assert_eq!(frame.scale, 1.0);
        let item = frame.item(&boxed([-98.0, 4.0, 5.0], [-94.0, 4.0, 6.0]), 0x8001_9002);
        assert_eq!(item.name(), 0x8001_9002);
        // From (2, 3, 4) to (6, 3, 5).
        assert_eq!([0, 1, 2].map(|axis| item.center(axis)), [8, 6, 9]);
        assert_eq!([0, 1, 2].map(|axis| item.bounds().low(axis)), [2, 3, 4]);
        assert_eq!([0, 1, 2].map(|axis| item.bounds().size(axis)), [4, 0, 1]);
        // 5 x 1 x 2 cells.
        assert_eq!((item.bounds().half_area(), item.bounds().longest()), (5 + 2 + 10, 0));
        let mut extent = Extent::of(&[item]);
        extent.add(&frame.item(&boxed([-100.0, 5.0, 1.0], [-99.4, 9.0, 1.4]), 7));
        // The other from (0, 4, 0) to (1, 8, 0), its middle at (0.5, 6, 0).
        assert_eq!([0, 1, 2].map(|axis| extent.bounds.size(axis)), [6, 5, 5]);
        assert_eq!([0, 1, 2].map(|axis| extent.centers.low(axis)), [1, 6, 0]);
        assert_eq!([0, 1, 2].map(|axis| extent.centers.size(axis)), [7, 6, 9]);
        assert_eq!((extent.count, extent.centers.longest()), (2, 2));
    }

    #[test]
    fn a_frame_without_size_has_all_in_one_place() {
        let point = boxed([0.3; 3], [0.3; 3]);
        let frame = LatticeFrame::of(&point);
        assert_eq!((frame.scale, frame.item(&point, 0).bounds().half_area()), (0.0, 3));
    }
}
