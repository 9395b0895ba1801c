//! What may change about a body between two steps, and bodies that leave.
//!
//! Everything takes effect in the next step. A change that may move a body wakes it.

use cranny_exact::DVec3;
use cranny_narrow_phase::Normals;
use cranny_primitives::BodyShape;
use rapier3d::geometry::{Group, InteractionGroups, InteractionTestMode};
use rapier3d::math::{Real, Vector};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::prelude::{Collider, LockedAxes, RigidBodyType};

use super::{BodyIndex, BodyKind, Simulation, SimulationError};
use crate::ahead::Tagged;
use crate::convert::narrow;
use crate::detector::Detector;
use crate::joint::{JointIndex, JointPlace};
use crate::mass::MassSource;

impl Simulation {
    /// Takes a body out, with its joints. Its number is free then: the next body
    /// that is inserted gets the lowest that is.
    ///
    /// Nothing happens to a body that is not there.
    pub fn remove(&mut self, body: BodyIndex) {
        if !self.contains(body) {
            return;
        }
        let handle = self.handle(body);
        self.bodies.remove(
            handle,
            &mut self.islands,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            true,
        );
        self.forget_parted_joints();
        self.tagged[body.0 as usize].leave();
        self.free.insert(body.0);
        self.earlier_points.retain(|&(a, b), _| a != body.0 && b != body.0);
        self.stalled.remove(&body.0);
        self.forget(body);
    }

    /// Drops all that is known of a body's pairs.
    fn forget(&self, body: BodyIndex) {
        let keeps = |first: u32, second: u32| first != body.0 && second != body.0;
        self.log.retain(keeps);
        self.searches.retain(keeps);
    }

    /// Whether a number is that of a body.
    #[must_use]
    pub fn contains(&self, body: BodyIndex) -> bool {
        (body.0 as usize) < self.handles.len() && !self.free.contains(&body.0)
    }

    pub(super) fn collider_mut(&mut self, body: BodyIndex) -> &mut Collider {
        &mut self.colliders[self.tagged[body.0 as usize].collider]
    }

    /// Gives a body another geometry. Its mass follows from it or is stated, if it is dynamic.
    ///
    /// # Errors
    ///
    /// As [`insert`](Self::insert); the body stays as it was.
    pub fn set_shape(
        &mut self,
        body: BodyIndex,
        shape: impl Into<BodyShape>,
        normals: Normals,
        mass: impl Into<MassSource>,
    ) -> Result<(), SimulationError> {
        let (shape, source) = (shape.into(), mass.into());
        let (own, place) = self.options.detector.collider(&shape, normals, body.0)?;
        let mass = match self.body(body).body_type() {
            RigidBodyType::Dynamic => Some(source.properties(&shape)?),
            // It turns about its centre of mass, if it has one.
            RigidBodyType::Fixed => None,
            _ => Some(source.properties(&shape).unwrap_or_default()),
        };
        let collider = self.tagged[body.0 as usize].collider;
        self.tagged[body.0 as usize] = Tagged::new(&shape, collider, source.center());
        let collider = self.collider_mut(body);
        collider.set_shape(own);
        collider.set_position_wrt_parent(place);
        if let Some(mass) = mass {
            self.put_mass(body, mass);
        }
        if self.body(body).soft_ccd_prediction() > 0.0 {
            let handle = self.handle(body);
            self.bodies[handle].set_soft_ccd_prediction(shape.radius() as Real);
        }
        self.forget(body);
        self.settled = false;
        self.wake(body);
        Ok(())
    }

