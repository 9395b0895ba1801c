//! A face without area along an edge of the hull lies on the facets of either side, and agrees with
//! both alike.

use cranny_exact::DVec3;
use cranny_geometry::{FaceId, Mesh, VertexId};

use super::{deformed, model};

/// Which vertex moves.
const MOVED: VertexId = VertexId(1);

/// Two lids meet in the edge from 6 to 8 once vertex [`MOVED`] stands out; the face [8, 10, 9] has
/// its corners there.
fn body() -> Mesh {
    let vertices = [
        [0.0, 1.0, 1.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.75],
        [0.0, 1.0, 2.0],
        [1.0, 0.0, 2.0],
        [0.0, 1.5, 0.5],
        [0.25, 1.90625, 0.0],
        [0.0, 1.5, 2.0],
        [0.0, 1.5, 1.5],
        [0.0, 1.5, 1.546875],
        [1.0, 2.0, 2.0],
        [1.0, 2.0, 1.5],
        [2.0, 1.0, 1.0],
        [2.0, 0.0, 0.5],
        [2.0, 1.0, 2.0],
        [2.0, 2.0, 1.0],
        [2.0, 2.0, 0.0],
        [2.0, 1.5, 0.0],
        [2.0, 1.5, 1.5],
        [2.0, 2.0, 1.5],
        [2.0, 2.0, 1.75],
        [2.0, 1.5, 2.0],
        [1.5, 2.0, 1.5],
        [1.5, 2.0, 2.0],
        [1.5, 1.5, 2.0],
    ];
    #[rustfmt::skip]
    let faces = vec![
        [0, 1, 2], [3, 4, 0], [0, 5, 3], [0, 6, 1], [6, 7, 1], [4, 8, 9], [9, 10, 7], [8, 10, 9],
        [9, 7, 6], [4, 6, 0], [9, 6, 4], [10, 8, 11], [10, 11, 12], [10, 12, 7], [3, 5, 11],
        [4, 3, 8], [3, 11, 8], [2, 13, 14], [5, 14, 15], [14, 5, 2], [5, 0, 2], [16, 7, 13],
        [7, 17, 18], [17, 7, 16], [18, 16, 13], [17, 16, 18], [18, 13, 2], [7, 2, 1], [18, 2, 7],
        [14, 13, 19], [13, 7, 20], [19, 20, 21], [13, 20, 19], [19, 21, 22], [14, 22, 15],
        [19, 22, 14], [7, 12, 23], [12, 11, 24], [23, 24, 21], [12, 24, 23], [23, 21, 20],
        [23, 20, 7], [5, 15, 22], [25, 22, 21], [5, 22, 25], [25, 21, 24], [5, 24, 11],
        [25, 24, 5],
    ];
    Mesh::new(vertices.map(DVec3::from_array).to_vec(), faces).unwrap()
}

#[test]
fn it_lies_on_the_same_facet_after_a_deformation_as_after_a_rebuild() {
    // The moves give the hull another box, by which its facets are numbered anew, and not as a
    // rebuild numbers them: the face went to the facet with the lower number, and two concavities
    // joined there or did not.
    let flat = FaceId(7);
    let before = model(body());
    assert_eq!(before.mesh().area_vector(flat), DVec3::ZERO);
    for steps in 1..16 {
        let mut model = before.clone();
        let place = DVec3::new(-f64::from(steps) / 64.0, 1.0, 0.0);
        let change = deformed(&mut model, &[(MOVED, place)], &format!("{steps} steps"));
        assert!(change.hull && !change.work.is_anew, "{steps}");
        assert!(model.features().is_convex(flat), "{steps}");
    }
}
