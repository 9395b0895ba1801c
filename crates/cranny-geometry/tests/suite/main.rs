//! Meshes, models and their files, by their public interfaces.

#[path = "../../../cranny-concavity/tests/suite/body.rs"]
mod body;
mod dents;
mod hull;
mod meshes;
mod model_files;
mod patches;
mod polygons;
mod repair;
mod smooth_normals;
mod trees;
