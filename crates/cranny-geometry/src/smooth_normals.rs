//! Normals of the curved surface that a mesh stands for, where its edges are flat enough.
//!
//! A turned part is stored in facets, and a facet's normal is the part's at one point only. Faces
//! that meet over edges flatter than a *crease angle* are taken as pieces of one curved surface. At
//! a corner its normal is the mean of the normals of the faces around the vertex that are reached
//! over such edges, weighted by the angles that they have there; at other points of a face, what
//! lies between those of its corners. An edge that is no flatter than the crease has no normal, nor
//! has a vertex where faces are not all reached from one another: there the part is sharp. Sharp
//! edges that run on from one to the next without turning by as much are pieces of one curve, whose
//! tangent is known.
//!
//! Nothing of this moves a point: it gives directions only. Each comes with how much the surface
//! bends about it, for whoever has to choose between the normals of two surfaces that meet.
//!
//! Source of the weights: Thürmer and Wüthrich (1998, "Computing vertex normals from polygonal
//! facets"): the mean does not depend on how the faces of a flat piece are cut into triangles.
//! Cost: linear, memory too: 12 bytes a face and 32 a corner normal, of which a smooth body has one
//! a vertex.

use cranny_exact::DVec3;
use thiserror::Error;

use crate::angle::{between, direction, is_between_faces};
use crate::ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::model::Model;
use crate::topology::{DisjointSets, Edge, Topology};

/// Faces around a vertex whose normals differ by less, as chords of the unit sphere, lie in one
/// plane. Smaller: a plane whose normals are rounded bends; larger: the faces of a very fine sphere
/// are flat.
const FLAT: f64 = 1e-10;

/// Normals of a model's surface, smooth over edges flatter than a crease angle. They are of this
/// model alone, not of what a deformation makes of it.
///
/// # Panics
///
/// Methods that take a model, or ids of its features, where these are another's.
#[derive(Clone, Debug)]
pub struct SmoothNormals {
    crease_angle: f64,
    /// Of faces that hang together around a vertex.
    corner_normals: Vec<SurfaceNormal>,
    /// Of each half-edge, where its beginning stands among these.
    of_corner: Vec<u32>,
    /// By ascending vertices.
    creases: Vec<(VertexId, Crease)>,
}

/// A sharp curve at a point: where sharp edges run on from one to the next, turning by less than
/// the crease angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// Along it: unit, in the body's frame; either way.
    pub tangent: DVec3,
    /// By how many radians it turns along a unit of length, about.
    pub bend: f64,
}

/// The normal of a curved surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceNormal {
    /// Unit, outward, in the body's frame.
    pub normal: DVec3,
    /// By how many radians the normal turns along a unit of length, about; 0 where the surface is
    /// flat.
    pub bend: f64,
}

/// A crease angle that is none.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the crease angle is {0}: it must be a number of radians from 0 to π")]
pub struct CreaseAngleError(pub f64);

/// Whether a number is a crease angle: radians from 0 (nothing is smooth) to π.
///
/// # Errors
///
/// [`CreaseAngleError`].
pub fn check_crease_angle(angle: f64) -> Result<(), CreaseAngleError> {
    if is_between_faces(angle) { Ok(()) } else { Err(CreaseAngleError(angle)) }
}

impl SmoothNormals {
    /// Of a model: smooth where normals of neighbouring faces differ by less than the crease angle,
    /// in radians from 0 to π. A face without area is no neighbour: over it, those on its other
    /// sides are.
    ///
    /// # Errors
    ///
    /// [`CreaseAngleError`] where the angle is none.
    pub fn of(model: &Model, crease_angle: f64) -> Result<Self, CreaseAngleError> {
        check_crease_angle(crease_angle)?;
        let (mesh, topology) = (model.mesh(), model.topology());
        let faces: Vec<DVec3> = mesh.face_ids().map(|f| direction(mesh.area_vector(f))).collect();
        let (of_corner, count) = joined_corners(topology, &faces, crease_angle).numbered();
        let corner_normals = means(mesh, &faces, &of_corner, count);
        let mut own = Self { crease_angle, corner_normals, of_corner, creases: Vec::new() };
        own.creases = own.found_creases(model);
        Ok(own)
    }

    /// Edges between normals that differ by less are smooth.
    #[must_use]
    pub fn crease_angle(&self) -> f64 {
        self.crease_angle
    }

