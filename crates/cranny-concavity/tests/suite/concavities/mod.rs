//! Features, caps, concavities and boundary loops: counted by hand, and their invariants.

mod bodies;
pub(crate) mod check;
mod counts;
mod families;
mod noisy;
mod random;
mod rough;
mod rounding;
mod ways;
