//! Whether triangles over some points are their convex hull, in exact rationals.

use std::collections::{HashMap, HashSet};

use cranny_exact::DVec3;

use crate::rational::{Q, Q3};

/// What is wrong with triangles that are said to be a hull.
#[derive(Clone, Debug, PartialEq)]
pub struct HullFault {
    /// In words.
    pub what: String,
    /// How far a point lies outside a triangle, where that is all that is wrong with it.
    pub outside: Option<f64>,
}

impl HullFault {
    fn of(what: impl Into<String>) -> Self {
        Self { what: what.into(), outside: None }
    }
}

/// What is wrong with triangles that are said to be the hull of `points`, outward; `None`: nothing.
///
/// They must be closed (every edge run once in each direction), hang together, have the genus of a
/// sphere, have area, and no point may lie above any of them. Then each lies in the hull's surface,
/// and together they cover it. Points × triangles determinants, in rationals.
#[must_use]
pub fn rational_hull_fault(points: &[DVec3], triangles: &[[DVec3; 3]]) -> Option<HullFault> {
    if triangles.is_empty() {
        return Some(HullFault::of("no triangle"));
    }
    shape_fault(triangles).or_else(|| point_fault(points, triangles))
}

/// Adding zero makes −0 and 0 one place.
fn key(p: DVec3) -> [u64; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

fn shape_fault(triangles: &[[DVec3; 3]]) -> Option<HullFault> {
    let mut faces_of: HashMap<[[u64; 3]; 2], usize> = HashMap::new();
    let mut corners = HashSet::new();
    for (face, t) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (p, q) = (t[i], t[(i + 1) % 3]);
            corners.insert(key(p));
            if faces_of.insert([key(p), key(q)], face).is_some() {
                return Some(HullFault::of(format!("the edge from {p} to {q} is run twice")));
            }
        }
    }
    let open = faces_of.keys().any(|&[p, q]| !faces_of.contains_key(&[q, p]));
    if open {
        return Some(HullFault::of("an edge has no other side"));
    }
    if corners.len() + triangles.len() != faces_of.len() / 2 + 2 {
        return Some(HullFault::of("not the genus of a sphere"));
    }
    let mut reached = HashSet::from([0]);
    let mut queue = vec![0];
    while let Some(face) = queue.pop() {
        let t = &triangles[face];
        for i in 0..3 {
            let beside = faces_of[&[key(t[(i + 1) % 3]), key(t[i])]];
            if reached.insert(beside) {
                queue.push(beside);
            }
        }
    }
    (reached.len() < triangles.len()).then(|| HullFault::of("it falls into pieces"))
}

fn point_fault(points: &[DVec3], triangles: &[[DVec3; 3]]) -> Option<HullFault> {
    let exact: Vec<Q3> = points.iter().map(|&p| Q3::exactly(p)).collect();
    let mut worst = None;
    for t in triangles {
        let [a, b, c] = t.map(Q3::exactly);
        let normal = (&b - &a).cross(&(&c - &a));
        if normal.is_zero() {
            return Some(HullFault::of(format!("{t:?} has no area")));
        }
        let height = normal.dot(&a);
        let heights = exact.iter().map(|p| normal.dot(p));
        let highest = heights.enumerate().max_by(|(_, p), (_, q)| p.cmp(q));
        if let Some((above, top)) = highest.filter(|(_, top)| *top > height) {
            let off = top - height;
            let length = normal.dot(&normal).to_f64().value().sqrt();
            let off = off.to_f64().value() / length;
            let what = format!("{} lies {off:.1e} above {t:?}", points[above]);
            worst = worst
                .filter(|w: &HullFault| w.outside >= Some(off))
                .or(Some(HullFault { what, outside: Some(off) }));
        }
    }
    let corners: HashSet<[u64; 3]> = triangles.iter().flatten().map(|&p| key(p)).collect();
    let own: HashSet<[u64; 3]> = points.iter().map(|&p| key(p)).collect();
    let foreign = corners.difference(&own).count();
    match foreign {
        0 => worst,
        _ => Some(HullFault::of(format!("{foreign} corners are none of the points"))),
    }
}

/// Whether some four of the points span a solid: only then are triangles its hull.
#[must_use]
pub fn spans_a_solid(points: &[DVec3]) -> bool {
    let exact: Vec<Q3> = points.iter().map(|&p| Q3::exactly(p)).collect();
    let Some((o, rest)) = exact.split_first() else { return false };
    let Some(u) = rest.iter().map(|p| p - o).find(|u| !u.is_zero()) else { return false };
    let Some(normal) = rest.iter().map(|p| u.cross(&(p - o))).find(|n| !n.is_zero()) else {
        return false;
    };
    rest.iter().any(|p| normal.dot(&(p - o)) != Q::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::{angle, cuboid, inverted, octahedron};
    use cranny_geometry::{FaceId, Mesh};

    fn triangles(mesh: &Mesh) -> Vec<[DVec3; 3]> {
        (0..mesh.faces().len() as u32).map(|f| mesh.triangle(FaceId(f))).collect()
    }

    fn fault(mesh: &Mesh) -> Option<HullFault> {
        rational_hull_fault(mesh.vertices(), &triangles(mesh))
    }

    #[test]
    fn convex_bodies_are_their_own_hulls_and_others_are_not() {
        let cube = cuboid([0.0; 3], [1.0; 3]);
        assert_eq!((fault(&cube), fault(&octahedron())), (None, None));
        assert!(fault(&angle()).unwrap().outside == Some(1.0));
        assert!(fault(&inverted(&cube)).unwrap().what.contains("above"));
        let two = cube.clone().joined(&cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]));
        assert!(fault(&two).is_some());
        let open = Mesh::new(cube.vertices().to_vec(), cube.faces()[1..].to_vec()).unwrap();
        assert!(fault(&open).unwrap().what.contains("other side"));
    }

    #[test]
    fn a_point_an_ulp_outside_is_found() {
        let cube = cuboid([0.0; 3], [1.0; 3]);
        let outside = |z: f64| {
            let mut points = cube.vertices().to_vec();
            points.push(DVec3::new(0.25, 0.5, z));
            rational_hull_fault(&points, &triangles(&cube))
        };
        assert_eq!((outside(1.0), outside(0.5)), (None, None));
        assert!(outside(1.0f64.next_up()).unwrap().outside == Some(f64::EPSILON));
    }

    #[test]
    fn four_points_in_a_plane_span_no_solid() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::X, DVec3::Y, DVec3::new(3.0, 4.0, 0.0)];
        assert!(!spans_a_solid(&flat) && !spans_a_solid(&flat[..3]) && !spans_a_solid(&[]));
        let solid = [&flat[..], &[DVec3::new(0.0, 0.0, 1e-300)]].concat();
        assert!(spans_a_solid(&solid));
    }
}
