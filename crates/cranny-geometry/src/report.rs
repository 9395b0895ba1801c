//! What was found and mended while a model was prepared.

use cranny_exact::DVec3;

use crate::scan::Scanned;

/// The outcome of preparing a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Vertices as filed.
    pub filed_vertices: usize,
    /// Faces as filed.
    pub filed_faces: usize,
    /// Vertices of the prepared mesh.
    pub vertices: usize,
    /// Faces of the prepared mesh; [`Model::filed_face`](crate::Model::filed_face) says whence each came.
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
    /// What 'the same place' meant for findings and repairs. Unit: length.
    pub weld_distance: f64,
    /// The prepared surface is proved to be the filed one within this distance, both ways. 0 where
    /// no vertex moved and no edge was split off its line. Unit: length.
    pub deviation: f64,
    /// How far the search for faces that meet went.
    pub meetings: MeetingScan,
    /// The flatness that was taken, relative to the largest coordinate magnitude: see
    /// [`Flatness`](crate::Flatness).
    pub flatness: f64,
    /// What is unusual and remains in the prepared mesh.
    pub findings: Vec<Finding>,
    /// What was mended, in order.
    pub repairs: Vec<RepairRecord>,
}

impl Report {
    /// Whether no finding limits any answer. Harmless ones (edges between faces in one plane, several
    /// shells) may remain.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.findings.iter().all(|finding| finding.kind.limits().is_empty())
    }

    /// Takes in what a scan found.
    pub(crate) fn take(&mut self, Scanned { findings, meetings, area }: Scanned) {
        (self.findings, self.meetings, self.area) = (findings, meetings, area);
    }

    /// Adds findings: what limits answers stays first, kind by kind.
    pub(crate) fn add(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.findings.extend(findings);
        self.findings.sort_by_key(|finding| (finding.kind.limits().is_empty(), finding.kind));
    }
}

/// How far the search for faces that cross, touch or overlap each other went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeetingScan {
    /// Not asked for: such faces are not reported.
    #[default]
    Skipped,
    /// Every pair was judged.
    Complete,
    /// Given up after so many pairs: there are more than the report lists.
    Stopped {
        /// Pairs judged.
        tests: usize,
    },
}

/// Something unusual, where it is and how large.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is.
    pub kind: FindingKind,
    /// What is concerned: numbers of the prepared mesh's vertices, faces or components, as
    /// [`FindingKind::element`] says. In a finding that sums up many, of the largest.
    pub ids: Vec<u32>,
    /// A point of it, in the body's frame.
    pub at: DVec3,
    /// Its size; [`FindingKind`] says which.
    pub measure: f64,
    /// How many such places this finding stands for; 1 but for kinds that are summed up.
    pub count: usize,
}

/// What the ids of a finding number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Element {
    /// Vertices.
    Vertex,
    /// Faces.
    Face,
    /// Components.
    Component,
}

impl Element {
    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Face => "face",
            Self::Component => "component",
        }
    }
}

/// Kinds of findings, and what is measured of each. Lengths unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum FindingKind {
    /// A face without area, exactly. Longest side.
    ZeroAreaFace,
    /// A face with area, no higher than the weld distance. Height over the longest side.
    NeedleFace,
    /// Faces on the same three vertices, wound alike. Area.
    DuplicateFaces,
    /// Faces on the same three vertices, some wound against the others. Area.
    OppositeFaces,
    /// Edges whose two faces lie in one plane, exactly, side by side: harmless, and so many that they
    /// are summed up. The longest such edge.
    CoplanarAdjacent,
    /// Two faces that lie in one plane, exactly, and share area. Size of the boxes' overlap.
    CoplanarOverlap,
    /// Two faces with an inner point in common, in planes that cross. Size of the boxes' overlap.
    SelfIntersection,
    /// Two faces that meet elsewhere than along what they share, without crossing. Size of the
    /// boxes' overlap.
    SelfTouch,
    /// An edge of one face. Its length.
    OpenEdge,
    /// An edge along which two faces run the same way. Its length.
    ContradictoryEdge,
    /// An edge of more than two faces. Its length.
    NonManifoldEdge,
    /// A vertex whose faces form several fans. How many fans.
    NonManifoldVertex,
    /// A vertex within the weld distance of the inside of an edge that is not matched: the vertex,
    /// then the ends of the edge. Distance from the edge.
    TVertex,
    /// Two vertices within the weld distance, not in the same place. Their distance.
    NearVertices,
    /// Faces that must be turned for their component to be consistently oriented. Their area.
    BackFaces,
    /// A component that cannot be oriented consistently (a Möbius strip). Its area.
    NonOrientable,
    /// A closed component, in no other, whose faces look inwards. Its volume, below 0.
    InsideOut,
    /// A closed component within another that looks inwards: a cavity of that. Its volume, below 0.
    Cavity,
    /// A closed component within another that looks outwards: a solid of its own. Its volume.
    NestedSolid,
    /// More than one component, summed up.
    SeveralShells,
    /// A side of the hull that faces cover more than once: caps there count negative. Strips no wider than
    /// [`slab_depth`](crate::features::Features::slab_depth) are not told. The vertices of these caps.
    /// Their area.
    NegativeCap,
    /// Such a side on which the rims of faces cross each other: its caps overlap. The corners of the
    /// side. How thick it is.
    CrossedCap,
    /// A closed body no thicker than [`slab_depth`](crate::features::Features::slab_depth) as a whole, so that either of
    /// its sides lies on the facets of both. The corners of its hull's largest side. The volume of the hull over its area,
    /// which is half the thickness of a plate.
    ThinBody,
}

const SURFACE: &str = "no containment, depth, area or mass: the component is a surface";

