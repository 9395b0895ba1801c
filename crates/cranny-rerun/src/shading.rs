//! Normals for the eye: a mesh's corners, split where it has an edge.
//!
//! A corner's normal is the mean, by area, of the normals of the faces around its vertex that bend
//! away from its own face by less than [`CREASE_DEGREES`].

use std::collections::HashMap;

use cranny_exact::DVec3;
use cranny_geometry::Mesh;

/// Faces that meet at a larger angle are drawn with an edge between them. Smaller: coarse tori look
/// faceted; larger: the flanks of threads are rounded off. `a_cube_keeps_its_edges` and
/// `a_torus_is_round` look at both.
const CREASE_DEGREES: f64 = 35.0;

/// At vertices of more faces, each face keeps its own normal. Smaller: the poles of fine spheres
/// are faceted; larger: the tip of a cone of many faces takes their square to look at.
const MOST_FACES: usize = 256;

/// A mesh as a viewer lights it. Vertices stand there once for each of their normals.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct ShadedMesh {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl ShadedMesh {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let areas: Vec<DVec3> = mesh.faces().iter().map(|face| area_vector(mesh, *face)).collect();
        let around = faces_around(mesh);
        let mut shaded = Self::default();
        let mut known = HashMap::new();
        for (face, corners) in mesh.faces().iter().enumerate() {
            shaded.triangles.push(corners.map(|vertex| {
                let normal = corner_normal(&areas, face, &around[vertex as usize]);
                *known.entry((vertex, normal.map(f32::to_bits))).or_insert_with(|| {
                    let position = mesh.vertices()[vertex as usize].as_vec3().to_array();
                    shaded.positions.push(position);
                    shaded.normals.push(normal);
                    shaded.positions.len() as u32 - 1
                })
            }));
        }
        shaded
    }
}

/// Twice the area, along the normal.
fn area_vector(mesh: &Mesh, face: [u32; 3]) -> DVec3 {
    let [a, b, c] = face.map(|vertex| mesh.vertices()[vertex as usize]);
    (b - a).cross(c - a)
}

/// For each vertex, the faces that it is a corner of.
fn faces_around(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut around = vec![Vec::new(); mesh.vertices().len()];
    for (face, corners) in mesh.faces().iter().enumerate() {
        corners.iter().for_each(|&vertex| around[vertex as usize].push(face));
    }
    around
}

/// Unit; straight up where no face around has an area.
fn corner_normal(areas: &[DVec3], face: usize, around: &[usize]) -> [f32; 3] {
    let own = areas[face].normalize_or_zero();
    let flat = CREASE_DEGREES.to_radians().cos();
    let is_near = |&&other: &&usize| own.dot(areas[other].normalize_or_zero()) >= flat;
    let sum: DVec3 = match around.len() > MOST_FACES {
        true => own,
        false => around.iter().filter(is_near).map(|&other| areas[other]).sum(),
    };
    sum.try_normalize().or(own.try_normalize()).unwrap_or(DVec3::Z).as_vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_shapes::{Cuboid, Torus};

    #[test]
    fn a_cube_keeps_its_edges() {
        let mesh = Cuboid { size: [1.0; 3] }.build().unwrap();
        let shaded = ShadedMesh::of(&mesh);
        assert_eq!((shaded.positions.len(), shaded.triangles.len()), (24, mesh.faces().len()));
        for normal in shaded.normals {
            assert_eq!(normal.map(f32::abs).iter().sum::<f32>(), 1.0, "{normal:?}");
        }
    }

    #[test]
    fn a_torus_is_round() {
        let mesh = Torus::default().build().unwrap();
        let shaded = ShadedMesh::of(&mesh);
        assert_eq!(shaded.positions.len(), mesh.vertices().len());
        for (triangle, face) in shaded.triangles.iter().zip(mesh.faces()) {
            let plane = area_vector(&mesh, *face).normalize();
            for (&corner, &vertex) in triangle.iter().zip(face) {
                let at = mesh.vertices()[vertex as usize].as_vec3().to_array();
                assert_eq!(shaded.positions[corner as usize], at);
                let normal = DVec3::from(shaded.normals[corner as usize].map(f64::from));
                assert!(normal.dot(plane) > 0.8 && (normal.length() - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn faces_without_area_have_a_normal_all_the_same() {
        let line = [0.0, 1.0, 2.0].map(|x| DVec3::new(x, 0.0, 0.0));
        let mesh = Mesh::new(line.to_vec(), vec![[0, 1, 2]]).unwrap();
        assert_eq!(ShadedMesh::of(&mesh).normals, [[0.0, 0.0, 1.0]; 3]);
    }
}
