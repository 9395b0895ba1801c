//! Defects seeded into sound meshes: the scan finds exactly those, repairs undo them, and what is
//! repaired lies where it lay, by an independent measurement.

mod distance;
mod outcome;
mod seeds;

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Tolerance};
use cranny_geometry::{
    BuildError, BuildOptions, Element, FaceId, FindingKind, MeetingScan, Mesh, Model, Repair,
    RepairKind, Report,
};
use cranny_shapes::Shape;
use cranny_testkit::Rng;

use crate::repair::distance::assert_same_surface;
use crate::repair::outcome::{built, deviation, kinds, repaired, triangles, volume, within};
use crate::repair::seeds::{cuboid, edited, moved, torus, turned, with_t_vertices};

#[test]
fn sound_generators_have_nothing_but_flat_edges_and_stay_as_they_are() {
    for shape in Shape::defaults() {
        let mesh = shape.build().unwrap();
        let (model, report) = built(&mesh, Repair::None);
        assert_eq!(kinds(&report), BTreeMap::new(), "{}", shape.name());
        assert!(report.is_sound() && report.meetings == MeetingScan::Complete, "{}", shape.name());
        let (full, after) = built(&mesh, Repair::Full);
        assert_eq!((full.digest(), deviation(&after)), (model.digest(), 0.0), "{}", shape.name());
        assert!(after.repairs().is_empty(), "{}: {:?}", shape.name(), after.repairs());
    }
}

#[test]
fn flat_edges_are_one_finding() {
    let (_, report) = built(&cuboid(), Repair::None);
    let [finding] = report.findings.as_slice() else { panic!("{:?}", report.findings) };
    assert_eq!((finding.kind, finding.count), (FindingKind::CoplanarAdjacent, 6));
    assert!(finding.ids.len() == 2 && finding.kind.limits().is_empty());
    assert_eq!(finding.measure, 80f64.sqrt()); // the diagonal of the 4 by 8 side
}

#[test]
fn copies_of_faces_go() {
    // On the hull, what lies twice in one place also makes a negative cap.
    let without_caps = |report: &Report| {
        let mut found = kinds(report);
        found.remove("negative_cap");
        found
    };
    for base in [cuboid(), torus()] {
        let twice = edited(&base, |_, faces| faces.push(faces[5]));
        let (_, before) = built(&twice, Repair::None);
        assert_eq!(
            without_caps(&before),
            [("duplicate_faces", 1), ("non_manifold_edge", 3)].into()
        );
        let (model, after) = built(&twice, Repair::Safe);
        assert_eq!(kinds(&after), BTreeMap::new());
        assert_eq!(repaired(&after), [(RepairKind::DroppedCoincidentFaces, 1)]);
        assert_eq!(after.repairs()[0].faces, [base.faces().len() as u32]);
        assert_eq!(triangles(model.mesh()), triangles(&base));

        let there_and_back = edited(&base, |_, faces| {
            let [a, b, c] = faces[7];
            faces.extend([[b, c, a], [a, c, b]]);
        });
        let (_, before) = built(&there_and_back, Repair::None);
        assert_eq!(without_caps(&before), [("opposite_faces", 1), ("non_manifold_edge", 3)].into());
        let (model, after) = built(&there_and_back, Repair::Safe);
        assert_eq!(
            (kinds(&after), model.mesh().faces().len()),
            (BTreeMap::new(), base.faces().len())
        );
        assert!(after.closed);

        // One copy too many, the wrong way round, and before the one that fits; on the hull and off
        // it.
        for f in [0, 7, 11] {
            let back =
                edited(&base, |_, faces| faces.insert(0, [faces[f][1], faces[f][0], faces[f][2]]));
            let (model, after) = built(&back, Repair::Safe);
            assert_eq!(kinds(&after), BTreeMap::new());
            assert_eq!(repaired(&after), [(RepairKind::DroppedCoincidentFaces, 1)]);
            assert_eq!(after.repairs()[0].faces, [0]);
            assert_eq!(triangles(model.mesh()), triangles(&base));
        }
    }
}

#[test]
fn a_lone_sheet_with_a_back_side_stays() {
    let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let sheet = Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    for repair in [Repair::Safe, Repair::Full] {
        let (model, report) = built(&sheet, repair);
        assert_eq!(model.mesh().faces().len(), 2);
        assert_eq!(kinds(&report), [("opposite_faces", 1)].into());
    }
}

