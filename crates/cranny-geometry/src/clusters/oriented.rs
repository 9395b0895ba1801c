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

/// The frame along a normal (unit, or zero: that of the body) that lies along the points' greatest
/// spread across it.
pub(super) fn frame_along(points: &[DVec3], normal: DVec3) -> Frame {
    if normal == DVec3::ZERO {
        return DVec3::AXES;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let mean = points.iter().sum::<DVec3>() / points.len() as f64;
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    for p in points {
        let (x, y) = (u.dot(*p - mean), v.dot(*p - mean));
        (a, b, c) = (a + x * x, b + x * y, c + y * y);
    }
    // Principal direction of [[a, b], [b, c]], without a transcendental function.
    let half = 0.5 * (a - c);
    let root = (half * half + b * b).sqrt();
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

/// How far points reach along a frame's directions: least and most.
fn extents(points: &[DVec3], frame: &Frame) -> [DVec3; 2] {
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in points {
        let at = DVec3::new(frame[0].dot(*p), frame[1].dot(*p), frame[2].dot(*p));
        (least, most) = (least.min(at), most.max(at));
    }
    [least, most]
}

/// Half the surface of the box along a frame.
pub(super) fn half_area(points: &[DVec3], frame: &Frame) -> f64 {
    let [least, most] = extents(points, frame);
    let size = most - least;
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
