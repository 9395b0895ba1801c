//! What the fuzz targets `nearly_flat` and `deform` check, on bytes drawn from seeds: run without
//! fuzzing too.

mod checks;

use cranny_testkit::Rng;

/// Bytes of a seed.
fn bytes(seed: u64) -> Vec<u8> {
    let mut rng = Rng::new(seed);
    (0..64 + rng.below(400)).map(|_| rng.bits() as u8).collect()
}

#[test]
fn solids_flat_but_for_rounding_keep_every_promise() {
    (0..600).for_each(|seed| checks::nearly_flat(&bytes(seed)));
}

#[test]
fn what_moves_clear_of_rounding_equals_a_rebuild() {
    (0..400).for_each(|seed| checks::deform(&bytes(seed)));
}

#[test]
fn a_flange_as_thin_as_two_slabs_is_skin() {
    // Its sides were openings of a closed body: caps on one side, too many faces on the other.
    [2437, 2796].into_iter().for_each(|seed| checks::nearly_flat(&bytes(seed)));
}

#[test]
fn two_caps_back_to_back_are_no_opening() {
    // Needles wider than slabs, on either side: what rounding left of the volume between them was
    // an opening.
    [24_883, 52_571].into_iter().for_each(|seed| checks::nearly_flat(&bytes(seed)));
}

#[test]
fn caps_back_to_back_hold_more_than_their_difference_says() {
    // Needles at the rim of a side that two caps cover and one uncovers: of half a unit of area
    // each, 2e-7 in sum.
    checks::nearly_flat(&[
        39, 11, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123,
        123, 123, 123, 123, 123, 123, 123, 123, 123, 12, 10, 255, 123, 123, 255, 255, 123, 123,
        123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123, 123,
        123, 123, 123, 167, 128, 5, 0, 0, 0, 15, 0, 0, 0, 13, 0, 0, 0, 5, 0, 0, 0, 13, 0, 0, 0, 21,
        0, 0, 0, 15, 0, 0, 0, 13, 0, 0, 0, 18, 0, 0, 0, 13, 0, 0, 0, 18, 0, 0, 0, 20, 0, 0, 0, 20,
        0, 0, 0, 21, 0, 0, 0, 20, 0, 0, 0, 24, 0, 0, 0, 123, 123, 123, 123, 123, 114, 123, 123, 3,
        0, 123, 123, 123, 123, 123, 123, 123, 123, 123, 126, 123, 255, 255, 255, 255, 176, 176,
        176, 176, 240, 176, 4, 0, 0, 0, 7, 0, 0, 0, 7, 0, 0, 0, 64, 0, 0, 0, 51, 0, 0, 0, 55, 0, 0,
        0, 52, 0, 0, 0, 51, 0, 0, 0, 54, 0, 0, 0, 58, 0, 0, 0, 55, 0, 0, 247, 59, 0, 0, 0, 56, 0,
        0, 0, 52, 0, 0, 0, 56, 0, 0, 0, 54, 0, 1, 0, 45, 0, 0, 0, 0, 255, 255, 255, 255, 255, 255,
        255, 255, 255, 255, 255, 255, 255, 0, 0, 51, 0, 0, 0, 54, 0, 0, 0, 58, 123, 123, 255, 255,
        255, 255, 255, 255, 255, 255, 255, 255, 255, 191, 255, 255, 255, 255, 255, 255, 255, 255,
        255, 255, 123, 123, 123, 123, 123, 123, 123, 10, 186, 51,
    ]);
}

#[test]
fn a_lid_all_around_opens_nowhere() {
    // What rounding left of the sum of its caps was an opening before a deformation and none after
    // it.
    [914, 1123, 2295, 4255].into_iter().for_each(|seed| checks::deform(&bytes(seed)));
}

#[test]
fn facets_of_nearly_flat_sides_cover_what_a_rebuild_covers() {
    // Planes triangulated otherwise than in a rebuild made other facets, and concavities covered
    // other edges.
    checks::deform(&[
        255, 97, 97, 97, 97, 12, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 0, 0, 0, 0, 0,
        80, 0, 0, 10, 75, 97, 97, 97, 12, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 97, 0, 0,
        0, 0, 0, 80, 0, 0, 10, 75, 97, 97, 97, 97, 97, 97, 33, 3, 255, 255, 255, 33,
    ]);
}

#[test]
fn a_solid_without_volume_comes_back_from_its_file() {
    // Rounding left it a volume below none, which no file may hold.
    let flat = [
        &[156, 0, 0, 0, 0, 249, 0, 0, 10, 0, 138, 42, 61, 10, 0, 10, 63][..],
        &[36, 0, 0, 0, 0, 0, 36, 0, 0, 0, 0, 0, 0, 2, 10, 0, 138, 42, 0, 0, 10, 0, 10, 63],
    ];
    flat.into_iter().for_each(checks::nearly_flat);
    checks::deform(&[
        1, 20, 17, 254, 239, 0, 0, 0, 0, 0, 0, 0, 255, 255, 36, 146, 73, 36, 62, 62, 62, 62, 62,
        62, 62, 62, 62, 62, 62, 62, 62, 54, 62, 1, 0, 0, 0, 0, 0, 0, 84, 62, 62, 62, 62, 62, 62,
        62, 62, 62, 62, 62, 62, 62, 62, 62, 33, 62, 62, 62, 62, 62, 62, 62, 62, 62, 255, 255, 255,
        255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255,
        255, 255, 255, 255, 255, 255, 255, 255, 255, 17, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 49,
        10, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 14, 62, 62, 62, 62, 62, 62, 62,
        62, 62, 62, 62, 62, 62, 62, 62, 62, 62, 62, 62, 62, 62, 62, 2, 2, 2, 2, 2, 48, 2, 2, 2, 2,
        2, 2, 2, 1, 62,
    ]);
}

#[test]
fn a_body_without_volume_has_none_up_to_what_its_sum_may_be_off_by() {
    // A sheet just thicker than skin that is reported to have no volume; shells as small as
    // rounding a length apart, between which the hull is a needle.
    [1_006_005, 1_023_061].into_iter().for_each(|seed| checks::nearly_flat(&bytes(seed)));
}

/// Two sides at 60 degrees, rough by rounding, share caps: seen along the axis nearest the larger
/// one's normal the other is edge-on, and triangles of half its size were turned over by rounding.
#[test]
fn sides_that_share_caps_are_not_seen_edge_on() {
    checks::nearly_flat(&EDGE_ON);
}

/// Found by fuzzing.
#[rustfmt::skip]
const EDGE_ON: [u8; 207] = [
    167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 193, 193, 193, 193, 16, 167, 30, 167, 167,
    167, 167, 167, 167, 167, 167, 167, 167, 167, 167, 193, 193, 193, 193, 193, 197, 193, 193, 193, 193, 193, 193, 193, 193,
    193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 193, 0, 0,
    0, 0, 24, 0, 0, 0, 6, 0, 0, 0, 8, 0, 0, 0, 7, 0, 0, 0, 6, 0, 0, 0, 8, 0,
    0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 11, 222, 222, 222, 222, 222, 222, 222, 222, 222,
    222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 254, 222, 222, 222,
    222, 222, 222, 222, 222, 222, 222, 222, 222, 222, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0,
    14, 0, 0, 0, 15, 0, 0, 0, 15, 0, 0, 0, 11, 0, 0, 0, 167, 167, 167, 193, 193, 193, 193, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 193, 0, 193, 193, 0,
];
