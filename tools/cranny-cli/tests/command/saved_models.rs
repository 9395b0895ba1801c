//! Models are saved once and loaded in place of their meshes.

use cranny_shapes::{Cuboid, Cup};

use crate::harness::{Folder, argument, run};

const POSES: &str = r#"[{}, {"b": [1,0,0,0.25, 0,1,0,0, 0,0,1,0.5, 0,0,0,1]}]"#;

#[test]
fn a_saved_model_answers_as_its_mesh_does() {
    let folder = Folder::new();
    let mesh = folder.mesh("cup.obj", &Cup::default().build().unwrap());
    let cube = folder.mesh("cube.obj", &Cuboid { size: [0.1; 3] }.build().unwrap());
    let poses = folder.write("poses.json", POSES);
    let model = argument(&folder.path("cup.cranny"));
    let saved = &run(&["inspect", &mesh, "--save", &model, "--format", "json"]).json_lines()[0];
    let size = std::fs::metadata(&model).unwrap().len();
    assert_eq!(saved["bytes"], size);
    assert_eq!(saved["outputs"][0], model.as_str());

    let loaded = &run(&["inspect", &model, "--format", "json"]).json_lines()[0];
    assert_eq!(loaded["format"], "saved model");
    for unknown in ["filed_vertices", "filed_faces", "deviation", "repairs"] {
        assert!(loaded[unknown].is_null() && !saved[unknown].is_null(), "{unknown}");
    }
    for same in ["digest", "faces", "volume", "area", "findings", "hull", "concavities", "patches"]
    {
        assert_eq!(loaded[same], saved[same], "{same}");
    }

    let answers = |a: &str| {
        let mut lines = run(&["query", a, &cube, "--poses", &poses]).json_lines();
        for line in &mut lines {
            line["micros"].take();
        }
        lines
    };
    assert_eq!(answers(&model), answers(&mesh));
}

#[test]
fn a_broken_model_is_refused_with_what_to_do() {
    let folder = Folder::new();
    let mesh = folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
    let path = folder.path("cube.CRANNY");
    let model = argument(&path);
    assert_eq!(run(&["inspect", &mesh, "--save", &model]).code, Some(0));
    let bytes = std::fs::read(&path).unwrap();

    let cut = folder.write("cut.cranny", &bytes[..bytes.len() - 1]);
    run(&["inspect", &cut]).assert_refused(2, &["cut.cranny", "cut off", "Copy"]);
    let mut other = bytes.clone();
    other[100] ^= 1;
    let damaged = folder.write("damaged.cranny", other);
    run(&["inspect", &damaged]).assert_refused(2, &["damaged.cranny", "checksum"]);
    let mut newer = bytes.clone();
    newer[8] += 1;
    let damaged = folder.write("head_damaged.cranny", &newer);
    run(&["inspect", &damaged]).assert_refused(2, &["damaged", "version in its head", "Copy"]);
    // Of another version: its sections are others, too.
    newer[100] ^= 1;
    let newer = folder.write("newer.cranny", newer);
    run(&["inspect", &newer]).assert_refused(2, &["newer.cranny", "version", "Prepare the mesh"]);
    let head = folder.write("head.cranny", &bytes[..12]);
    run(&["inspect", &head]).assert_refused(2, &["head.cranny", "12 bytes", "cut off", "Copy"]);
    let text = folder.write("text.cranny", "v 0 0 0\n");
    run(&["inspect", &text]).assert_refused(2, &["text.cranny", "no saved model", "--save"]);
    run(&["inspect", "nowhere.cranny"]).assert_refused(2, &["nowhere.cranny"]);

    let poses = folder.write("poses.json", "[{}]");
    run(&["query", &model, &mesh, "--poses", &poses, "--scale-a", "2"])
        .assert_refused(2, &["a scale needs the mesh"]);
    run(&["inspect", &model, "--repair", "safe"]).assert_refused(2, &["--repair needs the mesh"]);
    run(&["inspect", &model, "--weld", "1e-6"]).assert_refused(2, &["--weld needs the mesh"]);
    run(&["inspect", &model, "--flat", "1e-6"]).assert_refused(2, &["--flat needs the mesh"]);
}

#[test]
fn nothing_but_an_older_model_is_replaced() {
    let folder = Folder::new();
    let mesh = folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
    let model = argument(&folder.path("cube.cranny"));
    for _ in 0..2 {
        assert_eq!(run(&["inspect", &mesh, "--save", &model]).code, Some(0));
    }
    run(&["inspect", &model, "--save", &model]).assert_refused(2, &["it is the input"]);
    let named = run(&["inspect", &mesh, "--save", &mesh]);
    assert_eq!(named.code, Some(2));
    assert!(named.stderr.contains("it is the input"), "{named:?}");
    let nowhere = argument(&folder.path("no/such/folder.cranny"));
    let failed = run(&["inspect", &mesh, "--save", &nowhere]);
    assert_eq!(failed.code, Some(1));
    assert!(failed.stdout.is_empty() && failed.stderr.contains("there is no folder"));
    let left = std::fs::read_dir(folder.path(".")).unwrap().count();
    assert_eq!(left, 2, "no partial file stays");
}

/// An open mesh falls onto a floor: `check` and `run` say what it weighs, and it comes to rest.
#[test]
fn an_open_mesh_simulates_and_both_commands_say_what_it_weighs() {
    let folder = Folder::new();
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let sides = "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    folder.write("crate.obj", format!("{corners}{sides}"));
    let scene = folder.write(
        "open.ron",
        r#"(version: 1, gravity: (0, 0, -9.81), step: 0.00416, duration: 0.6, bodies: [
            (name: "floor", shape: Generator(Cuboid(size: (9, 9, 1))), kind: Fixed, pose: (at: (0, 0, -0.5))),
            (name: "crate", shape: Mesh(path: "crate.obj", recenter: true), pose: (at: (0, 0, 0.6))),
        ], effects: [Response(), Contacts(margin: 0)])"#,
    );
    // Warnings of a run appear with --verbose where standard error is no terminal.
    for command in ["check", "run"] {
        let outcome = run(&[command, &scene, "--verbose"]);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        for words in ["\"crate\"", "4 x open edge", "convex hull", "1.0000"] {
            let said = format!("{}{}", outcome.stdout, outcome.stderr);
            assert!(said.contains(words), "{command}, {words}: {outcome:?}");
        }
    }
    let summary = run(&["run", &scene, "--format", "json"]).json_lines().remove(0);
    let moved = summary["motion"][0]["displacement"][2].as_f64().unwrap();
    assert!((moved + 0.1).abs() < 1e-3, "{summary}");
}
