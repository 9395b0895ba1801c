//! A step of whole scenes under our detector, beside rapier's own, and how fast scenes run.
//!
//! `cranny compare` and `cranny run` do the work, one process a scene: all detectors of a scene
//! take their steps in turn.

use std::io;
use std::path::Path;
use std::process::Command;

use clap::Args;
use serde_json::Value;

use crate::progress;
use crate::report::{Cell, Report, Table, geometric_mean};

/// The scenes of the scoreboard.
const SCENES: [&str; 10] = [
    "ring_of_tori",
    "stack_of_cups",
    "hook_on_ring",
    "key_in_lock",
    "gears",
    "peg_in_hole",
    "mixed_pile_50",
    "l_on_slab",
    "wheel_on_stairs",
    "ball_on_floor",
];

/// Simulated seconds of a scene, without and with `--quick`.
const SECONDS: f64 = 1.0;
const QUICK_SECONDS: f64 = 0.25;

/// Detectors that ours is compared with.
const PEERS: [&str; 2] = ["rapier-trimesh-fixed", "rapier-decomposition"];

/// The scenes to measure, and how.
#[derive(Clone, Debug, Args)]
pub(crate) struct ScenesArgs {
    /// Scenes of `assets/scenes`, without their ending [default: the scoreboard's ten]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,

    /// Simulated seconds [default: 1, with --quick 0.25]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
}

/// Measures the scenes.
///
/// # Errors
///
/// No `cranny` beside this program; a scene that it does not run.
pub(crate) fn measure(quick: bool, args: &ScenesArgs) -> io::Result<Report> {
    let seconds = args.seconds.unwrap_or(if quick { QUICK_SECONDS } else { SECONDS });
    let named: Vec<&str> = args.scenes.iter().map(|name| &**name).collect();
    let scenes = if named.is_empty() { &SCENES[..] } else { &named };
    let mut rows = Vec::new();
    let mut ratios = [Vec::new(), Vec::new()];
    for scene in scenes {
        progress(scene);
        let compared = cranny("compare", scene, seconds)?;
        let run = cranny("run", scene, seconds)?;
        let row = SceneRow::read(scene, &compared, run.last())
            .ok_or_else(|| io::Error::other(format!("{scene}: `cranny` prints no such figures")))?;
        for (ratios, peer) in ratios.iter_mut().zip(&row.beside) {
            ratios.push(*peer);
        }
        rows.push(row.cells());
    }
    let mean = |ratios: &Vec<f64>| Cell::Ratio(geometric_mean(ratios));
    let mut means = vec![Cell::Text("geometric mean".into())];
    means.extend(ratios.iter().map(mean));
    means.resize(COLUMNS.len(), Cell::Absent);
    rows.push(means);
    Ok(Report {
        title: "Scenes",
        notes: vec![
            format!("{seconds} s each; our step in multiples of rapier's with trimesh-fixed and with its decomposition; less is better"),
            "contacts: ours in multiples of the decomposition's; deepest: units; real time: of `cranny run`; report: share of its time".into(),
        ],
        tables: vec![Table { title: "A step", columns: COLUMNS.to_vec(), rows }],
    })
}

const COLUMNS: [&str; 8] = [
    "scene",
    "of trimesh-fixed",
    "of decomposition",
    "contacts",
    "deepest",
    "decomposition's",
    "real time",
    "report",
];

struct SceneRow {
    scene: String,
    /// Our mean step in multiples of each peer's.
    beside: [f64; 2],
    contacts: f64,
    deepest: [f64; 2],
    real_time: f64,
    /// Share of a run's time that its reports take.
    report: f64,
}

impl SceneRow {
    /// Returns `None` if a figure is missing.
    fn read(scene: &str, compared: &[Value], run: Option<&Value>) -> Option<Self> {
        let of = |name: &str| compared.iter().find(|row| row["detector"] == name);
        let step = |row: &Value| row["step_ms"]["mean"].as_f64();
        let deepest = |row: &Value| row["deepest"]["depth"].as_f64().unwrap_or(0.0);
        let own = of("cranny")?;
        let [fixed, pieces] = PEERS.map(of);
        let (fixed, pieces) = (fixed?, pieces?);
        let run = run?;
        let contacts = |row: &Value| row["contacts"]["mean"].as_f64();
        Some(Self {
            scene: scene.into(),
            beside: [step(own)? / step(fixed)?, step(own)? / step(pieces)?],
            contacts: contacts(own)? / contacts(pieces)?,
            deepest: [deepest(own), deepest(pieces)],
            real_time: run["real_time_factor"].as_f64()?,
            report: run["time_ms"]["report"].as_f64()? / (1e3 * run["wall_s"].as_f64()?),
        })
    }

    fn cells(&self) -> Vec<Cell> {
        let mut cells = vec![Cell::Text(self.scene.clone())];
        cells.extend(self.beside.map(Cell::Ratio));
        cells.push(Cell::Ratio(self.contacts));
        cells.extend(self.deepest.map(|depth| Cell::Text(format!("{depth:.5}"))));
        cells.push(Cell::Ratio(self.real_time));
        cells.push(Cell::Text(format!("{:.0} %", 100.0 * self.report)));
        cells
    }
}

/// Returns the rows that `cranny` prints about a scene.
fn cranny(command: &str, scene: &str, seconds: f64) -> io::Result<Vec<Value>> {
    let program = std::env::current_exe()?.with_file_name("cranny");
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/scenes")
        .join(format!("{scene}.ron"));
    let output = Command::new(&program)
        .arg(command)
        .arg(file)
        .args(["--duration", &seconds.to_string(), "--format", "json"])
        .output()
        .map_err(|error| {
            io::Error::other(format!(
                "{}: {error}; `cargo build --release -p cranny-cli` makes it",
                program.display()
            ))
        })?;
    if !output.status.success() {
        let why = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(io::Error::other(format!("{scene}: {why}")));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn steps_are_read_as_ratios_and_missing_figures_are_noticed() {
        let row = |detector: &str, step: f64, contacts: f64| {
            json!({
                "detector": detector,
                "step_ms": { "mean": step },
                "contacts": { "mean": contacts },
                "deepest": null,
            })
        };
        let compared = [row("cranny", 3.0, 8.0), row(PEERS[0], 2.0, 4.0), row(PEERS[1], 1.0, 4.0)];
        let run = json!({ "real_time_factor": 2.0, "wall_s": 0.5, "time_ms": { "report": 250.0 } });
        let read = SceneRow::read("gate", &compared, Some(&run)).unwrap();
        assert_eq!((read.beside, read.contacts, read.report), ([1.5, 3.0], 2.0, 0.5));
        assert_eq!(read.cells().len(), COLUMNS.len());
        assert!(SceneRow::read("gate", &compared[..2], Some(&run)).is_none());
        assert!(SceneRow::read("gate", &compared, None).is_none());
    }
}
