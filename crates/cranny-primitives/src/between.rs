//! What is answered about two bodies of which either may be a primitive.
//!
//! Two models are queried exactly. A primitive beside a model is measured by this crate, and two
//! primitives by their signed distance (`convex`). An answer about a primitive lacks what only two
//! meshes have.

use cranny_exact::{DVec3, Interval, Meeting, Pose};
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::{
    Answer, Contact, Containment, Demand, Feature, PairMemory, Placed, Query, QueryError, Witness,
    query,
};
use thiserror::Error;

use crate::contacts::contacts;
use crate::convex;
use crate::primitive::{Primitive, PrimitiveError};
use crate::separation::{Found, found};
use crate::shape::BodyShape;

/// Units of rounding, relative to the largest length of a pair, by which a distance may be off.
/// Smaller: [`Answer::separation`] does not hold the distance; larger: it says less than is known.
const DISTANCE_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// What two cylinders or cones are apart by is found to this share of itself: the tolerance of
/// parry's search. Smaller: [`Answer::separation`] does not hold the distance; larger: it says less
/// than is known.
const ITERATED: f64 = 1e-6;

/// A shape at a pose.
#[derive(Clone, Copy, Debug)]
pub struct PlacedShape<'a> {
    /// What.
    pub shape: &'a BodyShape,
    /// Where: world_from_body. Read as [`Pose::accepted`] returns it.
    pub pose: Pose,
}

impl PlacedShape<'_> {
    /// The primitive in world coordinates, if it is one.
    pub(crate) fn primitive(&self) -> Option<Primitive> {
        Some(self.shape.primitive()?.moved(&self.pose.world_from_body()))
    }
}

/// A question about two shapes that is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeQueryError {
    /// A pose or a number of the question.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A number of a primitive.
    #[error("{what} of body {body}: {source}")]
    Primitive {
        /// `'A'` or `'B'`.
        body: char,
        /// The kind of primitive: "ball".
        what: &'static str,
        /// What is wrong with it.
        source: PrimitiveError,
    },
}

/// The answer about two placed shapes, in world coordinates. Of two models it is that of
/// [`query`], exact; `memory` is read and written for them alone.
///
/// Where a primitive takes part:
///
/// - Verdict, distance, witness points and contacts are right to rounding, the distance of two
///   cylinders or cones to a millionth. Touching counts as overlapping: of bodies that meet,
///   [`Answer::surface`] is `Cross` and [`Answer::solid`] holds.
/// - [`Answer::contained`] says only that a primitive lies wholly in a model; of a model in a
///   primitive, or of two primitives, it is `None`. What meets has the distance 0 and no witnesses.
/// - There are no regions, no curves and no pairs of triangles: a demand for regions is answered by
///   distance and contacts. Nothing is counted and nothing remembered.
/// - Two half-spaces have no contacts.
/// - The features of a primitive are numbers of its parts: [`contacts`] names them.
///
/// # Errors
///
/// [`ShapeQueryError`]: a pose that is invalid, or a number of the demand or of a primitive.
pub fn query_shapes(
    a: PlacedShape<'_>,
    b: PlacedShape<'_>,
    question: &Query,
    memory: &mut PairMemory,
) -> Result<Answer, ShapeQueryError> {
    checked([a, b], question.demand)?;
    let [pose_a, pose_b] = [accepted(a.pose, 'A')?, accepted(b.pose, 'B')?];
    let demand = question.demand;
    match (a.shape, b.shape) {
        (BodyShape::Model(first), BodyShape::Model(second)) => {
            let [first, second] =
                [(first, a.pose), (second, b.pose)].map(|(model, pose)| Placed { model, pose });
            Ok(query(first, second, question, memory)?)
        }
        (BodyShape::Model(model), BodyShape::Primitive(primitive)) => {
            let there = primitive.moved(&pose_a.inverse().compose(&pose_b).world_from_body());
            let answer = beside_model(model, &there, demand).map_err(refused('B', primitive))?;
            Ok(answer.moved(&pose_a.world_from_body()))
        }
        (BodyShape::Primitive(primitive), BodyShape::Model(model)) => {
            let there = primitive.moved(&pose_b.inverse().compose(&pose_a).world_from_body());
            let answer = beside_model(model, &there, demand).map_err(refused('A', primitive))?;
            Ok(answer.moved(&pose_b.world_from_body()).swapped())
        }
        (BodyShape::Primitive(first), BodyShape::Primitive(second)) => {
            let there = second.moved(&pose_a.inverse().compose(&pose_b).world_from_body());
            let answer = between(first, &there, demand).map_err(refused('B', second))?;
            Ok(answer.moved(&pose_a.world_from_body()))
        }
    }
}

