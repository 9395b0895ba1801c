//! Repairs: what may be mended, in which order, and that the surface stays where it is.
//!
//! Every repair that touches geometry is a *simplicial map*: filed vertices go to vertices of the
//! mended mesh, edges are split at vertices, faces are parted accordingly, and a face whose image
//! has no area may go if other faces cover that image. All faces of an edge are split alike and all
//! corners at a vertex go to the same one, so what closed before still closes. [`proof`] then
//! checks, from the outcome alone, that no point moved farther than the weld distance and that
//! nothing is missing and nothing is new.
//!
//! Holes are not filled by any policy: faces that the file does not have are an invention.
//!
//! Source: simplicial maps are those of Munkres (1984, "Elements of algebraic topology", section
//! 2); what is mended and in which order is this crate's own, and the proof trusts none of it.
//! Cost: O(n log n) as a rule.

mod coincident;
mod orient;
pub(crate) mod proof;
mod subdivide;

use cranny_exact::DVec3;

use crate::each_once::each_once;
use crate::ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::near::foot;
use crate::report::{RepairKind, RepairRecord};
use crate::scan::{cracks, faces::has_no_area};
use crate::topology::Topology;
use crate::tree::FaceTree;
use crate::weld::{UNREFERENCED, Welded};
use proof::{Proof, ProofError};
use subdivide::Splits;

/// What may be mended. Whatever the policy, vertices in exactly the same place are welded, vertices
/// that no face uses dropped, and a closed mesh of negative volume is turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Repair {
    /// Nothing else: the prepared faces are the filed ones, to the last.
    #[default]
    None,
    /// What leaves the surface where it is, within the weld distance, and is proved to: vertices
    /// along unmatched edges are welded to one another within the distance; edges are split at
    /// T-vertices and at the middle corners of faces without area; faces without area go where
    /// others cover them; of faces in one place as many stay as the surface needs (opposite ones
    /// are cancelled only while another copy stays, and of a last pair the one goes that fits its
    /// neighbours less well); faces are turned to agree with their neighbours, and closed
    /// components to look outwards, each with what lies in it.
    Safe,
    /// `Safe`, and what changes the solid, though no place where it can be touched from outside:
    /// components within others become cavities, those within cavities solids, by the parity of how
    /// many enclose them; pairs of opposite faces with solid on both sides are dropped.
    Full,
}

/// The prepared mesh and how it came about.
pub(crate) struct Mended {
    pub(crate) mesh: Mesh,
    /// The filed face that each face is, or is a part of; `None` where all are as filed.
    pub(crate) filed_face: Option<Vec<FaceId>>,
    /// The vertex that each filed one became; [`UNREFERENCED`] where no face uses it any more.
    pub(crate) new_id: Vec<u32>,
    pub(crate) records: Vec<RepairRecord>,
    /// No point of either surface is farther than this from the other.
    pub(crate) deviation: f64,
}

/// Mends a welded mesh by `Safe` or `Full`. O(n log n).
///
/// # Errors
///
/// The proof did not hold: an error of this crate, not of the mesh.
pub(crate) fn mend(
    filed: &Mesh,
    welded: Welded,
    full: bool,
    weld_distance: f64,
) -> Result<Mended, ProofError> {
    let mut records = Vec::new();
    let Welded { mesh, new_id: mut vertex_of, .. } = welded;
    let mesh = weld_near(mesh, &mut vertex_of, weld_distance, &mut records);
    let splits = splits(filed, &mesh, weld_distance, &mut records);
    let mut work = WorkingMesh::part(&mesh, &splits, &mut records);
    work.drop_coincident(&mut records);
    let sheets = orient::orient(&mut work, full, &mut records);

    let deviation = if work.is_as_filed() && records.iter().all(|r| r.moved == 0.0) {
        0.0
    } else {
        let proof = Proof { filed, vertex_of: &vertex_of, splits: &splits, without: &sheets };
        proof.check(&work.mesh, &work.origin, weld_distance)?
    };
    let filed_face = (!work.is_as_filed()).then_some(work.origin);
    let (mesh, place) = compacted(work.mesh);
    let now = |welded: u32| place.get(welded as usize).copied().unwrap_or(UNREFERENCED);
    let new_id = vertex_of.into_iter().map(now).collect();
    Ok(Mended { mesh, filed_face, new_id, records, deviation })
}

