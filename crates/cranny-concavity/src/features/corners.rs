//! The triangles of a hull, by their corners.
//!
//! Rows are filled by counting (Knuth 1973, section 5.2). Cost: O(n) as a rule; a look-up is a
//! binary search among the triangles of one corner.

use super::NONE;
use cranny_geometry::Mesh;
use cranny_geometry::VertexId;
use cranny_geometry::hull::{ConvexHull, lowest_first};

/// Which face of the mesh is a triangle of the hull.
pub(super) struct Corners {
    /// The corner of the hull that a vertex of the mesh is, or [`NONE`].
    of_vertex: Vec<u32>,
    /// Triangles in rows by their least corner, ascending by the corner that follows it.
    starts: Vec<u32>,
    rows: Vec<Row>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Row {
    second: u32,
    third: u32,
    facet: u32,
}

impl Corners {
    /// O(n), and O(k log k) for a corner of k triangles.
    pub(super) fn of(mesh: &Mesh, hull: &ConvexHull) -> Self {
        let mut of_vertex = vec![NONE; mesh.vertices().len()];
        for (corner, vertex) in hull.sources().iter().enumerate() {
            of_vertex[vertex.index()] = corner as u32;
        }
        let triangle = |t: usize| lowest_first(hull.triangle(t).map(|v| v.0));
        let mut starts = vec![0u32; hull.vertex_count() + 1];
        for t in 0..hull.triangle_count() {
            starts[triangle(t)[0] as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut fill = starts.clone();
        let mut rows = vec![Row::default(); hull.triangle_count()];
        for t in 0..hull.triangle_count() {
            let [first, second, third] = triangle(t);
            let at = &mut fill[first as usize];
            rows[*at as usize] = Row { second, third, facet: hull.facet_of_triangle(t).0 };
            *at += 1;
        }
        for row in starts.windows(2) {
            rows[row[0] as usize..row[1] as usize].sort_unstable();
        }
        Self { of_vertex, starts, rows }
    }

    /// The facet of the triangle with these corners in this order, if there is one.
    pub(super) fn facet_of_equal(&self, face: [VertexId; 3]) -> Option<u32> {
        let corners = face.map(|v| self.of_vertex[v.index()]);
        if corners.contains(&NONE) {
            return None;
        }
        let [first, second, third] = lowest_first(corners);
        let first = first as usize;
        let row = &self.rows[self.starts[first] as usize..self.starts[first + 1] as usize];
        // A closed surface runs an edge in each direction once.
        let found = row.get(row.partition_point(|r| r.second < second))?;
        (found.second == second && found.third == third).then_some(found.facet)
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;

    #[test]
    fn triangles_of_the_hull_are_found_from_any_corner_but_not_turned_over() {
        // Vertex 0 is inside the tetrahedron of the others.
        let p = [0.25 * DVec3::ONE, DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y, 2.0 * DVec3::Z];
        let faces = vec![[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]];
        let mesh = Mesh::new(p.to_vec(), faces.clone()).unwrap();
        let hull = ConvexHull::of_points(&p);
        let corners = Corners::of(&mesh, &hull);
        let mut facets = Vec::new();
        for [a, b, c] in faces.into_iter().map(|f| f.map(VertexId)) {
            let found = corners.facet_of_equal([a, b, c]);
            facets.extend(found);
            assert_eq!(found, corners.facet_of_equal([b, c, a]));
            assert_eq!(found, corners.facet_of_equal([c, a, b]));
            assert_eq!(corners.facet_of_equal([b, a, c]), None);
            assert_eq!(corners.facet_of_equal([VertexId(0), b, c]), None);
        }
        facets.sort_unstable();
        assert_eq!(facets, [0, 1, 2, 3]);
    }
}
