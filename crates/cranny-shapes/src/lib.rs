//! Generators of solids, as triangle meshes.
//!
//! # Promises
//!
//! - Every mesh is one closed, oriented shell: each edge is shared by exactly two faces that run it
//!   in opposite directions, faces are counter-clockwise seen from outside, no two vertices
//!   coincide, every vertex is used and every face has area. It does not meet itself anywhere but
//!   at shared edges and vertices. Tests decide all of this exactly.
//! - Parameters outside their documented range are refused by a [`ShapeError`] that names them.
//! - Bodies lie in a documented frame: axes along z, the origin on the axis or at the centroid.
//!   Lengths are in scene units, angles in radians.
//!
//! # Non-promises
//!
//! - Curved surfaces are inscribed: their *vertices* are on them.
//! - Sine and cosine come from the platform's mathematics library: meshes are reproducible on one
//!   platform, and may differ in the last bits between two. Where that matters, save the mesh.
//!
//! ```
//! use cranny_shapes::{Shape, Torus};
//! let torus = Torus { major_radius: 2.0, ..Torus::default() };
//! assert_eq!(torus.build()?.faces().len(), 2 * 64 * 16);
//! assert_eq!(Shape::from(torus).name(), "Torus");
//! assert!(Torus { minor_radius: 3.0, ..torus }.build().is_err());
//! # Ok::<(), cranny_shapes::ShapeError>(())
//! ```

mod blocks;
mod builder;
mod cylinder;
mod error;
mod fasteners;
mod floor;
mod freeform;
mod furniture;
mod gear;
mod golf_ball;
mod household;
mod lathe;
mod polyhedra;
mod primitive;
mod prism;
mod profiles;
mod round;
mod shape;
mod thread;
mod vehicles;
mod vessels;

pub use cylinder::Cylinder;
pub use error::{MAX_FACES, MAX_LENGTH, MIN_DETAIL, MIN_LENGTH, ShapeError};
pub use fasteners::{IsoBolt, IsoNut};
pub use floor::Floor;
pub use freeform::{Boxes, Corners, Lathe};
pub use furniture::{Hook, LockPlug, Stairs};
pub use gear::Gear;
pub use golf_ball::GolfBall;
pub use household::{Chair, Lamp, Shelf, Table, Tub, Wall};
pub use polyhedra::{Cuboid, Pyramid, Tetrahedron};
pub use primitive::primitive_mesh;
pub use profiles::{CPrism, Comb, LPrism, UPrism};
pub use round::{ChainLink, Sphere, Torus};
pub use shape::Shape;
pub use vehicles::{CarBody, Propeller, SpokedWheel, SubmarineHull};
pub use vessels::{Cup, NestedShells, PyramidInCavity};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
