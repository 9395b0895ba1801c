//! Mass, centre and inertia of the solid, for rapier.

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
