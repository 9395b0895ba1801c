//! Two search trees at a relative pose.

use cranny_exact::{DMat3, RigidMap};
use cranny_geometry::ClusterTree;
use cranny_geometry::clusters::{Child, Cluster, LANES, OrientedBox, ROUNDING, WideNode};
use wide::f32x8;

use super::lanes::{Wide3, single, wide};
use crate::observe::ComparedBoxes;
use crate::pair::{Pair, Side};

/// Weight of the least share by which boxes overlap, beside the sum of six. 2 to 6 serve as well;
/// 1 finds crossings of golf balls later, 12 those of a peg.
const LEAST_SHARE: f32 = 3.0;

/// Lengths from here on, in units of a tree, are not compared in single precision: squares
/// overflow.
const LARGEST: f32 = (1u64 << 60) as f32;

/// What sums of single-precision coordinates up to `scale` may be off by; infinite where their
/// squares may overflow, so that everything is kept.
#[inline(always)]
pub(crate) fn rounding(scale: f32) -> f32 {
    if scale < LARGEST { ROUNDING * scale } else { f32::INFINITY }
}

/// Where a descent stands in one tree: at the root, or at a lane of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct At(u32);

impl At {
    pub(crate) const ROOT: Self = Self(u32::MAX);

    /// A lane of a node.
    #[inline(always)]
    pub(crate) fn lane(node: usize, lane: usize) -> Self {
        Self((node * LANES + lane) as u32)
    }

    /// The node and the lane; `None` at the root.
    #[inline(always)]
    fn place(self) -> Option<[usize; 2]> {
        let at = self.0 as usize;
        (self != Self::ROOT).then_some([at / LANES, at % LANES])
    }
}

/// From one body's coordinates into the other's, in single precision: turned, scaled to its unit,
/// moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placing {
    rows: [[f32; 3]; 3],
    shift: [f32; 3],
    ratio: f32,
}

impl Placing {
    #[inline(always)]
    pub(crate) fn turned(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        self.rows.map(|[a, b, c]| a * x + b * y + c * z)
    }

    #[inline(always)]
    pub(crate) fn turned_all(&self, v: &Wide3) -> Wide3 {
        let row = |[a, b, c]: [f32; 3]| {
            f32x8::splat(a) * v.x + f32x8::splat(b) * v.y + f32x8::splat(c) * v.z
        };
        Wide3 { x: row(self.rows[0]), y: row(self.rows[1]), z: row(self.rows[2]) }
    }

    /// How many of the other body's units are one of the first's.
    #[inline(always)]
    pub(crate) fn ratio(&self) -> f32 {
        self.ratio
    }

    #[inline(always)]
    fn placed(&self, b: &OrientedBox) -> OrientedBox {
        let [x, y, z] = self.turned(b.center.map(|c| c * self.ratio));
        let [u, v, w] = self.shift;
        OrientedBox {
            center: [x + u, y + v, z + w],
            axes: b.axes.map(|axis| self.turned(axis)),
            half: b.half.map(|half| half * self.ratio),
            radius: b.radius * self.ratio,
        }
    }
}

/// Two search trees at a relative pose. What is called *a side's lengths* is in units of its tree.
pub(crate) struct Ground<'a> {
    pub(crate) trees: [&'a ClusterTree; 2],
    /// Into each side's coordinates, those of the other.
    into: [Placing; 2],
    /// Turns and moves the other's body frame into each side's, in double precision.
    maps: [RigidMap; 2],
    /// What bounds of distances may be off by, in each side's lengths.
    error: [f32; 2],
    /// What posing rounds, in lengths of the pair.
    posing: f64,
    /// The same in each side's lengths.
    posing_in: [f32; 2],
    /// One over the unit of each: powers of two, so that this is exact.
    per_unit: [f64; 2],
}

impl<'a> Ground<'a> {
    pub(crate) fn of(pair: &Pair<'a>) -> Self {
        let trees = Side::BOTH.map(|side| pair.model(side).clusters());
        let maps = [pair.first_from_second, pair.first_from_second.inverse()];
        let posing = pair.culling_error();
        let per_unit = trees.map(|tree| 1.0 / tree.unit());
        let posing_in = per_unit.map(|per_unit| (posing * per_unit) as f32);
        let mut error = [0.0; 2];
        let into = [0, 1].map(|i| {
            let (own, its) = (trees[i], trees[1 - i]);
            let shift = (maps[i].apply(its.origin()) - own.origin()) / own.unit();
            let ratio = (its.unit() / own.unit()) as f32;
            let DMat3 { x_axis, y_axis, z_axis } = maps[i].linear.transpose();
            let shift = single(shift);
            let reach = 1.0 + ratio + shift.iter().map(|x| x.abs()).sum::<f32>();
            error[i] = rounding(reach) + posing_in[i];
            Placing { rows: [x_axis, y_axis, z_axis].map(single), shift, ratio }
        });
        Self { trees, into, maps, error, posing, posing_in, per_unit }
    }

    #[inline(always)]
    pub(crate) fn into(&self, side: Side) -> &Placing {
        &self.into[side.index()]
    }

