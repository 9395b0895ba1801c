//! Coal as a contestant, where its Python wheel is found (`pip install coal`).
//!
//! It runs in a process of its own: a turn is a line of JSON each way.

use std::io;

use cranny_geometry::Mesh;
use serde_json::{Value, json};

use super::demand::DemandKind;
use super::stage::Stage;
use crate::python::Python;
use crate::turns::Contestant;

/// The process that calls Coal.
const SCRIPT: &str = include_str!("coal.py");

/// A process with the meshes and poses of a stage.
pub(super) struct Coal(Python);

impl Coal {
    /// Returns whether the interpreter has Coal.
    pub(super) fn is_found() -> bool {
        Python::has("coal")
    }

    /// # Errors
    ///
    /// An interpreter that does not start.
    pub(super) fn start(stage: &Stage) -> io::Result<Self> {
        Python::start(SCRIPT, &given(stage)).map(Self)
    }
}

/// Coal's turns with one demand.
pub(super) struct CoalTurns<'a> {
    pub(super) coal: &'a mut Coal,
    pub(super) kind: DemandKind,
    pub(super) margin: f64,
    /// One a frame that was run: a truth value or a number for each pair.
    pub(super) answers: Vec<Option<Vec<Value>>>,
}

impl Contestant for CoalTurns<'_> {
    fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>> {
        let what = match self.kind {
            DemandKind::Verdict => "verdict",
            DemandKind::Distance => "distance",
            DemandKind::Contacts | DemandKind::Regions => "contacts",
        };
        let turn = json!({ "what": what, "margin": self.margin, "frames": frames });
        let mut reply = self.coal.0.ask(&turn)?;
        if let Value::Array(answers) = reply["answers"].take() {
            for (&frame, answer) in frames.iter().zip(answers) {
                self.answers[frame] = answer.as_array().cloned();
            }
        }
        let seconds: Option<Vec<f64>> =
            reply["seconds"].as_array().map(|all| all.iter().filter_map(Value::as_f64).collect());
        seconds
            .filter(|seconds| seconds.len() == frames.len())
            .ok_or_else(|| io::Error::other("Coal's process returns another number of frames"))
    }
}

fn given(stage: &Stage) -> Value {
    let mesh = |mesh: &Mesh| {
        let vertices: Vec<[f64; 3]> = mesh.vertices().iter().map(|p| p.to_array()).collect();
        json!({ "vertices": vertices, "faces": mesh.faces() })
    };
    let pair = |frame: usize, pair: usize| {
        let pose = stage.a_from_b(frame, pair).to_row_major();
        json!({ "meshes": stage.mesh_indices(pair), "pose": pose })
    };
    let frame =
        |frame: usize| stage.near[frame].iter().map(|&p| pair(frame, p)).collect::<Vec<_>>();
    json!({
        "meshes": stage.motion.meshes.iter().map(mesh).collect::<Vec<_>>(),
        "frames": (0..stage.len()).map(frame).collect::<Vec<_>>(),
    })
}
