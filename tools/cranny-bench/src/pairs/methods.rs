//! The two ways to the faces that meet, on bodies that are in each other's pockets.

use std::f64::consts::TAU;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Counters, Demand, Method, PairMemory, Placed, Query, query};
use cranny_shapes::{Cup, Cylinder, IsoNut, Sphere};

use super::scenes::{Built, nut_on_bolt};
use super::{name_of, prepared};
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Repeats, keep, race};

/// Measures both methods on the same poses, in turns.
pub(crate) fn measure(quick: bool) -> Report {
    let frames = if quick { 100 } else { 400 };
    let scenes: [(&str, Built); 5] = [
        ("ball in cup, off its walls", ball_in_cup(0.45, frames)),
        ("ball in cup, through its wall", ball_in_cup(0.6, frames)),
        ("peg in hole, off its walls", peg_in_hole(6.5, frames)),
        ("peg in hole, through its wall", peg_in_hole(7.2, frames)),
        ("nut on bolt", nut_on_bolt(0.1, frames.min(200))),
    ];
    let demands = [Demand::Intersects, Demand::Regions { margin: 0.0 }];
    let mut rows = Vec::new();
    for (name, built) in scenes {
        let Some((models, poses)) =
            built.ok().and_then(|(meshes, poses)| Some((prepared(&meshes)?, poses)))
        else {
            continue;
        };
        rows.extend(demands.map(|demand| row(name, &models, &poses, demand, quick)));
    }
    Report {
        title: "Boxes and envelopes",
        notes: vec![
            "mean of thread CPU time over all frames with memory, both methods in turns".into(),
            "nodes: pairs of box-tree nodes compared, a frame; facets: of envelopes, held against a box".into(),
        ],
        tables: vec![Table {
            title: "A frame",
            columns: vec![
                "pair", "asked", "boxes", "envelopes", "boxes / envelopes", "nodes", "triangles",
                "facets", "nodes", "triangles", "opened",
            ],
            rows,
        }],
    }
}

fn row(name: &str, models: &[Model; 2], poses: &[Pose], demand: Demand, quick: bool) -> Vec<Cell> {
    let [a, b] = models;
    let run = |method: Method| -> Counters {
        let (question, mut memory) = (Query::of(demand).by(method), PairMemory::default());
        let mut all = Counters::default();
        for &pose in poses {
            let a = Placed { model: a, pose: Pose::IDENTITY };
            if let Ok(answer) = query(a, Placed { model: b, pose }, &question, &mut memory) {
                all += answer.counters;
                keep(answer);
            }
        }
        all
    };
    let [boxes, envelopes] = race(
        Repeats { least: 2, ..Repeats::of(quick) },
        [&mut || keep(run(Method::Boxes)), &mut || keep(run(Method::Envelopes))],
    );
    let frames = poses.len() as f64;
    let [by_boxes, by_envelopes] = [Method::Boxes, Method::Envelopes].map(run);
    let mean = |count: u64| Cell::Count((count / poses.len() as u64) as usize);
    vec![
        Cell::Text(name.into()),
        Cell::Text(name_of(demand).into()),
        Cell::Micros(boxes / frames * 1e6),
        Cell::Micros(envelopes / frames * 1e6),
        Cell::Ratio(boxes / envelopes),
        mean(by_boxes.node_tests),
        mean(by_boxes.triangle_tests),
        mean(by_envelopes.facets_compared),
        mean(by_envelopes.node_tests),
        mean(by_envelopes.triangle_tests),
        mean(by_envelopes.pockets_opened),
    ]
}

/// A ball that goes around in a cup of inner radius 0.9, so far from its axis, turning as it goes.
fn ball_in_cup(away: f64, frames: usize) -> Built {
    let cup = Cup { radius: 1.0, height: 2.0, wall: 0.1, floor: 0.1, segments: 96 };
    let ball = Sphere { radius: 0.4, segments: 48, rings: 24 };
    let pose = |frame: usize| {
        let angle = 0.1_f64.to_radians() * frame as f64;
        Pose {
            rotation: DQuat::from_axis_angle(DVec3::ONE.normalize(), 2.0 * angle),
            translation: DVec3::new(away * angle.cos(), away * angle.sin(), 1.0),
        }
    };
    Ok(([cup.build()?, ball.build()?], (0..frames).map(pose).collect()))
}

/// A peg of that radius that is turned and pushed through a threaded hole 13.8 wide.
fn peg_in_hole(radius: f64, frames: usize) -> Built {
    let peg = Cylinder { radius, height: 30.0, segments: 96, ..Cylinder::default() };
    let pose = |frame: usize| {
        let turn = 0.1 / 360.0 * TAU * frame as f64;
        Pose {
            rotation: DQuat::from_axis_angle(DVec3::Z, turn),
            translation: DVec3::new(0.1, 0.0, 0.01 * frame as f64),
        }
    };
    Ok(([IsoNut::default().build()?, peg.build()?], (0..frames).map(pose).collect()))
}
