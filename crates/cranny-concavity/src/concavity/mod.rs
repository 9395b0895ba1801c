//! Concavities: what the hull covers and the mesh does not fill.
//!
//! A *concavity* is a set of off-hull faces that hang together, over shared edges and over the cap
//! that closes them. Its *cap* is the part of the hull above it, and falls into *lids*, connected
//! pieces: a dent has one, a through-hole two, a void inside the body none. Several shells share a
//! concavity when they share a cap. Cap and faces, the faces turned around, bound the *pocket*; it
//! has no boundary as far as the mesh has none.
//!
//! Volumes and areas add up: what the hull has and the body lacks is the pockets and the *skin*,
//! which is what lies between the hull and faces that are on it but for rounding. Where a whole
//! body is no thicker than skin, either side lies on the facets of both, and they need not
//! ([`FindingKind::ThinBody`](cranny_geometry::FindingKind::ThinBody)).
//!
//! Cost: O(n log n), near linear where most faces are far from any rim.
//!
//! No source: these definitions are this crate's own. That pockets close follows from the algebra
//! of chains (Munkres 1984, sections 5 and 6): caps and faces off the hull have the same boundary,
//! see `caps`.

mod build;
mod components;
mod followed;
mod input;
mod nesting;
mod region;
mod skin;
mod splice;
mod sums;
mod update;
mod validate;
mod whole;

use cranny_exact::DVec3;

use crate::boundary::Loops;
use crate::caps::CapSurface;
use crate::features::NONE;
use crate::ids::{CapId, ConcavityId, LidId};
use cranny_geometry::hull::FacetId;
use cranny_geometry::{FaceId, VertexId};
pub use followed::{ConcavityChange, ConcavityWork, FollowedConcavities};
use splice::Disturbance;
use sums::SurfaceSums;
pub use whole::Concavities;

/// What a concavity is, by its lids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ConcavityKind {
    /// One lid: a dent, a groove, a well.
    Pocket,
    /// Several lids: a through-hole, say. Also where two notches have nothing in common but an edge
    /// of the mesh, which four faces share: faces hang together over it, though nothing passes
    /// through (two cubes that touch along an edge).
    Passage,
    /// No lid, and air within: a bubble inside a body. The shell around it is a finding, too, by
    /// itself ([`Cavity`](cranny_geometry::FindingKind::Cavity)).
    Void,
    /// No lid, and matter within, or a surface that bounds nothing: a separate piece inside a
    /// concavity, or anywhere off the hull. A solid inside the matter of another is one too,
    /// without a parent, as no air is around it; reports list it as
    /// [`NestedSolid`](cranny_geometry::FindingKind::NestedSolid).
    Island,
    /// A lid without faces beneath: the mesh is open there, and only faces on the hull border it.
    Opening,
    /// No faces of its own, where the hull is covered more than once (a face filed twice, coplanar
    /// faces that overlap): what would be a lid has negative area.
    Overlay,
}

impl ConcavityKind {
    /// As written in reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Pocket => "pocket",
            Self::Passage => "passage",
            Self::Void => "void",
            Self::Island => "island",
            Self::Opening => "opening",
            Self::Overlay => "overlay",
        }
    }
}

/// What covers a facet of the hull.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Faces of the mesh, everywhere.
    Solid,
    /// A lid of this concavity, everywhere.
    Lid(ConcavityId),
    /// Faces of the mesh, but for cap triangles, each of which names its concavity: these, and
    /// where the facet is covered together with others theirs as well
    /// ([`ConcavitySet::caps_over`]).
    Mixed(std::ops::Range<u32>),
}

/// What an edge of a boundary loop borders on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Border {
    /// A convex face.
    Convex,
    /// Another concavity, across a ridge on the hull.
    Ridge,
    /// Nothing: the mesh is open, or contradicts itself.
    Open,
}

/// A stage in making [`Concavities`]. Callers measure times; this crate reads no clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Features: convex, concavity, boundary.
    Classify,
    /// Caps, concavities, boundary loops.
    Caps,
    /// A box tree for each concavity.
    Trees,
    /// Envelopes of concavities.
    Envelopes,
    /// All done.
    Done,
}

