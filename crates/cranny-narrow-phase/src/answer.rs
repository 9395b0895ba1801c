//! What is answered about a pair.

use std::ops::AddAssign;

use cranny_exact::{DVec3, Interval, Meeting, RigidMap};
use cranny_geometry::triangle_distance::Part;
use cranny_geometry::{EdgeId, FaceId, HalfEdgeId, Model, Topology, VertexId};

use crate::penetration::Penetration;

/// How the two triangle surfaces meet: exact.
///
/// [`Meeting::Cross`]: some triangle pair shares a point interior to both; [`Meeting::Touch`]: they
/// share other points only, co-planar overlap included.
pub type Surface = Meeting;

/// All that a query wants to know about a pair, in world coordinates and in the caller's order.
///
/// Every field is a pure function of models, poses and query, but [`counters`](Self::counters), and
/// the names of [regions](Region::id).
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// How the surfaces meet.
    pub surface: Surface,
    /// Whether the bodies share interior points; a surface (a component that is not closed) counts
    /// where it enters a closed solid or crosses another surface.
    pub solid: bool,
    /// One wholly inside the other; the surfaces may touch. The outer one must be
    /// [closed](cranny_geometry::Model::is_closed); the inner one may be anything: an open sheet in
    /// a closed cube counts. Bodies that coincide contain neither the other.
    ///
    /// Closed is what every edge says, not volume: a triangle with both its sides is a closed body
    /// of volume 0. It lies in others and nothing lies in it; but what lies flush on it counts as
    /// `solid`, since one of the sides looks the same way.
    pub contained: Option<Containment>,
    /// Least distance between the surfaces: 0 where they meet, also >= 0 when contained. `None` if
    /// not demanded; [`f64::INFINITY`] if it is no less than the demanded bound.
    pub distance: Option<f64>,
    /// Where the distance is known to lie: the rounding error of `distance` taken outward.
    pub separation: Interval,
    /// Points that are [`distance`](Self::distance) apart: on A, on B. Of several such pairs of
    /// faces, the one of least ids is taken, counted from the body that comes first in the pair's
    /// own order. `None` where no distance is demanded, or none is found below its bound, and where
    /// surfaces cross: any crossing proves that the distance is 0, and one that does not depend on
    /// memory takes a search of its own, [`common_point`](crate::operations::common_point).
    pub witnesses: Option<[Witness; 2]>,
    /// Contacts for a solver, each with its own normal.
    pub contacts: Vec<Contact>,
    /// Connected regions of contact, overlapping ones first.
    pub regions: Vec<Region>,
    /// How deep two closed solids overlap, a region each, where a contact is as deep as
    /// [`Query::penetrations_from`](crate::Query::penetrations_from) says; else empty.
    pub penetrations: Vec<Penetration>,
    /// Triangle pairs that meet.
    pub triangle_pairs: u32,
    /// What it cost.
    pub counters: Counters,
}

/// One body wholly inside another's closed solid, see [`Answer::contained`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Containment {
    /// A lies inside B.
    AInB,
    /// B lies inside A.
    BInA,
}

impl Containment {
    /// With the bodies' names exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        match self {
            Self::AInB => Self::BInA,
            Self::BInA => Self::AInB,
        }
    }
}

/// A point of a body's surface and the feature that holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// World coordinates.
    pub point: DVec3,
    /// Least feature that holds it.
    pub feature: Feature,
}

/// A vertex, edge or face of a model's mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// A vertex.
    Vertex(VertexId),
    /// An edge, its ends left out.
    Edge(EdgeId),
    /// A face, its edges left out.
    Face(FaceId),
}

impl Feature {
    /// The model's name for a part of a face.
    #[must_use]
    pub fn of_part(part: Part, model: &Model, face: FaceId) -> Self {
        match part {
            Part::Corner(i) => Self::Vertex(model.mesh().corners(face)[usize::from(i)]),
            Part::Edge(i) => {
                let side = HalfEdgeId::of(face, usize::from(i));
                Self::Edge(model.topology().edge_of(side))
            }
            Part::Inside => Self::Face(face),
        }
    }

    /// The faces that have it.
    pub(crate) fn faces(self, topology: &Topology) -> Vec<FaceId> {
        match self {
            Self::Vertex(vertex) => topology.faces_at(vertex).to_vec(),
            Self::Edge(edge) => topology.half_edges(edge).iter().map(|h| h.face()).collect(),
            Self::Face(face) => vec![face],
        }
    }
}

/// A pair of points where the bodies meet or nearly do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The features that make it, on A and on B: stable from frame to frame.
    pub id: (Feature, Feature),
    /// On A's surface, world coordinates.
    pub point_a: DVec3,
    /// On B's surface.
    pub point_b: DVec3,
    /// Unit, from A to B, at this very point.
    pub normal: DVec3,
    /// Along the normal: > 0 apart, < 0 overlapping.
    pub separation: f64,
}

