//! Models for queries: of a mesh, of a shape, and a set of small ones of many kinds.

use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, NestedShells, Shape, Sphere, Torus};

/// The model of a mesh, built with the default options.
///
/// # Panics
///
/// If the mesh is refused.
#[must_use]
pub fn model(mesh: Mesh) -> Model {
    let built = Model::build(mesh, &BuildOptions::default());
    built.unwrap_or_else(|error| panic!("no model: {error}")).0
}

/// The model of a shape, built with the default options.
///
/// # Panics
///
/// If the shape's parameters are refused.
#[must_use]
pub fn shape(shape: impl Into<Shape>) -> Model {
    model(shape.into().build().unwrap_or_else(|error| panic!("no shape: {error}")))
}

/// Small models, convex and not, one much smaller than the rest, with their names.
///
/// # Panics
///
/// Never: all of them are built.
#[must_use]
pub fn small_models() -> Vec<(&'static str, Model)> {
    vec![
        ("cuboid", shape(Cuboid::default())),
        ("sphere", shape(Sphere { segments: 10, rings: 6, ..Sphere::default() })),
        ("torus", shape(Torus { major_segments: 18, minor_segments: 8, ..Torus::default() })),
        ("cup", shape(Cup { segments: 12, ..Cup::default() })),
        ("shells", shape(NestedShells { segments: 7, ..NestedShells::default() })),
        ("comb", shape(Comb::default())),
        ("speck", shape(Cuboid { size: [0.06, 0.05, 0.04] })),
        ("golf ball", shape(GolfBall { dimples: 0, triangles: 180, ..GolfBall::default() })),
    ]
}
