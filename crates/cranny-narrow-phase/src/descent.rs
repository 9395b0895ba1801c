//! Paired descent of two box trees.
//!
//! Boxes are compared as oriented boxes in the first body's frame, along the six face axes of the
//! two boxes (Gottschalk, Lin and Manocha 1996; the nine edge–edge axes rarely pay and are left
//! out). The test keeps too much, never too little: every comparison carries the rounding of posing.

use std::ops::ControlFlow;

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::{Content, FaceId};

use crate::answer::Counters;
use crate::pair::{Pair, Side};

/// The oriented-box tests of a pair, with what they need precomputed.
///
/// Boxes are compared by their doubled centers and extents, which are sums of their ends; what these
/// sums round off is part of the [culling error](Pair::culling_error).
pub(crate) struct BoxTest {
    rotation: DMat3,
    inverse: DMat3,
    absolute: DMat3,
    inverse_absolute: DMat3,
    twice_translation: DVec3,
    error: f64,
}

impl BoxTest {
    pub(crate) fn of(pair: &Pair) -> Self {
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
    pub(crate) fn apart(&self, first: &Aabb, second: &Aabb, margin: f64) -> bool {
        let slack = 2.0 * (margin + self.error);
        let (offset, gap) = self.along_first(first, second);
        gap.max_element() > slack || self.along_second(offset, first, second).max_element() > slack
    }

    /// A lower bound of the distance between what the boxes hold, and how far their centers are
    /// apart, doubled and squared: what to try first where the bounds say nothing.
    #[inline]
    pub(crate) fn bound_and_guess(&self, first: &Aabb, second: &Aabb) -> (f64, f64) {
        let (offset, gap) = self.along_first(first, second);
        let beside = self.along_second(offset, first, second);
        let [along_first, along_second] =
            [gap, beside].map(|gap| gap.max(DVec3::ZERO).length_squared());
        let lower = (0.5 * along_first.max(along_second).sqrt() - self.error).max(0.0);
        (lower, offset.length_squared())
    }
}

/// Calls `visit` for every pair of faces whose boxes may be within `margin` of each other, of the leaves that are reached by
/// nodes which `holds` names; the visitor may end the descent early.
pub(crate) fn for_each_near_pair_beneath(
    pair: &Pair,
    margin: f64,
    holds: impl Fn(Side, u32) -> bool,
    counters: &mut Counters,
    mut visit: impl FnMut(FaceId, FaceId, &mut Counters) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let boxes = BoxTest::of(pair);
    let (first, second) = (pair.model(Side::First).tree(), pair.model(Side::Second).tree());
    let apart = |a: u32, b: u32| boxes.apart(&first.node(a).bounds, &second.node(b).bounds, margin);
    counters.node_tests += 1;
    if apart(0, 0) {
        return ControlFlow::Continue(());
    }
    let mut stack = vec![(0u32, 0u32)];
    while let Some((a, b)) = stack.pop() {
        let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
        let children = match opened(first.content(a), second.content(b), box_a, box_b) {
            Opened::First(left, right) => [(right, b), (left, b)],
            Opened::Second(left, right) => [(a, right), (a, left)],
            Opened::Neither => {
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
                counters.node_tests += 1;
                stack.extend((!apart(a, b)).then_some((a, b)));
            }
        }
    }
    ControlFlow::Continue(())
}

/// Which node of a pair is opened next.
pub(crate) enum Opened {
    /// The first tree's: its children.
    First(u32, u32),
    /// The second tree's: its children.
    Second(u32, u32),
    /// Both are leaves.
    Neither,
}

/// Opens the larger of two nodes, or the one that can be opened.
#[inline]
pub(crate) fn opened(a: Content, b: Content, box_a: &Aabb, box_b: &Aabb) -> Opened {
    let size = |b: &Aabb| (b.max - b.min).length_squared();
    match (a, b) {
        (Content::Leaf { .. }, Content::Leaf { .. }) => Opened::Neither,
        (Content::Inner { left, right }, Content::Leaf { .. }) => Opened::First(left, right),
        (Content::Leaf { .. }, Content::Inner { left, right }) => Opened::Second(left, right),
        (Content::Inner { left, right }, Content::Inner { left: left_b, right: right_b }) => {
            if size(box_a) >= size(box_b) {
                Opened::First(left, right)
            } else {
                Opened::Second(left_b, right_b)
            }
        }
    }
}
