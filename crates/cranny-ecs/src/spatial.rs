//! Questions of an app about the bodies around a place: rays, shapes, points, distances.

use std::cell::Cell;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_ecs::system::{SystemChangeTick, SystemParam};
use bevy_math::{Dir3, Vec3};
use bevy_transform::components::Transform;
use cranny_exact::{Aabb, DVec3, Pose};
use cranny_geometry::FaceId;
use cranny_impact::{ImpactError, ImpactOptions, Motion};
use cranny_narrow_phase::{
    Answer, Containment, Demand, PairMemory, Query as PairQuery, QueryError,
};
use cranny_primitives::{
    BodyShape, MovingShape, PlacedShape, PrimitiveError, Separation, ShapeQueryError, ShapeRayHit,
    SweepError, Swept, cast_ray_at_shape, first_meeting, query_shapes, separation_of_point,
};
use cranny_world::{BodyId, Layers, world_box};
use thiserror::Error;

use crate::body::{Bodies, Body, BodyRecord, pose_of, widened};
use crate::collider::Collider;
use crate::properties::{AngularVelocity, CollisionLayers, LinearVelocity};
use crate::spatial_index::{SeenBoxes, SpatialIndex};

/// How near surfaces are where a cast ends, as a share of the smaller body's radius. Larger: bodies
/// stop visibly short; smaller: f32 does not resolve it, and it takes longer.
const CAST_TOLERANCE: f64 = 1e-6;

/// Which bodies a question is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpatialQueryFilter {
    /// Layers, as bits: bodies in none of them are left out. All until then.
    pub mask: u32,
    /// Entities that are left out.
    pub excluded: Vec<Entity>,
}

impl Default for SpatialQueryFilter {
    fn default() -> Self {
        Self { mask: u32::MAX, excluded: Vec::new() }
    }
}

impl SpatialQueryFilter {
    /// Bodies in some layers.
    #[must_use]
    pub fn from_mask(mask: u32) -> Self {
        Self { mask, ..Self::default() }
    }

    /// All but some entities.
    #[must_use]
    pub fn from_excluded_entities(excluded: impl IntoIterator<Item = Entity>) -> Self {
        Self { excluded: excluded.into_iter().collect(), ..Self::default() }
    }

    fn takes(&self, entity: Entity, layers: Layers) -> bool {
        layers.memberships & self.mask != 0 && !self.excluded.contains(&entity)
    }
}

/// A question that cannot be answered.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SpatialQueryError {
    /// An entity that is no body: it has no collider, or no step has taken it in yet.
    #[error(
        "entity {entity} is no body: it needs a Collider, and a step that has taken it in since"
    )]
    NoBody {
        /// The entity.
        entity: Entity,
    },
    /// Two primitives, of which one is to lie in the other.
    #[error(
        "whether a primitive lies in the primitive of entity {outer} is not known: one of the two \
         must be a mesh"
    )]
    InPrimitive {
        /// The entity that is to hold the other.
        outer: Entity,
    },
    /// A place, direction or length that is none.
    #[error(transparent)]
    Number(#[from] PrimitiveError),
    /// A pose, margin or length that is refused.
    #[error(transparent)]
    Query(#[from] ShapeQueryError),
    /// A motion that cannot be followed.
    #[error(transparent)]
    Motion(#[from] ImpactError),
}

impl From<SweepError> for SpatialQueryError {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Primitive(error) => Self::Number(error),
            SweepError::Shape(error) => Self::Query(error),
            SweepError::Motion(error) => Self::Motion(error),
        }
    }
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for SpatialQueryError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Where a ray meets a body. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHitData {
    /// The body.
    pub entity: Entity,
    /// From the ray's origin, >= 0, in units of length.
    pub distance: f64,
    /// The point on its surface.
    pub point: DVec3,
    /// Unit, out of the face.
    pub normal: DVec3,
    /// The face of the collider's mesh; `None` of a primitive.
    pub face: Option<FaceId>,
    /// Whether the ray comes from inside the body's solid.
    pub from_inside: bool,
}

/// Where a moving shape meets a body. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHitData {
    /// The body.
    pub entity: Entity,
    /// How far the shape travels freely, in units of length: certified.
    pub distance: f64,
    /// Where the two meet, on the body; `None` where they meet at the beginning.
    pub point: Option<DVec3>,
    /// Unit, out of the body, at the point.
    pub normal: Option<DVec3>,
}

