//! Axis-aligned boxes, rounded outward.

use glam::DVec3;

/// By what the entry into a box may be wrong, as a share of it: a few roundings. Smaller, and faces
/// in the plane of a side of their box are missed; larger, and more boxes are opened.
const ENTRY_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// An axis-aligned box `min <= max`, or [`Aabb::EMPTY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Aabb {
    /// Holds no point; the neutral element of [`union`](Self::union).
    pub const EMPTY: Self =
        Self { min: DVec3::splat(f64::INFINITY), max: DVec3::splat(f64::NEG_INFINITY) };

    /// The smallest box that holds the points (exact: no arithmetic is done).
    #[must_use]
    #[inline]
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Whether the box holds no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box that holds both.
    #[must_use]
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the closed boxes share a point.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Whether the closed box holds the point.
    #[must_use]
    pub fn contains_point(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// The box grown by `margin >= 0` on every side, rounded outward.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self {
            min: map(self.min, |x| (x - margin).next_down()),
            max: map(self.max, |x| (x + margin).next_up()),
        }
    }

    /// Middle of the box (rounded).
    #[must_use]
    #[inline]
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Half of the edge lengths about [`center`](Self::center), rounded outward so that
    /// `center ± half_extents` covers the box.
    #[must_use]
    #[inline]
    pub fn half_extents(&self) -> DVec3 {
        let c = self.center();
        map((c - self.min).max(self.max - c), f64::next_up)
    }

    /// Length of the diagonal (rounded); 0 for an empty box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).length() }
    }

    /// Half the area of its surface (rounded); infinite for an empty box.
    #[must_use]
    #[inline]
    pub fn half_area(&self) -> f64 {
        let size = self.max - self.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// A lower bound of the squared distance between the boxes: exact but for rounding, which is
    /// taken downward; 0 where they overlap.
    #[must_use]
    pub fn distance_squared_lower(&self, other: &Self) -> f64 {
        let gap = (other.min - self.max).max(self.min - other.max).max(DVec3::ZERO);
        // Four roundings of relative size 2^-53 each; eight leave room.
        gap.length_squared() * (1.0 - 8.0 * f64::EPSILON)
    }

    /// At which share of a segment, from 0 to 1, it enters the closed box, or a few roundings
    /// before; `None` where it does not.
    #[must_use]
    pub fn entered_at(&self, from: DVec3, to: DVec3) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (from, to) = (from[axis], to[axis]);
            let (min, max) = (self.min[axis], self.max[axis]);
            if from == to {
                if from < min || from > max {
                    return None;
                }
                continue;
            }
            let [a, b] = [min, max].map(|side| (side - from) / (to - from));
            let (first, last) = (a.min(b), a.max(b));
            enter = enter.max(first - ENTRY_ROUNDING * first.abs());
            leave = leave.min(last + ENTRY_ROUNDING * last.abs());
        }
        (enter <= leave).then_some(enter)
    }
}

fn map(v: DVec3, f: impl Fn(f64) -> f64) -> DVec3 {
    DVec3::new(f(v.x), f(v.y), f(v.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box_at(x: f64) -> Aabb {
        Aabb { min: DVec3::new(x, 0.0, 0.0), max: DVec3::new(x + 1.0, 1.0, 1.0) }
    }

    #[test]
    fn a_segment_enters_where_it_meets_the_first_side() {
        let entered = |x: f64, to: f64| {
            unit_box_at(x).entered_at(DVec3::splat(0.5), DVec3::new(to, 0.5, 0.5))
        };
        assert_eq!(entered(0.0, 9.0), Some(0.0), "it begins inside");
        assert!((entered(4.5, 8.5).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(entered(4.5, 4.4), None, "it ends before");
        assert_eq!(entered(-4.0, 8.5), None, "it leads away");
        let above = DVec3::new(0.5, 2.0, 0.5);
        assert_eq!(unit_box_at(0.0).entered_at(above, above + 9.0 * DVec3::X), None);
        let unbounded = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::new(f64::INFINITY, 1.0, 1.0) };
        assert_eq!(unbounded.entered_at(DVec3::ZERO, DVec3::X), Some(0.0));
        assert!(unbounded.entered_at(above, 0.5 * DVec3::ONE).is_some_and(|at| at > 0.6));
    }

    #[test]
    fn touching_boxes_overlap_and_have_no_distance() {
        assert!(unit_box_at(0.0).overlaps(&unit_box_at(1.0)));
        assert!(!unit_box_at(0.0).overlaps(&unit_box_at(1.0f64.next_up())));
        assert_eq!(unit_box_at(0.0).distance_squared_lower(&unit_box_at(1.0)), 0.0);
        let bound = unit_box_at(0.0).distance_squared_lower(&unit_box_at(3.0));
        assert!(bound <= 4.0 && bound > 4.0 - 1e-13);
    }

    #[test]
    fn the_empty_box_is_neutral_and_meets_nothing() {
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!(Aabb::EMPTY.union(&unit_box_at(2.0)), unit_box_at(2.0));
        assert!(!Aabb::EMPTY.overlaps(&unit_box_at(0.0)));
        assert_eq!(Aabb::EMPTY.diagonal(), 0.0);
        assert_eq!(Aabb::EMPTY.half_area(), f64::INFINITY);
        assert_eq!(unit_box_at(3.0).half_area(), 3.0);
    }

    #[test]
    fn center_and_half_extents_cover_the_box() {
        let b = Aabb { min: DVec3::splat(0.1), max: DVec3::splat(0.7) };
        let (c, h) = (b.center(), b.half_extents());
        assert!((c - h).cmple(b.min).all() && (c + h).cmpge(b.max).all());
        assert!(b.grown(0.0).min.cmplt(b.min).all());
    }
}
