//! rapier's own shapes as what Cranny knows them by.
//!
//! [`Core`] stands for polyhedra, sharp or rounded, which become models; `primitive` for balls,
//! capsules, segments, cylinders, cones and half-spaces, which `cranny-primitives` knows.

mod polyhedron;
mod primitive;

pub(crate) use polyhedron::{Core, polyhedron, rounded_polyhedron};
pub(crate) use primitive::{measured, placed, primitive};
