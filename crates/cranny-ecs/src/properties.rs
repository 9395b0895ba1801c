//! What a body may have beside its geometry: motion, material, layers, forces.
//!
//! A component that is not there means its default. Those that are [immutable] are changed by
//! inserting another one. All changes count in the next step.
//!
//! [immutable]: Component#component-mutability

use bevy_ecs::prelude::*;
use bevy_math::{BVec3, Vec3};
use bevy_transform::components::Transform;
use cranny_world::Layers;
use cranny_world::description::{BodyKind, Normals, StatedMass};

use crate::admission::{note_change, note_removal, note_rule, note_sensor};

/// How a body moves.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
#[require(Transform)]
pub enum RigidBody {
    /// As forces and contacts say; without [`Response`](crate::Response) it stands still.
    #[default]
    Dynamic,
    /// With its velocities, whatever it meets.
    Kinematic,
    /// Not at all.
    Fixed,
}

impl From<RigidBody> for BodyKind {
    fn from(body: RigidBody) -> Self {
        match body {
            RigidBody::Dynamic => Self::Dynamic,
            RigidBody::Kinematic => Self::Kinematic,
            RigidBody::Fixed => Self::Fixed,
        }
    }
}

impl From<BodyKind> for RigidBody {
    fn from(kind: BodyKind) -> Self {
        match kind {
            BodyKind::Dynamic => Self::Dynamic,
            BodyKind::Kinematic => Self::Kinematic,
            BodyKind::Fixed => Self::Fixed,
        }
    }
}

/// Velocity of a body's centre of mass, units of length a second, world axes. The solver writes
/// what it has at the end of a step; whoever writes another one changes it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct LinearVelocity(pub Vec3);

/// Angular velocity of a body, radians a second, world axes; written and changed as
/// [`LinearVelocity`] is.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct AngularVelocity(pub Vec3);

/// Coulomb's coefficient; of two bodies the mean counts.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(on_add = note_rule)]
pub struct Friction {
    /// At least 0.
    pub coefficient: f32,
}

impl Friction {
    /// Of a coefficient.
    #[must_use]
    pub const fn new(coefficient: f32) -> Self {
        Self { coefficient }
    }
}

impl Default for Friction {
    fn default() -> Self {
        Self::new(0.5)
    }
}

/// How much of the speed at which a body meets another is given back; of two bodies the mean
/// counts.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct Restitution {
    /// 0: no bounce; 1: full bounce.
    pub coefficient: f32,
}

impl Restitution {
    /// Of a coefficient.
    #[must_use]
    pub const fn new(coefficient: f32) -> Self {
        Self { coefficient }
    }
}

/// Mass per volume of a dynamic body, > 0; 1 where none is said. Mass, centre and inertia follow
/// from it and from the solid that the mesh bounds.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(on_add = note_rule)]
pub struct Density(pub f64);

impl Default for Density {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Mass, centre and inertia of a dynamic body as stated, in place of those that follow from
/// [`Density`] and the solid: its mesh need not bound one then.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(on_add = note_rule)]
pub struct Mass(pub StatedMass);

/// By what gravity is multiplied for a body.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(on_add = note_rule)]
pub struct GravityScale(pub f32);

impl Default for GravityScale {
    fn default() -> Self {
        Self(1.0)
    }
}

/// How fast a dynamic body loses linear velocity, a second: `v' = -damping * v`; finite and at
/// least 0, without it 0. A link of a [reduced](crate::Joint::reduced) joint has its joint's
/// resistance instead.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct LinearDamping(pub f64);

/// How fast a dynamic body loses angular velocity; as [`LinearDamping`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct AngularDamping(pub f64);

/// Beside a dynamic body that the solver has put to sleep: it rests, and costs nothing until
/// something touches or changes it. Each step inserts and removes it; what an app writes moves
/// nothing.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, storage = "SparseSet")]
pub struct Sleeping;

/// Motions that a dynamic body cannot make, world axes.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(on_add = note_rule)]
pub struct LockedAxes {
    /// Along x, y, z.
    pub translation: BVec3,
    /// About x, y, z.
    pub rotation: BVec3,
}

impl LockedAxes {
    /// No rotation.
    pub const ROTATION_LOCKED: Self = Self { translation: BVec3::FALSE, rotation: BVec3::TRUE };
    /// No translation.
    pub const TRANSLATION_LOCKED: Self = Self { translation: BVec3::TRUE, rotation: BVec3::FALSE };
}

/// A force at a body's centre of mass and a torque, world axes, which act in every step while the
/// component is there.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct ExternalForce {
    /// Mass x length / second².
    pub force: Vec3,
    /// Force x length.
    pub torque: Vec3,
}

/// A change of momentum, which acts once: the next step takes it and leaves zeros.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(on_add = note_rule)]
pub struct ExternalImpulse {
    /// At the centre of mass: mass x length / second.
    pub impulse: Vec3,
    /// Mass x length² / second.
    pub torque_impulse: Vec3,
}

/// In which of 32 layers a body is, and with which it meets, as bits: two bodies meet where each is
/// in a layer that the other meets. Layers that scene files name have numbers
/// ([`LayerNames`](crate::LayerNames)); "all" is the first.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct CollisionLayers(pub Layers);

impl CollisionLayers {
    /// In these layers, and meets those.
    #[must_use]
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self(Layers { memberships, filters })
    }

    /// In some layers, and meets whoever shares one.
    #[must_use]
    pub const fn shared(layers: u32) -> Self {
        Self(Layers::shared(layers))
    }
}

/// A body that is noticed and never pushes: it has every effect but `Response`.
///
/// One that nothing would notice brings [`Trigger`](crate::Trigger) along: where it is inserted and
/// neither a component beside it nor an effect of all bodies notices anything. Whoever wants to
/// hear nothing of it for a while removes the `Trigger`. Scenes say by name what notices a sensor.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_sensor, on_remove = note_removal)]
pub struct Sensor;

/// A body whose contacts have, for the solver, the normals of the curved surface that its facets
/// stand for.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct SmoothNormals {
    /// Radians: edges that are sharper stay edges.
    pub crease_angle: f64,
}

impl SmoothNormals {
    /// The normals that a body with this component, or without one, has.
    pub(crate) fn normals(smooth: Option<&Self>) -> Normals {
        smooth.map_or(Normals::Flat, |smooth| Normals::Smooth { crease_angle: smooth.crease_angle })
    }
}
