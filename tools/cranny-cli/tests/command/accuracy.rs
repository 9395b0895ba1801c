//! What `accuracy` writes.

use std::collections::BTreeMap;
use std::fs;

use cranny_shapes::{Cuboid, Cup, Sphere};

use crate::harness::{Folder, Outcome, argument, run};

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

    fn rows(&self) -> Vec<BTreeMap<String, String>> {
        let text = fs::read_to_string(self.folder.path("out/accuracy.csv")).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
        let names: Vec<String> = lines.next().unwrap().collect();
        lines
            .map(|cells| {
                let row: BTreeMap<_, _> = names.iter().cloned().zip(cells).collect();
                assert_eq!(row.len(), names.len());
                row
            })
            .collect()
    }
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
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
    assert_eq!(ours.len(), 2 * (10 + 7));
    for row in &ours {
        let wrong = (row["false_negatives"].as_str(), row["false_positives"].as_str());
        assert_eq!(wrong, ("0", "0"), "{row:?}");
        assert_eq!(row["poses"], FRAMES.to_string());
        assert!(
            number(row, "median_us") > 0.0 && number(row, "p99_us") >= number(row, "median_us")
        );
        assert!(number(row, "width_max") >= number(row, "width_mean"));
        // The upper end is no farther from the distance than the interval is wide.
        assert!(number(row, "distance_error_max") <= number(row, "width_max") + 1e-12);
    }
    let row = |level: &str, budget: &str, memory: &str| {
        let is = |row: &&&BTreeMap<String, String>| {
            row["level"] == level && row["budget"] == budget && row["memory"] == memory
        };
        *ours.iter().find(is).unwrap()
    };
    for memory in ["cold", "warm"] {
        let exact = row("exact", "", memory);
        assert_eq!(exact["open"], "0");
        assert!(number(exact, "width_max") < 1e-12 && number(exact, "witness_error_mean") == 0.0);
        // The deepest contact is one of those told.
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
    }
    let svg = fs::read_to_string(scene.folder.path("out/accuracy.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for word in
        ["trees, exact, warm", "budgets of tests, cold", "convex decomposition", "tree:2", "30"]
    {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn peers_may_be_left_out_and_rows_told_as_json() {
    let scene = Scene::new();
    let lines = scene.accuracy(&["--no-peers", "--format", "json"]).json_lines();
    assert_eq!(lines.len(), scene.rows().len());
    assert!(lines.iter().all(|line| line["method"] == "cranny" && line["false_negatives"] == 0));
    assert_eq!(lines[0]["level"], "boxes");
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
    ask(&far, &argument(&scene.folder.path("out"))).assert_refused(2, &["pose 0"]);
    assert_eq!(run(&["accuracy", &cube, &cube, "--poses", &scene.poses]).code, Some(2));
}
