//! What a program decides about pairs while a step is made: which respond to each other, and what
//! the solver gets of their contacts.

use cranny_exact::DVec3;
use rapier3d::geometry::{ColliderHandle, ColliderSet};
use rapier3d::math::Real;
use rapier3d::pipeline::{ContactModificationContext, ModifiableManifold, PairFilterContext};
use rapier3d::prelude::{ActiveHooks, PhysicsHooks, SolverFlags};

use super::{BodyIndex, Simulation};
use crate::convert::{narrow, wide};

/// Decides about pairs while [`Simulation::step_with`] makes a step. A step may be made in parts,
/// and each part decides anew.
///
/// The same state must lead to the same decisions, or else a run cannot be repeated.
pub trait StepHooks: Sync {
    /// Whether two bodies whose boxes overlap respond to each other; the lower number comes first.
    fn responds(&self, a: BodyIndex, b: BodyIndex) -> bool {
        let _ = (a, b);
        true
    }

    /// Changes contacts of a pair before they are solved. Called for each set of contacts of one
    /// normal.
    fn modify(&self, contacts: &mut SolvedContacts<'_>) {
        let _ = contacts;
    }
}

/// No decisions: all that may meet respond.
impl StepHooks for () {}

/// Contacts of one normal, as the solver is about to get them.
///
/// The body with the lower number is the first.
pub struct SolvedContacts<'a> {
    /// Both bodies.
    pub bodies: [BodyIndex; 2],
    /// Whether rapier has the bodies the other way round.
    turned: bool,
    manifold: ModifiableManifold<'a>,
}

impl SolvedContacts<'_> {
    /// Unit normal, from the first body to the second, in the world.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        let normal = wide(*self.manifold.normal);
        if self.turned { -normal } else { normal }
    }

    /// Points on the first body in the world, each with its separation along the normal: < 0 where
    /// the bodies overlap.
    pub fn points(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let turned = self.turned;
        self.manifold.solver_contacts.iter().map(move |contact| {
            let on_first = if turned { contact.anchor2 } else { contact.anchor1 };
            (wide(on_first), contact.dist.into())
        })
    }

    /// Leaves out the contacts for which `keep` is false of point and separation.
    pub fn retain(&mut self, keep: impl Fn(DVec3, f64) -> bool) {
        let turned = self.turned;
        self.manifold.solver_contacts.retain(|contact| {
            let on_first = if turned { contact.anchor2 } else { contact.anchor1 };
            keep(wide(on_first), contact.dist.into())
        });
    }

    /// Leaves out all of them.
    pub fn clear(&mut self) {
        self.manifold.solver_contacts.clear();
    }

    /// Coulomb's coefficient.
    #[must_use]
    pub fn friction(&self) -> f64 {
        (*self.manifold.friction).into()
    }

    /// Sets Coulomb's coefficient.
    pub fn set_friction(&mut self, coefficient: f64) {
        *self.manifold.friction = coefficient as Real;
    }

    /// The share of the speed that a collision gives back.
    #[must_use]
    pub fn restitution(&self) -> f64 {
        (*self.manifold.restitution).into()
    }

    /// Sets the share of the speed that a collision gives back.
    pub fn set_restitution(&mut self, coefficient: f64) {
        *self.manifold.restitution = coefficient as Real;
    }

    /// Lets friction drive the surfaces towards a relative velocity: that of the second body's
    /// surface beside the first's, in the world, as on a conveyor. 0 until then, which brakes.
    pub fn set_surface_velocity(&mut self, velocity: DVec3) {
        let velocity = narrow(if self.turned { -velocity } else { velocity });
        for contact in self.manifold.solver_contacts.iter_mut() {
            contact.tangent_velocity = velocity;
        }
    }
}

/// Hooks, as rapier has them.
pub(super) struct Decisions<'a, H>(pub(super) &'a H);

/// The numbers of two colliders' bodies; `None` for colliders that are not ours.
fn numbers(colliders: &ColliderSet, pair: [ColliderHandle; 2]) -> Option<[u32; 2]> {
    let [a, b] = pair.map(|handle| colliders.get(handle).map(|c| c.user_data as u32));
    Some([a?, b?])
}

impl<H: StepHooks> PhysicsHooks for Decisions<'_, H> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let pair = [context.collider1, context.collider2];
        let responds = numbers(context.colliders, pair)
            .is_none_or(|[a, b]| self.0.responds(BodyIndex(a.min(b)), BodyIndex(a.max(b))));
        responds.then(SolverFlags::default)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let pair = [context.collider1, context.collider2];
        let Some([a, b]) = numbers(context.colliders, pair) else { return };
        let Some(rigid) = context.rigid_mut() else { return };
        let manifold = ModifiableManifold {
            manifold: rigid.manifold,
            solver_contacts: &mut *rigid.solver_contacts,
            normal: &mut *rigid.normal,
            friction: &mut *rigid.friction,
            restitution: &mut *rigid.restitution,
            user_data: &mut *rigid.user_data,
        };
        let bodies = [BodyIndex(a.min(b)), BodyIndex(a.max(b))];
        self.0.modify(&mut SolvedContacts { bodies, turned: a > b, manifold });
    }
}

impl Simulation {
    /// Says whether the hooks of [`step_with`](Self::step_with) decide with whom a body responds,
    /// and whether they see its contacts before they are solved; neither until then. What nobody
    /// decides costs nothing.
    pub fn set_hooked(&mut self, body: BodyIndex, responds: bool, modify: bool) {
        let mut hooks = ActiveHooks::empty();
        hooks.set(ActiveHooks::FILTER_CONTACT_PAIRS, responds);
        hooks.set(ActiveHooks::MODIFY_SOLVER_CONTACTS, modify);
        // To rapier a collider that is borrowed to be written has changed.
        let collider = self.tagged[body.0 as usize].collider;
        if self.colliders.get(collider).is_some_and(|known| known.active_hooks() != hooks) {
            self.collider_mut(body).set_active_hooks(hooks);
        }
    }

    /// Has the next step decide anew whether two bodies respond to each other: both wake, and what
    /// is known of their contacts is dropped. A program whose hooks change their mind about a pair
    /// that may be at rest calls it.
    pub fn reconsider(&mut self, a: BodyIndex, b: BodyIndex) {
        self.log.forget(a.0, b.0);
        self.log.forget(b.0, a.0);
        self.wake(a);
        self.wake(b);
    }

    /// Pairs whose boxes overlap, by numbers, the lower first; those that do not respond included.
    pub fn candidate_pairs(&self) -> impl Iterator<Item = (BodyIndex, BodyIndex)> {
        let pairs = self.narrow_phase.contact_pairs().filter_map(|pair| self.tags(pair));
        pairs.map(|(a, b)| (BodyIndex(a.min(b)), BodyIndex(a.max(b))))
    }
}
