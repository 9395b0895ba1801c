//! Partners that are polyhedra already: they become models, exactly, and meet ours as such.

use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model};
use rapier3d::parry::shape::{Shape, TypedShape};

use crate::convert::wide;

/// The model of a cuboid, convex polyhedron, triangle mesh or height field; `None` for any other shape, or where
/// the mesh has no area.
pub(crate) fn polyhedron(shape: &dyn Shape) -> Option<Model> {
    let (vertices, faces) = match shape.as_typed_shape() {
        TypedShape::Cuboid(cuboid) => cuboid_mesh(wide(cuboid.half_extents)),
        TypedShape::ConvexPolyhedron(convex) => {
            let (points, faces) = convex.to_trimesh();
            (points.into_iter().map(wide).collect(), faces)
        }
        TypedShape::TriMesh(mesh) => {
            (mesh.vertices().iter().map(|&p| wide(p)).collect(), mesh.indices().to_vec())
        }
        TypedShape::HeightField(field) => {
            let (points, faces) = field.to_trimesh();
            (points.into_iter().map(wide).collect(), faces)
        }
        _ => return None,
    };
    let mesh = Mesh::new(vertices, faces).ok()?;
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    Model::build(mesh, &options).ok().map(|(model, _)| model)
}

/// Whether [`polyhedron`] knows the kind of a shape.
pub(crate) fn is_polyhedral(shape: &dyn Shape) -> bool {
    matches!(
        shape.as_typed_shape(),
        TypedShape::Cuboid(_)
            | TypedShape::ConvexPolyhedron(_)
            | TypedShape::TriMesh(_)
            | TypedShape::HeightField(_)
    )
}

fn cuboid_mesh(h: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let corner = |i: u32| h * DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4));
    let quads: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rapier3d::parry::shape::{Ball, Cuboid};

    #[test]
    fn a_cuboid_becomes_a_closed_model_of_its_volume() {
        let model = polyhedron(&Cuboid::new(rapier3d::math::Vector::new(0.5, 1.0, 1.5))).unwrap();
        assert!(model.is_closed());
        assert_eq!(model.mass_properties().unwrap().volume, 6.0);
        assert!(polyhedron(&Ball::new(1.0)).is_none());
    }
}
