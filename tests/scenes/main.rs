//! Whole scenes of `assets/`, simulated, and judged by what must be true of them in the world.

#![expect(clippy::print_stderr, reason = "figures are told where a person looks for them")]

mod linking;
mod nut;
mod ring;
mod run;