impl FindingKind {
    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ZeroAreaFace => "zero_area_face",
            Self::NeedleFace => "needle_face",
            Self::DuplicateFaces => "duplicate_faces",
            Self::OppositeFaces => "opposite_faces",
            Self::CoplanarAdjacent => "coplanar_adjacent",
            Self::CoplanarOverlap => "coplanar_overlap",
            Self::SelfIntersection => "self_intersection",
            Self::SelfTouch => "self_touch",
            Self::OpenEdge => "open_edge",
            Self::ContradictoryEdge => "contradictory_edge",
            Self::NonManifoldEdge => "non_manifold_edge",
            Self::NonManifoldVertex => "non_manifold_vertex",
            Self::TVertex => "t_vertex",
            Self::NearVertices => "near_vertices",
            Self::BackFaces => "back_faces",
            Self::NonOrientable => "non_orientable",
            Self::InsideOut => "inside_out",
            Self::Cavity => "cavity",
            Self::NestedSolid => "nested_solid",
            Self::SeveralShells => "several_shells",
            Self::NegativeCap => "negative_cap",
            Self::CrossedCap => "crossed_cap",
            Self::ThinBody => "thin_body",
        }
    }

    /// What it is and whence it comes, in a sentence for whoever looks at the mesh.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::ZeroAreaFace => "all three corners lie on one line",
            Self::NeedleFace => "a face no wider than what counts as the same place",
            Self::DuplicateFaces => "the same face filed more than once",
            Self::OppositeFaces => "the same face filed twice, looking both ways",
            Self::CoplanarAdjacent => "two faces that continue each other in one plane",
            Self::CoplanarOverlap => "two faces that lie on each other",
            Self::SelfIntersection => "two faces that pass through each other",
            Self::SelfTouch => "two faces that touch where they share no corner or edge",
            Self::OpenEdge => "an edge with a face on one side only: a hole, or a crack",
            Self::ContradictoryEdge => "an edge at which outside becomes inside",
            Self::NonManifoldEdge => "an edge at which more than two faces meet",
            Self::NonManifoldVertex => "a vertex in which separate parts of the surface touch",
            Self::TVertex => "a vertex on an edge that the face beside it does not divide",
            Self::NearVertices => "two vertices that are nearly the same place",
            Self::BackFaces => "faces that look the other way than their neighbours",
            Self::NonOrientable => "a surface with one side only",
            Self::InsideOut => "a closed part whose faces all look inwards",
            Self::Cavity => "a hollow within another part",
            Self::NestedSolid => "a solid part within another",
            Self::SeveralShells => "parts that share no edge",
            Self::NegativeCap => {
                "a side of the hull that faces cover twice: the mesh lies upon itself there, or folds back"
            }
            Self::CrossedCap => {
                "a side of the hull on which faces overlap without a common vertex: the mesh passes through itself there"
            }
            Self::ThinBody => {
                "a body that is as good as flat: no thicker than what counts as one side"
            }
        }
    }

    /// What the ids of such a finding number.
    #[must_use]
    pub fn element(self) -> Element {
        match self {
            Self::NonManifoldVertex
            | Self::TVertex
            | Self::NearVertices
            | Self::NegativeCap
            | Self::CrossedCap
            | Self::ThinBody => Element::Vertex,
            Self::NonOrientable
            | Self::InsideOut
            | Self::Cavity
            | Self::NestedSolid
            | Self::SeveralShells => Element::Component,
            _ => Element::Face,
        }
    }

    /// What a finding of this kind means for answers; empty where it limits nothing.
    #[must_use]
    pub fn limits(self) -> &'static [&'static str] {
        match self {
            Self::ZeroAreaFace
            | Self::NeedleFace
            | Self::CoplanarAdjacent
            | Self::NonManifoldVertex
            | Self::NearVertices
            | Self::SeveralShells
            | Self::Cavity => &[],
            Self::OpenEdge | Self::ContradictoryEdge | Self::NonOrientable => &[SURFACE],
            Self::TVertex => &["the edge stays open there: the component is a surface"],
            Self::NonManifoldEdge => &[
                "regions may be split or joined at the edge: which faces follow each other is open",
            ],
            Self::DuplicateFaces | Self::CoplanarOverlap => {
                &["area and volume count what lies twice in one place twice"]
            }
            Self::OppositeFaces => &["the sheet is touched from both sides; it bounds no volume"],
            Self::SelfIntersection => &[
                "volume, mass, depth and contact regions count the overlap as often as it is enclosed",
            ],
            Self::SelfTouch => &["contact regions may be split or joined there"],
            Self::BackFaces => &["normals of contacts on these faces point the wrong way", SURFACE],
            Self::InsideOut => {
                &["the component counts as negative volume; normals of its contacts point inwards"]
            }
            Self::NegativeCap => &[
                "a lid's area is less than what it covers by what is covered too often; volumes are right to within a few slabs",
            ],
            Self::CrossedCap => &[
                "a point there may lie beneath several lids, so more is opened than need be; volumes are right to within a few slabs",
            ],
            Self::ThinBody => &[
                "whole sides may count as skin, and which of them a face lies on is open: hull, faces and lids need not add up",
            ],
            Self::NestedSolid => &[
                "its volume counts twice where material surrounds it: once of its own, once of the part around it",
            ],
        }
    }
}

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

impl std::fmt::Display for RepairRecord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let moved = self.moved;
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
                "{vertices} on open edges near another: welded to it (moved by up to {moved:.3e})"
            ),
            RepairKind::SplitEdges => write!(
                f,
                "edges were split at {vertices} within them (up to {moved:.3e} off the edge)"
            ),
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
