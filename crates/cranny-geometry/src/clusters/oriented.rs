//! Boxes that lie along what they hold.

use cranny_exact::DVec3;

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

/// Where points lie, and how far they spread about their mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    count: f64,
    mean: DVec3,
    /// Sums of squares of what they are off the mean by, and of products: yz, zx, xy.
    squares: DVec3,
    products: DVec3,
}

impl Spread {
    pub(super) fn of(points: &[DVec3]) -> Self {
        let count = points.len() as f64;
        let at = |p: &DVec3| Self { count: 1.0, mean: *p, ..Self::NONE };
        Self::about(count, points.iter().sum::<DVec3>() / count, points.iter().map(at))
    }

    /// Of all points of some.
    pub(super) fn joined<'s>(parts: impl Iterator<Item = &'s Self> + Clone) -> Self {
        let count = parts.clone().map(|part| part.count).sum();
        let sum = parts.clone().map(|part| part.count * part.mean).sum::<DVec3>();
        Self::about(count, sum / count, parts.copied())
    }

    const NONE: Self =
        Self { count: 0.0, mean: DVec3::ZERO, squares: DVec3::ZERO, products: DVec3::ZERO };

    fn about(count: f64, mean: DVec3, parts: impl Iterator<Item = Self>) -> Self {
        let mut all = Self { count, mean, ..Self::NONE };
        for part in parts {
            let off = part.mean - mean;
            all.squares += part.squares + part.count * off * off;
            all.products += part.products + part.count * mixed(off, off);
        }
        all
    }

    /// The frame along a normal (unit, or zero: that of the body) that lies along the points'
    /// greatest spread across it.
    pub(super) fn frame_along(&self, normal: DVec3) -> Frame {
        if normal == DVec3::ZERO {
            return DVec3::AXES;
        }
        let (u, v) = normal.any_orthonormal_pair();
        let between = |u: DVec3, v: DVec3| {
            self.squares.dot(u * v) + self.products.dot(mixed(u, v) + mixed(v, u))
        };
        let (a, b, c) = (between(u, u), between(u, v), between(v, v));
        // Principal direction of [[a, b], [b, c]], without a transcendental function.
        let half = 0.5 * (a - c);
        let root = (half * half + b * b).sqrt();
        let (x, y) = if half >= 0.0 { (half + root, b) } else { (b, root - half) };
        let along = (u * x + v * y).try_normalize().unwrap_or(u);
        [along, normal.cross(along), normal]
    }
}

/// The products yz, zx and xy of two vectors.
fn mixed(u: DVec3, v: DVec3) -> DVec3 {
    DVec3::new(u.y * v.z, u.z * v.x, u.x * v.y)
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

/// How far points reach along a frame's directions: least and most.
fn extents<'p>(points: impl IntoIterator<Item = &'p DVec3>, frame: &Frame) -> [DVec3; 2] {
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in points {
        let at = DVec3::new(frame[0].dot(*p), frame[1].dot(*p), frame[2].dot(*p));
        (least, most) = (least.min(at), most.max(at));
    }
    [least, most]
}

/// Half the surface of the box along a frame.
pub(super) fn half_area<'p>(points: impl IntoIterator<Item = &'p DVec3>, frame: &Frame) -> f64 {
    let [least, most] = extents(points, frame);
    half_surface(most - least)
}

/// Half the surface of a box of a size.
pub(super) fn half_surface(size: DVec3) -> f64 {
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// The frame in which points have the smallest box, the first of equals.
pub(super) fn best_frame(points: &[DVec3], frames: impl Iterator<Item = Frame>) -> Frame {
    let mut best = (f64::INFINITY, DVec3::AXES);
    for frame in frames {
        let area = half_area(points, &frame);
        // By more than rounding, so that what is as good does not depend on it.
        if area < best.0 * (1.0 - 1.0 / (1u64 << 30) as f64) {
            best = (area, frame);
        }
    }
    best.1
}

impl OrientedBox {
    /// Around points, along a frame.
    pub(super) fn around(points: &[DVec3], frame: &Frame) -> Self {
        let single = |v: DVec3| v.to_array().map(|x| x as f32);
        let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let [least, most] = extents(points, frame);
        let middle = 0.5 * (least + most);
        let center = single(frame[0] * middle.x + frame[1] * middle.y + frame[2] * middle.z);
        let axes = frame.map(single);
        let (stored, from) = (axes.map(double), double(center));
        let (mut half, mut radius) = (DVec3::ZERO, 0.0f64);
        for p in points {
            let p = *p - from;
            half = half.max(DVec3::from_array(stored.map(|axis| axis.dot(p).abs())));
            radius = radius.max(p.length());
        }
        let outward = |x: f64| ((x * SPARE) as f32).next_up();
        Self { center, axes, half: half.to_array().map(outward), radius: outward(radius) }
    }
}
