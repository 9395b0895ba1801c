//! `cranny recover`: after kills at any moment, and of damaged files.

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::harness::{Folder, argument, cranny, run};

/// A box that tumbles down a slope of its own, far longer than anybody waits.
const ENDLESS: &str = r#"(
    step: 0.0078125, duration: 100000, seed: 3, record: (every: 2),
    bodies: [
        (name: "floor", shape: Generator(Cuboid(size: (4, 4, 1))), kind: Fixed),
        (name: "box", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0.125, 0, 1.05)),
         velocity: (angular: (0.3, 0.2, 0.5))),
    ],
    effects: [Response(), Contacts(margin: 0.01)],
)"#;

/// Waits until a file has some size. A run that does not get there within minutes hangs.
fn wait_for_size(path: &Path, bytes: u64) {
    let start = Instant::now();
    while path.metadata().map_or(0, |found| found.len()) < bytes {
        assert!(start.elapsed() < Duration::from_secs(300), "{} does not grow", path.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// What a run leaves that is killed when its recording has reached a size.
fn killed(folder: &Folder, name: &str, bytes: u64) -> String {
    let scene = folder.write("endless.ron", ENDLESS);
    let path = argument(&folder.path(name));
    let mut child = cranny()
        .args(["run", &scene, "--record", &path])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let partial = format!("{path}.partial");
    wait_for_size(Path::new(&partial), bytes);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!Path::new(&path).exists(), "nothing stands under the final name");
    partial
}

#[test]
fn a_killed_run_is_recovered_and_replays_to_the_bit() {
    let folder = Folder::new();
    // Sizes that lie somewhere in a chunk.
    for (k, bytes) in [30_000u64, 45_678, 61_007, 100_003].into_iter().enumerate() {
        let partial = killed(&folder, &format!("run{k}.mcap"), bytes);
        let found = run(&["recover", &partial, "--format", "json"]).json_lines().remove(0);
        let out = found["out"].as_str().unwrap();
        assert_eq!(format!("{out}.partial"), partial);
        let (frames, last) =
            (found["frames"].as_u64().unwrap(), found["steps"][1].as_u64().unwrap());
        assert!(frames >= 32 && last == 2 * (frames - 1), "{found}");
        assert_eq!(found["seconds"][1], last as f64 * 0.0078125);
        assert_eq!((&found["was_complete"], &found["damaged_chunks"]), (&false.into(), &0.into()));
        assert!(Path::new(&partial).exists(), "the partial file is kept");
        let replayed = run(&["replay", out, "--format", "json"]).json_lines().remove(0);
        assert_eq!((&replayed["complete"], &replayed["interrupted"]), (&true.into(), &true.into()));
        assert_eq!(replayed["held_frames"], frames);
        assert!(replayed["same"].as_u64().unwrap() > 0 && replayed["unknown"] == 0, "{replayed}");
        assert_eq!(replayed["different"].as_array().unwrap().len(), 0, "{replayed}");
    }
}

/// A recording of one second, whole.
fn whole(folder: &Folder) -> (String, Vec<u8>) {
    let scene = folder.write("short.ron", ENDLESS.replace("100000", "2"));
    let path = argument(&folder.path("whole.mcap"));
    let outcome = run(&["run", &scene, "--record", &path]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let bytes = std::fs::read(&path).unwrap();
    (path, bytes)
}

/// Bytes in front of a chunk's records.
const CHUNK_HEAD: usize = 60;

/// Where each chunk of a file begins: its operation code.
fn chunks(bytes: &[u8]) -> Vec<usize> {
    let (mut at, mut starts) = (8, Vec::new());
    while let Some(length) = bytes.get(at + 1..at + 9) {
        let length = u64::from_le_bytes(length.try_into().unwrap()) as usize;
        if bytes[at] == 0x06 {
            starts.push(at);
        }
        at += 9 + length;
    }
    assert!(starts.len() > 3);
    starts
}

#[test]
fn files_cut_or_damaged_anywhere_give_what_is_whole_or_a_clear_refusal() {
    let folder = Folder::new();
    let (path, bytes) = whole(&folder);
    let out = argument(&folder.path("out.mcap"));
    let frames = run(&["replay", &path, "--format", "json"]).json_lines().remove(0);
    let frames = frames["held_frames"].clone();
    let (mut recovered, mut refused, mut skipped) = (0, 0, 0);
    let mut check = |name: &str, damaged: &[u8]| {
        let file = folder.write(name, damaged);
        let outcome = run(&["recover", &file, "--out", &out, "--format", "json"]);
        if outcome.code != Some(0) {
            outcome.assert_refused(2, &[name]);
            refused += 1;
            return;
        }
        let found = outcome.json_lines().remove(0);
        skipped += u64::from(found["damaged_chunks"] != 0);
        let replayed = run(&["replay", &out, "--format", "json"]);
        assert_eq!(replayed.code, Some(0), "{replayed:?}");
        let replayed = replayed.json_lines().remove(0);
        assert_eq!(replayed["held_frames"], found["frames"], "{replayed}");
        // Nothing that lacks a part of the run looks as if it were whole.
        let is_whole = found["damaged_chunks"] == 0 && found["frames"] == frames;
        assert!(is_whole || replayed["interrupted"] == true, "{found} {replayed}");
        recovered += 1;
    };
    // Every chunk once, the one of the bodies and the one that first names the channels included.
    for at in chunks(&bytes) {
        for (at, bit) in [(at + CHUNK_HEAD, 0x10), (at, 0x80)] {
            let mut flipped = bytes.clone();
            flipped[at] ^= bit;
            check("chunk.mcap", &flipped);
        }
    }
    for k in 1..20 {
        check("cut.mcap", &bytes[..bytes.len() * k / 20]);
        let mut flipped = bytes.clone();
        flipped[bytes.len() * k / 20] ^= 0x10;
        check("flipped.mcap", &flipped);
    }
    check("empty.mcap", b"");
    check("other.mcap", b"no recording at all");
    assert!(recovered > 15 && refused > 2 && skipped > 2, "{recovered} {refused} {skipped}");
}

#[test]
fn nothing_is_overwritten_unasked() {
    let folder = Folder::new();
    let (path, bytes) = whole(&folder);
    let partial = folder.write("whole.mcap.partial", &bytes[..bytes.len() * 3 / 4]);
    run(&["recover", &partial]).assert_refused(2, &["whole.mcap", "--out"]);
    run(&["recover", &path]).assert_refused(2, &[".partial", "--out"]);
    run(&["recover", &path, "--out", &path]).assert_refused(2, &["the file that is read"]);
    run(&["recover", "missing.mcap.partial"]).assert_refused(2, &["missing.mcap.partial"]);
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    let other = argument(&folder.path("other.mcap"));
    let outcome = run(&["recover", &partial, "--out", &other]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    for words in ["recovered", "other.mcap", "frames, steps 0 to", "unchanged"] {
        assert!(outcome.stdout.contains(words), "{outcome:?}");
    }
    assert!(!folder.path("other.mcap.recovering").exists());
}
