//! When a primitive that moves straight first comes near a model.
//!
//! A face and a primitive are convex, so the distance between them is a convex function of time as
//! long as nothing turns. A tangent of it lies below it: where the tangent reaches the distance
//! sought, the two are still as far apart or farther. Newton's method from the beginning therefore
//! never passes the first meeting, and meets it quadratically.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{Content, FaceId, Model};

use crate::primitive::{Checked, Plane, Primitive, PrimitiveError, place};
use crate::revolved::{LeastOnTriangle, Revolved};
use crate::separation::{Found, found};

/// How near to the distance sought a way ends, as a share of the pair's size. Larger: bodies stop
/// visibly short; smaller: rounding of the distance is taken for a gap.
const TOLERANCE: f64 = 1e-9;

/// What is near at the beginning and comes nearer by no more than this share of its way slides
/// along. Larger: it sinks in visibly; smaller: rounded directions hold what slides.
const SLIDING: f64 = 1e-6;

/// Tangents of one face. Fewer: a way beside a border of small radius ends early, as unknown; more:
/// nothing, since each about doubles the digits.
const MOST_TANGENTS: usize = 64;

/// When a way ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveCastOptions {
    /// How near the primitive is let to the model's solid, >= 0.
    pub gap: f64,
    /// What becomes of a face that is as near at the beginning: where this holds, the way ends at
    /// once; else only if the primitive comes nearer to it, and a face that it parts from, or
    /// slides along, is not in its way.
    pub stops_at_overlap: bool,
}

/// How a way of a primitive beside a model ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PrimitiveCast {
    /// The primitive comes no nearer than the gap.
    Free,
    /// It is as near at the beginning, or they overlap, or it lies inside.
    Initially,
    /// It is as near as the gap for the first time.
    Hit {
        /// As a share of the way, from 0 to 1. The primitive is no nearer before.
        time: f64,
        /// On the model's surface.
        on_model: DVec3,
        /// On the primitive, where it is at that time.
        on_primitive: DVec3,
        /// Unit, from the model to the primitive.
        normal: DVec3,
    },
}

/// Moves a primitive along `travel`, in the model's frame, until it is as near to the model's solid
/// as the options let it. One that begins wholly inside a closed component meets it at once.
///
/// The time is right to a few dozen roundings of the largest length of the pair, over the speed at
/// which the two come nearer.
///
/// # Errors
///
/// [`PrimitiveError`] where a number of the primitive, the travel or the gap is invalid.
///
/// ```
/// use cranny_exact::DVec3;
/// use cranny_geometry::{BuildOptions, Model};
/// use cranny_primitives::{Ball, PrimitiveCast, PrimitiveCastOptions, cast_primitive};
/// use cranny_shapes::Cuboid;
///
/// let (cube, _) = Model::build(Cuboid { size: [2.0; 3] }.build()?, &BuildOptions::default())?;
/// let ball = |z: f64| Ball { center: DVec3::Z * z, radius: 0.5 }.into();
/// let (way, options) = (DVec3::Z * -4.0, PrimitiveCastOptions { gap: 0.0, stops_at_overlap: true });
/// let found = cast_primitive(&cube, &ball(3.5), way, &options)?;
/// let PrimitiveCast::Hit { time, normal, .. } = found else { panic!("it falls onto the cube") };
/// assert!((time - 0.5).abs() < 1e-8 && (normal - DVec3::Z).length() < 1e-8);
/// assert_eq!(cast_primitive(&cube, &ball(0.0), way, &options)?, PrimitiveCast::Initially);
/// assert_eq!(cast_primitive(&cube, &ball(3.5), -way, &options)?, PrimitiveCast::Free);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cast_primitive(
    model: &Model,
    primitive: &Primitive,
    travel: DVec3,
    options: &PrimitiveCastOptions,
) -> Result<PrimitiveCast, PrimitiveError> {
    let travel = place("travel", travel)?;
    let PrimitiveCastOptions { gap, stops_at_overlap } = *options;
    if !(gap >= 0.0 && gap.is_finite()) {
        return Err(PrimitiveError::Length { what: "gap", value: gap });
    }
    let found = found(model, primitive, gap)?;
    let is_near = match found {
        Found::Meeting => true,
        Found::Apart { distance, .. } => distance <= gap,
        Found::Inside | Found::Farther => false,
    };
    if matches!(found, Found::Inside) || (is_near && stops_at_overlap) {
        return Ok(PrimitiveCast::Initially);
    }
    Ok(match primitive.checked()? {
        Checked::Round(solid) => RoundCast { model, solid: &solid, travel, gap }.first(),
        Checked::HalfSpace(plane) => of_half_space(model, &plane, travel, gap),
    })
}

