//! Partners that are polyhedra already, or polyhedra grown by a radius: they become models,
//! exactly, and meet ours as such.

use std::collections::HashMap;
use std::sync::Arc;

use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model, SmoothNormals};
use cranny_primitives::{Rounded, deep::thickness};
use rapier3d::math::Real;
use rapier3d::parry::shape::{AxisMask, Shape, TypedShape, Voxels};

use crate::convert::wide;
use crate::shape::MeshShape;

/// A shape as all that is within a radius of a polyhedron.
#[derive(Clone, Debug)]
pub(crate) struct Core {
    pub(crate) rounded: Rounded,
    /// As [`thickness`] returns it.
    pub(crate) thickness: f64,
    /// The normals of its contacts, if not those of its facets.
    pub(crate) smooth: Option<Arc<SmoothNormals>>,
}

impl Core {
    /// Of a shape of rapier's; `None` where it has none, as anything round, or where its mesh has
    /// no area.
    pub(crate) fn of(shape: &dyn Shape) -> Option<Self> {
        let rounded = rounded_polyhedron(shape)?;
        Some(Self { thickness: thickness(&rounded.model), rounded, smooth: None })
    }

    /// Of one of our shapes.
    pub(crate) fn of_ours(shape: &MeshShape) -> Self {
        Self {
            rounded: Rounded { model: shape.model().clone(), radius: 0.0 },
            thickness: shape.thickness(),
            smooth: shape.smooth_normals().cloned(),
        }
    }

    pub(crate) fn model(&self) -> &Model {
        &self.rounded.model
    }
}

/// The model of a polyhedron and the border radius around it: 0 where it has none.
pub(crate) fn rounded_polyhedron(shape: &dyn Shape) -> Option<Rounded> {
    let (inner, radius): (&dyn Shape, Real) = match shape.as_typed_shape() {
        TypedShape::RoundCuboid(round) => (&round.inner_shape, round.border_radius),
        TypedShape::RoundTriangle(round) => (&round.inner_shape, round.border_radius),
        TypedShape::RoundConvexPolyhedron(round) => (&round.inner_shape, round.border_radius),
        _ => (shape, 0.0),
    };
    Some(Rounded { model: polyhedron(inner)?, radius: radius.into() })
}

/// The model of a polyhedron or a surface of triangles; `None` for any other shape, or where the
/// mesh has no area.
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
        TypedShape::Triangle(t) => ([t.a, t.b, t.c].map(wide).to_vec(), vec![[0, 1, 2]]),
        TypedShape::Voxels(voxels) => voxel_mesh(voxels),
        _ => return None,
    };
    let mesh = Mesh::new(vertices, faces).ok()?;
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    Model::build(mesh, &options).ok().map(|(model, _)| model)
}

fn cuboid_mesh(h: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let corner = |i: u32| h * DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4));
    let quads: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), faces)
}

/// The sides of the voxels that no other voxel covers; corners that voxels share are one vertex.
fn voxel_mesh(voxels: &Voxels) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let size = wide(voxels.voxel_size());
    let mut ids = HashMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for voxel in voxels.voxels().filter(|voxel| !voxel.state.is_empty()) {
        let cell = voxel.grid_coords;
        let free = voxel.state.free_faces();
        for (axis, [below, above]) in SIDES.into_iter().enumerate() {
            for (side, mask) in [(0, below), (1, above)] {
                if !free.contains(mask) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                    let mut corner = cell;
                    corner[axis] += side;
                    corner[u] += du;
                    corner[v] += dv;
                    *ids.entry(corner).or_insert_with(|| {
                        vertices.push(size * corner.as_dvec3());
                        vertices.len() as u32 - 1
                    })
                });
                if side == 0 {
                    quad.reverse();
                }
                let [a, b, c, d] = quad;
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (vertices, faces)
}

/// Of each axis, the side that looks down and the one that looks up.
const SIDES: [[AxisMask; 2]; 3] = [
    [AxisMask::X_NEG, AxisMask::X_POS],
    [AxisMask::Y_NEG, AxisMask::Y_POS],
    [AxisMask::Z_NEG, AxisMask::Z_POS],
];

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::Aabb;
    use rapier3d::math::{IVector, Vector};
    use rapier3d::parry::shape::{Ball, Cuboid, RoundCuboid};

    #[test]
    fn a_cuboid_becomes_a_closed_model_of_its_volume() {
        let model = polyhedron(&Cuboid::new(Vector::new(0.5, 1.0, 1.5))).unwrap();
        assert!(model.is_closed());
        assert_eq!(model.mass_properties().unwrap().volume, 6.0);
        assert!(polyhedron(&Ball::new(1.0)).is_none());
    }

    #[test]
    fn voxels_become_the_closed_surface_of_their_union() {
        let size = Vector::new(0.5, 0.25, 2.0);
        let cells = [[0, 0, 0], [1, 0, 0], [1, 1, 0]].map(IVector::from_array);
        let voxels = Voxels::new(size, &cells);
        let model = polyhedron(&voxels).unwrap();
        assert!(model.is_closed());
        assert_eq!(model.mass_properties().unwrap().volume, 3.0 * 0.25);
        // parry's own box is that of whole chunks of voxels.
        let corners = voxels
            .voxels()
            .filter(|voxel| !voxel.state.is_empty())
            .flat_map(|voxel| [-0.5, 0.5].map(|half| wide(voxel.center) + half * wide(size)));
        assert_eq!(model.bounds(), Aabb::of_points(corners));
    }

    #[test]
    fn a_round_shape_has_a_core_and_a_radius() {
        let round = RoundCuboid {
            inner_shape: Cuboid::new(Vector::new(0.5, 1.0, 1.5)),
            border_radius: 0.25,
        };
        let core = Core::of(&round).unwrap();
        assert_eq!(
            (core.rounded.radius, core.model().bounds().max),
            (0.25, DVec3::new(0.5, 1.0, 1.5))
        );
        assert!(Core::of(&Ball::new(1.0)).is_none());
    }
}
