//! Edges of a mesh that is drawn: which faces they join, which are creases, and whether the mesh is
//! closed.

use cranny_exact::DVec3;

use crate::style::CREASE_DEGREES;

/// The edges of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edges {
    pub(crate) all: Vec<Edge>,
    /// Whether each edge is passed as often one way as the other: such a mesh bounds a solid.
    pub(crate) closed: bool,
}

/// An edge that some drawn face has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Edge {
    /// Its ends among the corners that are drawn.
    pub(crate) ends: [u32; 2],
    /// The two faces that it joins; `None` where there are not two.
    pub(crate) faces: Option<[u32; 2]>,
    /// Whether it is drawn from wherever it is seen: its faces meet at an angle, or are not two.
    pub(crate) crease: bool,
}

/// A side of a face: where it runs from and to (the lower vertex first), and whose it is.
type Side = ([u32; 2], u32, u32);

impl Edges {
    /// Of faces by vertex index. `drawn` holds the corners of the first of them, three each; the
    /// others have no area. `normals` are unit.
    pub(crate) fn of(faces: &[[u32; 3]], drawn: &[u32], normals: &[DVec3]) -> Self {
        let mut sides: Vec<Side> = Vec::with_capacity(3 * faces.len());
        let mut balance = 0usize;
        for (f, corners) in (0u32..).zip(faces) {
            for k in 0..3usize {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                if from != to {
                    sides.push(([from.min(to), from.max(to)], f, k as u32));
                }
            }
        }
        sides.sort_unstable();
        let mut all = Vec::with_capacity(sides.len() / 2 + 1);
        for group in sides.chunk_by(|a, b| a.0 == b.0) {
            let forward =
                group.iter().filter(|s| faces[s.1 as usize][s.2 as usize] == s.0[0]).count();
            balance += forward.abs_diff(group.len() - forward);
            all.extend(edge(group, drawn, normals));
        }
        Self { all, closed: balance == 0 && !faces.is_empty() }
    }
}

fn edge(group: &[Side], drawn: &[u32], normals: &[DVec3]) -> Option<Edge> {
    let mut seen = group.iter().filter(|side| 3 * (side.1 as usize) < drawn.len());
    let &(_, face, k) = seen.next()?;
    let ends = [k, (k + 1) % 3].map(|corner| drawn[(3 * face + corner) as usize]);
    let (second, third) = (seen.next(), seen.next());
    let faces = match (second, third) {
        (Some(&(_, other, _)), None) => Some([face, other]),
        _ => None,
    };
    let flat = CREASE_DEGREES.to_radians().cos();
    let crease = faces.is_none_or(|[a, b]| normals[a as usize].dot(normals[b as usize]) < flat);
    Some(Edge { ends, faces, crease })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folded_square_has_one_inner_edge_that_is_a_crease_where_the_fold_is_sharp() {
        for (height, crease) in [(0.1, false), (1.0, true)] {
            let a = DVec3::new(-height, 0.0, 1.0).normalize();
            let normals = [a, DVec3::new(height, 0.0, 1.0).normalize()];
            let edges = Edges::of(&[[0, 1, 2], [0, 2, 3]], &[0, 1, 2, 0, 2, 3], &normals);
            let inner: Vec<_> = edges.all.iter().filter(|e| e.faces.is_some()).collect();
            assert_eq!((edges.all.len(), inner.len(), inner[0].crease), (5, 1, crease));
            assert!(!edges.closed);
        }
    }

    #[test]
    fn a_tetrahedron_is_closed_and_one_with_a_turned_face_is_not() {
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let normals = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X];
        assert!(Edges::of(&faces, faces.as_flattened(), &normals).closed);
        let turned = [[0, 1, 2], faces[1], faces[2], faces[3]];
        assert!(!Edges::of(&turned, turned.as_flattened(), &normals).closed);
        assert!(!Edges::of(&[], &[], &[]).closed);
    }

    #[test]
    fn faces_without_area_close_a_mesh_and_have_no_edges_of_their_own() {
        // A triangle over a T-vertex on each side: the flat face joins both.
        let faces = [[0, 1, 2], [2, 3, 0], [1, 0, 3], [1, 3, 2]];
        let drawn = faces[..3].as_flattened();
        let edges = Edges::of(&faces, drawn, &[DVec3::Z, DVec3::Z, DVec3::NEG_Z]);
        assert!(edges.closed && edges.all.len() == 6, "{edges:?}");
    }
}
