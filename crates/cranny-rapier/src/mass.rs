//! Mass, centre and inertia for rapier: of the solid, or as stated.

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::Model;
use cranny_primitives::{BodyShape, Primitive};
use rapier3d::math::{Matrix, Pose, Real};
use rapier3d::parry::mass_properties::MassProperties;
use thiserror::Error;

use crate::convert::narrow;
use crate::partners::placed;

/// A body without mass.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MassError {
    /// The mesh bounds no solid.
    #[error(
        "the mesh is not closed, so it has no volume and no mass: close it, state the mass, or make the body fixed or kinematic"
    )]
    NotClosed,
    /// A primitive that bounds no solid.
    #[error("a {what} has no mass: make the body fixed or kinematic")]
    NoVolume {
        /// "half-space" or "segment".
        what: &'static str,
    },
    /// The mass is no positive number that rapier can hold.
    #[error(
        "volume {volume:e} x density {density:e} is no positive mass that rapier can hold: give a density above 0 and a shape that encloses more than it leaves out, or state the mass"
    )]
    NotPositive {
        /// Volume of the solid.
        volume: f64,
        /// The density.
        density: f64,
    },
    /// A stated mass, centre or inertia is out of range.
    #[error(
        "the stated mass {mass:e}, of which the least principal moment is {least_moment:e}, is none that rapier can hold: mass, centre and inertia must be finite, mass and moments greater than 0"
    )]
    Stated {
        /// The mass.
        mass: f64,
        /// NaN where it is not known.
        least_moment: f64,
    },
}

/// Mass, centre and inertia of a body, as somebody states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedMass {
    /// Greater than 0.
    pub mass: f64,
    /// In the body's frame.
    pub center: DVec3,
    /// About the centre, along the axes of the body's frame: symmetric, positive definite.
    pub inertia: DMat3,
}

/// Where a body's mass comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MassSource {
    /// The solid that its mesh bounds, at a density; of a primitive, the solid without its border.
    Density(f64),
    /// What is stated, whatever the mesh.
    Stated(StatedMass),
}

impl From<f64> for MassSource {
    fn from(density: f64) -> Self {
        Self::Density(density)
    }
}

impl MassSource {
    /// The stated centre, if one is.
    pub(crate) fn center(&self) -> Option<DVec3> {
        match self {
            Self::Density(_) => None,
            Self::Stated(stated) => Some(stated.center),
        }
    }

    /// rapier's mass properties of a collider of this shape, in the collider's frame.
    ///
    /// # Errors
    ///
    /// [`MassError`]: there is no solid, or a number is out of range.
    pub(crate) fn properties(&self, shape: &BodyShape) -> Result<MassProperties, MassError> {
        match (*self, shape) {
            (Self::Density(density), BodyShape::Model(model)) => mass_properties(model, density),
            (Self::Density(density), BodyShape::Primitive(primitive)) => {
                of_primitive(primitive, density)
            }
            (Self::Stated(stated), _) => {
                let place = shape.primitive().map_or(Pose::IDENTITY, |p| placed(p).0);
                Ok(stated.properties()?.transform_by(&place.inverse()))
            }
        }
    }
}

impl StatedMass {
    /// # Errors
    ///
    /// [`MassError::Stated`].
    fn properties(&self) -> Result<MassProperties, MassError> {
        let Self { mass, center, inertia: i } = *self;
        let narrowed = mass as Real;
        let finite = center.is_finite() && i.is_finite() && narrowed.is_finite();
        if !(finite && narrowed > 0.0) {
            return Err(MassError::Stated { mass, least_moment: f64::NAN });
        }
        let matrix = Matrix::from_cols(narrow(i.x_axis), narrow(i.y_axis), narrow(i.z_axis));
        let properties = MassProperties::with_inertia_matrix(narrow(center), narrowed, matrix);
        let least = properties.principal_inertia().min_element();
        if least > 0.0 && least.is_finite() {
            return Ok(properties);
        }
        Err(MassError::Stated { mass, least_moment: least.into() })
    }
}

/// rapier's own of a primitive, in its collider's frame.
fn of_primitive(primitive: &Primitive, density: f64) -> Result<MassProperties, MassError> {
    let what = primitive.name();
    if matches!(primitive, Primitive::HalfSpace(_) | Primitive::Segment(_)) {
        return Err(MassError::NoVolume { what });
    }
    let mass = placed(primitive).1.mass_properties(density as Real);
    if mass.mass() > 0.0 && mass.mass().is_finite() {
        return Ok(mass);
    }
    let volume = f64::from(placed(primitive).1.mass_properties(1.0).mass());
    Err(MassError::NotPositive { volume, density })
}

/// Mass properties of the solid that the model bounds, computed in f64.
///
/// # Errors
///
/// [`MassError`] where there is no solid or no positive mass.
pub fn mass_properties(model: &Model, density: f64) -> Result<MassProperties, MassError> {
    let solid = model.mass_properties().ok_or(MassError::NotClosed)?;
    let mass = (solid.volume * density) as Real;
    if !(mass > 0.0 && mass.is_finite()) {
        return Err(MassError::NotPositive { volume: solid.volume, density });
    }
    let i = solid.inertia * density;
    let inertia = Matrix::from_cols(narrow(i.x_axis), narrow(i.y_axis), narrow(i.z_axis));
    Ok(MassProperties::with_inertia_matrix(narrow(solid.center), mass, inertia))
}
