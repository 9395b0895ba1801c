//! What was mended.

use std::fmt;

/// Something that was mended.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairRecord {
    /// What was done.
    pub kind: RepairKind,
    /// To how many vertices or faces, as the kind says.
    pub count: usize,
    /// The filed faces concerned, where it was not done to nearly all of them: ascending.
    pub faces: Vec<u32>,
    /// The filed vertices concerned, ascending: of what is always done to vertices.
    pub vertices: Vec<u32>,
    /// The farthest that any point of the surface was moved. Unit: length.
    pub moved: f64,
}

/// Kinds of repairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum RepairKind {
    /// Vertices in exactly the same place became one (count: merged into another). Always done.
    WeldedVertices,
    /// Vertices that no face used were dropped. Always done.
    DroppedVertices,
    /// A closed mesh of negative volume was turned (count: faces). Always done.
    TurnedRightSideOut,
    /// Vertices of unmatched edges became one with another within the weld distance (count: moved).
    WeldedNearVertices,
    /// Edges were split at vertices within them (count: vertices inserted).
    SplitEdges,
    /// Faces whose corners came to lie on edges or vertices of others were dropped (count: faces).
    DroppedCollapsedFaces,
    /// Faces that lay in one place with another were dropped (count: faces).
    DroppedCoincidentFaces,
    /// Faces were turned to agree with their neighbours (count: faces).
    TurnedBackFaces,
    /// Components were turned to look outwards, with what lies in them (count: components).
    TurnedComponents,
    /// Components within others were turned into cavities, or into solids within cavities
    /// (count: components).
    TurnedNestedComponents,
    /// Pairs of opposite faces within a solid were dropped (count: faces).
    DroppedInnerSheets,
}

impl RepairKind {
    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::WeldedVertices => "welded_vertices",
            Self::DroppedVertices => "dropped_vertices",
            Self::TurnedRightSideOut => "turned_right_side_out",
            Self::WeldedNearVertices => "welded_near_vertices",
            Self::SplitEdges => "split_edges",
            Self::DroppedCollapsedFaces => "dropped_collapsed_faces",
            Self::DroppedCoincidentFaces => "dropped_coincident_faces",
            Self::TurnedBackFaces => "turned_back_faces",
            Self::TurnedComponents => "turned_components",
            Self::TurnedNestedComponents => "turned_nested_components",
            Self::DroppedInnerSheets => "dropped_inner_sheets",
        }
    }
}

impl RepairRecord {
    pub(crate) fn new(kind: RepairKind, count: usize) -> Self {
        Self { kind, count, faces: Vec::new(), vertices: Vec::new(), moved: 0.0 }
    }
}

impl fmt::Display for RepairRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved = Rounded(self.moved);
        let counted = |one: &str, more: &str| match self.count {
            1 => format!("1 {one}"),
            n => format!("{n} {more}"),
        };
        let vertices = counted("vertex", "vertices");
        let faces = counted("face", "faces");
        let components = counted("component", "components");
        match self.kind {
            RepairKind::WeldedVertices => {
                write!(f, "{vertices} in the same place as another: welded to it")
            }
            RepairKind::DroppedVertices => write!(f, "{vertices} that no face uses: left out"),
            RepairKind::TurnedRightSideOut => {
                write!(f, "the mesh was inside out: {faces} turned, all there are")
            }
            RepairKind::WeldedNearVertices => write!(
                f,
                "{vertices} on open edges near another: welded to it (moved by up to {moved})"
            ),
            RepairKind::SplitEdges => {
                write!(f, "edges were split at {vertices} within them (up to {moved} off the edge)")
            }
            RepairKind::DroppedCollapsedFaces => {
                write!(f, "{faces} without area: dropped, others cover the place")
            }
            RepairKind::DroppedCoincidentFaces => {
                write!(f, "{faces} in the same place as another: dropped")
            }
            RepairKind::TurnedBackFaces => {
                write!(f, "{faces} turned to agree with the neighbours")
            }
            RepairKind::TurnedComponents => write!(f, "{components} inside out: turned"),
            RepairKind::TurnedNestedComponents => write!(
                f,
                "{components} within others: turned into cavities, or solids within cavities"
            ),
            RepairKind::DroppedInnerSheets => {
                write!(f, "{faces} back to back within the solid: dropped")
            }
        }
    }
}

/// A length in four digits, plain where it is nothing or about as long as a unit.
struct Rounded(f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            nothing if !nothing.is_normal() => write!(f, "0"),
            short if (1e-3..1e4).contains(&short.abs()) => write!(f, "{short:.4}"),
            other => write!(f, "{other:.3e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_did_not_move_is_told_plainly() {
        let text = |moved| {
            let record = RepairRecord::new(RepairKind::SplitEdges, 2);
            RepairRecord { moved, ..record }.to_string()
        };
        assert!(text(0.0).ends_with("(up to 0 off the edge)"), "{}", text(0.0));
        assert!(text(5e-323).ends_with("(up to 0 off the edge)"));
        assert!(text(0.25).ends_with("(up to 0.2500 off the edge)"));
        assert!(text(7.9e-7).ends_with("(up to 7.900e-7 off the edge)"));
    }
}
