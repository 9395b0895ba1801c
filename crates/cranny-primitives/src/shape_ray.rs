//! Rays and points against shapes of which any may be a primitive.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;
use parry3d_f64::query::Ray;

use crate::convex::{found, placed};
use crate::primitive::{Ball, Primitive, PrimitiveError, direction, place};
use crate::ray::cast_ray;
use crate::separation::{Separation, separation};
use crate::shape::BodyShape;

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeRayHit {
    /// From the ray's origin, >= 0, in units of length.
    pub distance: f64,
    /// The point on the surface.
    pub point: DVec3,
    /// Unit, out of the shape.
    pub normal: DVec3,
    /// The face of a model's prepared mesh; `None` of a primitive.
    pub face: Option<FaceId>,
    /// Whether the ray comes from inside.
    pub from_behind: bool,
}

/// The first point at which a ray meets a shape, no farther away than `within` (>= 0, infinite for
/// any distance); all is in the shape's frame. A ray that begins inside meets the surface from
/// there. Of a model it is [`cast_ray`], whose verdict is exact; of a primitive it is right to the
/// tolerance of parry's search, about a millionth.
///
/// # Errors
///
/// [`PrimitiveError`] for an origin, direction or number that is invalid.
pub fn cast_ray_at_shape(
    shape: &BodyShape,
    origin: DVec3,
    along: DVec3,
    within: f64,
) -> Result<Option<ShapeRayHit>, PrimitiveError> {
    match shape {
        BodyShape::Model(model) => {
            let hit = cast_ray(model, origin, along, within)?;
            Ok(hit.map(|hit| ShapeRayHit {
                distance: hit.distance,
                point: hit.point,
                normal: hit.normal,
                face: Some(hit.face),
                from_behind: hit.from_behind,
            }))
        }
        BodyShape::Primitive(primitive) => at_primitive(primitive, origin, along, within),
    }
}

fn at_primitive(
    primitive: &Primitive,
    origin: DVec3,
    along: DVec3,
    within: f64,
) -> Result<Option<ShapeRayHit>, PrimitiveError> {
    primitive.check()?;
    let (origin, along) = (place("origin", origin)?, direction("direction", along)?);
    let from_behind =
        separation_of_point(&(*primitive).into(), origin, 0.0)? == Separation::Meeting;
    let (pose, shape) = placed(primitive);
    let ray = Ray::new(origin, along);
    let hit = shape.cast_ray_and_get_normal(&pose, &ray, within.min(f64::MAX), false);
    Ok(hit.map(|hit| {
        // It leaves along the outward normal, and enters against it.
        let leaves = hit.normal.dot(along) > 0.0;
        ShapeRayHit {
            distance: hit.time_of_impact,
            point: origin + along * hit.time_of_impact,
            normal: if leaves == from_behind { hit.normal } else { -hit.normal },
            face: None,
            from_behind,
        }
    }))
}

/// How far a point is from a shape, in the shape's frame, if by no more than `within` (>= 0,
/// infinite for any distance): `Meeting` in its solid or on its surface. The first witness is the
/// nearest point of the shape.
///
/// # Errors
///
/// [`PrimitiveError`] for a point or number that is invalid.
pub fn separation_of_point(
    shape: &BodyShape,
    point: DVec3,
    within: f64,
) -> Result<Separation, PrimitiveError> {
    let here = Primitive::from(Ball { center: point, radius: 0.0 });
    match shape {
        BodyShape::Model(model) => separation(model, &here, within),
        BodyShape::Primitive(primitive) => {
            found(primitive, &here, within).map(|(found, _)| found.into())
        }
    }
}