/// Of a half-space: its plane meets the foremost vertex first.
fn of_half_space(model: &Model, plane: &Plane, travel: DVec3, gap: f64) -> PrimitiveCast {
    let Plane { normal, offset } = *plane;
    let height = |p: &DVec3| normal.dot(*p) - offset;
    let vertices = model.mesh().vertices().iter();
    let Some(&lowest) = vertices.min_by(|p, q| height(p).total_cmp(&height(q))) else {
        return PrimitiveCast::Free;
    };
    let (left, closing) = (height(&lowest) - gap, normal.dot(travel));
    if closing <= 0.0 || left > closing {
        return PrimitiveCast::Free;
    }
    if left <= 0.0 {
        return PrimitiveCast::Initially;
    }
    let on_primitive = lowest - normal * gap;
    PrimitiveCast::Hit { time: left / closing, on_model: lowest, on_primitive, normal: -normal }
}

/// A solid of revolution on its way.
struct RoundCast<'a> {
    model: &'a Model,
    solid: &'a Revolved,
    travel: DVec3,
    gap: f64,
}

impl RoundCast<'_> {
    fn first(&self) -> PrimitiveCast {
        let own = self.solid.bounds().grown(self.gap);
        let tree = self.model.tree();
        let mut first: Option<(f64, FaceId, LeastOnTriangle)> = None;
        each_face_on_the_way(
            self.model,
            1.0,
            |node| self.entry(&own, &tree.node(node).bounds),
            |face| {
                let until = first.map_or(1.0, |(time, ..)| time);
                if let Some((time, least)) = self.meets(face, until) {
                    let is_first =
                        first.is_none_or(|(before, known, _)| (time, face) < (before, known));
                    if is_first {
                        first = Some((time, face, least));
                    }
                }
                first.map_or(1.0, |(time, ..)| time)
            },
        );
        match first {
            None => PrimitiveCast::Free,
            Some((0.0, ..)) => PrimitiveCast::Initially,
            Some((time, _, least)) => self.hit(time, &least),
        }
    }

    /// When the solid's box, on its way, first reaches a box, at the earliest.
    fn entry(&self, own: &Aabb, bounds: &Aabb) -> Option<f64> {
        // Seen from a corner of the solid's box, boxes are as much larger as that is.
        let around = Aabb { min: bounds.min - (own.max - own.min), max: bounds.max };
        let size = around.min.abs().max(around.max.abs()).max(own.min.abs()).max_element();
        let around = around.grown(16.0 * f64::EPSILON * (size + self.travel.length()));
        around.entered_at(own.min, own.min + self.travel)
    }

    /// When the solid is as near to a face as the gap, up to a time.
    fn meets(&self, face: FaceId, until: f64) -> Option<(f64, LeastOnTriangle)> {
        let corners = self.model.mesh().triangle(face);
        let near = self.gap + self.solid.radius();
        let size = corners[0].abs().max_element() + self.solid.extent() + self.travel.length();
        let mut time = 0.0;
        for _ in 0..MOST_TANGENTS {
            // The face moves the other way, and the solid stays.
            let moved = corners.map(|corner| corner - time * self.travel);
            let least = self.solid.least_on_triangle(&moved);
            let left = least.signed - near;
            if time > 0.0 && left <= TOLERANCE * size {
                return Some((time, least));
            }
            let closing = self.solid.outward_at(&least).dot(self.travel);
            // A convex distance that does not fall never will: the two part, or slide along.
            let slides = left <= 0.0 && closing <= SLIDING * self.travel.length();
            if closing <= 0.0 || slides {
                return None;
            }
            if left <= TOLERANCE * size {
                return Some((time, least));
            }
            time += left / closing;
            if time > until {
                return None;
            }
        }
        let moved = corners.map(|corner| corner - time * self.travel);
        Some((time, self.solid.least_on_triangle(&moved)))
    }

    fn hit(&self, time: f64, least: &LeastOnTriangle) -> PrimitiveCast {
        let outward = self.solid.outward_at(least);
        let moved = time * self.travel;
        PrimitiveCast::Hit {
            time,
            on_model: least.point + moved,
            on_primitive: least.on_core + outward * self.solid.radius() + moved,
            normal: -outward,
        }
    }
}

