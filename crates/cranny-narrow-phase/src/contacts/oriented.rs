//! Boxes that lie along what they hold: tight around faces of nearly one normal, however these are turned.
//!
//! Along a thread everything is slanted; the box along the axes of a frame around a few faces is then as thick as
//! they are long, and that of a turned box larger still. A box with an axis along the mean normal is as thin as the faces are bent.
//!
//! Source: Gottschalk, Lin and Manocha (1996, "OBBTree: a hierarchical structure for rapid interference detection"). Theirs tests
//! fifteen axes for a verdict; here a bound of the distance is wanted, and of the fifteen those of the boxes
//! tell nearly all.

use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::{Content, PatchId};

use crate::pair::{Pair, Side};

/// Squared sine of the angle to the normal above which a direction can be laid across it. Smaller, and axes are no right
/// angles by more than rounding; larger, and directions are left out that would do.
const LEAST_SINE_SQUARED: f64 = 0.25;

/// A box with axes of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Oriented {
    pub(super) center: DVec3,
    /// Unit and at right angles, to rounding; the last is the normal where there is one.
    pub(super) axes: [DVec3; 3],
    /// Half its lengths along these.
    pub(super) half: DVec3,
    radius: f64,
}

impl Oriented {
    /// The smallest of the boxes around some points that have one axis along `normal` (unit, or zero: any) and another along one of
    /// `across`, as seen along the normal.
    pub(super) fn around(points: &[DVec3], normal: DVec3, across: &[DVec3]) -> Self {
        let normal = if normal == DVec3::ZERO { DVec3::Z } else { normal };
        let mut best: Option<(f64, Self)> = None;
        let mut offer = |v: DVec3| {
            let axes = [v.cross(normal), v, normal];
            let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for &p in points {
                let at = DVec3::from_array(axes.map(|axis| axis.dot(p)));
                (least, most) = (least.min(at), most.max(at));
            }
            let (middle, half) = (0.5 * (least + most), 0.5 * (most - least));
            let area = half.x * half.y;
            if best.as_ref().is_none_or(|(least, _)| area < *least) {
                let center = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
                best = Some((area, Self { center, axes, half, radius: half.length() }));
            }
        };
        let mut is_any = false;
        for &direction in across {
            let v = normal.cross(direction);
            if v.length_squared() > LEAST_SINE_SQUARED * direction.length_squared() {
                offer(v.normalize());
                is_any = true;
            }
        }
        if !is_any {
            offer(normal.any_orthonormal_vector());
        }
        best.map_or(
            Self { center: DVec3::ZERO, axes: DVec3::AXES, half: DVec3::ZERO, radius: 0.0 },
            |b| b.1,
        )
    }

    /// Where a rigid map takes it.
    #[inline]
    pub(super) fn posed(&self, map: &RigidMap) -> Self {
        let axes = self.axes.map(|axis| map.apply_vector(axis));
        Self { center: map.apply(self.center), axes, ..*self }
    }

    /// A plane over all that it holds: along the last axis, and how high.
    #[inline]
    pub(super) fn top(&self) -> (DVec3, f64) {
        let normal = self.axes[2];
        (normal, normal.dot(self.center) + self.half.z)
    }

    /// A point as the box has it: from its center, along its axes.
    #[inline]
    pub(super) fn within(&self, p: DVec3) -> DVec3 {
        let from = p - self.center;
        DVec3::from_array(self.axes.map(|axis| axis.dot(from)))
    }

    /// Where a point is as the box has it; `None` where it is farther away than `reach`, which the normal tells mostly.
    #[inline]
    pub(super) fn reached(&self, p: DVec3, reach: f64) -> Option<DVec3> {
        let from = p - self.center;
        let z = self.axes[2].dot(from);
        if z.abs() > self.half.z + reach {
            return None;
        }
        let x = self.axes[0].dot(from);
        if x.abs() > self.half.x + reach {
            return None;
        }
        let y = self.axes[1].dot(from);
        (y.abs() <= self.half.y + reach).then(|| DVec3::new(x, y, z))
    }

