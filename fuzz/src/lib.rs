//! What the fuzz targets share: numbers from bytes, and what every model must stand.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::{Demand, Method, PairMemory, Placed, Query, query};

// The tests of cranny-concavity ask the same of bytes from seeds; what they ask is written once.
#[path = "../../crates/cranny-concavity/tests/suite/from_bytes/checks.rs"]
mod checks;
#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../../crates/cranny-concavity/tests/suite/body.rs"]
mod body;
#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../../crates/cranny-concavity/tests/suite/concavities/check.rs"]
mod check;
#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../../crates/cranny-concavity/tests/suite/deform/equal.rs"]
mod equal;

pub use cranny_testkit::Bytes;

/// What the target of that name asks.
pub fn nearly_flat(data: &[u8]) {
    checks::nearly_flat(data);
}

/// What the target of that name asks.
pub fn deform(data: &[u8]) {
    checks::deform(data);
}

/// A point of a lattice of 16 steps a side, one in eight a hair off.
pub fn point(bytes: &mut Bytes) -> DVec3 {
    let [low, high] = [bytes.byte(), bytes.byte()];
    let whole = [low & 15, low >> 4, high & 15].map(f64::from);
    let hair = if high & 128 == 0 { 0.0 } else { f64::from(high >> 4 & 7) * f64::EPSILON };
    DVec3::from_array(whole) * (1.0 + hair)
}

/// A mesh of up to `faces` faces over lattice points.
pub fn mesh(bytes: &mut Bytes, faces: usize) -> Option<Mesh> {
    let points = 3 + bytes.byte() as usize % 30;
    let scale = [1.0, 0.1, 1e-20, 1e20][bytes.byte() as usize % 4];
    let vertices: Vec<DVec3> = (0..points).map(|_| point(bytes) * scale).collect();
    let mut triples = Vec::new();
    while !bytes.is_empty() && triples.len() < faces {
        triples.push([0; 3].map(|_: u32| u32::from(bytes.byte()) % points as u32));
    }
    Mesh::new(vertices, triples).ok()
}

/// Asks about a model beside itself, at a pose where it meets itself and one where it does not.
pub fn ask(model: &Model) {
    let size = model.bounds().diagonal();
    for share in [0.0, 0.25, 2.0] {
        let pose = Pose { translation: DVec3::new(share * size, 0.0, 0.0), ..Pose::IDENTITY };
        let [a, b] = [Placed { model, pose: Pose::IDENTITY }, Placed { model, pose }];
        for demand in [
            Demand::Intersects,
            Demand::Distance { below: None },
            Demand::contacts(0.1 * size),
            Demand::Regions { margin: 0.0 },
        ] {
            // A pose beyond the domain is refused, and that is an answer.
            for method in [Method::Boxes, Method::Envelopes] {
                let _ = query(a, b, &Query::of(demand).by(method), &mut PairMemory::default());
            }
        }
    }
}
