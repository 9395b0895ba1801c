//! Kinds of findings: what each is, measures and means for answers.

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
    /// Edges whose two faces lie in one plane, exactly, side by side: harmless, and so many that
    /// they are summed up. The longest such edge.
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
    /// More than one component, summed up: a face of each. Diagonal of the box of all.
    SeveralShells,
    /// A side of the hull that faces cover more than once: caps there count negative. Strips no
    /// wider than the slab depth (`cranny_concavity::Features::slab_depth`) are not reported. The
    /// vertices of these caps. Their area.
    NegativeCap,
    /// Such a side on which the rims of faces cross each other: its caps overlap. The corners of
    /// the side. How thick it is.
    CrossedCap,
    /// A closed body whose hull has no more volume for its area than the slab depth
    /// (`cranny_concavity::Features::slab_depth`): a plate of about twice that thickness or less,
    /// so that faces of either side may count as lying on the facets of both. The corners of its
    /// hull's largest side. The volume of the hull over its area, which is half the thickness of a
    /// plate.
    ThinBody,
}

const SURFACE: &str = "no containment, depth, area or mass: the component is a surface";
const ONE_SIDED: &str = "a solver keeps bodies off its faces on the side from which their corners run counter-clockwise; from the other side only primitives are held, as a Ball is";

impl FindingKind {
    /// Every kind, in order.
    pub const ALL: [Self; 23] = [
        Self::ZeroAreaFace,
        Self::NeedleFace,
        Self::DuplicateFaces,
        Self::OppositeFaces,
        Self::CoplanarAdjacent,
        Self::CoplanarOverlap,
        Self::SelfIntersection,
        Self::SelfTouch,
        Self::OpenEdge,
        Self::ContradictoryEdge,
        Self::NonManifoldEdge,
        Self::NonManifoldVertex,
        Self::TVertex,
        Self::NearVertices,
        Self::BackFaces,
        Self::NonOrientable,
        Self::InsideOut,
        Self::Cavity,
        Self::NestedSolid,
        Self::SeveralShells,
        Self::NegativeCap,
        Self::CrossedCap,
        Self::ThinBody,
    ];

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
                "a body so thin that its sides are hard to tell apart: its hull has no more volume for its area than a plate twice as thick as what counts as lying on the hull"
            }
        }
    }

    /// What the ids of such a finding name, and in which order.
    #[must_use]
    pub fn concerned(self) -> &'static str {
        match self {
            Self::ZeroAreaFace | Self::NeedleFace => "the face",
            Self::DuplicateFaces | Self::OppositeFaces => "the faces in one place, ascending",
            Self::CoplanarAdjacent => "the two faces at the longest such edge",
            Self::CoplanarOverlap | Self::SelfIntersection | Self::SelfTouch => {
                "the two faces, ascending"
            }
            Self::OpenEdge => "the face at the edge",
            Self::ContradictoryEdge | Self::NonManifoldEdge => {
                "the faces at the edge, one for each of their sides along it, ascending"
            }
            Self::NonManifoldVertex => "the vertex",
            Self::TVertex => "the vertex, then the two ends of the edge",
            Self::NearVertices => "the two vertices",
            Self::BackFaces => "the faces to be turned",
            Self::NonOrientable => "the component",
            Self::InsideOut => "the component",
            Self::Cavity | Self::NestedSolid => {
                "the component, then those that it lies in, ascending"
            }
            Self::SeveralShells => "the first face of each component, in the order of components",
            Self::NegativeCap => "the corners of the caps, ascending",
            Self::CrossedCap => "the corners of the side, ascending",
            Self::ThinBody => "the corners of the hull's largest side, ascending",
        }
    }

    /// What such a finding measures, and in which unit.
    #[must_use]
    pub fn measured(self) -> &'static str {
        match self {
            Self::ZeroAreaFace => "length of the longest side",
            Self::NeedleFace => "length: height over the longest side",
            Self::DuplicateFaces | Self::OppositeFaces => "area of the face",
            Self::CoplanarAdjacent => "length of the longest such edge",
            Self::CoplanarOverlap | Self::SelfIntersection | Self::SelfTouch => {
                "length: diagonal of what the faces' boxes share"
            }
            Self::OpenEdge | Self::ContradictoryEdge | Self::NonManifoldEdge => {
                "length of the edge"
            }
            Self::NonManifoldVertex => "a number without unit: how many fans of faces meet there",
            Self::TVertex => "length: distance of the vertex from the edge",
            Self::NearVertices => "length: distance of the two",
            Self::BackFaces => "area of these faces",
            Self::NonOrientable => "area of the component",
            Self::InsideOut | Self::Cavity => "volume of the component, below 0",
            Self::NestedSolid => "volume of the component",
            Self::SeveralShells => "length: diagonal of the box of all",
            Self::NegativeCap => "area of these caps",
            Self::CrossedCap => "length: how thick the side is",
            Self::ThinBody => {
                "length: volume of the hull over its area, half the thickness of a plate"
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
            Self::NonOrientable | Self::InsideOut | Self::Cavity | Self::NestedSolid => {
                Element::Component
            }
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
            Self::OpenEdge => &[SURFACE, ONE_SIDED],
            Self::ContradictoryEdge | Self::NonOrientable => &[SURFACE],
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_there_once_and_in_order() {
        for (place, kind) in FindingKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, place, "{kind:?}");
        }
        assert_eq!(FindingKind::ALL.last(), Some(&FindingKind::ThinBody), "the last that there is");
    }
}
