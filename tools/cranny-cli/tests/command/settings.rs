//! `--set PATH=VALUE`.

use crate::harness::{Folder, run};

const SCENE: &str = r#"(
    duration: 0.25, step: 0.0625,
    bodies: [(name: "stone", shape: Generator(Cuboid()), velocity: (linear: (1, 0, 0)))],
    effects: [Response()],
)"#;

fn displacement(arguments: &[&str]) -> Vec<f64> {
    let summary = &run(arguments).json_lines()[0];
    let moved = summary["motion"][0]["displacement"].as_array().unwrap();
    moved.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn a_run_goes_by_the_values_that_are_set() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    let run = ["run", &scene, "--format", "json"];
    let still = ["--set", "gravity.z=0", "--set", "bodies.stone.velocity.linear.x=2"];
    let moved = displacement(&[&run[..], &still[..]].concat());
    assert!((moved[0] - 0.5).abs() < 1e-6 && moved[2].abs() < 1e-6, "{moved:?}");
    let fallen = displacement(&run);
    assert!((fallen[0] - 0.25).abs() < 1e-6 && fallen[2] < -0.2, "{fallen:?}");
}

#[test]
fn every_command_of_scenes_takes_settings() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    let none = ["--set", "bodies=[]"];
    let checked =
        &run(&[&["check", &scene, "--format", "json"], &none[..]].concat()).json_lines()[0];
    assert_eq!(checked["bodies"], 0);
    let plan = run(&[&["explain", &scene], &["--set", "effects=[Trigger()]"][..]].concat());
    assert!(plan.code == Some(0) && plan.stdout.contains("Trigger"), "{plan:?}");
    let compared =
        run(&[&["compare", &scene, "--detector", "cranny"], &["--set", "effects=[]"][..]].concat());
    compared.assert_refused(2, &["nothing in it responds"]);
}

#[test]
fn settings_that_are_wrong_are_refused_with_their_place() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    let refused = |setting: &str| run(&["check", &scene, "--set", setting]);
    let unknown = refused("bodies.pebble.kind=Fixed");
    assert_eq!((unknown.code, unknown.stdout.as_str()), (Some(2), ""));
    for words in
        ["bodies.pebble.kind=Fixed: `bodies` has no `pebble`", "It has stone", "s.ron", "line 3"]
    {
        assert!(unknown.stderr.contains(words), "{words}: {unknown:?}");
    }
    let worded = refused("bodies.stone.material.density=-1");
    assert!(worded.stderr.contains("greater than 0, found -1"), "{worded:?}");
    let shapeless = refused("gravity");
    assert!(shapeless.code == Some(2) && shapeless.stderr.contains("PATH=VALUE"), "{shapeless:?}");
    let mesh = folder.mesh("a.obj", &cranny_shapes::Cuboid::default().build().unwrap());
    let poses = folder.write("poses.json", "[{}]");
    let out = folder.path("out").display().to_string();
    let args = ["accuracy", &mesh, &mesh, "--poses", &poses, "--out", &out, "--set", "step=1"];
    run(&args).assert_refused(2, &["--set step=1", "meshes"]);
}

/// A run drives them apart; whoever reads its results should know.
#[test]
fn check_and_run_name_what_overlaps_at_the_start() {
    let folder = Folder::new();
    let two = SCENE.replace(
        "bodies: [",
        "bodies: [(name: \"block\", shape: Generator(Cuboid()), kind: Fixed, pose: (at: (0.75, 0, 0))), ",
    );
    let scene = folder.write("s.ron", two);
    let says = "\"block\" and \"stone\" overlap by up to 0.250000 at the start";
    let checked = &run(&["check", &scene, "--format", "json"]).json_lines()[0];
    assert!(checked["warnings"][0].as_str().unwrap().starts_with(says), "{checked}");
    let ran = run(&["run", &scene, "--verbose"]);
    assert!(ran.code == Some(0) && ran.stderr.contains(says), "{ran:?}");
    let apart = run(&["run", &scene, "--verbose", "--set", "bodies.block.pose.at.x=1.5"]);
    assert!(!apart.stderr.contains("overlap"), "{apart:?}");
}

/// The scene has no such field: the flag is what is to be left out.
#[test]
fn levels_and_budgets_of_flags_are_refused_by_the_flags_names() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    for (flag, value) in [("--accuracy", "caps"), ("--accuracy", "tree:3"), ("--budget", "5")] {
        let named = format!("`{flag} {value}` changes nothing");
        run(&["run", &scene, flag, value]).assert_refused(2, &[&named]);
    }
    let own = folder.write("own.ron", SCENE.replace("duration:", "budget: 5, duration:"));
    run(&["run", &own]).assert_refused(2, &["`budget: 5` changes nothing"]);
}

#[test]
fn a_file_for_frames_and_too_many_threads_are_refused() {
    let folder = Folder::new();
    let scene = folder.write("s.ron", SCENE);
    let file = folder.write("frames", "");
    run(&["run", &scene, "--frames", &file])
        .assert_refused(1, &[&format!("--frames {file}: it is a file"), "Name a folder"]);
    let threads = run(&["run", &scene, "--threads", "20000"]);
    assert!(threads.code == Some(2) && threads.stderr.contains("at most "), "{threads:?}");
}
