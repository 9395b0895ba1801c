//! Shape casts of polyhedra, by the certified time of impact: nothing is passed through, whatever
//! the speed.
//!
//! parry's cast of a hollow mesh goes from triangle to triangle, and reports of a body inside a
//! solid that it is free. Here a cast is free for certain before the time returned, and at that
//! time the surfaces are within a tolerance of each other.

use cranny_exact::{DVec3, Pose as ExactPose};
use cranny_geometry::Model;
use cranny_impact::{Hit, Impact, ImpactOptions, Motion, Moving, time_of_impact};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::NonlinearRigidMotion;
use rapier3d::parry::query::{Contact, ShapeCastHit, ShapeCastStatus};

use crate::convert::{narrow, pose_from_rapier, wide};

/// How far apart surfaces may be where a cast ends, as a share of the smaller body's radius: some
/// ten steps of f32. Larger: bodies stop visibly short; smaller: f32 does not resolve it, and it
/// takes longer.
const TOLERANCE: f64 = 1e-6;

/// Elementary tests of a cast: half a second. More: what slides along a thread stalls whoever
/// casts; fewer: casts among many faces end before they have to.
const BUDGET: u64 = 1_000_000;

/// Two bodies that move for a while.
pub(crate) struct Cast<'a> {
    models: [&'a Model; 2],
    /// Over the whole time.
    motions: [Motion; 2],
    /// When the time begins, and how long it is.
    begin: f64,
    seconds: f64,
}

/// What bodies that meet at the beginning do there.
pub(crate) struct InitialOverlap {
    /// Whether that counts also where they part.
    pub(crate) always: bool,
    /// Where they meet, in each one's frame.
    pub(crate) contact: Option<Contact>,
}

