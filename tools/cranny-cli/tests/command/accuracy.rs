//! What `accuracy` writes.

use std::collections::BTreeMap;
use std::fs;

use cranny_shapes::{Cuboid, Cup, Sphere};

use crate::harness::{Folder, Outcome, argument, run};

/// Cells by the names of their columns.
type Row = BTreeMap<String, String>;

/// A ball that comes down beside a cup's middle until it overlaps the bottom, and rises again.
struct Scene {
    folder: Folder,
    meshes: [String; 2],
    poses: String,
}

const FRAMES: usize = 24;

impl Scene {
    fn new() -> Self {
        let folder = Folder::new();
        let ball = Sphere { segments: 12, rings: 8, radius: 0.3 };
        let cup = folder.mesh("cup.obj", &Cup::default().build().unwrap());
        let ball = folder.mesh("ball.obj", &ball.build().unwrap());
        let pose = |frame: usize| {
            let height = 2.6 * (frame as f64 / FRAMES as f64 - 0.5).abs() - 0.3;
            format!(r#"{{"b": [1,0,0,0.03, 0,1,0,0.05, 0,0,1,{height}, 0,0,0,1]}}"#)
        };
        let poses: Vec<String> = (0..FRAMES).map(pose).collect();
        let poses = folder.write("poses.json", format!("[{}]", poses.join(",")));
        Self { folder, meshes: [cup, ball], poses }
    }

    fn accuracy(&self, options: &[&str]) -> Outcome {
        let out = argument(&self.folder.path("out"));
        let [a, b] = &self.meshes;
        run(&[&["accuracy", a, b, "--poses", &self.poses, "--out", &out], options].concat())
    }

    fn rows(&self) -> Vec<Row> {
        self.table("accuracy.csv")
    }

    fn table(&self, name: &str) -> Vec<Row> {
        let text = fs::read_to_string(self.folder.path("out").join(name)).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
        let names: Vec<String> = lines.next().unwrap().collect();
        lines
            .map(|cells| {
                let row: Row = names.iter().cloned().zip(cells).collect();
                assert_eq!(row.len(), names.len());
                row
            })
            .collect()
    }
}

impl Scene {
    fn page(&self) -> String {
        fs::read_to_string(self.folder.path("out").join("accuracy.html")).unwrap()
    }

