//! Between rapier's numbers, f32 or f64, and Cranny's f64. Poses are converted by functions, since
//! neither side's types are ours.

use cranny_exact::{DQuat, DVec3, Pose};
use rapier3d::math::{Pose as RapierPose, Real, Rotation, Vector};

/// A rapier pose as it stands, its quaternion normalised in f64: the pose that 'exact' refers to.
#[must_use]
pub fn pose_from_rapier(pose: &RapierPose) -> Pose {
    let q = pose.rotation;
    let rotation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
    Pose { rotation: rotation * (1.0 / rotation.length()), translation: wide(pose.translation) }
}

/// A pose, rounded to rapier's numbers.
#[must_use]
pub fn pose_to_rapier(pose: &Pose) -> RapierPose {
    let q = pose.rotation;
    let rotation = Rotation::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real);
    RapierPose::from_parts(narrow(pose.translation), rotation.normalize())
}

/// A vector, widened.
#[must_use]
pub fn wide(v: Vector) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// A vector, rounded to rapier's numbers.
#[must_use]
pub fn narrow(v: DVec3) -> Vector {
    Vector::new(v.x as Real, v.y as Real, v.z as Real)
}