    /// Says how a body moves from now on. A body that becomes dynamic gets its mass.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Mass`] where a dynamic body would have none; the body stays as it was.
    pub fn set_kind(
        &mut self,
        body: BodyIndex,
        kind: BodyKind,
        shape: impl Into<BodyShape>,
        mass: impl Into<MassSource>,
    ) -> Result<(), SimulationError> {
        let (shape, source) = (shape.into(), mass.into());
        // It turns about its centre of mass, if it has one.
        let center = source.properties(&shape).ok();
        if kind == BodyKind::Dynamic {
            self.set_mass(body, &shape, source)?;
        } else {
            self.leave_coordinates(body);
        }
        if kind == BodyKind::Kinematic
            && let Some(center) = center
        {
            self.put_mass(body, center);
        }
        let own = kind == BodyKind::Dynamic && self.options.detector != Detector::Cranny;
        let handle = self.handle(body);
        let rigid = &mut self.bodies[handle];
        rigid.set_soft_ccd_prediction(if own { shape.radius() as Real } else { 0.0 });
        rigid.set_body_type(rapier_kind(kind), true);
        Ok(())
    }

    /// Gives a body another mass: that of its solid at a density, or one that is stated.
    ///
    /// # Errors
    ///
    /// [`SimulationError::Mass`]; the body stays as it was.
    pub fn set_mass(
        &mut self,
        body: BodyIndex,
        shape: impl Into<BodyShape>,
        mass: impl Into<MassSource>,
    ) -> Result<(), SimulationError> {
        let (shape, source) = (shape.into(), mass.into());
        let properties = source.properties(&shape)?;
        let collider = self.tagged[body.0 as usize].collider;
        self.tagged[body.0 as usize] = Tagged::new(&shape, collider, source.center());
        self.put_mass(body, properties);
        self.wake(body);
        Ok(())
    }

    /// rapier itself would do so within the next step, after an impulse was divided by the old
    /// mass.
    fn put_mass(&mut self, body: BodyIndex, mass: MassProperties) {
        self.collider_mut(body).set_mass_properties(mass);
        let handle = self.handle(body);
        self.bodies[handle].recompute_mass_properties_from_colliders(&self.colliders);
    }

    /// Gives a body another coefficient of friction (Coulomb's) and of restitution (0 to 1).
    pub fn set_material(&mut self, body: BodyIndex, friction: f64, restitution: f64) {
        let collider = self.collider_mut(body);
        collider.set_friction(friction as Real);
        collider.set_restitution(restitution as Real);
        self.wake(body);
        // rapier sees no change in it: what rests on the body would sleep on.
        let handle = self.tagged[body.0 as usize].collider;
        let partners: Vec<_> = self
            .narrow_phase
            .contact_pairs_with(handle)
            .flat_map(|pair| [pair.collider1, pair.collider2])
            .filter_map(|collider| self.colliders.get(collider)?.parent())
            .collect();
        for partner in partners {
            if let Some(rigid) = self.bodies.get_mut(partner) {
                rigid.wake_up(true);
            }
        }
    }

    /// Says in which groups a body is, and which it meets, as bits: two bodies meet where each is
    /// in a group that the other meets.
    pub fn set_groups(&mut self, body: BodyIndex, memberships: u32, filters: u32) {
        let [memberships, filters] = [memberships, filters].map(Group::from_bits_truncate);
        let groups = InteractionGroups::new(memberships, filters, InteractionTestMode::And);
        self.collider_mut(body).set_collision_groups(groups);
        self.forget(body);
        self.wake(body);
    }

    /// By what gravity is multiplied for a body; 1 until then.
    pub fn set_gravity_scale(&mut self, body: BodyIndex, scale: f64) {
        let handle = self.handle(body);
        self.bodies[handle].set_gravity_scale(scale as Real, true);
    }

    /// By how much a dynamic body slows down of itself: in each second its linear and its angular
    /// velocity lose these shares of what they are then; 0 until then. Links of trees of reduced
    /// joints slow down by the resistance of their joints alone.
    pub fn set_damping(&mut self, body: BodyIndex, linear: f64, angular: f64) {
        let handle = self.handle(body);
        let rigid = &mut self.bodies[handle];
        rigid.set_linear_damping(linear as Real);
        rigid.set_angular_damping(angular as Real);
    }

