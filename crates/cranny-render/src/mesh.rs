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
    /// Three to each face that is drawn. The first is that face's own: its normal and colour count.
    indices: Vec<u32>,
    bounds: Aabb,
    center: DVec3,
    radius: f64,
    /// By vertex index as given: those that are drawn, in their order, then those without area.
    faces: Vec<[u32; 3]>,
    /// Made when first needed.
    edges: OnceLock<Edges>,
}

/// A corner. Faces share them, though each has a normal of its own: a face takes it from its first
/// corner (the provoking vertex), and no two faces have the same first one.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Vertex {
    /// Relative to the mesh's centre, in units of its radius: within −1..=1.
    pub(crate) position: [f32; 3],
    /// Unit normal, signed normalised; the fourth is padding.
    pub(crate) normal: [i16; 4],
    /// Linear light, so that no vertex costs a power.
    pub(crate) color: [u16; 4],
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
        let mut corners = Corners::of(vertices, center, radius);
        let (mut drawn, mut flat) = (Vec::with_capacity(faces.len()), Vec::new());
        for (face, &indices) in faces.iter().enumerate() {
            let places = indices.map(|i| (vertices[i as usize] - center) / radius);
            match unit_normal(places) {
                Some(normal) => {
                    let wide = |c: f32| (c * f32::from(u16::MAX)).round() as u16;
                    let indices = corners.add(indices, normal, color(face).to_linear().map(wide));
                    drawn.push(indices);
                }
                None => flat.push(indices),
            }
        }
        drawn.append(&mut flat);
        let Corners { prepared: vertices, indices, .. } = corners;
        let edges = OnceLock::new();
        Ok(Self { vertices, indices, bounds, center, radius, faces: drawn, edges })
    }

    /// The box of all vertices that a face uses, in the body's frame; empty without faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Number of triangles that are drawn: those with an area.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Whether every edge is passed as often one way as the other, so that the mesh bounds a solid:
    /// a section fills what it cuts of such a mesh.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.edges().closed
    }

    pub(crate) fn edges(&self) -> &Edges {
        self.edges.get_or_init(|| {
            let normals: Vec<DVec3> = self.normals().collect();
            Edges::of(&self.faces, &self.indices, &normals)
        })
    }

    /// Of each face that is drawn; unit, to 16 bits.
    pub(crate) fn normals(&self) -> impl Iterator<Item = DVec3> {
        let faces = self.indices.chunks_exact(3).map(|face| self.vertices[face[0] as usize].normal);
        faces.map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()) / f64::from(i16::MAX))
    }

    pub(crate) fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    pub(crate) fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// Of all corners in the body's frame, as they are drawn (rounded to `f32` about the centre).
    pub(crate) fn positions(&self) -> impl Iterator<Item = DVec3> {
        (0..self.vertices.len() as u32).map(|vertex| self.position(vertex))
    }

    /// Corners of each face that is drawn, in the body's frame.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let faces = self.indices.chunks_exact(3);
        faces.map(|face| [0, 1, 2].map(|k| self.position(face[k])))
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

/// Corners as faces come to share them.
struct Corners {
    prepared: Vec<Vertex>,
    /// Where each vertex is among `prepared`, if it is, and whether a face has it first.
    places: Vec<Option<(u32, bool)>>,
    positions: Vec<[f32; 3]>,
    indices: Vec<u32>,
}

impl Corners {
    fn of(vertices: &[DVec3], center: DVec3, radius: f64) -> Self {
        let position = |p: &DVec3| ((*p - center) / radius).as_vec3().to_array();
        let positions = vertices.iter().map(position).collect();
        let places = vec![None; vertices.len()];
        Self { prepared: Vec::new(), places, positions, indices: Vec::new() }
    }

    /// Takes a face in, and returns it with the corner first that is its own.
    fn add(&mut self, face: [u32; 3], normal: [i16; 4], color: [u16; 4]) -> [u32; 3] {
        let is_free = |i: &u32| self.places[*i as usize].is_none_or(|(_, taken)| !taken);
        let k = face.iter().position(is_free);
        let turn = k.unwrap_or(0);
        let face = [0, 1, 2].map(|i| face[(i + turn) % 3]);
        let own = match k {
            Some(_) => self.place(face[0]),
            None => self.push(face[0]),
        };
        if k.is_some() {
            self.places[face[0] as usize] = Some((own, true));
        }
        self.prepared[own as usize].normal = normal;
        self.prepared[own as usize].color = color;
        let others = [face[1], face[2]].map(|i| self.place(i));
        self.indices.extend([own, others[0], others[1]]);
        face
    }

    fn place(&mut self, vertex: u32) -> u32 {
        if let Some((at, _)) = self.places[vertex as usize] {
            return at;
        }
        let at = self.push(vertex);
        self.places[vertex as usize] = Some((at, false));
        at
    }

    fn push(&mut self, vertex: u32) -> u32 {
        let position = self.positions[vertex as usize];
        self.prepared.push(Vertex { position, normal: [0; 4], color: [0; 4] });
        self.prepared.len() as u32 - 1
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
        assert_eq!(up.normals().next(), Some(DVec3::Z));
        assert_eq!(down.normals().next(), Some(DVec3::NEG_Z));
        assert_eq!(up.bounds().max, DVec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn faces_share_corners_and_each_has_a_normal_of_its_own() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 2, 1]];
        let mesh = DrawMesh::new(&corners, &faces).unwrap();
        assert_eq!((mesh.triangle_count(), mesh.vertices().len()), (5, 5));
        let oblique = DVec3::ONE.normalize();
        let normals = [DVec3::NEG_Z, DVec3::NEG_Y, DVec3::NEG_X, oblique, DVec3::NEG_Z];
        for (drawn, normal) in mesh.normals().zip(normals) {
            assert!((drawn - normal).length() < 1e-4, "{drawn}");
        }
        for (drawn, face) in mesh.triangles().zip(faces) {
            let [a, b, c] = face.map(|i: u32| corners[i as usize]);
            let turns = [[a, b, c], [b, c, a], [c, a, b]];
            let near = |t: &[DVec3; 3]| (0..3).all(|k| (t[k] - drawn[k]).length() < 1e-6);
            assert!(turns.iter().any(near), "{drawn:?}");
        }
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