    #[inline(always)]
    pub(crate) fn tree(&self, side: Side) -> &'a ClusterTree {
        self.trees[side.index()]
    }

    /// A length of the pair in a side's lengths, rounded up, with what bounds may be off by.
    #[inline(always)]
    pub(crate) fn reach(&self, side: Side, length: f64) -> f32 {
        let i = side.index();
        ((length * self.per_unit[i]) as f32).next_up() + self.error[i]
    }

    /// A bound in a side's lengths as a length of the pair that is certain, or negative.
    #[inline(always)]
    pub(crate) fn certain(&self, side: Side, bound: f32) -> f64 {
        let i = side.index();
        let certain = f64::from(bound - self.error[i]).next_down() * self.trees[i].unit();
        // Of what overflowed nothing is certain.
        certain.max(f64::NEG_INFINITY)
    }

    /// What posing rounds, in a side's lengths.
    #[inline(always)]
    pub(crate) fn posing_in(&self, side: Side) -> f32 {
        self.posing_in[side.index()]
    }

    /// What posing rounds.
    pub(crate) fn posing(&self) -> f64 {
        self.posing
    }

    #[inline(always)]
    pub(crate) fn child(&self, side: Side, at: At) -> Child {
        let Some([node, lane]) = at.place() else { return Child::ROOT };
        self.tree(side).nodes()[node].children[lane]
    }

    #[inline(always)]
    pub(crate) fn boxed(&self, side: Side, at: At) -> OrientedBox {
        let Some([node, lane]) = at.place() else { return *self.tree(side).root() };
        self.tree(side).nodes()[node].boxed(lane)
    }

    /// Lengths of the pair in a side's lengths, rounded up, with what bounds may be off by.
    #[inline(always)]
    pub(crate) fn reaches(&self, side: Side, lengths: f32x8) -> f32x8 {
        let i = side.index();
        // Units are powers of two; what they make of the least lengths is less than the error.
        lengths * f32x8::splat(self.per_unit[i] as f32) + f32x8::splat(self.error[i])
    }

    /// Lanes of the node at a place of `side`, compared with the other place.
    #[inline(always)]
    pub(crate) fn compared(&self, at: [At; 2], side: Side, lanes: u32) -> ComparedBoxes {
        let body = side.index();
        let node = self.child(side, at[body]).index() as u32;
        let other = at[1 - body].place().map(|place| place.map(|number| number as u32));
        ComparedBoxes { body, node, lanes, other }
    }

    /// The box at a place of the other side, in this side's coordinates.
    #[inline(always)]
    pub(crate) fn placed(&self, side: Side, other: At) -> OrientedBox {
        self.into(side).placed(&self.boxed(side.other(), other))
    }

    /// Where the centre of a cluster of the other side lies from one of this side's, in this side's
    /// lengths.
    #[inline(always)]
    pub(crate) fn between(&self, side: Side, own: &Cluster, its: &Cluster) -> [f32; 3] {
        let i = side.index();
        let from = self.maps[i].apply(its.center) - own.center;
        single(from * self.per_unit[i])
    }

    /// Which of two places is opened next, and how; `None` where both are clusters.
    #[inline(always)]
    pub(crate) fn opened(&self, at: [At; 2]) -> Option<Side> {
        let children = [self.child(Side::First, at[0]), self.child(Side::Second, at[1])];
        match children.map(Child::is_cluster) {
            [true, true] => None,
            [true, false] => Some(Side::Second),
            [false, true] => Some(Side::First),
            [false, false] => {
                let first = self.boxed(Side::First, at[0]).radius;
                let second = self.boxed(Side::Second, at[1]).radius * self.into[0].ratio;
                Some(if first >= second { Side::First } else { Side::Second })
            }
        }
    }

    /// Lower bounds, in the side's lengths and but for [`reach`](Self::reach)'s allowance, of how
    /// far what is at a place of the other side lies from each of the boxes of a node of this side.
    #[inline(always)]
    pub(crate) fn gaps(&self, side: Side, node: &WideNode, other: At) -> f32x8 {
        gaps_and_overlaps(node, &self.placed(side, other)).0
    }
}

/// How far boxes are apart, seen along the three axes of either, at right angles to each other: the
/// greater of the two lengths of what is between. The nine cross products of axes rarely pay. And
/// how centrally boxes overlap: along each axis the share of the way from where they touch to where
/// their centres meet, the least of six with a weight of its own. 0 where they are apart along all,
/// 6 and that weight where they share their centre.
///
/// Where surfaces cross, their boxes mostly do so centrally: of 18 lists of poses that cross,
/// shares along six axes compare 0.80 of what the least length does before they find a crossing.
#[inline(always)]
pub(crate) fn gaps_and_overlaps(node: &WideNode, b: &OrientedBox) -> (f32x8, f32x8) {
    let between = Wide3::of(&node.center).minus(&Wide3::all(b.center));
    let axes = [0, 1, 2].map(|j: usize| Wide3::of(&node.axes[j]));
    let half = [wide(&node.half.x), wide(&node.half.y), wide(&node.half.z)];
    let mut reach = half;
    let (zero, smallest) = (f32x8::splat(0.0), f32x8::splat(f32::MIN_POSITIVE));
    let (mut along_its, mut along_own) = (zero, zero);
    let (mut shares, mut least) = (zero, f32x8::splat(1.0));
    let mut share = |apart: f32x8, extent: f32x8| {
        let share = (zero - apart).fast_max(zero) / extent.fast_max(smallest);
        shares += share;
        least = least.fast_min(share);
    };
    for i in 0..3 {
        let axis = Wide3::all(b.axes[i]);
        let mut extent = f32x8::splat(b.half[i]);
        for j in 0..3 {
            let across = axis.dot(&axes[j]).abs();
            extent += across * half[j];
            reach[j] += across * f32x8::splat(b.half[i]);
        }
        let apart = between.dot(&axis).abs() - extent;
        share(apart, extent);
        let gap = apart.fast_max(zero);
        along_its += gap * gap;
    }
    for j in 0..3 {
        let apart = between.dot(&axes[j]).abs() - reach[j];
        share(apart, reach[j]);
        let gap = apart.fast_max(zero);
        along_own += gap * gap;
    }
    let overlap = shares + f32x8::splat(LEAST_SHARE) * least;
    (along_its.fast_max(along_own).sqrt(), overlap)
}
