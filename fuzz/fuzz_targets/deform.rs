//! What follows moved vertices equals a rebuild.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| cranny_fuzz::deform(data));