#[test]
fn turned_faces_are_turned_back() {
    for base in [cuboid(), torus()] {
        let one = edited(&base, |_, faces| faces[3].swap(0, 1));
        let (_, before) = built(&one, Repair::None);
        assert_eq!(kinds(&before), [("back_faces", 1), ("contradictory_edge", 3)].into());
        let found = before.findings.iter().find(|f| f.kind == FindingKind::BackFaces).unwrap();
        assert_eq!(found.ids, [3]);
        let (model, after) = built(&one, Repair::Safe);
        assert_eq!((kinds(&after), after.closed), (BTreeMap::new(), true));
        assert_eq!(repaired(&after), [(RepairKind::TurnedBackFaces, 1)]);
        assert_eq!(after.repairs()[0].faces, [3]);
        assert!(model.mass_properties().unwrap().volume > 0.0);
        assert_eq!(model.filed_face(FaceId(3)), FaceId(3));
    }
}

#[test]
fn a_strip_with_half_a_turn_has_no_orientation() {
    let rim = |i: u32| {
        let (x, y) = [(2.0, 0.0), (1.0, 2.0), (-1.0, 2.0), (-2.0, 0.0), (0.0, -2.0)][i as usize];
        [DVec3::new(x, y, -0.5), DVec3::new(x, y, 0.5 + 0.1 * f64::from(i))]
    };
    let vertices: Vec<DVec3> = (0..5).flat_map(rim).collect();
    let mut faces = Vec::new();
    for i in 0..5u32 {
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i == 4 { (1, 0) } else { (a + 2, b + 2) };
        faces.extend([[a, c, b], [b, c, d]]);
    }
    let strip = Mesh::new(vertices, faces).unwrap();
    for repair in [Repair::None, Repair::Full] {
        let (model, report) = built(&strip, repair);
        assert_eq!(kinds(&report)["non_orientable"], 1);
        assert_eq!(triangles(model.mesh()), triangles(&strip));
    }
}

#[test]
fn t_vertices_are_stitched_several_an_edge() {
    for (parts, t_vertices) in [(2, 1), (4, 3)] {
        let seeded = with_t_vertices(&cuboid(), 0, parts, DVec3::ZERO);
        let (_, before) = built(&seeded, Repair::None);
        // The long side is open, and every piece of it.
        let open = 1 + parts as usize;
        let expected = [("open_edge", open), ("t_vertex", t_vertices)];
        assert_eq!(kinds(&before), expected.into());
        let (model, after) = built(&seeded, Repair::Safe);
        assert_eq!(
            (kinds(&after), after.closed, volume(&after)),
            (BTreeMap::new(), true, Some(64.0))
        );
        assert_eq!(repaired(&after), [(RepairKind::SplitEdges, t_vertices)]);
        assert_eq!(deviation(&after), 0.0);
        assert_eq!(model.mesh().faces().len(), 12 + 2 * t_vertices);
        assert_same_surface(&seeded, &model, &after);
    }
}

#[test]
fn filed_faces_are_known_when_faces_are_parted() {
    let seeded = with_t_vertices(&cuboid(), 0, 4, DVec3::ZERO);
    let (model, _) = built(&seeded, Repair::Safe);
    let mut parts = BTreeMap::<u32, f64>::new();
    for face in (0..model.mesh().faces().len() as u32).map(FaceId) {
        *parts.entry(model.filed_face(face).0).or_default() +=
            model.mesh().area_vector(face).length();
    }
    for (filed, area) in parts {
        assert_eq!(area, seeded.area_vector(FaceId(filed)).length(), "face {filed}");
    }
}

#[test]
fn t_vertices_off_the_edge_are_stitched_within_the_distance_only() {
    let lift = DVec3::new(0.001, 0.001, 0.001);
    for base in [cuboid(), torus()] {
        for face in [0, 5, 11] {
            let seeded = with_t_vertices(&base, face, 4, lift);
            let (model, after) = within(&seeded, Repair::Safe, 0.002);
            assert!(after.closed && deviation(&after) > 0.0005, "{face}: {after:?}");
            assert_same_surface(&seeded, &model, &after);
            let (model, after) = within(&seeded, Repair::Safe, 0.0005);
            assert!(!after.closed && after.repairs().is_empty());
            assert_eq!(triangles(model.mesh()), triangles(&seeded));
        }
    }
}

