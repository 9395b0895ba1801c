//! Each bad input gives one paragraph that says what and where, and the right exit code.

use std::process::Stdio;

use cranny_shapes::Cuboid;

use crate::harness::{Folder, cranny, run, run_command};

/// A folder with a good mesh and a good pose file.
fn good() -> (Folder, String, String) {
    let folder = Folder::new();
    let cube = folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
    let poses = folder.write("poses.json", r#"[{"a": null, "b": null}]"#);
    (folder, cube, poses)
}

#[test]
fn meshes_that_are_none() {
    let (folder, cube, poses) = good();
    let refused = |mesh: &str, words: &[&str]| {
        run(&["inspect", mesh]).assert_refused(2, words);
        run(&["query", &cube, mesh, "--poses", &poses]).assert_refused(2, words);
        run(&["query", mesh, &cube, "--poses", &poses]).assert_refused(2, words);
    };
    let obj = |name: &str, text: &str| folder.write(name, text);
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

    refused(&folder.path("missing.obj").display().to_string(), &["missing.obj", "no such file"]);
    refused(&folder.path("").display().to_string(), &["mesh file"]);
    refused(&obj("empty.obj", ""), &["empty.obj", "empty"]);
    refused(&obj("picture.jpg", "none"), &["picture.jpg", "jpg", ".obj"]);
    refused(&obj("none", "none"), &["extension"]);
    refused(&obj("points.obj", triangle), &["points.obj", "no faces", "3 vertices"]);
    refused(&obj("range.obj", &format!("{triangle}f 1 2 7\n")), &["range.obj", "line 4", "7"]);
    refused(&obj("nan.obj", "v 0 NaN 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), &["nan.obj", "line 1"]);
    refused(&obj("huge.obj", "v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n"), &["huge.obj", "1e300"]);
    refused(&obj("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), &["line.obj", "zero area"]);
    refused(&obj("bytes.obj", "\u{1}\u{2}\u{3}"), &["bytes.obj"]);

    let noise: Vec<u8> = (0..300u32).map(|i| (i * i * 7 + i * 131 + 129) as u8).collect();
    refused(&folder.write("noise.glb", &noise), &["noise.glb", "byte 0", "'glTF'", "'{'"]);
    refused(&folder.write("noise.stl", &noise), &["noise.stl", "bytes 80 to 83", "'solid'"]);

    let mut stl = vec![0; 80];
    stl.extend(12u32.to_le_bytes());
    stl.extend([0; 70]); // one triangle and a piece of the second
    refused(&folder.write("cut.stl", stl), &["cut.stl", "truncated", "684", "154"]);
}

#[test]
fn a_picture_does_not_replace_its_mesh_or_a_device() {
    let (_folder, cube, _) = good();
    let before = std::fs::read(&cube).unwrap();
    run(&["inspect", &cube, "--render", &cube]).assert_refused(2, &["cube.obj", "input"]);
    assert_eq!(std::fs::read(&cube).unwrap(), before);
    if cfg!(unix) {
        run(&["inspect", &cube, "--render", "/dev/null"]).assert_refused(2, &["device"]);
    }
}

#[test]
fn outputs_are_known_by_their_names_and_need_a_folder() {
    let (folder, cube, _) = good();
    let at = |name: &str| folder.path(name).to_str().unwrap().to_owned();
    for (option, name, known) in
        [("--render", "out.png", ".png"), ("--save", "out.cranny", ".cranny")]
    {
        let refused = |path: &str, code: i32, words: &[&str]| {
            run(&["inspect", &cube, option, path]).assert_refused(code, words);
        };
        for other in ["out.jpg", "out", ".png.txt"].map(at) {
            refused(&other, 2, &[option, &other, "must end in", known]);
            assert!(!std::fs::exists(&other).unwrap());
        }
        let missing = at(&format!("nowhere/{name}"));
        refused(&missing, 1, &[option, &missing, "there is no folder", "nowhere. Create it"]);
        refused(&at(""), 1, &[option, "it is a folder"]);
    }
}

#[test]
fn a_folder_or_nothing_is_told_alike_whatever_was_to_be_read() {
    let (folder, cube, poses) = good();
    std::fs::create_dir(folder.path("folder.obj")).unwrap();
    std::fs::create_dir(folder.path("folder.ron")).unwrap();
    let at = |name: &str| folder.path(name).to_str().unwrap().to_owned();
    for (name, words) in [("folder", "it is a folder"), ("missing", "there is no such file")] {
        let (mesh, scene) = (at(&format!("{name}.obj")), at(&format!("{name}.ron")));
        run(&["inspect", &mesh]).assert_refused(2, &["mesh file", &mesh, words]);
        run(&["query", &mesh, &cube, "--poses", &poses]).assert_refused(2, &[&mesh, words]);
        run(&["query", &cube, &cube, "--poses", &scene]).assert_refused(2, &[&scene, words]);
        for command in ["check", "explain", "run"] {
            run(&[command, &scene]).assert_refused(2, &["scene file", &scene, words]);
        }
    }
    run(&["check", &cube]).assert_refused(2, &["cube.obj", "no scene", "cranny inspect"]);
}

#[test]
fn poses_that_are_none() {
    let (folder, cube, _) = good();
    let refused = |name: &str, text: &str, words: &[&str]| {
        let poses = folder.write(name, text);
        let words = [&[name], words].concat();
        run(&["query", &cube, &cube, "--poses", &poses]).assert_refused(2, &words);
    };
    let matrix = |first: &str| format!("[{first},0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
    refused("empty.json", "", &["empty"]);
    refused("text.json", "[{\"a\":\n nul}]", &["line 2", "column"]);
    refused("object.json", r#"{"poses": []}"#, &["\"poses\"", "list of"]);
    refused("none.json", "[]", &["empty", "at least one"]);
    refused("short.json", r#"[{}, {"b": [1, 2, 3]}]"#, &["pose 1", "\"b\"", "3 numbers", "16"]);
    refused("key.json", r#"[{"A": null}]"#, &["pose 0", "\"A\""]);
    refused("scaled.json", &format!(r#"[{{"a": {}}}]"#, matrix("2")), &["pose 0", "rigid"]);
    refused("mirror.json", &format!(r#"[{{"a": {}}}]"#, matrix("-1")), &["pose 0", "rigid"]);
    refused("nan.json", &format!(r#"[{{"a": {}}}]"#, matrix("NaN")), &["line 1"]);
    refused("huge.json", &format!(r#"[{{"a": {}}}]"#, matrix("1e999")), &["out of range"]);
    let missing = folder.path("missing.json").display().to_string();
    run(&["query", &cube, &cube, "--poses", &missing]).assert_refused(2, &["missing.json"]);
}

#[test]
fn options_that_are_wrong_or_come_later() {
    let (_folder, cube, poses) = good();
    let query = |options: &[&str]| {
        let outcome = run(&[&["query", &cube, &cube, "--poses", &poses], options].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (Some(2), ""), "{outcome:?}");
        outcome.stderr
    };
    assert!(query(&["--accuracy", "perfect"]).contains("choose boxes, hulls"));
    assert!(query(&["--accuracy", "tree"]).contains("how deep"));
    assert!(query(&["--budget", "many"]).contains("--budget"));
    assert!(query(&["--demand", "everything"]).contains("possible values"));
    for scale in ["0", "inf", "NaN", "two"] {
        assert!(query(&["--scale-b", scale]).contains("scale"), "{scale}");
    }
    assert!(query(&["--scale-a", "1e200"]).contains("scaled by 1"));
    assert!(query(&["--format", "xml"]).contains("possible values"));

    let no_poses = run(&["query", &cube, &cube]);
    assert_eq!(no_poses.code, Some(2));
    assert!(no_poses.stderr.contains("--poses"));
    assert_eq!(run(&[]).code, Some(2));
}

#[test]
fn numbers_below_zero_are_values_not_options() {
    let (_folder, cube, poses) = good();
    let query = ["query", &cube, &cube, "--poses", &poses];
    let inspect = ["inspect", cube.as_str()];
    let run_args = ["run", "scene.ron"];
    let stability = ["stability"];
    let cases: [(&[&str], &str, &str, &str); 10] = [
        (&inspect, "--weld", "-1e-9", "not below 0, and at most a hundredth"),
        (&inspect, "--flat", "-1e-9", "from 0 to 0.01"),
        (&query, "--scale-a", "-1e-9x", "a scale is a number"),
        (&query, "--scale-b", "-inf", "finite and not 0"),
        (&query, "--budget", "-1e3", "from 0 to 18446744073709551615"),
        (&run_args, "--duration", "-1e-3", "above 0 seconds"),
        (&run_args, "--dt", "-1e-3", "above 0 seconds"),
        (&run_args, "--seed", "-1e3", "from 0 to 18446744073709551615"),
        (&run_args, "--threads", "-1e3", "1 or more"),
        (&stability, "--variants", "-1e3", "from 1 to 4294967295"),
    ];
    for (command, option, value, range) in cases {
        let outcome = run(&[command, &[option, value]].concat());
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        let found = format!("invalid value '{value}' for '{option}");
        assert!(outcome.stderr.contains(&found), "{outcome:?}");
        assert!(outcome.stderr.contains(range), "{option}: {outcome:?}");
    }
    let seed = run(&["stability", "--seed", "-1e3"]);
    assert!(seed.stderr.contains("a seed is a whole number from 0"), "{seed:?}");
    // One that may be negative is read.
    assert_eq!(run(&[&query[..], &["--scale-a", "-1e-1"]].concat()).code, Some(0));
}

#[test]
fn an_output_that_fails_late_is_told_in_the_report_as_well() {
    let (folder, cube, _) = good();
    // Where the partial file would go is a folder: found out only when it is written.
    std::fs::create_dir(folder.path("out.cranny.partial")).unwrap();
    let model = folder.path("out.cranny");
    let arguments = ["inspect", &cube, "--format", "json", "--save", model.to_str().unwrap()];
    let outcome = run(&arguments);
    assert_eq!(outcome.code, Some(1), "{outcome:?}");
    let report: serde_json::Value = serde_json::from_str(outcome.stdout.trim()).unwrap();
    let skipped = &report["skipped"][0];
    assert!(skipped["what"].as_str().unwrap().ends_with("out.cranny"), "{report}");
    assert!(skipped["why"].as_str().unwrap().contains("Check the folder"), "{report}");
    assert_eq!(report["outputs"].as_array().unwrap().len(), 0);
}

#[test]
fn scenes_that_are_none() {
    let folder = Folder::new();
    let refused = |text: &str, words: &[&str]| {
        let scene = folder.write("scene.ron", text);
        run(&["check", &scene]).assert_refused(2, &[&["scene.ron"], words].concat());
    };
    let body = r#"bodies: [(name: "cube", shape: Generator(Cuboid()))]"#;
    refused("", &["line 1", "no scene in the file", "`(bodies: ["]);
    refused("\n// later", &["line 2", "no scene in the file"]);
    refused("scene", &["line 1", "written in parentheses"]);
    refused(&format!("({body},\n most_parts: -1)"), &["line 2", "`most_parts`", "from 1 to", "-1"]);
    refused(&format!("({body},\n seed: 1.5)"), &["line 2", "`seed`", "from 0 to", "1.5"]);
    let pile = "Pile(count: 3, region: (min: (0, 0, 0), max: (9, 9, 9)), shapes: [])";
    refused(&format!("(groups: [\n{pile}])"), &["line 2", "pile", "`shapes` is empty", "Name at"]);
    refused("(\n  gravty: (0, 0, -9.81),\n)", &["line 2", "gravty", "gravity"]);
    refused(&format!("({body},\n effects: [Flying()])"), &["line 2", "Flying", "Response"]);
    refused(r#"(bodies: [(name: "m", shape: Mesh(path: "gone.obj"))])"#, &["gone.obj", "line 1"]);
    let latin = folder.write("latin.ron", b"(\n// \xfcber\n)");
    run(&["check", &latin])
        .assert_refused(2, &["latin.ron", "byte 0xfc of line 2", "Save it as UTF-8"]);
    let empty = run(&["check", &folder.write("empty.ron", "(bodies: [])")]);
    assert!(empty.stdout.contains("warning: the scene has no bodies"), "{empty:?}");
    refused("(\n bodies: [", &["line 2", "the `[` of line 2, column 10", "Close it with `]`"]);
    let missing = folder.path("missing.ron").display().to_string();
    run(&["check", &missing]).assert_refused(2, &["missing.ron", "no such file"]);
}

#[test]
fn a_picture_that_cannot_be_written_fails_and_leaves_nothing() {
    let (folder, cube, poses) = good();
    for inside in ["missing", "poses.json"] {
        let picture = folder.path(inside).join("out.png");
        let outcome = run(&["inspect", &cube, "--render", picture.to_str().unwrap()]);
        assert_eq!(outcome.code, Some(1), "{outcome:?}");
        assert!(outcome.stderr.contains("out.png") && outcome.stderr.contains("folder"));
        assert!(outcome.stdout.is_empty(), "reported before any work: {outcome:?}");
        assert!(!picture.exists());
    }
    assert_eq!(std::fs::read_to_string(poses).unwrap(), r#"[{"a": null, "b": null}]"#);
}

#[test]
fn without_a_graphics_adapter_the_report_says_so_and_goes_on() {
    let (folder, cube, _) = good();
    let picture = folder.path("out.png");
    let mut command = cranny();
    command.args(["inspect", &cube, "--format", "json", "--render"]).arg(&picture);
    // No system has both: where this one is missing, nothing draws.
    let absent = if cfg!(windows) { "metal" } else { "dx12" };
    let lines = run_command(command.env("WGPU_BACKEND", absent)).json_lines();
    assert!(lines[0]["skipped"][0]["what"].as_str().unwrap().ends_with("out.png"));
    assert!(lines[0]["skipped"][0]["why"].as_str().unwrap().contains("no graphics adapter"));
    assert_eq!(lines[0]["outputs"].as_array().unwrap().len(), 0);
    assert!(!picture.exists());

    let unknown = run_command(command.env("WGPU_BACKEND", "abacus"));
    assert_eq!(unknown.code, Some(2));
    assert!(unknown.stderr.contains("abacus"), "{unknown:?}");
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let (folder, cube, _) = good();
    let poses = folder.write("many.json", format!("[{}{{}}]", "{},".repeat(5_000)));
    let mut child = cranny()
        .args(["query", &cube, &cube, "--demand", "intersects", "--poses", &poses])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_under_standard_output_is_a_failure() {
    let (_folder, cube, poses) = good();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = cranny();
    command.args(["query", &cube, &cube, "--poses", &poses]).stdout(full);
    run_command(&mut command).assert_refused(1, &["standard output", "space"]);
}

/// A file that grows beyond a limit ends no command without a word, and what there is of it does
/// not look whole.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_on_the_size_of_files_is_a_failure() {
    let folder = Folder::new();
    let body = "(name: \"cup\", shape: Generator(Cup(segments: 256)))";
    let scene = folder.write("s.ron", format!("(bodies: [{body}], duration: 0.1)"));
    let recording = folder.path("out.mcap");
    let mut shell = std::process::Command::new("sh");
    // Blocks of 512 bytes.
    shell.args(["-c", "ulimit -f 8; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_cranny")]);
    shell.args(["run", &scene, "--record"]).arg(&recording);
    let outcome = run_command(shell.env_remove("RUST_LOG"));
    outcome.assert_refused(1, &["out.mcap.partial", "File too large", "Make room"]);
    assert!(!recording.exists());
}