fn refused(body: char, primitive: &Primitive) -> impl Fn(PrimitiveError) -> ShapeQueryError {
    let what = primitive.name();
    move |source| ShapeQueryError::Primitive { body, what, source }
}

fn accepted(pose: Pose, body: char) -> Result<Pose, QueryError> {
    pose.accepted().map_err(|source| QueryError::Pose { body, source })
}

fn checked(pair: [PlacedShape<'_>; 2], demand: Demand) -> Result<(), ShapeQueryError> {
    demand.check()?;
    for (placed, body) in pair.into_iter().zip(['A', 'B']) {
        if let Some(primitive) = placed.shape.primitive() {
            primitive.check().map_err(refused(body, primitive))?;
        }
    }
    Ok(())
}

/// Up to which distance a demand looks.
fn reach_of(demand: Demand) -> f64 {
    match demand {
        Demand::Distance { below } => below.unwrap_or(f64::INFINITY),
        Demand::Regions { .. } => f64::INFINITY,
        Demand::None | Demand::Intersects | Demand::Contacts { .. } => 0.0,
    }
}

/// A model (A) and a primitive (B) in its frame.
fn beside_model(
    model: &Model,
    primitive: &Primitive,
    demand: Demand,
) -> Result<Answer, PrimitiveError> {
    if demand == Demand::None {
        return Ok(Answer::nothing());
    }
    let found = found(model, primitive, reach_of(demand))?;
    let size = model.radius() + size_of(primitive);
    let mut answer = answer_of(&found, demand, DISTANCE_ROUNDING * size);
    if let Found::Inside = found {
        (answer.surface, answer.contained) = (Meeting::None, Some(Containment::BInA));
    }
    if let Some(margin) = demand.margin() {
        answer.contacts = contacts(model, primitive, margin)?;
    }
    Ok(answer)
}

/// Two primitives in the frame of the first.
fn between(
    first: &Primitive,
    second: &Primitive,
    demand: Demand,
) -> Result<Answer, PrimitiveError> {
    if demand == Demand::None {
        return Ok(Answer::nothing());
    }
    let (found, iterated) = convex::found(first, second, reach_of(demand))?;
    let rounding = DISTANCE_ROUNDING * (size_of(first) + size_of(second));
    let distance = if let Found::Apart { distance, .. } = found { distance } else { 0.0 };
    let error = rounding + if iterated { ITERATED * distance } else { 0.0 };
    let mut answer = answer_of(&found, demand, error);
    if let Some(margin) = demand.margin() {
        answer.contacts = convex::contacts(first, second, margin)?;
    }
    Ok(answer)
}

/// The largest length about a primitive; how far the plane is, for a half-space.
fn size_of(primitive: &Primitive) -> f64 {
    match primitive {
        Primitive::HalfSpace(half_space) => half_space.point.length(),
        _ => primitive.radius_about(DVec3::ZERO),
    }
}

fn answer_of(found: &Found, demand: Demand, error: f64) -> Answer {
    let meets = matches!(found, Found::Meeting | Found::Inside);
    let mut answer = Answer {
        surface: if meets { Meeting::Cross } else { Meeting::None },
        solid: meets,
        ..Answer::nothing()
    };
    if !matches!(demand, Demand::Distance { .. } | Demand::Regions { .. }) {
        return answer;
    }
    match *found {
        Found::Meeting | Found::Inside => {
            (answer.distance, answer.separation) = (Some(0.0), Interval::point(0.0));
        }
        // No less than the bound, by the contract of demands.
        Found::Apart { distance, .. } if distance >= reach_of(demand) => {
            answer.distance = Some(f64::INFINITY);
            answer.separation = Interval { lo: (distance - error).max(0.0), hi: f64::INFINITY };
        }
        Found::Apart { distance, points, features } => {
            let [p, q] = [0, 1].map(|i| Witness { point: points[i], feature: features[i] });
            answer.distance = Some(distance);
            answer.separation = Interval::around(distance, error);
            answer.witnesses = Some([p, q]);
        }
        Found::Farther => {
            let lo = (reach_of(demand) - error).max(0.0);
            answer.distance = Some(f64::INFINITY);
            answer.separation = Interval { lo, hi: f64::INFINITY };
        }
    }
    answer
}

/// The part of a primitive that has no parts of its own.
pub(crate) const WHOLE_PRIMITIVE: Feature = Feature::Face(FaceId(0));

/// The deepest contact, where bodies overlap.
pub(crate) fn deepest(answer: &Answer) -> Option<&Contact> {
    let overlapping = answer.contacts.iter().filter(|contact| contact.separation <= 0.0);
    overlapping.min_by(|x, y| x.separation.total_cmp(&y.separation))
}