/// The mesh in work: all welded vertices, used or not, and faces with the filed face of each.
struct WorkingMesh {
    mesh: Mesh,
    origin: Vec<FaceId>,
    filed_faces: usize,
}

impl WorkingMesh {
    fn is_as_filed(&self) -> bool {
        self.mesh.faces().len() == self.filed_faces
            && self.origin.iter().enumerate().all(|(i, f)| f.index() == i)
    }

    /// Parts every face as its edges are split, and drops what collapsed and is covered by others.
    fn part(mesh: &Mesh, splits: &Splits, records: &mut Vec<RepairRecord>) -> Self {
        let parted: Vec<Vec<[u32; 3]>> = mesh.faces().iter().map(|&f| splits.parts(f)).collect();
        let cover = Cover::of(parted.iter().flatten().copied().filter(|&p| !is_collapsed(p)));
        let (mut faces, mut origin, mut dropped) = (Vec::new(), Vec::new(), Vec::new());
        for (f, parts) in parted.iter().enumerate() {
            let face = FaceId(f as u32);
            let stays = |part: &[u32; 3]| !is_collapsed(*part) || !cover.holds(*part);
            if parts.iter().all(|&part| is_collapsed(part)) {
                // Wholly collapsed: it goes, or stays as it was filed.
                match parts.iter().any(stays) {
                    true => (faces.push(mesh.faces()[f]), origin.push(face)).1,
                    false => dropped.push(face.0),
                }
                continue;
            }
            for part in parts.iter().copied().filter(|part| stays(part)) {
                faces.push(part);
                origin.push(face);
            }
        }
        if !dropped.is_empty() {
            let record = RepairRecord::new(RepairKind::DroppedCollapsedFaces, dropped.len());
            records.push(RepairRecord { faces: dropped, ..record });
        }
        let filed_faces = mesh.faces().len();
        Self { mesh: Mesh::from_trusted(mesh.vertices().to_vec(), faces), origin, filed_faces }
    }

    fn drop_coincident(&mut self, records: &mut Vec<RepairRecord>) {
        let drop = coincident::superfluous(&self.mesh, &Topology::of(&self.mesh));
        self.without(&drop, RepairKind::DroppedCoincidentFaces, records);
    }

    /// Leaves out the faces of an ascending list, and says so.
    fn without(&mut self, drop: &[FaceId], kind: RepairKind, records: &mut Vec<RepairRecord>) {
        if drop.is_empty() {
            return;
        }
        let filed = self.filed_ids(drop);
        records.push(RepairRecord { faces: filed, ..RepairRecord::new(kind, drop.len()) });
        let keep = |f: usize| drop.binary_search(&FaceId(f as u32)).is_err();
        let faces = self.mesh.faces().iter().enumerate().filter(|&(f, _)| keep(f));
        let faces = faces.map(|(_, &face)| face).collect();
        let origin = self.origin.iter().enumerate().filter(|&(f, _)| keep(f));
        self.origin = origin.map(|(_, &face)| face).collect();
        self.mesh = Mesh::from_trusted(self.mesh.vertices().to_vec(), faces);
    }

    /// Turns the faces that `turn` names.
    fn turn(&mut self, turn: &[bool]) {
        let mut faces = self.mesh.faces().to_vec();
        for (face, _) in faces.iter_mut().zip(turn).filter(|&(_, &turn)| turn) {
            face.swap(1, 2);
        }
        self.mesh = Mesh::from_trusted(self.mesh.vertices().to_vec(), faces);
    }

    /// The filed faces of some faces: ascending, each once.
    fn filed_ids(&self, faces: &[FaceId]) -> Vec<u32> {
        each_once(faces.iter().map(|f| self.origin[f.index()].0))
    }
}

/// Whether two corners are one vertex.
fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// The edges and vertices of some faces.
struct Cover {
    edges: Vec<(u32, u32)>,
    vertices: Vec<u32>,
}

