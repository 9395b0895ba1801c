//! What a deformation reports: errors, changes, work.

use cranny_exact::DomainError;
use thiserror::Error;

use crate::hull::FacetChange;
use crate::ids::{FaceId, PatchId, VertexId};
use crate::model::no_area;
use crate::tree::{MovedFace, NodeChanges};

/// Moves that are refused; the model is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DeformError {
    /// A vertex that the mesh does not have.
    #[error(
        "move {at} names vertex {}, but the mesh has {vertices} vertices (numbered from 0)", vertex.0
    )]
    UnknownVertex {
        /// Which move.
        at: usize,
        /// The vertex named.
        vertex: VertexId,
        /// How many there are.
        vertices: usize,
    },
    /// A vertex that is moved twice.
    #[error("vertex {} is moved more than once", vertex.0)]
    MovedTwice {
        /// Which.
        vertex: VertexId,
    },
    /// A place outside the domain.
    #[error("vertex {}: {source}", vertex.0)]
    Coordinate {
        /// The vertex.
        vertex: VertexId,
        /// What is wrong with its new place.
        source: DomainError,
    },
    /// No face would have an area.
    #[error("after these moves {}", no_area(*.faces))]
    OnlyDegenerateFaces {
        /// Number of faces.
        faces: usize,
    },
    /// A closed body would be turned inside out.
    #[error("after these moves the body is inside out: its volume is {volume:?}")]
    InsideOut {
        /// What its volume would be.
        volume: f64,
    },
}

/// What a deformation has changed, for whoever keeps something about the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChangeSet {
    /// Vertices that are in another place; ascending.
    pub vertices: Vec<VertexId>,
    /// Faces with such a vertex; ascending.
    pub faces: Vec<FaceId>,
    /// Whether the hull has changed: its vertices, triangles and facets may have other numbers.
    /// Triangles and facets away from the change keep theirs, unless everything was built anew.
    pub hull: bool,
    /// For each patch before, by its id, the id of the one that has the same faces; `None` where
    /// there is no such.
    pub patches: Vec<Option<PatchId>>,
    /// Nodes of [`Model::tree`](crate::Model::tree).
    pub tree: NodeChanges,
    /// What was done.
    pub work: Work,
    /// How to follow it; `None` where nothing has changed, or everything was made anew.
    pub trail: Option<Trail>,
}

/// What a deformation leaves for structures that follow hull and faces, and need more than numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// The digest of the model before.
    pub from: [u8; 32],
    /// The faces that have moved.
    pub moved: Vec<MovedFace>,
    /// Facets of the hull that are others.
    pub facets: FacetChange,
    /// Triangles of the hull that are new or have another number.
    pub triangles: Vec<u32>,
}

impl ChangeSet {
    /// Whether the model is as it was.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }
}

/// How much geometry a deformation has looked at: figures that do not depend on the machine.
///
/// Passes that only number things (a few nanoseconds a face) are not counted; where they happen
/// stands with [`Model::deform`](crate::Model::deform).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Whether everything was built anew, a large part having moved: then the figures below are of
    /// all there is.
    pub is_anew: bool,
    /// Triangles of the hull that were passed in finding where moved vertices lie, as long as the
    /// hull was known to stay.
    pub located: usize,
    /// Triangles of the hull whose planes were measured.
    pub hull_triangles: usize,
    /// Nodes of trees, all kinds, whose boxes were computed.
    pub nodes: usize,
    /// Faces of patches that were measured.
    pub patched: usize,
    /// Faces and vertices that were added up, or compared, for sizes of the whole body: volume,
    /// centre, inertia, radius.
    pub summed: usize,
}
