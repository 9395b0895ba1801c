//! A translation by which two models that overlap come apart: what a program without a solver moves
//! a body by.
//!
//! A region of contact knows its own direction and how deep it is along it; where there is one
//! region of two plain bodies, that is the answer. Where there are several, or a body sits in the
//! other's concavity, what parts one region may press another: so the body is led along a direction
//! region by region, each time queried anew, and what has not come out after [`ROUNDS`] is led
//! until a plane parts the hulls. Directions are those of the regions, the deepest first, and of
//! the nearest surface for a body that lies wholly inside; the shortest translation that was found
//! is taken. It is *a* way out: the shortest of all would be a search of its own.

use cranny_exact::DVec3;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, QueryError, Region, query};

use crate::between::{PlacedShape, ShapeQueryError, deepest, query_shapes};
use crate::primitive::Primitive;
use crate::shape::BodyShape;

/// How often a body is led on along one direction. More: a screw in its thread takes longer to be
/// given up; fewer: bodies with many regions are led as far as their hulls reach.
const ROUNDS: usize = 8;

/// Along how many directions at most a way out is looked for. More: a pile of regions takes longer;
/// fewer: the shortest of several ways is missed.
const DIRECTIONS: usize = 4;

/// By how much farther than necessary a body is moved, as a share of the hulls' reach. Smaller:
/// rounding leaves the bodies in each other; larger: the gap is seen.
const ROOM: f64 = 1e-9;

/// Cosine between a region's normal and a direction from which on moving along it parts the region.
/// Smaller: a region at a right angle leads a body out of sight; larger: what leans is left to more
/// rounds.
const ALONG: f64 = 0.1;

/// Cosine of the angle (8 degrees) between directions up to which they are one. Larger: flank after
/// flank of a thread is tried; smaller: a shorter way is missed.
const SAME: f64 = 0.99;

/// The translation of the second model that takes it out of the first one, in world coordinates:
/// afterwards they share no interior point. `None` where they share none now. `answer` is one of
/// [`Demand::Regions`] about the two.
///
/// # Errors
///
/// [`QueryError`] where a pose is invalid, or a body is moved out of the domain of coordinates.
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, Model};
/// use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
/// use cranny_primitives::way_apart;
/// use cranny_shapes::Cuboid;
///
/// let (cube, _) = Model::build(Cuboid { size: [1.0; 3] }.build()?, &BuildOptions::default())?;
/// let place = |x| Placed { model: &cube, pose: Pose::at(DVec3::new(x, 0.25, 0.0)) };
/// let (a, b) = (place(0.0), place(0.75));
/// let found = query(a, b, &Query::of(Demand::Regions { margin: 0.0 }), &mut PairMemory::default())?;
/// let way = way_apart(a, b, &found)?.expect("they overlap");
/// assert!((way - DVec3::new(0.25, 0.0, 0.0)).length() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn way_apart(
    a: Placed<'_>,
    b: Placed<'_>,
    answer: &Answer,
) -> Result<Option<DVec3>, QueryError> {
    if !answer.solid {
        return Ok(None);
    }
    let mut memory = PairMemory::default();
    let mut shortest: Option<DVec3> = None;
    for direction in directions(a, b, answer)? {
        let way = direction * along(a, b, direction, answer, &mut memory)?;
        if shortest.is_none_or(|known| way.length() < known.length()) {
            shortest = Some(way);
        }
    }
    Ok(shortest)
}

/// The same of shapes of which either may be a primitive; `answer` is one of
/// [`Demand::Regions`] of [`query_shapes`]. Beside a primitive the second body is led along the
/// deepest contact, from one to the next, and what has not come out after a few rounds until a
/// plane parts the two.
///
/// `None` also of two half-spaces that meet: there is no way out.
///
/// # Errors
///
/// [`ShapeQueryError`], as [`query_shapes`].
pub fn way_apart_of_shapes(
    a: PlacedShape<'_>,
    b: PlacedShape<'_>,
    answer: &Answer,
) -> Result<Option<DVec3>, ShapeQueryError> {
    if let (BodyShape::Model(first), BodyShape::Model(second)) = (a.shape, b.shape) {
        let [a, b] =
            [(first, a.pose), (second, b.pose)].map(|(model, pose)| Placed { model, pose });
        return Ok(way_apart(a, b, answer)?);
    }
    if !answer.solid {
        return Ok(None);
    }
    let room = ROOM * [a, b].map(extent).into_iter().fold(0.0, f64::max);
    let (direction, contacts) = (first_direction(a, b, answer), Query::of(Demand::contacts(0.0)));
    let (mut moved, mut now) = (DVec3::ZERO, answer.clone());
    for _ in 0..ROUNDS {
        let Some(contact) = deepest(&now) else { break };
        moved += contact.normal * (room - contact.separation);
        let mut pose = b.pose;
        pose.translation += moved;
        now = query_shapes(a, PlacedShape { pose, ..b }, &contacts, &mut PairMemory::default())?;
        if !now.solid {
            return Ok(Some(moved));
        }
    }
    let until = reach_along(a, direction) + reach_along(b, -direction);
    Ok(until.is_finite().then(|| direction * (until + room)))
}

