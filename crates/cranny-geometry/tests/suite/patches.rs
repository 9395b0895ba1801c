//! Patches: what they promise, on generated solids, soups and the corpus.

use crate::meshes::{scaled, soup, turned};
use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId, Mesh, PatchId, Patches, Topology, VertexId};
use cranny_shapes::{Cuboid, GolfBall, IsoBolt, IsoNut, Shape, Torus};
use cranny_testkit::{Q, Q3, Rng};

fn patches(mesh: &Mesh) -> Patches {
    let topology = Topology::of(mesh);
    let patches = Patches::of(mesh, &topology);
    patches.validate(mesh, &topology).unwrap();
    patches
}

/// Whether a face's normal lies in its patch's cone, in rational arithmetic.
fn lies_in_cone(mesh: &Mesh, patches: &Patches, face: FaceId) -> bool {
    let cone = patches.patch(patches.patch_of_face(face)).cone;
    let [a, b, c] = mesh.triangle(face).map(Q3::exactly);
    let normal = (&b - &a).cross(&(&c - &a));
    let axis = Q3::exactly(cone.axis);
    let along = normal.dot(&axis);
    let cosine = Q::try_from(cone.cosine).unwrap();
    let square = |q: &Q| q * q;
    along >= Q::ZERO && square(&along) >= square(&cosine) * normal.dot(&normal) * axis.dot(&axis)
}

#[test]
fn every_generator_is_divided() {
    for shape in Shape::defaults() {
        let mesh = shape.build().unwrap();
        assert!(patches(&mesh).len() > 1, "{}", shape.name());
        patches(&turned(&mesh));
    }
}

#[test]
fn counts_are_those_a_solver_can_use() {
    assert_eq!(patches(&Cuboid::default().build().unwrap()).len(), 6);
    let bolt = patches(&IsoBolt::default().build().unwrap());
    assert!((200..700).contains(&bolt.len()), "bolt: {}", bolt.len());
    let nut = patches(&IsoNut::default().build().unwrap());
    assert!((100..400).contains(&nut.len()), "nut: {}", nut.len());
    // Finer faces do not make more patches.
    let torus = |n| Torus { major_segments: 2 * n, minor_segments: n, ..Torus::default() };
    let [coarse, fine] = [32, 128].map(|n| patches(&torus(n).build().unwrap()).len());
    assert!((60..140).contains(&coarse) && (60..140).contains(&fine), "torus: {coarse}, {fine}");
    let ball = GolfBall { triangles: 50_000, ..GolfBall::default() };
    let ball = patches(&ball.build().unwrap());
    assert!((336..1_800).contains(&ball.len()), "ball: {}", ball.len());
}

#[test]
fn normals_lie_in_their_cones_exactly() {
    let torus = Torus::default().build().unwrap();
    let bolt = IsoBolt { segments: 24, ..IsoBolt::default() }.build().unwrap();
    let cuboid = Cuboid::default().build().unwrap();
    for mesh in [turned(&torus), turned(&bolt), turned(&cuboid), bolt] {
        let patches = patches(&mesh);
        assert!(patches.patches().iter().all(|p| p.needles == 0));
        for face in (0..mesh.faces().len() as u32).step_by(3).map(FaceId) {
            assert!(lies_in_cone(&mesh, &patches, face), "face {}", face.0);
        }
    }
}

#[test]
fn powers_of_two_change_nothing_but_lengths() {
    for shape in
        [Shape::from(Torus::default()), IsoBolt { segments: 24, ..IsoBolt::default() }.into()]
    {
        let mesh = turned(&shape.build().unwrap());
        let here = patches(&mesh);
        for exponent in [-150, -3, 7, 110] {
            let there = patches(&scaled(&mesh, 2f64.powi(exponent)));
            for face in (0..mesh.faces().len() as u32).map(FaceId) {
                assert_eq!(here.patch_of_face(face), there.patch_of_face(face));
            }
            for (p, q) in here.patches().iter().zip(there.patches()) {
                assert_eq!(p.cone, q.cone);
            }
        }
    }
}

#[test]
fn soups_are_divided_like_any_surface() {
    let mut rng = Rng::new(7);
    for round in 0..300 {
        let mesh = soup(&mut rng, 3 + round % 40);
        let patches = patches(&mesh);
        let topology = Topology::of(&mesh);
        for (e, edge) in (0..).map(EdgeId).zip(topology.edges()) {
            let patch = patches.patch_of_edge(&topology, e);
            let own = topology.half_edges(e).iter().map(|h| patches.patch_of_face(h.face()));
            assert_eq!(own.min(), Some(patch));
            for end in [edge.from, edge.to] {
                let lowest = topology.faces_at(end).iter().map(|&f| patches.patch_of_face(f)).min();
                assert_eq!(patches.patch_of_vertex(&topology, end), lowest);
                assert!(lowest.is_some_and(|p| p <= patch));
            }
        }
        for face in (0..mesh.faces().len() as u32).map(FaceId) {
            let patch = patches.patch(patches.patch_of_face(face));
            assert!(
                !patch.cone.is_bounded()
                    || patch.needles > 0
                    || lies_in_cone(&mesh, &patches, face)
            );
        }
    }
}

#[test]
fn a_vertex_that_no_face_names_is_in_no_patch() {
    let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mesh = Mesh::new(vertices, vec![[0, 1, 3]]).unwrap();
    let patches = patches(&mesh);
    let topology = Topology::of(&mesh);
    for v in [0, 1, 3] {
        assert_eq!(patches.patch_of_vertex(&topology, VertexId(v)), Some(PatchId(0)));
    }
    assert_eq!(patches.patch_of_vertex(&topology, VertexId(2)), None);
}
