//! What `inspect` says of concavities: counts by hand, sizes that add up.

use std::f64::consts::TAU;

use cranny_exact::DVec3;
use cranny_geometry::{FindingKind, Mesh};
use cranny_shapes::{Cuboid, Cup, GolfBall, Torus};
use serde_json::{Value, json};

use crate::harness::{Folder, run};

fn inspected(mesh: &Mesh) -> Value {
    let folder = Folder::new();
    let file = folder.mesh("mesh.obj", mesh);
    run(&["inspect", &file, "--format", "json"]).json_lines().remove(0)
}

fn concavities(report: &Value) -> &[Value] {
    report["concavities"].as_array().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[track_caller]
fn assert_near(value: &Value, expected: f64) {
    let off = (number(value) - expected).abs();
    assert!(off <= 1e-11 * expected.abs().max(1.0), "{value} instead of {expected}");
}

/// Area of a regular polygon by the radius of its corners.
fn polygon(corners: u32, radius: f64) -> f64 {
    let corners = f64::from(corners);
    0.5 * corners * radius * radius * (TAU / corners).sin()
}

/// What holds of the report of any closed mesh.
fn assert_consistent(report: &Value) {
    let all = concavities(report);
    let sum = |field: &str| all.iter().map(|c| number(&c[field])).sum::<f64>();
    let hull = &report["hull"];
    let air = number(&hull["volume"]) - number(&report["volume"]);
    assert_near(&report["skin_volume"], air - sum("pocket_volume"));
    let more = number(&hull["area"]) - number(&report["area"]);
    assert_near(&report["skin_area"], more - sum("cap_area") + sum("area"));
    let rough = number(&hull["area"]) - number(&report["area"]);
    assert!((rough - (sum("cap_area") - sum("area"))).abs() < 1e-9, "{report}");
    assert_eq!(report["features"]["concavities"], all.len());
    for (id, concavity) in all.iter().enumerate() {
        let count = |field: &str| concavity[field].as_u64().unwrap();
        assert_eq!(count("id"), id as u64);
        let faces = count("faces");
        // One or two faces a leaf.
        assert!((faces - 1..2 * faces).contains(&count("tree_nodes")), "{concavity}");
        assert!(count("envelope_depth") <= count("envelope_layers"), "{concavity}");
        assert!(count("envelope_layers") <= count("envelope_facets"), "{concavity}");
        assert!(count("envelope_depth") >= 1 && count("envelope_facets") <= 2 * faces);
    }
}

#[test]
fn a_torus_has_one_passage_with_two_rims() {
    let (around, tube) = (24, 8);
    let torus = Torus { major_segments: around, minor_segments: tube, ..Torus::default() };
    let report = inspected(&torus.build().unwrap());
    assert_consistent(&report);
    assert_eq!(report["features"]["convex_sets"], 1);
    // The topmost and the lowest circle, one edge a segment.
    assert_eq!(report["features"]["boundary_edges"], 2 * around);
    let [passage] = concavities(&report) else { panic!("{report}") };
    assert_eq!(passage["kind"], "passage");
    assert_eq!((&passage["loops"], &passage["lids"]), (&json!(2), &json!(2)));
    // The half of the tube that faces the axis, two faces a quad.
    assert_eq!(passage["faces"], around * tube);
    assert_near(&passage["cap_area"], 2.0 * polygon(around, torus.major_radius));
    assert_eq!(passage["parent"], Value::Null);
}

#[test]
fn a_cup_has_one_pocket_as_large_as_its_well() {
    let cup = Cup { segments: 32, ..Cup::default() };
    let mesh = cup.build().unwrap();
    let report = inspected(&mesh);
    assert_consistent(&report);
    let [well] = concavities(&report) else { panic!("{report}") };
    assert_eq!(well["kind"], "pocket");
    assert_eq!((&well["loops"], &well["lids"]), (&json!(1), &json!(1)));
    assert_eq!(report["features"]["boundary_edges"], cup.segments);
    // The wall's quads and the floor's triangles.
    assert_eq!(well["faces"], 3 * cup.segments);
    let mouth = polygon(cup.segments, cup.radius - cup.wall);
    assert_near(&well["cap_area"], mouth);
    assert_near(&well["pocket_volume"], mouth * (cup.height - cup.floor));

    let folder = Folder::new();
    let text = run(&["inspect", &folder.mesh("cup.obj", &mesh)]).stdout;
    for words in [
        "1 convex set, 32 boundary edges",
        "1 pocket; pockets hold 0.449",
        "concavities, the largest first",
        "envelopes ",
        "patches ",
        " deep",
    ] {
        assert!(text.contains(words), "{words:?} is missing in\n{text}");
    }
    let row = text.lines().find(|line| line.contains("pocket  ")).unwrap();
    assert_eq!(row.split_whitespace().take(5).collect::<Vec<_>>(), ["0", "pocket", "96", "1", "1"]);
}

#[test]
fn a_golf_ball_has_a_pocket_for_each_dimple() {
    let ball = GolfBall { dimples: 24, triangles: 5_000, coverage: 0.4, ..GolfBall::default() };
    let mesh = ball.build().unwrap();
    let report = inspected(&mesh);
    assert_consistent(&report);
    assert_eq!(report["features"]["convex_sets"], 1);
    assert_eq!(concavities(&report).len(), 24);
    for dimple in concavities(&report) {
        assert_eq!(dimple["kind"], "pocket");
        assert_eq!((&dimple["loops"], &dimple["lids"]), (&json!(1), &json!(1)));
        assert!(number(&dimple["pocket_volume"]) > 0.0);
    }
    let folder = Folder::new();
    let text = run(&["inspect", &folder.mesh("ball.obj", &mesh)]).stdout;
    assert!(text.contains("24 pockets") && text.contains("and 16 more"), "{text}");
}

#[test]
fn a_pebble_in_a_cup_is_an_island_in_its_well() {
    let cup = Cup { segments: 16, ..Cup::default() }.build().unwrap();
    let pebble = Cuboid { size: [0.2; 3] }.build().unwrap();
    let mut vertices = cup.vertices().to_vec();
    let first = vertices.len() as u32;
    vertices.extend(pebble.vertices().iter().map(|&p| p + DVec3::new(0.0, 0.0, 0.5)));
    let mut faces = cup.faces().to_vec();
    faces.extend(pebble.faces().iter().map(|face| face.map(|i| first + i)));
    let both = Mesh::new(vertices, faces).unwrap();
    let report = inspected(&both);
    assert_consistent(&report);
    let [well, island] = concavities(&report) else { panic!("{report}") };
    assert_eq!((&well["kind"], &island["kind"]), (&json!("pocket"), &json!("island")));
    assert_eq!((&well["parent"], &island["parent"]), (&Value::Null, &json!(0)));
    assert_eq!(
        (&island["lids"], &island["loops"], &island["faces"]),
        (&json!(0), &json!(0), &json!(12))
    );
    assert_near(&island["pocket_volume"], -0.008);
    let folder = Folder::new();
    let text = run(&["inspect", &folder.mesh("both.obj", &both)]).stdout;
    assert!(text.contains("island in 0"), "{text}");
}

#[test]
fn how_flat_is_flat_can_be_said() {
    let folder = Folder::new();
    let torus = Torus::default().build().unwrap();
    let moved = |mesh: &Mesh, to: &dyn Fn(DVec3) -> DVec3| {
        let vertices = mesh.vertices().iter().map(|&p| to(p)).collect();
        Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
    };
    let rounded = moved(&torus, &|p| (1e6 * p).round() / 1e6);
    let turned =
        moved(&rounded, &|p| DVec3::new(0.6 * p.x - 0.8 * p.y, 0.8 * p.x + 0.6 * p.y, p.z) / 3.0);
    let mesh = folder.mesh("turned.obj", &turned);
    let count = |more: &[&str]| {
        let arguments = [&["inspect", &mesh, "--format", "json"], more].concat();
        let report = run(&arguments).json_lines().remove(0);
        (concavities(&report).len(), number(&report["flatness"]))
    };
    // Turned, the grid of the rounding is gone, and its dents are marks like any others.
    assert!(count(&[]).0 > 1);
    assert_eq!(count(&["--flat", "2e-6"]), (1, 2e-6));
    for (flat, word) in [("-1", "0 to 0.01"), ("1", "0 to 0.01"), ("even", "such as")] {
        let refused = run(&["inspect", &mesh, "--flat", flat]);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{refused:?}");
        assert!(refused.stderr.contains(word), "{word:?} is missing in {refused:?}");
    }
}

/// All keys of an object, and of what it holds.
fn keys(value: &Value, found: &mut std::collections::BTreeSet<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| {
            found.insert(key.clone());
            keys(value, found);
        }),
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_key_is_in_the_documentation() {
    let page = include_str!("../../../../docs/inspect.md");
    let cup = Cup::default().build().unwrap();
    let mut open = cup.faces().to_vec();
    open.truncate(open.len() - 3);
    open.push(open[0]);
    let open = Mesh::new([cup.vertices(), &[DVec3::ONE]].concat(), open).unwrap();
    let mut found = std::collections::BTreeSet::new();
    for mesh in [&cup, &open] {
        keys(&inspected(mesh), &mut found);
    }
    for key in ["limits", "vertices", "pocket_volume", "volumes_unknown", "moved"] {
        assert!(found.contains(key), "{key}");
    }
    for key in &found {
        assert!(page.contains(&format!("`{key}`")), "{key} is not explained in docs/inspect.md");
    }
}

#[test]
fn what_an_open_or_a_doubled_mesh_holds_is_unknown_and_why() {
    let cup = Cup::default().build().unwrap();
    let open = cup.faces()[1..].to_vec();
    let [a, b, c] = cup.faces()[0];
    let doubled = [cup.faces(), &[[a, b, c], [a, c, b]]].concat();
    let of_cup = |faces| Mesh::new(cup.vertices().to_vec(), faces).unwrap();
    let aside = cup.vertices().iter().map(|&p| p + DVec3::new(0.5, 0.25, 0.125)).collect();
    let crossed = cup.clone().joined(&Mesh::new(aside, cup.faces().to_vec()).unwrap());
    for (mesh, why) in [
        (of_cup(open), "the mesh is not closed"),
        (of_cup(doubled), "faces lie in one place with others"),
        (crossed, "the surface passes through itself"),
    ] {
        let report = inspected(&mesh);
        assert_eq!(report["volumes_unknown"], why);
        assert!(concavities(&report).iter().all(|c| c["pocket_volume"].is_null()));
        assert!(!concavities(&report).is_empty());
    }
}

#[test]
fn two_sheets_back_to_back_are_not_inside_out() {
    let corners = [[0.1, 0.0, 0.3], [1.0, 0.7, 0.2], [0.3, 0.9, 0.6]];
    let vertices = corners.map(DVec3::from_array).to_vec();
    for faces in [vec![[0, 1, 2], [2, 1, 0]], vec![[2, 1, 0], [0, 1, 2]]] {
        let report = inspected(&Mesh::new(vertices.clone(), faces).unwrap());
        assert_eq!(report["repairs"], json!([]));
        assert_eq!(report["closed"], true);
    }
}

#[test]
fn every_kind_of_finding_is_told_with_its_ids_and_its_measure() {
    let page = include_str!("../../../../docs/inspect.md");
    for kind in FindingKind::ALL {
        let (name, of) = (kind.name(), kind.element().name());
        let row = format!("| `{name}` | {of} | {} | {} |", kind.concerned(), kind.measured());
        assert!(page.lines().any(|line| line == row), "docs/inspect.md lacks this row:\n{row}");
    }
}
