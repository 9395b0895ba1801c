//! Sorting level by level, beside the kept front and beside a descent from the top.
//!
//! The proposal's other method: the boxes of each level of both trees that are of interest stay
//! sorted along the axes from frame to frame, and what passes what decides which overlap. It is
//! measured at what it does, the search for all pairs of faces that meet; it is no part of the
//! narrow phase.

mod axis;
mod descent;
mod level;
mod levels;

use cranny_exact::{Meeting, Pose, RigidMap, classify_triangles};
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};

use self::descent::pairs_of_leaves;
use self::level::{LevelWork, NodePair};
use self::levels::Levels;
use super::prepared;
use super::scenes::{Built, golf_balls, nut_on_bolt, tori};
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Repeats, keep, race};

/// Measures the three on the same poses, in turns.
pub(crate) fn measure(quick: bool) -> Report {
    let frames = if quick { 60 } else { 300 };
    let mut scenes: Vec<(String, Built)> = Vec::new();
    let sizes: &[u32] = if quick { &[1_000] } else { &[1_000, 10_000] };
    for degrees in [0.01, 0.1, 1.0] {
        for &size in sizes {
            for (what, gap) in [("near", 0.03), ("contact", -0.02)] {
                let named = |shape| format!("{shape} {}k {what}, {degrees} degrees", size / 1_000);
                scenes.push((named("golf"), golf_balls(size, gap, degrees, frames)));
                scenes.push((named("torus"), tori(size, gap, degrees, frames)));
            }
        }
        let few = if quick { 5 } else { 60 };
        scenes.push((format!("nut on bolt, {degrees} degrees"), nut_on_bolt(degrees, few)));
    }
    let rows = scenes.into_iter().filter_map(|(name, built)| {
        let (meshes, poses) = built.ok()?;
        Some(row(&name, &prepared(&meshes)?, &poses, quick))
    });
    Report {
        title: "Sorting level by level",
        notes: vec![
            "all pairs of faces that meet; mean of thread CPU time over all frames, the three in turns".into(),
            "sorting: boxes of each level sorted along three axes, kept; tests: pairs of boxes compared; active: boxes held, on all levels".into(),
            "descent: the same boxes from the top, nothing kept; front: the narrow phase's with memory, its time that of the whole query (in contact: \
             `regions`, which are made of the pairs; elsewhere `intersects`)".into(),
        ],
        tables: vec![Table {
            title: "A frame",
            columns: vec![
                "pair", "meet", "sorting", "swaps", "active", "tests", "KiB", "descent", "tests", "front", "tests",
                "KiB", "sorting / descent", "sorting / front",
            ],
            rows: rows.collect(),
        }],
    }
}

fn row(name: &str, models: &[Model; 2], poses: &[Pose], quick: bool) -> Vec<Cell> {
    let [a, b] = models;
    // Where nothing meets, that is the same search.
    let meets = name.contains("contact");
    let demand = if meets { Demand::Regions { margin: 0.0 } } else { Demand::Intersects };
    let question = Query::of(demand);
    let trees = [a.tree(), b.tree()];
    let mut levels = Levels::of(trees);
    let mut memory = PairMemory::default();
    let sort = |levels: &mut Levels| {
        let mut all = (0, LevelWork::default());
        for pose in poses {
            let map = pose.world_from_body();
            let (leaves, work) = levels.update(&map);
            all.0 += meetings([a, b], &map, &leaves).len() as u64;
            all.1 += work;
        }
        all
    };
    let descend = || {
        let mut tests = 0;
        for pose in poses {
            let map = pose.world_from_body();
            let (leaves, compared) = pairs_of_leaves(trees, &map);
            keep(meetings([a, b], &map, &leaves));
            tests += compared;
        }
        tests
    };
    let ask = |memory: &mut PairMemory| {
        let mut tests = 0;
        for &pose in poses {
            let a = Placed { model: a, pose: Pose::IDENTITY };
            if let Ok(answer) = query(a, Placed { model: b, pose }, &question, memory) {
                tests += answer.counters.node_tests + answer.counters.front_tested;
                keep(answer);
            }
        }
        tests
    };
    // Counted over frames that follow one that was sorted.
    keep(sort(&mut levels));
    let (meet, work) = sort(&mut levels);
    keep(ask(&mut memory));
    let (compared, tested) = (descend(), ask(&mut memory));
    let [by_sorting, by_descent, by_front] = race(
        Repeats { least: 2, ..Repeats::of(quick) },
        [&mut || keep(sort(&mut levels)), &mut || keep(descend()), &mut || keep(ask(&mut memory))],
    )
    .map(|seconds| seconds / poses.len() as f64);
    let mean = |n: u64| Cell::Count((n / poses.len() as u64) as usize);
    vec![
        Cell::Text(name.into()),
        mean(meet),
        Cell::Micros(by_sorting * 1e6),
        mean(work.swaps),
        mean(work.active),
        mean(work.tests),
        Cell::Count(levels.bytes() / 1024),
        Cell::Micros(by_descent * 1e6),
        mean(compared),
        Cell::Micros(by_front * 1e6),
        mean(tested),
        Cell::Count(memory.bytes() / 1024),
        Cell::Ratio(by_sorting / by_descent),
        Cell::Ratio(by_sorting / by_front),
    ]
}

