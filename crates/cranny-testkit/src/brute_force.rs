//! Triangle against triangle the plain, slow way: every edge of one against the other, by signs of
//! tetrahedra alone.

use cranny_exact::{
    DVec3, Meeting, Piercing, SegmentFeature, Sign, TriangleFeature, locate_piercing, orient3d,
};

/// How two closed triangles meet. No filter, no order of intervals, no projection.
#[must_use]
pub fn brute_force_meeting(a: &[DVec3; 3], b: &[DVec3; 3]) -> Meeting {
    let meets = |t: &[DVec3; 3], u: &[DVec3; 3]| edges(t).iter().any(|e| edge_meets(e, u));
    if !meets(a, b) && !meets(b, a) {
        Meeting::None
    } else if crosses(a, b) {
        Meeting::Cross
    } else {
        Meeting::Touch
    }
}

/// A triangle without area is co-planar with every point.
fn has_area(t: &[DVec3; 3]) -> bool {
    CORNERS.into_iter().any(|o| !orient3d(t[0], t[1], t[2], o).is_zero())
}

fn edges(t: &[DVec3; 3]) -> [[DVec3; 2]; 3] {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
}

/// The common segment of two triangles in crossing planes has both ends on edges. It runs inside a
/// triangle unless one edge of that triangle holds both ends. Different pairs of features hold
/// different points, since the features of a triangle with area are disjoint.
fn crosses(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    if !has_area(a) || !has_area(b) {
        return false;
    }
    let mut contacts = contacts_of_edges(a, b);
    contacts.extend(contacts_of_edges(b, a).into_iter().map(|(on_b, on_a)| (on_a, on_b)));
    contacts.sort();
    contacts.dedup();
    let along_an_edge = |features: &mut dyn Iterator<Item = TriangleFeature>| {
        let features: Vec<TriangleFeature> = features.collect();
        (0..3).any(|edge| features.iter().all(|&f| lies_on_edge(f, edge)))
    };
    contacts.len() >= 2
        && !along_an_edge(&mut contacts.iter().map(|c| c.0))
        && !along_an_edge(&mut contacts.iter().map(|c| c.1))
}

/// Where the edges of `t` that are not co-planar with `u` meet it: features of `t` and of `u`.
fn contacts_of_edges(t: &[DVec3; 3], u: &[DVec3; 3]) -> Vec<(TriangleFeature, TriangleFeature)> {
    let mut contacts = Vec::new();
    for (i, edge) in (0u8..).zip(edges(t)) {
        if let Piercing::Point { on_segment, on_triangle } = locate_piercing(&edge, u) {
            let on_t = match on_segment {
                SegmentFeature::Start => TriangleFeature::Vertex(i),
                SegmentFeature::Interior => TriangleFeature::Edge(i),
                SegmentFeature::End => TriangleFeature::Vertex((i + 1) % 3),
            };
            contacts.push((on_t, on_triangle));
        }
    }
    contacts
}

fn lies_on_edge(feature: TriangleFeature, edge: u8) -> bool {
    match feature {
        TriangleFeature::Vertex(v) => v == edge || v == (edge + 1) % 3,
        TriangleFeature::Edge(e) => e == edge,
        TriangleFeature::Interior => false,
    }
}

/// Whether a closed segment meets a closed triangle: it meets an edge, or the inside.
fn edge_meets(segment: &[DVec3; 2], t: &[DVec3; 3]) -> bool {
    edges(t).iter().any(|e| segments_meet(segment, e)) || reaches_inside(segment, t)
}

/// Whether a segment that meets no edge of a triangle meets it nonetheless.
fn reaches_inside(&[p, q]: &[DVec3; 2], t: &[DVec3; 3]) -> bool {
    let (start, end) = (orient3d(t[0], t[1], t[2], p), orient3d(t[0], t[1], t[2], q));
    let all_equal = |s: [Sign; 3]| s[0] == s[1] && s[1] == s[2] && !s[0].is_zero();
    if start == end && !start.is_zero() {
        false
    } else if start == end {
        let apex = CORNERS.into_iter().find(|&o| !orient3d(t[0], t[1], t[2], o).is_zero());
        apex.is_some_and(|o| all_equal(edges(t).map(|[u, v]| orient3d(u, v, p, o))))
    } else {
        all_equal(edges(t).map(|[u, v]| orient3d(p, q, u, v)))
    }
}

/// Whether two closed segments share a point.
fn segments_meet(s: &[DVec3; 2], t: &[DVec3; 2]) -> bool {
    if !orient3d(s[0], s[1], t[0], t[1]).is_zero() {
        return false;
    }
    // Seen from a point off their plane, turns in the plane are signs of tetrahedra.
    let turns = |o: DVec3| {
        [[s[0], s[1], t[0]], [s[0], s[1], t[1]], [t[0], t[1], s[0]], [t[0], t[1], s[1]]]
            .map(|[u, v, w]| orient3d(u, v, w, o))
    };
    let seen = CORNERS.map(turns).into_iter().find(|seen| seen.iter().any(|sign| !sign.is_zero()));
    match seen {
        Some([a, b, c, d]) => {
            let aside = |u: Sign, v: Sign| u == v && !u.is_zero();
            !aside(a, b) && !aside(c, d)
        }
        None => {
            // All on one line: their boxes meet exactly where they do.
            let (lo, hi) = (s[0].min(s[1]), s[0].max(s[1]));
            lo.cmple(t[0].max(t[1])).all() && t[0].min(t[1]).cmple(hi).all()
        }
    }
}

/// Four points that no plane holds.
const CORNERS: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_through_edges_cross_though_no_edge_pierces_an_inside() {
        // Both ends of the common segment lie on an edge of each triangle.
        let a = [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0)];
        let b = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 2.0, 0.0)];
        assert_eq!(brute_force_meeting(&a, &b), Meeting::Cross);
        let beside = b.map(|p| p + DVec3::X);
        assert_eq!(brute_force_meeting(&a, &beside), Meeting::Touch);
        let apart = b.map(|p| p + 2.0 * DVec3::X);
        assert_eq!(brute_force_meeting(&a, &apart), Meeting::None);
    }

    #[test]
    fn a_triangle_inside_another_touches() {
        let outer = [DVec3::ZERO, 8.0 * DVec3::X, 8.0 * DVec3::Y];
        let inner = [DVec3::ONE, DVec3::new(2.0, 1.0, 1.0), DVec3::new(1.0, 2.0, 1.0)];
        assert_eq!(brute_force_meeting(&outer, &inner), Meeting::None);
        assert_eq!(brute_force_meeting(&outer, &inner.map(|p| p - DVec3::Z)), Meeting::Touch);
    }
}