/// All concavities of a body, and the cap surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ConcavitySet {
    records: Vec<Record>,
    faces: Vec<FaceId>,
    concavity_of_face: Vec<u32>,
    caps: CapSurface,
    /// Cap triangles by concavity, then lid.
    cap_order: Vec<CapId>,
    concavity_of_cap: Vec<u32>,
    lid_of_cap: Vec<u32>,
    lids: Vec<LidRecord>,
    loops: Loops,
    borders: Vec<Border>,
    outlines: Loops,
    outline_facets: Vec<FacetId>,
    cover: Vec<u32>,
    skin: Skin,
}

/// What lies between the hull and the faces on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Skin {
    /// Volume, signed. Unit: length^3.
    pub volume: f64,
    /// Area of the hull there minus that of the faces. Unit: length^2.
    pub area: f64,
    /// Number of cap triangles that belong to no concavity: needles between faces on the hull.
    pub caps: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Record {
    kind: ConcavityKind,
    parent: u32,
    first_face: u32,
    first_cap: u32,
    first_lid: u32,
    first_loop: u32,
    measures: Measures,
}

/// Sizes of a concavity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// Area of the cap; where a facet is covered twice, less. Unit: length^2.
    pub cap_area: f64,
    /// Area of the faces.
    pub face_area: f64,
    /// Volume between cap and faces: negative for a piece of matter. It means nothing where
    /// [`Report::volumes_unknown`](cranny_geometry::Report::volumes_unknown) says why. Unit:
    /// length^3.
    pub pocket_volume: f64,
    /// Sum of the area vectors of the cap, outward: the direction in which the concavity opens, its
    /// length the area of the opening seen from there. Zero, to rounding, for a through-hole
    /// between parallel sides.
    pub opening: DVec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct LidRecord {
    concavity: ConcavityId,
    first_cap: u32,
    first_outline: u32,
    area: f64,
    opening: DVec3,
}

/// A concavity: faces off the hull and the cap that closes them.
#[derive(Clone, Copy, Debug)]
pub struct Concavity<'a> {
    all: &'a ConcavitySet,
    id: ConcavityId,
    /// What it is.
    pub kind: ConcavityKind,
    /// Of a concavity without a lid, the one whose pocket (or matter) surrounds it most closely, if
    /// any.
    pub parent: Option<ConcavityId>,
    /// Its faces, ascending.
    pub faces: &'a [FaceId],
    /// Its cap triangles, lid by lid.
    pub caps: &'a [CapId],
    /// Its sizes.
    pub measures: Measures,
}

impl<'a> Concavity<'a> {
    /// Its id.
    #[must_use]
    pub fn id(&self) -> ConcavityId {
        self.id
    }

    /// Its lids.
    pub fn lids(&self) -> impl ExactSizeIterator<Item = Lid<'a>> + use<'a> {
        let all = self.all;
        let next = all.record_end(self.id, |r| r.first_lid, all.lids.len());
        (all.records[self.id.index()].first_lid..next).map(|lid| all.lid(LidId(lid)))
    }

    /// Its boundary loops, by their lowest vertices: the edges of its faces that border on
    /// something else, run as these faces run them. All are simple.
    pub fn loops(&self) -> impl ExactSizeIterator<Item = BoundaryLoop<'a>> + use<'a> {
        let all = self.all;
        let next = all.record_end(self.id, |r| r.first_loop, all.loops.len());
        (all.records[self.id.index()].first_loop..next).map(|i| {
            let row = all.loops.row(i as usize);
            BoundaryLoop {
                vertices: &all.loops.vertices[row.clone()],
                borders: &all.borders[row.clone()],
                touches: &all.loops.touches[row],
            }
        })
    }
}

