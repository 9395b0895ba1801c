//! The detector inside rapier, judged by what bodies do and by answers that it did not give itself.

mod carrying;
mod casts;
mod chain;
mod changes;
mod character;
mod compounds;
mod concave;
mod continuous;
mod fallback;
mod falling;
mod impulses;
mod manifolds;
mod mass;
mod motion;
mod nut;
mod pairs;
mod parts;
mod primitive_bodies;
mod queries;
mod reduced;
mod resting;
mod rolling;
mod round;
mod round_scenes;
mod smooth;
#[cfg(feature = "snapshot")]
mod snapshots;
mod stalled;
mod world;
