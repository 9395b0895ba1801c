//! Convex hulls of clouds, against parry's `convex_hull` on the same points.

use cranny_exact::DVec3;
use cranny_geometry::ConvexHull;
use parry3d::math::Vector;
use parry3d::transformation::try_convex_hull;

use crate::cloud;
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{Repeats, keep, race};

/// A cloud, made when its turn comes.
type Cloud = Box<dyn Fn() -> Vec<DVec3>>;

/// parry's points: single precision, as its default build takes them.
pub(crate) fn single(points: &[DVec3]) -> Vec<Vector> {
    points.iter().map(|p| Vector::new(p.x as f32, p.y as f32, p.z as f32)).collect()
}

/// Measures the clouds whose name contains `only`.
pub(crate) fn measure(quick: bool, only: &str) -> Report {
    let sizes: &[usize] =
        if quick { &[1_000, 10_000] } else { &[1_000, 10_000, 100_000, 1_000_000] };
    let mut clouds: Vec<(String, Cloud)> = Vec::new();
    for &n in sizes {
        clouds.push((format!("sphere {n}"), Box::new(move || cloud::sphere(n))));
        clouds.push((format!("ball {n}"), Box::new(move || cloud::ball(n))));
    }
    let ring = if quick { 4_000 } else { 40_000 };
    clouds.push((format!("double cone {ring}"), Box::new(move || cloud::double_cone(ring))));
    let side = if quick { 24 } else { 128 };
    clouds.push((format!("cube grid {side}"), Box::new(move || cloud::cube_grid(side))));
    clouds.retain(|(name, _)| name.contains(only));
    let rows = clouds.into_iter().map(|(name, cloud)| row(name, &cloud(), quick)).collect();
    Report {
        title: "Convex hulls",
        notes: vec![
            "cranny: f64, exact signs, facets merged and support graph included; parry: `try_convex_hull`, f32, triangles only".into(),
            "same run, same points, in turns; medians of thread CPU time; ratio = parry / cranny".into(),
        ],
        tables: vec![Table {
            title: "Clouds",
            columns: vec!["points", "vertices", "facets", "cranny", "parry", "ratio"],
            rows,
        }],
    }
}

fn row(name: String, points: &[DVec3], quick: bool) -> Vec<Cell> {
    let narrow = single(points);
    let hull = ConvexHull::of_points(points);
    let mut parry_succeeds = true;
    let [ours, theirs] = race(
        Repeats::of(quick),
        [&mut || keep(ConvexHull::of_points(points)), &mut || {
            parry_succeeds = try_convex_hull(&narrow).is_ok();
        }],
    );
    let parry = if parry_succeeds {
        [Cell::Time(theirs), Cell::Ratio(theirs / ours)]
    } else {
        [Cell::Text("fails".into()), Cell::Absent]
    };
    let [time, ratio] = parry;
    vec![
        Cell::Text(name),
        Cell::Count(hull.vertex_count()),
        Cell::Count(hull.facet_count()),
        Cell::Time(ours),
        time,
        ratio,
    ]
}
