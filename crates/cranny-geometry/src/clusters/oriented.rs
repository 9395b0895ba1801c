//! Boxes that lie along what they hold.

use cranny_exact::DVec3;
use glam::Vec3Swizzles;

/// A box with axes of its own, in the coordinates of its tree. What it holds lies within it,
/// rounding of its own numbers taken into account.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Its middle.
    pub center: [f32; 3],
    /// Unit and at right angles, to rounding.
    pub axes: [[f32; 3]; 3],
    /// Half its lengths along these.
    pub half: [f32; 3],
    /// Of a ball about the centre that holds it.
    pub radius: f32,
}

/// Three directions at right angles, the last along a normal where there is one.
pub(super) type Frame = [DVec3; 3];

/// Squared sine of the angle to the normal above which a direction can be laid across it. Smaller,
/// and axes are no right angles by more than rounding; larger, and directions are left out that
/// would do.
const LEAST_SINE_SQUARED: f64 = 0.01;

/// Rounded sums of what a box holds may be off by so many parts of its size: extents are computed
/// in double precision from axes and centres as they are stored, so only axes that are no right
/// angles count.
const SPARE: f64 = 1.0 + 1.0 / (1 << 20) as f64;

/// By how much, as a share, what is alike in a mesh may differ: lengths of faces a sixty-fourth as
/// wide as a body are off by 4e-6 in a file in single precision, and what is made of them by a few
/// times that. Smaller: rounding decides (`a_plane_falls_into_full_and_flat_clusters`); larger:
/// what is worse comes first.
pub(super) const FILE_NOISE: f64 = 3e-5;

/// How points spread about their mean.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    count: f64,
    mean: DVec3,
    /// Sums of xx, yy and zz about the mean.
    squares: DVec3,
    /// Sums of yz, zx and xy about it.
    products: DVec3,
}

impl Spread {
    pub(super) fn of(points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let (count, sum) =
            points.clone().fold((0.0, DVec3::ZERO), |(n, sum), p| (n + 1.0, sum + p));
        let mean = sum / count;
        let (mut squares, mut products) = (DVec3::ZERO, DVec3::ZERO);
        for p in points {
            let p = p - mean;
            squares += p * p;
            products += p.yzx() * p.zxy();
        }
        Self { count, mean, squares, products }
    }

    /// Of the points of both (Chan, Golub and LeVeque 1979): no point is looked at again, and
    /// points that lie together far from the origin lose nothing.
    pub(super) fn with(&self, other: &Self) -> Self {
        let count = self.count + other.count;
        let (between, share) = (other.mean - self.mean, other.count / count);
        let weight = self.count * share;
        Self {
            count,
            mean: self.mean + between * share,
            squares: self.squares + other.squares + between * between * weight,
            products: self.products + other.products + between.yzx() * between.zxy() * weight,
        }
    }

    /// The scatter matrix (the covariance times the number of points) times a vector.
    fn times(&self, u: DVec3) -> DVec3 {
        let (yz, zx, xy) = self.products.into();
        self.squares * u + DVec3::new(xy * u.y + zx * u.z, xy * u.x + yz * u.z, zx * u.x + yz * u.y)
    }
}

/// The frame along a normal (unit, or zero: that of the body) that lies along the greatest spread
/// across it.
pub(super) fn frame_along(spread: &Spread, normal: DVec3) -> Frame {
    if normal == DVec3::ZERO {
        return DVec3::AXES;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let (of_u, of_v) = (spread.times(u), spread.times(v));
    let (a, b, c) = (u.dot(of_u), v.dot(of_u), v.dot(of_v));
    // Principal direction of [[a, b], [b, c]], without a transcendental function.
    let half = 0.5 * (a - c);
    let root = (half * half + b * b).sqrt();
    if root <= FILE_NOISE * (a + c) {
        return [u, v, normal];
    }
    let (x, y) = if half >= 0.0 { (half + root, b) } else { (b, root - half) };
    let along = (u * x + v * y).try_normalize().unwrap_or(u);
    [along, normal.cross(along), normal]
}

/// The frame along a normal that has an axis along a direction; `None` where that leads along the
/// normal.
pub(super) fn frame_across(normal: DVec3, direction: DVec3) -> Option<Frame> {
    let across = direction - normal * normal.dot(direction);
    if across.length_squared() <= LEAST_SINE_SQUARED * direction.length_squared() {
        return None;
    }
    let along = across.normalize();
    Some([along, normal.cross(along), normal])
}

/// Two points side by side; of one, the same again.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointPair {
    x: [f64; 2],
    y: [f64; 2],
    z: [f64; 2],
}

