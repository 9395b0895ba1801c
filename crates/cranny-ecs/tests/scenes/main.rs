//! Whole scenes through the app: what exists, what is reported, what is written.

mod absence;
mod build;
#[cfg(feature = "rapier")]
mod collisions;
mod comings;
#[cfg(feature = "rapier")]
mod continuous;
mod continuous_unsolved;
#[cfg(feature = "rapier")]
mod deformation;
mod detection;
mod entities;
mod fixed_update;
mod force_feedback;
#[cfg(all(feature = "rapier", feature = "scene"))]
mod hashes;
mod levels;
mod links;
#[cfg(feature = "rapier")]
mod meshes;
mod parts;
mod paths;
mod penetration;
mod primitives;
mod proximity;
#[cfg(feature = "record")]
mod recording;
#[cfg(feature = "render")]
mod rendering;
#[cfg(feature = "rapier")]
mod response;
#[cfg(feature = "rapier")]
mod sound;
mod spatial;
mod spatial_index;
mod tracking;
#[cfg(all(feature = "rapier", feature = "scene"))]
mod worlds;
