//! Every reader of meshes on any bytes: a mesh that keeps its promises, or an error that can be
//! shown.

#![no_main]

use cranny_exact::check_point;
use cranny_scene::{MeshFormat, decode_mesh};
use libfuzzer_sys::fuzz_target;

const FORMATS: [MeshFormat; 6] = [
    MeshFormat::Obj,
    MeshFormat::Stl,
    MeshFormat::Ply,
    MeshFormat::Off,
    MeshFormat::Gltf,
    MeshFormat::Collada,
];

fuzz_target!(|data: &[u8]| {
    let Some((&first, content)) = data.split_first() else { return };
    match decode_mesh(content, FORMATS[first as usize % FORMATS.len()]) {
        Ok(file) => {
            let vertices = file.mesh.vertices();
            assert!(vertices.iter().all(|&p| check_point(p).is_ok()));
            assert!(!file.mesh.faces().is_empty());
            assert!(file.mesh.faces().iter().flatten().all(|&v| (v as usize) < vertices.len()));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
