//! Partners that are solids of revolution: as what they are, in our shape's frame.

use cranny_exact::{DVec3, RigidMap};
use cranny_narrow_phase::revolved::Revolved;
use rapier3d::math::Real;
use rapier3d::parry::shape::{Cone, Cylinder, Shape, TypedShape};

use crate::convert::wide;

/// Ball, capsule, segment, cylinder or cone, with a border radius or without, in a frame; `None` for any other shape,
/// or at no pose.
pub(crate) fn revolved(shape: &dyn Shape, frame_from_shape: &RigidMap) -> Option<Revolved> {
    let map = frame_from_shape;
    let axis = map.apply_vector(DVec3::Y).try_normalize()?;
    let at = map.translation;
    if !at.is_finite() {
        return None;
    }
    let cylinder = |c: &Cylinder, border: Real| {
        Revolved::cylinder(at, axis, c.half_height.into(), c.radius.into(), border.into())
    };
    let cone = |c: &Cone, border: Real| {
        Revolved::cone(at, axis, c.half_height.into(), c.radius.into(), border.into())
    };
    match shape.as_typed_shape() {
        TypedShape::Ball(ball) => Some(Revolved::segment([at, at], ball.radius.into())),
        TypedShape::Capsule(capsule) => {
            let ends = [capsule.segment.a, capsule.segment.b].map(|p| map.apply(wide(p)));
            Some(Revolved::segment(ends, capsule.radius.into()))
        }
        TypedShape::Segment(segment) => {
            Some(Revolved::segment([segment.a, segment.b].map(|p| map.apply(wide(p))), 0.0))
        }
        TypedShape::Cylinder(c) => Some(cylinder(c, 0.0)),
        TypedShape::Cone(c) => Some(cone(c, 0.0)),
        TypedShape::RoundCylinder(c) => Some(cylinder(&c.inner_shape, c.border_radius)),
        TypedShape::RoundCone(c) => Some(cone(&c.inner_shape, c.border_radius)),
        _ => None,
    }
}
