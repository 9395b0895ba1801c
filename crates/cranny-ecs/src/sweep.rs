//! When two shapes first meet as they move: certified for two meshes; where a primitive takes part
//! by steps that are too short to meet within, each as long as the distance allows.

use cranny_exact::DVec3;
use cranny_impact::{Impact, ImpactError, ImpactOptions, Motion, Moving, time_of_impact};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Query};
use cranny_primitives::{BodyShape, PlacedShape, Primitive, query_shapes};

use crate::spatial::SpatialQueryError;

/// How near surfaces are where a cast ends, as a share of the smaller body's radius. Larger: bodies
/// stop visibly short; smaller: f32 cannot tell, and it takes longer.
const CAST_TOLERANCE: f64 = 1e-6;

/// Steps of a way beside a primitive. More: what passes closely takes long; fewer: it is left open.
const MOST_STEPS: usize = 1_000;

/// A shape on its way.
#[derive(Clone, Copy)]
pub(crate) struct MovingShape<'a> {
    pub(crate) shape: &'a BodyShape,
    pub(crate) motion: Motion,
}

/// When two shapes meet, as a share of their ways.
pub(crate) enum Swept {
    /// Nowhere.
    Free,
    /// They touch at the beginning.
    Initially,
    Hit {
        /// Free until then.
        time: f64,
        /// On the second shape.
        point: DVec3,
        /// Unit, from the first to the second.
        normal: DVec3,
    },
    /// It took too much work to decide: free until then.
    Open { free_before: f64 },
}

pub(crate) fn first_meeting(
    a: MovingShape<'_>,
    b: MovingShape<'_>,
) -> Result<Swept, SpatialQueryError> {
    let tolerance = CAST_TOLERANCE * a.shape.radius().min(b.shape.radius());
    match (a.shape, b.shape) {
        (BodyShape::Model(first), BodyShape::Model(second)) => {
            let [a, b] = [(first, a.motion), (second, b.motion)]
                .map(|(model, motion)| Moving { model, motion });
            Ok(certified(a, b, tolerance)?)
        }
        _ => advanced(a, b, tolerance),
    }
}

fn certified(a: Moving<'_>, b: Moving<'_>, tolerance: f64) -> Result<Swept, ImpactError> {
    let (impact, _) = time_of_impact(a, b, &ImpactOptions::within(tolerance))?;
    Ok(match impact {
        Impact::None => Swept::Free,
        Impact::Initially { .. } => Swept::Initially,
        Impact::Hit(hit) => {
            let (point, normal) = (hit.witnesses[1].point, hit.normal);
            Swept::Hit { time: hit.time.lo, point, normal }
        }
        Impact::Open { free_before } => Swept::Open { free_before },
    })
}

/// Conservative advancement: until the distance is spent by a bound of how fast the two come
/// nearer, nothing is met.
fn advanced(
    a: MovingShape<'_>,
    b: MovingShape<'_>,
    tolerance: f64,
) -> Result<Swept, SpatialQueryError> {
    let turning = turning(&a) + turning(&b);
    let travel = a.motion.travel - b.motion.travel;
    let parted_by_planes = are_parted_by_planes(a.shape, b.shape);
    // Two half-spaces that move have no size to go by.
    let tolerance = if tolerance.is_finite() { tolerance } else { 0.0 };
    let mut time = 0.0;
    for _ in 0..MOST_STEPS {
        let answer = at(a, b, time)?;
        let distance = answer.distance.unwrap_or(0.0);
        if distance <= tolerance {
            return Ok(ended(&answer, time));
        }
        let along = normal(&answer).filter(|_| parted_by_planes);
        let closing = along.map_or(travel.length(), |way| travel.dot(way).max(0.0)) + turning;
        let step = (answer.separation.lo - 0.5 * tolerance) / closing;
        if closing == 0.0 || time + step >= 1.0 {
            return Ok(Swept::Free);
        }
        time += step;
    }
    Ok(Swept::Open { free_before: time })
}

/// Whether a plane across the way between the nearest points parts the two: convex bodies, and
/// whatever is above a half-space. Then only what moves along that way brings them nearer.
fn are_parted_by_planes(a: &BodyShape, b: &BodyShape) -> bool {
    let primitives = [a, b].map(BodyShape::primitive);
    let is_plane = |primitive: &Primitive| matches!(primitive, Primitive::HalfSpace(_));
    primitives.iter().all(Option::is_some) || primitives.into_iter().flatten().any(is_plane)
}

/// From the nearest point of the first to that of the second, of length 1.
fn normal(answer: &Answer) -> Option<DVec3> {
    let [p, q] = answer.witnesses?.map(|witness| witness.point);
    (q - p).try_normalize()
}

/// How far a point of a shape moves by turning, at most.
fn turning(moving: &MovingShape<'_>) -> f64 {
    let angle = moving.motion.turn.length();
    if angle == 0.0 { 0.0 } else { angle * moving.shape.radius_about(moving.motion.pivot) }
}

fn at(a: MovingShape<'_>, b: MovingShape<'_>, time: f64) -> Result<Answer, SpatialQueryError> {
    let [a, b] = [a, b].map(|m| PlacedShape { shape: m.shape, pose: m.motion.pose_at(time) });
    let nearest = Query::of(Demand::Distance { below: None });
    Ok(query_shapes(a, b, &nearest, &mut PairMemory::default())?)
}

/// Where an advance ended.
fn ended(answer: &Answer, time: f64) -> Swept {
    let hit = answer.witnesses.zip(normal(answer));
    match hit {
        _ if time == 0.0 => Swept::Initially,
        Some(([_, on_second], normal)) => Swept::Hit { time, point: on_second.point, normal },
        None => Swept::Open { free_before: time },
    }
}
