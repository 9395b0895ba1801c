//! Shapes that are given by a few numbers, against meshes: contacts, distances, ways out.
//!
//! Balls, capsules, segments, cylinders, cones and half-spaces meet a
//! [`Model`](cranny_geometry::Model) as what they are: nothing is tessellated. Beside them stand
//! polyhedra with rounded edges, and the contacts by which a solver leads bodies out of deep
//! overlaps. No solver is needed for any of it.
//!
//! # Promises
//!
//! - [`separation`] (verdict, distance, witness points) is right to a few dozen units of rounding
//!   of the largest length of the pair.
//! - [`contacts`] finds one wherever the mesh is locally nearest to the primitive, with the normal
//!   of the face or of the primitive's own surface, and the points that span what the two share.
//! - The order of faces and vertices chooses between equal ones only; nothing is remembered from
//!   question to question.
//! - No input or output, no clock, no globals, no transcendental functions.
//!
//! # Non-promises
//!
//! Verdicts here are not exact: a primitive's own points round, so what is apart or overlaps by a
//! few units of rounding may be found to touch. (Between models that are not rounded they are.)
//! A segment that lies flush over a face and ends exactly above an edge to a face of the same plane
//! gets no contact. Of casts those of rays are exact ([`cast_ray`]), and sweeps of two meshes are
//! certified ([`first_meeting`]). Two cylinders or cones, and contacts of two primitives, are
//! parry's, to its tolerances.
//!
//! # A ball over a mesh
//!
//! All is in the model's frame; [`Primitive::moved`] takes a shape there.
//!
//! ```
//! use cranny_exact::{DVec3, Pose};
//! use cranny_geometry::{BuildOptions, Model};
//! use cranny_primitives::{Ball, Primitive, Separation, contacts, separation};
//! use cranny_shapes::Cuboid;
//!
//! let (cube, _) = Model::build(Cuboid { size: [1.0; 3] }.build()?, &BuildOptions::default())?;
//! let pose = Pose::at(DVec3::new(0.0, 0.0, 10.0)); // of the cube in the world
//! let ball = Primitive::from(Ball { center: DVec3::new(0.25, 0.0, 10.75), radius: 0.25 });
//! let in_model = ball.moved(&pose.world_from_body().inverse());
//!
//! // It rests on the upper side, in one contact, which points from the cube to the ball.
//! let found = contacts(&cube, &in_model, 0.01)?;
//! assert_eq!(found.len(), 1);
//! assert_eq!((found[0].normal, found[0].separation), (DVec3::Z, 0.0));
//! assert_eq!(found[0].point_a, DVec3::new(0.25, 0.0, 0.5));
//!
//! let higher = in_model.moved(&Pose::at(DVec3::Z).world_from_body());
//! let apart = separation(&cube, &higher, f64::INFINITY)?;
//! let [on_cube, on_ball] = [DVec3::new(0.25, 0.0, 0.5), DVec3::new(0.25, 0.0, 1.5)];
//! assert_eq!(apart, Separation::Apart { distance: 1.0, witnesses: [on_cube, on_ball] });
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The story, file by file
//!
//! `primitive` names the shapes and checks their numbers. `revolved` measures solids of revolution:
//! where the signed distance from one is least on a segment, a triangle, a model. `contacts` finds
//! where a mesh is locally nearest to a primitive, by the `normal_cone` of each feature and by what
//! is `inside`; `separation` says how far the two are apart. `rounded` does the same for polyhedra
//! with rounded edges. `shape` is what a body is made of, a model or a primitive; `between` answers
//! about two of them, `convex` about two primitives. `ray` casts rays at models, `shape_ray` at
//! shapes; `cast` moves primitives at them, `turning_cast` moves them as they turn,
//! and `sweep` any shape at any other. `cores` are what is left of a body below its surface, and
//! `hold` says up to when bodies are let on their ways for none to pass through another. `text`
//! writes primitives down. `deep` finds contacts
//! that lead a solver's bodies out of a deep overlap, and `percussion` the places at which to lead
//! a body without turning it; `escape` finds a translation that ends an overlap, for whoever has no
//! solver.

mod between;
mod cast;
mod contacts;
mod convex;
mod cores;
pub mod deep;
mod escape;
mod hold;
mod inside;
mod normal_cone;
mod percussion;
mod primitive;
mod ray;
pub mod revolved;
mod rounded;
mod separation;
mod shape;
mod shape_ray;
mod sweep;
mod text;
mod turning_cast;

pub use between::{PlacedShape, ShapeQueryError, query_shapes};
pub use cast::{PrimitiveCast, PrimitiveCastOptions, cast_primitive};
pub use contacts::contacts;
pub use cores::{Cores, CoresOfBodies};
pub use escape::{way_apart, way_apart_of_shapes};
pub use hold::{MovingCores, last_apart, let_until};
pub use inside::contains_point;
pub use percussion::percussion_centers;
pub use primitive::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive, PrimitiveError, Segment};
pub use ray::{RayHit, cast_ray};
pub use rounded::{Rounded, rounded, rounded_contacts, rounded_separation};
pub use separation::{Separation, meets, separation};
pub use shape::BodyShape;
pub use shape_ray::{ShapeRayHit, cast_ray_at_shape, separation_of_point};
pub use sweep::{MovingShape, SweepError, Swept, first_meeting};
pub use text::UnknownPrimitive;

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