impl Contact {
    /// Of surfaces that share a point.
    pub(crate) fn touching(id: (Feature, Feature), point: DVec3, normal: DVec3) -> Self {
        Self { id, point_a: point, point_b: point, normal, separation: 0.0 }
    }

    /// With the bodies' names exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self {
            id: (self.id.1, self.id.0),
            point_a: self.point_b,
            point_b: self.point_a,
            normal: -self.normal,
            separation: self.separation,
        }
    }
}

/// Names a region of a pair for as long as it lasts: from 0, never used twice by one memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegionId(pub u32);

/// A connected region of contact.
///
/// Two are equal that are the same place: [`id`](Self::id) and [`from`](Self::from) are history,
/// and are not compared.
#[derive(Clone, Debug)]
pub struct Region {
    /// Stays the same from query to query with one memory while the region lasts. Of a region that
    /// splits, the part with most pairs of faces in common keeps it; of regions that merge, so does
    /// that one's.
    pub id: RegionId,
    /// The regions of the last query of which it has a share, ascending: itself alone while nothing
    /// happens, none where it is new, several where they merged.
    pub from: Vec<RegionId>,
    /// The pairs of faces, of A and of B, that meet in it, or that hold the features of its
    /// contacts where it lies across a gap; ascending. Of special positions (faces flush, edges
    /// crossing edges), those that meet right beside it.
    pub faces: Vec<[FaceId; 2]>,
    /// The contact of least separation.
    pub deepest: Contact,
    /// Unit, from A to B: direction of the area that the region's curves enclose, or another where
    /// that takes several times farther to part it; of the deepest contact where no short
    /// translation parts it, and where there are no curves. It describes the region; contacts have
    /// normals of their own.
    pub normal: DVec3,
    /// The least translation along `normal` that parts the two surface pieces that the curves cut
    /// out; of pieces that no short one parts, as of a tongue that a slot squeezes from both sides,
    /// how deep the deepest vertex or middle of a face lies. 0 where they only touch, `None` where
    /// the bodies are apart or a surface is open.
    pub depth: Option<f64>,
    /// Area enclosed by the curves, projected onto the plane of `normal`; `None` as for `depth`.
    pub area: Option<f64>,
    /// Contacts that represent the region's extent, deepest first.
    pub points: Vec<Contact>,
    /// Where the surfaces intersect.
    pub curves: Vec<Curve>,
    /// Triangle pairs that meet in this region.
    pub triangle_pairs: u32,
}

impl PartialEq for Region {
    fn eq(&self, other: &Self) -> bool {
        self.place() == other.place()
    }
}

impl Region {
    /// All but its history.
    fn place(&self) -> impl PartialEq {
        let Self {
            id: _,
            from: _,
            faces,
            deepest,
            normal,
            depth,
            area,
            points,
            curves,
            triangle_pairs,
        } = self;
        (faces, deepest, normal, depth, area, points, curves, triangle_pairs)
    }

    /// With the bodies' names exchanged.
    #[must_use]
    pub fn swapped(mut self) -> Self {
        self.faces.iter_mut().for_each(|faces| faces.reverse());
        self.faces.sort_unstable();
        self.deepest = self.deepest.swapped();
        self.normal = -self.normal;
        self.points.iter_mut().for_each(|point| *point = point.swapped());
        self
    }
}

/// A polyline in which the surfaces intersect.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// In order, world coordinates; the first point is not repeated at the end.
    pub points: Vec<DVec3>,
    /// The last point is joined to the first.
    pub closed: bool,
}

/// Work done for an answer. No hash includes them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Directions along which the two hulls were compared, two support points each.
    pub planes_tried: u64,
    /// Queries for which a plane was found that parts the hulls as far as was demanded.
    pub planes_parted: u64,
    /// Pairs of tree nodes compared, of the search tree each of eight side by side.
    pub node_tests: u64,
    /// Pairs of clusters compared, of which the faces or features may be near each other. No
    /// elementary test: each stands for up to 64 pairs of faces, which are compared eight at once.
    pub cluster_tests: u64,
    /// Pairs of triangles classified exactly or measured: the sum of the next two, and of those of
    /// which only the distance was demanded.
    pub triangle_tests: u64,
    /// Pairs of triangles whose meeting or parting plain floating point settled, by a gap larger
    /// than its error or by signs of determinants larger than theirs.
    pub triangles_filtered: u64,
    /// Pairs of triangles of which some sign was too near zero for that: adaptive arithmetic
    /// decided it.
    pub triangles_adaptive: u64,
    /// Points classified against a solid.
    pub inside_tests: u64,
    /// Boxes at which the last search had ended, and which had to be tested again: motion had spent
    /// their slack.
    pub front_tested: u64,
    /// Of these, boxes that had come within reach.
    pub front_split: u64,
    /// Cuts that were given up: outrun by motion, outgrown by the demand, or grown too fine.
    pub front_rebuilt: u64,
    /// Blocks of eight boxes fewer than before, where a cut was built anew.
    pub front_merged: u64,
    /// Blocks of eight boxes kept for the next query.
    pub front_held: u64,
    /// Times that a search from the top was cheaper than what memory had to offer.
    pub bypassed: u64,
    /// Concavities whose faces were looked for, since the other body's hull may reach them; this
    /// and what follows is counted by [`Method::Envelopes`](crate::Method::Envelopes) only.
    pub pockets_opened: u64,
    /// Concavities whose box overlaps that of the other hull, but none of whose faces the hull
    /// reaches: it is beyond a lid, its box misses theirs, it is in the core of the pocket, or
    /// offends no facet of the first layer.
    pub pockets_passed: u64,
    /// Facets of envelopes that a box was held against.
    pub facets_compared: u64,
    /// Models whose concavities were made: by the first query of a pair that needs them, of two
    /// bodies of one model once.
    pub concavities_made: u64,
}

