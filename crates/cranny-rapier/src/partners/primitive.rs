//! Partners that are primitives, in their own frames.

use cranny_exact::DVec3;
use cranny_primitives::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive, Segment};
use rapier3d::math::Real;
use rapier3d::parry::shape::{self, Shape, TypedShape};

use crate::convert::wide;

/// Ball, capsule, segment, half-space, and cylinder or cone, with a border radius or without;
/// `None` for any other shape. parry's cylinders and cones stand along y.
pub(crate) fn primitive(shape: &dyn Shape) -> Option<Primitive> {
    Some(match shape.as_typed_shape() {
        TypedShape::Ball(ball) => Ball { center: DVec3::ZERO, radius: ball.radius.into() }.into(),
        TypedShape::Capsule(capsule) => {
            let ends = [capsule.segment.a, capsule.segment.b].map(wide);
            Capsule { ends, radius: capsule.radius.into() }.into()
        }
        TypedShape::Segment(segment) => Segment { ends: [segment.a, segment.b].map(wide) }.into(),
        TypedShape::HalfSpace(half_space) => {
            HalfSpace { point: DVec3::ZERO, normal: wide(half_space.normal) }.into()
        }
        TypedShape::Cylinder(c) => cylinder(c, 0.0),
        TypedShape::Cone(c) => cone(c, 0.0),
        TypedShape::RoundCylinder(c) => cylinder(&c.inner_shape, c.border_radius),
        TypedShape::RoundCone(c) => cone(&c.inner_shape, c.border_radius),
        _ => return None,
    })
}

/// The same, of those whose distances are ours: parry measures half-spaces.
pub(crate) fn measured(shape: &dyn Shape) -> Option<Primitive> {
    primitive(shape).filter(|found| !matches!(found, Primitive::HalfSpace(_)))
}

fn cylinder(c: &shape::Cylinder, border: Real) -> Primitive {
    let (half_height, radius) = (c.half_height.into(), c.radius.into());
    let (center, axis, border) = (DVec3::ZERO, DVec3::Y, border.into());
    Cylinder { center, axis, half_height, radius, border }.into()
}

fn cone(c: &shape::Cone, border: Real) -> Primitive {
    let (half_height, radius) = (c.half_height.into(), c.radius.into());
    let (center, axis, border) = (DVec3::ZERO, DVec3::Y, border.into());
    Cone { center, axis, half_height, radius, border }.into()
}
