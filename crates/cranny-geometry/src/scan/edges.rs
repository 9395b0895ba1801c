//! Edges and vertices at which faces do not meet as on a surface, and edges that bend nothing.
//!
//! No source: definitions, decided by signs. Cost: O(n), and O(k log k) as a rule at a vertex whose
//! k faces are not one ring.

use cranny_exact::{DVec3, orient3d};

use super::judge::overlap_in_plane;
use super::stars::Stars;
use super::turns::Turn;
use crate::ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::report::{Finding, FindingKind};
use crate::topology::{DisjointSets, EdgeKind, Topology};

/// Open, contradictory and non-manifold edges.
pub(super) fn unsound(mesh: &Mesh, topology: &Topology) -> Vec<Finding> {
    let mut findings = Vec::new();
    if topology.pairs().is_some() {
        return findings;
    }
    for (e, edge) in topology.edges().iter().enumerate() {
        let kind = match edge.kind {
            EdgeKind::Manifold => continue,
            _ if edge.from == edge.to => continue, // the short side of a collapsed face
            EdgeKind::Open => FindingKind::OpenEdge,
            EdgeKind::Contradictory => FindingKind::ContradictoryEdge,
            EdgeKind::Balanced | EdgeKind::Tangled => FindingKind::NonManifoldEdge,
        };
        let (p, q) = (mesh.position(edge.from), mesh.position(edge.to));
        let faces = topology.half_edges(EdgeId(e as u32)).iter().map(|h| h.face().0);
        findings.push(Finding::one(kind, faces.collect(), 0.5 * (p + q), (q - p).length()));
    }
    findings
}

/// Vertices at which faces hang together in more than one fan.
pub(super) fn pinched(mesh: &Mesh, topology: &Topology, stars: &Stars) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut spokes: Vec<(VertexId, usize)> = Vec::new();
    for vertex in mesh.vertex_ids() {
        if !stars.is_torn(vertex) {
            continue; // one ring is one fan
        }
        let faces = topology.faces_at(vertex);
        spokes.clear();
        for (i, &face) in faces.iter().enumerate() {
            let others = mesh.corners(face).into_iter().filter(|&v| v != vertex);
            spokes.extend(others.map(|v| (v, i)));
        }
        spokes.sort_unstable();
        let mut fans = DisjointSets::new(faces.len());
        for pair in spokes.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            fans.union(pair[0].1, pair[1].1);
        }
        let fans = (0..faces.len()).filter(|&i| fans.find(i) == i).count();
        let collapsed = faces.iter().any(|&f| {
            let [a, b, c] = mesh.corners(f);
            a == b || b == c || c == a
        });
        if fans > 1 && !collapsed {
            let (kind, at) = (FindingKind::NonManifoldVertex, mesh.position(vertex));
            findings.push(Finding::one(kind, vec![vertex.0], at, fans as f64));
        }
    }
    findings
}

/// The manifold edges whose faces lie side by side in one plane, exactly: one finding for all.
pub(super) fn flat(
    mesh: &Mesh,
    topology: &Topology,
    turns: &[Turn],
    without_area: &[bool],
) -> Option<Finding> {
    let (mut count, mut longest, mut at, mut ids) = (0, 0.0, DVec3::ZERO, Vec::new());
    let start = |h: HalfEdgeId| mesh.position(VertexId(mesh.faces().as_flattened()[h.index()]));
    // Nearly no edge.
    let may_be_flat = |&[g, h]: &[HalfEdgeId; 2]| {
        !turns[g.face().index()].is_off_plane(start(h.previous()) - start(g))
    };
    let looked_at: Vec<[HalfEdgeId; 2]> = match topology.pairs() {
        Some(pairs) => pairs.iter().copied().filter(may_be_flat).collect(),
        None => {
            let edges = (0..).map(EdgeId).zip(topology.edges());
            let manifold = edges.filter(|(_, e)| e.kind == EdgeKind::Manifold && e.from != e.to);
            let pairs = manifold.filter_map(|(e, _)| topology.half_edges(e).try_into().ok());
            pairs.filter(may_be_flat).collect()
        }
    };
    for [g, h] in looked_at {
        let [f, other] = [g, h].map(HalfEdgeId::face);
        let ([a, b, c], apex) = (mesh.triangle(f), start(h.previous()));
        let sound = |f: FaceId| !without_area[f.index()];
        let coplanar = sound(f) && sound(other) && in_one_plane([a, b, c, apex]);
        if !coplanar || overlap_in_plane(&[a, b, c], &mesh.triangle(other)) {
            continue;
        }
        let (p, q) = (start(g), start(h));
        count += 1;
        if (q - p).length() > longest {
            (longest, at) = ((q - p).length(), 0.5 * (p + q));
            ids = vec![f.0.min(other.0), f.0.max(other.0)];
        }
    }
    let kind = FindingKind::CoplanarAdjacent;
    (count > 0).then_some(Finding { kind, ids, at, measure: longest, count })
}

