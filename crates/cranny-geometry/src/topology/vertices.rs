//! The faces at each vertex.

use crate::ids::FaceId;
use crate::mesh::Mesh;

/// Where the faces of each vertex begin, and one more, where the last end; and these faces.
pub(super) fn faces_of_vertices(mesh: &Mesh) -> (Vec<u32>, Vec<FaceId>) {
    let mut starts = vec![0u32; mesh.vertices().len() + 1];
    for &i in mesh.faces().as_flattened() {
        starts[i as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let faces = faces_in_rows(mesh, &starts);
    debug_assert!(faces.is_some(), "each row is as long as it was counted");
    (starts, faces.unwrap_or_default())
}

/// The faces of each vertex in its row, if rows that begin at `starts` have just the length for that.
pub(super) fn faces_in_rows(mesh: &Mesh, starts: &[u32]) -> Option<Vec<FaceId>> {
    let (&first, ends) = starts.split_first()?;
    let mut places = starts.to_vec();
    let mut faces = vec![FaceId(0); 3 * mesh.faces().len()];
    for (f, corners) in (0..).zip(mesh.faces()) {
        for &i in corners {
            let place = &mut places[i as usize];
            *faces.get_mut(*place as usize)? = FaceId(f);
            *place += 1;
        }
    }
    // Each row was filled from its beginning to where the next one begins, as often as there are places.
    (first == 0 && places[..ends.len()] == *ends).then_some(faces)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{points, tetrahedron};
    use super::*;

    #[test]
    fn rows_of_vertices_have_just_the_length_that_is_needed() {
        let mesh = Mesh::new(points(5), tetrahedron(0)).unwrap();
        let (starts, faces) = faces_of_vertices(&mesh);
        assert_eq!(starts, [0, 3, 6, 9, 12, 12]);
        assert_eq!(faces_in_rows(&mesh, &starts), Some(faces));
        for wrong in [
            [0, 2, 6, 9, 12, 12],
            [0, 4, 6, 9, 12, 12],
            [1, 3, 6, 9, 12, 12],
            [0, 3, 6, 9, 12, 13],
            [0, 3, 6, u32::MAX, 12, 12],
            [3, 0, 6, 9, 12, 12],
        ] {
            assert_eq!(faces_in_rows(&mesh, &wrong), None, "{wrong:?}");
        }
    }
}
