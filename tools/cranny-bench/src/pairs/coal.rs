//! The same pairs beside Coal, where its Python wheel is found (`pip install coal`).
//!
//! Coal runs in a process of its own, asked from Python, between two runs of ours; what the call takes is subtracted.

use std::io::{self, Write};
use std::process::{Command, Stdio};

use cranny_exact::Pose;
use cranny_geometry::Mesh;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use serde_json::{Value, json};

use super::scenes::{Scene, scenes};
use super::{Bodies, PEER_RUN, name_of};
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Patience, keep, race};

/// What asks Coal.
const SCRIPT: &str = include_str!("coal.py");

/// Names the interpreter that has Coal; `python3` unless set.
const PYTHON: &str = "CRANNY_PYTHON";

/// Measures the scenes whose name contains `only`.
///
/// # Errors
///
/// No interpreter, or one without Coal.
pub(crate) fn measure(quick: bool, only: &str) -> io::Result<Report> {
    let mut rows = Vec::new();
    for scene in scenes(quick, only) {
        rows.extend(scene_rows(&scene, quick)?);
    }
    Ok(Report {
        title: "Pairs in motion, beside Coal",
        notes: vec![
            "cranny: f64, memory kept; mean of thread CPU time over all frames, before and after Coal's".into(),
            "coal: f64, BVHModelOBBRSS, its call from Python subtracted; regions: all contacts; contacts: all within the margin".into(),
            "ratio = coal / cranny".into(),
        ],
        tables: vec![Table {
            title: "A frame",
            columns: vec!["pair", "asked", "cranny", "coal", "coal / cranny"],
            rows,
        }],
    })
}

fn scene_rows(scene: &Scene, quick: bool) -> io::Result<Vec<Vec<Cell>>> {
    let Some(bodies) = Bodies::of(&scene.meshes) else { return Ok(Vec::new()) };
    let before: Vec<f64> = scene.demands.iter().map(|d| ours(scene, &bodies, *d, quick)).collect();
    let theirs = ask(scene)?;
    let after = scene.demands.iter().map(|d| ours(scene, &bodies, *d, quick));
    let rows = scene.demands.iter().zip(before).zip(after).zip(theirs);
    Ok(rows
        .map(|(((&demand, before), after), coal)| {
            let ours = 0.5 * (before + after);
            vec![
                Cell::Text(scene.name.clone()),
                Cell::Text(name_of(demand).into()),
                Cell::Micros(ours * 1e6),
                Cell::Micros(coal * 1e6),
                Cell::Ratio(coal / ours),
            ]
        })
        .collect())
}

/// Seconds a frame, with memory.
fn ours(scene: &Scene, bodies: &Bodies, demand: Demand, quick: bool) -> f64 {
    let question = Query::of(demand);
    let [a, b] = &bodies.models;
    let [run] = race(
        Patience { least: 2, ..Patience::of(quick) },
        [&mut || {
            let mut memory = PairMemory::default();
            for &pose in &scene.poses {
                let there = Placed { model: b, pose };
                let here = Placed { model: a, pose: Pose::IDENTITY };
                keep(query(here, there, &question, &mut memory));
            }
        }],
    );
    run / scene.poses.len() as f64
}

/// Seconds a frame of each question.
fn ask(scene: &Scene) -> io::Result<Vec<f64>> {
    let python = std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into());
    let refused = |why: String| {
        io::Error::other(format!(
            "{} does not answer with Coal: {why}\n  `pip install coal`, and name the interpreter in {PYTHON}",
            python.display()
        ))
    };
    let mut child = Command::new(&python)
        .args(["-c", SCRIPT])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| refused(error.to_string()))?;
    if let Some(mut stdin) = child.stdin.take() {
        // Whoever ends before it has read all says why on its standard error.
        let _ = stdin.write_all(given(scene).to_string().as_bytes());
    }
    let output = child.wait_with_output()?;
    let told: Vec<f64> = String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| line.parse().ok())
        .collect();
    if !output.status.success() || told.len() != scene.demands.len() {
        let why = String::from_utf8_lossy(&output.stderr);
        return Err(refused(
            why.lines()
                .rfind(|line| !line.starts_with(' '))
                .unwrap_or("it says nothing")
                .to_owned(),
        ));
    }
    Ok(told)
}

fn given(scene: &Scene) -> Value {
    let mesh = |mesh: &Mesh| {
        let vertices: Vec<[f64; 3]> = mesh.vertices().iter().map(|p| p.to_array()).collect();
        json!({ "vertices": vertices, "faces": mesh.faces() })
    };
    let poses: Vec<_> = scene.poses.iter().map(Pose::to_row_major).collect();
    let asked = scene.demands.iter().map(|demand| {
        let what = match demand {
            Demand::Regions { .. } | Demand::Contacts { .. } => "contacts",
            Demand::Distance { .. } => "distance",
            _ => "intersects",
        };
        json!({ "what": what, "margin": demand.margin().unwrap_or(0.0) })
    });
    json!({
        "meshes": scene.meshes.each_ref().map(mesh),
        "poses": poses,
        "asked": asked.collect::<Vec<_>>(),
        "seconds": PEER_RUN,
    })
}
