//! What an app reads of a contact: where, which way, how deep, how hard.

use bevy_ecs::prelude::*;
use bevy_ecs::query::{QueryData, QueryFilter};
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_narrow_phase::{Answer, Contact};
use cranny_world::BodyId;

use crate::body::{Bodies, Body, pose_of, widened};
use crate::contacts::ContactReport;
use crate::effects::{EffectTable, Pair, ordered};
use crate::properties::{AngularVelocity, LinearVelocity};
use crate::trigger::TriggeredPairs;

/// Where two bodies meet, at the poses at the beginning of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionPoint {
    /// Half-way between the surfaces, world coordinates.
    pub point: DVec3,
    /// Unit, from the body to the other one, world axes.
    pub normal: DVec3,
    /// How deep the bodies overlap along the normal, units of length; < 0 where a gap is left.
    pub depth: f64,
}

impl CollisionPoint {
    /// Of a contact, seen from its body A.
    fn of(contact: &Contact) -> Self {
        Self {
            point: 0.5 * (contact.point_a + contact.point_b),
            normal: contact.normal,
            depth: -contact.separation,
        }
    }

    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { normal: -self.normal, ..self }
    }
}

/// How two bodies came to touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionContact {
    /// The deepest point at which they meet.
    pub deepest: CollisionPoint,
    /// What the solver's contacts gave each of them along their normals in the step, summed as
    /// numbers: mass x length / second; 0 for pairs without [`Response`](crate::Response).
    pub impulse: f64,
    /// The speed at which the bodies approached each other at the point, along the normal, at the
    /// beginning of the step: length / second; < 0 where they part.
    pub speed: f64,
}

impl CollisionContact {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { deepest: self.deepest.flipped(), ..self }
    }
}

/// Who is who in a report about two bodies, which are its fields `body` and `other`.
macro_rules! two_bodies {
    ($($event:ty),+) => {$(
        impl $event {
            /// Whether an entity is one of the two.
            #[must_use]
            pub fn involves(&self, entity: Entity) -> bool {
                self.body == entity || self.other == entity
            }

            /// The other one than an entity; `None` if that is neither of the two.
            #[must_use]
            pub fn other_than(
                &self,
                entity: Entity,
            ) -> Option<Entity> {
                let ends = [(self.body, self.other), (self.other, self.body)];
                ends.into_iter().find(|(end, _)| *end == entity).map(|(_, other)| other)
            }

            /// The first of the two that a query finds, and the other one.
            #[must_use]
            pub fn one_of<D, F>(
                &self,
                query: &Query<'_, '_, D, F>,
            ) -> Option<(Entity, Entity)>
            where
                D: QueryData,
                F: QueryFilter,
            {
                let ends = [(self.body, self.other), (self.other, self.body)];
                ends.into_iter().find(|(end, _)| query.contains(*end))
            }
        }
    )+};
}
pub(crate) use two_bodies;

/// The deepest contact of an answer, seen from its body A.
pub(crate) fn deepest(answer: &Answer) -> Option<CollisionPoint> {
    let contacts = answer.contacts.iter();
    contacts
        .min_by(|a, b| a.separation.total_cmp(&b.separation))
        .or_else(|| {
            let regions = answer.regions.iter().map(|region| &region.deepest);
            regions.min_by(|a, b| a.separation.total_cmp(&b.separation))
        })
        .map(CollisionPoint::of)
}

/// The point of the greatest impulse; of equals the deepest.
#[cfg(feature = "rapier")]
pub(crate) fn hardest(points: &[(CollisionPoint, f64)]) -> Option<CollisionPoint> {
    let harder = |(p, i): &&(CollisionPoint, f64), (q, j): &&(CollisionPoint, f64)| {
        i.total_cmp(j).then(p.depth.total_cmp(&q.depth))
    };
    points.iter().max_by(harder).map(|(point, _)| *point)
}

/// How fast points of bodies move at the beginning of a step.
#[derive(SystemParam)]
pub(crate) struct Velocities<'w, 's> {
    bodies: Query<
        'w,
        's,
        (&'static Transform, &'static LinearVelocity, &'static AngularVelocity),
        With<Body>,
    >,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
}

impl Velocities<'_, '_> {
    /// The point of a body, in its frame, that its linear velocity is of: what the solver has it
    /// turn about, if the solver has it.
    fn center(&self, records: &Bodies, body: BodyId) -> Option<DVec3> {
        #[cfg(feature = "rapier")]
        if let Some(center) = self.solver.as_ref().and_then(|solver| solver.center_of_mass(body)) {
            return Some(center);
        }
        Some(records.get(body)?.shape.center())
    }

