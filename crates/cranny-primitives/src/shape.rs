//! What a body is made of: a prepared mesh, or a primitive in the body's frame.

use cranny_exact::domain::MAX_COORDINATE;
use cranny_exact::{Aabb, DVec3, RigidMap};
use cranny_geometry::{MassProperties, Model};

use crate::convex::placed;
use crate::deep;
use crate::primitive::{
    Ball, Capsule, Checked, Cone, Cylinder, HalfSpace, Plane, Primitive, PrimitiveError, Segment,
};

/// What a body is made of.
#[derive(Clone, Debug)]
pub enum BodyShape {
    /// A prepared mesh.
    Model(Model),
    /// A primitive, placed in the body's frame.
    Primitive(Primitive),
}

impl From<Model> for BodyShape {
    fn from(model: Model) -> Self {
        Self::Model(model)
    }
}

impl From<&Model> for BodyShape {
    fn from(model: &Model) -> Self {
        Self::Model(model.clone())
    }
}

impl From<&Self> for BodyShape {
    fn from(shape: &Self) -> Self {
        shape.clone()
    }
}

impl From<Primitive> for BodyShape {
    fn from(primitive: Primitive) -> Self {
        Self::Primitive(primitive)
    }
}

impl BodyShape {
    /// The prepared mesh, if it is one.
    #[must_use]
    pub fn model(&self) -> Option<&Model> {
        match self {
            Self::Model(model) => Some(model),
            Self::Primitive(_) => None,
        }
    }

    /// The primitive, if it is one.
    #[must_use]
    pub fn primitive(&self) -> Option<&Primitive> {
        match self {
            Self::Model(_) => None,
            Self::Primitive(primitive) => Some(primitive),
        }
    }

    /// Whether it is the same model, or a primitive of equal numbers.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Model(a), Self::Model(b)) => a.is_same(b),
            (Self::Primitive(a), Self::Primitive(b)) => a == b,
            _ => false,
        }
    }

    /// Fails if a number of a primitive is invalid.
    ///
    /// # Errors
    ///
    /// [`PrimitiveError`].
    pub fn check(&self) -> Result<(), PrimitiveError> {
        self.primitive().map_or(Ok(()), Primitive::check)
    }

    /// The centre of mass at an even density, in the body's frame: the origin where a mesh bounds
    /// no volume, the point of the plane for a half-space.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        match self {
            Self::Model(model) => model.mass_properties().map_or(DVec3::ZERO, |mass| mass.center),
            Self::Primitive(primitive) => primitive.center(),
        }
    }

    /// The radius of a ball about a point of the body's frame that holds the shape; infinite for a
    /// half-space.
    #[must_use]
    pub fn radius_about(&self, center: DVec3) -> f64 {
        match self {
            Self::Model(model) => {
                let away = |p: &DVec3| p.distance(center);
                model.mesh().vertices().iter().map(away).fold(0.0, f64::max)
            }
            Self::Primitive(primitive) => primitive.radius_about(center),
        }
    }

    /// A bound of the distance of its points from the body's origin; infinite for a half-space.
    #[must_use]
    pub fn radius(&self) -> f64 {
        match self {
            Self::Model(model) => model.radius(),
            Self::Primitive(primitive) => primitive.radius_about(DVec3::ZERO),
        }
    }

    /// Twice its volume per area; infinite where it bounds no volume, and for a half-space.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        match self {
            Self::Model(model) => deep::thickness(model),
            Self::Primitive(primitive) => primitive.thickness(),
        }
    }

    /// A box that holds the shape in another frame, rounded outward. That of a half-space has faces
    /// at [`MAX_COORDINATE`], but for the one along its normal where that is an axis of the frame:
    /// it is large, and valid.
    #[must_use]
    pub fn bounds(&self, to_from_body: &RigidMap) -> Aabb {
        match self {
            Self::Model(model) => to_from_body.bounds(&model.bounds()),
            Self::Primitive(primitive) => primitive.moved(to_from_body).bounds(),
        }
    }
}

impl Primitive {
    /// Fails if a number is invalid.
    ///
    /// # Errors
    ///
    /// [`PrimitiveError`].
    pub fn check(&self) -> Result<(), PrimitiveError> {
        self.checked().map(|_| ())
    }

