//! The command against the answers of others: six pairs of real meshes at 240 poses.

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

    /// The command's lines, with the pair's two bodies as A and B in this order.
    fn query(&self, [first, second]: [&str; 2]) -> Vec<Value> {
        let entry = |pose: &Value| match first {
            "a" => json!({"a": null, "b": pose["b"]}),
            _ => json!({"a": pose["b"], "b": null}),
        };
        let folder = Folder::new();
        let poses: Vec<Value> = self.poses().iter().map(entry).collect();
        let poses = folder.write("poses.json", Value::Array(poses).to_string());
        let [mesh_a, mesh_b] = [first, second].map(|body| argument(&self.mesh(body)));
        let [scale_a, scale_b] = [first, second].map(|body| self.scale(body).to_string());
        run(&[
            "query",
            &mesh_a,
            &mesh_b,
            "--poses",
            &poses,
            "--scale-a",
            &scale_a,
            "--scale-b",
            &scale_b,
        ])
        .json_lines()
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
