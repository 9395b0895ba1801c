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
    let height = |placed: Placed<'_>, along: DVec3| {
        let (map, hull) = (placed.pose.world_from_body(), placed.model.hull());
        let top = hull.support(map.inverse().apply_vector(along), None);
        top.map_or(0.0, |top| map.apply(hull.position(top)).dot(direction))
    };
    let (highest, lowest) = (height(a, direction), height(b, -direction));
    let size = [a, b].map(|placed| placed.pose.translation.length() + placed.model.radius());
    highest - lowest + ROOM * size[0].max(size[1])
}
