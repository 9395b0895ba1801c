//! Whole scenes of `assets/`, simulated, and judged by what must be true of them in the world.

#![expect(clippy::print_stderr, reason = "figures are printed where a person looks for them")]

mod cell;
mod cups;
mod gears;
mod hook;
mod key;
mod l_on_slab;
mod linking;
mod nut;
mod overlap;
mod peg;
mod rest;
mod ring;
mod run;
mod screw;
