//! How often closed components wind around a point. Exact: signed crossings of a segment that leads
//! out, each decided by sign predicates.
//!
//! A segment that meets an edge or a vertex is given up for another direction. The walk ends
//! because finitely many edges block only a null set of directions; after [`DIRECTIONS`] a point is
//! called undecided all the same.
//!
//! Source: crossings are counted after Linhart (1990, "A quick point-in-polyhedron test"); to try
//! other directions is this crate's own. Cost: with the function.

use cranny_exact::{
    DVec3, Piercing, SegmentFeature, Sign, TriangleFeature, classify_segment_triangle,
    generic_direction, locate_piercing, orient3d,
};

use crate::ids::{ComponentId, FaceId};
use crate::mesh::Mesh;
use crate::topology::Topology;
use crate::tree::FaceTree;

/// Directions tried. Fewer: a point before a fine regular grid may stay undecided; more is of no
/// use, as the first one almost always serves.
const DIRECTIONS: u32 = 32;

/// What winds around a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Winding {
    /// Closed components with their winding numbers, those other than 0, by ascending id.
    Around(Vec<(ComponentId, i64)>),
    /// The point lies on one of the faces that count.
    On,
    /// No direction was free of edges.
    Undecided,
}

/// The winding numbers around `p` of the closed components, over the faces that `counts` admits.
/// Cost: a walk through the tree, O(log n + faces hit) as a rule.
pub(crate) fn winding(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    p: DVec3,
    counts: impl Fn(FaceId) -> bool,
) -> Winding {
    let bounds = tree.node(0).bounds;
    let reach = 2.0 * (bounds.diagonal() + (p - bounds.center()).length());
    for attempt in 0..DIRECTIONS {
        let segment = [p, p + generic_direction(attempt) * reach];
        let mut crossings: Vec<(ComponentId, i64)> = Vec::new();
        let (mut on, mut blocked) = (false, false);
        let visit = |face: FaceId| {
            if on || !topology.in_closed_component(face) || !counts(face) {
                return;
            }
            let triangle = mesh.triangle(face);
            match locate_piercing(&segment, &triangle) {
                Piercing::Miss => {}
                Piercing::Point { on_segment: SegmentFeature::Start, .. } => on = true,
                Piercing::Point { on_triangle: TriangleFeature::Interior, .. } => {
                    let from_behind =
                        orient3d(triangle[0], triangle[1], triangle[2], p) == Sign::Negative;
                    crossings.push((topology.component_of(face), if from_behind { 1 } else { -1 }));
                }
                Piercing::Point { .. } => blocked = true,
                Piercing::Coplanar => {
                    on |= classify_segment_triangle(&[p; 2], &triangle).meets();
                    blocked |= classify_segment_triangle(&segment, &triangle).meets();
                }
            }
        };
        tree.visit(|b| b.grown(0.0).entered_at(segment[0], segment[1]).is_some(), visit);
        if on {
            return Winding::On;
        }
        if !blocked {
            return Winding::Around(summed(crossings));
        }
    }
    Winding::Undecided
}

fn summed(mut crossings: Vec<(ComponentId, i64)>) -> Vec<(ComponentId, i64)> {
    crossings.sort_unstable();
    crossings
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| (group[0].0, group.iter().map(|c| c.1).sum()))
        .filter(|&(_, sum): &(ComponentId, i64)| sum != 0)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron(radius: f64) -> Mesh {
        let tips = [1.0, -1.0].iter().flat_map(|s| [DVec3::X, DVec3::Y, DVec3::Z].map(|a| a * *s));
        let faces = vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        Mesh::new(tips.map(|p| radius * p).collect(), faces).unwrap()
    }

    fn around(mesh: &Mesh, p: DVec3) -> Winding {
        let topology = Topology::of(mesh);
        winding(mesh, &topology, &FaceTree::of(mesh, 1), p, |_| true)
    }

    #[test]
    fn shells_are_counted_one_by_one() {
        let shells = octahedron(4.0).joined(&octahedron(2.0).turned_inside_out());
        let [outer, inner] = [ComponentId(0), ComponentId(1)];
        assert_eq!(
            around(&shells, DVec3::new(0.1, 0.2, 0.0)),
            Winding::Around(vec![(outer, 1), (inner, -1)])
        );
        assert_eq!(around(&shells, DVec3::new(0.0, 0.0, 3.0)), Winding::Around(vec![(outer, 1)]));
        assert_eq!(around(&shells, DVec3::new(4.0, 4.0, 0.0)), Winding::Around(vec![]));
    }

    #[test]
    fn points_on_faces_edges_and_vertices_are_on() {
        let mesh = octahedron(4.0);
        for p in [DVec3::new(2.0, 1.0, 1.0), DVec3::new(2.0, 2.0, 0.0), 4.0 * DVec3::Y] {
            assert_eq!(around(&mesh, p), Winding::On);
        }
    }

    #[test]
    fn faces_left_out_and_open_components_do_not_count() {
        let mesh = octahedron(4.0);
        let topology = Topology::of(&mesh);
        let tree = FaceTree::of(&mesh, 1);
        let none = winding(&mesh, &topology, &tree, DVec3::ZERO, |_| false);
        assert_eq!(none, Winding::Around(vec![]));
        let mut faces = mesh.faces().to_vec();
        faces.pop();
        let open = Mesh::new(mesh.vertices().to_vec(), faces).unwrap();
        assert_eq!(around(&open, DVec3::ZERO), Winding::Around(vec![]));
    }
}
