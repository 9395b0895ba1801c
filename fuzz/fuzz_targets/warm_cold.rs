//! Two bodies stroll as the bytes say: they drift, turn, rest, jump, skip calls, change places,
//! lose their memory, are queried for something else. Whatever they do, memory changes no bit of an
//! answer.

#![no_main]

use std::sync::OnceLock;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_fuzz::{Bytes, mesh};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query_verified};
use cranny_shapes::{Comb, Cup, NestedShells, Torus};
use libfuzzer_sys::fuzz_target;

/// Bodies with concavities; a fifth one is made of the bytes.
fn bodies() -> &'static [Model] {
    static BODIES: OnceLock<Vec<Model>> = OnceLock::new();
    BODIES.get_or_init(|| {
        let meshes = [
            Cup { segments: 12, ..Cup::default() }.build(),
            Torus { major_segments: 16, minor_segments: 7, ..Torus::default() }.build(),
            Comb::default().build(),
            NestedShells { segments: 7, ..NestedShells::default() }.build(),
        ];
        meshes.into_iter().filter_map(|mesh| model(mesh.expect("parameters are right"))).collect()
    })
}

fn model(mesh: Mesh) -> Option<Model> {
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    Model::build(mesh, &options).ok().map(|(model, _)| model)
}

/// A vector of length up to about 2, in steps of 1/64.
fn vector(bytes: &mut Bytes) -> DVec3 {
    DVec3::from_array([0; 3].map(|_: u8| f64::from(bytes.byte() as i8) / 64.0))
}

fn turn(bytes: &mut Bytes, pace: f64) -> DQuat {
    let v = 0.5 * pace * vector(bytes);
    DQuat::from_xyzw(v.x, v.y, v.z, 1.0).normalize()
}

fuzz_target!(|data: &[u8]| {
    let mut bytes = Bytes(data);
    let (which, own) = (bytes.byte() as usize, bytes.byte());
    let known = bodies();
    let a = known[which % known.len()].clone();
    let b = match own % 4 {
        0 => mesh(&mut bytes, 12).and_then(model),
        _ => Some(known[which / known.len() % known.len()].clone()),
    };
    let Some(b) = b else { return };
    let size = a.radius() + b.radius();
    let mut pose = Pose { rotation: turn(&mut bytes, 1.0), translation: size * vector(&mut bytes) };
    let (mut drift, mut spin) = (DVec3::ZERO, DQuat::IDENTITY);
    let (mut memory, mut swapped) = (PairMemory::default(), false);
    let mut demand = Demand::Intersects;
    for _ in 0..64 {
        if bytes.is_empty() {
            return;
        }
        let mut asks = true;
        match bytes.byte() % 16 {
            0 => pose.translation = size * vector(&mut bytes),
            1 => pose.rotation = turn(&mut bytes, 8.0),
            2..=4 => {
                let pace = [1e-15, 1e-9, 1e-4, 1e-2][bytes.byte() as usize % 4];
                drift = pace * size * vector(&mut bytes);
                spin = turn(&mut bytes, pace);
            }
            5 => (drift, spin) = (DVec3::ZERO, DQuat::IDENTITY),
            6 => (drift, spin) = (-drift, spin.conjugate()),
            7 => memory.clear(),
            8 => swapped = !swapped,
            9 => asks = false,
            10 | 11 => {
                let reach = f64::from(bytes.byte()) / 512.0 * size;
                demand = match bytes.byte() % 6 {
                    0 => Demand::Intersects,
                    1 => Demand::Distance { below: None },
                    2 => Demand::Distance { below: Some(reach) },
                    3 => Demand::contacts(reach),
                    4 => Demand::Regions { margin: 0.0 },
                    _ => Demand::Regions { margin: 0.1 * reach },
                };
            }
            _ => {}
        }
        pose.translation += drift;
        pose.rotation = (spin * pose.rotation).normalize();
        if !asks {
            continue;
        }
        let mut pair = [Placed { model: &a, pose: Pose::IDENTITY }, Placed { model: &b, pose }];
        if swapped {
            pair.reverse();
        }
        // A pose beyond the domain is refused, and that is an answer.
        if let Ok((_, mismatch)) = query_verified(pair[0], pair[1], &Query::of(demand), &mut memory)
        {
            let fields = mismatch.as_ref().map(|mismatch| mismatch.fields());
            assert!(fields.is_none(), "{fields:?}: {mismatch:#?}");
        }
    }
});
