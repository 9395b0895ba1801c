//! The list of candidates holds every pair of features that makes a contact: all pairs are tried.

use crate::answer::Counters;
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_testkit::Rng;

use super::super::*;
use crate::query::Placed;
use crate::search::{Candidate, Kind};

/// A contact by its features and the bits of its separation.
pub(super) type Made = ((Feature, Feature), u64);

pub(super) fn made(contacts: &[Contact]) -> Vec<Made> {
    let mut all: Vec<Made> = contacts.iter().map(|c| (c.id, c.separation.to_bits())).collect();
    all.sort_unstable();
    all
}

/// By every vertex and face, and every two edges.
pub(super) fn by_all_pairs(pair: &Pair, margin: f64) -> Vec<Made> {
    made(&of_all_pairs(pair, margin))
}

/// The contacts of every vertex and face, and of every two edges.
pub(super) fn of_all_pairs(pair: &Pair, margin: f64) -> Vec<Contact> {
    let [first, second] = Side::BOTH.map(|side| {
        let (mesh, edges) = (pair.mesh(side), pair.topology(side).edges());
        [mesh.vertices().len(), mesh.faces().len(), edges.len()].map(|n| n as u32)
    });
    let kinds = [
        (Kind::CornerFace, first[0], second[1]),
        (Kind::FaceCorner, first[1], second[0]),
        (Kind::Edges, first[2], second[2]),
    ];
    let mut found = Vec::new();
    for (kind, own, its) in kinds {
        for ids in (0..own).flat_map(|i| (0..its).map(move |k| [i, k])) {
            let candidate = Candidate { patches: 0, ids, bound: 0.0, reach: f32::INFINITY, kind };
            found.extend(list::contact(pair, &candidate, margin));
        }
    }
    found
}

/// By the list, without memory.
fn by_list(pair: &Pair, margin: f64) -> Vec<Made> {
    let (mut coherent, mut memory) = (Coherent::default(), ContactMemory::default());
    coherent.begin(pair);
    made(&across_gaps(pair, margin, (&mut coherent, &mut memory), &mut Counters::default()))
}

/// A blade: its edge, of length `2 size` along x about the origin, is uppermost. Another one, of
/// length 2, lies far below.
fn blades(size: f64) -> Model {
    let corners = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.1, 0.3, -0.5], [-0.2, -0.4, -0.4]];
    let corners = corners.map(DVec3::from_array);
    let below = corners.map(|p| p - 9.0 * DVec3::Z);
    let vertices = corners.iter().map(|p| *p * size).chain(below).collect();
    let faces = [[0, 1, 2], [1, 0, 3], [0, 2, 3], [2, 1, 3]];
    let faces = faces.iter().copied().chain(faces.map(|f| f.map(|v| v + 4))).collect();
    Model::build(Mesh::new(vertices, faces).unwrap(), &BuildOptions::default()).unwrap().0
}

/// Edges that cross at a small angle, and edges so short that their squares underflow in single
/// precision.
#[test]
fn edges_that_are_all_but_parallel_or_all_but_points_are_listed() {
    let mut rng = Rng::new(3);
    let kinds = [(1.0, 1e-3), (0.01, 1e-3), (1e-10, 0.3), (1e-12, 0.3)];
    let bodies = kinds.map(|(size, _)| blades(size));
    let mut crossed = [0; 4];
    for round in 0..8_000 {
        let kind = round % 4;
        let ((size, sine), body) = (kinds[kind], &bodies[kind]);
        let sine = sine * (1.0 + 0.02 * rng.unit().abs());
        let upside_down = DQuat::from_rotation_z(sine.asin()) * DQuat::from_rotation_x(3.1);
        let (across, height) = (0.1 * sine * rng.unit(), 0.05 * rng.unit().abs());
        let turned = Pose {
            rotation: upside_down.normalize(),
            translation: size * DVec3::new(rng.unit(), across, height),
        };
        // What is small is in its place.
        let at = match size < 1e-9 {
            true => Pose { rotation: rng.rotation(), translation: DVec3::ZERO },
            false => Pose { rotation: rng.rotation(), translation: rng.direction() },
        };
        let pair = Pair::of_accepted(
            Placed { model: body, pose: at.accepted().unwrap() },
            Placed { model: body, pose: at.compose(&turned).accepted().unwrap() },
        );
        let margin = 0.1 * size;
        let truth = by_all_pairs(&pair, margin);
        assert_eq!(by_list(&pair, margin), truth, "round {round}, size {size}, sine {sine}");
        let of_edges = |m: &&Made| matches!(m.0, (Feature::Edge(_), Feature::Edge(_)));
        crossed[kind] += truth.iter().filter(of_edges).count();
    }
    assert!(crossed.iter().all(|&n| n > 300), "{crossed:?}");
}

