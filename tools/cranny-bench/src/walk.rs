//! Hull against hull in motion: a ball of points rolls round another, 0.1 degrees a frame.

use cranny_concavity::walk::{
    FeatureGraph, Relation, WalkCounters, WalkHull, WalkState, walk_hulls,
};
use cranny_exact::{DQuat, DVec3, Pose, RigidMap};
use cranny_geometry::ConvexHull;
use parry3d::math::{Pose as NarrowPose, Rotation, Vector};
use parry3d::query;
use parry3d::shape::ConvexPolyhedron;

use crate::cloud;
use crate::count::Work;
use crate::hulls::single;
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Repeats, keep, race};

const FRAMES: usize = 1_000;

/// Bisections of the gap between two boxes that are nearly parallel; see [`near_parallel`].
const BISECTIONS: usize = 100_000;

/// The smallest angle between those boxes, radians: smaller, and all of them are parallel to f64;
/// larger, and angles that hide in rounding are left out. The largest is 1e9 times that.
const LEAST_ANGLE: f64 = 1e-12;

pub(crate) fn measure(quick: bool) -> Report {
    let gaps = [("near", 0.1), ("nearer", 0.001), ("shallow", -0.02), ("deep", -0.5)];
    let rows =
        gaps.iter().flat_map(|&gap| [32, 128, 500, 2_000].map(|n| row(gap, n, quick))).collect();
    Report {
        title: "Hull pairs in motion",
        notes: vec![
            "points on two unit spheres, one rolling round the other, 0.1 degrees a frame; near: 0.1 apart at most vertices".into(),
            "walk: f64, certified interval, witnesses and features, penetration depth; parry: `distance` (GJK), f32, 0 where they overlap".into(),
            "same run, in turns; medians of thread CPU time over runs of 1,000 frames; ratio = parry / warm".into(),
        ],
        tables: vec![
            Table {
                title: "A frame",
                columns: vec![
                    "pair", "vertices", "warm", "cold", "parry", "parry / warm", "at once", "steps",
                    "searches", "exhausted",
                ],
                rows,
            },
            near_parallel(if quick { BISECTIONS / 100 } else { BISECTIONS }),
        ],
    }
}

fn row((name, gap): (&str, f64), n: usize, quick: bool) -> Vec<Cell> {
    let points = cloud::sphere(2 * n);
    let clouds = [&points[..n], &points[n..]];
    let hulls = clouds.map(ConvexHull::of_points);
    let graphs = hulls.each_ref().map(|hull| FeatureGraph::new(hull).ok());
    let narrow = clouds.map(|cloud| ConvexPolyhedron::from_convex_hull(&single(cloud)));
    let ([Some(g), Some(h)], [Some(p), Some(q)]) = (&graphs, &narrow) else {
        return vec![Cell::Text(name.into()), Cell::Count(n)];
    };
    let bodies = [WalkHull { hull: &hulls[0], graph: g }, WalkHull { hull: &hulls[1], graph: h }];
    let poses: Vec<Pose> = (0..FRAMES).map(|frame| rolling(frame, 2.0 + gap)).collect();
    let maps: Vec<RigidMap> = poses.iter().map(Pose::world_from_body).collect();
    let narrow_poses: Vec<NarrowPose> = poses.iter().map(single_pose).collect();

    let mut counters = WalkCounters::default();
    let run = |cold: bool, counters: &mut WalkCounters| {
        let mut state = WalkState::default();
        for map in &maps {
            if cold {
                state = WalkState::default();
            }
            keep(walk_hulls(bodies[0], bodies[1], map, &mut state, counters).ok());
        }
    };
    run(false, &mut counters);
    let times = race(
        Repeats::of(quick),
        [
            &mut || run(false, &mut WalkCounters::default()),
            &mut || run(true, &mut WalkCounters::default()),
            &mut || {
                for pose in &narrow_poses {
                    keep(query::distance(&NarrowPose::IDENTITY, p, pose, q).ok());
                }
            },
        ],
    );
    let [warm, cold, parry] = times.map(|seconds| seconds / FRAMES as f64 * 1e9);
    vec![
        Cell::Text(name.into()),
        Cell::Count(n),
        Cell::Nanos(warm),
        Cell::Nanos(cold),
        Cell::Nanos(parry),
        Cell::Ratio(parry / warm),
        Cell::Count(counters.proved_at_once as usize),
        Cell::Count(counters.steps as usize),
        Cell::Count(counters.searches as usize),
        Cell::Count(counters.exhausted as usize),
    ]
}