/// How far two bodies are apart. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoints {
    /// Between their surfaces, >= 0; 0 where they meet, and where a primitive meets the other or
    /// lies in it.
    pub distance: f64,
    /// A point of each that realises it; `None` where surfaces cross, and where a primitive meets
    /// the other or lies in it.
    pub points: Option<[DVec3; 2]>,
    /// Whether they share interior points, or one lies inside the other.
    pub overlap: bool,
}

/// The point of a body that is nearest to another. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointProjection {
    /// The body.
    pub entity: Entity,
    /// The nearest point; the point itself where it lies in the body.
    pub point: DVec3,
    /// How far away it is: 0 inside.
    pub distance: f64,
    /// Whether the point lies in the body's solid or on its surface.
    pub is_inside: bool,
}

/// When two bodies meet as they move now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeOfImpact {
    /// Not within the time of the question: certified between meshes.
    None,
    /// Seconds from now: free until then, met to rounding then. 0 where they meet already.
    At(f64),
    /// It took too much work to decide: certified free for so many seconds, unknown from then on.
    FreeFor(f64),
}

/// Queries the bodies where their `Transform`s are now: in any schedule, at any time, without a
/// plugin. Bodies are those that a step has taken in.
///
/// An answer about meshes is exact or certified, as everywhere in Cranny: a ray slips through
/// no edge, shapes overlap where their solids do and not where their hulls do, and a cast passes
/// nothing, however thin or fast. Of primitives it is right to rounding, and rays to parry's
/// tolerance.
///
/// A question costs what lies near, found by a tree of boxes, and a look at when each body last
/// changed. A system keeps its tree for as long as no body moves, comes or leaves; then its next
/// question costs a box a body, and sorting them.
///
/// ```
/// use bevy_ecs::prelude::*;
/// use bevy_math::{Dir3, Vec3};
/// use cranny_ecs::{SpatialQuery, SpatialQueryError, SpatialQueryFilter};
///
/// fn look_down(spatial: SpatialQuery) -> Result<(), SpatialQueryError> {
///     let all = SpatialQueryFilter::default();
///     let from = Vec3::new(0.0, 0.0, 10.0);
///     if let Some(hit) = spatial.cast_ray(from, Dir3::NEG_Z, 100.0, &all)? {
///         println!("{} is {} below", hit.entity, hit.distance);
///     }
///     Ok(())
/// }
/// ```
#[derive(SystemParam)]
pub struct SpatialQuery<'w, 's> {
    bodies: Query<'w, 's, Placement>,
    records: Res<'w, Bodies>,
    index: Local<'s, SpatialIndex>,
    ticks: SystemChangeTick,
}

/// A body, where it is and how it moves, and its layers.
type Placement = (
    &'static Body,
    Ref<'static, Transform>,
    &'static LinearVelocity,
    &'static AngularVelocity,
    Option<&'static CollisionLayers>,
);

/// A body of a question.
#[derive(Clone, Copy)]
struct Candidate<'a> {
    record: &'a BodyRecord,
    pose: Pose,
}

impl<'a> Candidate<'a> {
    fn shape(&self) -> &'a BodyShape {
        &self.record.shape
    }

    fn bounds(&self) -> Aabb {
        world_box(self.shape(), &self.pose, 0.0)
    }
}

