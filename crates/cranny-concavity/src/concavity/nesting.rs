//! In which concavity a concavity without a lid lies.
//!
//! A surface inside another is found by the crossings of a ray with the surfaces that bound
//! pockets: caps, and faces negatively. The ray runs along +x from a vertex and is moved aside by
//! an infinitesimal amount in y and a still smaller one in z (Edelsbrunner and Mücke 1990), so that
//! it meets no edge: every sign is exact, none is zero.
//!
//! Cost: the elements of all concavities whose boxes enclose the one in question, for each without
//! a lid; bodies have few of these.

use cranny_exact::{Aabb, DVec2, DVec3, Sign, orient2d, orient3d};

/// Whether a point lies inside the surface of the triangles, each counted once; `None` where the
/// point lies on one of those that the ray meets.
fn winding(point: DVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<i32> {
    let mut winding = 0;
    for [a, b, c] in triangles {
        if a.x.max(b.x).max(c.x) < point.x {
            continue;
        }
        let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| left_of(point, from, to));
        if edges[0] != edges[1] || edges[1] != edges[2] {
            continue;
        }
        // The projected triangle holds the point; counter-clockwise there means a normal along +x.
        match (orient3d(a, b, c, point), edges[0]) {
            (Sign::Zero, _) => return None,
            (Sign::Negative, true) => winding += 1,
            (Sign::Positive, false) => winding -= 1,
            _ => {}
        }
    }
    Some(winding)
}

/// Whether the moved point lies to the left of the edge, seen along −x.
fn left_of(point: DVec3, from: DVec3, to: DVec3) -> bool {
    let flat = |p: DVec3| DVec2::new(p.y, p.z);
    match orient2d(flat(from), flat(to), flat(point)) {
        Sign::Positive => true,
        Sign::Negative => false,
        // Moved by e in y, the point gains −(to − from).z e; by e² in z, (to − from).y e².
        Sign::Zero if from.z != to.z => from.z > to.z,
        Sign::Zero => from.y < to.y,
    }
}

/// What the search knows of a concavity.
pub(super) struct Surface {
    /// Cap triangles, and faces turned around: what bounds the pocket.
    pub(super) triangles: Vec<[DVec3; 3]>,
    pub(super) bounds: Aabb,
    /// Whether it has a lid, and so lies in no other.
    pub(super) is_lidded: bool,
}

/// For each surface the one that holds it most closely, if any.
pub(super) fn parents(surfaces: &[Surface]) -> Vec<Option<usize>> {
    surfaces
        .iter()
        .enumerate()
        .map(|(i, inner)| {
            if inner.is_lidded {
                return None;
            }
            let around = (0..surfaces.len()).filter(|&j| j != i && holds(&surfaces[j], inner));
            // Of nested boxes the innermost has the least diagonal.
            around.min_by(|&j, &k| {
                let size = |s: usize| surfaces[s].bounds.diagonal();
                size(j).total_cmp(&size(k)).then(j.cmp(&k))
            })
        })
        .collect()
}

fn holds(outer: &Surface, inner: &Surface) -> bool {
    let (o, i) = (&outer.bounds, &inner.bounds);
    if !(o.contains_point(i.min) && o.contains_point(i.max)) {
        return false;
    }
    let points = inner.triangles.iter().map(|t| t[0]);
    let first = points.map(|p| winding(p, outer.triangles.iter().copied())).find_map(|w| w);
    first.is_some_and(|w| w != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box, outward.
    fn cuboid(low: f64, high: f64) -> Vec<[DVec3; 3]> {
        let p = |i: u32| {
            let pick = |bit: u32| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(pick(0), pick(1), pick(2))
        };
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(p)).collect()
    }

    fn surface(low: f64, high: f64, is_lidded: bool) -> Surface {
        let triangles = cuboid(low, high);
        Surface {
            bounds: Aabb::of_points(triangles.iter().flatten().copied()),
            triangles,
            is_lidded,
        }
    }

    #[test]
    fn a_ray_through_corners_and_edges_counts_once() {
        // From inside, along the diagonals of both sides, through edges and corners of the box.
        for point in [DVec3::ZERO, DVec3::new(0.0, 0.5, 0.5), DVec3::new(0.0, -0.5, 0.5)] {
            assert_eq!(winding(point, cuboid(-1.0, 1.0).into_iter()), Some(1), "{point}");
        }
        for point in [-2.0 * DVec3::X, DVec3::new(-2.0, 1.0, 1.0), DVec3::new(0.0, 0.0, 2.0)] {
            assert_eq!(winding(point, cuboid(-1.0, 1.0).into_iter()), Some(0), "{point}");
        }
        let inward = cuboid(-1.0, 1.0).into_iter().map(|[a, b, c]| [a, c, b]);
        assert_eq!(winding(DVec3::ZERO, inward), Some(-1));
        assert_eq!(winding(DVec3::X, cuboid(-1.0, 1.0).into_iter()), None);
    }

    #[test]
    fn boxes_in_boxes_have_the_next_larger_for_parent() {
        let boxes = [
            surface(-1.0, 1.0, false),
            surface(-8.0, 8.0, true),
            surface(-4.0, 4.0, false),
            surface(5.0, 6.0, false),
            surface(9.0, 10.0, false),
        ];
        assert_eq!(parents(&boxes), [Some(2), None, Some(1), Some(1), None]);
    }
}
