//! Paired descent of two box trees.
//!
//! Boxes are compared as oriented boxes in the first body's frame, along the six face axes of the
//! two boxes (Gottschalk, Lin and Manocha 1996; the nine edge–edge axes rarely pay and are left
//! out). The test keeps too much, never too little: every comparison carries the rounding of
//! posing.

use std::ops::ControlFlow;

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::{FaceId, PairedStep};

use crate::pair::{Pair, Side};
use crate::tally::Tally;

/// The oriented-box test of a pair: a box in the first body's frame against a box in the second's.
///
/// Both boxes are axis-aligned in their own body's frame, as the nodes of a
/// [tree](cranny_geometry::Model::tree) are. The test never excludes too much: its bounds carry the
/// [culling error](Pair::culling_error), of which the rounding of centers and extents is a part.
pub struct BoxTest {
    rotation: DMat3,
    inverse: DMat3,
    absolute: DMat3,
    inverse_absolute: DMat3,
    twice_translation: DVec3,
    error: f64,
}

impl BoxTest {
    /// The test at the poses of a pair.
    #[must_use]
    pub fn of(pair: &Pair) -> Self {
        let map = pair.first_from_second;
        let m = map.linear;
        let absolute = DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        Self {
            rotation: m,
            inverse: m.transpose(),
            absolute,
            inverse_absolute: absolute.transpose(),
            twice_translation: 2.0 * map.translation,
            error: pair.culling_error(),
        }
    }

    /// From the first box's center to the second's, doubled, and the gaps along the first's axes.
    #[inline]
    fn along_first(&self, first: &Aabb, second: &Aabb) -> (DVec3, DVec3) {
        let center = self.rotation * (second.min + second.max) + self.twice_translation;
        let offset = center - (first.min + first.max);
        let reach = (first.max - first.min) + self.absolute * (second.max - second.min);
        (offset, offset.abs() - reach)
    }

    #[inline]
    fn along_second(&self, offset: DVec3, first: &Aabb, second: &Aabb) -> DVec3 {
        let reach = (second.max - second.min) + self.inverse_absolute * (first.max - first.min);
        (self.inverse * offset).abs() - reach
    }

    /// Whether the boxes are certainly more than `margin` apart.
    #[inline]
    #[must_use]
    pub fn apart(&self, first: &Aabb, second: &Aabb, margin: f64) -> bool {
        let slack = 2.0 * (margin + self.error);
        let (offset, gap) = self.along_first(first, second);
        gap.max_element() > slack || self.along_second(offset, first, second).max_element() > slack
    }

    /// Returns a lower bound of the distance between what the boxes hold, 0 or more, and the square
    /// of the doubled distance between their centers, which orders boxes that overlap.
    #[inline]
    #[must_use]
    pub fn bound_and_guess(&self, first: &Aabb, second: &Aabb) -> (f64, f64) {
        let (offset, gap) = self.along_first(first, second);
        let beside = self.along_second(offset, first, second);
        let [along_first, along_second] =
            [gap, beside].map(|gap| gap.max(DVec3::ZERO).length_squared());
        let lower = (0.5 * along_first.max(along_second).sqrt() - self.error).max(0.0);
        (lower, offset.length_squared())
    }
}

/// Calls `visit` for every pair of faces whose boxes may be within `margin` of each other, of the
/// leaves that are reached by nodes which `holds` names; the visitor may end the descent early.
pub(crate) fn for_each_near_pair_beneath<T: Tally>(
    pair: &Pair,
    margin: f64,
    holds: impl Fn(Side, u32) -> bool,
    counters: &mut T,
    mut visit: impl FnMut(FaceId, FaceId, &mut T) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let boxes = BoxTest::of(pair);
    let (first, second) = (pair.model(Side::First).tree(), pair.model(Side::Second).tree());
    let apart = |a: u32, b: u32| boxes.apart(&first.node(a).bounds, &second.node(b).bounds, margin);
    counters.counters().node_tests += 1;
    if apart(0, 0) {
        return ControlFlow::Continue(());
    }
    let mut stack = vec![(0u32, 0u32)];
    while let Some((a, b)) = stack.pop() {
        let children = match PairedStep::of_larger([first, second], [a, b]) {
            PairedStep::First(left, right) => [(right, b), (left, b)],
            PairedStep::Second(left, right) => [(a, right), (a, left)],
            PairedStep::Leaves => {
                for &f in first.leaf_faces(a) {
                    for &g in second.leaf_faces(b) {
                        visit(f, g, counters)?;
                    }
                }
                continue;
            }
        };
        for (a, b) in children {
            if holds(Side::First, a) && holds(Side::Second, b) {
                counters.counters().node_tests += 1;
                stack.extend((!apart(a, b)).then_some((a, b)));
            }
        }
    }
    ControlFlow::Continue(())
}
