//! The faces around each vertex: whether they are one ring, and whether that ring lies spread out.
//!
//! No source: definitions, decided by exact signs. Cost: O(n) for the rings; O(k) for k faces when
//! it is tested whether a ring is spread out.

use cranny_exact::{DVec2, DVec3, orient2d};

use crate::ids::{HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::projection::seen_along;
use crate::topology::Topology;

/// How the faces at a vertex hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Star {
    /// Not in one ring of twins: at a boundary, in several fans, next to a collapsed face, or
    /// unused.
    Torn,
    /// In one ring of twins, not yet seen along an axis.
    Ring,
    /// In one ring that does not lie [spread out](Stars::is_spread).
    Bent,
    /// In one ring that does.
    Spread,
}

/// The stars of all vertices.
pub(super) struct Stars<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    /// Seen when first needed.
    stars: Vec<Star>,
    ring: Vec<VertexId>,
}

impl<'a> Stars<'a> {
    /// O(n).
    pub(super) fn of(mesh: &'a Mesh, topology: &'a Topology) -> Self {
        let vertices = mesh.vertex_ids();
        let all_rings = are_rings(mesh, topology);
        let is_ring = |v| all_rings || walk(mesh, topology, v, |_| ());
        let star = |v| if is_ring(v) { Star::Ring } else { Star::Torn };
        let stars = vertices.map(star).collect();
        Self { mesh, topology, stars, ring: Vec::new() }
    }

    /// Whether the faces at a vertex are not one ring of twins: at a boundary, in several fans,
    /// next to a collapsed face, or where no face is.
    pub(super) fn is_torn(&self, vertex: VertexId) -> bool {
        self.stars[vertex.index()] == Star::Torn
    }

    /// Whether the faces at a vertex are one ring that, seen along an axis, goes around it once
    /// without turning back. Seen so, the faces lie side by side: two of them share the side that
    /// they have in common, or else the vertex, and nothing more. O(k) for k faces, when first
    /// checked.
    pub(super) fn is_spread(&mut self, vertex: VertexId) -> bool {
        let Self { mesh, topology, stars, ring } = self;
        let star = &mut stars[vertex.index()];
        if *star == Star::Ring {
            ring.clear();
            let spread = walk(mesh, topology, vertex, |h| ring.push(start_of(mesh, h.next())))
                && is_spread(mesh, vertex, ring);
            *star = if spread { Star::Spread } else { Star::Bent };
        }
        *star == Star::Spread
    }
}

/// Whether Euler's formula shows that the faces at each vertex are one ring, which it does of
/// bodies without handles.
///
/// Where all edges are between two faces, the faces at a vertex make one ring or several. Were a
/// vertex parted for each of its rings, every component would be a closed surface, so with R rings,
/// E edges, F faces and C components R − E + F <= 2 C; and all V vertices have a ring or more:
/// V <= R. So V − E + F = 2 C leaves no room for R > V.
fn are_rings(mesh: &Mesh, topology: &Topology) -> bool {
    let [vertices, edges, faces, components] = [
        mesh.vertices().len(),
        topology.edges().len(),
        mesh.faces().len(),
        topology.components().len(),
    ];
    let has_faces = |v: u32| !topology.faces_at(VertexId(v)).is_empty();
    topology.pairs().is_some()
        && vertices + faces == edges + 2 * components
        && (0..vertices as u32).all(has_faces)
}

/// The vertex at which a half-edge begins.
fn start_of(mesh: &Mesh, half_edge: HalfEdgeId) -> VertexId {
    VertexId(mesh.faces().as_flattened()[half_edge.index()])
}

/// Walks from twin to twin around a vertex and visits each half-edge that begins there. Returns
/// whether it came around and passed all faces there. Collapsed faces are in no ring: the side from
/// a vertex to itself has no twin.
fn walk(
    mesh: &Mesh,
    topology: &Topology,
    vertex: VertexId,
    mut visit: impl FnMut(HalfEdgeId),
) -> bool {
    let faces = topology.faces_at(vertex);
    let Some(&face) = faces.first() else { return false };
    let Some(corner) = mesh.corners(face).iter().position(|&v| v == vertex) else { return false };
    let start = HalfEdgeId::of(face, corner);
    let mut half_edge = start;
    for passed in 1..=faces.len() {
        visit(half_edge);
        // The side that ends at the vertex; its twin starts there.
        match topology.twin(half_edge.previous()) {
            Some(twin) if twin == start => return passed == faces.len(),
            Some(twin) => half_edge = twin,
            None => return false,
        }
    }
    false
}