    /// Heap bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.corner_normals.capacity() * size_of::<SurfaceNormal>()
            + self.of_corner.capacity() * size_of::<u32>()
            + self.creases.capacity() * size_of::<(VertexId, Crease)>()
    }

    /// At a vertex of the model; `None` where the surface is sharp or ends, or no face has an area.
    #[must_use]
    pub fn at_vertex(&self, model: &Model, vertex: VertexId) -> Option<SurfaceNormal> {
        let faces = model.topology().faces_at(vertex);
        let mut all = faces.iter().flat_map(|&face| {
            let corners = model.mesh().corners(face);
            (0..3).filter(move |&c| corners[c] == vertex).map(move |c| HalfEdgeId::of(face, c))
        });
        let first = all.next()?;
        let is_whole = |corner: HalfEdgeId| model.topology().twin(corner).is_some();
        let number = self.of_corner[first.index()];
        let is_one =
            is_whole(first) && all.all(|c| self.of_corner[c.index()] == number && is_whole(c));
        is_one.then(|| self.corner_normal(number))?
    }

    /// On an edge of the model, a share (0 to 1) of the way from its lesser to its greater vertex;
    /// `None` where it is sharp, or not between two faces.
    #[must_use]
    pub fn on_edge(&self, model: &Model, edge: EdgeId, share: f64) -> Option<SurfaceNormal> {
        let topology = model.topology();
        let own = *topology.half_edges(edge).first()?;
        let twin = topology.twin(own)?;
        let ends = [own, own.next()].map(|corner| self.of_corner[corner.index()]);
        if [twin.next(), twin].map(|corner| self.of_corner[corner.index()]) != ends {
            return None;
        }
        let begins = model.mesh().corners(own.face())[own.corner()];
        let is_forth = topology.edges()[edge.index()].from == begins;
        let share = if is_forth { share } else { 1.0 - share };
        let [p, q] = ends.map(|end| self.corner_normal(end));
        Some(mixed([(p?, 1.0 - share), (q?, share)]))
    }

    /// At a point on a face of the model, in the body's frame; `None` where the face has no area.
    #[must_use]
    pub fn on_face(&self, model: &Model, face: FaceId, point: DVec3) -> Option<SurfaceNormal> {
        let shares = shares(&model.mesh().triangle(face), point)?;
        let [a, b, c] = [0, 1, 2].map(|corner| self.at_corner(face, corner));
        Some(mixed([(a?, shares[0]), (b?, shares[1]), (c?, shares[2])]))
    }

    /// At a corner (0, 1 or 2) of a face, as seen from that face; `None` where it has no area.
    #[must_use]
    pub fn at_corner(&self, face: FaceId, corner: usize) -> Option<SurfaceNormal> {
        self.corner_normal(self.of_corner[HalfEdgeId::of(face, corner).index()])
    }

    /// The sharp curve through a vertex; `None` where there is none, or it turns there as much as
    /// the crease angle, or meets others.
    #[must_use]
    pub fn crease_at_vertex(&self, vertex: VertexId) -> Option<Crease> {
        let found = self.creases.binary_search_by_key(&vertex, |(v, _)| *v);
        found.ok().map(|i| self.creases[i].1)
    }

    /// The sharp curve at a share (0 to 1) of the way along an edge of the model, from its lesser
    /// to its greater vertex; `None` where the edge is smooth, or runs on over neither end.
    #[must_use]
    pub fn crease_on_edge(&self, model: &Model, edge: EdgeId, share: f64) -> Option<Crease> {
        if self.on_edge(model, edge, share).is_some() {
            return None;
        }
        let Edge { from, to, .. } = model.topology().edges()[edge.index()];
        let along = direction(model.mesh().position(to) - model.mesh().position(from));
        let [p, q] = [from, to].map(|v| self.crease_at_vertex(v));
        let straight = Crease { tangent: along, bend: 0.0 };
        let bend = p.or(q)?.bend.max(q.or(p)?.bend);
        let forth = |end: Option<Crease>| {
            let Crease { tangent, .. } = end.unwrap_or(straight);
            if tangent.dot(along) < 0.0 { -tangent } else { tangent }
        };
        let tangent = direction((1.0 - share) * forth(p) + share * forth(q));
        Some(Crease { tangent, bend })
    }

    fn found_creases(&self, model: &Model) -> Vec<(VertexId, Crease)> {
        let (mesh, topology) = (model.mesh(), model.topology());
        let is_sharp = |e: EdgeId| self.on_edge(model, e, 0.5).is_none();
        let edges = topology.edge_ids().filter(|&e| is_sharp(e));
        let mut ends: Vec<[VertexId; 2]> = edges
            .flat_map(|e| {
                let Edge { from, to, .. } = topology.edges()[e.index()];
                [[from, to], [to, from]]
            })
            .collect();
        ends.sort_unstable();
        let around = ends.chunk_by(|a, b| a[0] == b[0]);
        let through = around.filter_map(|ends| {
            let &[[vertex, p], [_, q]] = ends else { return None };
            let [p, at, q] = [p, vertex, q].map(|v| mesh.position(v));
            let [come, go] = [at - p, q - at];
            let turned = between(direction(come), direction(go));
            // Of the circle through the three points.
            let [short, long] = [come.length(), go.length()];
            let tangent = direction(direction(come) * long + direction(go) * short);
            let bend = 2.0 * turned / (short + long);
            (turned < self.crease_angle).then_some((vertex, Crease { tangent, bend }))
        });
        through.collect()
    }

    fn corner_normal(&self, number: u32) -> Option<SurfaceNormal> {
        let found = self.corner_normals[number as usize];
        (found.normal != DVec3::ZERO).then_some(found)
    }
}

