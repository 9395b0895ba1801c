//! What contacts can be made of: the vertices and ridges of a mesh, and from where each is looked
//! at.
//!
//! A vertex or an edge *counts to* the first face of the lowest patch at it ([`Owned`]): of several
//! faces that say the same of a rim, that one speaks. It is *looked at* from the cluster with the
//! largest area among those at it, whose box it does not make larger.

use cranny_exact::DVec3;

use super::lanes::{CornerLanes, FaceLanes, LANES, Lanes, Lanes3, RidgeLanes};
use super::{Surface, grow};
use crate::ids::{EdgeId, FaceId, HalfEdgeId, PatchId, VertexId};
use crate::patches::Patches;

/// By how far, as a sine, an edge must be bent to be no line drawn on a plane. Zero would find
/// ridges by rounding.
pub(super) const LEAST_BEND: f64 = 1e-9;

/// Sine of the angle by which an edge must be bent inwards to make no contacts for certain: what
/// leads out of the solid there runs into one of its faces. Smaller than [`LEAST_BEND`], and
/// contacts that it lets pass are lost; larger, and edges of finely divided hollows are looked at
/// in vain.
const REFLEX: f64 = 1e3 * LEAST_BEND;

/// How far, as a sine, edges at a vertex may rise towards a direction along which it touches rims.
/// Smaller: tips are lost by rounding; larger: vertices of flat places are compared with every rim.
const TIP_SLACK: f64 = 1e-6;

/// Sine of the angle between two edges below which they lie along one line. Smaller: vertices of
/// straight edges are tips for lack of knowing better; larger: what bounds them by a hair is lost.
const ONE_LINE: f64 = 1e-8;

/// Sine of the angle between two edges below which what is at right angles to both is not certain.
/// Smaller: rounding turns it; larger: tips between narrow faces are not known.
const LEAST_ANGLE: f64 = 1e-4;

/// Vertices of more edges than this are not examined, since each pair of their edges is compared
/// with all: 8 million products. Whether they are tips is unknown, so that motion bounds nothing of
/// what holds them (`tips_of_many_edges_are_not_known`). Smaller: centres of finely cut caps are
/// among them; larger: a fan of thousands of faces takes minutes.
pub(super) const MOST_EDGES: usize = 256;

/// Cosine of the angle (30 degrees) between faces from which their edge is sharp. A smaller angle:
/// regions of finely cut round bodies are measured in vain, whose vertices say how deep they are; a
/// larger one: blunt edges dig in.
const SHARP: f64 = 0.866;

/// Which corners and sides count to a face, a bit each; of sides, that from corner `i` to the next
/// is bit `i`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Owned {
    /// Its corners.
    pub corners: u8,
    /// Its sides.
    pub sides: u8,
    /// Those of the sides that may cross an edge: neither lines drawn on a plane nor bent inwards.
    pub ridges: u8,
    /// All sides that may, whatever face they count to.
    pub bent: u8,
    /// Sides between faces whose normals are more than 30 degrees apart, or of which one has no
    /// area. Of more faces than two at a side, two count.
    pub sharp: u8,
    /// Sides at which a vertex can touch what counts to the face: the side, or a corner at one of
    /// its ends.
    pub rims: u8,
}

/// Which features count to each face.
pub(super) fn owned(
    surface: &Surface,
    patches: &Patches,
    tips: &[Tip],
    is_ridge: &[bool],
) -> Vec<Owned> {
    let Surface { mesh, topology, normals, .. } = surface;
    let key = |f: FaceId| (patches.patch_of_face(f), f);
    let is_sharp = |along: &[HalfEdgeId]| {
        let [h, g, ..] = along else { return false };
        normals[h.face().index()].dot(normals[g.face().index()]) <= SHARP
    };
    let of = |face: FaceId| {
        let (own, mut owned) = (key(face), Owned::default());
        let corners = mesh.corners(face);
        for (i, &corner) in corners.iter().enumerate() {
            let around = topology.faces_at(corner);
            owned.corners |= u8::from(around.iter().all(|&f| key(f) >= own)) << i;
            let edge = topology.edge_of(HalfEdgeId::of(face, i));
            let along = topology.half_edges(edge);
            let is_owned = along.iter().all(|h| key(h.face()) >= own);
            owned.sides |= u8::from(is_owned) << i;
            let is_bent = is_ridge[edge.index()];
            owned.ridges |= u8::from(is_owned && is_bent) << i;
            owned.bent |= u8::from(is_bent) << i;
            owned.sharp |= u8::from(is_sharp(along)) << i;
        }
        let is_tip = |i: usize| owned.corners >> i & 1 != 0 && tips[corners[i].index()].may_be();
        for i in 0..3 {
            let is_rim = owned.ridges >> i & 1 != 0 || is_tip(i) || is_tip((i + 1) % 3);
            owned.rims |= u8::from(is_rim) << i;
        }
        owned
    };
    mesh.face_ids().map(of).collect()
}

