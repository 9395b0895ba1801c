//! Sound meshes, and defects to put into them.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_shapes::{Cuboid, Torus};

/// Two by four by eight: every half of every coordinate is exact. Outward, 12 faces, volume 64.
pub(crate) fn cuboid() -> Mesh {
    Cuboid { size: [2.0, 4.0, 8.0] }.build().unwrap()
}

pub(crate) fn torus() -> Mesh {
    Torus { major_segments: 24, minor_segments: 10, ..Torus::default() }.build().unwrap()
}

pub(crate) fn moved(mesh: &Mesh, by: DVec3) -> Mesh {
    let vertices = mesh.vertices().iter().map(|&p| p + by).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

pub(crate) fn turned(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    Mesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

pub(crate) fn edited(mesh: &Mesh, edit: impl FnOnce(&mut Vec<DVec3>, &mut Vec<[u32; 3]>)) -> Mesh {
    let (mut vertices, mut faces) = (mesh.vertices().to_vec(), mesh.faces().to_vec());
    edit(&mut vertices, &mut faces);
    Mesh::new(vertices, faces).unwrap()
}

/// Splits a side of one face at equal parts, without its neighbour: T-vertices.
pub(crate) fn with_t_vertices(mesh: &Mesh, face: usize, parts: u32, lift: DVec3) -> Mesh {
    edited(mesh, |vertices, faces| {
        let [a, b, c] = faces[face];
        let (p, q) = (vertices[a as usize], vertices[b as usize]);
        let mut last = a;
        for i in 1..parts {
            let new = vertices.len() as u32;
            vertices.push(p.lerp(q, f64::from(i) / f64::from(parts)) + lift);
            faces.push([last, new, c]);
            last = new;
        }
        faces[face] = [last, b, c];
    })
}
