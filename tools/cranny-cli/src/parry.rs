//! parry's numbers, single precision as its default build takes them; and its panics.

use std::panic::{self, AssertUnwindSafe, catch_unwind};

use cranny_exact::{DVec3, Pose as ExactPose};
use parry3d::math::{Pose, Rotation, Vector};

/// A pose in single precision.
pub(crate) fn single(pose: ExactPose) -> Pose {
    let (t, r) = (pose.translation, pose.rotation);
    Pose::from_parts(
        Vector::new(t.x as f32, t.y as f32, t.z as f32),
        Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32),
    )
}

/// A point, exactly.
pub(crate) fn double(v: Vector) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// What a peer returns, or why it does not; a panic of its is not printed.
pub(crate) fn quietly<T>(ask: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let found = catch_unwind(AssertUnwindSafe(ask));
    panic::set_hook(hook);
    found.unwrap_or_else(|_| Err("it panicked".to_owned()))
}
