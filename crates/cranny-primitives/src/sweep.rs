//! When two shapes first meet as they move: certified for two meshes; of primitives by steps that
//! are too short to meet within, each as long as the distance allows.

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_impact::{Impact, ImpactError, ImpactOptions, Motion, Moving, time_of_impact};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Query};
use thiserror::Error;

use crate::between::{PlacedShape, ShapeQueryError, query_shapes};
use crate::primitive::{Ball, Checked, Primitive, PrimitiveError};
use crate::revolved::Revolved;
use crate::separation::{Found, found};
use crate::shape::BodyShape;
use crate::turning_cast::{TurningCast, turning_along};

/// Steps of a way beside a primitive. More: what passes closely takes long; fewer: it is left open.
const MOST_STEPS: usize = 1_000;

/// A shape on its way.
#[derive(Clone, Copy, Debug)]
pub struct MovingShape<'a> {
    /// What.
    pub shape: &'a BodyShape,
    /// How, over the time from 0 to 1.
    pub motion: Motion,
}

/// When two shapes meet, as a share of their ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Swept {
    /// Nowhere.
    Free,
    /// They touch at the beginning, or one begins within the other.
    Initially,
    /// For the first time.
    Hit {
        /// Free until then.
        time: f64,
        /// On the second shape, in world coordinates.
        point: DVec3,
        /// Unit, from the first to the second.
        normal: DVec3,
    },
    /// It took too much work to decide.
    Open {
        /// Free until then, unknown from then on.
        free_before: f64,
    },
}