impl SpatialQuery<'_, '_> {
    /// The first body that a ray meets, no farther away than `max_distance`; of equals the one with
    /// the lowest id. A ray that begins in a body sees its surface from inside.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::Number`] for an origin or a distance that is none.
    pub fn cast_ray(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f64,
        filter: &SpatialQueryFilter,
    ) -> Result<Option<RayHitData>, SpatialQueryError> {
        let ray = RayOf::checked(origin, direction, max_distance)?;
        let (bodies, within) = (self.seen(), Cell::new(max_distance));
        let mut first: Option<(f64, BodyId, RayHitData)> = None;
        for id in bodies.reached(|held| ray.enters(held, within.get())) {
            let Some(body) = self.candidate(id, filter) else { continue };
            // To the last bit the same as without the others: not up to what is met already.
            let Some(hit) = ray.at(&body, max_distance)? else { continue };
            if first.is_none_or(|(distance, before, _)| (hit.distance, id) < (distance, before)) {
                within.set(hit.distance);
                first = Some((hit.distance, id, hit));
            }
        }
        Ok(first.map(|(_, _, hit)| hit))
    }

    /// Where a ray enters or leaves bodies first, one hit a body, the nearest first.
    ///
    /// # Errors
    ///
    /// As [`cast_ray`](Self::cast_ray).
    pub fn ray_hits(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f64,
        filter: &SpatialQueryFilter,
    ) -> Result<Vec<RayHitData>, SpatialQueryError> {
        let ray = RayOf::checked(origin, direction, max_distance)?;
        let bodies = self.seen();
        let mut met: Vec<BodyId> = bodies.reached(|held| ray.enters(held, max_distance)).collect();
        met.sort_unstable();
        let met = met.into_iter().filter_map(|id| self.candidate(id, filter));
        let hits = met.filter_map(|body| ray.at(&body, max_distance).transpose());
        let mut hits: Vec<RayHitData> = hits.collect::<Result<_, _>>()?;
        hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok(hits)
    }

    /// The first body that a shape meets as it travels straight, without turning. A shape that
    /// meets something at the beginning travels no way.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::Query`] for a start that is no pose, [`SpatialQueryError::Number`] or
    /// [`SpatialQueryError::Motion`] for a way that is none.
    pub fn cast_shape(
        &self,
        shape: &Collider,
        start: &Transform,
        travel: Vec3,
        filter: &SpatialQueryFilter,
    ) -> Result<Option<ShapeHitData>, SpatialQueryError> {
        let (start, travel) = (pose_checked(start)?, finite("travel", travel)?);
        let length = travel.length();
        let whole = swept_box(shape.shape(), &Motion::straight(start, travel));
        let mut first: Option<ShapeHitData> = None;
        for body in self.near(&whole, filter) {
            // Beyond what is met already nothing matters.
            let share = first.map_or(1.0, |hit| (hit.distance / length).min(1.0));
            let motion = Motion::straight(start, share * travel);
            if !swept_box(shape.shape(), &motion).overlaps(&body.bounds()) {
                continue;
            }
            let moving = MovingShape { shape: shape.shape(), motion };
            let still = MovingShape { shape: body.shape(), motion: Motion::at_rest(body.pose) };
            let entity = body.record.entity;
            let before = first.is_some_and(|hit| hit.distance == 0.0);
            first = match met(moving, still)? {
                Swept::Free => first,
                Swept::Initially if before => first,
                Swept::Initially => {
                    Some(ShapeHitData { entity, distance: 0.0, point: None, normal: None })
                }
                Swept::Hit { time, point, normal } => Some(ShapeHitData {
                    entity,
                    distance: share * length * time,
                    point: Some(point),
                    normal: Some(-normal),
                }),
                Swept::Open { free_before } => Some(ShapeHitData {
                    entity,
                    distance: share * length * free_before,
                    point: None,
                    normal: None,
                }),
            };
        }
        Ok(first)
    }