/// Visits the faces that may be met on a way until a time (or a distance), those of near nodes
/// first. `entry` says when a node is reached at the earliest, if it is; `visit` up to when faces
/// are sought from then on.
pub(crate) fn each_face_on_the_way(
    model: &Model,
    mut until: f64,
    entry: impl Fn(u32) -> Option<f64>,
    mut visit: impl FnMut(FaceId) -> f64,
) {
    let tree = model.tree();
    let entry = |node: u32| entry(node).map(|at| (at, node));
    let mut open: Vec<(f64, u32)> = Vec::new();
    if !tree.nodes().is_empty() {
        open.extend(entry(0));
    }
    while let Some((at, node)) = open.pop() {
        if at > until {
            continue;
        }
        match tree.content(node) {
            Content::Inner { left, right } => {
                let mut children: Vec<_> = [left, right].into_iter().filter_map(entry).collect();
                children.sort_by(|a, b| b.0.total_cmp(&a.0));
                open.extend(children);
            }
            Content::Leaf { .. } => {
                tree.leaf_faces(node).iter().for_each(|&face| until = visit(face));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitive::{Ball, Capsule, Cone, Cylinder, HalfSpace, Segment};
    use crate::separation::{Separation, separation};
    use cranny_geometry::BuildOptions;
    use cranny_shapes::{Cuboid, Cup, Shape, Torus};
    use cranny_testkit::Rng;

    fn built(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    fn primitives(center: DVec3, axis: DVec3) -> Vec<Primitive> {
        let (half_height, radius) = (0.3, 0.2);
        let ends = [center - 0.3 * axis, center + 0.3 * axis];
        let rounded = |border: f64| -> [Primitive; 2] {
            [
                Cylinder { center, axis, half_height, radius, border }.into(),
                Cone { center, axis, half_height, radius, border }.into(),
            ]
        };
        let [cylinder, cone] = rounded(0.0);
        let [round_cylinder, round_cone] = rounded(0.15);
        vec![
            Ball { center, radius }.into(),
            Ball { center, radius: 0.0 }.into(),
            Capsule { ends, radius: 0.1 }.into(),
            Segment { ends }.into(),
            cylinder,
            cone,
            round_cylinder,
            round_cone,
            HalfSpace { point: center, normal: axis }.into(),
        ]
    }

    fn stopping(gap: f64) -> PrimitiveCastOptions {
        PrimitiveCastOptions { gap, stops_at_overlap: true }
    }

    fn moved(primitive: &Primitive, by: DVec3) -> Primitive {
        primitive.moved(&cranny_exact::Pose::at(by).world_from_body())
    }

    /// Whether the two are as near as the gap, or nearer, by a search of all faces.
    fn is_near(model: &Model, primitive: &Primitive, gap: f64) -> bool {
        match separation(model, primitive, f64::INFINITY).unwrap() {
            Separation::Meeting => true,
            Separation::Apart { distance, .. } => distance <= gap,
            Separation::Farther => false,
        }
    }

    /// Small steps along the way find nothing before the time, and the gap at it.
    #[test]
    fn a_way_is_free_before_its_time_and_ends_at_the_gap() {
        let models =
            [built(Torus::default()), built(Cup::default()), built(Cuboid { size: [1.0; 3] })];
        let mut rng = Rng::new(11);
        let mut counts = [0; 3];
        for round in 0..240 {
            let model = &models[round % models.len()];
            let size = model.bounds().diagonal();
            let mut vector = |size: f64| DVec3::from_array([(); 3].map(|()| size * rng.unit()));
            let (at, to) = (vector(size), vector(0.5 * size));
            let axis = vector(1.0).normalize();
            let gap = [0.0, 0.01, 0.1][round / 3 % 3];
            for primitive in primitives(at, axis) {
                let way = to - at;
                match cast_primitive(model, &primitive, way, &stopping(gap)).unwrap() {
                    PrimitiveCast::Initially => {
                        counts[0] += 1;
                        assert!(is_near(model, &primitive, gap));
                    }
                    PrimitiveCast::Free => {
                        counts[1] += 1;
                        for k in 0..=40 {
                            let there = moved(&primitive, f64::from(k) / 40.0 * way);
                            assert!(!is_near(model, &there, gap), "{primitive:?} at {k}");
                        }
                    }
                    PrimitiveCast::Hit { time, on_model, on_primitive, normal } => {
                        counts[2] += 1;
                        for k in 0..40 {
                            let share = f64::from(k) / 40.0 * time - 1e-7;
                            let there = moved(&primitive, share.max(0.0) * way);
                            assert!(!is_near(model, &there, gap), "{primitive:?} at {k} of {time}");
                        }
                        let there = moved(&primitive, time * way);
                        assert!(is_near(model, &there, gap + 1e-7 * size), "{primitive:?}");
                        let between = on_primitive - on_model;
                        assert!((between.dot(normal) - gap).abs() < 1e-7 * size, "{primitive:?}");
                        assert!((between - gap * normal).length() < 1e-4 * size, "{primitive:?}");
                    }
                }
            }
        }
        assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
    }

    /// Through the hole of a ring, into a cup, and out of a solid.
    #[test]
    fn holes_are_open_and_solids_are_full() {
        let ring = built(Torus::default());
        let down = |model: &Model, from: DVec3, radius: f64| {
            let ball = Ball { center: from, radius }.into();
            cast_primitive(model, &ball, DVec3::Z * -50.0, &stopping(0.0)).unwrap()
        };
        assert_eq!(down(&ring, DVec3::Z * 20.0, 0.1), PrimitiveCast::Free);
        let wide = ring.bounds().half_extents().x;
        assert!(matches!(down(&ring, DVec3::Z * 20.0, wide), PrimitiveCast::Hit { .. }));
        let block = built(Cuboid { size: [9.0; 3] });
        assert_eq!(down(&block, DVec3::ZERO, 0.1), PrimitiveCast::Initially);
        let cup = built(Cup::default());
        let floor = down(&cup, DVec3::Z * 20.0, 0.05);
        let PrimitiveCast::Hit { on_model, .. } = floor else { panic!("{floor:?}") };
        assert!(on_model.z < cup.bounds().center().z, "its floor, not its rim: {on_model}");
    }

    /// On the floor of a cup, with a little of it inside: it slides along to the wall, and lifts
    /// off; it does not go down.
    #[test]
    fn what_slides_along_a_face_is_not_held_by_it() {
        let cup = Cup { radius: 1.0, height: 1.0, wall: 0.1, floor: 0.1, segments: 64 };
        let cup = built(cup);
        let floor = cup.bounds().min.z + 0.1;
        let options = PrimitiveCastOptions { gap: 0.0, stops_at_overlap: false };
        for depth in [-1e-9, 0.0, 0.01] {
            let ball = Ball { center: DVec3::Z * (floor + 0.2 - depth), radius: 0.2 }.into();
            let to = |travel: DVec3| cast_primitive(&cup, &ball, travel, &options).unwrap();
            assert_eq!(to(DVec3::Z * 5.0), PrimitiveCast::Free);
            let down = match to(DVec3::Z * -5.0) {
                PrimitiveCast::Initially => 0.0,
                PrimitiveCast::Hit { time, .. } => time,
                PrimitiveCast::Free => 1.0,
            };
            assert!(down < 1e-8, "{down}");
            let PrimitiveCast::Hit { time, normal, .. } = to(DVec3::X * 5.0) else {
                panic!("the wall, {depth} deep in the floor")
            };
            assert!((5.0 * time - 0.7).abs() < 0.01 && normal.x < -0.9, "{time} {normal}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let cube = built(Cuboid { size: [1.0; 3] });
        let ball = Ball { center: DVec3::Z * 3.0, radius: 0.5 }.into();
        let refused =
            |travel, gap| cast_primitive(&cube, &ball, travel, &stopping(gap)).unwrap_err();
        assert!(refused(DVec3::NAN, 0.0).to_string().contains("travel"));
        assert!(refused(DVec3::X, -1.0).to_string().contains("gap"));
        let still = cast_primitive(&cube, &ball, DVec3::ZERO, &stopping(0.0));
        assert_eq!(still, Ok(PrimitiveCast::Free));
    }
}
