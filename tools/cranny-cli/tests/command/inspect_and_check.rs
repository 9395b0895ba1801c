//! What `inspect` and `check` say of sound input.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_shapes::{Cuboid, Cup, LPrism};

use crate::harness::{Folder, argument, cranny, run, run_command};

#[test]
fn a_sound_mesh_has_volume_and_no_findings() {
    let folder = Folder::new();
    let size = [1.0, 2.0, 4.0];
    let mesh = folder.mesh("box.obj", &Cuboid { size }.build().unwrap());
    let report = &run(&["inspect", &mesh, "--format", "json"]).json_lines()[0];
    assert_eq!(report["version"], 1);
    assert_eq!(report["vertices"], 8);
    assert_eq!((&report["faces"], &report["components"]), (&12.into(), &1.into()));
    assert_eq!((&report["closed"], &report["oriented"]), (&true.into(), &true.into()));
    assert_eq!((&report["volume"], &report["area"]), (&8.0.into(), &28.0.into()));
    let findings = report["findings"].as_array().unwrap();
    assert_eq!(findings.len(), 1);
    // The diagonals of the six sides, summed up.
    assert_eq!(
        (&findings[0]["kind"], &findings[0]["count"]),
        (&"coplanar_adjacent".into(), &6.into())
    );
    assert_eq!(findings[0]["limits"].as_array().unwrap().len(), 0);
    assert_eq!(report["hull"]["kind"], "volume");
    assert_eq!(report["hull"]["facets"], 6);
    assert_eq!(report["hull"]["volume"], 8.0);
    assert_eq!(report["features"]["convex_sets"], 1);
    assert_eq!(
        (&report["patches"], report["concavities"].as_array().unwrap().len()),
        (&6.into(), 0)
    );
    assert!(report["skin_volume"].as_f64().unwrap().abs() < 1e-14);
    assert!(report["time_ms"]["hull"].as_f64().unwrap() > 0.0);
    for stage in ["read", "repair", "classify", "caps", "trees", "envelopes"] {
        assert!(report["time_ms"][stage].as_f64().is_some(), "{stage}");
    }

    let text = run(&["inspect", &mesh]);
    for words in
        ["box.obj (OBJ)", "12 in 1 component", "closed", "6 facets", "6 x coplanar adjacent"]
    {
        assert!(text.stdout.contains(words), "{words:?} is missing in\n{}", text.stdout);
    }
    assert_eq!(text.stderr, "");
}