impl<'a> Cast<'a> {
    /// The second moves straight as the first sees it.
    pub(crate) fn straight(
        models: [&'a Model; 2],
        pos12: &Pose,
        velocity: Vector,
        seconds: Real,
    ) -> Self {
        let (start, velocity) = (pose_from_rapier(pos12), wide(velocity));
        // Beyond that they have passed each other; callers give no end.
        let apart = start.translation.length() + extent(models[0]) + extent(models[1]);
        let past = match velocity.length() {
            0.0 => 0.0,
            speed => 2.0 * apart / speed,
        };
        let seconds = f64::from(seconds).min(past);
        let moving = Motion::straight(start, velocity * seconds);
        Self {
            models,
            motions: [Motion::at_rest(ExactPose::IDENTITY), moving],
            begin: 0.0,
            seconds,
        }
    }

    /// Both move and turn at constant rates.
    pub(crate) fn turning(
        models: [&'a Model; 2],
        motions: [&NonlinearRigidMotion; 2],
        begin: Real,
        end: Real,
    ) -> Self {
        let (begin, seconds) = (f64::from(begin), f64::from(end) - f64::from(begin));
        let motions = motions.map(|motion| {
            let a_second = Motion {
                start: pose_from_rapier(&motion.start),
                pivot: wide(motion.local_center),
                turn: wide(motion.angvel),
                travel: wide(motion.linvel),
            };
            Motion {
                start: a_second.pose_at(begin),
                turn: seconds * a_second.turn,
                travel: seconds * a_second.travel,
                ..a_second
            }
        });
        Self { models, motions, begin, seconds }
    }

    /// How far apart the surfaces may be when they are reported to meet.
    pub(crate) fn tolerance(&self) -> f64 {
        TOLERANCE * self.models[0].radius().min(self.models[1].radius())
    }

    /// When they meet; `None` inside where they do not, outside where the motion is none that can
    /// be followed.
    pub(crate) fn meet(
        &self,
        initial: impl FnOnce() -> InitialOverlap,
    ) -> Option<Option<ShapeCastHit>> {
        let options = ImpactOptions { budget: BUDGET, ..ImpactOptions::within(self.tolerance()) };
        let [a, b] = [0, 1].map(|k| Moving { model: self.models[k], motion: self.motions[k] });
        Some(match time_of_impact(a, b, &options) {
            Ok((Impact::None, _)) => None,
            Ok((Impact::Initially { .. }, _)) => self.at_beginning(initial()),
            Ok((Impact::Hit(hit), _)) => Some(self.shape_cast_hit(&hit)),
            Ok((Impact::Open { free_before }, _)) => Some(ShapeCastHit {
                time_of_impact: self.time(free_before),
                status: ShapeCastStatus::OutOfIterations,
                ..nowhere()
            }),
            Err(error) => {
                tracing::debug!("a cast is left to parry: {error}");
                return None;
            }
        })
    }

    fn shape_cast_hit(&self, hit: &Hit) -> ShapeCastHit {
        let inverses = self.motions.map(|m| m.pose_at(hit.time.hi).world_from_body().inverse());
        let [witness1, witness2] =
            [0, 1].map(|k| narrow(inverses[k].apply(hit.witnesses[k].point)));
        let [normal1, normal2] =
            [(0, hit.normal), (1, -hit.normal)].map(|(k, n)| narrow(inverses[k].apply_vector(n)));
        ShapeCastHit {
            time_of_impact: self.time(hit.time.lo),
            witness1,
            witness2,
            normal1,
            normal2,
            status: ShapeCastStatus::Converged,
            ..nowhere()
        }
    }

    fn at_beginning(
        &self,
        InitialOverlap { always, contact }: InitialOverlap,
    ) -> Option<ShapeCastHit> {
        let parts = contact.is_some_and(|contact| self.approach(&contact) <= 0.0);
        (always || !parts).then(|| together(contact, self.begin as Real))
    }

    /// How fast the bodies come nearer to each other at a contact, at the beginning.
    fn approach(&self, contact: &Contact) -> f64 {
        let places = [wide(contact.point1), wide(contact.point2)];
        let [v1, v2] = [0, 1].map(|k| {
            let motion = &self.motions[k];
            let from_pivot = places[k] - motion.pivot;
            motion.travel + motion.turn.cross(motion.start.rotation * from_pivot)
        });
        let normal: DVec3 = self.motions[0].start.rotation * wide(contact.normal1);
        (v1 - v2).dot(normal)
    }

    /// A moment of the motions, rounded towards the beginning.
    fn time(&self, share: f64) -> Real {
        earlier(self.begin + share * self.seconds)
    }
}

/// What bodies that are together at the beginning come to: a hit at once. `contact` is where they
/// meet, in each one's frame, if that is known.
pub(crate) fn together(contact: Option<Contact>, begin: Real) -> ShapeCastHit {
    let hit = ShapeCastHit {
        time_of_impact: begin,
        status: ShapeCastStatus::PenetratingOrWithinTargetDist,
        ..nowhere()
    };
    contact.map_or(hit, |contact| ShapeCastHit {
        witness1: contact.point1,
        witness2: contact.point2,
        normal1: contact.normal1,
        normal2: contact.normal2,
        ..hit
    })
}

/// A time in rapier's numbers, rounded towards the beginning.
pub(crate) fn earlier(time: f64) -> Real {
    let rounded = time as Real;
    if f64::from(rounded) > time { rounded.next_down() } else { rounded }
}

/// A body's farthest point from its origin, at most.
fn extent(model: &Model) -> f64 {
    let bounds = model.bounds();
    bounds.min.abs().max(bounds.max.abs()).length()
}

/// A hit of which nothing is known.
pub(crate) fn nowhere() -> ShapeCastHit {
    ShapeCastHit {
        time_of_impact: 0.0,
        witness1: Vector::ZERO,
        witness2: Vector::ZERO,
        normal1: Vector::X,
        normal2: Vector::NEG_X,
        status: ShapeCastStatus::Failed,
        subshape1: 0,
        subshape2: 0,
    }
}
