//! Model files that somebody changed, with a right checksum: they are refused, or are models that
//! can be written back as they were and queried in any way.

#![no_main]

use std::sync::LazyLock;

use cranny_exact::DVec3;
use cranny_fuzz::{Bytes, ask};
use cranny_concavity::Concavities;
use cranny_geometry::{BuildOptions, Mesh, Model, VertexId};
use cranny_shapes::{Cuboid, Cup, NestedShells, PyramidInCavity, Torus};
use libfuzzer_sys::fuzz_target;

/// Magic, version, 0, length; then the checksum.
const BEFORE_CHECKSUM: usize = 24;
const HEAD: usize = BEFORE_CHECKSUM + 8;

static FILES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let small = |mesh: Result<Mesh, _>| mesh.expect("a generator with sound parameters");
    let cup = small(Cup { segments: 8, ..Cup::default() }.build());
    let open = Mesh::new(cup.vertices().to_vec(), cup.faces()[3..].to_vec()).expect("a part");
    let meshes = [
        small(Cuboid::default().build()),
        small(PyramidInCavity::default().build()),
        small(Torus { major_segments: 6, minor_segments: 5, ..Torus::default() }.build()),
        small(NestedShells { segments: 6, ..NestedShells::default() }.build()),
        cup,
        open,
    ];
    let build = |mesh| Model::build(mesh, &BuildOptions::default()).expect("a sound mesh").0;
    let mut models: Vec<Model> = meshes.into_iter().map(build).collect();
    let mut moved = models[1].clone();
    let place = moved.mesh().position(VertexId(0)) + DVec3::splat(1e-3);
    moved.deform(&[(VertexId(0), place)]).expect("a small move");
    models.push(moved);
    models.iter().map(Model::encode).collect()
});

fn sealed(mut file: Vec<u8>) -> Vec<u8> {
    if file.len() >= HEAD {
        let length = file.len() as u64;
        file[BEFORE_CHECKSUM - 8..BEFORE_CHECKSUM].copy_from_slice(&length.to_le_bytes());
        let sum = checksum(&file[HEAD..]);
        file[BEFORE_CHECKSUM..HEAD].copy_from_slice(&sum.to_le_bytes());
    }
    file
}

/// As `cranny-geometry` describes it (`codec`).
fn checksum(bytes: &[u8]) -> u64 {
    let factor = 0x9E37_79B9_7F4A_7C15u64;
    let step = |lane: u64, word: u64| (lane ^ word).wrapping_mul(factor).rotate_left(32);
    let mut lanes: [u64; 8] = std::array::from_fn(|i| factor.wrapping_mul(i as u64 + 1));
    for block in bytes.chunks(64) {
        let mut filled = [0; 64];
        filled[..block.len()].copy_from_slice(block);
        for (lane, word) in lanes.iter_mut().zip(filled.as_chunks::<8>().0) {
            *lane = step(*lane, u64::from_le_bytes(*word));
        }
    }
    lanes.into_iter().fold(0, step)
}

/// A real file after some edits, or the bytes as they are.
fn file(data: &[u8]) -> Vec<u8> {
    let mut bytes = Bytes(data);
    let Some(mut file) = FILES.get(bytes.byte() as usize % 8).cloned() else {
        return bytes.0.to_vec();
    };
    while !bytes.is_empty() {
        let (edit, at) = (bytes.byte(), HEAD + bytes.word() as usize % (file.len() - HEAD));
        let value = bytes.word();
        match edit % 6 {
            0 => file[at] = value as u8,
            1 => file[at] ^= 1 << (value % 8),
            2 if at + 4 <= file.len() => file[at..at + 4].copy_from_slice(&value.to_le_bytes()),
            3 if at + 4 <= file.len() => {
                let small = value % 256;
                file[at..at + 4].copy_from_slice(&small.to_le_bytes());
            }
            4 => {
                let from = HEAD + value as usize % (file.len() - HEAD);
                file.swap(at, from);
            }
            _ => {
                let length = (value as usize % 16).min(file.len() - at);
                if file.len() > HEAD + length {
                    file.drain(at..at + length);
                }
            }
        }
    }
    file
}

fuzz_target!(|data: &[u8]| {
    let file = sealed(file(data));
    if let Ok(model) = Model::decode(&file) {
        assert!(model.encode() == file, "a file that is read is the one that would be written");
        // What is made late is made of what was read.
        model.prepare_all();
        let concavities = Concavities::of(&model);
        let groups = concavities.iter().map(|concavity| concavity.faces);
        let trees = concavities.trees().validate(model.mesh(), groups);
        assert_eq!(trees, Ok(()), "a tree for each concavity");
        // Queries take a hundred times as long as reading: they are made of some.
        if data.first().is_none_or(|byte| byte / 8 % 8 == 0) {
            ask(&model);
        }
    }
});