/// A triangle: its edges have no second face that says along which directions they are touched.
#[test]
fn edges_of_open_surfaces_are_listed() {
    let corners = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.1, 0.3, -2.0]].map(DVec3::from_array);
    let sheet = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let sheet = Model::build(sheet, &BuildOptions::default()).unwrap().0;
    let (mut rng, mut crossed) = (Rng::new(5), 0);
    for round in 0..300 {
        let rotation = (rng.rotation() * DQuat::from_rotation_x(3.1)).normalize();
        let pose = Pose { rotation, translation: 0.4 * rng.direction() };
        let [a, b] =
            [Pose::IDENTITY, pose.accepted().unwrap()].map(|pose| Placed { model: &sheet, pose });
        let pair = Pair::of_accepted(a, b);
        let truth = by_all_pairs(&pair, 0.3);
        assert_eq!(by_list(&pair, 0.3), truth, "round {round}");
        crossed += truth.iter().filter(|m| matches!(m.0, (Feature::Edge(_), _))).count();
    }
    assert!(crossed > 10, "{crossed}");
}

/// A speck rests, then spins in its place: no point of it spends a wide margin's skin, but other
/// edges come to face each other.
#[test]
fn a_list_does_not_outlast_its_turn() {
    let (large, small) = (blades(1.0), blades(1.0));
    let shrunk = small.mesh().vertices().iter().map(|p| *p * 0.01).collect();
    let small = Mesh::new(shrunk, small.mesh().faces().to_vec()).unwrap();
    let small = Model::build(small, &BuildOptions::default()).unwrap().0;
    let mut rng = Rng::new(6);
    for round in 0..60 {
        let (mut coherent, mut memory) = (Coherent::default(), ContactMemory::default());
        let (axis, mut rotation) = (rng.direction(), rng.rotation());
        let translation = DVec3::new(0.5 * rng.unit(), 0.1 * rng.unit(), 0.3);
        for frame in 0..30 {
            if frame > 6 {
                rotation = (DQuat::from_axis_angle(axis, 0.15) * rotation).normalize();
            }
            let pose = Pose { rotation, translation }.accepted().unwrap();
            let a = Placed { model: &large, pose: Pose::IDENTITY };
            let pair = Pair::of_accepted(a, Placed { model: &small, pose });
            coherent.begin(&pair);
            let kept = (&mut coherent, &mut memory);
            let warm = made(&across_gaps(&pair, 1.0, kept, &mut Counters::default()));
            coherent.end(&pair);
            assert_eq!(warm, by_all_pairs(&pair, 1.0), "round {round}, frame {frame}");
        }
    }
}

/// A box turned on a box: the common normal of crossing edges is that of their faces, where the
/// arcs of directions end.
#[test]
fn edges_of_faces_that_are_parallel_are_listed() {
    let cube = cranny_shapes::Shape::from(cranny_shapes::Cuboid::default()).build().unwrap();
    let cube = Model::build(cube, &BuildOptions::default()).unwrap().0;
    let (mut rng, mut crossed) = (Rng::new(7), 0);
    for round in 0..100 {
        let rotation = DQuat::from_rotation_z(0.5 + 0.2 * rng.unit());
        let translation = DVec3::new(0.6 * rng.unit(), 0.6 * rng.unit(), 1.01);
        let pose = Pose { rotation, translation }.accepted().unwrap();
        let [a, b] = [Pose::IDENTITY, pose].map(|pose| Placed { model: &cube, pose });
        let pair = Pair::of_accepted(a, b);
        let truth = by_all_pairs(&pair, 0.05);
        assert_eq!(by_list(&pair, 0.05), truth, "round {round}");
        crossed += truth.iter().filter(|m| matches!(m.0, (Feature::Edge(_), _))).count();
    }
    assert!(crossed > 50, "{crossed}");
}

