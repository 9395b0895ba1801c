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
pub(crate) struct BoxTest {
    rotation: DMat3,
    absolute: DMat3,
    translation: DVec3,
    error: f64,
}

impl BoxTest {
    pub(crate) fn of(pair: &Pair) -> Self {
        let map = pair.first_from_second;
        let abs = |v: DVec3| v.abs();
        let m = map.linear;
        Self {
            rotation: m,
            absolute: DMat3::from_cols(abs(m.x_axis), abs(m.y_axis), abs(m.z_axis)),
            translation: map.translation,
            error: pair.culling_error(),
        }
    }

    /// Whether the boxes are certainly more than `margin` apart.
    pub(crate) fn apart(&self, first: &Aabb, second: &Aabb, margin: f64) -> bool {
        let (ha, hb) = (first.half_extents(), second.half_extents());
        let d = self.rotation * second.center() + self.translation - first.center();
        let slack = margin + self.error;
        if (d.abs() - ha - self.absolute * hb).max_element() > slack {
            return true;
        }
        let along_second = self.rotation.transpose() * d;
        let reach = self.absolute.transpose() * ha;
        (along_second.abs() - hb - reach).max_element() > slack
    }

    /// A lower bound of the distance between what the boxes hold.
    pub(crate) fn distance_lower(&self, first: &Aabb, second: &Aabb) -> f64 {
        let (ha, hb) = (first.half_extents(), second.half_extents());
        let d = self.rotation * second.center() + self.translation - first.center();
        let gap_first = (d.abs() - ha - self.absolute * hb).max(DVec3::ZERO);
        let along_second = self.rotation.transpose() * d;
        let gap_second =
            (along_second.abs() - hb - self.absolute.transpose() * ha).max(DVec3::ZERO);
        (gap_first.length().max(gap_second.length()) - self.error).max(0.0)
    }
}

/// Calls `visit` for every pair of faces whose boxes may be within `margin` of each other; the
/// visitor may end the descent early.
pub(crate) fn for_each_near_pair(
    pair: &Pair,
    margin: f64,
    counters: &mut Counters,
    mut visit: impl FnMut(FaceId, FaceId, &mut Counters) -> ControlFlow<()>,
) {
    let boxes = BoxTest::of(pair);
    let (first, second) = (pair.model(Side::First).tree(), pair.model(Side::Second).tree());
    let mut stack = vec![(0u32, 0u32)];
    while let Some((a, b)) = stack.pop() {
        counters.node_tests += 1;
        let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
        if boxes.apart(box_a, box_b, margin) {
            continue;
        }
        match opened(first.content(a), second.content(b), box_a, box_b) {
            Opened::First(left, right) => stack.extend([(right, b), (left, b)]),
            Opened::Second(left, right) => stack.extend([(a, right), (a, left)]),
            Opened::Neither => {
                for &f in first.leaf_faces(a) {
                    for &g in second.leaf_faces(b) {
                        if visit(f, g, counters).is_break() {
                            return;
                        }
                    }
                }
            }
        }
    }
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