/// Of each edge, whether it may cross another body's and make a contact.
pub(super) fn ridges_of(surface: &Surface) -> Vec<bool> {
    let edges = surface.topology.edge_ids();
    edges.map(|edge| may_be_ridge(surface, surface.topology.half_edges(edge))).collect()
}

fn may_be_ridge(surface: &Surface, around: &[HalfEdgeId]) -> bool {
    let [h, g] = around else { return true };
    // Of faces that contradict each other, the normals say nothing of which way the edge is bent.
    let start = |h: &HalfEdgeId| surface.mesh.faces()[h.face().index()][h.corner()];
    if start(h) == start(g) {
        return true;
    }
    let [n, m] = [h, g].map(|h| surface.normal(h.face()));
    let ends = surface.mesh.triangle(h.face());
    let along = (ends[(h.corner() + 1) % 3] - ends[h.corner()]).normalize_or_zero();
    let bend = n.cross(m);
    // Half the slack: in the pair's frame, rounding has the angle a little larger or smaller.
    let is_flat = n.dot(m) > 0.0 && bend.length() < 0.5 * LEAST_BEND;
    !is_flat && bend.dot(along) >= -REFLEX
}

/// From which group each vertex and each edge is looked at.
pub(super) struct Owners {
    vertices: Vec<Vec<VertexId>>,
    edges: Vec<Vec<EdgeId>>,
}

/// What is looked at from a group.
#[derive(Clone, Copy)]
pub(super) struct Share<'a> {
    pub(super) vertices: &'a [VertexId],
    pub(super) edges: &'a [EdgeId],
}

impl Owners {
    pub(super) fn of(surface: &Surface, groups: &[Vec<FaceId>], is_ridge: &[bool]) -> Self {
        let Surface { mesh, topology, .. } = surface;
        let area = |face: FaceId| {
            let [a, b, c] = surface.triangle(face);
            (b - a).cross(c - a).length()
        };
        let mut group_of = vec![0u32; mesh.faces().len()];
        let mut areas = Vec::with_capacity(groups.len());
        for (group, faces) in groups.iter().enumerate() {
            areas.push(faces.iter().map(|&face| area(face)).sum::<f64>());
            for face in faces {
                group_of[face.index()] = group as u32;
            }
        }
        // The largest, of equals the first.
        let largest = |faces: &mut dyn Iterator<Item = FaceId>| {
            faces.map(|face| group_of[face.index()] as usize).reduce(|x, y| {
                let order = areas[x].total_cmp(&areas[y]).then(y.cmp(&x));
                if order.is_lt() { y } else { x }
            })
        };
        let mut vertices = vec![Vec::new(); groups.len()];
        for vertex in mesh.vertex_ids() {
            if let Some(group) = largest(&mut topology.faces_at(vertex).iter().copied()) {
                vertices[group].push(vertex);
            }
        }
        let mut edges = vec![Vec::new(); groups.len()];
        for edge in topology.edge_ids() {
            let around = topology.half_edges(edge);
            if is_ridge[edge.index()]
                && let Some(group) = largest(&mut around.iter().map(|h| h.face()))
            {
                edges[group].push(edge);
            }
        }
        Self { vertices, edges }
    }

    pub(super) fn of_group(&self, group: usize) -> Share<'_> {
        Share { vertices: &self.vertices[group], edges: &self.edges[group] }
    }
}

/// The vertices of some faces, each once, eight at a time; what is left repeats the first.
pub(super) fn points(
    surface: &Surface,
    faces: &[FaceId],
    from: impl Fn(DVec3) -> DVec3 + Copy,
) -> Vec<Lanes3> {
    let vertices = surface.vertices_of(faces);
    let place = |v: &VertexId| from(surface.places[v.index()]);
    vertices
        .chunks(LANES)
        .map(|chunk| {
            let rest = std::iter::repeat_n(&vertices[0], LANES - chunk.len());
            Lanes3::of(chunk.iter().chain(rest).map(place))
        })
        .collect()
}

