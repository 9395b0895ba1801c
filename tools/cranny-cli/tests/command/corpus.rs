//! The command against the answers of others: six pairs of real meshes at 240 poses.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use cranny_exact::DVec3;
use cranny_scene::read_mesh;
use serde_json::{Value, json};

use crate::harness::{Folder, argument, run};

/// Largest accepted difference of distances, as a share of the sum of the two meshes' diagonals.
/// The recorded distances come from `f64` libraries; ours and theirs agree to about 1e-15.
const DISTANCE_TOLERANCE: f64 = 1e-9;

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

    /// What the command takes for the pair's two bodies as A and B in this order, and its poses in a file.
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
    let Some(corpus) = std::env::var_os("CRANNY_CORPUS").map(PathBuf::from) else {
        println!("skipped: CRANNY_CORPUS not set");
        return;
    };
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

/// No level and no budget, of tests or of time, with memory or without, excludes what others found, and the intervals
/// hold the distances that they measured.
#[test]
fn levels_and_budgets_contradict_no_answer_of_others() {
    let Some(corpus) = std::env::var_os("CRANNY_CORPUS").map(PathBuf::from) else {
        println!("skipped: CRANNY_CORPUS not set");
        return;
    };
    let mut told = BTreeMap::from([("apart", 0), ("meets", 0), ("open", 0)]);
    for pair in &pairs(&corpus) {
        let tolerance = DISTANCE_TOLERANCE * (pair.diagonal("a") + pair.diagonal("b"));
        let rows = pair.accuracy();
        assert_eq!(rows.len(), 2 * 7 * pair.poses().len());
        for row in &rows {
            let expected = &pair.poses()[row["pose"].parse::<usize>().unwrap()];
            let meets = expected["surface"] != "none" || expected["solid"] == true;
            let right = if meets { "meets" } else { "apart" };
            *told.get_mut(row["told"].as_str()).unwrap() += 1;
            let distance = expected["distance"].as_f64().unwrap();
            let [least, most] = ["at_least", "at_most"].map(|end| row[end].parse::<f64>().unwrap());
            let agrees = (row["told"] == "open" || row["told"] == right)
                && least <= distance + tolerance
                && distance <= most + tolerance;
            assert!(agrees, "{}: expected {expected}, found {row:?}", pair.file.display());
        }
    }
    assert!(told.values().all(|&times| times > 300), "{told:?}");
}
