//! Integration tests of the generators, in one binary.

mod any_parameters;
mod closed_shell;
mod household;
mod mating;
mod parameters;
mod readme;
mod solids;
