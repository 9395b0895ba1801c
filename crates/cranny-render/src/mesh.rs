//! What can be drawn of a body: triangles, flat-shaded, ready for the graphics adapter.

use std::sync::OnceLock;

use bytemuck::{Pod, Zeroable};
use cranny_exact::{Aabb, DVec3};
use thiserror::Error;

use crate::color::Color;
use crate::edges::Edges;

/// Triangles in a body's frame, prepared for drawing once and shared by every frame and instance.
///
/// Put it into an [`Arc`](std::sync::Arc) and hand the same handle to each frame: the
/// [`Renderer`](crate::Renderer) uploads it once and keeps it while any handle lives. Each face is
/// lit by its own plane (flat shading), so a picture shows the polyhedron as it is. Faces without
/// area cannot be seen and are left out. Coordinates are kept relative to the mesh's own centre and
/// size, so a small part far from its body's origin loses no detail.
#[derive(Clone, Debug)]
pub struct DrawMesh {
    vertices: Vec<Vertex>,
    bounds: Aabb,
    center: DVec3,
    radius: f64,
    /// By vertex index as given: those that are drawn, in their order, then those without area.
    faces: Vec<[u32; 3]>,
    /// Made when first needed.
    edges: OnceLock<Edges>,
}

/// Three of them make a face; no vertex is shared, since each face has its own normal.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Vertex {
    /// Relative to the mesh's centre, in units of its radius: within −1..=1.
    pub(crate) position: [f32; 3],
    /// Unit normal, signed normalised; the fourth is padding.
    pub(crate) normal: [i16; 4],
    /// sRGB.
    pub(crate) color: [u8; 4],
}

/// A mesh that cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DrawMeshError {
    /// A face names a vertex that does not exist.
    #[error(
        "face {face} names vertex {index}, but the mesh has {vertices} vertices (numbered from 0)"
    )]
    IndexOutOfRange {
        /// Offending face.
        face: usize,
        /// Index found.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// There must be one colour a face, or none at all.
    #[error("{colors} face colours were given for {faces} faces: there must be one for each")]
    ColorCount {
        /// Colours given.
        colors: usize,
        /// Faces given.
        faces: usize,
    },
    /// A coordinate is `NaN` or infinite.
    #[error("vertex {vertex} is at {position}: coordinates must be finite numbers")]
    NotFinite {
        /// Offending vertex.
        vertex: usize,
        /// Its position.
        position: DVec3,
    },
}

impl DrawMesh {
    /// A mesh of one colour (that of the instance). Faces are triples of vertex indices from 0,
    /// counter-clockwise seen from outside; seen from inside they are drawn dimmer.
    ///
    /// # Errors
    ///
    /// [`DrawMeshError`]: an index out of range, or a coordinate that is not finite.
    pub fn new(vertices: &[DVec3], faces: &[[u32; 3]]) -> Result<Self, DrawMeshError> {
        Self::build(vertices, faces, |_| Color::WHITE)
    }

    /// A mesh whose faces have colours of their own, for instance one per class of face. The
    /// instance's colour multiplies them: draw such a mesh with [`Color::WHITE`].
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new), and where `colors` and `faces` differ in number.
    pub fn with_face_colors(
        vertices: &[DVec3],
        faces: &[[u32; 3]],
        colors: &[Color],
    ) -> Result<Self, DrawMeshError> {
        if colors.len() != faces.len() {
            return Err(DrawMeshError::ColorCount { colors: colors.len(), faces: faces.len() });
        }
        Self::build(vertices, faces, |face| colors[face])
    }

    fn build(
        vertices: &[DVec3],
        faces: &[[u32; 3]],
        color: impl Fn(usize) -> Color,
    ) -> Result<Self, DrawMeshError> {
        if let Some(vertex) = vertices.iter().position(|p| !p.is_finite()) {
            return Err(DrawMeshError::NotFinite { vertex, position: vertices[vertex] });
        }
        for (face, corners) in faces.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices.len()) {
                let vertices = vertices.len();
                return Err(DrawMeshError::IndexOutOfRange { face, index, vertices });
            }
        }
        let used = faces.iter().flatten().map(|&i| vertices[i as usize]);
        let bounds = Aabb::of_points(used);
        let (center, radius) = match bounds.is_empty() {
            true => (DVec3::ZERO, 1.0),
            false => (bounds.center(), positive_or_one(bounds.half_extents().max_element())),
        };
        let mut prepared = Vec::with_capacity(3 * faces.len());
        let (mut drawn, mut flat) = (Vec::with_capacity(faces.len()), Vec::new());
        for (face, &indices) in faces.iter().enumerate() {
            let corners = indices.map(|i| (vertices[i as usize] - center) / radius);
            if let Some(normal) = unit_normal(corners) {
                let color = color(face).to_bytes();
                prepared.extend(corners.map(|p| Vertex {
                    position: p.as_vec3().to_array(),
                    normal,
                    color,
                }));
                drawn.push(indices);
            } else {
                flat.push(indices);
            }
        }
        drawn.append(&mut flat);
        let edges = OnceLock::new();
        Ok(Self { vertices: prepared, bounds, center, radius, faces: drawn, edges })
    }

    /// The box of all vertices that a face uses, in the body's frame; empty without faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Number of triangles that are drawn: those with an area.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.vertices.len() / 3
    }

    /// Whether every edge is passed as often one way as the other, so that the mesh bounds a solid: a
    /// section fills what it cuts of such a mesh.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.edges().closed
    }

    pub(crate) fn edges(&self) -> &Edges {
        self.edges.get_or_init(|| {
            let normals: Vec<DVec3> = self.normals().collect();
            Edges::of(&self.faces, self.triangle_count(), &normals)
        })
    }

    /// Of each face that is drawn; unit, to 16 bits.
    pub(crate) fn normals(&self) -> impl Iterator<Item = DVec3> {
        let faces = self.vertices.chunks_exact(3).map(|face| face[0].normal);
        faces.map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()) / f64::from(i16::MAX))
    }

    pub(crate) fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Vertex positions in the body's frame, as they are drawn (rounded to `f32` about the centre).
    pub(crate) fn positions(&self) -> impl Iterator<Item = DVec3> {
        (0..self.vertices.len() as u32).map(|vertex| self.position(vertex))
    }

    /// Of one of the vertices that are drawn.
    pub(crate) fn position(&self, vertex: u32) -> DVec3 {
        let local = self.vertices[vertex as usize].position.map(f64::from);
        self.center + self.radius * DVec3::from_array(local)
    }

    /// Origin of the vertex positions, in the body's frame.
    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    /// Unit of the vertex positions; above 0.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }
}

