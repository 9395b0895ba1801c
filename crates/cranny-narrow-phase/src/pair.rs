//! A pair of placed models in canonical order, and the frame in which everything is decided.
//!
//! The order is that of model digest, then pose bits, not the caller's; the second model's vertices
//! are posed into the first one's frame by [`RigidMap::apply`], when first needed, and rounded. All
//! decisions read those rounded positions, so exchanging A and B cannot change an answer.

use std::cell::RefCell;

use cranny_exact::{Aabb, DVec3, RigidMap};
use cranny_geometry::{EdgeId, FaceId, HalfEdgeId, Mesh, Model, ModelTag, Topology, VertexId};

use crate::answer::{Contact, Containment, Feature, Witness};
use crate::approach::Approach;
use crate::evaluate::QueryError;
use crate::numbering::Numbering;
use crate::query::Placed;

/// One of the two bodies of a pair in canonical order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The first in canonical order, in whose frame the pair is decided.
    First,
    /// The second, whose vertices are posed.
    Second,
}

impl Side {
    /// First and second.
    pub const BOTH: [Self; 2] = [Self::First, Self::Second];

    /// The other body.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }

    /// 0 for the first, 1 for the second.
    #[must_use]
    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }

    /// In the pair's order, what is of this side and what is of the other.
    pub(crate) fn ordered<T>(self, own: T, its: T) -> [T; 2] {
        if self == Self::First { [own, its] } else { [its, own] }
    }

    /// In the pair's order, a contact that has what is of this side first.
    pub(crate) fn in_order(self, contact: Contact) -> Contact {
        if self == Self::First { contact } else { contact.swapped() }
    }

    /// In the pair's order, the contact of a feature of this side with one of the other, at a
    /// point of each; the normal leads from this side to the other.
    pub(crate) fn contact(
        self,
        [own, its]: [Feature; 2],
        [point_a, point_b]: [DVec3; 2],
        normal: DVec3,
        separation: f64,
    ) -> Contact {
        self.in_order(Contact { id: (own, its), point_a, point_b, normal, separation })
    }
}

/// Vertices of a second body that has grown or shrunk, whose places cost more than posing: each is
/// computed when it is first read.
#[derive(Debug, Default)]
pub(crate) struct GrownVertices(RefCell<(Numbering, Vec<DVec3>)>);

impl GrownVertices {
    fn place(&self, vertex: VertexId, computed: impl FnOnce() -> DVec3) -> DVec3 {
        let (numbers, places) = &mut *self.0.borrow_mut();
        let (number, is_new) = numbers.number(u64::from(vertex.0));
        if is_new {
            places.push(computed());
        }
        places[number as usize]
    }
}

/// The two models that cached data belongs to, in order. The default belongs to none.
///
/// Faces, nodes and patches are numbered by the model, and one mesh may have other patches after
/// deformations: what names them means nothing for another pair.
#[derive(Clone, Debug, Default)]
pub struct PairTag(Option<[ModelTag; 2]>);

impl PairTag {
    /// The tag of a pair's models.
    #[must_use]
    pub fn of(pair: &Pair) -> Self {
        Self(Some(pair.models().map(ModelTag::of)))
    }

    /// Whether these are the pair's models, in this order.
    #[must_use]
    pub fn is_of(&self, pair: &Pair) -> bool {
        let same = |tags: &[ModelTag; 2]| {
            Side::BOTH.iter().all(|&side| tags[side.index()].is_of(pair.model(side)))
        };
        self.0.as_ref().is_some_and(same)
    }
}

/// Two placed models in canonical order: by model digest, then by pose bits.
///
/// All decisions are made in the *pair's frame*, which is the first model's own: the second model's
/// vertices are posed into it and rounded. Whatever is computed in this order and this frame does
/// not depend on which body the caller names A; [`ordered`](Self::ordered) and
/// [`world_witness`](Self::world_witness) translate results back.
pub struct Pair<'a> {
    models: [&'a Model; 2],
    pub(crate) first_from_second: RigidMap,
    world_from_first: RigidMap,
    /// How far the second's vertices are moved along their normals: 0 but beside special positions.
    bulge: f64,
    /// The first in canonical order is the caller's B.
    swapped: bool,
    length_error: f64,
    /// Where vertices of the second are kept, if that has grown or shrunk.
    grown: Option<&'a GrownVertices>,
}

impl<'a> Pair<'a> {
    /// Puts two placed models in order.
    ///
    /// # Errors
    ///
    /// [`QueryError::Pose`] where a pose is not [accepted](cranny_exact::Pose::accepted).
    pub fn new(a: Placed<'a>, b: Placed<'a>) -> Result<Self, QueryError> {
        let [a, b] = accepted(a, b)?;
        Ok(Self::of_accepted(a, b))
    }