    /// Volume, centre and inertia at an even density; `None` of what bounds no volume: a segment, a
    /// half-space, and what has no thickness or invalid numbers.
    #[must_use]
    pub fn mass_properties(&self) -> Option<MassProperties> {
        if matches!(self, Self::Segment(_) | Self::HalfSpace(_)) || self.check().is_err() {
            return None;
        }
        let (pose, shape) = placed(self);
        let mass = shape.mass_properties(1.0).transform_by(&pose);
        let (volume, center) = (mass.mass(), mass.local_com);
        let inertia = mass.reconstruct_inertia_matrix();
        (volume > 0.0 && volume.is_finite()).then_some(MassProperties { volume, center, inertia })
    }

    /// Its name: "ball", "half-space".
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ball(_) => "ball",
            Self::Capsule(_) => "capsule",
            Self::Segment(_) => "segment",
            Self::Cylinder(_) => "cylinder",
            Self::Cone(_) => "cone",
            Self::HalfSpace(_) => "half-space",
        }
    }

    /// The centre of mass at an even density; the point of the plane for a half-space. (Of a cone
    /// with a border, that of the cone.)
    #[must_use]
    pub fn center(&self) -> DVec3 {
        match *self {
            Self::Ball(Ball { center, .. }) | Self::Cylinder(Cylinder { center, .. }) => center,
            Self::Capsule(Capsule { ends: [a, b], .. })
            | Self::Segment(Segment { ends: [a, b] }) => 0.5 * (a + b),
            // A quarter of the height above the base.
            Self::Cone(Cone { center, axis, half_height, .. }) => {
                center - 0.5 * half_height * axis.normalize_or_zero()
            }
            Self::HalfSpace(HalfSpace { point, .. }) => point,
        }
    }

    /// The radius of a ball about a point that holds it; infinite for a half-space.
    #[must_use]
    pub fn radius_about(&self, p: DVec3) -> f64 {
        match self.checked() {
            Ok(Checked::Round(solid)) => {
                let reach = |(radius, center): (f64, DVec3)| radius + center.distance(p);
                solid.circles().map(reach).fold(0.0, f64::max) + solid.radius()
            }
            _ => f64::INFINITY,
        }
    }

    /// The greatest product of a point of it with a unit direction; infinite for a half-space.
    pub(crate) fn reach(&self, direction: DVec3) -> f64 {
        match self.checked() {
            Ok(Checked::Round(solid)) => solid.core_reach(direction) + solid.radius(),
            _ => f64::INFINITY,
        }
    }

    /// Twice its volume per area, of cylinders and cones without their border; infinite for
    /// segments, discs and half-spaces.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        let thickness = match *self {
            Self::Ball(Ball { radius, .. }) => 2.0 / 3.0 * radius,
            Self::Capsule(Capsule { ends: [a, b], radius: r }) => {
                let length = a.distance(b);
                r * (length + 4.0 / 3.0 * r) / (length + 2.0 * r)
            }
            Self::Cylinder(Cylinder { half_height: h, radius: r, .. }) => {
                2.0 * r * h / (r + 2.0 * h)
            }
            Self::Cone(Cone { half_height: h, radius: r, .. }) => {
                4.0 / 3.0 * r * h / (r + (r * r + 4.0 * h * h).sqrt())
            }
            Self::Segment(_) | Self::HalfSpace(_) => f64::INFINITY,
        };
        if thickness > 0.0 { thickness } else { f64::INFINITY }
    }

    /// The box of it, rounded outward: [`BodyShape::bounds`] says which one a half-space has. The
    /// whole domain where a number is invalid.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self.checked() {
            Ok(Checked::Round(solid)) => solid.bounds(),
            Ok(Checked::HalfSpace(plane)) => half_space_bounds(&plane),
            Err(_) => WHOLE,
        }
    }
}

/// All that has coordinates.
const WHOLE: Aabb = Aabb { min: DVec3::splat(-MAX_COORDINATE), max: DVec3::splat(MAX_COORDINATE) };

/// The whole domain, up to the plane where that is square to an axis.
fn half_space_bounds(&Plane { normal, offset }: &Plane) -> Aabb {
    let mut bounds = WHOLE;
    for axis in 0..3 {
        // A hair's turn lifts the plane far away.
        let others = [normal[(axis + 1) % 3], normal[(axis + 2) % 3]];
        if others != [0.0; 2] {
            continue;
        }
        if normal[axis] > 0.0 {
            bounds.max[axis] = offset.next_up();
        } else {
            bounds.min[axis] = (-offset).next_down();
        }
    }
    bounds
}
