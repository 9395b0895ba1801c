//! The command against the answers of others: six pairs of real meshes at 240 poses.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use cranny_exact::DVec3;
use cranny_scene::read_mesh;
use serde_json::{Value, json};

use crate::harness::{Folder, argument, corpus, run};

/// Largest accepted difference of distances, as a share of the sum of the two meshes' diagonals.
/// The recorded distances come from `f64` libraries; ours and theirs agree to about 1e-15.
const DISTANCE_TOLERANCE: f64 = 1e-9;

/// What a line says that is not of its pose alone.
const HISTORY: [&str; 3] = ["pose", "micros", "tests"];

struct Pair {
    file: PathBuf,
    content: Value,
    corpus: PathBuf,
}

impl Pair {
    fn mesh(&self, body: &str) -> PathBuf {
        self.corpus.join(self.content[body].as_str().unwrap())
    }

    fn scale(&self, body: &str) -> f64 {
        self.content[format!("scale_{body}")].as_f64().unwrap()
    }

    fn diagonal(&self, body: &str) -> f64 {
        let mesh = read_mesh(&self.mesh(body)).unwrap().mesh;
        mesh.scaled(DVec3::splat(self.scale(body))).unwrap().bounds().diagonal()
    }

    fn poses(&self) -> &[Value] {
        self.content["poses"].as_array().unwrap()
    }

    /// The same poses in another order, by their numbers.
    fn reordered(&self, order: &[usize]) -> Self {
        let mut content = self.content.clone();
        content["poses"] = order.iter().map(|&k| self.poses()[k].clone()).collect();
        Self { file: self.file.clone(), content, corpus: self.corpus.clone() }
    }

    /// The poses by how far apart bodies are: neighbours are mostly near each other.
    fn sorted(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.poses().len()).collect();
        let distance = |k: usize| self.poses()[k]["distance"].as_f64().unwrap();
        order.sort_by(|&i, &j| distance(i).total_cmp(&distance(j)));
        order
    }

    /// The poses in an order that leads back and forth: each the multiple of a number without a
    /// common divisor.
    fn shuffled(&self) -> Vec<usize> {
        let count = self.poses().len();
        assert_ne!(count % 17, 0);
        (0..count).map(|k| (17 * k + 5) % count).collect()
    }

    /// What the command takes for the pair's two bodies as A and B in this order, and its poses in
    /// a file.
    fn arguments(&self, [first, second]: [&str; 2], folder: &Folder) -> Vec<String> {
        let entry = |pose: &Value| match first {
            "a" => json!({"a": null, "b": pose["b"]}),
            _ => json!({"a": pose["b"], "b": null}),
        };
        let poses: Vec<Value> = self.poses().iter().map(entry).collect();
        let poses = folder.write("poses.json", Value::Array(poses).to_string());
        let [mesh_a, mesh_b] = [first, second].map(|body| argument(&self.mesh(body)));
        let [scale_a, scale_b] = [first, second].map(|body| self.scale(body).to_string());
        let options = ["--scale-a", &scale_a, "--scale-b", &scale_b, "--poses", &poses];
        [&mesh_a, &mesh_b]
            .into_iter()
            .map(String::as_str)
            .chain(options)
            .map(str::to_owned)
            .collect()
    }

    /// Lines of `query`.
    fn query(&self, order: [&str; 2]) -> Vec<Value> {
        let folder = Folder::new();
        let arguments = self.arguments(order, &folder);
        let arguments: Vec<&str> =
            std::iter::once("query").chain(arguments.iter().map(String::as_str)).collect();
        run(&arguments).json_lines()
    }

    /// Rows of the table of poses that `accuracy` writes for some levels and budgets.
    fn accuracy(&self) -> Vec<BTreeMap<String, String>> {
        let folder = Folder::new();
        let out = argument(&folder.path("out"));
        let arguments = self.arguments(["a", "b"], &folder);
        let options = [
            "--levels",
            "boxes,hulls,caps,tree:4,tree:10",
            "--budgets",
            "300",
            "--deadlines",
            "200",
            "--patience",
            "300",
            "--runs",
            "1",
            "--no-peers",
            "--out",
            &out,
        ];
        let arguments: Vec<&str> = std::iter::once("accuracy")
            .chain(arguments.iter().map(String::as_str))
            .chain(options)
            .collect();
        assert_eq!(run(&arguments).code, Some(0));
        let text = std::fs::read_to_string(folder.path("out/poses.csv")).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
        let names: Vec<String> = lines.next().unwrap().collect();
        lines.map(|cells| names.iter().cloned().zip(cells).collect()).collect()
    }
}