/// A connected piece of a concavity's cap.
#[derive(Clone, Copy, Debug)]
pub struct Lid<'a> {
    all: &'a ConcavitySet,
    id: LidId,
    /// Whose lid it is.
    pub concavity: ConcavityId,
    /// Its triangles, ascending.
    pub caps: &'a [CapId],
    /// Its area. Unit: length^2.
    pub area: f64,
    /// Sum of its area vectors, outward.
    pub opening: DVec3,
}

impl<'a> Lid<'a> {
    /// Its id.
    #[must_use]
    pub fn id(&self) -> LidId {
        self.id
    }

    /// Its polygons, facet by facet: loops counter-clockwise around the lid seen from outside,
    /// clockwise around its holes.
    pub fn outlines(&self) -> impl ExactSizeIterator<Item = (FacetId, &'a [VertexId])> + use<'a> {
        let all = self.all;
        let next = all.lids.get(self.id.index() + 1).map(|l| l.first_outline as usize);
        let first = all.lids[self.id.index()].first_outline as usize;
        (first..next.unwrap_or(all.outlines.len()))
            .map(|i| (all.outline_facets[i], &all.outlines.vertices[all.outlines.row(i)]))
    }
}

/// A simple closed loop along the boundary of a concavity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryLoop<'a> {
    /// Its vertices, in order, the lowest first.
    pub vertices: &'a [VertexId],
    /// What the edge from each vertex to the next borders on.
    pub borders: &'a [Border],
    /// Whether the concavity's boundary passes the vertex more than once: loops touch there.
    pub touches: &'a [bool],
}

/// A triangle of the cap surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapTriangle {
    /// Corners, vertices of the mesh; counter-clockwise seen from outside, unless the triangle is
    /// negative.
    pub corners: [VertexId; 3],
    /// The facet that it lies on.
    pub facet: FacetId,
    /// The concavity beneath; `None` for skin.
    pub concavity: Option<ConcavityId>,
    /// Its lid; `None` for skin.
    pub lid: Option<LidId>,
}