/// Whether four points lie in one plane, exactly.
///
/// The predicate takes longest for zeros, and most planes of filed meshes run along axes: where all
/// four have a coordinate in common, or two and two of them lie on lines along one axis, nothing is
/// computed.
fn in_one_plane([a, b, c, d]: [DVec3; 4]) -> bool {
    let level = |axis: usize| a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis];
    let on_line = |p: DVec3, q: DVec3, axis: usize| {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
        p[i] == q[i] && p[j] == q[j]
    };
    let on_lines = |axis: usize| {
        let pairs = [[a, b, c, d], [a, c, b, d], [a, d, b, c]];
        pairs.iter().any(|&[p, q, r, s]| on_line(p, q, axis) && on_line(r, s, axis))
    };
    (0..3).any(level) || (0..3).any(on_lines) || orient3d(a, b, c, d).is_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_along_axes_are_known_as_any_other() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let upright = [at(0.1, 0.7, 1.0), at(0.3, 0.2, 5.0), at(0.1, 0.7, 3.0), at(0.3, 0.2, 1.0)];
        let level = [at(0.1, 0.7, 0.3), at(0.3, 0.2, 0.3), at(0.9, 0.4, 0.3), at(0.3, 0.8, 0.3)];
        let slanted = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 1.0), at(0.0, 1.0, 2.0), at(1.0, 1.0, 3.0)];
        for axis in 0..3 {
            let turned = |p: DVec3| at(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]);
            for flat in [upright, level, slanted] {
                let [a, b, c, d] = flat.map(turned);
                for points in [[a, b, c, d], [a, c, b, d], [b, c, d, a]] {
                    assert!(in_one_plane(points));
                    for moved in 0..4 {
                        let mut points = points;
                        points[moved] += 1e-9 * at(1.0, 2.0, 7.0);
                        assert!(!in_one_plane(points), "{points:?}");
                    }
                }
            }
        }
    }

    fn mesh(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> (Mesh, Topology) {
        let vertices = vertices.iter().map(|&p| DVec3::from_array(p)).collect();
        let mesh = Mesh::new(vertices, faces.to_vec()).unwrap();
        let topology = Topology::of(&mesh);
        (mesh, topology)
    }

    const BOW_TIE: [[f64; 3]; 5] =
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]];

    #[test]
    fn a_bow_tie_is_pinched_and_a_fan_is_not() {
        let (tie, topology) = mesh(&BOW_TIE, &[[0, 2, 1], [0, 3, 4]]);
        let found = pinched(&tie, &topology, &Stars::of(&tie, &topology));
        assert_eq!((found.len(), found[0].ids[0], found[0].measure), (1, 0, 2.0));
        let (fan, topology) = mesh(&BOW_TIE, &[[0, 2, 1], [0, 1, 3], [0, 3, 4]]);
        assert!(pinched(&fan, &topology, &Stars::of(&fan, &topology)).is_empty());
    }

    #[test]
    fn solids_that_share_a_corner_are_pinched_there() {
        // Two closed tetrahedra, each a ring of three faces around vertex 0.
        let sides: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let other = sides.map(|f| f.map(|v| if v == 0 { 0 } else { v + 3 }));
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let opposite = corners.map(|p| p.map(|x: f64| -x));
        let vertices = [&[[0.0; 3]], &corners[..], &opposite[..]].concat();
        let (single, topology) = mesh(&vertices[..4], &sides);
        assert!(pinched(&single, &topology, &Stars::of(&single, &topology)).is_empty());
        let (double, topology) = mesh(&vertices, &[sides, other].concat());
        let found = pinched(&double, &topology, &Stars::of(&double, &topology));
        assert_eq!((found.len(), found[0].ids[0], found[0].measure), (1, 0, 2.0));
    }

    fn turns_of(mesh: &Mesh) -> Vec<Turn> {
        (0..mesh.faces().len() as u32).map(|f| Turn::of(&mesh.triangle(FaceId(f)))).collect()
    }

    #[test]
    fn flat_edges_are_counted_once_folded_ones_not() {
        let (fan, topology) = mesh(&BOW_TIE, &[[0, 2, 1], [0, 1, 3], [0, 3, 4]]);
        let found = flat(&fan, &topology, &turns_of(&fan), &[false; 3]).unwrap();
        assert_eq!((found.count, found.measure), (2, 2f64.sqrt()));
        // Both faces on one side of their edge: they overlap.
        let folded = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]];
        let (folded, topology) = mesh(&folded, &[[0, 1, 2], [1, 0, 3]]);
        assert_eq!(flat(&folded, &topology, &turns_of(&folded), &[false; 2]), None);
    }
}
