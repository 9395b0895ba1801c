//! Vertices and faces on their way from a file to a [`Mesh`].

use std::collections::HashMap;

use cranny_exact::{DVec3, check_point};
use cranny_geometry::{Flatness, Mesh, MeshError};

use super::polygons::Polygons;
use super::problem::{DecodeError, Place, Problem};
use super::{MeshFile, MeshFormat};

/// Gathers what a reader finds. Coordinates are checked as they come, while their place is known.
pub(super) struct Builder {
    format: MeshFormat,
    vertices: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    polygons: Polygons,
    notes: Vec<String>,
    remark: String,
    flatness: Flatness,
}

impl Builder {
    pub(super) fn new(format: MeshFormat) -> Self {
        Self {
            format,
            vertices: Vec::new(),
            faces: Vec::new(),
            polygons: Polygons::default(),
            notes: Vec::new(),
            remark: String::new(),
            flatness: Flatness::Auto,
        }
    }

    /// An error of this file.
    pub(super) fn error(&self, place: Place, problem: impl Into<Problem>) -> DecodeError {
        DecodeError { format: self.format, place, problem: problem.into() }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Adds a vertex; `place` is made only where its coordinates are refused.
    pub(super) fn vertex(
        &mut self,
        position: DVec3,
        place: impl FnOnce() -> Place,
    ) -> Result<(), DecodeError> {
        check_point(position).map_err(|problem| self.error(place(), problem))?;
        self.vertices.push(position);
        Ok(())
    }

    /// Adds a polygon of at least three corners, split at the end, when all vertices are known. The
    /// caller has checked the indices.
    pub(super) fn polygon(&mut self, corners: &[u32], place: impl FnOnce() -> Place) {
        match *corners {
            [a, b, c] => self.faces.push([a, b, c]),
            _ => self.polygons.add(self.faces.len(), corners, place()),
        }
    }

    /// Coordinates had single precision, and have been transformed since.
    pub(super) fn was_single(&mut self) {
        self.flatness = Flatness::Single;
    }

    /// Something the reader left out or changed, one sentence.
    pub(super) fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// What to say beside 'no faces were found'.
    pub(super) fn remark(&mut self, remark: String) {
        self.remark = remark;
    }

    /// The mesh as gathered.
    pub(super) fn finish(mut self) -> Result<MeshFile, DecodeError> {
        let format = self.format;
        let (faces, splits) = self.polygons.split(&self.vertices, self.faces);
        match Mesh::new(self.vertices, faces) {
            Ok(mesh) => {
                self.notes.extend(splits.notes(&mesh));
                Ok(MeshFile { mesh, format, notes: self.notes, flatness: self.flatness })
            }
            Err(error) => {
                let (place, problem) = match error {
                    MeshError::NoFaces { vertices } => {
                        (Place::Whole, Problem::NoFaces { vertices, remark: self.remark })
                    }
                    MeshError::IndexOutOfRange { face, index, vertices } => (
                        Place::Face(face),
                        Problem::Index { index: i64::from(index), vertices, first: 0 },
                    ),
                    MeshError::Coordinate { vertex, source } => {
                        (Place::Vertex(vertex), Problem::Coordinate(source))
                    }
                    other => (Place::Whole, Problem::Mesh(other)),
                };
                Err(DecodeError { format, place, problem })
            }
        }
    }
}

/// Joins vertices of equal position, for formats without indices; −0 equals 0.
#[derive(Default)]
pub(super) struct Weld {
    index_of: HashMap<[u64; 3], u32>,
}

impl Weld {
    /// The index of a position, added to the builder where it is new.
    pub(super) fn index(
        &mut self,
        builder: &mut Builder,
        position: DVec3,
        place: impl FnOnce() -> Place,
    ) -> Result<u32, DecodeError> {
        let key = position.to_array().map(|x| (x + 0.0).to_bits());
        if let Some(&index) = self.index_of.get(&key) {
            return Ok(index);
        }
        let index = builder.vertex_count() as u32;
        builder.vertex(position, place)?;
        self.index_of.insert(key, index);
        Ok(index)
    }
}
