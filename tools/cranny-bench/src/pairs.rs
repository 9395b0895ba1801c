//! Pairs of meshes in slow motion: warm, cold, and parry on the same poses in the same run.
//!
//! A frame is a pose of the second body; each body of a pair is asked frame after frame, once with
//! memory, once without. Means are of the thread's CPU time over whole runs; the spread of single
//! frames is taken from the wall clock (reading the CPU clock costs as much as a query), each frame
//! at its best of some runs, since a spike that does not come back is the machine's.

pub(crate) mod coal;
pub(crate) mod methods;
mod scenes;
pub(crate) mod sorting;

use std::time::{Duration, Instant};

use cranny_exact::Pose;
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use parry3d::math::{Pose as NarrowPose, Rotation, Vector};
use parry3d::query::{self as parry, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d::shape::TriMesh;

use self::scenes::{Scene, scenes};
use crate::hulls::single;
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Patience, keep, median, race};

/// Runs of which each frame's best is taken.
const REPEATS: usize = 3;

/// What parry's manifolds are asked to foresee beside our regions: next to nothing, as our segments do. Beside
/// contacts it is their margin.
const PREDICTION: f32 = 1e-4;

/// Seconds that one run of a peer over its frames may take; it gets fewer frames, evenly spread, if
/// it is slower.
const PEER_RUN: f64 = 0.5;

/// Measures the scenes whose name contains `only`.
pub(crate) fn measure(quick: bool, only: &str) -> Report {
    let mut rows = Vec::new();
    for scene in scenes(quick, only) {
        rows.extend(scene_rows(&scene, quick));
    }
    Report {
        title: "Pairs in motion",
        notes: vec![
            "degrees a frame as the name says (0.1 unless it says so); near: a gap of about a fiftieth of the size; contact: as much overlap".into(),
            "cranny: f64, exact; warm: memory kept, cold: none; parry: `intersection_test`, `distance`, `contact_manifolds`, f32".into(),
            "mean of thread CPU time over all frames; spread: p99 / median of single frames; ratio = parry / warm".into(),
        ],
        tables: vec![Table {
            title: "A frame",
            columns: vec![
                "pair", "asked", "warm", "spread", "cold", "cold / warm", "parry", "parry / warm",
                "KiB", "nodes", "triangles",
            ],
            rows,
        }],
    }
}

/// The bodies of the scene of that name, and the second's poses.
pub(crate) fn models(name: &str) -> Option<([Model; 2], Vec<Pose>)> {
    let scene = scenes(true, name).into_iter().find(|scene| scene.name == name)?;
    let Bodies { models, .. } = Bodies::of(&scene.meshes)?;
    Some((models, scene.poses))
}

/// Both bodies as we and parry have them.
struct Bodies {
    models: [Model; 2],
    meshes: [TriMesh; 2],
}

impl Bodies {
    fn of(meshes: &[Mesh; 2]) -> Option<Self> {
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        let [a, b] = meshes.each_ref().map(|m| Model::build(m.clone(), &options).ok());
        let [p, q] =
            meshes.each_ref().map(|m| TriMesh::new(single(m.vertices()), m.faces().to_vec()).ok());
        Some(Self { models: [a?.0, b?.0], meshes: [p?, q?] })
    }
}

fn scene_rows(scene: &Scene, quick: bool) -> Vec<Vec<Cell>> {
    let Some(bodies) = Bodies::of(&scene.meshes) else { return Vec::new() };
    scene.demands.iter().map(|&demand| row(scene, &bodies, demand, quick)).collect()
}