impl Counters {
    /// Elementary tests of all kinds: of directions, boxes, faces and points.
    #[must_use]
    pub fn tests(&self) -> u64 {
        self.planes_tried
            + self.node_tests
            + self.front_tested
            + self.facets_compared
            + self.triangle_tests
            + self.inside_tests
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.planes_tried += other.planes_tried;
        self.planes_parted += other.planes_parted;
        self.node_tests += other.node_tests;
        self.cluster_tests += other.cluster_tests;
        self.triangle_tests += other.triangle_tests;
        self.triangles_filtered += other.triangles_filtered;
        self.triangles_adaptive += other.triangles_adaptive;
        self.inside_tests += other.inside_tests;
        self.front_tested += other.front_tested;
        self.front_split += other.front_split;
        self.front_rebuilt += other.front_rebuilt;
        self.front_merged += other.front_merged;
        self.front_held += other.front_held;
        self.bypassed += other.bypassed;
        self.pockets_opened += other.pockets_opened;
        self.pockets_passed += other.pockets_passed;
        self.facets_compared += other.facets_compared;
        self.concavities_made += other.concavities_made;
    }
}

impl Answer {
    /// An answer that says nothing: what [`Demand::None`](crate::Demand) gets.
    #[must_use]
    pub fn nothing() -> Self {
        Self {
            surface: Surface::None,
            solid: false,
            contained: None,
            distance: None,
            separation: Interval::WHOLE,
            witnesses: None,
            contacts: Vec::new(),
            regions: Vec::new(),
            penetrations: Vec::new(),
            triangle_pairs: 0,
            counters: Counters::default(),
        }
    }

    /// Whether the bodies share a point, or one lies inside the other.
    #[must_use]
    pub fn touches(&self) -> bool {
        self.solid || self.surface.meets()
    }

    /// How deep the bodies overlap, >= 0, as far as the demand says: the greatest depth of a region
    /// or a contact. The two may differ: a region is measured along its own normal, a contact along
    /// that of its point. 0 where nothing overlaps, and for a body wholly within another.
    #[must_use]
    pub fn depth(&self) -> f64 {
        let of_regions = self.regions.iter().map(|r| r.depth.unwrap_or(-r.deepest.separation));
        let of_contacts = self.contacts.iter().map(|contact| -contact.separation);
        of_regions.chain(of_contacts).fold(0.0, f64::max)
    }

    /// The same answer with the bodies' names exchanged.
    #[must_use]
    pub fn swapped(mut self) -> Self {
        self.contained = self.contained.map(Containment::swapped);
        self.witnesses = self.witnesses.map(|[a, b]| [b, a]);
        self.contacts.iter_mut().for_each(|contact| *contact = contact.swapped());
        self.regions = self.regions.into_iter().map(Region::swapped).collect();
        self.penetrations = self.penetrations.into_iter().map(Penetration::swapped).collect();
        self
    }

    /// The same answer in another frame: every point and direction is moved. Lengths stay.
    #[must_use]
    pub fn moved(mut self, map: &RigidMap) -> Self {
        let place = |p: &mut DVec3| *p = map.apply(*p);
        let contact = |contact: &mut Contact| *contact = contact.moved(map);
        self.witnesses.iter_mut().flatten().for_each(|witness| place(&mut witness.point));
        self.contacts.iter_mut().for_each(contact);
        self.penetrations.iter_mut().for_each(|it| *it = it.moved(map));
        for region in &mut self.regions {
            contact(&mut region.deepest);
            region.normal = map.apply_vector(region.normal);
            region.points.iter_mut().for_each(contact);
            region.curves.iter_mut().flat_map(|curve| &mut curve.points).for_each(place);
        }
        self
    }
}

impl Contact {
    /// The same contact in another frame.
    #[must_use]
    pub fn moved(self, map: &RigidMap) -> Self {
        Self {
            point_a: map.apply(self.point_a),
            point_b: map.apply(self.point_b),
            normal: map.apply_vector(self.normal),
            ..self
        }
    }
}