impl ConcavitySet {
    /// Number of concavities, openings and voids included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// A concavity (`0..len`). Those with faces come first, by their least face.
    ///
    /// # Panics
    ///
    /// Where there is no such concavity; so do the functions below for their ids.
    #[must_use]
    pub fn get(&self, id: ConcavityId) -> Concavity<'_> {
        let r = &self.records[id.index()];
        let face_end = self.record_end(id, |r| r.first_face, self.faces.len());
        let cap_end = self.record_end(id, |r| r.first_cap, self.cap_order.len());
        Concavity {
            all: self,
            id,
            kind: r.kind,
            parent: (r.parent != NONE).then_some(ConcavityId(r.parent)),
            faces: &self.faces[r.first_face as usize..face_end as usize],
            caps: &self.cap_order[r.first_cap as usize..cap_end as usize],
            measures: r.measures,
        }
    }

    /// All of them, by id.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Concavity<'_>> {
        (0..self.len() as u32).map(|i| self.get(ConcavityId(i)))
    }

    /// The concavity of a face; `None` of a convex one.
    #[must_use]
    pub fn of_face(&self, face: FaceId) -> Option<ConcavityId> {
        let concavity = self.concavity_of_face[face.index()];
        (concavity != NONE).then_some(ConcavityId(concavity))
    }

    /// Number of cap triangles.
    #[must_use]
    pub fn cap_count(&self) -> usize {
        self.caps.triangles.len()
    }

    /// A cap triangle (`0..cap_count`). They are numbered facet by facet.
    #[must_use]
    pub fn cap(&self, id: CapId) -> CapTriangle {
        let (concavity, lid) = (self.concavity_of_cap[id.index()], self.lid_of_cap[id.index()]);
        CapTriangle {
            corners: self.caps.triangles[id.index()].map(VertexId),
            facet: self.caps.facet_of(id),
            concavity: (concavity != NONE).then_some(ConcavityId(concavity)),
            lid: (lid != NONE).then_some(LidId(lid)),
        }
    }

    /// The corners of a cap triangle, and nothing else of it.
    pub(crate) fn corners_of_cap(&self, id: CapId) -> [VertexId; 3] {
        self.caps.triangles[id.index()].map(VertexId)
    }

    /// All cap triangles, by id.
    pub fn caps(&self) -> impl ExactSizeIterator<Item = CapTriangle> + '_ {
        (0..self.cap_count() as u32).map(|c| self.cap(CapId(c)))
    }

    /// Number of lids, of all concavities.
    #[must_use]
    pub fn lid_count(&self) -> usize {
        self.lids.len()
    }

    /// A lid (`0..lid_count`). They are numbered concavity by concavity.
    #[must_use]
    pub fn lid(&self, id: LidId) -> Lid<'_> {
        let r = &self.lids[id.index()];
        // Behind the last lid's triangles come those of the skin.
        let skinless = self.cap_order.len();
        let end = self.lids.get(id.index() + 1).map_or(skinless, |next| next.first_cap as usize);
        Lid {
            all: self,
            id,
            concavity: r.concavity,
            caps: &self.cap_order[r.first_cap as usize..end],
            area: r.area,
            opening: r.opening,
        }
    }

    /// What covers a facet of the hull. O(1).
    #[must_use]
    pub fn cover(&self, facet: FacetId) -> Cover {
        match self.cover[facet.index()] {
            SOLID => Cover::Solid,
            MIXED => Cover::Mixed(self.caps.of_facet(facet)),
            concavity => Cover::Lid(ConcavityId(concavity)),
        }
    }

    /// The cap triangles that may lie over a facet: its own, and those of the facets that it is
    /// covered together with. A triangle of the mesh may lie on two facets where these meet at an
    /// angle that is rounding; such facets are covered together, exactly once, but not each by
    /// itself.
    pub fn caps_over(&self, facet: FacetId) -> impl Iterator<Item = CapId> + '_ {
        let others = self.caps.sharing(facet).filter(move |&f| f != facet);
        let theirs = others.flat_map(|f| self.caps.of_facet(f));
        self.caps.of_facet(facet).chain(theirs).map(CapId)
    }

    /// The facets that are covered together with others: each with the first of its group,
    /// ascending.
    pub fn shared_facets(&self) -> impl Iterator<Item = [FacetId; 2]> + '_ {
        self.caps.shared.iter().map(|entry| entry.map(FacetId))
    }

    /// What lies between the hull and the faces on it.
    #[must_use]
    pub fn skin(&self) -> Skin {
        self.skin
    }

    /// Cap triangles that count negative: faces cover the hull twice there.
    #[must_use]
    pub fn negative_caps(&self) -> &[CapId] {
        &self.caps.negative
    }

    /// Facets whose cap may cover some points twice and others not, because its outline crosses
    /// itself: faces overlap there, or rounding did it.
    #[must_use]
    pub fn crossed_facets(&self) -> &[FacetId] {
        &self.caps.crossed
    }

    /// With nothing but the concavities of faces, and caps that belong to none.
    fn blank(concavity_of_face: Vec<u32>, caps: CapSurface) -> Self {
        Self {
            records: Vec::new(),
            faces: Vec::new(),
            concavity_of_face,
            cap_order: Vec::new(),
            concavity_of_cap: vec![NONE; caps.triangles.len()],
            lid_of_cap: vec![NONE; caps.triangles.len()],
            caps,
            lids: Vec::new(),
            loops: Loops::new(),
            borders: Vec::new(),
            outlines: Loops::new(),
            outline_facets: Vec::new(),
            cover: Vec::new(),
            skin: Skin::default(),
        }
    }

    fn record_end(&self, id: ConcavityId, of: impl Fn(&Record) -> u32, all: usize) -> u32 {
        self.records.get(id.index() + 1).map_or(all as u32, of)
    }
}

/// In [`ConcavitySet::cover`]: no cap triangle.
const SOLID: u32 = u32::MAX;

/// In [`ConcavitySet::cover`]: some cap triangles, not all of one concavity, or faces as well.
const MIXED: u32 = u32::MAX - 1;
