//! The exact pair query: verdicts, distances, contact curves and regions.

mod answer;
mod query;

pub use answer::{Answer, Contact, Containment, Counters, Curve, Feature, Region, Surface, Witness};
pub use query::{Demand, Placed, Query};
