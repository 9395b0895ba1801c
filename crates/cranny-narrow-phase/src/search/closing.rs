//! How fast what is at a place of a tree comes nearer to the other body, at most.
//!
//! A motion's product with a wrench is the rate at which it closes a contact that presses with that
//! (`cranny_geometry::clusters::WrenchBox`); the trees bound the wrenches of what is at each place.

use cranny_exact::DVec3;
use cranny_geometry::clusters::{WRENCH, WideNode, WrenchBox};
use wide::f32x8;

use super::ground::Ground;
use super::lanes::{single, wide};
use crate::approach::Approach;
use crate::pair::{Pair, Side};

/// What single precision is off by, per size of the motion. Smaller: contacts are lost at the
/// bound; larger: more is looked at.
const SPARE: f32 = 1e-5;

/// Where posing rounds by more than this, in units of a tree, normals of small faces are not what
/// the tree says, and nothing is bounded. Larger: faces of the least height that a tree relies on
/// are turned by more than it spares.
const MOST_POSING: f32 = 1e-11;

/// A body's motion against the other, in the coordinates of its tree.
#[derive(Clone, Copy, Debug)]
struct Screw {
    /// What each coordinate of a force counts.
    linear: [f32; 3],
    /// What it may count besides, by its size.
    spread: [f32; 3],
    /// What each coordinate counts by the turn: of a force, then of its moment.
    turning: [f32; WRENCH],
    spare: f32,
}

impl Screw {
    /// `motion`: in the body's frame. Of the tree, its origin and its unit.
    fn new(motion: &Approach, (origin, unit): (DVec3, f64)) -> Self {
        let Approach { linear, spread, turn, swing, .. } = motion;
        let force = *swing + turn.cross(origin);
        let moment = *turn * unit;
        let [f, m] = [force, moment].map(single);
        let turning = [f[0], f[1], f[2], m[0], m[1], m[2]];
        let columns = [spread.x_axis, spread.y_axis, spread.z_axis];
        let spread = single(columns.into_iter().map(DVec3::abs).sum());
        let linear = single(*linear);
        let size: f32 = linear.iter().chain(&spread).chain(&turning).map(|x| x.abs()).sum();
        Self { linear, spread, turning, spare: SPARE * size }
    }

    /// For wrenches of a box.
    #[inline(always)]
    fn closing(&self, wrenches: &WrenchBox) -> f32 {
        let greater = |x: f32, y: f32| if x > y { x } else { y };
        let most = |i: usize, by: f32| greater(by * wrenches.least[i], by * wrenches.most[i]);
        let (mut linear, mut turning) = (self.spare, 0.0);
        for i in 0..3 {
            let size = greater(-wrenches.least[i], wrenches.most[i]);
            linear += most(i, self.linear[i]) + self.spread[i] * size;
        }
        for i in 0..WRENCH {
            turning += most(i, self.turning[i]);
        }
        linear + turning.max(0.0)
    }

    /// For the boxes of a node's lanes.
    #[inline(always)]
    fn closings(&self, node: &WideNode) -> f32x8 {
        let bounds = |i: usize| (wide(&node.wrenches.least[i]), wide(&node.wrenches.most[i]));
        let most = |i: usize, by: f32| {
            let ((least, most), by) = (bounds(i), f32x8::splat(by));
            (by * least).fast_max(by * most)
        };
        let (mut linear, mut turning) = (f32x8::splat(self.spare), f32x8::splat(0.0));
        for i in 0..3 {
            let (least, greatest) = bounds(i);
            linear += most(i, self.linear[i])
                + f32x8::splat(self.spread[i]) * (-least).fast_max(greatest);
        }
        for i in 0..WRENCH {
            turning += most(i, self.turning[i]);
        }
        linear + turning.fast_max(f32x8::splat(0.0))
    }
}

/// How far contacts count, by where they are in the trees: lengths of the pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closing {
    /// As far as that whatever moves.
    margin: f32,
    /// No farther.
    within: f32,
    screws: Option<[Screw; 2]>,
}

impl Closing {
    /// `approach`: of the pair's first body as the second sees it, in the pair's frame.
    pub(crate) fn of(pair: &Pair, ground: &Ground, margin: f64, approach: &Approach) -> Self {
        let is_known = Side::BOTH.iter().all(|&side| ground.posing_in(side) <= MOST_POSING);
        let screws = is_known.then(|| {
            let back = pair.first_from_second.inverse();
            let motions = [*approach, approach.swapped().moved(&back)];
            [0, 1].map(|i: usize| {
                let tree = ground.trees[i];
                Screw::new(&motions[i], (tree.origin(), tree.unit()))
            })
        });
        let up = |x: f64| (x as f32).next_up();
        Self { margin: up(margin), within: up(approach.within), screws }
    }

    /// How far the contacts of two clusters count.
    #[inline]
    pub(crate) fn of_clusters(&self, ground: &Ground, clusters: [u32; 2]) -> f64 {
        let Some(screws) = &self.screws else { return f64::from(self.within) };
        let closing = |i: usize| {
            screws[i].closing(&ground.trees[i].clusters()[clusters[i] as usize].wrenches)
        };
        f64::from(closing(0).max(closing(1)).max(self.margin).min(self.within))
    }

    /// How far those count at the lanes of a side's node, by that side's motion alone.
    #[inline(always)]
    pub(crate) fn of_lanes(&self, side: Side, node: &WideNode) -> f32x8 {
        match &self.screws {
            Some(screws) => screws[side.index()].closings(node),
            None => f32x8::splat(f32::INFINITY),
        }
    }

    /// How far those count that count so far by the motion of either side.
    #[inline(always)]
    pub(crate) fn reaches(&self, own: f32x8, other: f32) -> f32x8 {
        let least = f32x8::splat(other.max(self.margin));
        own.fast_max(least).fast_min(f32x8::splat(self.within))
    }
}
