//! Shapes that are given by a few numbers, placed in the frame of the model that they meet.

use cranny_exact::{DVec3, RigidMap};
use thiserror::Error;

use crate::revolved::Revolved;

/// A shape that is given by a few numbers. All lengths are in the model's unit, all places in the
/// model's frame: [`moved`](Self::moved) takes a shape from another frame there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// All points within a radius of a point.
    Ball(Ball),
    /// All points within a radius of a segment.
    Capsule(Capsule),
    /// A segment, which has no volume.
    Segment(Segment),
    /// A cylinder with flat ends, sharp or with a border.
    Cylinder(Cylinder),
    /// A cone, sharp or with a border.
    Cone(Cone),
    /// All points on one side of a plane.
    HalfSpace(HalfSpace),
}

/// All points within a radius of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre.
    pub center: DVec3,
    /// Radius, >= 0.
    pub radius: f64,
}

/// All points within a radius of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the segment; equal ends make a ball.
    pub ends: [DVec3; 2],
    /// Radius, >= 0.
    pub radius: f64,
}

/// All points between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Ends; equal ends make a point.
    pub ends: [DVec3; 2],
}

/// A cylinder with flat ends. A disc, where its height is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Half-way along the axis.
    pub center: DVec3,
    /// Direction of the axis, of any length but 0.
    pub axis: DVec3,
    /// From the centre to each end, >= 0.
    pub half_height: f64,
    /// Radius, >= 0.
    pub radius: f64,
    /// The shape is all within this distance of the cylinder, >= 0; 0 for sharp edges.
    pub border: f64,
}

/// A cone. A disc, where its height is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Half-way between base and apex.
    pub center: DVec3,
    /// Direction from the base to the apex, of any length but 0.
    pub axis: DVec3,
    /// From the centre to base and apex, >= 0.
    pub half_height: f64,
    /// Radius of the base, >= 0.
    pub radius: f64,
    /// The shape is all within this distance of the cone, >= 0; 0 for sharp edges.
    pub border: f64,
}

/// All points `p` with `normal · (p − point) <= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// A point of the plane.
    pub point: DVec3,
    /// Direction out of the half-space, of any length but 0.
    pub normal: DVec3,
}

/// A number of a primitive that is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PrimitiveError {
    /// A place that is not finite.
    #[error("{what} is {value}: it must be finite")]
    Place {
        /// "center", "end", "point" or "origin".
        what: &'static str,
        /// The value found.
        value: DVec3,
    },
    /// A direction that is zero or not finite.
    #[error("{what} is {value}: it must be finite and not zero")]
    Direction {
        /// "axis", "normal" or "direction".
        what: &'static str,
        /// The value found.
        value: DVec3,
    },
    /// A length that is negative or not finite.
    #[error("{what} is {value}: it must be a finite number, 0 or more")]
    Length {
        /// "radius", "half height" or "border".
        what: &'static str,
        /// The value found.
        value: f64,
    },
}

/// A primitive whose numbers are checked.
#[expect(clippy::large_enum_variant, reason = "it is on the stack, for one question")]
pub(crate) enum Checked {
    /// All but half-spaces.
    Round(Revolved),
    HalfSpace(Plane),
}

/// The plane of a half-space: `normal · p = offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// Unit, out of the half-space.
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
}

impl Primitive {
    /// The same shape in another frame.
    #[must_use]
    pub fn moved(&self, to_from_here: &RigidMap) -> Self {
        let map = to_from_here;
        match *self {
            Self::Ball(b) => Self::Ball(Ball { center: map.apply(b.center), ..b }),
            Self::Capsule(c) => Self::Capsule(Capsule { ends: c.ends.map(|p| map.apply(p)), ..c }),
            Self::Segment(s) => Self::Segment(Segment { ends: s.ends.map(|p| map.apply(p)) }),
            Self::Cylinder(c) => Self::Cylinder(Cylinder {
                center: map.apply(c.center),
                axis: map.apply_vector(c.axis),
                ..c
            }),
            Self::Cone(c) => Self::Cone(Cone {
                center: map.apply(c.center),
                axis: map.apply_vector(c.axis),
                ..c
            }),
            Self::HalfSpace(h) => Self::HalfSpace(HalfSpace {
                point: map.apply(h.point),
                normal: map.apply_vector(h.normal),
            }),
        }
    }

    pub(crate) fn checked(&self) -> Result<Checked, PrimitiveError> {
        Ok(match *self {
            Self::Ball(Ball { center, radius }) => {
                let center = place("center", center)?;
                Checked::Round(Revolved::segment([center; 2], length("radius", radius)?))
            }
            Self::Capsule(Capsule { ends: [a, b], radius }) => {
                let ends = [place("end", a)?, place("end", b)?];
                Checked::Round(Revolved::segment(ends, length("radius", radius)?))
            }
            Self::Segment(Segment { ends: [a, b] }) => {
                Checked::Round(Revolved::segment([place("end", a)?, place("end", b)?], 0.0))
            }
            Self::Cylinder(Cylinder { center, axis, half_height, radius, border }) => {
                Checked::Round(Revolved::cylinder(
                    place("center", center)?,
                    direction("axis", axis)?,
                    length("half height", half_height)?,
                    length("radius", radius)?,
                    length("border", border)?,
                ))
            }
            Self::Cone(Cone { center, axis, half_height, radius, border }) => {
                Checked::Round(Revolved::cone(
                    place("center", center)?,
                    direction("axis", axis)?,
                    length("half height", half_height)?,
                    length("radius", radius)?,
                    length("border", border)?,
                ))
            }
            Self::HalfSpace(HalfSpace { point, normal }) => {
                let normal = direction("normal", normal)?;
                let offset = normal.dot(place("point", point)?);
                Checked::HalfSpace(Plane { normal, offset })
            }
        })
    }
}

pub(crate) fn place(what: &'static str, value: DVec3) -> Result<DVec3, PrimitiveError> {
    value.is_finite().then_some(value).ok_or(PrimitiveError::Place { what, value })
}

/// Unit.
pub(crate) fn direction(what: &'static str, value: DVec3) -> Result<DVec3, PrimitiveError> {
    value.try_normalize().ok_or(PrimitiveError::Direction { what, value })
}

fn length(what: &'static str, value: f64) -> Result<f64, PrimitiveError> {
    let good = value >= 0.0 && value.is_finite();
    good.then_some(value).ok_or(PrimitiveError::Length { what, value })
}

macro_rules! is_a_primitive {
    ($($shape:ident)*) => {
        $(impl From<$shape> for Primitive {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape)
            }
        })*
    };
}

is_a_primitive!(Ball Capsule Segment Cylinder Cone HalfSpace);
