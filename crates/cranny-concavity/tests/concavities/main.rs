//! Features, caps, concavities and boundary loops: counted by hand, and their invariants.

mod bodies;
#[path = "../body/mod.rs"]
mod body;
mod check;
mod counts;
mod covers;
mod families;
mod noisy;
mod random;
mod rough;
mod rounding;
mod ways;