    /// Of the point of a body that is at `place` in the world. Zero for a body that is gone.
    pub(crate) fn at(&self, records: &Bodies, body: BodyId, place: DVec3) -> DVec3 {
        self.about(records, body, place)
            .map_or(DVec3::ZERO, |(linear, angular, arm)| linear + angular.cross(arm))
    }

    /// A body's velocities, and where `place` is from its centre of mass.
    fn about(&self, records: &Bodies, body: BodyId, place: DVec3) -> Option<(DVec3, DVec3, DVec3)> {
        let record = records.get(body)?;
        let (transform, linear, angular) = self.bodies.get(record.entity).ok()?;
        let center = self.center(records, body)?;
        let arm = place - pose_of(transform).world_from_body().apply(center);
        Some((widened(linear.0), widened(angular.0), arm))
    }

    /// How fast one of two bodies rolls on the other at a point: how fast the centre of mass of the
    /// one that turns faster passes the point by turning about it, as the other one sees it.
    /// Turning about the normal is no rolling.
    #[cfg(feature = "rapier")]
    pub(crate) fn rolling(&self, records: &Bodies, pair: [BodyId; 2], at: &CollisionPoint) -> f64 {
        let about = pair.map(|body| self.about(records, body, at.point));
        let [Some((_, of_a, arm_a)), Some((_, of_b, arm_b))] = about else { return 0.0 };
        let turning = of_a - of_b;
        let tipping = turning - turning.dot(at.normal) * at.normal;
        let faster = of_a.length_squared() >= of_b.length_squared();
        tipping.cross(if faster { arm_a } else { arm_b }).length()
    }

    /// How fast two bodies approach each other at a point that is seen from the first.
    pub(crate) fn closing(
        &self,
        records: &Bodies,
        [a, b]: [BodyId; 2],
        at: &CollisionPoint,
    ) -> f64 {
        let [of_a, of_b] = [a, b].map(|body| self.at(records, body, at.point));
        (of_a - of_b).dot(at.normal)
    }
}

/// Contacts of the last step, by entities: those of pairs with [`Contacts`](crate::Contacts), as
/// far as their margin reaches, and those that the solver found of pairs of meshes with
/// [`Response`](crate::Response).
///
/// ```
/// use bevy_ecs::prelude::*;
/// use cranny_ecs::{Collisions, Sensor};
///
/// fn report(collisions: Collisions, plates: Query<Entity, With<Sensor>>) {
///     for plate in &plates {
///         for collision in collisions.collisions_with(plate) {
///             for point in collision.points() {
///                 println!("{} at {} along {}", collision.other, point.point, point.normal);
///             }
///         }
///     }
/// }
/// ```
#[derive(SystemParam)]
pub struct Collisions<'w, 's> {
    ids: Query<'w, 's, &'static Body>,
    records: Res<'w, Bodies>,
    contacts: Option<Res<'w, ContactReport>>,
    triggered: Option<Res<'w, TriggeredPairs>>,
    effects: Res<'w, EffectTable>,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
}

/// The contacts of a pair, seen from one of its bodies.
#[derive(Clone, Copy, Debug)]
pub struct Collision<'a> {
    /// The body from which it is seen.
    pub body: Entity,
    /// What it meets.
    pub other: Entity,
    /// Whether A of the answer is `other`.
    turned: bool,
    /// World coordinates; A is the body with the lower id. Holds the fields that somebody reads.
    pub answer: &'a Answer,
    /// What the solver's contacts gave each body along their normals, summed as numbers: mass x
    /// length / second; 0 for pairs without [`Response`](crate::Response).
    pub impulse: f64,
}

impl<'a> Collision<'a> {
    /// Where the bodies meet.
    pub fn points(&self) -> impl Iterator<Item = CollisionPoint> + use<'a> {
        let turned = self.turned;
        let points = self.answer.contacts.iter().map(CollisionPoint::of);
        points.map(move |point| if turned { point.flipped() } else { point })
    }

    /// The deepest point at which they meet; `None` where no point is known.
    #[must_use]
    pub fn deepest(&self) -> Option<CollisionPoint> {
        deepest(self.answer).map(|point| if self.turned { point.flipped() } else { point })
    }
}