#[test]
fn cracks_are_welded_within_the_distance_only() {
    for base in [cuboid(), torus()] {
        // One face hangs on vertices of its own, a little off.
        let cracked = edited(&base, |vertices, faces| {
            for corner in 0..3 {
                let p = vertices[faces[4][corner] as usize];
                faces[4][corner] = vertices.len() as u32;
                vertices.push(p + DVec3::new(0.0003, -0.0004, 0.0));
            }
        });
        let (_, before) = within(&cracked, Repair::None, 0.001);
        let found = kinds(&before);
        assert_eq!(
            (found["open_edge"], found["near_vertices"], found["several_shells"]),
            (6, 3, 2)
        );
        let (model, after) = within(&cracked, Repair::Safe, 0.001);
        assert_eq!((kinds(&after), after.closed), (BTreeMap::new(), true));
        assert_eq!(repaired(&after), [(RepairKind::WeldedNearVertices, 3)]);
        let off = deviation(&after);
        assert!((0.000_499_9..0.000_500_1).contains(&off), "{off:e}");
        assert_same_surface(&cracked, &model, &after);
        let (_, apart) = within(&cracked, Repair::Safe, 0.0002);
        // Vertices that slid along an edge are in it now; none is welded, and the crack stays.
        let kinds: Vec<_> = apart.repairs().iter().map(|r| r.kind).collect();
        assert!(!apart.closed && !kinds.contains(&RepairKind::WeldedNearVertices), "{kinds:?}");
    }
}

#[test]
fn fine_detail_of_a_closed_mesh_is_not_welded() {
    // A vertex drawn close to another: no crack.
    let close = edited(&cuboid(), |vertices, faces| {
        let (p, new) = (vertices[faces[0][0] as usize], vertices.len() as u32);
        let [a, b, c] = faces[0];
        let middle = (vertices[b as usize] + vertices[c as usize] + p) / 3.0;
        vertices.push(p.lerp(middle, 0.000_001));
        faces[0] = [a, b, new];
        faces.extend([[b, c, new], [c, a, new]]);
    });
    let (model, report) = within(&close, Repair::Full, 0.001);
    assert_eq!(triangles(model.mesh()), triangles(&close));
    assert_eq!(kinds(&report)["near_vertices"], 1);
    assert!(report.closed && report.repairs().is_empty());
}

#[test]
fn a_face_without_area_that_stitches_a_t_vertex_goes() {
    let seeded = edited(&with_t_vertices(&cuboid(), 0, 2, DVec3::ZERO), |vertices, faces| {
        // The pieces of the side are of face 12 and face 0; the long side is the neighbour's.
        let new = vertices.len() as u32 - 1;
        let [a, b] = [faces[12][0], faces[0][1]];
        faces.push([b, new, a]);
    });
    let (_, before) = built(&seeded, Repair::None);
    assert!(before.closed);
    assert_eq!(kinds(&before)["zero_area_face"], 1);
    let (model, after) = built(&seeded, Repair::Safe);
    assert_eq!((kinds(&after), volume(&after)), (BTreeMap::new(), Some(64.0)));
    assert_eq!(
        repaired(&after),
        [(RepairKind::SplitEdges, 1), (RepairKind::DroppedCollapsedFaces, 1)]
    );
    assert_same_surface(&seeded, &model, &after);
}

#[test]
fn faces_without_area_on_faces_without_area_are_seen_through() {
    let seeded = edited(&with_t_vertices(&cuboid(), 0, 4, DVec3::ZERO), |vertices, faces| {
        let third = vertices.len() as u32 - 1;
        let [first, second] = [third - 2, third - 1];
        let [a, b] = [faces[12][0], faces[0][1]];
        // From the neighbour's long side to two halves, from each of these to two quarters.
        faces.extend([[b, second, a], [second, first, a], [b, third, second]]);
    });
    let (_, before) = built(&seeded, Repair::None);
    assert_eq!((before.closed, kinds(&before)["zero_area_face"]), (true, 3));
    let (model, after) = built(&seeded, Repair::Safe);
    assert_eq!((kinds(&after), volume(&after)), (BTreeMap::new(), Some(64.0)));
    assert_eq!(model.mesh().faces().len(), 12 + 2 * 3);
    assert_same_surface(&seeded, &model, &after);
}

