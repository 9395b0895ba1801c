//! What the components of a body say to the solver.

use bevy_ecs::query::QueryData;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_rapier::{BodySpec, MassSource, SimulationError};
use cranny_world::description::{BodyKind, StatedMass};

use super::Known;
use crate::body::{pose_of, widened};
use crate::properties::{
    AngularDamping, AngularVelocity, Density, ExternalForce, Friction, GravityScale, LinearDamping,
    LinearVelocity, LockedAxes, Mass, Restitution,
};

/// The components that the solver reads of a body.
#[derive(QueryData)]
pub(crate) struct Given {
    transform: &'static Transform,
    linear: &'static LinearVelocity,
    angular: &'static AngularVelocity,
    friction: Option<&'static Friction>,
    restitution: Option<&'static Restitution>,
    pub(super) density: Option<&'static Density>,
    pub(super) mass: Option<&'static Mass>,
    gravity: Option<&'static GravityScale>,
    linear_damping: Option<&'static LinearDamping>,
    angular_damping: Option<&'static AngularDamping>,
    locked: Option<&'static LockedAxes>,
    force: Option<&'static ExternalForce>,
}

/// Their values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GivenValues {
    pub(super) transform: Transform,
    pub(super) velocities: [Vec3; 2],
    pub(super) friction: Friction,
    pub(super) restitution: Restitution,
    pub(super) density: Density,
    pub(super) mass: Option<Mass>,
    pub(super) gravity: GravityScale,
    pub(super) linear_damping: LinearDamping,
    pub(super) angular_damping: AngularDamping,
    pub(super) locked: LockedAxes,
    pub(super) force: ExternalForce,
}

impl GivenItem<'_, '_> {
    pub(super) fn values(&self) -> GivenValues {
        GivenValues {
            transform: *self.transform,
            velocities: [self.linear.0, self.angular.0],
            friction: self.friction.copied().unwrap_or_default(),
            restitution: self.restitution.copied().unwrap_or_default(),
            density: self.density.copied().unwrap_or_default(),
            mass: self.mass.copied(),
            gravity: self.gravity.copied().unwrap_or_default(),
            linear_damping: self.linear_damping.copied().unwrap_or_default(),
            angular_damping: self.angular_damping.copied().unwrap_or_default(),
            locked: self.locked.copied().unwrap_or_default(),
            force: self.force.copied().unwrap_or_default(),
        }
    }
}

impl GivenValues {
    pub(super) fn mass_source(&self) -> MassSource {
        match self.mass {
            None => MassSource::Density(self.density.0),
            Some(Mass(StatedMass { mass, center, inertia })) => {
                MassSource::Stated(cranny_rapier::StatedMass { mass, center, inertia })
            }
        }
    }

    /// The body that a record and these values describe.
    pub(super) fn spec(&self, known: &Known) -> BodySpec {
        BodySpec {
            shape: known.shape.clone(),
            kind: super::rapier_kind(known.kind),
            pose: pose_of(&self.transform),
            linear_velocity: widened(self.velocities[0]),
            angular_velocity: widened(self.velocities[1]),
            mass: self.mass_source(),
            friction: self.friction.coefficient.into(),
            restitution: self.restitution.coefficient.into(),
            normals: known.normals,
            groups: known.layers.memberships,
        }
    }

    /// Fails if the solver would not take a number.
    pub(super) fn check(&self, known: &Known) -> Result<(), SimulationError> {
        self.spec(known).check()?;
        let [force, torque] = [self.force.force, self.force.torque].map(|v| v.to_array());
        let forces = force.map(|x| ("force", x)).into_iter();
        let numbers = forces.chain(torque.map(|x| ("torque", x)));
        for (what, value) in numbers.chain([("gravity scale", self.gravity.0)]) {
            if !value.is_finite() {
                let (value, expected) = (value.into(), "a finite number");
                return Err(SimulationError::Number { what, value, expected });
            }
        }
        self.check_damping()
    }

    fn check_damping(&self) -> Result<(), SimulationError> {
        let numbers = [
            ("linear damping", self.linear_damping.0),
            ("angular damping", self.angular_damping.0),
        ];
        let refused = |value: f64| !(value >= 0.0 && (value as f32).is_finite());
        match numbers.into_iter().find(|&(_, value)| refused(value)) {
            Some((what, value)) => {
                let expected = "a finite number, 0 or more";
                Err(SimulationError::Number { what, value, expected })
            }
            None => Ok(()),
        }
    }

    /// Linear and angular, for the solver: what moves by its own velocity loses none.
    pub(super) fn damping(&self, kind: BodyKind) -> [f64; 2] {
        match kind {
            BodyKind::Dynamic => [self.linear_damping.0, self.angular_damping.0],
            _ => [0.0; 2],
        }
    }
}