/// A sweep that is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SweepError {
    /// A pose or a number of a shape.
    #[error(transparent)]
    Shape(#[from] ShapeQueryError),
    /// A number of a primitive.
    #[error(transparent)]
    Primitive(#[from] PrimitiveError),
    /// A motion.
    #[error(transparent)]
    Motion(#[from] ImpactError),
}

/// When two shapes first meet. Surfaces that are as near as `options.tolerance`, in units of
/// length, may count as meeting; shapes that are apart at the beginning are not met then.
///
/// # Errors
///
/// [`SweepError`] for a shape or a motion with an invalid number.
pub fn first_meeting(
    a: MovingShape<'_>,
    b: MovingShape<'_>,
    options: &ImpactOptions,
) -> Result<Swept, SweepError> {
    let [a, b] = [a, b].map(without_idle_turn);
    match (a.shape, b.shape) {
        (BodyShape::Model(first), BodyShape::Model(second)) => {
            let [a, b] = [(first, a.motion), (second, b.motion)]
                .map(|(model, motion)| Moving { model, motion });
            Ok(certified(a, b, options)?)
        }
        (BodyShape::Model(model), BodyShape::Primitive(primitive)) => match primitive.checked()? {
            Checked::HalfSpace(_) => advanced(a, b, options),
            Checked::Round(solid) => {
                beside((model, a.motion), (primitive, &solid, b.motion), options)
            }
        },
        (BodyShape::Primitive(primitive), BodyShape::Model(model)) => match primitive.checked()? {
            Checked::HalfSpace(_) => advanced(a, b, options),
            Checked::Round(solid) => {
                let found = beside((model, b.motion), (primitive, &solid, a.motion), options)?;
                Ok(with_primitive_first(found))
            }
        },
        (BodyShape::Primitive(_), BodyShape::Primitive(_)) => advanced(a, b, options),
    }
}

/// How fast a point of one moves beside the other, at most.
pub(crate) fn speed(a: &MovingShape<'_>, b: &MovingShape<'_>) -> f64 {
    let turning =
        a.motion.turn.length() * reach_beside(a, b) + b.motion.turn.length() * reach_beside(b, a);
    a.motion.travel.distance(b.motion.travel) + turning
}

fn certified(a: Moving<'_>, b: Moving<'_>, options: &ImpactOptions) -> Result<Swept, ImpactError> {
    let (impact, _) = time_of_impact(a, b, options)?;
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

/// A ball that turns about its centre does not turn.
fn without_idle_turn(moving: MovingShape<'_>) -> MovingShape<'_> {
    let MovingShape { shape, motion } = moving;
    match shape.primitive() {
        Some(Primitive::Ball(Ball { center, .. })) if *center == motion.pivot => {
            MovingShape { shape, motion: Motion { turn: DVec3::ZERO, ..motion } }
        }
        _ => moving,
    }
}

/// Of a model, which is the first, and a primitive, which is that solid.
fn beside(
    (model, of_model): (&Model, Motion),
    (primitive, solid, own): (&Primitive, &Revolved, Motion),
    options: &ImpactOptions,
) -> Result<Swept, SweepError> {
    let place = of_model.start.inverse().compose(&own.start);
    if let Found::Inside | Found::Meeting =
        found(model, &primitive.moved(&place.world_from_body()), 0.0)?
    {
        return Ok(Swept::Initially);
    }
    let (reach, tolerance) = (primitive.radius_about(own.pivot), options.tolerance);
    Ok(TurningCast { model, of_model, solid, own, reach, tolerance }.first())
}

/// The same where the primitive is the first: at their meeting they share the point.
fn with_primitive_first(found: Swept) -> Swept {
    match found {
        Swept::Hit { time, point, normal } => Swept::Hit { time, point, normal: -normal },
        other => other,
    }
}

/// Of two primitives, or of a half-space and whatever is above it: a plane across the way between
/// the nearest points parts them. Until their distance is spent by what moves along that way,
/// nothing is met (conservative advancement).
fn advanced(
    a: MovingShape<'_>,
    b: MovingShape<'_>,
    options: &ImpactOptions,
) -> Result<Swept, SweepError> {
    let travel = a.motion.travel - b.motion.travel;
    let reaches = [reach_beside(&a, &b), reach_beside(&b, &a)];
    let along = |way: DVec3| {
        let turning =
            turning_along(&a.motion, way) * reaches[0] + turning_along(&b.motion, way) * reaches[1];
        travel.dot(way) + turning
    };
    // Two half-spaces that move have no size to go by.
    let mut tolerance = if options.tolerance.is_finite() { options.tolerance } else { 0.0 };
    let mut time = 0.0;
    for _ in 0..MOST_STEPS {
        let answer = at(a, b, time)?;
        if time == 0.0 {
            if answer.touches() {
                return Ok(Swept::Initially);
            }
            // What is nearer than that already is not met by it.
            tolerance = tolerance.min(0.5 * answer.separation.lo);
        }
        let way = normal(&answer);
        if answer.distance.unwrap_or(0.0) <= tolerance {
            return Ok(ended(&answer, time));
        }
        let closing = way.map_or_else(|| speed(&a, &b), |way| along(way).max(0.0));
        let step = (answer.separation.lo - 0.5 * tolerance) / closing;
        if closing == 0.0 || time + step >= 1.0 {
            return Ok(Swept::Free);
        }
        time += step;
    }
    Ok(Swept::Open { free_before: time })
}

/// How far points of a shape that another one may meet are from the pivot of its motion.
fn reach_beside(moving: &MovingShape<'_>, other: &MovingShape<'_>) -> f64 {
    if moving.motion.turn == DVec3::ZERO {
        return 0.0;
    }
    let own = moving.shape.radius_about(moving.motion.pivot);
    if own.is_finite() {
        return own;
    }
    let [from, to] =
        [moving, other].map(|end| end.motion.start.world_from_body().apply(end.motion.pivot));
    let travel = moving.motion.travel.length() + other.motion.travel.length();
    from.distance(to) + travel + other.shape.radius_about(other.motion.pivot)
}

/// From the nearest point of the first to that of the second, of length 1.
fn normal(answer: &Answer) -> Option<DVec3> {
    let [p, q] = answer.witnesses?.map(|witness| witness.point);
    (q - p).try_normalize()
}

fn at(a: MovingShape<'_>, b: MovingShape<'_>, time: f64) -> Result<Answer, ShapeQueryError> {
    let [a, b] = [a, b].map(|m| PlacedShape { shape: m.shape, pose: m.motion.pose_at(time) });
    let nearest = Query::of(Demand::Distance { below: None });
    query_shapes(a, b, &nearest, &mut PairMemory::default())
}

/// Where an advance ended.
fn ended(answer: &Answer, time: f64) -> Swept {
    let hit = answer.witnesses.zip(normal(answer));
    match hit {
        Some(([_, on_second], normal)) => Swept::Hit { time, point: on_second.point, normal },
        None => Swept::Open { free_before: time },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitive::{Capsule, Cone, Cylinder, HalfSpace};
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::BuildOptions;
    use cranny_shapes::{Cup, Shape, Torus};
    use cranny_testkit::Rng;

    const TOLERANCE: f64 = 1e-4;

    fn built(shape: impl Into<Shape>) -> BodyShape {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0.into()
    }

    fn shapes() -> Vec<BodyShape> {
        let (center, axis, half_height, radius) = (DVec3::ZERO, DVec3::Y, 0.3, 0.2);
        let primitives: [Primitive; 5] = [
            Ball { center: DVec3::X * 0.1, radius }.into(),
            Capsule { ends: [DVec3::NEG_X * 0.5, DVec3::X * 0.4], radius: 0.1 }.into(),
            Cylinder { center, axis, half_height, radius: 0.4, border: 0.0 }.into(),
            Cone { center, axis, half_height, radius, border: 0.05 }.into(),
            HalfSpace { point: center, normal: DVec3::Z }.into(),
        ];
        let ring = Torus { major_radius: 0.5, minor_radius: 0.15, ..Torus::default() };
        let cup = Cup { radius: 0.5, height: 0.8, wall: 0.1, floor: 0.1, segments: 24 };
        let primitives = primitives.map(BodyShape::from);
        [&primitives[..], &[built(ring), built(cup)]].concat()
    }

    fn motion(rng: &mut Rng) -> Motion {
        let mut vector = |size: f64| DVec3::from_array([(); 3].map(|()| size * rng.unit()));
        let (translation, pivot, turn) = (vector(1.5), vector(0.3), vector(2.0));
        let travel = vector(0.7) - translation;
        let rotation: DQuat = rng.rotation();
        Motion { start: Pose { rotation, translation }, pivot, turn, travel }
    }

    fn distance(ends: &[MovingShape<'_>; 2], time: f64) -> f64 {
        at(ends[0], ends[1], time).unwrap().distance.unwrap()
    }

    /// Of any two shapes that travel and turn: free at every time before they meet, and near then.
    #[test]
    fn ways_are_free_before_shapes_meet_and_near_when_they_do() {
        let shapes = shapes();
        let mut rng = Rng::new(21);
        let mut counts = [0; 4];
        for round in 0..700 {
            let (i, j) = (round % shapes.len(), round / shapes.len() % shapes.len());
            let mut moving = |k: usize| MovingShape { shape: &shapes[k], motion: motion(&mut rng) };
            let mut ends = [moving(i), moving(j)];
            for (k, end) in ends.iter_mut().enumerate() {
                let is_endless = end.shape.radius().is_infinite();
                if is_endless || round % 3 == k {
                    end.motion.turn = DVec3::ZERO;
                }
            }
            let sampled = |until: f64| {
                (0..50).map(move |k| until * f64::from(k) / 50.0).map(|time| distance(&ends, time))
            };
            let found = first_meeting(ends[0], ends[1], &ImpactOptions::within(TOLERANCE)).unwrap();
            match found {
                Swept::Initially => {
                    counts[0] += 1;
                    assert_eq!(distance(&ends, 0.0), 0.0);
                }
                Swept::Free => {
                    counts[1] += 1;
                    assert!(sampled(1.02).all(|distance| distance > 0.0), "{round}");
                }
                Swept::Hit { time, point, normal } => {
                    counts[2] += 1;
                    assert!(sampled(time).all(|distance| distance > 0.0), "{round}");
                    assert!(distance(&ends, time) < 1.1 * TOLERANCE, "{round}");
                    // The point is on the second, and the first is a step against the normal away.
                    let ball = Primitive::from(Ball { center: point, radius: 2.0 * TOLERANCE });
                    let ball = BodyShape::from(ball);
                    let here = PlacedShape { shape: &ball, pose: Pose::IDENTITY };
                    for end in ends {
                        let there =
                            PlacedShape { shape: end.shape, pose: end.motion.pose_at(time) };
                        let touch = Query::of(Demand::Intersects);
                        let answer =
                            query_shapes(here, there, &touch, &mut PairMemory::default()).unwrap();
                        assert!(answer.touches(), "{round}: {point}");
                    }
                    assert!((normal.length() - 1.0).abs() < 1e-9);
                }
                Swept::Open { free_before } => {
                    counts[3] += 1;
                    assert!(sampled(free_before).all(|distance| distance > 0.0), "{round}");
                }
            }
        }
        assert!(counts[..3].iter().all(|&count| count > 100) && counts[3] < 40, "{counts:?}");
    }
}