fn positive_or_one(x: f64) -> f64 {
    if x.is_normal() { x } else { 1.0 }
}

/// As signed normalised integers; `None` for a face without area. The corners lie within −1..=1.
fn unit_normal([a, b, c]: [DVec3; 3]) -> Option<[i16; 4]> {
    let normal = (b - a).cross(c - a).try_normalize()?;
    let [x, y, z] = normal.to_array().map(|x| (x * f64::from(i16::MAX)).round() as i16);
    Some([x, y, z, 0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_face_has_the_normal_of_its_winding() {
        let up = DrawMesh::new(&TRIANGLE, &[[0, 1, 2]]).unwrap();
        let down = DrawMesh::new(&TRIANGLE, &[[0, 2, 1]]).unwrap();
        assert_eq!(up.vertices()[0].normal, [0, 0, i16::MAX, 0]);
        assert_eq!(down.vertices()[2].normal, [0, 0, -i16::MAX, 0]);
        assert_eq!(up.bounds().max, DVec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn detail_survives_far_from_the_origin_and_at_any_scale() {
        for (scale, offset) in [(1e-20, 0.0), (1.0, 1e9), (1e20, 0.0)] {
            let vertices = TRIANGLE.map(|p| DVec3::splat(offset) + scale * p);
            let mesh = DrawMesh::new(&vertices, &[[0, 1, 2]]).unwrap();
            let drawn = mesh.vertices().iter().map(|v| v.position);
            for (drawn, wanted) in drawn.zip([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]]) {
                assert!((drawn[0] - wanted[0]).abs() < 1e-6, "{drawn:?}");
                assert!((drawn[1] - wanted[1]).abs() < 1e-6, "{drawn:?}");
            }
        }
    }

    #[test]
    fn faces_without_area_and_unused_vertices_do_not_count() {
        let mut vertices = TRIANGLE.to_vec();
        vertices.push(DVec3::splat(50.0));
        let mesh = DrawMesh::new(&vertices, &[[0, 1, 1], [0, 1, 2], [2, 2, 2]]).unwrap();
        assert_eq!(mesh.triangle_count(), 1);
        assert_eq!(mesh.bounds().max, DVec3::new(1.0, 1.0, 0.0));
        let none = DrawMesh::new(&[], &[]).unwrap();
        assert!(none.bounds().is_empty() && none.triangle_count() == 0);
    }

    #[test]
    fn bad_meshes_are_refused_by_name() {
        assert_eq!(
            DrawMesh::new(&TRIANGLE, &[[0, 1, 2], [0, 1, 3]]).unwrap_err(),
            DrawMeshError::IndexOutOfRange { face: 1, index: 3, vertices: 3 }
        );
        let nan = [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 0.0), DVec3::Y];
        let error = DrawMesh::new(&nan, &[[0, 1, 2]]).unwrap_err();
        assert!(matches!(error, DrawMeshError::NotFinite { vertex: 1, .. }));
        assert_eq!(
            DrawMesh::with_face_colors(&TRIANGLE, &[[0, 1, 2]], &[]).unwrap_err(),
            DrawMeshError::ColorCount { colors: 0, faces: 1 }
        );
    }
}
