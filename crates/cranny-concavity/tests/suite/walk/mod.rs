//! The closest-feature walk between hulls.

mod frames;
mod hard;
mod judge;
