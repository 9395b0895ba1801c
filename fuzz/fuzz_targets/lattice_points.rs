//! Hulls of lattice points, many of them coplanar, collinear or coincident: every invariant,
//! exactly.

#![no_main]

use cranny_exact::DVec3;
use cranny_fuzz::{Bytes, point};
use cranny_geometry::ConvexHull;
use cranny_geometry::hull::FLATNESS;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut bytes = Bytes(data);
    let flatness = [FLATNESS, 0.0, 1e-3, f64::NAN][bytes.byte() as usize % 4];
    let scale = [1.0, 0.1, 1e-20, 1e20][bytes.byte() as usize % 4];
    let mut points: Vec<DVec3> = Vec::new();
    while !bytes.is_empty() && points.len() < 64 {
        points.push(point(&mut bytes) * scale);
    }
    let hull = ConvexHull::with_flatness(&points, flatness);
    let violations = hull.validate(&points);
    assert!(violations.is_empty(), "{violations:?}");
});
