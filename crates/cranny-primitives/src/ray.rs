//! Where a ray first meets a model.
//!
//! Whether a ray passes a face is decided by exact signs, which neighbouring faces share: no ray
//! slips between them, and none misses a corner.

use cranny_exact::{DVec3, Sign, orient3d};
use cranny_geometry::{FaceId, Model};

use crate::cast::each_face_on_the_way;
use crate::primitive::{PrimitiveError, direction, place};

/// By what the distance at which a ray enters a box may be wrong, as a share of it: a few
/// roundings. Smaller, and what is met at the box is missed; larger, and more boxes are opened.
const BOX_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Where a ray meets a model, in the model's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// From the ray's origin, >= 0, in units of length.
    pub distance: f64,
    /// The point on the surface.
    pub point: DVec3,
    /// Unit, out of the face.
    pub normal: DVec3,
    /// The face; the first of several that are met at the same distance.
    pub face: FaceId,
    /// Whether the ray comes from behind the face: of a closed mesh, from inside the solid.
    pub from_behind: bool,
}

/// Finds where a ray first meets the surface of a model, in its frame, no farther away than
/// `within` (>= 0, infinite for any distance). `None` where it does not.
///
/// The ray is the segment from its origin to the point at that distance, rounded: which faces it
/// meets is exact for that segment; distance, point and normal are right to a few roundings. Faces
/// of no area, and faces in whose plane the ray lies, are not met: their neighbours are.
///
/// Cost: the boxes that the ray passes, the nearest first.
///
/// # Errors
///
/// [`PrimitiveError`] for an origin that is not finite, a direction that is zero or not finite, and
/// a distance that is none.
///
/// ```
/// use cranny_exact::DVec3;
/// use cranny_geometry::{BuildOptions, Model};
/// use cranny_primitives::cast_ray;
/// use cranny_shapes::Cuboid;
///
/// let (cube, _) = Model::build(Cuboid { size: [2.0; 3] }.build()?, &BuildOptions::default())?;
/// let from = DVec3::new(0.0, 0.0, 5.0);
/// let hit = cast_ray(&cube, from, DVec3::NEG_Z, f64::INFINITY)?.expect("it looks at the cube");
/// assert_eq!((hit.distance, hit.normal, hit.from_behind), (4.0, DVec3::Z, false));
/// assert_eq!(cast_ray(&cube, from, DVec3::NEG_Z, 3.9)?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cast_ray(
    model: &Model,
    origin: DVec3,
    direction_of_ray: DVec3,
    within: f64,
) -> Result<Option<RayHit>, PrimitiveError> {
    let from = place("origin", origin)?;
    let along = direction("direction", direction_of_ray)?;
    if within.is_nan() || within < 0.0 {
        return Err(PrimitiveError::Length { what: "distance", value: within });
    }
    // Beyond this the model is left behind.
    let bounds = model.bounds();
    let beyond = (bounds.center() - from).length() + bounds.diagonal();
    let length = within.min(2.0 * beyond);
    let ray = RaySegment { from, to: from + length * along };
    Ok(first_hit(model, &ray, length))
}

struct RaySegment {
    from: DVec3,
    to: DVec3,
}

fn first_hit(model: &Model, ray: &RaySegment, length: f64) -> Option<RayHit> {
    let tree = model.tree();
    let mut best: Option<RayHit> = None;
    let distance_to = |node: u32| {
        let at = tree.node(node).bounds.entered_at(ray.from, ray.to)?;
        Some(at * length * (1.0 - BOX_ROUNDING))
    };
    each_face_on_the_way(model, f64::INFINITY, distance_to, |face| {
        let is_first = |hit: &RayHit| {
            best.is_none_or(|best| (hit.distance, hit.face) < (best.distance, best.face))
        };
        best = ray.meets(model, face, length).filter(is_first).or(best);
        best.map_or(f64::INFINITY, |best| best.distance)
    });
    best
}

impl RaySegment {
    /// Where the segment meets a face.
    fn meets(&self, model: &Model, face: FaceId, length: f64) -> Option<RayHit> {
        let Self { from, to } = *self;
        let [a, b, c] = model.mesh().triangle(face);
        let ends = [from, to].map(|end| orient3d(a, b, c, end));
        // Both on one side, or both in the plane.
        if ends[0] == ends[1] {
            return None;
        }
        let around = [orient3d(from, to, a, b), orient3d(from, to, b, c), orient3d(from, to, c, a)];
        if around.contains(&Sign::Positive) && around.contains(&Sign::Negative) {
            return None;
        }
        let normal = (b - a).cross(c - a).try_normalize()?;
        let [above, below] = [from, to].map(|end| normal.dot(end - a));
        let share = (above / (above - below)).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        // An end in the plane is on the side on which the other one is not.
        let from_behind = ends[0] == Sign::Negative || ends[1] == Sign::Positive;
        let point = from + share * (to - from);
        Some(RayHit { distance: share * length, point, normal, face, from_behind })
    }
}