/// A spike whose tip is at the origin: each of its three sides is cut from the tip to the middle of
/// the base, and the tip counts to a face that begins (or ends) at such a cut.
fn spike(begins: bool) -> Model {
    let base = [[1.0, 0.0], [-0.5, 0.75], [-0.5, -0.75]];
    let base = base.map(|[x, y]: [f64; 2]| DVec3::new(0.25 * x, 0.25 * y, -1.0));
    let ring = (0..3).flat_map(|i| [base[i], 0.5 * (base[i] + base[(i + 1) % 3])]);
    let vertices = std::iter::once(DVec3::ZERO).chain(ring).collect();
    // The base comes first: the other ends of the cuts count to it.
    let mut faces = vec![[2, 1, 6], [4, 3, 2], [6, 5, 4], [2, 6, 4]];
    let mut sides: Vec<[u32; 3]> = (0..6).map(|i| [0, 1 + i, 1 + (i + 1) % 6]).collect();
    sides.rotate_left(usize::from(begins));
    faces.append(&mut sides);
    Model::build(Mesh::new(vertices, faces).unwrap(), &BuildOptions::default()).unwrap().0
}

/// What is nearest to a tip may lie beyond the cut alone, of the sides of the face that speaks for
/// the tip.
#[test]
fn tips_of_narrow_faces_are_listed() {
    let bodies = [spike(true), spike(false)];
    let (mut rng, mut met) = (Rng::new(8), [0; 2]);
    for round in 0..1_000 {
        let [a, b] = [&bodies[round % 2], &bodies[round / 2 % 2]];
        let pose = Pose { rotation: rng.rotation(), translation: 0.1 * rng.direction() };
        let [a, b] = [(a, Pose::IDENTITY), (b, pose.accepted().unwrap())]
            .map(|(model, pose)| Placed { model, pose });
        let pair = Pair::of_accepted(a, b);
        let truth = by_all_pairs(&pair, 0.2);
        assert_eq!(by_list(&pair, 0.2), truth, "round {round}");
        let of_tips = |m: &&Made| matches!(m.0, (Feature::Vertex(_), Feature::Vertex(_)));
        // Of two vertices, the faces of the second body speak.
        met[round / 2 % 2] += truth.iter().filter(of_tips).count();
    }
    assert!(met.iter().all(|&n| n > 50), "{met:?}");
}

/// A face turns about its own middle, and shifts beneath a tip high above it: by more than any
/// distance changes.
#[test]
fn a_list_holds_what_turning_brings_before_a_face() {
    let large = {
        let small = spike(true);
        let vertices = small.mesh().vertices().iter().map(|p| *p * -4.0).collect();
        let faces = small.mesh().faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
        Model::build(Mesh::new(vertices, faces).unwrap(), &BuildOptions::default()).unwrap().0
    };
    let cube = cranny_shapes::Shape::from(cranny_shapes::Cuboid { size: [0.35; 3] });
    let cube = Model::build(cube.build().unwrap(), &BuildOptions::default()).unwrap().0;
    let (mut rng, mut lasted) = (Rng::new(9), 0);
    for round in 0..300 {
        let (mut coherent, mut memory) = (Coherent::default(), ContactMemory::default());
        let along = DVec3::new(rng.unit(), rng.unit(), 0.0).normalize();
        let start = DVec3::new(0.2 * rng.unit(), 0.2 * rng.unit(), -0.9 - 0.175);
        for frame in 0..24 {
            let frame = f64::from(frame);
            let rotation = DQuat::from_axis_angle(DVec3::Z.cross(along), 0.0125 * frame);
            let pose = Pose { rotation, translation: start + along * (0.011 * frame) };
            let a = Placed { model: &large, pose: Pose::IDENTITY };
            let pair =
                Pair::of_accepted(a, Placed { model: &cube, pose: pose.accepted().unwrap() });
            coherent.begin(&pair);
            let kept = (&mut coherent, &mut memory);
            let mut counters = Counters::default();
            let warm = made(&across_gaps(&pair, 1.0, kept, &mut counters));
            coherent.end(&pair);
            lasted += u32::from(counters.cluster_tests == 0);
            assert_eq!(warm, by_all_pairs(&pair, 1.0), "round {round}, frame {frame}");
        }
    }
    assert!(lasted > 500, "{lasted}");
}