    fn assert_drawn(&self, name: &str, words: &[&str]) {
        let svg = fs::read_to_string(self.folder.path("out").join(name)).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for word in words {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name} in {row:?}"))
}

#[test]
fn the_report_reads_back_and_nothing_is_missed() {
    let scene = Scene::new();
    let outcome = scene.accuracy(&[]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    let rows = scene.rows();
    assert_eq!(outcome.stdout.lines().count(), rows.len() + 1, "a line a row, and a heading");
    let ours: Vec<_> = rows.iter().filter(|row| row["method"] == "cranny").collect();
    assert_eq!(ours.len(), 2 * (10 + 7 + 3));
    let in_contact = number(ours[0], "contact_poses");
    assert!(in_contact > 2.0 && in_contact < FRAMES as f64, "{in_contact}");
    for row in &ours {
        for wrong in ["false_negatives", "false_positives", "outside", "contacts_missed"] {
            assert_eq!(row[wrong], "0", "{wrong} in {row:?}");
        }
        assert_eq!((row["poses"].as_str(), row["note"].as_str()), ("24", ""));
        assert!(number(row, "contact_median_us") > 0.0 && number(row, "contacts_mean") >= 1.0);
        assert!(number(row, "contact_error_max") >= number(row, "contact_error_mean"));
        assert!(
            number(row, "median_us") > 0.0 && number(row, "p99_us") >= number(row, "median_us")
        );
        assert!(number(row, "width_max") >= number(row, "width_mean"));
        // The upper end is no farther from the distance than the interval is wide.
        assert!(number(row, "distance_error_max") <= number(row, "width_max") + 1e-12);
    }
    let row = |level: &str, budget: &str, memory: &str| {
        let is = |row: &&&Row| {
            row["level"] == level && row["budget"] == budget && row["memory"] == memory
        };
        *ours.iter().find(is).unwrap()
    };
    for memory in ["cold", "warm"] {
        let exact = row("exact", "", memory);
        assert_eq!(exact["open"], "0");
        assert!(number(exact, "width_max") < 1e-12 && number(exact, "witness_error_mean") == 0.0);
        // The deepest contact is one of those reported.
        assert!(number(exact, "contact_error_mean") < 1e-12);
    }
    let width = |level, budget, memory| number(row(level, budget, memory), "width_mean");
    assert!(width("boxes", "", "cold") > width("tree:8", "", "cold"));
    assert!(width("tree:8", "", "cold") > 1e9 * width("exact", "", "cold"));
    assert!(width("exact", "1000", "cold") < width("exact", "30", "cold"));
    for peer in ["parry-trimesh", "parry-decomposition"] {
        let row = rows.iter().find(|row| row["method"] == peer).unwrap();
        assert!(row["level"].is_empty() && row["width_mean"].is_empty());
        assert!(number(row, "median_us") > 0.0 && number(row, "distance_error_mean") < 1.0);
        assert_eq!((number(row, "contact_poses"), number(row, "outside")), (in_contact, 0.0));
    }
    let words = [
        "levels, warm",
        "budgets of tests, cold",
        "budgets of time",
        "convex pieces",
        "boxes",
        "Bodies apart",
        "Bodies that overlap",
        "\nexact\n",
    ];
    scene.assert_drawn("accuracy.svg", &words);
}

/// The answer at a pose agrees with what is so there, and the rows are made of nothing else.
#[test]
fn poses_are_listed_one_by_one() {
    let scene = Scene::new();
    let options =
        ["--levels", "hulls,exact", "--budgets", "100", "--deadlines", "none", "--no-peers"];
    assert_eq!(scene.accuracy(&options).code, Some(0));
    let poses = scene.table("poses.csv");
    let rows = scene.rows();
    assert_eq!((rows.len(), poses.len()), (6, 6 * FRAMES));
    for (row, poses) in rows.iter().zip(poses.chunks(FRAMES)) {
        let count = |found: &str| poses.iter().filter(|pose| pose["told"] == found).count();
        assert_eq!(row["open"], count("open").to_string());
        for (i, pose) in poses.iter().enumerate() {
            assert_eq!((&pose["level"], &pose["budget"]), (&row["level"], &row["budget"]));
            assert_eq!(pose["pose"], i.to_string());
            assert!(pose["told"] == "open" || pose["told"] == pose["meets"], "{pose:?}");
            let [least, most, distance] =
                ["at_least", "at_most", "distance"].map(|name| number(pose, name));
            assert!(least <= distance + 1e-12 && distance <= most + 1e-12, "{pose:?}");
        }
        let widths = poses.iter().map(|pose| number(pose, "at_most") - number(pose, "at_least"));
        let mean = widths.sum::<f64>() / FRAMES as f64;
        assert!((mean - number(row, "width_mean")).abs() < 1e-12);
    }
}

#[test]
fn what_a_budget_leaves_open_is_narrowed_at_rest() {
    let scene = Scene::new();
    let options = ["--levels", "none", "--budgets", "20,200", "--deadlines", "none", "--no-peers"];
    assert_eq!(scene.accuracy(&options).code, Some(0));
    let rows = scene.table("refinement.csv");
    assert_eq!(rows.len(), 2 * 64);
    for rows in rows.chunks(64) {
        let widths: Vec<f64> = rows.iter().map(|row| number(row, "width_mean")).collect();
        assert!(widths.windows(2).all(|w| w[1] <= w[0]), "{widths:?}");
        assert!(widths[0] > 0.01 && widths[widths.len() - 1] < 0.5 * widths[0], "{widths:?}");
        assert!(rows.windows(2).all(|w| number(&w[1], "open") <= number(&w[0], "open")));
    }
    // The larger budget is through.
    assert_eq!(rows[127]["open"], "0");
    assert!(number(&rows[127], "width_max") < 1e-12, "{:?}", rows[127]);
    scene.assert_drawn("refinement.svg", &["20 tests a frame", "200 tests a frame"]);
}

/// A slow method answers at fewer poses, and one with memory sees the motion as it is.
#[test]
fn an_impatient_user_gets_fewer_poses() {
    let scene = Scene::new();
    let options = ["--levels", "exact", "--budgets", "none", "--deadlines", "none", "--no-peers"];
    let hurried = [&options[..], &["--patience", "0.00001", "--runs", "1"]].concat();
    assert_eq!(scene.accuracy(&hurried).code, Some(0));
    for row in scene.rows() {
        assert!(number(&row, "poses") >= 1.0 && number(&row, "poses") < FRAMES as f64, "{row:?}");
    }
    scene.assert_drawn("accuracy.svg", &["timed on fewer poses"]);
    let html = scene.page();
    for row in scene.rows() {
        let poses = number(&row, "overlapping_poses");
        assert!(html.contains(&format!("<td>{poses} of ")), "{poses}");
    }
    for name in ["refinement.csv", "refinement.svg"] {
        assert!(!scene.folder.path("out").join(name).exists(), "no budget, nothing to refine");
    }
}

#[test]
fn peers_may_be_left_out_and_rows_printed_as_json() {
    let scene = Scene::new();
    let lines = scene.accuracy(&["--no-peers", "--format", "json"]).json_lines();
    assert_eq!(lines.len(), scene.rows().len());
    assert!(lines.iter().all(|line| line["method"] == "cranny" && line["false_negatives"] == 0));
    assert_eq!(lines[0]["level"], "boxes");
}

/// The panels are made of the answers at poses of their kind.
#[test]
fn errors_are_judged_where_bodies_are_apart_and_where_they_overlap() {
    let scene = Scene::new();
    assert_eq!(scene.accuracy(&["--runs", "1", "--deadlines", "none"]).code, Some(0));
    let (rows, poses) = (scene.rows(), scene.table("poses.csv"));
    for row in rows.iter().filter(|row| row["method"] == "cranny") {
        let is_of = |pose: &&Row| {
            ["level", "budget", "memory"].iter().all(|name| pose[*name] == row[*name])
        };
        let apart = poses.iter().filter(is_of).filter(|pose| pose["meets"] == "apart").count();
        assert_eq!(number(row, "apart_poses") as usize, apart);
        assert!(apart > 5 && number(row, "apart_mean_us") > 0.0);
        assert_eq!((row["apart_wrong"].as_str(), row["overlapping_wrong"].as_str()), ("0", "0"));
        assert_eq!(row["overlapping_poses"], row["contact_poses"]);
        for kind in ["apart", "overlapping"] {
            let [mean, max] =
                ["error", "error_max"].map(|name| number(row, &format!("{kind}_{name}")));
            assert!(0.0 <= mean && mean <= max && max <= 1.0, "{row:?}");
            let is_exact = row["level"] == "exact" && row["budget"].is_empty();
            assert!(!is_exact || max < 1e-12, "{row:?}");
        }
    }
    let peer = |name: &str| rows.iter().find(|row| row["method"] == name).unwrap();
    // Single precision is off by little, convex pieces that fill a cup by more.
    assert!(number(peer("parry-trimesh"), "apart_error") < 1e-6);
    assert!(number(peer("parry-decomposition"), "apart_error") > 1e-4);
}

#[test]
fn the_page_needs_no_other_file_and_says_what_follows() {
    let scene = Scene::new();
    assert_eq!(scene.accuracy(&["--runs", "1"]).code, Some(0));
    let html = scene.page();
    assert!(html.starts_with("<!DOCTYPE html>") && html.trim_end().ends_with("</html>"));
    for word in [
        "<h1>What accuracy costs in time: cup.obj and ball.obj</h1>",
        "Where bodies are apart, an exact answer takes ",
        "Where they overlap, an exact answer takes ",
        "Parry&#39;s triangle mesh is",
        "cranny accuracy cup.obj ball.obj --poses poses.json --out DIR",
        "</svg>",
        "There are 24 poses of 1 pair: ",
        "What ten times less error costs",
        "Convex pieces are ",
        "<dt>warm, cold</dt>",
        "An open pose has no answer whether the bodies meet",
    ] {
        let plain = word.replace("&#39;", "'");
        assert!(html.contains(word) || html.contains(&plain), "{word}");
    }
    for outside in ["src=\"http", "href=", "<script", "url("] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(!html.contains("timed on fewer poses") && !html.contains(" of 24</td>"));
    // What the page says to be open is what the table of figures has.
    let rows = scene.rows();
    let sum = |names: [&str; 2]| -> usize {
        rows.iter().flat_map(|row| names.map(|name| number(row, name) as usize)).sum()
    };
    let [answers, open] =
        [["apart_poses", "overlapping_poses"], ["apart_open", "overlapping_open"]].map(sum);
    let said = format!("Of {answers} answers in this table {open} are open; ");
    assert!(open > 0 && html.contains(&said), "{said}");
    // No page for what could not be measured.
    let ladder = 1 + 5;
    assert_eq!(html.matches("<tr>").count(), ladder + 1 + scene.rows().len());
}

/// A ball that falls onto a floor: pairs and poses come from the run.
#[test]
fn a_scene_is_measured_at_the_poses_of_its_run() {
    let folder = Folder::new();
    let scene = folder.write(
        "fall.ron",
        r#"(version: 1, gravity: (0, 0, -9.81), step: 0.02, duration: 1.0, bodies: [
            (name: "floor", shape: Generator(Cuboid(size: (4, 4, 1))), kind: Fixed),
            (name: "far", shape: Generator(Cuboid(size: (1, 1, 1))), kind: Fixed, pose: (at: (9, 0, 0))),
            (name: "box", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0, 0, 1.2))),
        ], effects: [Response()])"#,
    );
    let out = argument(&folder.path("out"));
    let options = ["--runs", "1", "--deadlines", "none", "--budgets", "none", "--no-peers"];
    let all = [&["accuracy", &scene, "--out", &out, "--duration", "0.5"], &options[..]].concat();
    let outcome = run(&all);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    let csv = fs::read_to_string(folder.path("out").join("accuracy.csv")).unwrap();
    let poses: Vec<&str> =
        csv.lines().skip(1).map(|line| line.split(',').nth(5).unwrap()).collect();
    // The boxes of the two overlap from the first touch on: in some of 25 steps.
    let seen: usize = poses[0].parse().unwrap();
    assert!(seen > 5 && seen < 25 && poses.iter().all(|count| *count == poses[0]), "{poses:?}");
    let html = fs::read_to_string(folder.path("out").join("accuracy.html")).unwrap();
    let said = format!("There are {seen} poses of 1 pair: ");
    for word in [
        &said,
        "fall",
        "What it does to the motion",
        "A step is quickest under ",
        "Bodies end ",
        "Where that was, and who moved:",
        "cranny accuracy fall.ron --out DIR --duration 0.5 --runs 1",
    ] {
        assert!(html.contains(word), "{word}");
    }
    let lonely = folder.write(
        "alone.ron",
        r#"(version: 1, gravity: (0, 0, 0), step: 0.02, duration: 0.1, bodies: [
            (name: "box", shape: Generator(Cuboid(size: (1, 1, 1)))),
        ], effects: [Response()])"#,
    );
    run(&["accuracy", &lonely, "--out", &out])
        .assert_refused(2, &["alone.ron", "nothing to measure"]);
}