    /// A lower bound of the distance between what two boxes hold, but for rounding: the first that is found beyond `limit`, and else
    /// the greatest.
    #[inline]
    pub(super) fn apart(&self, other: &Self, limit: f64) -> Bound {
        let between = other.center - self.center;
        let touching = self.radius + other.radius + limit;
        if between.length_squared() > touching * touching {
            let lower = between.length() - self.radius - other.radius;
            return Bound { lower, axis: Axis::BALLS };
        }
        let ([a0, a1, a2], [b0, b1, b2]) = (self.axes, other.axes);
        let reach = |half: DVec3, x: f64, y: f64, z: f64| {
            half.x * x.abs() + half.y * y.abs() + half.z * z.abs()
        };
        // Along the normals first.
        let (d20, d21, d22) = (a2.dot(b0), a2.dot(b1), a2.dot(b2));
        let along = a2.dot(between).abs() - self.half.z - reach(other.half, d20, d21, d22);
        if along > limit {
            return Bound { lower: along, axis: Axis(2) };
        }
        let mut best = Bound { lower: along, axis: Axis(2) };
        let (d02, d12) = (a0.dot(b2), a1.dot(b2));
        let along = b2.dot(between).abs() - other.half.z - reach(self.half, d02, d12, d22);
        if along > limit {
            return Bound { lower: along, axis: Axis(5) };
        }
        best = best.or(along, Axis(5));
        let (d00, d01) = (a0.dot(b0), a0.dot(b1));
        let along = a0.dot(between).abs() - self.half.x - reach(other.half, d00, d01, d02);
        if along > limit {
            return Bound { lower: along, axis: Axis(0) };
        }
        best = best.or(along, Axis(0));
        let (d10, d11) = (a1.dot(b0), a1.dot(b1));
        let along = a1.dot(between).abs() - self.half.y - reach(other.half, d10, d11, d12);
        if along > limit {
            return Bound { lower: along, axis: Axis(1) };
        }
        best = best.or(along, Axis(1));
        let along = b0.dot(between).abs() - other.half.x - reach(self.half, d00, d10, d20);
        if along > limit {
            return Bound { lower: along, axis: Axis(3) };
        }
        best = best.or(along, Axis(3));
        let along = b1.dot(between).abs() - other.half.y - reach(self.half, d01, d11, d21);
        best.or(along, Axis(4))
    }

    /// The bound that one axis tells.
    #[inline]
    pub(super) fn apart_along(&self, other: &Self, axis: Axis) -> f64 {
        let between = other.center - self.center;
        if axis == Axis::BALLS {
            return between.length() - self.radius - other.radius;
        }
        let (own, its, at) =
            if axis.0 < 3 { (self, other, axis.0) } else { (other, self, axis.0 - 3) };
        let at = usize::from(at).min(2);
        let (along, half) = (own.axes[at], own.half.to_array()[at]);
        let [x, y, z] = its.axes;
        let reach = its.half.x * along.dot(x).abs()
            + its.half.y * along.dot(y).abs()
            + its.half.z * along.dot(z).abs();
        along.dot(between).abs() - half - reach
    }
}

/// What tells that two boxes are apart: one of the axes of the first or of the second, or the balls around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Axis(u8);

impl Axis {
    pub(super) const BALLS: Self = Self(6);
}

/// A lower bound of a distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    pub(super) lower: f64,
    /// What tells it.
    pub(super) axis: Axis,
}

impl Bound {
    /// The greater of two.
    #[inline]
    fn or(self, lower: f64, axis: Axis) -> Self {
        if lower > self.lower { Self { lower, axis } } else { self }
    }
}

/// Boxes around what the nodes of a patch's tree hold, in the body's frame, in the order of the nodes.
///
/// Cost: O(n) for each level of the tree.
pub(super) fn boxes_of(pair: &Pair, side: Side, patch: PatchId) -> Vec<Oriented> {
    let patches = pair.model(side).patches();
    let Some(root) = patches.trees().root(patch.index()) else { return Vec::new() };
    let (mesh, arena) = (pair.mesh(side), patches.trees().arena());
    let nodes = patches.trees().nodes(patch.index());
    let (mut points, mut names, mut held) = (Vec::new(), Vec::new(), Vec::new());
    for name in (root..).take(nodes.len()) {
        let start = points.len();
        for &face in arena.leaf_faces(name) {
            for vertex in mesh.corners(face) {
                if !names[start..].contains(&vertex) {
                    names.push(vertex);
                    points.push(mesh.position(vertex));
                }
            }
        }
        held.push([start, points.len()]);
    }
    let mut boxes = vec![Oriented::around(&[], DVec3::ZERO, &[]); nodes.len()];
    for at in (0..nodes.len()).rev() {
        let name = root + at as u32;
        let normal = patches.slab(name).normal;
        boxes[at] = match arena.content(name) {
            Content::Leaf { start, .. } => {
                let [a, b, c] = mesh.triangle(arena.faces()[start as usize]);
                Oriented::around(&points[held[at][0]..held[at][1]], normal, &[b - a, c - b, a - c])
            }
            Content::Inner { left, right } => {
                let [left, right] = [left, right].map(|n| (n - root) as usize);
                held[at] = [held[left][0], held[right][1]];
                let across = [
                    boxes[left].axes[1],
                    boxes[right].axes[1],
                    boxes[right].center - boxes[left].center,
                ];
                Oriented::around(&points[held[at][0]..held[at][1]], normal, &across)
            }
        };
    }
    boxes
}

/// The greater of two numbers that are no NaN.
#[inline]
fn more(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// How far something reaches along the axes of a box, from its center.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    least: DVec3,
    most: DVec3,
}