#[test]
fn moves_do_not_add_up() {
    // A face below an edge, its two corners 0.9 of the distance off the edge's ends; a vertex on
    // the edge's other side, 0.9 above it: within the distance once the corners are welded.
    let vertices = [
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [2.0, 0.0009, 0.0],
        [2.0, 2.0, 0.0],
        [0.0, -0.0009, 0.0],
        [4.0, -0.0009, 0.0],
        [2.0, -2.0, 0.0],
        [2.0, 2.0, 2.0],
    ];
    let faces = vec![[0, 2, 3], [2, 1, 3], [5, 4, 6], [0, 3, 7], [3, 1, 7]];
    let mesh = Mesh::new(vertices.map(DVec3::from_array).to_vec(), faces).unwrap();
    let (model, report) = within(&mesh, Repair::Safe, 0.001);
    assert_eq!(repaired(&report), [(RepairKind::WeldedNearVertices, 2)]);
    assert_same_surface(&mesh, &model, &report);
    // Twice the distance allows for both.
    let (_, report) = within(&mesh, Repair::Safe, 0.002);
    assert_eq!(report.repairs()[1].kind, RepairKind::SplitEdges);
}

#[test]
fn a_collapsed_face_that_nothing_covers_stays() {
    let lone = edited(&cuboid(), |vertices, faces| {
        let n = vertices.len() as u32;
        vertices.extend([DVec3::splat(20.0), DVec3::splat(21.0), DVec3::splat(22.0)]);
        faces.extend([[n, n + 1, n + 2], [n, n, n + 1], [0, 0, 0]]);
    });
    let (model, report) = built(&lone, Repair::Full);
    assert_eq!(kinds(&report)["zero_area_face"], 2); // the one in a corner of the box goes
    assert_eq!(model.mesh().faces().len(), 14);
    assert_same_surface(&lone, &model, &report);
}

#[test]
fn holes_are_told_and_not_filled() {
    let holed = edited(&torus(), |_, faces| {
        faces.remove(17);
    });
    let (_, before) = built(&holed, Repair::None);
    assert_eq!(kinds(&before), [("open_edge", 3)].into());
    assert!(!before.is_sound());
    let (model, after) = built(&holed, Repair::Full);
    assert!(triangles(model.mesh()) == triangles(&holed) && !after.closed);
}

#[test]
fn needles_and_pinched_vertices_are_told() {
    let needle = with_t_vertices(&cuboid(), 0, 2, DVec3::ZERO);
    let needle = edited(&needle, |vertices, faces| {
        // The crack is bridged by a face of a height of 1/1024.
        let new = vertices.len() as u32 - 1;
        let [a, b] = [faces[12][0], faces[0][1]];
        vertices[new as usize] += DVec3::splat(1.0 / 1024.0);
        faces.push([b, new, a]);
    });
    let (_, report) = within(&needle, Repair::None, 1.0 / 256.0);
    assert_eq!(kinds(&report)["needle_face"], 1);
    assert!(!kinds(&within(&needle, Repair::None, 1.0 / 4096.0).1).contains_key("needle_face"));

    let corner = cuboid().joined(&moved(&cuboid(), DVec3::new(2.0, 4.0, 8.0)));
    let (_, report) = built(&corner, Repair::Full);
    let expected = [("non_manifold_vertex", 1), ("several_shells", 2)];
    let several = report.findings.iter().find(|f| f.kind == FindingKind::SeveralShells).unwrap();
    assert_eq!((several.kind.element(), &several.ids[..]), (Element::Face, &[0, 12][..]));
    let mut found = kinds(&report);
    // Faces of the two boxes that meet at the shared corner only, meet there by right.
    assert_eq!(found.remove("self_touch"), None);
    assert_eq!(found, expected.into());
    assert!(report.closed);
}