/// Whether a ring of neighbours, seen along the axis nearest its normal, goes around the vertex
/// once, all faces turning alike. Exact.
fn is_spread(mesh: &Mesh, vertex: VertexId, ring: &[VertexId]) -> bool {
    let middle = mesh.position(vertex);
    let sides = || {
        let last = ring.last().map(|&v| mesh.position(v));
        let ends = ring.iter().map(|&v| mesh.position(v));
        ends.scan(last, |before, end| before.replace(end).map(|before| (before, end)))
    };
    let normal: DVec3 = sides().map(|(p, q)| (p - middle).cross(q - middle)).sum();
    let axis = normal.abs().max_position();
    let center = seen_along(axis, middle);
    // Below the vertex, or level with it and behind: half of all directions.
    let is_below = |p: DVec2| p.y < center.y || (p.y == center.y && p.x < center.x);
    let mut turn = None;
    // Every face turns by less than half a revolution, so it passes from above to below no more
    // often than the ring comes around.
    let mut descents = 0;
    for (p, q) in sides() {
        let [p, q] = [p, q].map(|p| seen_along(axis, p));
        let sign = orient2d(center, p, q);
        if sign.is_zero() || *turn.get_or_insert(sign) != sign {
            return false;
        }
        descents += usize::from(!is_below(p) && is_below(q));
    }
    descents == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed umbrella: vertex 0 under the tip, a ring of others, and a last one far below.
    fn umbrella(tip: [f64; 3], ring: &[[f64; 3]]) -> (Mesh, Topology) {
        let mut vertices = vec![DVec3::from_array(tip)];
        vertices.extend(ring.iter().map(|&p| DVec3::from_array(p)));
        vertices.push(DVec3::new(0.0, 0.0, -9.0));
        let (n, below) = (ring.len() as u32, ring.len() as u32 + 1);
        let sides = (0..n).map(|i| (1 + i, 1 + (i + 1) % n));
        let faces = sides.flat_map(|(p, q)| [[0, p, q], [below, q, p]]).collect();
        let mesh = Mesh::new(vertices, faces).unwrap();
        let topology = Topology::of(&mesh);
        (mesh, topology)
    }

    fn star_of(mesh: &Mesh, topology: &Topology, vertex: u32) -> Star {
        let mut stars = Stars::of(mesh, topology);
        let spread = stars.is_spread(VertexId(vertex));
        assert_eq!(spread, stars.is_spread(VertexId(vertex)));
        stars.stars[vertex as usize]
    }

    fn star_of_tip(tip: [f64; 3], ring: &[[f64; 3]]) -> Star {
        let turned = |axis: usize, p: [f64; 3]| [p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]];
        let stars: Vec<Star> = (0..3)
            .map(|axis| {
                let ring: Vec<[f64; 3]> = ring.iter().map(|&p| turned(axis, p)).collect();
                let (mesh, topology) = umbrella(turned(axis, tip), &ring);
                star_of(&mesh, &topology, 0)
            })
            .collect();
        assert!(stars.iter().all(|&star| star == stars[0]), "{stars:?}");
        stars[0]
    }

    const SQUARE: [[f64; 3]; 4] =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];

    #[test]
    fn tents_and_saddles_are_spread() {
        assert_eq!(star_of_tip([0.0, 0.0, 1.0], &SQUARE), Star::Spread);
        assert_eq!(star_of_tip([0.5, 0.25, 0.0], &SQUARE), Star::Spread);
        let saddle = [0.5, -0.5, 0.5, -0.5];
        let saddle: Vec<[f64; 3]> =
            SQUARE.iter().zip(saddle).map(|(&[x, y, _], z)| [x, y, z]).collect();
        assert_eq!(star_of_tip([0.0; 3], &saddle), Star::Spread);
        let reversed: Vec<[f64; 3]> = SQUARE.iter().rev().copied().collect();
        assert_eq!(star_of_tip([0.0, 0.0, 1.0], &reversed), Star::Spread);
    }

    #[test]
    fn what_turns_back_or_stands_upright_is_not() {
        // Off the square: two faces turn the other way.
        assert_eq!(star_of_tip([2.0, 0.0, 0.1], &SQUARE), Star::Bent);
        // Right above a side: one face stands upright.
        assert_eq!(star_of_tip([0.5, 0.5, 1.0], &SQUARE), Star::Bent);
    }

    #[test]
    fn what_goes_around_twice_is_not_spread_though_all_turn_alike() {
        let twice: Vec<[f64; 3]> = SQUARE
            .iter()
            .chain(&SQUARE)
            .zip(0..)
            .map(|(&[x, y, _], i)| [x, y, f64::from(i) / 8.0])
            .collect();
        let (mesh, topology) = umbrella([0.0; 3], &twice);
        let ring: Vec<VertexId> = (1..=8).map(VertexId).collect();
        let turns = (0..8).map(|i| {
            let [p, q] = [ring[i], ring[(i + 1) % 8]].map(|v| mesh.position(v).truncate());
            orient2d(DVec2::ZERO, p, q).as_i8()
        });
        assert!(turns.clone().all(|turn| turn == 1));
        assert_eq!(star_of(&mesh, &topology, 0), Star::Bent);
    }

    #[test]
    fn what_is_told_of_all_stars_at_once_is_so_of_each() {
        // Walls of a box around a hole or not, and a vertex of one of its tubes in two places.
        let ring = |at: u32| (0..4).map(move |k| 4 * (at % 4) + k);
        let tube = |from: u32, to: u32| {
            let (from, to): (Vec<u32>, Vec<u32>) = (ring(from).collect(), ring(to).collect());
            let squares = (0..4).map(move |k| (from[k], from[(k + 1) % 4], to[k], to[(k + 1) % 4]));
            squares.flat_map(|(a, b, c, d)| [[a, b, c], [b, d, c]]).collect::<Vec<_>>()
        };
        let lid = |[a, b, c, d]: [u32; 4]| vec![[a, b, c], [a, c, d]];
        let torus = [tube(0, 1), tube(1, 2), tube(2, 3), tube(3, 0)].concat();
        let sealed = [tube(0, 1), lid([3, 2, 1, 0]), lid([4, 5, 6, 7])].concat();
        let pinched: Vec<[u32; 3]> =
            sealed.iter().map(|f| f.map(|v| if v == 6 { 0 } else { v })).collect();
        for (faces, known) in [(&torus, false), (&sealed, true), (&pinched, false)] {
            let point = |i: u32| DVec3::new(f64::from(i), f64::from(i * i), f64::from(i * i * i));
            let used: std::collections::BTreeSet<u32> = faces.iter().flatten().copied().collect();
            let place = |v: u32| used.iter().position(|&u| u == v).expect("it is used") as u32;
            let faces = faces.iter().map(|f| f.map(place)).collect();
            let mesh = Mesh::new((0..used.len() as u32).map(point).collect(), faces).unwrap();
            let topology = Topology::of(&mesh);
            assert!(topology.is_closed());
            let mut vertices = mesh.vertex_ids();
            let all = vertices.all(|v| walk(&mesh, &topology, v, |_| ()));
            assert_eq!((are_rings(&mesh, &topology), all), (known, known || used.len() == 16));
            // A vertex that no face names makes up for no ring.
            let more = Mesh::new([mesh.vertices(), &[DVec3::ZERO]].concat(), mesh.faces().to_vec());
            let more = more.unwrap();
            assert!(!are_rings(&more, &Topology::of(&more)));
        }
    }

    #[test]
    fn solids_that_share_a_corner_and_open_fans_are_torn() {
        // Two closed tetrahedra, each a ring of three faces around vertex 0.
        let sides: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let other = sides.map(|f| f.map(|v| if v == 0 { 0 } else { v + 3 }));
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        let vertices = [&[DVec3::ZERO], &corners[..], &corners.map(|p| -p)].concat();
        let torn = |faces: Vec<[u32; 3]>| {
            let mesh = Mesh::new(vertices.clone(), faces).unwrap();
            let topology = Topology::of(&mesh);
            let stars = Stars::of(&mesh, &topology);
            (0..mesh.vertices().len() as u32).map(|v| stars.is_torn(VertexId(v))).collect()
        };
        let of_pair: Vec<bool> = torn([sides, other].concat());
        assert_eq!(of_pair, [true, false, false, false, false, false, false]);
        let of_open: Vec<bool> = torn(sides[1..].to_vec());
        assert_eq!(of_open, [true, true, true, false, true, true, true]);
        // The side 0-0 of a collapsed face, between two others.
        let with_collapsed = [&sides[..], &[[0, 0, 1]]].concat();
        assert!(torn(with_collapsed)[0]);
    }
}