fn pairs(corpus: &Path) -> Vec<Pair> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(corpus.join("expected"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    files.sort();
    let pair = |file: PathBuf| {
        let content = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        Pair { file, content, corpus: corpus.to_owned() }
    };
    files.into_iter().map(pair).collect()
}

fn exchanged(contained: &Value) -> Value {
    match contained.as_str() {
        Some("A_in_B") => "B_in_A".into(),
        Some("B_in_A") => "A_in_B".into(),
        _ => Value::Null,
    }
}

#[test]
fn six_pairs_agree_on_all_poses_either_way_round() {
    let Some(corpus) = corpus() else { return };
    let pairs = pairs(&corpus);
    assert_eq!(pairs.len(), 6);
    let mut poses = 0;
    let mut differences = Vec::new();
    for pair in &pairs {
        let (lines, swapped) = (pair.query(["a", "b"]), pair.query(["b", "a"]));
        assert_eq!((lines.len(), swapped.len()), (pair.poses().len(), pair.poses().len()));
        let tolerance = DISTANCE_TOLERANCE * (pair.diagonal("a") + pair.diagonal("b"));
        for (index, (expected, (line, back))) in
            pair.poses().iter().zip(lines.iter().zip(&swapped)).enumerate()
        {
            let distance = |value: &Value| value["distance"].as_f64().unwrap();
            let agrees = line["surface"] == expected["surface"]
                && line["solid"] == expected["solid"]
                && line["contained"] == expected["contain"]
                && (distance(line) - distance(expected)).abs() <= tolerance;
            let symmetric = line["surface"] == back["surface"]
                && line["solid"] == back["solid"]
                && line["contained"] == exchanged(&back["contained"])
                && distance(line).to_bits() == distance(back).to_bits();
            if !(agrees && symmetric) {
                differences.push(format!(
                    "{} pose {index}: expected {expected}\n  found {line}\n  swapped {back}",
                    pair.file.display()
                ));
            }
            poses += 1;
        }
    }
    assert_eq!(poses, 240);
    assert!(differences.is_empty(), "{} differ:\n{}", differences.len(), differences.join("\n"));
}

/// The certificate of each pose holds, A and B either way round.
#[test]
fn certificates_of_all_poses_hold() {
    let Some(corpus) = corpus() else { return };
    let mut certificates = 0;
    for pair in &pairs(&corpus) {
        for order in [["a", "b"], ["b", "a"]] {
            let folder = Folder::new();
            let arguments = pair.arguments(order, &folder);
            let arguments: Vec<&str> = ["query", "--certificate", "--demand", "intersects"]
                .into_iter()
                .chain(arguments.iter().map(String::as_str))
                .collect();
            let lines = run(&arguments);
            assert_eq!(lines.code, Some(0), "{lines:?}");
            let file = folder.write("certificates.jsonl", &lines.stdout);
            for line in run(&["verify", &file, "--format", "json"]).json_lines() {
                assert_eq!(line["holds"], true, "{}: {line}", pair.file.display());
                certificates += 1;
            }
        }
    }
    assert_eq!(certificates, 2 * 240);
}

/// With memory, earlier queries change nothing: to the bit, in sorted and in shuffled order.
#[test]
fn answers_do_not_depend_on_the_order_of_poses() {
    let Some(corpus) = corpus() else { return };
    let mut poses = 0;
    for pair in &pairs(&corpus) {
        let lines = pair.query(["a", "b"]);
        for order in [pair.sorted(), pair.shuffled()] {
            let mut seen = order.clone();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..lines.len()), "each once");
            let others = pair.reordered(&order).query(["a", "b"]);
            assert_eq!(others.len(), lines.len());
            for (&k, mut other) in order.iter().zip(others) {
                let mut line = lines[k].clone();
                for line in [&mut line, &mut other] {
                    line.as_object_mut().unwrap().retain(|name, _| !HISTORY.contains(&&name[..]));
                }
                assert!(line == other, "{} pose {k}", pair.file.display());
                poses += 1;
            }
        }
    }
    assert_eq!(poses, 2 * 240);
}