impl PointPair {
    pub(super) fn of([p, q]: [DVec3; 2]) -> Self {
        Self { x: [p.x, q.x], y: [p.y, q.y], z: [p.z, q.z] }
    }

    fn each(&self) -> [DVec3; 2] {
        std::array::from_fn(|i| DVec3::new(self.x[i], self.y[i], self.z[i]))
    }

    fn along(&self, d: DVec3) -> [f64; 2] {
        std::array::from_fn(|i| d.x * self.x[i] + d.y * self.y[i] + d.z * self.z[i])
    }
}

/// How far points reach along a direction, two at a time. No coordinate is NaN, so that `<`
/// suffices.
#[derive(Clone, Copy)]
struct Interval2 {
    least: [f64; 2],
    most: [f64; 2],
}

impl Interval2 {
    const EMPTY: Self = Self { least: [f64::INFINITY; 2], most: [f64::NEG_INFINITY; 2] };

    fn add(&mut self, at: &[f64; 2]) {
        for (i, &x) in at.iter().enumerate() {
            self.least[i] = if x < self.least[i] { x } else { self.least[i] };
            self.most[i] = if x > self.most[i] { x } else { self.most[i] };
        }
    }

    /// From the least to the most.
    fn length(&self) -> f64 {
        let least = self.least.into_iter().fold(f64::INFINITY, f64::min);
        let most = self.most.into_iter().fold(f64::NEG_INFINITY, f64::max);
        most - least
    }
}

/// Half the surface of the box of points along a frame.
pub(super) fn half_area_along<'p>(
    points: impl Iterator<Item = &'p PointPair>,
    frame: &Frame,
) -> f64 {
    let mut reach = [Interval2::EMPTY; 3];
    for two in points {
        for (reach, &axis) in reach.iter_mut().zip(frame) {
            reach.add(&two.along(axis));
        }
    }
    let [x, y, z] = reach.map(|reach| reach.length());
    x * y + y * z + z * x
}

/// Whether an area is less by more than rounding, so that of equals the first counts.
pub(super) fn is_less(area: f64, than: f64) -> bool {
    area < than * (1.0 - FILE_NOISE)
}

/// The frame in which points have the smallest box, the first of equals.
pub(super) fn best_frame(points: &[PointPair], frames: impl Iterator<Item = Frame>) -> Frame {
    let mut best = (f64::INFINITY, DVec3::AXES);
    for frame in frames {
        let area = half_area_along(points.iter(), &frame);
        if is_less(area, best.0) {
            best = (area, frame);
        }
    }
    best.1
}

impl OrientedBox {
    /// Around points, along a frame.
    pub(super) fn around<'p>(
        points: impl Iterator<Item = &'p PointPair> + Clone,
        frame: &Frame,
    ) -> Self {
        let single = |v: DVec3| v.to_array().map(|x| x as f32);
        let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in points.clone().flat_map(PointPair::each) {
            let at = DVec3::from_array(frame.map(|axis| axis.dot(p)));
            (least, most) = (least.min(at), most.max(at));
        }
        let middle = 0.5 * (least + most);
        let center = single(frame[0] * middle.x + frame[1] * middle.y + frame[2] * middle.z);
        let axes = frame.map(single);
        let (stored, from) = (axes.map(double), double(center));
        let (mut half, mut radius) = (DVec3::ZERO, 0.0f64);
        for p in points.flat_map(PointPair::each) {
            let p = p - from;
            half = half.max(DVec3::from_array(stored.map(|axis| axis.dot(p).abs())));
            radius = radius.max(p.length());
        }
        let outward = |x: f64| ((x * SPARE) as f32).next_up();
        Self { center, axes, half: half.to_array().map(outward), radius: outward(radius) }
    }
}