impl Extent {
    /// Of what is spanned by some points, as the box has them.
    #[inline]
    pub(super) fn of<const N: usize>(points: [DVec3; N]) -> Self {
        let less = |x: f64, y: f64| if y < x { y } else { x };
        let (mut least, mut most) = (points[0], points[0]);
        for p in &points[1..] {
            least = DVec3::new(less(least.x, p.x), less(least.y, p.y), less(least.z, p.z));
            most = DVec3::new(more(most.x, p.x), more(most.y, p.y), more(most.z, p.z));
        }
        Self { least, most }
    }

    /// Whether a point may be no farther away than `reach`, as seen along the box's last axis.
    #[inline]
    pub(super) fn may_reach(&self, p: DVec3, reach: f64) -> bool {
        p.x <= self.most.x + reach
            && p.x >= self.least.x - reach
            && p.y <= self.most.y + reach
            && p.y >= self.least.y - reach
    }

    /// Whether what reaches so far may be no farther away than `reach`.
    #[inline]
    pub(super) fn may_meet(&self, other: &Self, reach: f64) -> bool {
        let are_near = |least: f64, most: f64, low: f64, high: f64| {
            low <= most + reach && high >= least - reach
        };
        are_near(self.least.x, self.most.x, other.least.x, other.most.x)
            && are_near(self.least.y, self.most.y, other.least.y, other.most.y)
            && are_near(self.least.z, self.most.z, other.least.z, other.most.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, Pose};
    use cranny_testkit::Rng;

    fn point(rng: &mut Rng) -> DVec3 {
        DVec3::new(rng.unit(), rng.unit(), rng.unit())
    }

    #[test]
    fn a_slanted_floor_lies_flat_in_its_box() {
        let turn = DQuat::from_xyzw(0.3, 0.2, -0.5, 0.7).normalize();
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let floor = corners.map(|p| turn * DVec3::from_array(p));
        // The diagonal and the normal are of no use, the side is.
        let across = [floor[2] - floor[0], turn * DVec3::Z, floor[1] - floor[0]];
        let about = |shift: DVec3| {
            Oriented::around(&floor.map(|p| p + turn * shift), turn * DVec3::Z, &across)
        };
        let here = about(DVec3::ZERO);
        let mut half = here.half.to_array();
        half.sort_by(f64::total_cmp);
        assert!((DVec3::from_array(half) - DVec3::new(0.0, 0.5, 2.0)).length() < 1e-14);
        for (shift, apart) in
            [(0.25 * DVec3::Z, 0.25), (3.0 * DVec3::Y, 2.0), (6.0 * DVec3::X, 2.0)]
        {
            let there = about(shift);
            let lower = here.apart(&there, 3.0).lower;
            assert!((lower - apart).abs() < 1e-14, "{shift} {lower}");
            assert!(here.apart(&there, 0.99 * apart).lower > 0.99 * apart);
        }
    }

    /// No two points are nearer than what boxes around them say, nor out of reach where one is before a box or beside an extent.
    #[test]
    fn what_boxes_part_is_apart() {
        let mut rng = Rng::new(5);
        let (mut parted, mut held) = (0, 0);
        for round in 0..2_000 {
            let normal = if round % 5 == 0 { DVec3::ZERO } else { point(&mut rng).normalize() };
            let size = 0.5f64.powi(round % 7);
            let cloud: [DVec3; 6] = std::array::from_fn(|_| size * point(&mut rng));
            let across = [cloud[1] - cloud[0], cloud[2] - cloud[1], normal];
            let own = Oriented::around(&cloud, normal, &across[..rng.below(4)]);
            let rotation = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
            let map = Pose { rotation, translation: 1.5 * point(&mut rng) }.world_from_body();
            let other = own.posed(&map);
            let moved = cloud.map(|p| map.apply(p));
            let nearest = cloud
                .iter()
                .flat_map(|p| moved.map(|q| (*p - q).length()))
                .fold(f64::INFINITY, f64::min);
            let limit = rng.unit().abs();
            let Bound { lower, axis } = own.apart(&other, limit);
            assert!(nearest >= lower - 1e-14);
            assert!((own.apart_along(&other, axis) - lower).abs() < 1e-14);
            parted += u32::from(lower > limit);
            for axis in (0..=6).map(Axis) {
                assert!(nearest >= own.apart_along(&other, axis) - 1e-14);
            }
            let extent = Extent::of(cloud.map(|p| own.within(p)));
            let its = Extent::of(moved.map(|p| own.within(p)));
            assert!(extent.may_meet(&its, nearest) && its.may_meet(&extent, nearest));
            for p in moved {
                let reach = nearest.max(1e-14);
                let near = cloud.iter().map(|q| (*q - p).length()).fold(f64::INFINITY, f64::min);
                held += u32::from(own.reached(p, reach).is_none());
                assert!(own.reached(p, near + 1e-14).is_some());
            }
        }
        assert!(parted > 200 && held > 500, "{parted} {held}");
    }
}
