//! From our types to the well-known schemas'.

use cranny_exact::{DQuat, DVec3, Pose};
use foxglove::messages::{self, Color, Point3, Quaternion, Timestamp, Vector3};

pub(crate) fn vector3(v: DVec3) -> Vector3 {
    Vector3 { x: v.x, y: v.y, z: v.z }
}

pub(crate) fn point3(v: DVec3) -> Point3 {
    Point3 { x: v.x, y: v.y, z: v.z }
}

pub(crate) fn quaternion(q: DQuat) -> Quaternion {
    Quaternion { x: q.x, y: q.y, z: q.z, w: q.w }
}

pub(crate) fn pose(pose: &Pose) -> messages::Pose {
    messages::Pose {
        position: Some(vector3(pose.translation)),
        orientation: Some(quaternion(pose.rotation)),
    }
}

/// `None` where it lacks a rotation or a translation.
pub(crate) fn read_pose(pose: messages::Pose) -> Option<Pose> {
    let (t, q) = (pose.position?, pose.orientation?);
    let rotation = DQuat::from_xyzw(q.x, q.y, q.z, q.w);
    Some(Pose { rotation, translation: DVec3::new(t.x, t.y, t.z) })
}

pub(crate) fn color([r, g, b, a]: [f64; 4]) -> Color {
    Color { r, g, b, a }
}

const NANOSECONDS: f64 = 1e9;

/// Log time of a step, nanoseconds; `None` where its seconds do not fit 32 bits.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the product is checked to lie between 0 and 2^62, and rounded"
)]
pub(crate) fn time_ns(step: u64, dt: f64) -> Option<u64> {
    let time = (step as f64 * dt * NANOSECONDS).round();
    (time < f64::from(u32::MAX) * NANOSECONDS).then_some(time as u64)
}

/// Of a log time that [`time_ns`] gave, so that its seconds fit 32 bits.
pub(crate) fn timestamp(time_ns: u64) -> Timestamp {
    #[expect(clippy::cast_possible_truncation, reason = "time_ns keeps seconds below 2^32")]
    Timestamp::new((time_ns / 1_000_000_000) as u32, (time_ns % 1_000_000_000) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_the_nanosecond() {
        assert_eq!(time_ns(0, 1.0), Some(0));
        assert_eq!(time_ns(1, 1.0 / 240.0), Some(4_166_667));
        assert_eq!(time_ns(240, 1.0 / 240.0), Some(1_000_000_000));
        assert_eq!(time_ns(u64::MAX, 1.0), None);
        assert_eq!(timestamp(12_000_000_007), Timestamp::new(12, 7));
    }
}