    /// The poses must be [accepted](cranny_exact::Pose::accepted): culling takes a transpose for
    /// the inverse and carries no more than rounding.
    pub(crate) fn of_accepted(a: Placed<'a>, b: Placed<'a>) -> Self {
        let key = |p: &Placed| (p.model.digest(), p.pose.bits());
        let swapped = key(&b) < key(&a);
        let (first, second) = if swapped { (b, a) } else { (a, b) };
        let (models, first_from_second) =
            ([first.model, second.model], RigidMap::between(&first.pose, &second.pose));
        Self {
            models,
            first_from_second,
            length_error: length_error(models, &first_from_second),
            world_from_first: first.pose.world_from_body(),
            bulge: 0.0,
            swapped,
            grown: None,
        }
    }

    /// The same pair with the second body moved by `offset` (first's frame) and grown by `bulge`
    /// (shrunk if negative), every vertex along the mean normal of its faces, and kept in `grown`,
    /// which holds none so far.
    pub(crate) fn shifted<'p>(
        &self,
        offset: DVec3,
        bulge: f64,
        grown: &'p GrownVertices,
    ) -> Pair<'p>
    where
        'a: 'p,
    {
        let mut first_from_second = self.first_from_second;
        first_from_second.translation += offset;
        Pair {
            first_from_second,
            bulge,
            length_error: length_error(self.models, &first_from_second),
            grown: (bulge != 0.0).then_some(grown),
            ..*self
        }
    }

    /// The first and the second model.
    #[must_use]
    pub fn models(&self) -> [&'a Model; 2] {
        self.models
    }

    /// A body's model.
    #[must_use]
    #[inline]
    pub fn model(&self, side: Side) -> &'a Model {
        self.models[side.index()]
    }

    pub(crate) fn mesh(&self, side: Side) -> &'a Mesh {
        self.models[side.index()].mesh()
    }

    pub(crate) fn topology(&self, side: Side) -> &'a Topology {
        self.models[side.index()].topology()
    }

    /// The relative pose: from the second model's frame to the first's, which is the pair's.
    #[must_use]
    #[inline]
    pub fn first_from_second(&self) -> &RigidMap {
        &self.first_from_second
    }

    /// Position of a vertex in the pair's frame.
    ///
    /// # Panics
    ///
    /// If the body's mesh has no such vertex.
    #[must_use]
    #[inline]
    pub fn position(&self, side: Side, vertex: VertexId) -> DVec3 {
        let p = self.mesh(side).position(vertex);
        match (side, self.grown) {
            (Side::First, _) => p,
            // Posing costs less than looking up what was posed.
            (Side::Second, None) => self.first_from_second.apply(p),
            (Side::Second, Some(grown)) => grown.place(vertex, || {
                self.first_from_second.apply(p) + self.bulge * self.vertex_normal(vertex)
            }),
        }
    }

    /// Mean normal of the second body's faces at a vertex, in the pair's frame.
    fn vertex_normal(&self, vertex: VertexId) -> DVec3 {
        let unit = |&f: &FaceId| self.mesh(Side::Second).area_vector(f).normalize_or_zero();
        let faces = self.topology(Side::Second).faces_at(vertex);
        self.first_from_second.apply_vector(faces.iter().map(unit).sum()).normalize_or_zero()
    }

    /// Corners of a face in the pair's frame.
    ///
    /// # Panics
    ///
    /// If the body's mesh has no such face.
    #[must_use]
    #[inline]
    pub fn triangle(&self, side: Side, face: FaceId) -> [DVec3; 3] {
        // One by one: as a map over the three it is a call for each.
        let [a, b, c] = self.mesh(side).corners(face);
        [self.position(side, a), self.position(side, b), self.position(side, c)]
    }

    /// Ends of an edge, in the direction from its lesser to its greater vertex.
    pub(crate) fn segment(&self, side: Side, edge: EdgeId) -> [DVec3; 2] {
        let e = self.topology(side).edges()[edge.index()];
        [self.position(side, e.from), self.position(side, e.to)]
    }

    /// Area vector of a face in the pair's frame.
    pub(crate) fn area_vector(&self, side: Side, face: FaceId) -> DVec3 {
        let [a, b, c] = self.triangle(side, face);
        0.5 * (b - a).cross(c - a)
    }

    /// Unit normal of a face in the pair's frame; zero for a degenerate face.
    pub(crate) fn normal(&self, side: Side, face: FaceId) -> DVec3 {
        self.area_vector(side, face).normalize_or_zero()
    }

    /// The mesh's name for corner or side `i` of a face.
    pub(crate) fn corner(&self, side: Side, face: FaceId, i: usize) -> VertexId {
        self.mesh(side).corners(face)[i]
    }

    pub(crate) fn edge(&self, side: Side, face: FaceId, i: usize) -> EdgeId {
        self.topology(side).edge_of(HalfEdgeId::of(face, i))
    }

    /// The largest length that occurs in the pair's arithmetic; rounding is measured by it.
    pub(crate) fn scale(&self) -> f64 {
        scale(self.models, &self.first_from_second)
    }

    /// An upper bound of the error of a constructed length: a distance, a depth, a coordinate of a
    /// witness. Posing rounds about 8 times, a closest point about 30 times, each by at most half
    /// an ulp of the scale: the radii of both models plus the length of the relative translation.
    #[must_use]
    pub fn length_error(&self) -> f64 {
        self.length_error
    }

    /// By how much a posed vertex may leave the posed box of what holds it, and by how much more a
    /// length measured in one body's frame may differ from that in the other's.
    ///
    /// In units of half an ulp of the same scale as [`length_error`](Self::length_error): a posed
    /// vertex rounds 8 times, a box's center and extents, doubled, 30 times together; a rotation
    /// matrix made of accepted quaternions is off by at most 64. A hundred in all; 256 leave room.
    /// [`RigidMap::posing_error`] bounds what posing one point rounds.
    #[must_use]
    pub fn culling_error(&self) -> f64 {
        2.0 * self.length_error() + self.bulge.abs()
    }

    /// The box of a whole body in the pair's frame, rounded outward.
    #[must_use]
    pub fn bounds(&self, side: Side) -> Aabb {
        let local = self.model(side).bounds();
        match side {
            Side::First => local,
            Side::Second => self.first_from_second.bounds(&local).grown(self.bulge.abs()),
        }
    }

    /// Whether both bodies are closed.
    pub(crate) fn is_closed(&self) -> bool {
        self.models.iter().all(|model| model.is_closed())
    }

    /// Into world coordinates.
    pub(crate) fn world_point(&self, p: DVec3) -> DVec3 {
        self.world_from_first.apply(p)
    }

    /// The box of a box of the pair's frame in world coordinates, rounded outward.
    #[must_use]
    pub fn world_bounds(&self, bounds: &Aabb) -> Aabb {
        self.world_from_first.bounds(bounds)
    }

    /// Whether the first is the caller's B.
    pub(crate) fn is_swapped(&self) -> bool {
        self.swapped
    }

    /// From (first, second) to the caller's (A, B).
    #[must_use]
    pub fn ordered<T>(&self, first: T, second: T) -> [T; 2] {
        if self.swapped { [second, first] } else { [first, second] }
    }

    /// Pairs of faces of the two in the caller's order, ascending, each once.
    pub(crate) fn ordered_faces(&self, mut faces: Vec<[FaceId; 2]>) -> Vec<[FaceId; 2]> {
        if self.swapped {
            faces.iter_mut().for_each(|faces| faces.reverse());
        }
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// A containment that takes the first for A, in the caller's order.
    #[must_use]
    pub fn ordered_containment(&self, containment: Containment) -> Containment {
        if self.swapped { containment.swapped() } else { containment }
    }

    /// How the first body approaches the second, in the pair's frame, where the caller's A
    /// approaches B.
    pub(crate) fn own_approach(&self, approach: &Approach) -> Approach {
        let moved = approach.moved(&self.world_from_first.inverse());
        if self.swapped { moved.swapped() } else { moved }
    }

    /// A contact of the pair's frame and order, as the caller wants it.
    pub(crate) fn world_contact(&self, contact: Contact) -> Contact {
        let contact = if self.swapped { contact.swapped() } else { contact };
        contact.moved(&self.world_from_first)
    }

    /// A point of the pair's frame and its feature as a witness, in world coordinates.
    #[must_use]
    pub fn world_witness(&self, point: DVec3, feature: Feature) -> Witness {
        Witness { point: self.world_point(point), feature }
    }

    /// From first to second, in the caller's words: from A to B.
    pub(crate) fn world_normal(&self, normal: DVec3) -> DVec3 {
        let n = self.world_from_first.apply_vector(normal);
        if self.swapped { -n } else { n }
    }
}

fn scale(models: [&Model; 2], first_from_second: &RigidMap) -> f64 {
    models[0].radius() + models[1].radius() + first_from_second.translation.length()
}

pub(crate) fn length_error(models: [&Model; 2], first_from_second: &RigidMap) -> f64 {
    64.0 * f64::EPSILON * scale(models, first_from_second)
}

/// The bodies at poses that a [`Pair`] may rely on.
pub(crate) fn accepted<'a>(a: Placed<'a>, b: Placed<'a>) -> Result<[Placed<'a>; 2], QueryError> {
    let at = |placed: Placed<'a>, body| match placed.pose.accepted() {
        Ok(pose) => Ok(Placed { pose, ..placed }),
        Err(source) => Err(QueryError::Pose { body, source }),
    };
    Ok([at(a, 'A')?, at(b, 'B')?])
}