impl Collisions<'_, '_> {
    /// All of them, by ascending ids; each pair once, seen from the body with the lower id.
    pub fn iter(&self) -> impl Iterator<Item = Collision<'_>> {
        self.answers(|_| true).into_iter().filter_map(|(pair, answer)| self.seen(pair, answer))
    }

    /// Those of one body, by ascending ids, seen from it.
    pub fn collisions_with(&self, body: Entity) -> impl Iterator<Item = Collision<'_>> {
        let id = self.ids.get(body).ok().map(|body| body.id);
        let own = |(a, b): Pair| Some(a) == id || Some(b) == id;
        let collisions = self.answers(own).into_iter();
        let collisions = collisions.filter_map(|(pair, answer)| self.seen(pair, answer));
        collisions.map(move |c| if c.body == body { c } else { c.flipped() })
    }

    /// What a body meets, by ascending ids.
    pub fn entities_colliding_with(&self, body: Entity) -> impl Iterator<Item = Entity> {
        self.collisions_with(body).map(|collision| collision.other)
    }

    /// The contacts of two bodies, seen from the first; `None` where there are none.
    #[must_use]
    pub fn get(&self, body: Entity, other: Entity) -> Option<Collision<'_>> {
        let [id, with] = [self.ids.get(body).ok()?.id, self.ids.get(other).ok()?.id];
        let pair = ordered(id, with);
        let reported = self.contacts.as_ref().and_then(|report| {
            let at = report.pairs.binary_search_by_key(&pair, |known| (known.a, known.b)).ok()?;
            Some(&report.pairs[at].answer)
        });
        #[cfg(feature = "rapier")]
        let reported = reported.or_else(|| {
            let found = self.solver.as_ref()?.contacts_of(pair)?;
            (!found.answer.contacts.is_empty()).then_some(&*found.answer)
        });
        let answer = reported?;
        let seen = self.seen(pair, answer)?;
        Some(if seen.body == body { seen } else { seen.flipped() })
    }

    /// Whether two bodies touch: of pairs with [`Trigger`](crate::Trigger) what
    /// [`CollisionStart`](crate::CollisionStart) says, of others whether their contacts overlap or
    /// press.
    #[must_use]
    pub fn are_touching(&self, body: Entity, other: Entity) -> bool {
        let ids = [body, other].map(|entity| self.ids.get(entity).ok().map(|body| body.id));
        let [Some(a), Some(b)] = ids else { return false };
        let triggered = self.triggered.as_ref().is_some_and(|t| t.touches(ordered(a, b)));
        if self.effects.tracked(a, b).is_some() {
            return triggered;
        }
        // Of primitives a solver has no answer, but what it pushes touches.
        triggered
            || self.impulse(ordered(a, b)) > 0.0
            || self.get(body, other).is_some_and(|collision| {
                collision.deepest().is_some_and(|point| point.depth >= 0.0)
            })
    }

    /// Answers by pairs that are wanted, each once, ascending.
    fn answers(&self, wanted: impl Fn(Pair) -> bool) -> Vec<(Pair, &Answer)> {
        let reported = self.contacts.iter().flat_map(|report| &report.pairs);
        let reported = reported.map(|pair| ((pair.a, pair.b), &pair.answer));
        let answers: Vec<_> = reported.filter(|(pair, _)| wanted(*pair)).collect();
        #[cfg(feature = "rapier")]
        let answers = {
            let mut answers = answers;
            let solved = self.solver.iter().flat_map(|solver| solver.contacts());
            let solved = solved.map(|(a, b, pair)| ((a, b), &*pair.answer));
            let solved = solved.filter(|(pair, answer)| {
                let reported = |pair| {
                    let report = self.contacts.as_ref();
                    report.is_some_and(|report| {
                        report.pairs.binary_search_by_key(&pair, |p| (p.a, p.b)).is_ok()
                    })
                };
                wanted(*pair) && !answer.contacts.is_empty() && !reported(*pair)
            });
            answers.extend(solved);
            answers.sort_by_key(|(pair, _)| *pair);
            answers
        };
        answers
    }

    fn seen<'a>(&self, (a, b): Pair, answer: &'a Answer) -> Option<Collision<'a>> {
        let [body, other] = [self.records.get(a)?.entity, self.records.get(b)?.entity];
        let impulse = self.impulse((a, b));
        Some(Collision { body, other, turned: false, answer, impulse })
    }

    /// The solver's of the last step; 0 without one.
    #[cfg(feature = "rapier")]
    fn impulse(&self, (a, b): Pair) -> f64 {
        self.solver.as_ref().map_or(0.0, |solver| solver.impulse(a, b))
    }

    #[cfg(not(feature = "rapier"))]
    fn impulse(&self, _: Pair) -> f64 {
        0.0
    }
}

two_bodies!(Collision<'_>);

impl Collision<'_> {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { body: self.other, other: self.body, turned: !self.turned, ..self }
    }
}