impl Cover {
    fn of(faces: impl Iterator<Item = [u32; 3]>) -> Self {
        let edges = faces.flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
        let edges = each_once(edges.map(|(a, b)| (a.min(b), a.max(b))));
        let vertices = each_once(edges.iter().flat_map(|&(a, b)| [a, b]));
        Self { edges, vertices }
    }

    /// Whether what is left of a collapsed face, an edge or a vertex, is one of these.
    fn holds(&self, [a, b, c]: [u32; 3]) -> bool {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        match low == high {
            true => self.vertices.binary_search(&low).is_ok(),
            false => self.edges.binary_search(&(low, high)).is_ok(),
        }
    }
}

/// Welds the vertices of unmatched edges to one another within the distance.
fn weld_near(
    mesh: Mesh,
    vertex_of: &mut [u32],
    weld_distance: f64,
    records: &mut Vec<RepairRecord>,
) -> Mesh {
    let unmatched = cracks::on_unmatched_edges(&Topology::of(&mesh), mesh.vertices().len());
    if !unmatched.contains(&true) {
        return mesh;
    }
    let tree = FaceTree::of(&mesh, 1);
    let near = cracks::near(&mesh, &tree, weld_distance, |v| unmatched[v.index()]);
    if near.is_empty() {
        return mesh;
    }
    let mut leader: Vec<u32> = (0..mesh.vertices().len() as u32).collect();
    for pair in &near {
        leader[pair.vertex.index()] = pair.leader.0;
    }
    let follows = |face: &[u32; 3]| face.iter().any(|&v| leader[v as usize] != v);
    let faces = mesh.faces().iter().enumerate().filter(|(_, face)| follows(face));
    records.push(RepairRecord {
        faces: faces.map(|(f, _)| f as u32).collect(),
        moved: near.iter().map(|pair| pair.distance).fold(0.0, f64::max),
        ..RepairRecord::new(RepairKind::WeldedNearVertices, near.len())
    });
    for id in vertex_of.iter_mut().filter(|id| **id != UNREFERENCED) {
        *id = leader[*id as usize];
    }
    let faces = mesh.faces().iter().map(|face| face.map(|v| leader[v as usize])).collect();
    Mesh::from_trusted(mesh.vertices().to_vec(), faces)
}

/// Where edges are to be split: unmatched ones at T-vertices, and the long side of every face
/// without area at its middle corner (its neighbour over that side then meets the two short ones).
///
/// `mesh` has the faces of `filed`, one for one. A vertex is inserted only where it lies within the
/// distance of the edge *as filed*, in every face of the edge: so moves do not add up.
fn splits(
    filed: &Mesh,
    mesh: &Mesh,
    weld_distance: f64,
    records: &mut Vec<RepairRecord>,
) -> Splits {
    let topology = Topology::of(mesh);
    let mut wanted: Vec<(EdgeId, VertexId)> =
        mesh.face_ids().filter_map(|f| middle_corner(mesh, &topology, f)).collect();
    if topology.edges().iter().any(|e| !e.kind.is_balanced()) {
        let tree = FaceTree::of(mesh, 1);
        let found = cracks::t_vertices(mesh, &topology, &tree, weld_distance);
        wanted.extend(found.iter().map(|t| (t.edge, t.vertex)));
    }
    let mut wanted = each_once(wanted);

    let off_edge = |edge: EdgeId, vertex: VertexId| {
        let off_side = |h: &HalfEdgeId| {
            let triangle = filed.triangle(h.face());
            let ends = [triangle[h.corner()], triangle[(h.corner() + 1) % 3]];
            foot(mesh.position(vertex), ends).distance
        };
        topology.half_edges(edge).iter().map(off_side).fold(0.0, f64::max)
    };
    wanted.retain(|&(edge, vertex)| off_edge(edge, vertex) <= weld_distance);

    let mut edges: Vec<(EdgeId, Vec<u32>)> = wanted
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| (group[0].0, group.iter().map(|&(_, v)| v.0).collect()))
        .collect();
    let ends = |edge: EdgeId| {
        let edge = topology.edges()[edge.index()];
        (edge.from, edge.to)
    };
    let length_squared = |edge: EdgeId| {
        let (from, to) = ends(edge);
        mesh.position(from).distance_squared(mesh.position(to))
    };
    // Short edges first: a piece of a long one may be a short one that is split itself.
    edges.sort_by(|a, b| length_squared(a.0).total_cmp(&length_squared(b.0)).then(a.0.cmp(&b.0)));
    let mut splits = Splits::default();
    let (mut count, mut moved, mut faces) = (0, 0.0f64, Vec::new());
    for (edge, mut inside) in edges {
        let (from, to) = ends(edge);
        sort_along(mesh, from, to, &mut inside);
        let finer = refined(&splits, from.0, to.0, &inside);
        let fits = |&v: &u32| off_edge(edge, VertexId(v)) <= weld_distance;
        if is_each_once(from.0, to.0, &finer) && finer.iter().all(fits) {
            inside = finer;
        }
        count += inside.len();
        moved = inside.iter().map(|&v| off_edge(edge, VertexId(v))).fold(moved, f64::max);
        faces.extend(topology.half_edges(edge).iter().map(|h| h.face().0));
        splits.insert(from, to, inside);
    }
    if !splits.is_empty() {
        let record = RepairRecord::new(RepairKind::SplitEdges, count);
        records.push(RepairRecord { faces: each_once(faces), moved, ..record });
    }
    splits
}

