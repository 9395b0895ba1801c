//! Conformance of the time of impact: hand-computed times, sampled motions, and an exact corpus of
//! linear motions.

mod closed_forms;
mod linear;
mod sampled;
