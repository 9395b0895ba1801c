//! Whole scenes through the app: what exists, what is told, what is written.

mod absence;
mod build;
#[cfg(feature = "rapier")]
mod collisions;
mod comings;
mod detection;
mod entities;
mod fixed_update;
mod links;
mod parts;
mod proximity;
#[cfg(feature = "record")]
mod recording;
#[cfg(feature = "render")]
mod rendering;
#[cfg(feature = "rapier")]
mod response;
mod spatial;