#[test]
fn a_scene_takes_no_poses_and_meshes_need_them() {
    let scene = Scene::new();
    let out = argument(&scene.folder.path("out"));
    let [a, b] = &scene.meshes;
    let refused = |arguments: &[&str], words: &[&str]| {
        let outcome = run(&[&["accuracy", "--out", &out], arguments].concat());
        assert_eq!(outcome.code, Some(2));
        words.iter().for_each(|word| assert!(outcome.stderr.contains(word), "{outcome:?}"));
    };
    refused(&[a, b], &["--poses"]);
    refused(&["scene.ron", "--poses", &scene.poses], &["<B>"]);
    refused(&[a, b, "--poses", &scene.poses, "--duration", "1"], &["--duration", "cannot be used"]);
    refused(&[a], &["a mesh or a model, no scene"]);
}

#[test]
fn what_cannot_be_asked_or_written_is_refused() {
    let scene = Scene::new();
    let cube = scene.folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
    let taken = scene.folder.write("taken", "a file");
    let far =
        scene.folder.write("far.json", r#"[{"b": [1,0,0,1e300, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]"#);
    let ask = |poses: &str, out: &str| {
        run(&["accuracy", &cube, &cube, "--poses", poses, "--out", out, "--no-peers"])
    };
    ask(&scene.poses, &taken).assert_refused(1, &["taken"]);
    // A folder where a file must go is reported before the work, and nothing is left behind.
    let blocked = scene.folder.path("blocked");
    fs::create_dir_all(blocked.join("refinement.csv")).unwrap();
    ask(&scene.poses, &argument(&blocked))
        .assert_refused(1, &["refinement.csv", "cannot be written"]);
    assert_eq!(fs::read_dir(&blocked).unwrap().count(), 1);
    let empty = scene.folder.write("empty.json", "[]");
    ask(&empty, &argument(&scene.folder.path("out"))).assert_refused(2, &["at least one pose"]);
    let nothing = ["--levels", "none", "--budgets", "none", "--deadlines", "none", "--no-peers"];
    scene.accuracy(&nothing).assert_refused(2, &["nothing is left", "--levels"]);
    for (option, list, reason) in [
        ("--levels", "exact,tree", "how deep"),
        ("--budgets", "-5", "whole number of tests"),
        ("--deadlines", "10,0", "microseconds"),
        ("--runs", "0", "1 or more"),
        ("--patience", "-1", "seconds"),
    ] {
        let refused = scene.accuracy(&[option, list]);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
        assert!(refused.stderr.contains(option) && refused.stderr.contains(reason), "{refused:?}");
    }
    ask(&far, &argument(&scene.folder.path("out"))).assert_refused(2, &["pose 0"]);
    assert_eq!(run(&["accuracy", &cube, &cube, "--poses", &scene.poses]).code, Some(2));
}
