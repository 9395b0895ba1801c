//! Primitives in rapier: what a partner is in its own frame, and what a body is made of.

use cranny_exact::DVec3;
use cranny_primitives::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive, Segment};
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::shape::{self, Shape, SharedShape, TypedShape};

use crate::convert::{narrow, wide};

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

/// rapier's shape of a primitive, and where it stands in the body's frame: parry's balls and
/// half-spaces are about the origin, its cylinders and cones stand there along y.
pub(crate) fn placed(primitive: &Primitive) -> (Pose, SharedShape) {
    let at = |place: DVec3| Pose::from_parts(narrow(place), Rotation::IDENTITY);
    let along = |axis: DVec3, place: DVec3| {
        let axis = narrow(axis.normalize_or(DVec3::Y)).normalize_or(Vector::Y);
        Pose::from_parts(narrow(place), Rotation::from_rotation_arc(Vector::Y, axis))
    };
    match *primitive {
        Primitive::Ball(Ball { center, radius }) => (at(center), SharedShape::ball(radius as Real)),
        Primitive::Capsule(Capsule { ends, radius }) => {
            let [a, b] = ends.map(narrow);
            (Pose::IDENTITY, SharedShape::capsule(a, b, radius as Real))
        }
        Primitive::Segment(Segment { ends }) => {
            let [a, b] = ends.map(narrow);
            (Pose::IDENTITY, SharedShape::segment(a, b))
        }
        Primitive::Cylinder(Cylinder { center, axis, half_height, radius, border }) => {
            let [h, r, border] = [half_height, radius, border].map(|x| x as Real);
            let sharp = border == 0.0;
            let round = || SharedShape::round_cylinder(h, r, border);
            (along(axis, center), if sharp { SharedShape::cylinder(h, r) } else { round() })
        }
        Primitive::Cone(Cone { center, axis, half_height, radius, border }) => {
            let [h, r, border] = [half_height, radius, border].map(|x| x as Real);
            let sharp = border == 0.0;
            let round = || SharedShape::round_cone(h, r, border);
            (along(axis, center), if sharp { SharedShape::cone(h, r) } else { round() })
        }
        Primitive::HalfSpace(HalfSpace { point, normal }) => {
            let normal = narrow(normal.normalize_or(DVec3::Y)).normalize_or(Vector::Y);
            (at(point), SharedShape::halfspace(normal))
        }
    }
}
