//! What was found and mended while a model was prepared.

use cranny_exact::DVec3;

/// The outcome of preparing a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Vertices as filed.
    pub filed_vertices: usize,
    /// Vertices of the prepared mesh.
    pub vertices: usize,
    /// Faces (filed and prepared: none is ever dropped).
    pub faces: usize,
    /// Components that hang together over edges.
    pub components: usize,
    /// Every component bounds a region of space.
    pub closed: bool,
    /// No two faces contradict each other's orientation.
    pub oriented: bool,
    /// Surface area. Unit: length^2.
    pub area: f64,
    /// Volume, where closed. Unit: length^3.
    pub volume: Option<f64>,
    /// What is unusual and remains.
    pub findings: Vec<Finding>,
    /// What was mended.
    pub repairs: Vec<Repair>,
}

/// Something unusual, where it is and how large.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is.
    pub kind: FindingKind,
    /// The faces concerned.
    pub ids: Vec<u32>,
    /// A point of it, in the body's frame.
    pub at: DVec3,
    /// Its size: the length of an edge, the longest side of a face.
    pub measure: f64,
}

/// Kinds of findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FindingKind {
    /// A face without area: part of the surface as a segment or point, never of a crossing.
    ZeroAreaFace,
    /// An edge of one face: the mesh is a surface, not a solid.
    OpenEdge,
    /// An edge along which two faces run the same way: their orientations contradict.
    ContradictoryEdge,
    /// An edge of more than two faces.
    NonManifoldEdge,
}

impl FindingKind {
    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ZeroAreaFace => "zero_area_face",
            Self::OpenEdge => "open_edge",
            Self::ContradictoryEdge => "contradictory_edge",
            Self::NonManifoldEdge => "non_manifold_edge",
        }
    }

    /// What a finding of this kind means for answers; empty where it limits nothing.
    #[must_use]
    pub fn limits(self) -> &'static [&'static str] {
        match self {
            Self::ZeroAreaFace => &[],
            Self::OpenEdge | Self::ContradictoryEdge => {
                &["no containment, depth, area or mass: the component is a surface"]
            }
            Self::NonManifoldEdge => &[
                "regions may be split or joined at the edge: which faces follow each other is open",
            ],
        }
    }
}

/// Something that was mended, without moving any vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Repair {
    /// Vertices in exactly the same place became one.
    WeldedVertices {
        /// How many were merged into another.
        count: usize,
    },
    /// Vertices that no face used were dropped.
    DroppedVertices {
        /// How many.
        count: usize,
    },
    /// A closed mesh of negative volume was turned.
    TurnedRightSideOut {
        /// How many faces were turned.
        faces: usize,
    },
}

impl std::fmt::Display for Repair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::WeldedVertices { count } => {
                write!(f, "{count} vertices in the same place as another were welded to it")
            }
            Self::DroppedVertices { count } => {
                write!(f, "{count} vertices that no face uses were left out")
            }
            Self::TurnedRightSideOut { faces } => {
                write!(f, "the mesh was inside out: all {faces} faces were turned")
            }
        }
    }
}