/// The M12 nut meets nothing anywhere along the helix of its bolt, and a tenth of the pitch aside
/// it is thousands of triangles deep in the thread.
#[test]
fn the_nut_of_twelve_millimetres_follows_its_bolt() {
    /// Of M12, in metres.
    const PITCH: f64 = 0.001_75;
    /// Where the nut's thread stands in the bolt's: by trial, in the middle between the flanks.
    const START: f64 = 0.012 + PITCH * 1.5 / 16.0;
    let Some(corpus) = corpus() else { return };
    let pairs = pairs(&corpus);
    let pair = pairs.iter().find(|pair| pair.file.ends_with("p01_bolt_nut_m12.json")).unwrap();
    let pose = |k: u32, shift: f64| {
        let turns = f64::from(k) / 60.0;
        let (sin, cos) = (turns * std::f64::consts::TAU).sin_cos();
        let z = START + PITCH * (turns + shift);
        let rows = [[cos, -sin, 0.0, 0.0], [sin, cos, 0.0, 0.0], [0.0, 0.0, 1.0, z]];
        let last = [[0.0, 0.0, 0.0, 1.0]];
        json!({"a": null, "b": rows.iter().chain(&last).flatten().collect::<Vec<_>>()})
    };
    let folder = Folder::new();
    let query = |demand: &str, poses: Vec<Value>| {
        let poses = folder.write("helix.json", Value::Array(poses).to_string());
        let [mesh_a, mesh_b] = ["a", "b"].map(|body| argument(&pair.mesh(body)));
        run(&["query", &mesh_a, &mesh_b, "--poses", &poses, "--demand", demand]).json_lines()
    };
    // A turn and a half, by six degrees.
    let along = (0..90).map(|k| pose(k, 0.0)).collect();
    for (k, line) in query("intersects", along).iter().enumerate() {
        assert_eq!((&line["surface"], &line["solid"]), (&json!("none"), &json!(false)), "{k}");
    }
    let aside = [(0, 0.1), (0, -0.1), (25, 0.1), (70, -0.1)].map(|(k, shift)| pose(k, shift));
    for line in query("regions", aside.to_vec()) {
        assert_eq!(line["surface"], json!("cross"));
        let pairs = line["triangle_pairs"].as_u64().unwrap();
        assert!(pairs > 4_000, "{pairs}");
    }
}

/// No level and no budget, of tests or of time, with memory or without, excludes what others found,
/// and the intervals hold the distances that they measured.
#[test]
fn levels_and_budgets_contradict_no_answer_of_others() {
    let Some(corpus) = corpus() else { return };
    let mut reported = BTreeMap::from([("apart", 0), ("meets", 0), ("open", 0)]);
    for pair in &pairs(&corpus) {
        let tolerance = DISTANCE_TOLERANCE * (pair.diagonal("a") + pair.diagonal("b"));
        let rows = pair.accuracy();
        assert_eq!(rows.len(), 2 * 7 * pair.poses().len());
        for row in &rows {
            let expected = &pair.poses()[row["pose"].parse::<usize>().unwrap()];
            let meets = expected["surface"] != "none" || expected["solid"] == true;
            let right = if meets { "meets" } else { "apart" };
            *reported.get_mut(row["told"].as_str()).unwrap() += 1;
            let distance = expected["distance"].as_f64().unwrap();
            let [least, most] = ["at_least", "at_most"].map(|end| row[end].parse::<f64>().unwrap());
            let agrees = (row["told"] == "open" || row["told"] == right)
                && least <= distance + tolerance
                && distance <= most + tolerance;
            assert!(agrees, "{}: expected {expected}, found {row:?}", pair.file.display());
        }
    }
    assert!(reported.values().all(|&times| times > 300), "{reported:?}");
}

/// The links that meet at recorded configurations of two robots, as two libraries found them.
#[test]
fn links_meet_where_others_say_they_do() {
    let Some(corpus) = corpus() else { return };
    for name in ["panda", "go2"] {
        let file = corpus.join(format!("robots/{name}.expected.json"));
        let expected: Value =
            serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let expected = expected["configs"].as_array().unwrap();
        let folder = Folder::new();
        let configurations: Value = expected.iter().map(|config| config["q"].clone()).collect();
        let configurations = folder.write("q.json", configurations.to_string());
        let urdf = format!("example-robot-data/robots/{name}_description/urdf/{name}.urdf");
        let urdf = argument(&corpus.join("robots").join(urdf));
        let found = run(&["robot", &urdf, "--configurations", &configurations, "--distance"]);
        assert_eq!(found.code, Some(0), "{found:?}");
        assert_eq!(found.stdout.lines().count(), expected.len());
        for (line, expected) in found.stdout.lines().zip(expected) {
            let line: Value = serde_json::from_str(line).unwrap();
            assert_eq!(line["hits"], expected["hits"], "{name}, {}", line["configuration"]);
            let meets = expected["hits"].as_array().is_some_and(|hits| !hits.is_empty());
            assert_eq!(line["distance"].as_f64() == Some(0.0), meets, "{name}");
        }
    }
}