#[test]
fn shells_that_pass_through_each_other_are_told_with_their_faces() {
    let through = moved(&cuboid(), DVec3::new(0.5, 1.0, 5.0));
    let (model, report) = built(&cuboid().joined(&through), Repair::Full);
    assert_eq!(model.mesh().faces().len(), 24);
    let crossing: Vec<_> =
        report.findings.iter().filter(|f| f.kind == FindingKind::SelfIntersection).collect();
    assert!(!crossing.is_empty());
    assert!(crossing.iter().all(|f| f.ids[0] < 12 && f.ids[1] >= 12 && f.ids.len() == 2));
    // The same where the box of one holds that of the other: a spike out of a pyramid's side.
    let spike = cuboid().scaled(DVec3::new(0.125, 0.125, 0.75)).unwrap();
    let pyramid = cranny_shapes::Pyramid { base: 8.0, height: 8.0 }.build().unwrap();
    let poking = moved(&spike, pyramid.bounds().center() - 1.5 * DVec3::X);
    let both = pyramid.joined(&poking);
    let (_, report) = built(&both, Repair::Full);
    assert!(kinds(&report)["self_intersection"] > 0 && report.repairs().is_empty());
    assert!(!kinds(&report).contains_key("nested_solid"));

    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let (_, unseen) = Model::build(model.mesh().clone(), &options).unwrap();
    assert_eq!(
        (unseen.meetings, kinds(&unseen)),
        (MeetingScan::Skipped, [("several_shells", 2)].into())
    );
}

#[test]
fn a_face_over_a_face_overlaps_it() {
    let over = edited(&cuboid(), |vertices, faces| {
        let n = vertices.len() as u32;
        let corners = [[1.0, 0.5, 0.5], [1.0, 1.5, 0.5], [1.0, 0.5, 1.5]];
        vertices.extend(corners.map(DVec3::from_array));
        faces.push([n, n + 1, n + 2]);
    });
    let (_, report) = built(&over, Repair::None);
    assert!(kinds(&report)["coplanar_overlap"] >= 1);
    assert_eq!(kinds(&report)["open_edge"], 3);
}

#[test]
fn shells_in_shells_are_cavities_or_solids() {
    let outer = cuboid();
    let inner = outer.scaled(DVec3::splat(0.5)).unwrap();

    let solid = outer.clone().joined(&inner);
    let (_, reported) = built(&solid, Repair::Safe);
    assert_eq!(kinds(&reported), [("nested_solid", 1), ("several_shells", 2)].into());
    assert_eq!((volume(&reported), reported.repairs().len()), (Some(72.0), 0));
    let (_, hollow) = built(&solid, Repair::Full);
    assert_eq!(kinds(&hollow), [("cavity", 1), ("several_shells", 2)].into());
    assert_eq!(volume(&hollow), Some(56.0));
    assert_eq!(repaired(&hollow), [(RepairKind::TurnedNestedComponents, 1)]);

    let filed_hollow = outer.clone().joined(&turned(&inner));
    for repair in [Repair::None, Repair::Safe, Repair::Full] {
        let (_, report) = built(&filed_hollow, repair);
        assert_eq!((volume(&report), report.repairs().len()), (Some(56.0), 0));
    }

    // A core in the cavity, filed any way: by parity it is a solid.
    let core = inner.scaled(DVec3::splat(0.5)).unwrap();
    for core in [core.clone(), turned(&core)] {
        let (_, report) = built(&outer.clone().joined(&inner).joined(&core), Repair::Full);
        assert_eq!(volume(&report), Some(57.0));
    }
}

#[test]
fn components_that_look_inwards_are_turned_with_what_they_hold() {
    let hollow = cuboid().joined(&turned(&cuboid().scaled(DVec3::splat(0.5)).unwrap()));
    let aside = moved(&cuboid().scaled(DVec3::splat(2.0)).unwrap(), DVec3::new(40.0, 0.0, 0.0));
    // All in all the volume is positive, so nothing is turned by default.
    let seeded = turned(&hollow).joined(&aside);
    let (_, before) = built(&seeded, Repair::None);
    let expected = [("inside_out", 1), ("nested_solid", 1), ("several_shells", 3)];
    assert_eq!(kinds(&before), expected.into());
    let (_, after) = built(&seeded, Repair::Safe);
    assert_eq!(kinds(&after), [("cavity", 1), ("several_shells", 3)].into());
    assert_eq!(repaired(&after), [(RepairKind::TurnedComponents, 2)]);
    assert_eq!(volume(&after), Some(56.0 + 512.0));

    let (model, whole) = built(&turned(&torus()), Repair::None);
    assert_eq!(repaired(&whole), [(RepairKind::TurnedRightSideOut, torus().faces().len())]);
    assert_eq!(model.digest(), built(&turned(&torus()), Repair::Safe).0.digest());
}