/// Which faces beneath pairs of leaves meet, the second posed by `map`; in no order.
fn meetings(models: [&Model; 2], map: &RigidMap, leaves: &[NodePair]) -> Vec<[FaceId; 2]> {
    let [first, second] = models;
    let mut found = Vec::new();
    for &[a, b] in leaves {
        for &g in second.tree().leaf_faces(b) {
            let posed = second.mesh().triangle(g).map(|p| map.linear * p + map.translation);
            for &f in first.tree().leaf_faces(a) {
                if classify_triangles(&first.mesh().triangle(f), &posed) != Meeting::None {
                    found.push([f, g]);
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, DVec3};
    use cranny_geometry::BuildOptions;
    use cranny_shapes::Torus;

    /// Slow motion, a stop, a jump away and back.
    fn poses() -> Vec<Pose> {
        let pose = |turn: f64, x: f64| Pose {
            rotation: DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), turn),
            translation: DVec3::new(x, 0.25, 0.1),
        };
        let slow = (0..40).map(|i| pose(0.01 * f64::from(i), 0.3 + 0.01 * f64::from(i)));
        let rest = std::iter::repeat_n(pose(0.4, 0.7), 3);
        let jumps = [pose(2.0, 0.1), pose(1.0, 9.0), pose(0.3, 0.6), pose(0.31, 0.6)];
        slow.chain(rest).chain(jumps).collect()
    }

    #[test]
    fn sorting_and_descent_find_what_looking_at_all_pairs_finds() {
        let ring = Torus { major_segments: 14, minor_segments: 9, ..Torus::default() };
        let model = Model::build(ring.build().unwrap(), &BuildOptions::default()).unwrap().0;
        let faces: Vec<FaceId> = (0..model.mesh().faces().len() as u32).map(FaceId).collect();
        let mut levels = Levels::of([model.tree(), model.tree()]);
        let (mut swaps, mut active, mut met) = (0, 0, [0; 2]);
        for (frame, pose) in poses().iter().enumerate() {
            let map = pose.world_from_body();
            let posed =
                |g: FaceId| model.mesh().triangle(g).map(|p| map.linear * p + map.translation);
            let mut all: Vec<[FaceId; 2]> = Vec::new();
            for &g in &faces {
                let other = posed(g);
                let of = |&f: &FaceId| classify_triangles(&model.mesh().triangle(f), &other);
                all.extend(faces.iter().filter(|f| of(f) != Meeting::None).map(|&f| [f, g]));
            }
            let (leaves, work) = levels.update(&map);
            let by_descent = pairs_of_leaves([model.tree(), model.tree()], &map).0;
            all.sort_unstable();
            for leaves in [leaves, by_descent] {
                let mut found = meetings([&model, &model], &map, &leaves);
                found.sort_unstable();
                assert_eq!(found, all, "frame {frame}");
            }
            swaps += work.swaps;
            active = active.max(work.active);
            met[usize::from(all.is_empty())] += 1;
        }
        assert!(met.iter().all(|&n| n > 0), "{met:?} frames with meetings, and without");
        assert!(swaps > 1_000 && active > 100, "{swaps} swaps, {active} active");
        // What stands still passes nothing, and no box is compared.
        let rest = poses()[40].world_from_body();
        levels.update(&rest);
        let work = levels.update(&rest).1;
        assert_eq!((work.swaps, work.tests), (0, 0));
    }
}
