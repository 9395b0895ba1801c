//! How far two clusters are apart along a direction, and which direction parts them most.

use cranny_geometry::ClusterTree;
use cranny_geometry::clusters::Cluster;
use wide::f32x8;

use super::cut::Due;
use super::ground::{Ground, rounding};
use super::lanes::{Wide3, greatest};
use crate::pair::Side;

/// In so many queries a pair of clusters that nothing parted is not tried again: the longer for
/// those with greater numbers, so that not all come up at once. Fewer: what cannot be parted is
/// tried in vain; more: what has come apart is looked at.
const REST: u8 = 6;
const SPREAD: u32 = 5;

/// Two clusters within reach, and what is known of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    pub(crate) pair: [u32; 2],
    /// That parted them last: unit, from first to second, in the first's frame.
    pub(super) direction: [f32; 3],
    rest: u8,
    /// Queries in which faces that planes do not part are not measured, since what they were apart
    /// was spent too soon.
    pub(super) hurry: u8,
    /// Faces met when they were measured last.
    pub(super) met: bool,
    /// While slack is left, `direction` parts them.
    pub(super) is_parted: bool,
    /// What motion must spend before they can be nearer than a reach.
    pub(super) due: Due,
}

impl Leaf {
    pub(super) fn new(pair: [u32; 2], due: Due) -> Self {
        Self { pair, direction: [0.0; 3], rest: 0, hurry: 0, met: false, is_parted: false, due }
    }
}

/// Two clusters at a pose.
struct Two<'a> {
    trees: [&'a ClusterTree; 2],
    clusters: [&'a Cluster; 2],
    between: [f32; 3],
    error: f32,
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(v: [f32; 3]) -> [f32; 3] {
    v.map(|x| -x)
}

fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

/// How far a cluster's points reach along a direction of its body.
#[inline]
fn support(tree: &ClusterTree, cluster: &Cluster, direction: [f32; 3]) -> f32 {
    let direction = Wide3::all(direction);
    let mut most = f32x8::splat(f32::NEG_INFINITY);
    for block in tree.points(cluster) {
        most = direction.dot(&Wide3::of(block)).fast_max(most);
    }
    greatest(most)
}

impl<'a> Ground<'a> {
    fn two(&self, pair: [u32; 2]) -> Two<'a> {
        let trees = self.trees;
        let clusters = [0, 1].map(|i: usize| &trees[i].clusters()[pair[i] as usize]);
        let [a, b] = clusters;
        let between = self.between(Side::First, a, b);
        let scale = a.bounds.radius
            + b.bounds.radius * self.into(Side::First).ratio()
            + between.iter().map(|x| x.abs()).sum::<f32>();
        let error = rounding(scale) + self.posing_in(Side::First);
        Two { trees, clusters, between, error }
    }

    /// A certain lower bound along a direction, in lengths of the first body.
    #[inline]
    fn gap_along(&self, two: &Two, direction: [f32; 3]) -> f32 {
        let ([first, second], [a, b]) = (two.trees, two.clusters);
        let back = minus(self.into(Side::Second).turned(direction));
        let its = support(second, b, back) * self.into(Side::First).ratio();
        let gap = dot(direction, two.between) - support(first, a, direction) - its - two.error;
        // Of what overflowed nothing is certain.
        gap.max(f32::NEG_INFINITY)
    }

    /// A certain lower bound of how far two clusters are apart along a direction, in lengths of the
    /// pair.
    pub(crate) fn cluster_gap_along(&self, pair: [u32; 2], direction: [f32; 3]) -> f64 {
        let two = self.two(pair);
        f64::from(self.gap_along(&two, direction)) * two.trees[0].unit()
    }

    /// Whether two clusters are certain to be apart, as seen along the normal of either.
    pub(crate) fn are_parted_by_normals(&self, pair: [u32; 2]) -> bool {
        let two = self.two(pair);
        let [a, b] = two.clusters;
        let facing = minus(self.into(Side::First).turned(b.normal));
        self.gap_along(&two, a.normal) > 0.0 || self.gap_along(&two, facing) > 0.0
    }

    /// A lower bound of how far two clusters are apart, in lengths of the pair and certain: along
    /// the direction that parted them last, and where that is not more than `reach`, along the one
    /// that parts them most of some; and whether the direction from before the call parts them.
    pub(crate) fn cluster_gap(&self, leaf: &mut Leaf, reach: f64) -> (f64, bool) {
        let two = self.two(leaf.pair);
        let unit_length = two.trees[0].unit();
        let limit = ((reach / unit_length) as f32).next_up();
        let mut best = self.gap_along(&two, leaf.direction);
        let parts = best > 0.0;
        let certain = |gap: f32| (f64::from(gap) * unit_length, parts);
        if best > limit {
            return certain(best);
        }
        if leaf.rest > 0 {
            leaf.rest -= 1;
            return certain(best);
        }
        let [a, b] = two.clusters;
        let into = self.into(Side::First);
        let facing = minus(into.turned(b.normal));
        let middle = [0, 1, 2].map(|i: usize| a.normal[i] + facing[i]);
        let [x, y, z] = a.bounds.axes;
        let [u, v, w] = b.bounds.axes.map(|axis| into.turned(axis));
        let outward =
            |axis: [f32; 3]| if dot(axis, two.between) < 0.0 { minus(axis) } else { axis };
        let tries = [
            Some(a.normal),
            Some(facing),
            unit(middle),
            unit(two.between),
            Some(outward(x)),
            Some(outward(y)),
            Some(outward(z)),
            Some(outward(u)),
            Some(outward(v)),
            Some(outward(w)),
        ];
        for direction in tries.into_iter().flatten() {
            let gap = self.gap_along(&two, direction);
            if gap > best {
                (best, leaf.direction) = (gap, direction);
                if gap > limit {
                    return certain(best);
                }
            }
        }
        let spread = leaf.pair[0].wrapping_mul(3).wrapping_add(leaf.pair[1]) % SPREAD;
        leaf.rest = REST + spread as u8;
        certain(best)
    }
}
