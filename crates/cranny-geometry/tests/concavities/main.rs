//! Features, caps, concavities and boundary loops: counted by hand, and their invariants.

mod bodies;
mod check;
mod counts;
mod random;
mod rounding;
mod ways;