#[test]
fn sheets_within_a_solid_go_by_full_only() {
    // Mirrored, so that the diagonals of the two walls are the same.
    let mirrored = cuboid().scaled(DVec3::new(-1.0, 1.0, 1.0)).unwrap();
    let glued = cuboid().joined(&moved(&mirrored, DVec3::new(2.0, 0.0, 0.0)));
    let (_, before) = built(&glued, Repair::Safe);
    assert_eq!(kinds(&before)["opposite_faces"], 2);
    let (model, after) = built(&glued, Repair::Full);
    assert_eq!(repaired(&after).last(), Some(&(RepairKind::DroppedInnerSheets, 4)));
    assert_eq!((volume(&after), model.mesh().faces().len()), (Some(128.0), 20));
    assert!(after.closed && kinds(&after).is_empty(), "{:?}", kinds(&after));
}

#[test]
fn a_weld_distance_is_checked() {
    for weld_distance in [-1.0, f64::NAN, f64::INFINITY, 1.0] {
        let tolerance = Some(Tolerance { weld_distance });
        let options = BuildOptions { tolerance, ..BuildOptions::default() };
        let refused = Model::build(cuboid(), &options).unwrap_err();
        assert!(matches!(refused, BuildError::WeldDistance { .. }), "{refused}");
    }
    assert_eq!(within(&cuboid(), Repair::Safe, 0.0).1.weld_distance, 0.0);
}

#[test]
fn powers_of_two_change_nothing_that_is_found_or_repaired() {
    let seeded = with_t_vertices(&torus(), 3, 3, DVec3::ZERO);
    let seeded = edited(&seeded, |_, faces| {
        faces.push(faces[9]);
        faces[20].swap(0, 1);
    });
    let (model, report) = built(&seeded, Repair::Safe);
    for scale in [1024.0, 1.0 / 1024.0] {
        let (scaled, other) = built(&seeded.scaled(DVec3::splat(scale)).unwrap(), Repair::Safe);
        assert_eq!(scaled.mesh().faces(), model.mesh().faces());
        assert_eq!(repaired(&other), repaired(&report));
        assert_eq!(kinds(&other), kinds(&report));
        assert_eq!(deviation(&other), scale * deviation(&report));
    }
}

/// Faces between few points of a small lattice: all kinds of degeneracy at once.
#[test]
fn any_soup_is_repaired_without_leaving_its_place() {
    let mut rng = Rng::new(7);
    let (mut parted, mut dropped) = (0, 0);
    for _ in 0..600 {
        let points = 4 + rng.below(12);
        let vertices = (0..points).map(|_| {
            let mut whole = || f64::from(rng.between(0, 4));
            let p = DVec3::new(whole(), whole(), whole());
            let mut jitter = || f64::from(rng.between(-1, 1)) / 128.0;
            p + DVec3::new(jitter(), 0.0, jitter())
        });
        let vertices: Vec<DVec3> = vertices.collect();
        let mut corner = || rng.below(points) as u32;
        let faces = (0..16).map(|_| [corner(), corner(), corner()]).collect();
        let soup = Mesh::new(vertices, faces).unwrap();
        for weld_distance in [0.0, 0.009 * soup.bounds().diagonal()] {
            let tolerance = Some(Tolerance { weld_distance });
            let options =
                BuildOptions { repair: Repair::Safe, tolerance, ..BuildOptions::default() };
            match Model::build(soup.clone(), &options) {
                Ok((model, report)) => {
                    model.topology().validate(model.mesh()).unwrap();
                    assert_same_surface(&soup, &model, &report);
                    parted +=
                        repaired(&report).iter().filter(|r| r.0 == RepairKind::SplitEdges).count();
                    dropped += soup.faces().len().saturating_sub(model.mesh().faces().len());
                }
                Err(error) => assert!(matches!(error, BuildError::OnlyDegenerateFaces { .. })),
            }
        }
    }
    assert!(parted > 100 && dropped > 1000, "{parted} {dropped}");
}
