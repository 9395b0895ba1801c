//! Primitives against meshes, judged by searches that know of a shape only how wide it is, and by
//! hand.

mod by_hand;
mod escape;
mod pairs;
mod rays;
mod revolved;
mod rounded;

use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_shapes::Cuboid;

/// A model of a mesh that is good.
fn built(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).expect("a good mesh").0
}

/// A cuboid about the origin.
fn cuboid(size: [f64; 3]) -> Model {
    built(Cuboid { size }.build().expect("a good size"))
}
