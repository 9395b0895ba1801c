//! How far ahead two bodies are looked at: as far as they may come nearer in the next step.
//!
//! rapier has one prediction distance for all pairs, and its way to widen it for a fast body leaves
//! out pairs that do not approach at the beginning of a step: of two bodies that fall together the
//! upper one would go into the lower one in the step in which that lands. So here each pair has a
//! reach of its own. A body may go on as it moves, or be brought to the motion of what is near it,
//! or to any motion in between: a box of motions ([`Motion::may`]). A pair's reach is what two
//! motions of its boxes differ by at most, and a reserve for what is not foreseen; and of the
//! contacts within it only those count that they may come to along the normal. rapier gets the
//! longest reach of bodies that are near each other, at least its own prediction distance. So what
//! lies at rest, or is lost far away, makes nothing else dearer.
//!
//! Motions are those of centres of mass. What that leaves out, turning and features that change, is
//! kept short by dividing steps (`pace`).

mod pace;

use std::sync::{Arc, PoisonError, RwLock};

use cranny_exact::{DMat3, DVec3};
use cranny_narrow_phase::Approach;
use cranny_primitives::BodyShape;
use rapier3d::geometry::BroadPhaseBvh;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::prelude::{
    ColliderHandle, ColliderSet, IntegrationParameters, QueryFilter, RigidBody, RigidBodySet,
};

use crate::carried::CARRIED_WITHIN;
use crate::convert::{narrow, wide};
use crate::dispatcher::Dispatcher;
use crate::manifolds::SolverContact;

/// Through how many bodies a motion is handed on within a step. More: everything in a pile that one
/// body falls on looks ahead; fewer: what stands close behind a body that is hit is not seen by it.
const HOPS: usize = 2;

/// By how much more than their motions say two bodies may come nearer in a step, as a part of the
/// prediction distance, apart from what gravity adds. More: the solver goes through contacts that
/// nothing comes to; less: a body that is pushed goes in until the next step.
const UNFORESEEN: Real = 0.25;

/// The longest of a box of motions.
fn longest(may: &Aabb) -> Real {
    may.mins.abs().max(may.maxs.abs()).length()
}

/// How far a point of a body moves at most as it turns by an angle. What does not turn does not
/// move, however large it is: a half-space has no radius.
fn spin_of(angle: Real, radius: Real) -> Real {
    if angle == 0.0 { 0.0 } else { angle * radius }
}

/// What a body does in the next step.
#[derive(Clone, Copy, Debug)]
struct Motion {
    pose: Pose,
    /// Of its collider.
    bounds: Aabb,
    /// World coordinates.
    center: Vector,
    /// Of the center, no longer than the body's radius about it.
    linear: Vector,
    angular: Vector,
    /// How far a point of the body moves at most as it turns.
    spin: Real,
    /// What others may make of `linear`: a box that holds it.
    may: Aabb,
}

impl Motion {
    fn of(body: &RigidBody, bounds: Aabb, tagged: &Tagged, dt: Real) -> Self {
        let linear = (body.linvel() * dt).clamp_length_max(tagged.radius);
        Self {
            pose: *body.position(),
            bounds,
            center: *body.position() * tagged.center,
            linear,
            angular: body.angvel() * dt,
            spin: spin_of(body.angvel().length() * dt, tagged.radius),
            may: Aabb::new(linear, linear),
        }
    }

    /// Of a tag that no body has: nothing is near it.
    fn of_nobody() -> Self {
        Self {
            pose: Pose::IDENTITY,
            bounds: Aabb::new_invalid(),
            center: Vector::ZERO,
            linear: Vector::ZERO,
            angular: Vector::ZERO,
            spin: 0.0,
            may: Aabb::new(Vector::ZERO, Vector::ZERO),
        }
    }

    /// Two that are not, come no nearer than the prediction distance, `base`.
    fn is_fast(&self, base: Real) -> bool {
        longest(&self.may) > 0.5 * base
    }

    /// How far a point moves by the body's turning.
    fn turning(&self, point: Vector) -> Vector {
        self.angular.cross(point - self.center)
    }

    /// Where the body may be until the end of the step, and a margin around it.
    fn swept(&self, margin: Real) -> Aabb {
        let (least, most) = (self.may.mins.min(Vector::ZERO), self.may.maxs.max(Vector::ZERO));
        Aabb::new(self.bounds.mins + least, self.bounds.maxs + most).loosened(margin)
    }
}

/// How two bodies may move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairAhead {
    motions: [Motion; 2],
    /// rapier's prediction distance.
    base: Real,
    /// How near a contact counts, whatever motions say.
    reserve: Real,
}

impl PairAhead {
    /// Motions of the first as the second sees them.
    fn may(&self) -> Aabb {
        let [a, b] = &self.motions;
        Aabb::new(a.may.mins - b.may.maxs, a.may.maxs - b.may.mins)
    }