fn row(scene: &Scene, bodies: &Bodies, demand: Demand, quick: bool) -> Vec<Cell> {
    let poses = &scene.poses;
    let question = Query::of(demand);
    let place = |pose: Pose| {
        let [a, b] = &bodies.models;
        [Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose }]
    };
    let ask = |pose: Pose, memory: &mut PairMemory| {
        let [a, b] = place(pose);
        query(a, b, &question, memory).ok()
    };
    let narrow: Vec<NarrowPose> = poses.iter().map(single_pose).collect();
    let stride = peer_stride(bodies, demand, &narrow);
    let mut memory = PairMemory::default();
    let [warm, cold, peer] = race(
        Patience { least: 2, ..Patience::of(quick) },
        [
            &mut || {
                memory.clear();
                poses.iter().for_each(|&pose| keep(ask(pose, &mut memory)));
            },
            &mut || poses.iter().for_each(|&pose| keep(ask(pose, &mut PairMemory::default()))),
            &mut || narrow.iter().step_by(stride).for_each(|pose| ask_peer(bodies, demand, pose)),
        ],
    );
    let [warm, cold] = [warm, cold].map(|seconds| seconds / poses.len() as f64);
    let peer = peer / narrow.iter().step_by(stride).count() as f64;
    let mut work = [0u64; 2];
    memory.clear();
    for &pose in poses {
        if let Some(answer) = ask(pose, &mut memory) {
            work[0] += answer.counters.node_tests;
            work[1] += answer.counters.triangle_tests;
        }
    }
    let [nodes, triangles] = work.map(|n| Cell::Count((n / poses.len() as u64) as usize));
    vec![
        Cell::Text(scene.name.clone()),
        Cell::Text(name_of(demand).into()),
        Cell::Micros(warm * 1e6),
        Cell::Ratio(spread(poses, |pose, memory| keep(ask(pose, memory)))),
        Cell::Micros(cold * 1e6),
        Cell::Ratio(cold / warm),
        Cell::Micros(peer * 1e6),
        Cell::Ratio(peer / warm),
        Cell::Count(memory.bytes() / 1024),
        nodes,
        triangles,
    ]
}

/// 99th percentile over median of warm frames, the first left out.
fn spread(poses: &[Pose], mut ask: impl FnMut(Pose, &mut PairMemory)) -> f64 {
    let mut best = vec![Duration::MAX; poses.len()];
    for _ in 0..REPEATS {
        let mut memory = PairMemory::default();
        for (&pose, best) in poses.iter().zip(&mut best) {
            let start = Instant::now();
            ask(pose, &mut memory);
            *best = start.elapsed().min(*best);
        }
    }
    let mut frames: Vec<f64> = best[1..].iter().map(Duration::as_secs_f64).collect();
    frames.sort_unstable_by(f64::total_cmp);
    let high = frames[(frames.len() * 99 / 100).min(frames.len() - 1)];
    high / median(frames)
}

fn name_of(demand: Demand) -> &'static str {
    match demand {
        Demand::None => "nothing",
        Demand::Intersects => "intersects",
        Demand::Distance { .. } => "distance",
        Demand::Contacts { .. } => "contacts",
        Demand::Regions { .. } => "regions",
    }
}

/// Every how many frames the peer is asked, so that a run ends in time.
fn peer_stride(bodies: &Bodies, demand: Demand, poses: &[NarrowPose]) -> usize {
    let start = Instant::now();
    poses.iter().take(2).for_each(|pose| ask_peer(bodies, demand, pose));
    let run = start.elapsed().as_secs_f64() * 0.5 * poses.len() as f64;
    ((run / PEER_RUN).ceil() as usize).clamp(1, poses.len())
}

fn ask_peer(bodies: &Bodies, demand: Demand, pose: &NarrowPose) {
    let here = NarrowPose::IDENTITY;
    let [a, b] = &bodies.meshes;
    match demand {
        Demand::None => {}
        Demand::Intersects => keep(parry::intersection_test(&here, a, pose, b).is_ok()),
        Demand::Distance { .. } => keep(parry::distance(&here, a, pose, b).is_ok()),
        Demand::Contacts { .. } | Demand::Regions { .. } => {
            let margin = demand.margin().filter(|&margin| margin > 0.0);
            let mut manifolds: Vec<parry::ContactManifold<(), ()>> = Vec::new();
            let done = DefaultQueryDispatcher.contact_manifolds(
                pose,
                a,
                b,
                margin.map_or(PREDICTION, |margin| margin as f32),
                &mut manifolds,
                &mut None,
            );
            keep((done.is_ok(), manifolds));
        }
    }
}

fn single_pose(pose: &Pose) -> NarrowPose {
    let (t, r) = (pose.translation, pose.rotation);
    NarrowPose::from_parts(
        Vector::new(t.x as f32, t.y as f32, t.z as f32),
        Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32),
    )
}