    /// The bodies whose solids a shape touches or overlaps, by ascending ids.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::Query`] for a transform that is no pose.
    pub fn shape_intersections(
        &self,
        shape: &Collider,
        at: &Transform,
        filter: &SpatialQueryFilter,
    ) -> Result<Vec<Entity>, SpatialQueryError> {
        let here = PlacedShape { shape: shape.shape(), pose: pose_checked(at)? };
        let around = world_box(here.shape, &here.pose, 0.0);
        let mut met = Vec::new();
        for body in self.near(&around, filter) {
            let answer = answer_about(here, placed(&body), Demand::Intersects)?;
            if answer.touches() {
                met.push(body.record.entity);
            }
        }
        Ok(met)
    }

    /// The bodies in whose solids a point lies, by ascending ids.
    #[must_use]
    pub fn point_intersections(&self, point: Vec3, filter: &SpatialQueryFilter) -> Vec<Entity> {
        let holds = |body: &Candidate<'_>| {
            let here = in_frame_of(body, point);
            separation_of_point(body.shape(), here, 0.0) == Ok(Separation::Meeting)
        };
        let here = Aabb::of_points([widened(point)]);
        self.near(&here, filter).filter(holds).map(|body| body.record.entity).collect()
    }

    /// The point of any body that is nearest to a given one, no farther away than `max_distance`;
    /// of equals that of the lowest id.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::Number`] for a point that is none.
    pub fn project_point(
        &self,
        point: Vec3,
        max_distance: f64,
        filter: &SpatialQueryFilter,
    ) -> Result<Option<PointProjection>, SpatialQueryError> {
        let at = Aabb::of_points([finite("point", point)?]);
        length_checked(max_distance)?;
        let (bodies, within) = (self.seen(), Cell::new(max_distance));
        let near = |held: &Aabb| held.distance_squared_lower(&at) <= within.get() * within.get();
        let mut nearest: Option<(f64, BodyId, PointProjection)> = None;
        for id in bodies.reached(near) {
            let Some(body) = self.candidate(id, filter) else { continue };
            let Some(found) = projected(&body, point, within.get())? else { continue };
            let key = (found.distance, id);
            if nearest.is_none_or(|(distance, before, _)| key < (distance, before)) {
                within.set(found.distance);
                nearest = Some((found.distance, id, found));
            }
        }
        Ok(nearest.map(|(_, _, found)| found))
    }

    /// How far two bodies are apart, and where.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::NoBody`].
    pub fn closest_points(&self, a: Entity, b: Entity) -> Result<ClosestPoints, SpatialQueryError> {
        let [a, b] = [self.body(a)?, self.body(b)?];
        let answer = answer_about(placed(&a), placed(&b), Demand::Distance { below: None })?;
        Ok(ClosestPoints {
            distance: answer.distance.unwrap_or(0.0),
            points: answer.witnesses.map(|both| both.map(|witness| witness.point)),
            overlap: answer.solid || answer.contained.is_some(),
        })
    }

    /// Whether two bodies touch or overlap: exact.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::NoBody`].
    pub fn intersects(&self, a: Entity, b: Entity) -> Result<bool, SpatialQueryError> {
        let [a, b] = [self.body(a)?, self.body(b)?];
        Ok(answer_about(placed(&a), placed(&b), Demand::Intersects)?.touches())
    }

    /// Whether a body lies wholly in the closed solid of another, whose surface it may touch from
    /// inside: exact between meshes, else right to rounding.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::NoBody`], or [`SpatialQueryError::InPrimitive`] for a primitive in a
    /// primitive.
    pub fn contains(&self, outer: Entity, inner: Entity) -> Result<bool, SpatialQueryError> {
        let [outer, inner] = [self.body(outer)?, self.body(inner)?];
        match (outer.shape(), inner.shape()) {
            (BodyShape::Model(_), _) => {
                let answer = answer_about(placed(&outer), placed(&inner), Demand::Intersects)?;
                Ok(answer.contained == Some(Containment::BInA))
            }
            (BodyShape::Primitive(_), BodyShape::Model(model)) => {
                let map = outer.pose.inverse().compose(&inner.pose).world_from_body();
                let mut corners = model.mesh().vertices().iter().map(|&corner| map.apply(corner));
                let holds = |corner| separation_of_point(outer.shape(), corner, 0.0);
                Ok(corners.all(|corner| holds(corner) == Ok(Separation::Meeting)))
            }
            (BodyShape::Primitive(_), BodyShape::Primitive(_)) => {
                Err(SpatialQueryError::InPrimitive { outer: outer.record.entity })
            }
        }
    }

    /// When two bodies meet within so many seconds, if both keep their velocities: nothing is
    /// missed, however fast.
    ///
    /// # Errors
    ///
    /// [`SpatialQueryError::NoBody`], or [`SpatialQueryError::Motion`] for velocities or a time
    /// that are none.
    pub fn time_of_impact(
        &self,
        a: Entity,
        b: Entity,
        seconds: f64,
    ) -> Result<TimeOfImpact, SpatialQueryError> {
        let moving = |entity: Entity| {
            let body = self.body(entity)?;
            let (_, _, linear, angular, _) =
                self.bodies.get(entity).map_err(|_| SpatialQueryError::NoBody { entity })?;
            let motion = Motion {
                start: body.pose,
                pivot: body.shape().center(),
                turn: seconds * widened(angular.0),
                travel: seconds * widened(linear.0),
            };
            Ok::<_, SpatialQueryError>(MovingShape { shape: body.shape(), motion })
        };
        let [a, b] = [moving(a)?, moving(b)?];
        Ok(match met(a, b)? {
            Swept::Free => TimeOfImpact::None,
            Swept::Initially => TimeOfImpact::At(0.0),
            Swept::Hit { time, .. } => TimeOfImpact::At(seconds * time),
            Swept::Open { free_before } => TimeOfImpact::FreeFor(seconds * free_before),
        })
    }

    /// Where all bodies are now.
    fn seen(&self) -> Arc<SeenBoxes> {
        let bodies =
            self.bodies.iter().map(|(body, transform, ..)| (body.id, transform.last_changed()));
        let boxes = self.bodies.iter().filter_map(|(body, transform, ..)| {
            let record = self.records.get(body.id)?;
            Some((body.id, Candidate { record, pose: pose_of(&transform) }.bounds()))
        });
        self.index.now(self.ticks.this_run(), self.records.last_changed(), bodies, boxes)
    }

    /// The bodies whose boxes overlap another one, by ascending ids.
    fn near<'a>(
        &'a self,
        around: &Aabb,
        filter: &'a SpatialQueryFilter,
    ) -> impl Iterator<Item = Candidate<'a>> {
        let near = self.seen().overlapping(around).into_iter();
        near.filter_map(move |id| self.candidate(id, filter))
    }

    /// A body, if the question is about it.
    fn candidate(&self, id: BodyId, filter: &SpatialQueryFilter) -> Option<Candidate<'_>> {
        let record = self.records.get(id)?;
        let (_, transform, _, _, layers) = self.bodies.get(record.entity).ok()?;
        let layers = layers.copied().unwrap_or_default().0;
        let taken = filter.takes(record.entity, layers);
        taken.then(|| Candidate { record, pose: pose_of(&transform) })
    }

    fn body(&self, entity: Entity) -> Result<Candidate<'_>, SpatialQueryError> {
        let found = self.bodies.get(entity).ok().and_then(|(body, transform, ..)| {
            Some(Candidate { record: self.records.get(body.id)?, pose: pose_of(&transform) })
        });
        found.ok_or(SpatialQueryError::NoBody { entity })
    }
}

