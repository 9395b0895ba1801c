//! `query --certificate` and `verify`.

use cranny_shapes::Cuboid;
use serde_json::Value;

use crate::harness::{Folder, Outcome, run};

/// Apart, face to face, crossing, one in the other.
const SHIFTS: [(f64, f64); 4] = [(1.5, 0.25), (1.0, 0.25), (0.6, 0.25), (0.0, 0.0)];

struct Certified {
    folder: Folder,
    certificates: String,
    text: String,
}

fn certified() -> Certified {
    let folder = Folder::new();
    let large = folder.mesh("large.obj", &Cuboid { size: [1.0; 3] }.build().unwrap());
    let small = folder.mesh("small.obj", &Cuboid { size: [0.5; 3] }.build().unwrap());
    let pose = |(x, y): (f64, f64)| {
        let x = if x == 0.0 { 0.0 } else { x - 0.25 };
        format!(r#"{{"b": [0,-1,0,{x}, 1,0,0,{y}, 0,0,1,0.125, 0,0,0,1]}}"#)
    };
    let poses = folder.write("poses.json", format!("[{}]", SHIFTS.map(pose).join(",")));
    let outcome = run(&["query", &large, &small, "--poses", &poses, "--certificate"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    let certificates = folder.write("certificates.jsonl", &outcome.stdout);
    Certified { folder, certificates, text: outcome.stdout }
}

/// What `verify` says of each line of a file, be it that all hold or not.
fn checked(outcome: &Outcome) -> Vec<Value> {
    outcome.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn certificates_of_all_verdicts_hold() {
    let certified = certified();
    let lines: Vec<Value> =
        certified.text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let surfaces: Vec<&str> = lines.iter().map(|line| line["surface"].as_str().unwrap()).collect();
    assert_eq!(surfaces, ["none", "touch", "cross", "none"]);
    assert_eq!(lines[3]["contained"], "B_in_A");
    assert!(lines[0]["regions"].is_array(), "the answer is there as without certificates");
    let outcome = run(&["verify", &certified.certificates]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    for words in ["pose 1  holds", "B lies in A", "4 of 4 certificates hold"] {
        assert!(outcome.stdout.contains(words), "{words}: {outcome:?}");
    }
    let moved = certified.folder.mesh("moved.obj", &Cuboid { size: [1.0; 3] }.build().unwrap());
    let elsewhere = run(&["verify", &certified.certificates, "--mesh-a", &moved]);
    assert_eq!(elsewhere.code, Some(0), "{elsewhere:?}");
    let other = certified.folder.mesh("other.obj", &Cuboid { size: [4.0; 3] }.build().unwrap());
    let wrong = run(&["verify", &certified.certificates, "--mesh-a", &other, "--format", "json"]);
    assert_eq!(wrong.code, Some(1), "{wrong:?}");
    assert!(wrong.stderr.contains("do not hold"), "{wrong:?}");
    assert!(checked(&wrong).iter().any(|line| line["holds"] == false), "{wrong:?}");
}

/// Whatever bit of a line is flipped, the line is refused.
#[test]
fn one_flipped_bit_is_refused() {
    let certified = certified();
    let mut mangled = Vec::new();
    let mut count = 0;
    for line in certified.text.lines() {
        // Every byte of a line is met by some bit; all bits of all bytes would take minutes.
        for byte in 0..line.len() {
            let mut bytes = line.as_bytes().to_vec();
            bytes[byte] ^= 1 << (byte % 8);
            mangled.extend_from_slice(&bytes);
            mangled.push(b'\n');
            count += 1;
        }
    }
    let file = certified.folder.write("mangled.jsonl", &mangled);
    let outcome = run(&["verify", &file, "--format", "json"]);
    assert_eq!(outcome.code, Some(1));
    let checked = checked(&outcome);
    assert!(checked.len() >= count, "a flip may make two lines of one: {}", checked.len());
    assert!(checked.iter().all(|line| line["holds"] == false && line["why"].is_string()));
}

/// A line that somebody changed and sealed anew is refused for what it says.
#[test]
fn a_false_claim_under_a_right_sum_is_refused() {
    let certified = certified();
    let forged = |from: &str, to: &str, pose: usize| {
        let line = certified.text.lines().nth(pose).unwrap();
        assert!(line.contains(from), "{from}: {line}");
        let (content, _) = line.rsplit_once(",\"sum\":\"").unwrap();
        let content = content.replacen(from, to, 1);
        let sum = &blake3::hash(content.as_bytes()).to_hex()[..32];
        let file =
            certified.folder.write("forged.jsonl", format!("{content},\"sum\":\"{sum}\"}}\n"));
        let outcome = run(&["verify", &file]);
        assert_eq!(outcome.code, Some(1), "{outcome:?}");
        outcome.stdout
    };
    let none = forged(r#""surface":"none""#, r#""surface":"cross""#, 0);
    assert!(none.contains("names no pair of faces that cross"), "{none}");
    assert!(forged(r#""solid":false"#, r#""solid":true"#, 0).contains("solid is false"));
    assert!(forged(r#""surface":"touch""#, r#""surface":"none""#, 1).contains("step 0"));
    assert!(forged(r#""surface":"cross""#, r#""surface":"none""#, 2).contains("steps end"));
    assert!(forged(r#""B_in_A""#, r#""A_in_B""#, 3).contains("contained"));
    assert!(forged(r#""crossing":["#, r#""crossing":[9"#, 2).contains("no face 9"));
}

#[test]
fn what_is_no_certificate_is_refused() {
    let certified = certified();
    let folder = &certified.folder;
    run(&["verify", &folder.write("empty.jsonl", "\n")]).assert_refused(2, &["no certificate"]);
    run(&["verify", &folder.write("scene.ron", "(\n bodies: [],\n)")])
        .assert_refused(2, &["scene.ron", "no certificates in this file"]);
    run(&["verify", "missing.jsonl"]).assert_refused(2, &["missing.jsonl", "no such file"]);
    let plain = run(&["verify", &folder.write("plain.jsonl", "{\"pose\": 0}\n\u{fffd}\n")]);
    assert_eq!(plain.code, Some(1));
    assert!(plain.stdout.contains("plain.jsonl:2") && plain.stdout.contains("no sum"), "{plain:?}");
    let cube = folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
    let poses = folder.write("one.json", "[{}]");
    for options in [["--accuracy", "hulls"], ["--budget", "9"], ["--format", "text"]] {
        let arguments =
            [&["query", &cube, &cube, "--poses", &poses, "--certificate"], &options[..]];
        run(&arguments.concat()).assert_refused(2, &["--certificate", options[0]]);
    }
}