#[test]
fn repairs_and_findings_are_reported_with_their_faces() {
    let folder = Folder::new();
    let cube = Cuboid::default().build().unwrap();
    // Each face has vertices of its own, and the last face is missing.
    let corners: Vec<DVec3> =
        cube.faces().iter().flatten().map(|&i| cube.vertices()[i as usize]).collect();
    let faces = (0..11).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = folder.mesh("open.obj", &Mesh::new(corners, faces).unwrap());
    let report = &run(&["inspect", &mesh, "--format", "json"]).json_lines()[0];
    assert_eq!((&report["filed_vertices"], &report["vertices"]), (&36.into(), &8.into()));
    assert_eq!((&report["closed"], &report["volume"]), (&false.into(), &serde_json::Value::Null));
    let kinds: Vec<&str> = report["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|finding| finding["kind"].as_str().unwrap())
        .collect();
    assert_eq!(kinds, ["open_edge", "open_edge", "open_edge", "coplanar_adjacent"]);
    assert_eq!(report["findings"][0]["limits"].as_array().unwrap().len(), 2);
    assert_eq!(report["findings"][0]["of"], "face");
    let repairs: Vec<&str> = report["repairs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|repair| repair["kind"].as_str().unwrap())
        .collect();
    assert_eq!(repairs, ["welded_vertices", "dropped_vertices"]);

    let text = run(&["inspect", &mesh]).stdout;
    assert!(text.contains("3 x open edge") && text.contains("none: not closed"), "{text}");
}

#[test]
fn bodies_that_overlap_at_the_start_are_named_with_their_depth() {
    let folder = Folder::new();
    let check = |effects: &str, more: &str| {
        let scene = folder.write(
            "s.ron",
            format!(
                r#"(bodies: [
                    (name: "floor", shape: Generator(Cuboid(size: (9, 9, 1))), kind: Fixed),
                    (name: "sunk", shape: Generator(Cuboid()), pose: (at: (0, 0, 0.75))),
                    (name: "on", shape: Generator(Cuboid()), pose: (at: (3, 0, 1))),
                    (name: "marble", shape: Primitive(Ball(radius: 0.5)), pose: (at: (-3, 0, 0.9))),
                    (name: "pea", shape: Generator(Cuboid(size: (0.1, 0.1, 0.1))), pose: (at: (0, 0, 1))),
                    (name: "ghost", shape: Generator(Cuboid()), sensor: true, effects: [Trigger()]),
                ], effects: [{effects}], {more})"#
            ),
        );
        let checked = &run(&["check", &scene, "--format", "json"]).json_lines()[0];
        checked["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .map(|w| w.as_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    let found = check("Response()", "");
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0].starts_with("\"pea\" lies wholly within \"sunk\" at the start"), "{found:?}");
    assert!(
        found[1].starts_with("\"floor\" and \"sunk\" overlap by up to 0.250000 at the start"),
        "{found:?}"
    );
    assert!(
        found[2].starts_with("\"floor\" and \"marble\" overlap by up to 0.100000"),
        "{found:?}"
    );
    let apart = check("Response()", r#"pairs: [(a: "sunk", b: "floor", collide: false)]"#);
    assert_eq!(apart.len(), 2, "{apart:?}");
    let still = check("Trigger()", "");
    assert_eq!(still.len(), 1, "nothing is pushed: {still:?}");
    assert!(still[0].starts_with("no effect asks for Response(): nothing moves 5 Dynamic bodies"));
}

#[test]
fn the_picture_is_written_whole_or_reported_as_skipped() {
    let folder = Folder::new();
    let mesh = folder.mesh("l.obj", &LPrism::default().build().unwrap());
    let picture = folder.path("l.png");
    let mut command = cranny();
    command.args(["inspect", &mesh, "--format", "json", "--render"]).arg(&picture);
    let report = &run_command(&mut command).json_lines()[0];
    match report["skipped"].as_array().unwrap().as_slice() {
        [] => {
            assert!(report["outputs"][0].as_str().unwrap().ends_with("l.png"));
            let bytes = std::fs::read(&picture).unwrap();
            assert!(bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xae\x42\x60\x82"));
        }
        skipped => {
            println!("skipped: {skipped:?}");
            assert!(!picture.exists());
        }
    }
    assert!(!folder.path("l.png.partial").exists());
}

#[test]
fn each_view_is_a_picture_with_a_legend_of_its_own() {
    let folder = Folder::new();
    let mesh = folder.mesh("cup.obj", &Cup { segments: 16, ..Cup::default() }.build().unwrap());
    let picture = folder.path("cup.png");
    let mut pictures = Vec::new();
    for (show, words) in [
        ("classes", "concavities by number: blue 0"),
        ("patches", "patches in colours"),
        ("boxes:1", "level 1 of the concavities' trees: 2"),
        ("envelope:0", "layers of the envelopes at depth 0"),
        ("findings", "blue: coplanar adjacent"),
    ] {
        let mut command = cranny();
        command.args(["inspect", &mesh, "--show", show, "--render"]).arg(&picture);
        let outcome = run_command(&mut command);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        if !picture.exists() {
            println!("skipped: {}", outcome.stdout);
            return;
        }
        assert!(outcome.stdout.contains(words), "{words:?} is missing in\n{}", outcome.stdout);
        pictures.push(std::fs::read(&picture).unwrap());
    }
    pictures.sort();
    pictures.dedup();
    assert_eq!(pictures.len(), 5);
    let never = argument(&folder.path("never.png"));
    for deep in ["boxes:99", "envelope:99"] {
        run(&["inspect", &mesh, "--render", &never, "--show", deep])
            .assert_refused(2, &["cup.obj", deep, "nothing lies deeper than"]);
    }
    let refused = run(&["inspect", &mesh, "--show", "classes"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("--render"), "{refused:?}");
}

#[test]
fn a_right_scene_is_counted() {
    let folder = Folder::new();
    folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
    let scene = folder.write(
        "scene.ron",
        r#"(
            bodies: [(name: "ring", shape: Generator(Torus(major_radius: 1))),
                     (name: "cube", shape: Mesh(path: "cube.obj"), effects: [Trigger()])],
            effects: [Response()],
            cameras: [(name: "main", preset: Isometric)],
        )"#,
    );
    let text = run(&["check", &scene]);
    assert_eq!((text.code, text.stderr.as_str()), (Some(0), ""));
    assert!(text.stdout.starts_with("ok: "), "{text:?}");
    assert!(text.stdout.ends_with("2 bodies, 0 joints, 2 effects, 1 camera\n"), "{text:?}");
    let report = &run(&["check", &scene, "--format", "json"]).json_lines()[0];
    assert_eq!((&report["ok"], &report["bodies"]), (&true.into(), &2.into()));
    assert_eq!(report["files"], 1);
}

/// What `run` refuses, `check` does not pass.
#[test]
fn a_step_or_a_duration_that_cannot_be_run_is_refused() {
    let folder = Folder::new();
    for (field, says) in [
        ("step: 1e-300", "between 1e-9 and 1e6 s"),
        ("duration: 1e300", "more than 4 billion steps"),
    ] {
        let scene = folder.write("scene.ron", format!("(bodies: [], {field})"));
        run(&["check", &scene]).assert_refused(2, &[says]);
    }
}