fn placed<'a>(body: &Candidate<'a>) -> PlacedShape<'a> {
    PlacedShape { shape: body.shape(), pose: body.pose }
}

fn answer_about(
    a: PlacedShape<'_>,
    b: PlacedShape<'_>,
    demand: Demand,
) -> Result<Answer, ShapeQueryError> {
    query_shapes(a, b, &PairQuery::of(demand), &mut PairMemory::default())
}

fn met(a: MovingShape<'_>, b: MovingShape<'_>) -> Result<Swept, SweepError> {
    let tolerance = CAST_TOLERANCE * a.shape.radius().min(b.shape.radius());
    first_meeting(a, b, &ImpactOptions::within(tolerance))
}

fn in_frame_of(body: &Candidate<'_>, point: Vec3) -> DVec3 {
    body.pose.world_from_body().inverse().apply(widened(point))
}

/// The ray of a question, in the world.
struct RayOf {
    origin: Vec3,
    direction: Dir3,
    /// Far beyond whatever has a box in single precision.
    end: DVec3,
}

/// How far rays are followed through boxes: beyond all numbers of single precision. Smaller, and
/// what is farther is not met; larger, and squares overflow.
const FARTHEST: f64 = 1e40;

/// By what the distance of a box may be wrong, as a share. Smaller, and what is met at its box is
/// missed; larger, and more boxes are opened.
const BOX_ROUNDING: f64 = 1e-12;

