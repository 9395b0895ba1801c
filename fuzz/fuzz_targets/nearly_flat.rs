//! Closed solids, flat but for about as much as rounding, keep every promise.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| cranny_fuzz::nearly_flat(data));
