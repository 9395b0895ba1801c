//! Whether two meshes are the same surface, measured without the code under test.

use cranny_exact::DVec3;
use cranny_geometry::{Mesh, Model, Report};

use crate::repair::outcome::{assert_vertices_are_known, deviation};

/// The distance of a point from a triangle, by its sides and its foot on the plane.
pub(crate) fn triangle_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let side = |from: DVec3, to: DVec3| {
        let t = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        if t.is_nan() { p.distance(from) } else { p.distance(from.lerp(to, t)) }
    };
    let sides = side(a, b).min(side(b, c)).min(side(c, a));
    let inside =
        [(a, b), (b, c), (c, a)].iter().all(|&(s, t)| (t - s).cross(p - s).dot(normal) > 0.0);
    match inside {
        true => sides.min((p - a).dot(normal).abs() / normal.length()),
        false => sides,
    }
}

/// The farthest that samples of one surface (15 a face) lie from the other.
pub(crate) fn one_way(from: &Mesh, to: &Mesh) -> f64 {
    let mut farthest = 0.0f64;
    for face in from.faces() {
        let [a, b, c] = face.map(|v| from.vertices()[v as usize]);
        for i in 0..5 {
            for j in 0..5 - i {
                let p = a + (b - a) * (f64::from(i) / 4.0) + (c - a) * (f64::from(j) / 4.0);
                let triangles = to.faces().iter().map(|f| f.map(|v| to.vertices()[v as usize]));
                let nearest =
                    triangles.map(|t| triangle_distance(p, t)).fold(f64::INFINITY, f64::min);
                farthest = farthest.max(nearest);
            }
        }
    }
    farthest
}

/// Checks that the repaired surface is where the filed one is, as closely as its report claims.
pub(crate) fn assert_same_surface(filed: &Mesh, model: &Model, report: &Report) {
    assert!(deviation(report) <= report.weld_distance);
    assert_vertices_are_known(filed, model, report);
    let rounding = 1e-14 * filed.bounds().diagonal();
    let (out, back) = (one_way(filed, model.mesh()), one_way(model.mesh(), filed));
    assert!(out <= deviation(report) + rounding, "{out:e} from filed, {:e}", deviation(report));
    assert!(back <= deviation(report) + rounding, "{back:e} from mended, {:e}", deviation(report));
}