    /// Contacts that are farther away do not matter in this step, nor in those through which a list
    /// is carried on. Turning counts up to the prediction distance; beyond, steps are divided.
    pub(crate) fn reach(&self) -> Real {
        let lasting = self.reserve + 2.0 * CARRIED_WITHIN as Real * self.base;
        let [a, b] = &self.motions;
        let linear = longest(&self.may());
        lasting.max(linear + a.spin + b.spin).min(self.base).max(linear)
    }

    /// rapier's prediction distance.
    pub(crate) fn base(&self) -> Real {
        self.base
    }

    /// How far contacts count whatever motions say, and the motion that brings bodies to those
    /// beyond, in the frame of the first; `None` of those
    /// slower than a prediction distance a step: what is listed about them serves the next search.
    pub(crate) fn approaching(&self) -> Option<(f64, Approach)> {
        let [a, b] = &self.motions;
        let within = self.reach();
        let motion = (a.linear - b.linear).length() + a.spin + b.spin;
        if motion <= self.base || within <= self.reserve {
            return None;
        }
        let (may, back) = (self.may(), a.pose.inverse());
        let half = 0.5 * (may.maxs - may.mins);
        let axes = [Vector::X * half.x, Vector::Y * half.y, Vector::Z * half.z];
        let turned = |v: Vector| wide(back.rotation * v);
        let swing = |m: &Motion| wide(back * m.center).cross(turned(m.angular));
        let approach = Approach {
            within: within.into(),
            linear: turned(0.5 * (may.mins + may.maxs)),
            spread: DMat3::from_cols(turned(axes[0]), turned(axes[1]), turned(axes[2])),
            turn: turned(a.angular - b.angular),
            swing: swing(a) - swing(b),
        };
        Some((self.reserve.into(), approach))
    }

    /// How far a contact may have moved since the step before.
    pub(crate) fn drift(&self) -> Real {
        let [a, b] = &self.motions;
        self.base.max((a.linear - b.linear).length())
    }

    /// Whether not even the bodies' boxes come within the prediction distance.
    pub(crate) fn stay_apart(&self) -> bool {
        let ([a, b], may) = (&self.motions, self.may());
        let (least, most) = (may.mins.min(Vector::ZERO), may.maxs.max(Vector::ZERO));
        let swept = Aabb::new(a.bounds.mins + least, a.bounds.maxs + most);
        !swept.loosened(self.base).intersects(&b.bounds)
    }

    /// Whether the bodies may come together at a contact (in the frame of the first).
    pub(crate) fn may_close(&self, contact: &SolverContact) -> bool {
        let ([a, b], may) = (&self.motions, self.may());
        let point = a.pose * narrow(contact.on_first);
        let normal = a.pose.rotation * narrow(contact.normal);
        let linear = (may.mins * normal).max(may.maxs * normal).element_sum();
        let turning = (a.turning(point) - b.turning(point)).dot(normal);
        contact.separation <= f64::from(self.reserve.max(linear + turning.max(0.0)))
    }
}

/// What all bodies do in the next step, by tags. Shared by a dispatcher and its owner.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motions(Arc<RwLock<KnownMotions>>);

#[derive(Debug, Default)]
struct KnownMotions {
    bodies: Vec<Motion>,
    base: Real,
    reserve: Real,
}

/// Bodies as a simulation keeps them.
pub(crate) struct World<'a> {
    pub(crate) bodies: &'a RigidBodySet,
    pub(crate) colliders: &'a ColliderSet,
    /// By tag.
    pub(crate) tagged: &'a [Tagged],
}

/// What does not change about a body as it moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tagged {
    pub(crate) collider: ColliderHandle,
    /// Of mass, in the body's frame.
    pub(crate) center: Vector,
    /// About the centre of mass; infinite of a half-space.
    pub(crate) radius: Real,
    /// Twice its volume over its area, which is the radius of a long wire and the height of a wide
    /// sheet; infinite where it has no volume.
    pub(crate) thickness: Real,
}

impl Tagged {
    /// `center` is the centre of mass that the body has, if it has one; else it is the solid's, and
    /// the origin where a model has none.
    pub(crate) fn new(shape: &BodyShape, collider: ColliderHandle, center: Option<DVec3>) -> Self {
        let center = center.unwrap_or_else(|| shape.center());
        Self {
            collider,
            center: narrow(center),
            radius: shape.radius_about(center) as Real,
            thickness: shape.thickness() as Real,
        }
    }
}

impl Tagged {
    /// No body has the tag any more.
    pub(crate) fn leave(&mut self) {
        (self.radius, self.thickness) = (0.0, Real::INFINITY);
    }
}

impl World<'_> {
    fn body(&self, tag: usize) -> Option<&RigidBody> {
        self.bodies.get(self.colliders.get(self.tagged[tag].collider)?.parent()?)
    }

    fn motion(&self, tag: usize, dt: Real) -> Option<Motion> {
        let (tagged, body) = (&self.tagged[tag], self.body(tag)?);
        // Where somebody put the body: its collider follows within the step.
        let collider = self.colliders.get(tagged.collider)?;
        let place = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
        let bounds = collider.shape().compute_aabb(&(*body.position() * place));
        Some(Motion::of(body, bounds, tagged, dt))
    }
}

