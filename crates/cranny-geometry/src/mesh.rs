//! Triangle meshes as they are read: vertices and index triples, checked but not yet understood.

use cranny_exact::{Aabb, DVec3, DomainError, check_point, is_in_domain};
use thiserror::Error;

use crate::ids::{FaceId, VertexId};

/// Vertices and triangles. Faces are counter-clockwise seen from outside where the mesh bounds a
/// solid. Every index is in range and every coordinate inside the [`domain`](cranny_exact::domain);
/// nothing else is promised (faces may be degenerate, edges open).
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
}

/// A mesh that cannot be accepted at all.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No face.
    #[error("the mesh has no faces ({vertices} vertices): nothing can collide with it")]
    NoFaces {
        /// Number of vertices found.
        vertices: usize,
    },
    /// An index beyond the vertices.
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
    /// A coordinate outside the domain.
    #[error("vertex {vertex}: {source}")]
    Coordinate {
        /// Offending vertex.
        vertex: usize,
        /// What is wrong with it.
        source: DomainError,
    },
    /// More than 2^30 vertices or faces.
    #[error("the mesh has {count} {what}; at most {limit} are supported")]
    TooLarge {
        /// "vertices" or "faces".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are accepted.
        limit: usize,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for MeshError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Half-edges are numbered by `u32`: three a face.
const MAX_ELEMENTS: usize = 1 << 30;

impl Mesh {
    /// A mesh from vertices and faces (indices from 0).
    ///
    /// # Errors
    ///
    /// [`MeshError`]: no faces, an index out of range, a coordinate out of the domain.
    pub fn new(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        for (what, count) in [("vertices", vertices.len()), ("faces", faces.len())] {
            if count > MAX_ELEMENTS {
                return Err(MeshError::TooLarge { what, count, limit: MAX_ELEMENTS });
            }
        }
        if faces.is_empty() {
            return Err(MeshError::NoFaces { vertices: vertices.len() });
        }
        // Short loops over all; whoever offends is searched for when it is known that somebody
        // does.
        let is_inside = vertices.iter().fold(true, |all, &p| all & is_in_domain(p));
        if !is_inside {
            for (vertex, &p) in vertices.iter().enumerate() {
                check_point(p).map_err(|source| MeshError::Coordinate { vertex, source })?;
            }
        }
        let count = vertices.len() as u32;
        let is_there = |corners: &[u32; 3]| corners.iter().fold(true, |all, &i| all & (i < count));
        if !faces.iter().fold(true, |all, corners| all & is_there(corners)) {
            for (face, corners) in faces.iter().enumerate() {
                if let Some(&index) = corners.iter().find(|&&i| i >= count) {
                    let vertices = vertices.len();
                    return Err(MeshError::IndexOutOfRange { face, index, vertices });
                }
            }
        }
        Ok(Self { vertices, faces })
    }

    /// From parts that are known to keep the promises.
    pub(crate) fn from_trusted(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Self {
        debug_assert!(faces.iter().flatten().all(|&i| (i as usize) < vertices.len()));
        Self { vertices, faces }
    }

    /// Turns every face around.
    pub(crate) fn turned_inside_out(mut self) -> Self {
        for face in &mut self.faces {
            face.swap(1, 2);
        }
        self
    }

    /// Moves a vertex to a place inside the domain.
    pub(crate) fn set_position(&mut self, vertex: VertexId, position: DVec3) {
        debug_assert!(check_point(position).is_ok());
        // As in `weld`: no zero has a sign.
        self.vertices[vertex.index()] = position + DVec3::ZERO;
    }

    /// Vertex positions in the body's frame.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Faces as triples of vertex indices.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// All vertices, ascending.
    #[inline]
    pub fn vertex_ids(&self) -> impl ExactSizeIterator<Item = VertexId> + Clone + use<> {
        (0..self.vertices.len() as u32).map(VertexId)
    }

    /// All faces, ascending.
    #[inline]
    pub fn face_ids(&self) -> impl ExactSizeIterator<Item = FaceId> + Clone + use<> {
        (0..self.faces.len() as u32).map(FaceId)
    }

    /// Position of a vertex.
    #[must_use]
    #[inline]
    pub fn position(&self, vertex: VertexId) -> DVec3 {
        self.vertices[vertex.index()]
    }

    /// Corners of a face, in order.
    #[must_use]
    #[inline]
    pub fn corners(&self, face: FaceId) -> [VertexId; 3] {
        self.faces[face.index()].map(VertexId)
    }

    /// Corner positions of a face, in order.
    #[must_use]
    #[inline]
    pub fn triangle(&self, face: FaceId) -> [DVec3; 3] {
        let [a, b, c] = self.faces[face.index()];
        [self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]]
    }

    /// The area vector of a face: half the cross product of two edges, along its outward normal.
    #[must_use]
    pub fn area_vector(&self, face: FaceId) -> DVec3 {
        let [a, b, c] = self.triangle(face);
        0.5 * (b - a).cross(c - a)
    }

    /// The box of all vertices.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.vertices.iter().copied())
    }

    /// The same mesh, scaled along the axes. A mirroring scale (odd number of negative factors)
    /// turns the faces around, so that outside stays outside.
    ///
    /// # Errors
    ///
    /// [`MeshError::Coordinate`] where the result leaves the domain.
    pub fn scaled(&self, scale: DVec3) -> Result<Self, MeshError> {
        let vertices = self.vertices.iter().map(|&p| p * scale).collect();
        let mirrored = scale.x * scale.y * scale.z < 0.0;
        let turn = |&[a, b, c]: &[u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        Self::new(vertices, self.faces.iter().map(turn).collect())
    }

    /// Both meshes as one, the faces of `other` after those of `self`.
    #[must_use]
    pub fn joined(mut self, other: &Self) -> Self {
        let offset = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.faces.extend(other.faces.iter().map(|f| f.map(|i| i + offset)));
        self
    }
}