impl RayOf {
    fn checked(origin: Vec3, direction: Dir3, within: f64) -> Result<Self, PrimitiveError> {
        let from = finite("origin", origin)?;
        length_checked(within)?;
        Ok(Self {
            origin,
            direction,
            end: from + FARTHEST * widened(direction.as_vec3()).normalize(),
        })
    }

    /// Whether it enters a box no farther away than that.
    fn enters(&self, held: &Aabb, within: f64) -> bool {
        let share = held.entered_at(widened(self.origin), self.end);
        share.is_some_and(|share| share * FARTHEST * (1.0 - BOX_ROUNDING) <= within)
    }

    /// Where it meets a body, no farther away than that.
    fn at(&self, body: &Candidate<'_>, within: f64) -> Result<Option<RayHitData>, PrimitiveError> {
        let map = body.pose.world_from_body();
        let along = map.inverse().apply_vector(widened(self.direction.as_vec3()));
        let hit = cast_ray_at_shape(body.shape(), in_frame_of(body, self.origin), along, within)?;
        let filed = |face| body.record.model().map(|model| model.filed_face(face));
        Ok(hit.map(|ShapeRayHit { distance, point, normal, face, from_behind }| RayHitData {
            entity: body.record.entity,
            distance,
            point: map.apply(point),
            normal: map.apply_vector(normal),
            face: face.and_then(filed),
            from_inside: from_behind,
        }))
    }
}

/// The point of a body that is nearest to another, no farther away than that.
fn projected(
    body: &Candidate<'_>,
    point: Vec3,
    within: f64,
) -> Result<Option<PointProjection>, PrimitiveError> {
    let entity = body.record.entity;
    let found = separation_of_point(body.shape(), in_frame_of(body, point), within)?;
    Ok(match found {
        Separation::Farther => None,
        Separation::Meeting => {
            Some(PointProjection { entity, point: widened(point), distance: 0.0, is_inside: true })
        }
        Separation::Apart { distance, witnesses: [on_body, _] } => Some(PointProjection {
            entity,
            point: body.pose.world_from_body().apply(on_body),
            distance,
            is_inside: false,
        }),
    })
}

/// A box around a shape on a way on which it does not turn.
fn swept_box(shape: &BodyShape, motion: &Motion) -> Aabb {
    let ends = [0.0, 1.0].map(|t| world_box(shape, &motion.pose_at(t), 0.0));
    ends[0].union(&ends[1])
}

fn length_checked(value: f64) -> Result<(), PrimitiveError> {
    if value >= 0.0 { Ok(()) } else { Err(PrimitiveError::Length { what: "distance", value }) }
}

/// The pose of a transform that a question names.
fn pose_checked(transform: &Transform) -> Result<Pose, ShapeQueryError> {
    let Pose { rotation, translation } = pose_of(transform);
    let refused = |source| QueryError::Pose { body: 'A', source };
    Ok(Pose::checked(rotation, translation).map_err(refused)?)
}

fn finite(what: &'static str, value: Vec3) -> Result<DVec3, PrimitiveError> {
    let value = widened(value);
    if value.is_finite() { Ok(value) } else { Err(PrimitiveError::Place { what, value }) }
}
