//! What is inserted into a simulation, and what is refused.

use cranny_exact::{DVec3, Pose, PoseError};
use cranny_narrow_phase::Normals;
use cranny_primitives::BodyShape;
use rapier3d::math::Real;
use thiserror::Error;

use crate::mass::{MassError, MassSource};
use crate::shape::ShapeError;

/// How a body moves.
///
/// `cranny_world::description::BodyKind` says the same of a scene's bodies. Neither crate may
/// depend on the other (a solver is no part of a world), and no crate beneath both knows who moves:
/// so there are two, and `cranny-ecs` converts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyKind {
    /// Not at all.
    Fixed,
    /// With its given velocity, whatever it meets.
    Kinematic,
    /// As forces and contacts say.
    Dynamic,
}

/// A body to be inserted.
#[derive(Clone, Debug)]
pub struct BodySpec {
    /// Geometry: a model, or a primitive, which is rapier's own shape then.
    pub shape: BodyShape,
    /// How it moves.
    pub kind: BodyKind,
    /// Where it starts.
    pub pose: Pose,
    /// Units a second.
    pub linear_velocity: DVec3,
    /// Radians a second.
    pub angular_velocity: DVec3,
    /// Where its mass comes from; read of dynamic bodies.
    pub mass: MassSource,
    /// Coulomb coefficient.
    pub friction: f64,
    /// 0 to 1.
    pub restitution: f64,
    /// Whose normals its contacts have for the solver: its facets' or, opted in, those of the
    /// curved surface that they stand for
    /// ([`MeshShape::with_smooth_normals`](crate::MeshShape::with_smooth_normals)). Our detector
    /// only.
    pub normals: Normals,
    /// Bodies meet where their bits overlap.
    pub groups: u32,
}

/// A body of a simulation, counted from 0 in order of insertion. The number of a body that has left
/// is free, and is given to a later one; until then whatever takes a number panics on it, but for
/// [`contains`](super::Simulation::contains) and [`remove`](super::Simulation::remove).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyIndex(pub u32);

/// A body that cannot be inserted.
#[derive(Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// Its shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Its mass.
    #[error(transparent)]
    Mass(#[from] MassError),
    /// Its pose.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// Another number.
    #[error("{what} is {value}: it must be {expected}")]
    Number {
        /// Which field of [`BodySpec`].
        what: &'static str,
        /// The value found.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for SimulationError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl BodySpec {
    /// Whether a simulation takes the numbers: rapier would carry what is none into every pose that
    /// it touches. The mass depends on the solid, and is looked at by whoever makes it.
    ///
    /// # Errors
    ///
    /// [`SimulationError`]: a pose that is none, a number of a primitive, a velocity or coefficient
    /// out of range.
    pub fn check(&self) -> Result<(), SimulationError> {
        Pose::checked(self.pose.rotation, self.pose.translation)?;
        self.shape.check().map_err(ShapeError::from)?;
        check_numbers(self)
    }
}

fn check_numbers(spec: &BodySpec) -> Result<(), SimulationError> {
    let (linear, angular) = (spec.linear_velocity, spec.angular_velocity);
    let velocities = linear.to_array().map(|v| ("linear velocity", v)).into_iter();
    let velocities = velocities.chain(angular.to_array().map(|v| ("angular velocity", v)));
    for (what, value) in velocities {
        if !(value as Real).is_finite() {
            return Err(SimulationError::Number {
                what,
                value,
                expected: "a number that rapier can hold",
            });
        }
    }
    for (what, value) in [("friction", spec.friction), ("restitution", spec.restitution)] {
        if !(value >= 0.0 && (value as Real).is_finite()) {
            let expected = "a finite number, 0 or more";
            return Err(SimulationError::Number { what, value, expected });
        }
    }
    Ok(())
}
