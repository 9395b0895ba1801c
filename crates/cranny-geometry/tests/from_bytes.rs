//! What the fuzz targets `nearly_flat` and `deform` ask, of bytes drawn from seeds: asked without fuzzing too.

#[path = "from_bytes/asked.rs"]
mod asked;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "concavities/check.rs"]
mod check;
#[path = "deform/equal.rs"]
mod equal;

use cranny_testkit::Rng;

/// Bytes of a seed.
fn bytes(seed: u64) -> Vec<u8> {
    let mut rng = Rng::new(seed);
    (0..64 + rng.below(400)).map(|_| rng.bits() as u8).collect()
}

#[test]
fn solids_flat_but_for_rounding_keep_every_promise() {
    (0..600).for_each(|seed| asked::nearly_flat(&bytes(seed)));
}

#[test]
fn what_moves_clear_of_rounding_equals_a_rebuild() {
    (0..400).for_each(|seed| asked::deform(&bytes(seed)));
}

#[test]
fn a_flange_as_thin_as_two_slabs_is_skin() {
    // Its sides were openings of a closed body: caps on one side, too many faces on the other.
    [2437, 2796].into_iter().for_each(|seed| asked::nearly_flat(&bytes(seed)));
}

#[test]
fn a_lid_all_around_opens_nowhere() {
    // What rounding left of the sum of its caps was an opening before a deformation and none after it.
    [914, 1123, 2295, 4255].into_iter().for_each(|seed| asked::deform(&bytes(seed)));
}
