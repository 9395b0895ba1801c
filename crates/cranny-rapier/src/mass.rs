//! Mass, centre and inertia for rapier: of the solid, or as stated.

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::Model;
use rapier3d::math::{Matrix, Real};
use rapier3d::parry::mass_properties::MassProperties;
use thiserror::Error;

use crate::convert::narrow;

/// A body without mass.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MassError {
    /// The mesh bounds no solid.
    #[error(
        "the mesh is not closed, so it has no volume and no mass: close it, or make the body fixed or kinematic"
    )]
    NotClosed,
    /// The mass is no positive number that rapier can hold.
    #[error("volume {volume:e} x density {density:e} is no positive mass that rapier can hold")]
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
    /// The solid that its mesh bounds, at a density.
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

    /// rapier's mass properties of a body of this model.
    ///
    /// # Errors
    ///
    /// [`MassError`]: there is no solid, or a number is out of range.
    pub(crate) fn properties(&self, model: &Model) -> Result<MassProperties, MassError> {
        match *self {
            Self::Density(density) => mass_properties(model, density),
            Self::Stated(stated) => stated.properties(),
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
