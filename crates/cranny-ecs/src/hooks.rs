//! What an app decides about pairs while the solver makes a step.

use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use bevy_ecs::query::{QueryData, QueryFilter};
use bevy_math::Vec3;
use cranny_rapier::{BodyIndex, SolvedContacts, StepHooks};

use crate::body::{narrowed, widened};
use crate::effects::{EffectKind, EffectTable};
use crate::solved::Known;

/// Decides about pairs while the solver makes a step: which of them respond to each other, and what
/// the solver gets of their contacts. A system parameter, so it reads components and resources as a
/// system does; [`CrannyPlugins::hooks`](crate::CrannyPlugins::hooks) puts it in.
///
/// A step may be made in parts, and each decides anew. Equal states must lead to equal decisions,
/// or else a run cannot be repeated. A pair at rest sleeps: nothing is decided about it until it
/// wakes.
///
/// ```
/// use bevy_ecs::prelude::*;
/// use bevy_ecs::system::SystemParam;
/// use cranny_ecs::{CollisionHooks, CrannyPlugins, SolverContacts};
///
/// /// The surface of a body moves, in the world, as a belt does.
/// #[derive(Component)]
/// struct Belt(bevy_math::Vec3);
///
/// #[derive(SystemParam)]
/// struct Belts<'w, 's> {
///     belts: Query<'w, 's, &'static Belt>,
/// }
///
/// impl CollisionHooks for Belts<'_, '_> {
///     fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
///         if let Some((belt, _)) = contacts.one_of(&self.belts) {
///             contacts.drive(belt, self.belts.get(belt).map_or(bevy_math::Vec3::ZERO, |b| b.0));
///         }
///         true
///     }
/// }
///
/// let plugins = CrannyPlugins::new(1.0 / 60.0)?.hooks::<Belts>();
/// # Ok::<(), cranny_ecs::SceneAppError>(())
/// ```
pub trait CollisionHooks: Send + Sync {
    /// Whether two bodies that may meet respond to each other in this step. They are still detected
    /// for other effects: `Trigger` reports them.
    fn filter_pairs(&self, body: Entity, other: Entity) -> bool {
        let _ = (body, other);
        true
    }

    /// Changes contacts of one normal before they are solved; `false` leaves them out.
    fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
        let _ = contacts;
        true
    }
}

/// Contacts of one normal, as the solver is about to get them.
pub struct SolverContacts<'a, 'm> {
    /// Both bodies, the lower id first.
    pub bodies: [Entity; 2],
    /// Whether the solver has them the other way round.
    turned: bool,
    contacts: &'a mut SolvedContacts<'m>,
}

impl SolverContacts<'_, '_> {
    /// The first of both bodies that a query finds, and the other one.
    #[must_use]
    pub fn one_of<D, F>(&self, query: &Query<'_, '_, D, F>) -> Option<(Entity, Entity)>
    where
        D: QueryData,
        F: QueryFilter,
    {
        let [a, b] = self.bodies;
        [(a, b), (b, a)].into_iter().find(|(body, _)| query.contains(*body))
    }

    /// The unit normal out of one of the two bodies, in the world; that out of the first for any
    /// other entity.
    #[must_use]
    pub fn normal_out_of(&self, body: Entity) -> Vec3 {
        let normal = narrowed(self.contacts.normal());
        if self.turned == (body == self.bodies[1]) { normal } else { -normal }
    }

    /// The least separation of the contacts, along the normal: < 0 where the bodies overlap.
    #[must_use]
    pub fn separation(&self) -> f64 {
        self.contacts.points().map(|(_, separation)| separation).fold(f64::INFINITY, f64::min)
    }

    /// Lets friction drive whatever touches the surface of one of the two bodies as if that surface
    /// moved by so much, world axes, units of length a second.
    pub fn drive(&mut self, body: Entity, surface: Vec3) {
        let surface = widened(surface);
        let of_first = (body == self.bodies[0]) != self.turned;
        self.contacts.set_surface_velocity(if of_first { surface } else { -surface });
    }

    /// Coulomb's coefficient.
    #[must_use]
    pub fn friction(&self) -> f64 {
        self.contacts.friction()
    }

    /// Sets Coulomb's coefficient.
    pub fn set_friction(&mut self, coefficient: f64) {
        self.contacts.set_friction(coefficient);
    }

    /// The share of the speed that a collision gives back.
    #[must_use]
    pub fn restitution(&self) -> f64 {
        self.contacts.restitution()
    }

    /// Sets the share of the speed that a collision gives back.
    pub fn set_restitution(&mut self, coefficient: f64) {
        self.contacts.set_restitution(coefficient);
    }
}

/// Decides nothing.
impl CollisionHooks for () {}

/// What decides while the solver makes a step: the effects of pairs, and an app's hooks.
pub(crate) struct Deciding<'a, H> {
    pub(crate) hooks: &'a H,
    pub(crate) effects: &'a EffectTable,
    pub(crate) members: &'a BTreeMap<BodyIndex, Known>,
}

impl<H> Deciding<'_, H> {
    /// Two bodies of these numbers, the lower id first, and whether that exchanges them. `None` for
    /// bodies that were put into the solver's world by hand.
    fn members(&self, a: BodyIndex, b: BodyIndex) -> Option<([&Known; 2], bool)> {
        let [a, b] = [self.members.get(&a)?, self.members.get(&b)?];
        Some(if a.id < b.id { ([a, b], false) } else { ([b, a], true) })
    }
}

impl<H: CollisionHooks> StepHooks for Deciding<'_, H> {
    fn responds(&self, a: BodyIndex, b: BodyIndex) -> bool {
        self.members(a, b).is_none_or(|([a, b], _)| {
            self.effects.asks(EffectKind::Response, a.id, b.id)
                && self.hooks.filter_pairs(a.entity, b.entity)
        })
    }

    fn modify(&self, contacts: &mut SolvedContacts<'_>) {
        let [a, b] = contacts.bodies;
        let Some((members, turned)) = self.members(a, b) else { return };
        let bodies = members.map(|member| member.entity);
        if !self.hooks.modify_contacts(&mut SolverContacts { bodies, turned, contacts }) {
            contacts.clear();
        }
    }
}
