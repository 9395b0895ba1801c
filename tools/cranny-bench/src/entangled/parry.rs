//! parry as a contestant: triangle meshes, or their convex decompositions at its defaults.

use std::io;

use cranny_exact::Pose;
use cranny_rapier::Detector;
use parry3d::math::{Pose as NarrowPose, Rotation, Vector};
use parry3d::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
    QueryDispatcher, Unsupported,
};
use parry3d::shape::{Shape, SharedShape};

use super::demand::DemandKind;
use super::stage::Stage;
use crate::turns::{Contestant, Stopwatch};

/// Prediction of manifolds where regions have no margin: next to nothing, as the regions' curves.
const PREDICTION: f32 = 1e-4;

/// Shapes of a stage's meshes, in the order of its models.
pub(super) struct Shapes(Vec<SharedShape>);

impl Shapes {
    /// `None` where parry refuses a mesh or fails to decompose it.
    pub(super) fn new(stage: &Stage, detector: Detector) -> Option<Self> {
        let shapes = stage.models.iter().map(|model| detector.shape(model, 0).ok());
        shapes.collect::<Option<Vec<_>>>().map(Self)
    }
}

/// parry's state of a pair from frame to frame.
#[derive(Default)]
struct Memory {
    manifolds: Vec<ContactManifold<(), ()>>,
    workspace: Option<ContactManifoldsWorkspace>,
}

pub(super) struct Parry<'a> {
    stage: &'a Stage,
    shapes: &'a Shapes,
    kind: DemandKind,
    stopwatch: Stopwatch,
    /// One a pair.
    memories: Vec<Memory>,
    /// One a frame that was run with `Verdict`: whether the shapes meet, pair by pair.
    pub(super) meets: Vec<Option<Vec<bool>>>,
}

impl<'a> Parry<'a> {
    pub(super) fn new(stage: &'a Stage, shapes: &'a Shapes, kind: DemandKind) -> Self {
        let memories = stage.motion.pairs.iter().map(|_| Memory::default()).collect();
        let meets = vec![None; stage.len()];
        Self { stage, shapes, kind, stopwatch: Stopwatch::new(), memories, meets }
    }

    fn frame(&mut self, frame: usize) -> io::Result<f64> {
        let Self { stage, shapes, kind, stopwatch, memories, meets } = self;
        let near = &stage.near[frame];
        let poses: Vec<NarrowPose> =
            near.iter().map(|&pair| narrow(&stage.a_from_b(frame, pair))).collect();
        let margin = match kind {
            DemandKind::Regions => (stage.motion.region_margin as f32).max(PREDICTION),
            _ => stage.motion.contact_margin as f32,
        };
        let (seconds, answers) = stopwatch.seconds(|| {
            let answers = near.iter().zip(&poses).map(|(&pair, pose)| {
                let shapes = stage.mesh_indices(pair).map(|mesh| &*shapes.0[mesh]);
                answer(*kind, pose, shapes, margin, &mut memories[pair])
            });
            answers.collect::<Result<Vec<bool>, _>>()
        });
        let answers = answers.map_err(|_| io::Error::other("not supported by parry"))?;
        if *kind == DemandKind::Verdict {
            meets[frame] = Some(answers);
        }
        Ok(seconds)
    }
}

/// Returns whether the shapes meet, as far as the query finds out.
fn answer(
    kind: DemandKind,
    a_from_b: &NarrowPose,
    [a, b]: [&dyn Shape; 2],
    margin: f32,
    memory: &mut Memory,
) -> Result<bool, Unsupported> {
    let dispatcher = DefaultQueryDispatcher;
    match kind {
        DemandKind::Verdict => {
            dispatcher.intersection_test(a_from_b, a, b).map(|found| found.intersecting)
        }
        DemandKind::Distance => {
            dispatcher.distance(a_from_b, a, b).map(|found| found.distance <= 0.0)
        }
        DemandKind::Contacts | DemandKind::Regions => {
            let Memory { manifolds, workspace } = memory;
            dispatcher.contact_manifolds(a_from_b, a, b, margin, manifolds, workspace)?;
            Ok(!manifolds.is_empty())
        }
    }
}

impl Contestant for Parry<'_> {
    fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>> {
        self.memories.iter_mut().for_each(|memory| *memory = Memory::default());
        let keeps = matches!(self.kind, DemandKind::Contacts | DemandKind::Regions);
        let mut seconds = Vec::with_capacity(frames.len());
        let mut last = None;
        for &frame in frames {
            // In a simulation, manifolds of the previous frame are there.
            if keeps && frame > 0 && last != Some(frame - 1) {
                self.frame(frame - 1)?;
            }
            seconds.push(self.frame(frame)?);
            last = Some(frame);
        }
        Ok(seconds)
    }
}

fn narrow(pose: &Pose) -> NarrowPose {
    let (t, r) = (pose.translation, pose.rotation);
    NarrowPose::from_parts(
        Vector::new(t.x as f32, t.y as f32, t.z as f32),
        Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32),
    )
}
