//! Support queries on hulls: the direction turns a little between two, as a body does between
//! frames.

use cranny_exact::DVec3;
use cranny_geometry::ConvexHull;
use cranny_geometry::hull::HullVertexId;

use crate::cloud;
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Repeats, keep, race};

/// Queries a run, along one great circle.
const QUERIES: usize = 3_600;

pub(crate) fn measure(quick: bool) -> Report {
    let rows = [32, 128, 500, 2_000].map(|n| row(n, quick)).into();
    Report {
        title: "Support queries",
        notes: vec![
            "0.1 degrees between two queries; warm: from the last answer; cold: from the extreme vertex of an axis".into(),
            "scan: all vertices, as an exact maximum needs without a graph; same run, medians of thread CPU time".into(),
        ],
        tables: vec![Table {
            title: "A query",
            columns: vec!["vertices", "warm", "cold", "scan", "scan / warm"],
            rows,
        }],
    }
}

fn row(n: usize, quick: bool) -> Vec<Cell> {
    let hull = ConvexHull::of_points(&cloud::sphere(n));
    let directions: Vec<DVec3> = (0..QUERIES)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * i as f64 / QUERIES as f64).sin_cos();
            DVec3::new(c, 0.6 * s, 0.8 * s)
        })
        .collect();
    let scan = |d: DVec3| {
        let higher = |best: (usize, f64), (i, p): (usize, &DVec3)| {
            let h = d.dot(*p);
            if h > best.1 { (i, h) } else { best }
        };
        hull.positions().iter().enumerate().fold((0, f64::NEG_INFINITY), higher).0
    };
    let times = race(
        Repeats::of(quick),
        [
            &mut || {
                let mut last = HullVertexId(0);
                for &d in &directions {
                    last = hull.support(d, Some(last)).unwrap_or(last);
                }
                keep(last);
            },
            &mut || directions.iter().for_each(|&d| keep(hull.support(d, None))),
            &mut || directions.iter().for_each(|&d| keep(scan(d))),
        ],
    );
    let [warm, cold, scan] = times.map(|seconds| seconds / QUERIES as f64 * 1e9);
    vec![
        Cell::Count(hull.vertex_count()),
        Cell::Nanos(warm),
        Cell::Nanos(cold),
        Cell::Nanos(scan),
        Cell::Ratio(scan / warm),
    ]
}
