//! The tests of `cranny-rapier` in double precision.

#![allow(
    clippy::unnecessary_cast,
    clippy::useless_conversion,
    reason = "what is narrowed or widened for f32 is left as it is here"
)]

// The name that they know it by.
extern crate cranny_rapier_f64 as cranny_rapier;

#[path = "../../cranny-rapier/tests/suite/casts.rs"]
mod casts;
#[path = "../../cranny-rapier/tests/suite/chain.rs"]
mod chain;
#[path = "../../cranny-rapier/tests/suite/character.rs"]
mod character;
#[path = "../../cranny-rapier/tests/suite/compounds.rs"]
mod compounds;
#[path = "../../cranny-rapier/tests/suite/concave.rs"]
mod concave;
#[path = "../../cranny-rapier/tests/suite/fallback.rs"]
mod fallback;
#[path = "../../cranny-rapier/tests/suite/falling.rs"]
mod falling;
#[path = "../../cranny-rapier/tests/suite/manifolds.rs"]
mod manifolds;
#[path = "../../cranny-rapier/tests/suite/mass.rs"]
mod mass;
#[path = "../../cranny-rapier/tests/suite/motion.rs"]
mod motion;
#[path = "../../cranny-rapier/tests/suite/nut.rs"]
mod nut;
#[path = "../../cranny-rapier/tests/suite/pairs.rs"]
mod pairs;
#[path = "../../cranny-rapier/tests/suite/queries.rs"]
mod queries;
#[path = "../../cranny-rapier/tests/suite/resting.rs"]
mod resting;
#[path = "../../cranny-rapier/tests/suite/rolling.rs"]
mod rolling;
#[path = "../../cranny-rapier/tests/suite/round.rs"]
mod round;
#[path = "../../cranny-rapier/tests/suite/round_scenes.rs"]
mod round_scenes;
#[path = "../../cranny-rapier/tests/suite/smooth.rs"]
mod smooth;
#[cfg(feature = "snapshot")]
#[path = "../../cranny-rapier/tests/suite/snapshots/mod.rs"]
mod snapshots;
#[path = "../../cranny-rapier/tests/suite/world.rs"]
mod world;
