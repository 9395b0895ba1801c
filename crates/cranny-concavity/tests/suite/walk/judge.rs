//! The judge of `cranny_stability` as assertions.

use cranny_concavity::walk::{HullAnswer, WalkCounters, WalkState, walk_hulls};
use cranny_exact::RigidMap;
pub(crate) use cranny_stability::hull_judge::{
    Body, at, brute_force, brute_force_depth, cuboid, disk, faults, platonic_solids, random_map,
    rounding, sphere,
};

/// Compares from a given state.
pub(crate) fn ask(a: &Body, b: &Body, map: &RigidMap, state: &mut WalkState) -> HullAnswer {
    walk_hulls(a.walkable(), b.walkable(), map, state, &mut WalkCounters::default()).unwrap()
}

/// Compares without history.
pub(crate) fn ask_cold(a: &Body, b: &Body, map: &RigidMap) -> HullAnswer {
    ask(a, b, map, &mut WalkState::default())
}

/// Holds an answer against brute force.
pub(crate) fn judge(a: &Body, b: &Body, map: &RigidMap, found: &HullAnswer) {
    assert_eq!(faults(a, b, map, found), [""; 0]);
}