/// So many frames, after the first, of a hull that rolls round another at a distance.
pub(crate) fn work(gap: f64, points: usize, frames: usize) -> Option<Work<'static>> {
    let cloud = cloud::sphere(2 * points);
    let hulls = [&cloud[..points], &cloud[points..]].map(ConvexHull::of_points);
    let [g, h] = hulls.each_ref().map(|hull| FeatureGraph::new(hull).ok());
    let graphs = [g?, h?];
    let maps: Vec<RigidMap> =
        (0..=frames).map(|frame| rolling(frame, 2.0 + gap).world_from_body()).collect();
    let mut state = WalkState::default();
    let mut ask = move |frame: usize| {
        let [a, b] = [0, 1].map(|i| WalkHull { hull: &hulls[i], graph: &graphs[i] });
        keep(walk_hulls(a, b, &maps[frame], &mut state, &mut WalkCounters::default()));
    };
    ask(0);
    Some(Box::new(move || (1..=frames).for_each(&mut ask)))
}

/// Turned about one axis while going round another, 0.1 degrees a frame each.
fn rolling(frame: usize, distance: f64) -> Pose {
    let angle = 0.1f64.to_radians() * frame as f64;
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), angle);
    let around = DVec3::new(angle.cos(), angle.sin(), 0.1).normalize();
    Pose { rotation, translation: distance * around }
}

fn single_pose(pose: &Pose) -> NarrowPose {
    let (t, r) = (pose.translation, pose.rotation);
    NarrowPose::from_parts(
        Vector::new(t.x as f32, t.y as f32, t.z as f32),
        Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32),
    )
}

/// Boxes turned by 1e-12 to 1e-3 radians against each other, the gap halved until `f64` has no
/// number left: the poses on which feature walks are known to run in circles. Counted, not timed.
fn near_parallel(bisections: usize) -> Table {
    let sign = |bit: u32| if bit & 1 == 1 { 1.0 } else { -1.0 };
    let corners: Vec<DVec3> =
        (0..8).map(|i: u32| DVec3::new(sign(i), sign(i >> 1), sign(i >> 2))).collect();
    let hull = ConvexHull::of_points(&corners);
    let mut counters = WalkCounters::default();
    let mut widest = 0.0f64;
    if let Ok(graph) = FeatureGraph::new(&hull) {
        let body = WalkHull { hull: &hull, graph: &graph };
        let mut random = cloud::Random::new();
        for round in 0..bisections {
            let angle = LEAST_ANGLE * 1e9f64.powf(round as f64 / bisections as f64);
            let axis = [DVec3::X, DVec3::Z, DVec3::new(0.6, 0.8, 0.0), random.on_sphere()];
            let rotation = DQuat::from_axis_angle(axis[round % 4], angle);
            let beside = random.in_ball().with_z(0.0);
            let mut state = WalkState::default();
            let (mut low, mut high) = (1.5f64, 2.5f64);
            while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
                let middle = 0.5 * (low + high);
                let map =
                    Pose { rotation, translation: beside + middle * DVec3::Z }.world_from_body();
                let answer = walk_hulls(body, body, &map, &mut state, &mut counters);
                if answer.is_ok_and(|a| a.relation == Relation::Separated) {
                    widest = widest.max(answer.map_or(0.0, |a| a.separation.width()));
                    high = middle;
                } else {
                    low = middle;
                }
            }
        }
    }
    let per_query = |count: u64| Cell::Ratio(count as f64 / counters.queries.max(1) as f64);
    Table {
        title: "Near-parallel bisections, a query",
        columns: vec![
            "bisections",
            "queries",
            "at once",
            "steps",
            "cycles",
            "exhausted",
            "widest gap",
        ],
        rows: vec![vec![
            Cell::Count(bisections),
            Cell::Count(counters.queries as usize),
            per_query(counters.proved_at_once),
            per_query(counters.steps),
            Cell::Count(counters.cycles as usize),
            per_query(counters.exhausted),
            Cell::Text(format!("{widest:.1e}")),
        ]],
    }
}
