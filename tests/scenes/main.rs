//! Whole scenes of `assets/`, simulated, and judged by what must be true of them in the world.

mod linking;
mod nut;
mod ring;
mod run;