    /// Which motions a body cannot make: translations along world x, y, z, then rotations about
    /// them.
    pub fn set_locked_axes(&mut self, body: BodyIndex, translations: [bool; 3], turns: [bool; 3]) {
        let bits = translations.into_iter().chain(turns).enumerate();
        let bits = bits.fold(0, |bits, (i, locked)| bits | (u8::from(locked) << i));
        let handle = self.handle(body);
        self.bodies[handle].set_locked_axes(LockedAxes::from_bits_truncate(bits), true);
        self.keep_locked(body);
    }

    /// rapier lets no force act along a locked axis, and keeps the speed that is there.
    pub(super) fn keep_locked(&mut self, body: BodyIndex) {
        let handle = self.handle(body);
        let rigid = &mut self.bodies[handle];
        let locked = rigid.locked_axes();
        if locked.is_empty() {
            return;
        }
        let free = |axes: [LockedAxes; 3]| {
            let free = axes.map(|axis| if locked.contains(axis) { 0.0 } else { 1.0 });
            Vector::from_array(free)
        };
        let along = free([
            LockedAxes::TRANSLATION_LOCKED_X,
            LockedAxes::TRANSLATION_LOCKED_Y,
            LockedAxes::TRANSLATION_LOCKED_Z,
        ]);
        let about = free([
            LockedAxes::ROTATION_LOCKED_X,
            LockedAxes::ROTATION_LOCKED_Y,
            LockedAxes::ROTATION_LOCKED_Z,
        ]);
        rigid.set_linvel(rigid.linvel() * along, true);
        rigid.set_angvel(rigid.angvel() * about, true);
    }

    /// The force at a body's centre of mass, and the torque, that act on it in every step from now
    /// on, world axes.
    pub fn set_force(&mut self, body: BodyIndex, force: DVec3, torque: DVec3) {
        let handle = self.handle(body);
        let rigid = &mut self.bodies[handle];
        rigid.reset_forces(true);
        rigid.reset_torques(true);
        rigid.add_force(narrow(force), true);
        rigid.add_torque(narrow(torque), true);
    }

    /// Changes a body's velocities at once: by an impulse at its centre of mass, and an angular
    /// one, world axes.
    pub fn apply_impulse(&mut self, body: BodyIndex, linear: DVec3, angular: DVec3) {
        let handle = self.handle(body);
        self.bodies[handle].apply_impulse(narrow(linear), true);
        self.bodies[handle].apply_torque_impulse(narrow(angular), true);
        self.push_coordinates(body, narrow(linear), narrow(angular));
    }

    /// Takes a joint out. Nothing happens to one that is not there.
    pub fn part(&mut self, joint: JointIndex) {
        match joint.0 {
            JointPlace::Impulses(handle) => {
                self.joints.remove(handle, true);
            }
            JointPlace::Reduced(number) => self.part_reduced(number),
        }
    }

    /// Acceleration of dynamic bodies from now on.
    pub fn set_gravity(&mut self, gravity: DVec3) {
        if gravity != self.options.gravity {
            self.options.gravity = gravity;
            let all: Vec<BodyIndex> = self.indices().collect();
            all.into_iter().for_each(|index| self.wake(index));
        }
    }

    pub(super) fn wake(&mut self, body: BodyIndex) {
        if let Some(rigid) = self.bodies.get_mut(self.handle(body)) {
            rigid.wake_up(true);
        }
    }
}

/// rapier's word for how a body moves.
pub(super) fn rapier_kind(kind: BodyKind) -> RigidBodyType {
    match kind {
        BodyKind::Fixed => RigidBodyType::Fixed,
        BodyKind::Kinematic => RigidBodyType::KinematicVelocityBased,
        BodyKind::Dynamic => RigidBodyType::Dynamic,
    }
}