/// The mean of the faces' normals, unit; any direction where there is none.
pub(super) fn mean_normal(surface: &Surface, faces: &[FaceId]) -> [f32; 3] {
    let mean = grow::mean(surface, faces);
    let mean = if mean == DVec3::ZERO { DVec3::Z } else { mean };
    mean.to_array().map(|x| x as f32)
}

fn named<T: Copy>(ids: impl Iterator<Item = T>) -> [T; LANES] {
    let ids: Vec<T> = ids.collect();
    std::array::from_fn(|i| ids.get(i).copied().unwrap_or(ids[0]))
}

/// Faces side by side; `owned` says what counts to each face of the mesh.
pub(super) fn faces(
    surface: &Surface,
    (owned, patches): (&[Owned], &Patches),
    faces: &[FaceId],
    from: impl Fn(DVec3) -> DVec3 + Copy,
) -> FaceLanes {
    let all = || faces.iter().copied();
    let rims = |side: usize| {
        let is_rim = |face: FaceId| u32::from(owned[face.index()].rims >> side & 1);
        all().enumerate().map(|(i, face)| is_rim(face) << i).sum()
    };
    let (zero, none) = (Lanes::all(0.0), Lanes3::of(std::iter::empty()));
    let mut lanes = FaceLanes {
        ids: named(all()),
        patches: named(all().map(|f| patches.patch_of_face(f))),
        count: faces.len() as u32,
        rims: [rims(0), rims(1), rims(2)],
        normal: Lanes3::of(all().map(|face| surface.normal(face))),
        top: zero,
        bottom: zero,
        sides: [none; 3],
        ends: [zero; 3],
        corners: [none; 3],
    };
    let single = |v: DVec3| v.to_array().map(|x| x as f32);
    for (i, face) in all().enumerate() {
        let (triangle, normal) = (surface.triangle(face).map(from), surface.normal(face));
        // All three corners, so that bounds hold also where rounding tilts a direction.
        let most = |along: DVec3| {
            triangle.map(|p| along.dot(p)).into_iter().fold(f64::NEG_INFINITY, f64::max)
        };
        // Of slivers, rounding turns the normal, and nothing is beyond a side for certain.
        let certain = surface.certain_normal(face).unwrap_or(DVec3::ZERO);
        lanes.top.0[i] = most(normal) as f32;
        lanes.bottom.0[i] = -most(-normal) as f32;
        for j in 0..3 {
            let side = (triangle[(j + 1) % 3] - triangle[j]).cross(certain).normalize_or_zero();
            lanes.sides[j].set(i, single(side));
            lanes.ends[j].0[i] = most(side) as f32;
            lanes.corners[j].set(i, single(triangle[j]));
        }
    }
    lanes
}

/// Vertices side by side.
pub(super) fn corners(
    surface: &Surface,
    (patches, tips): (&Patches, &[Tip]),
    vertices: &[VertexId],
    from: impl Fn(DVec3) -> DVec3 + Copy,
) -> Vec<CornerLanes> {
    let patch = |vertex: VertexId| {
        // A vertex that is looked at is a corner of a face.
        patches.patch_of_vertex(surface.topology, vertex).unwrap_or(PatchId(u32::MAX))
    };
    let chunks = vertices.chunks(LANES).map(|chunk| {
        let is_tip = |v: &VertexId| u32::from(tips[v.index()].may_be());
        CornerLanes {
            ids: named(chunk.iter().copied()),
            patches: named(chunk.iter().map(|&v| patch(v))),
            count: chunk.len() as u32,
            tips: chunk.iter().enumerate().map(|(i, v)| is_tip(v) << i).sum(),
            points: Lanes3::of(chunk.iter().map(|v| from(surface.places[v.index()]))),
        }
    });
    chunks.collect()
}

