//! Contacts of our shape with rapier's own shapes.
//!
//! All contacts here are in the model's frame, from the model to the partner.

mod ball;
mod half_space;
mod polyhedron;
mod revolved;
mod round;
mod spread;

pub(crate) use ball::{ball_contacts, capsule_contacts, holds};
pub(crate) use half_space::half_space_contacts;
pub(crate) use polyhedron::{Core, polyhedron, rounded_polyhedron};
pub(crate) use revolved::{deep_contact, revolved_contacts};
pub(crate) use round::revolved;