/// Along the deepest contact; where none is found, out of a half-space, or between the centres.
fn first_direction(a: PlacedShape<'_>, b: PlacedShape<'_>, answer: &Answer) -> DVec3 {
    let outward = |placed: PlacedShape<'_>| match placed.primitive() {
        Some(Primitive::HalfSpace(plane)) => plane.normal.try_normalize(),
        _ => None,
    };
    if let Some(normal) = outward(a).or_else(|| outward(b).map(|normal| -normal)) {
        return normal;
    }
    let center = |p: PlacedShape<'_>| p.pose.world_from_body().apply(p.shape.center());
    let between = || (center(b) - center(a)).try_normalize().unwrap_or(DVec3::Z);
    deepest(answer).map_or_else(between, |contact| contact.normal)
}

/// How large a placed shape is and how far from the origin; of a half-space, where its plane is.
fn extent(placed: PlacedShape<'_>) -> f64 {
    let radius = Some(placed.shape.radius()).filter(|radius| radius.is_finite());
    radius.unwrap_or_else(|| placed.shape.center().length()) + placed.pose.translation.length()
}

/// The greatest product of a point of a placed shape with a direction; infinite for a half-space.
fn reach_along(placed: PlacedShape<'_>, direction: DVec3) -> f64 {
    match (placed.shape, placed.primitive()) {
        (BodyShape::Model(model), _) => height(Placed { model, pose: placed.pose }, direction),
        (_, Some(primitive)) => primitive.reach(direction),
        _ => f64::INFINITY,
    }
}

/// Unit vectors along which the second model may come out. There is always one.
fn directions(a: Placed<'_>, b: Placed<'_>, answer: &Answer) -> Result<Vec<DVec3>, QueryError> {
    let mut regions: Vec<&Region> = answer.regions.iter().collect();
    let depth = |region: &&Region| region.depth.unwrap_or(0.0);
    regions.sort_by(|x, y| depth(y).total_cmp(&depth(x)));
    let mut found: Vec<DVec3> = Vec::new();
    let from_inside = if answer.contained.is_some() { out_of(a, b)? } else { None };
    let normals = regions.iter().map(|region| region.normal);
    for direction in from_inside.into_iter().chain(normals) {
        // Directions that hardly differ lead to the same place.
        let is_new = found.iter().all(|known| known.dot(direction) < SAME);
        if is_new && found.len() < DIRECTIONS {
            found.push(direction);
        }
    }
    if found.is_empty() {
        let [of_a, of_b] = [a, b]
            .map(|placed| placed.pose.world_from_body().apply(placed.model.bounds().center()));
        let between = of_b - of_a;
        found.push(between.try_normalize().unwrap_or(DVec3::Z));
    }
    Ok(found)
}

/// From within, the nearest surface is out: the second body leaves by way of its nearest point
/// towards the first one's, whichever of the two is inside.
fn out_of(a: Placed<'_>, b: Placed<'_>) -> Result<Option<DVec3>, QueryError> {
    let nearest = Query::of(Demand::Distance { below: None });
    let answer = query(a, b, &nearest, &mut PairMemory::default())?;
    let Some([of_a, of_b]) = answer.witnesses else { return Ok(None) };
    Ok((of_a.point - of_b.point).try_normalize())
}

/// How far the second model moves along a direction until it is out.
fn along(
    a: Placed<'_>,
    b: Placed<'_>,
    direction: DVec3,
    answer: &Answer,
    memory: &mut PairMemory,
) -> Result<f64, QueryError> {
    let hulls = until_hulls_part(a, b, direction);
    let mut moved = 0.0;
    let mut now = answer.clone();
    let regions = Query::of(Demand::Regions { margin: 0.0 });
    for _ in 0..ROUNDS {
        let parting = now.regions.iter().filter_map(|region| {
            let along = region.normal.dot(direction);
            region.depth.filter(|_| along > ALONG).map(|depth| depth / along)
        });
        let Some(step) = parting.reduce(f64::max).filter(|_| now.contained.is_none()) else {
            return Ok(hulls);
        };
        moved += step + ROOM * hulls;
        if moved >= hulls {
            return Ok(hulls);
        }
        let mut pose = b.pose;
        pose.translation += moved * direction;
        now = query(a, Placed { pose, ..b }, &regions, memory)?;
        if !now.solid {
            return Ok(moved);
        }
    }
    Ok(hulls)
}

/// How far the second model moves until a plane across the direction parts the hulls.
fn until_hulls_part(a: Placed<'_>, b: Placed<'_>, direction: DVec3) -> f64 {
    let until = height(a, direction) + height(b, -direction);
    let size = [a, b].map(|placed| placed.pose.translation.length() + placed.model.radius());
    until + ROOM * size[0].max(size[1])
}

/// The greatest product of a point of a placed model with a direction.
fn height(placed: Placed<'_>, along: DVec3) -> f64 {
    let (map, hull) = (placed.pose.world_from_body(), placed.model.hull());
    let top = hull.support(map.inverse().apply_vector(along), None);
    top.map_or(0.0, |top| map.apply(hull.position(top)).dot(along))
}