/// The corners (half-edges, where they begin) of faces that are reached from each other around a
/// vertex.
fn joined_corners(topology: &Topology, faces: &[DVec3], crease_angle: f64) -> DisjointSets {
    let mut sets = DisjointSets::new(3 * faces.len());
    let has_area = |corner: HalfEdgeId| faces[corner.face().index()] != DVec3::ZERO;
    // Around the vertex that a half-edge begins at, to the corner on its other side.
    let across = |corner| topology.twin(corner).map(HalfEdgeId::next);
    for start in (0..3 * faces.len() as u32).map(HalfEdgeId) {
        if !has_area(start) {
            continue;
        }
        let mut end = across(start);
        while let Some(corner) = end.filter(|&corner| !has_area(corner)) {
            end = across(corner);
        }
        let Some(end) = end else { continue };
        let [own, its] = [start, end].map(|corner| faces[corner.face().index()]);
        if between(own, its) >= crease_angle {
            continue;
        }
        // With what lies between.
        let mut corner = start;
        while corner != end {
            let Some(next) = across(corner) else { break };
            sets.union(corner.index(), next.index());
            corner = next;
        }
    }
    sets
}

/// The mean normal of each set of corners, and how much the surface bends about them.
fn means(mesh: &Mesh, faces: &[DVec3], of_corner: &[u32], count: usize) -> Vec<SurfaceNormal> {
    let none = SurfaceNormal { normal: DVec3::ZERO, bend: 0.0 };
    let mut found = vec![none; count];
    let corners = || {
        let faces = mesh.face_ids().zip(faces).filter(|(_, normal)| **normal != DVec3::ZERO);
        faces.flat_map(|(face, normal)| {
            let triangle = mesh.triangle(face);
            (0..3).map(move |c| (HalfEdgeId::of(face, c), *normal, triangle))
        })
    };
    for (corner, normal, triangle) in corners() {
        let c = corner.corner();
        let [along, back] = [1, 2].map(|k| direction(triangle[(c + k) % 3] - triangle[c]));
        found[of_corner[corner.index()] as usize].normal += between(along, back) * normal;
    }
    for mean in &mut found {
        mean.normal = direction(mean.normal);
    }
    for (corner, normal, triangle) in corners() {
        let mean = &mut found[of_corner[corner.index()] as usize];
        let turned = (normal - mean.normal).length();
        let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let away = (middle - triangle[corner.corner()]).length();
        if turned > FLAT {
            mean.bend = mean.bend.max(turned / away);
        }
    }
    // What is flat has the normal of its faces to the bit.
    for (corner, normal, _) in corners() {
        let mean = &mut found[of_corner[corner.index()] as usize];
        if mean.bend == 0.0 {
            mean.normal = normal;
        }
    }
    found
}

/// The shares of a triangle's corners in a point of it; `None` where it has no area. Points beside
/// it, as rounding makes them, have shares of its rim.
fn shares(triangle: &[DVec3; 3], point: DVec3) -> Option<[f64; 3]> {
    let [a, b, c] = triangle.map(|corner| corner - point);
    let normal = direction((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]));
    let parts = [b.cross(c), c.cross(a), a.cross(b)].map(|part| part.dot(normal).max(0.0));
    let whole: f64 = parts.iter().sum();
    (whole > 0.0).then(|| parts.map(|part| part / whole))
}

/// What lies between normals, by their shares.
fn mixed<const N: usize>(parts: [(SurfaceNormal, f64); N]) -> SurfaceNormal {
    let (first, _) = parts[0];
    let bend = parts.iter().map(|(part, share)| part.bend * share).sum();
    if parts.iter().all(|(part, _)| part.normal == first.normal) {
        return SurfaceNormal { normal: first.normal, bend };
    }
    let normal = parts.iter().map(|(part, share)| part.normal * *share).sum();
    SurfaceNormal { normal: direction(normal), bend }
}