/// The long side of a face without area, and the corner within it; none where two corners coincide.
fn middle_corner(mesh: &Mesh, topology: &Topology, face: FaceId) -> Option<(EdgeId, VertexId)> {
    let corners = mesh.corners(face);
    if is_collapsed(mesh.faces()[face.index()]) || !has_no_area(mesh, face) {
        return None;
    }
    (0..3).find_map(|corner| {
        let [p, q, r] = [0, 1, 2].map(|i| mesh.position(corners[(corner + i) % 3]));
        let edge = topology.edge_of(HalfEdgeId::of(face, corner));
        is_between(r, p, q).then_some((edge, corners[(corner + 2) % 3]))
    })
}

/// For points on one line: whether the first lies strictly between the others.
fn is_between(p: DVec3, a: DVec3, b: DVec3) -> bool {
    let before = |p: DVec3, q: DVec3| p.to_array() < q.to_array();
    (before(a, p) && before(p, b)) || (before(b, p) && before(p, a))
}

/// Sorts vertices along an edge, by the coordinate that changes most on it.
fn sort_along(mesh: &Mesh, from: VertexId, to: VertexId, inside: &mut [u32]) {
    let along = mesh.position(to) - mesh.position(from);
    let axis = along.abs().max_position();
    let place = |v: u32| mesh.position(VertexId(v))[axis] * along[axis].signum();
    inside.sort_by(|&u, &v| place(u).total_cmp(&place(v)).then(u.cmp(&v)));
}

/// The pieces of an edge, each with its own splits.
fn refined(splits: &Splits, from: u32, to: u32, inside: &[u32]) -> Vec<u32> {
    let mut finer = Vec::with_capacity(inside.len());
    let mut last = from;
    for &v in inside.iter().chain([&to]) {
        finer.extend(splits.between(last, v));
        finer.push(v);
        last = v;
    }
    finer.pop();
    finer
}

fn is_each_once(from: u32, to: u32, inside: &[u32]) -> bool {
    let mut all: Vec<u32> = [&[from, to], inside].concat();
    all.sort_unstable();
    all.windows(2).all(|pair| pair[0] != pair[1])
}

/// Without the vertices that no face uses, in their old order; and where each one is now,
/// [`UNREFERENCED`] if nowhere.
fn compacted(mesh: Mesh) -> (Mesh, Vec<u32>) {
    let mut used = vec![false; mesh.vertices().len()];
    for &v in mesh.faces().iter().flatten() {
        used[v as usize] = true;
    }
    let mut next = 0;
    let new_id: Vec<u32> = used
        .iter()
        .map(|&used| {
            next += u32::from(used);
            if used { next - 1 } else { UNREFERENCED }
        })
        .collect();
    let vertices = mesh.vertices().iter().zip(&used).filter(|(_, used)| **used).map(|(p, _)| *p);
    let faces = mesh.faces().iter().map(|face| face.map(|v| new_id[v as usize])).collect();
    (Mesh::from_trusted(vertices.collect(), faces), new_id)
}
