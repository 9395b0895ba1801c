//! Linear motion of a vertex and a face, and of two edges, against queries with rational truth.
#![allow(clippy::print_stderr)] // what was skipped or counted is worth saying

use std::path::{Path, PathBuf};

use cranny_exact::DVec3;
use cranny_geometry::triangle_distance::{closest_on_segments, closest_on_triangle};
use cranny_impact::{LinearImpact, LinearLimits, linear_edge_edge, linear_vertex_face};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    VertexFace,
    EdgeEdge,
}

/// Four points at time 0, four at time 1, and whether they meet, in exact arithmetic.
struct Case {
    start: [DVec3; 4],
    end: [DVec3; 4],
    meets: bool,
}

/// A ratio of integers that is an `f64`: the corpus has no others, and rounding would void its
/// truth.
fn exact(numerator: &str, denominator: &str) -> f64 {
    let (n, d): (i128, i128) = (numerator.parse().unwrap(), denominator.parse().unwrap());
    assert!(n.unsigned_abs() < 1 << 53 && d.count_ones() == 1, "{numerator}/{denominator}");
    n as f64 / d as f64
}

fn cases(file: &Path) -> Vec<Case> {
    let text = std::fs::read_to_string(file).unwrap();
    let rows: Vec<(DVec3, bool)> = text
        .lines()
        .map(|line| {
            let f: Vec<&str> = line.trim().split(',').collect();
            let p = DVec3::new(exact(f[0], f[1]), exact(f[2], f[3]), exact(f[4], f[5]));
            (p, f[6] == "1")
        })
        .collect();
    let case = |rows: &[(DVec3, bool)]| Case {
        start: [0, 1, 2, 3].map(|i| rows[i].0),
        end: [4, 5, 6, 7].map(|i| rows[i].0),
        meets: rows[0].1,
    };
    assert_eq!(rows.len() % 8, 0);
    rows.chunks(8).map(case).collect()
}

fn files(folder: &Path) -> Vec<(Kind, PathBuf)> {
    let mut found = Vec::new();
    for scene in std::fs::read_dir(folder.join("ccd")).unwrap() {
        let scene = scene.unwrap().path();
        for (kind, name) in [(Kind::VertexFace, "vertex-face"), (Kind::EdgeEdge, "edge-edge")] {
            for file in std::fs::read_dir(scene.join(name)).into_iter().flatten() {
                found.push((kind, file.unwrap().path()));
            }
        }
    }
    found.sort_by(|a, b| a.1.cmp(&b.1));
    found
}

fn impact(kind: Kind, start: &[DVec3; 4], end: &[DVec3; 4], tolerance: f64) -> (LinearImpact, u32) {
    let limits = LinearLimits { separation: 0.0, tolerance, subdivisions: 100_000 };
    match kind {
        Kind::VertexFace => linear_vertex_face(start, end, &limits),
        Kind::EdgeEdge => linear_edge_edge(start, end, &limits),
    }
}

/// Distance of the two features.
fn distance(kind: Kind, p: &[DVec3; 4]) -> f64 {
    match kind {
        Kind::VertexFace => (closest_on_triangle(p[0], &[p[1], p[2], p[3]]).0 - p[0]).length(),
        Kind::EdgeEdge => {
            let (s, t) = closest_on_segments(&[p[0], p[1]], &[p[2], p[3]]);
            (p[0].lerp(p[1], s) - p[2].lerp(p[3], t)).length()
        }
    }
}

/// The same query with its points in other orders, which have the same answer.
fn orders(kind: Kind) -> [[usize; 4]; 4] {
    match kind {
        Kind::VertexFace => [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 2, 1], [0, 2, 1, 3]],
        Kind::EdgeEdge => [[0, 1, 2, 3], [1, 0, 2, 3], [2, 3, 0, 1], [3, 2, 1, 0]],
    }
}

/// What a tolerance makes of all queries, each in several orders and backwards in time.
#[derive(Debug, Default)]
struct Tally {
    queries: u64,
    hits: u32,
    false_positives: u32,
    subdivisions: u64,
    most: u32,
}

fn tally(cases: &[(Kind, Case)], tolerance: f64) -> Tally {
    let mut tally = Tally::default();
    for (number, (kind, case)) in cases.iter().enumerate() {
        for order in orders(*kind) {
            let [start, end] = [&case.start, &case.end].map(|p| order.map(|i| p[i]));
            for (start, end) in [(start, end), (end, start)] {
                let (impact, subdivisions) = impact(*kind, &start, &end, tolerance);
                tally.queries += 1;
                tally.subdivisions += u64::from(subdivisions);
                tally.most = tally.most.max(subdivisions);
                match impact {
                    LinearImpact::Free => assert!(!case.meets, "missed: {number} {order:?}"),
                    LinearImpact::Open { .. } => panic!("{subdivisions} at {number} {order:?}"),
                    LinearImpact::Near { time } => {
                        tally.hits += 1;
                        tally.false_positives += u32::from(!case.meets);
                        // Whether or not they meet, they are as near as is promised.
                        let p = [0, 1, 2, 3].map(|i| start[i].lerp(end[i], time));
                        let size = p.iter().fold(1.0, |m, p| f64::max(m, p.abs().max_element()));
                        let promised =
                            3f64.sqrt() * (2.0 * tolerance + 600.0 * f64::EPSILON * size);
                        let near = distance(*kind, &p);
                        assert!(near <= promised, "{near:e} at {number} {order:?}");
                    }
                }
            }
        }
    }
    tally
}

#[test]
fn public_queries_have_no_false_negative() {
    let Some(folder) = std::env::var_os("CRANNY_CORPUS").map(PathBuf::from) else {
        eprintln!("skipped: CRANNY_CORPUS not set");
        return;
    };
    let with_kind =
        |(kind, file): (Kind, PathBuf)| cases(&file).into_iter().map(move |c| (kind, c));
    let cases: Vec<(Kind, Case)> = files(&folder).into_iter().flat_map(with_kind).collect();
    let meeting = 8 * cases.iter().filter(|(_, c)| c.meets).count() as u32;
    assert!(cases.len() >= 1000 && meeting > 0, "{} queries", cases.len());
    let mut fewer = u32::MAX;
    for tolerance in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        let t = tally(&cases, tolerance);
        assert_eq!(t.hits - t.false_positives, meeting);
        eprintln!(
            "tolerance {tolerance:e}: {} queries, {meeting} meet, {} more within the tolerance; {:.1} \
             boxes a query, at most {}",
            t.queries,
            t.false_positives,
            t.subdivisions as f64 / t.queries as f64,
            t.most
        );
        assert!(t.false_positives <= fewer);
        fewer = t.false_positives;
    }
}