/// Edges side by side.
pub(super) fn ridges(
    surface: &Surface,
    patches: &Patches,
    edges: &[EdgeId],
    from: impl Fn(DVec3) -> DVec3 + Copy,
) -> Vec<RidgeLanes> {
    let chunks = edges.chunks(LANES).map(|chunk| {
        let arcs: Vec<Arc> = chunk.iter().map(|&edge| Arc::of(surface, edge)).collect();
        RidgeLanes {
            ids: named(chunk.iter().copied()),
            patches: named(chunk.iter().map(|&e| patches.patch_of_edge(surface.topology, e))),
            count: chunk.len() as u32,
            starts: Lanes3::of(arcs.iter().map(|arc| from(arc.start))),
            spans: Lanes3::of(arcs.iter().map(|arc| arc.span)),
            squares: Lanes::of(arcs.iter().map(|arc| arc.span.length_squared()), 1.0),
            along: Lanes3::of(arcs.iter().map(|arc| arc.along)),
            left: Lanes3::of(arcs.iter().map(|arc| arc.left)),
            right: Lanes3::of(arcs.iter().map(|arc| arc.right)),
            blur: Lanes::of(arcs.iter().map(|arc| arc.blur), f32::INFINITY),
        }
    });
    chunks.collect()
}

/// The directions from which all edges at a vertex fall away, or nearly so.
pub(super) enum Tip {
    /// There are none.
    None,
    /// A cone between these, unit, at right angles to two edges each.
    Cone(Vec<DVec3>),
    /// There are some.
    Unknown,
}

impl Tip {
    /// Of all vertices.
    pub(super) fn all(surface: &Surface) -> Vec<Self> {
        surface.mesh.vertex_ids().map(|v| Self::of(surface, v)).collect()
    }

    /// Whether there may be some.
    fn may_be(&self) -> bool {
        !matches!(self, Self::None)
    }

    fn of(surface: &Surface, vertex: VertexId) -> Self {
        let at = surface.places[vertex.index()];
        let mut around = surface.vertices_of(surface.topology.faces_at(vertex));
        around.retain(|&other| other != vertex);
        if !(3..=MOST_EDGES).contains(&around.len()) {
            return Self::Unknown;
        }
        let edges: Vec<DVec3> =
            around.iter().map(|v| (surface.places[v.index()] - at).normalize_or_zero()).collect();
        // Whether all edges fall away from a direction, and from the one against it.
        let fall = |direction: DVec3| {
            let (mut falls, mut rises) = (true, true);
            for edge in &edges {
                let along = edge.dot(direction);
                (falls, rises) = (falls && along <= TIP_SLACK, rises && -along <= TIP_SLACK);
                if !falls && !rises {
                    break;
                }
            }
            [falls, rises]
        };
        // The directions are a cone, whose border lines are at right angles to two edges.
        // Edges along one line bound it by others: what is at right angles to that line.
        let (mut borders, mut some) = (Vec::new(), false);
        for (i, edge) in edges.iter().enumerate() {
            for other in &edges[i + 1..] {
                let cross = edge.cross(*other);
                let length = cross.length();
                if length < ONE_LINE {
                    continue;
                }
                some = true;
                let cross = cross / length;
                let found =
                    [cross, -cross].into_iter().zip(fall(cross)).filter(|(_, falls)| *falls);
                let before = borders.len();
                borders.extend(found.map(|(direction, _)| direction));
                if borders.len() > before && length < LEAST_ANGLE {
                    return Self::Unknown;
                }
            }
        }
        match (borders.is_empty(), some) {
            (false, _) => Self::Cone(borders),
            (true, true) => Self::None,
            (true, false) => Self::Unknown,
        }
    }
}

/// The directions along which an edge between two faces is touched: an arc of the sphere of
/// directions.
struct Arc {
    start: DVec3,
    span: DVec3,
    along: DVec3,
    left: DVec3,
    right: DVec3,
    blur: f64,
}

impl Arc {
    fn of(surface: &Surface, edge: EdgeId) -> Self {
        let ends = surface.topology.edges()[edge.index()];
        let [start, end] = [ends.from, ends.to].map(|v| surface.places[v.index()]);
        let span = end - start;
        let whole = Self {
            start,
            span,
            along: DVec3::ZERO,
            left: DVec3::ZERO,
            right: DVec3::ZERO,
            blur: f64::INFINITY,
        };
        let [h, g] = surface.topology.half_edges(edge) else { return whole };
        let Some(along) = span.try_normalize() else { return whole };
        let (mut least, mut most) = (span.length(), span.length());
        let [left, right] = [h, g].map(|h| {
            let aside = surface.triangle(h.face())[(h.corner() + 2) % 3] - start;
            let into = aside - along * along.dot(aside);
            (least, most) = (least.min(into.length()), most.max(aside.length()));
            into.normalize_or_zero().cross(along)
        });
        let blur = most / (least * least);
        if blur.is_finite() { Self { along, left, right, blur, ..whole } } else { whole }
    }
}