impl Motions {
    /// How far two tagged bodies are looked at; `None` where one is not known.
    pub(crate) fn between(&self, first: u32, second: u32) -> Option<PairAhead> {
        let known = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let of = |tag: u32| known.bodies.get(tag as usize).copied();
        let KnownMotions { base, reserve, .. } = *known;
        Some(PairAhead { motions: [of(first)?, of(second)?], base, reserve })
    }

    /// Looks at what bodies are about to do, grows the boxes of fast ones, and returns the
    /// prediction distance that rapier needs where that is longer than its own: no contact that a
    /// pair's reach holds is farther.
    ///
    /// `settled`: whether the broad phase has boxes of all bodies where they are.
    pub(crate) fn look(
        &self,
        world: &World,
        broad_phase: &mut BroadPhaseBvh,
        parameters: &IntegrationParameters,
        gravity: Vector,
        settled: bool,
    ) -> Option<Real> {
        let base = parameters.prediction_distance();
        let fall = gravity.length() * parameters.dt * parameters.dt;
        let reserve = UNFORESEEN * base + fall;
        let tags = 0..world.tagged.len();
        let motion = |tag| world.motion(tag, parameters.dt).unwrap_or_else(Motion::of_nobody);
        let mut bodies: Vec<Motion> = tags.map(motion).collect();
        let reach = if settled {
            Neighbours { world, parameters, base }.influence(&mut bodies, broad_phase)
        } else {
            // Nobody knows yet what is near: anything may take over any motion.
            let rest = Aabb::new(Vector::ZERO, Vector::ZERO);
            let all = bodies.iter().fold(rest, |all, motion| all.merged(&motion.may));
            bodies.iter_mut().for_each(|motion| motion.may = all);
            // rapier loosens boxes by half of it, but not those of what has long been there.
            2.0 * all.extents().length()
        };
        *self.0.write().unwrap_or_else(PoisonError::into_inner) =
            KnownMotions { bodies, base, reserve };
        (reach > base).then_some(reach)
    }
}

/// Who is near whom.
struct Neighbours<'a> {
    world: &'a World<'a>,
    parameters: &'a IntegrationParameters,
    base: Real,
}

impl Neighbours<'_> {
    /// Extends each body's motion by what others may make of it, and returns the longest reach.
    fn influence(&self, motions: &mut [Motion], broad_phase: &mut BroadPhaseBvh) -> Real {
        let mut seen = vec![false; motions.len()];
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for hop in 0..=HOPS {
            let fast: Vec<u32> = (0..motions.len() as u32)
                .filter(|&i| !seen[i as usize] && motions[i as usize].is_fast(self.base))
                .collect();
            for &i in &fast {
                seen[i as usize] = true;
                let swept = motions[i as usize].swept(0.5 * self.base);
                broad_phase.set_aabb(
                    self.parameters,
                    self.world.tagged[i as usize].collider,
                    swept,
                );
            }
            if fast.is_empty() || hop == HOPS {
                break;
            }
            let World { bodies, colliders, .. } = *self.world;
            let dispatcher = Dispatcher::default();
            let tree =
                broad_phase.as_query_pipeline(&dispatcher, bodies, colliders, QueryFilter::new());
            for &i in &fast {
                let swept = motions[i as usize].swept(0.5 * self.base);
                let near = tree.intersect_aabb_conservative(swept);
                let near = near.map(|(_, collider)| collider.user_data as u32);
                pairs.extend(near.filter(|&j| j != i).map(|j| [i.min(j), i.max(j)]));
            }
            pairs.sort_unstable();
            pairs.dedup();
            let before = motions.to_vec();
            for &[i, j] in pairs.iter().filter(|pair| !self.between(&before, **pair).stay_apart()) {
                for (of, by) in [(i as usize, j as usize), (j as usize, i as usize)] {
                    let share = self.share(&before, of, by);
                    let (own, its) = (before[of].linear, &before[by].may);
                    let taken = |end: Vector| own + share * (end - own);
                    motions[of].may.merge(&Aabb::new(taken(its.mins), taken(its.maxs)));
                }
            }
        }
        let pairs = pairs.iter().map(|&pair| self.between(motions, pair));
        pairs.filter(|p| !p.stay_apart()).map(|p| p.reach()).fold(0.0, Real::max)
    }

    fn between(&self, motions: &[Motion], pair: [u32; 2]) -> PairAhead {
        PairAhead {
            motions: pair.map(|i| motions[i as usize]),
            base: self.base,
            reserve: self.base,
        }
    }

    /// How much of another's motion a body may take over: all where that is slower, since others
    /// may hold it, otherwise as much as its mass says.
    fn share(&self, motions: &[Motion], of: usize, by: usize) -> Real {
        let mass = |tag: usize| {
            let dynamic = self.world.body(tag).filter(|body| body.is_dynamic());
            dynamic.map_or(Real::INFINITY, RigidBody::mass)
        };
        let (own, its) = (mass(of), mass(by));
        if own == Real::INFINITY {
            0.0
        } else if its == Real::INFINITY || motions[by].linear.length() < motions[of].linear.length()
        {
            1.0
        } else {
            its / (own + its)
        }
    }
}
