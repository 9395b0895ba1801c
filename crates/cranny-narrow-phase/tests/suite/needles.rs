//! Faces without area take no contact away: a cube one edge of which carries such a face, and the
//! tip of an octahedron beside it.
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_testkit::bodies::octahedron;

/// Unit cube 0..1, edge from (1,1,0) to (1,1,1) with a vertex in its middle, and a face without
/// area there.
fn cube(first: bool) -> Mesh {
    let v = |x: i32, y: i32, z: i32| DVec3::new(x.into(), y.into(), z.into());
    let vertices = vec![
        v(0, 0, 0),
        v(1, 0, 0),
        v(1, 1, 0),
        v(0, 1, 0),
        v(0, 0, 1),
        v(1, 0, 1),
        v(1, 1, 1),
        v(0, 1, 1),
        DVec3::new(1.0, 1.0, 0.5),
    ];
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        // y = 1
        [3, 7, 6],
        [3, 6, 2],
        // x = 0
        [0, 4, 7],
        [0, 7, 3],
        // x = 1, with the vertex 8
        [1, 2, 8],
        [1, 8, 6],
        [1, 6, 5],
    ];
    // without area: undoes 2-8, 8-6 of x = 1 and 6-2 of y = 1
    let flat = [8, 2, 6];
    if first {
        faces.insert(0, flat);
    } else {
        faces.push(flat);
    }
    Mesh::new(vertices, faces).unwrap()
}

fn lost(first: bool) -> Vec<String> {
    let options = BuildOptions::default();
    let (model, _) = Model::build(cube(first), &options).unwrap();
    assert!(model.is_closed());
    let (tip, _) = Model::build(octahedron(), &options).unwrap();
    let mut lost = Vec::new();
    let a = Placed { model: &model, pose: Pose::IDENTITY };
    let r = tip.mesh().vertices().iter().map(|p| p.x).fold(0.0, f64::max);
    for z in [0.25, 0.7, 0.5] {
        for gap in [0.01, 0.05] {
            let n = DVec3::new(0.5f64.sqrt(), 0.5f64.sqrt(), 0.0);
            let rotation = DQuat::from_rotation_arc(-DVec3::X, -n);
            let b = Placed {
                model: &tip,
                pose: Pose { rotation, translation: DVec3::new(1.0, 1.0, z) + (r + gap) * n },
            };
            let ask = |d| query(a, b, &Query::of(d), &mut PairMemory::default()).unwrap();
            let distance = ask(Demand::Distance { below: None }).distance.unwrap();
            let c = ask(Demand::contacts(0.1));
            let g = ask(Demand::Regions { margin: 0.1 });
            for (name, answer) in [("contacts", c), ("regions", g)] {
                let least =
                    answer.contacts.iter().map(|c| c.separation).fold(f64::INFINITY, f64::min);
                if (least - distance).abs() > 1e-9 {
                    lost.push(format!("first {first} z {z} {name}: distance {distance}, least contact {least}, {} contacts", answer.contacts.len()));
                }
            }
        }
    }
    lost
}

#[test]
fn faces_without_area_lose_no_contact() {
    let lost: Vec<_> = [false, true].into_iter().flat_map(lost).collect();
    assert!(lost.is_empty(), "{}", lost.join("\n"));
}
