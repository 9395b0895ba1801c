//! Least distance between two triangles, with the features that hold the witnesses.
//!
//! The least distance of two triangles that do not intersect is attained between a vertex and a
//! triangle or between two edges; all fifteen are measured (Ericson, 'Real-Time Collision
//! Detection', 2005, chapter 5). A bad edge–edge answer for nearly parallel edges does no harm:
//! there a vertex attains the distance too, to within rounding, and every candidate is a distance
//! between two points that lie on the triangles.

use cranny_exact::DVec3;
use cranny_geometry::{FaceId, HalfEdgeId, Model};

use crate::answer::Feature;

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Corner 0, 1 or 2.
    Corner(u8),
    /// Edge `i`, from corner `i` to corner `(i + 1) % 3`, its ends left out.
    Edge(u8),
    /// Inside, off the edges.
    Inside,
}

impl Part {
    /// The model's name for this part of a face.
    #[must_use]
    pub fn feature(self, model: &Model, face: FaceId) -> Feature {
        match self {
            Self::Corner(i) => Feature::Vertex(model.mesh().corners(face)[usize::from(i)]),
            Self::Edge(i) => {
                let side = HalfEdgeId::of(face, usize::from(i));
                Feature::Edge(model.topology().edge_of(side))
            }
            Self::Inside => Feature::Face(face),
        }
    }
}

/// Two nearest points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) squared: f64,
    pub(crate) points: [DVec3; 2],
    pub(crate) parts: [Part; 2],
}

/// The point of a triangle nearest to `p`, and the part that holds it.
#[must_use]
pub fn closest_on_triangle(p: DVec3, [a, b, c]: &[DVec3; 3]) -> (DVec3, Part) {
    let (ab, ac, ap) = (*b - *a, *c - *a, p - *a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, Part::Corner(0));
    }
    let bp = p - *b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, Part::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return on_edge(*a, ab, d1, d1 - d3, 0);
    }
    let cp = p - *c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, Part::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return on_edge(*c, -ac, -d6, d2 - d6, 2);
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 {
        return on_edge(*b, *c - *b, e, e + f, 1);
    }
    let sum = va + vb + vc;
    if sum > 0.0 {
        (*a + ab * (vb / sum) + ac * (vc / sum), Part::Inside)
    } else {
        nearest_of_edges(p, &[*a, *b, *c])
    }
}

/// For triangles without area: the nearest point of the three sides.
fn nearest_of_edges(p: DVec3, corners: &[DVec3; 3]) -> (DVec3, Part) {
    let mut best = (corners[0], Part::Corner(0));
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let candidate = on_edge(a, b - a, (b - a).dot(p - a), (b - a).length_squared(), i as u8);
        if (p - candidate.0).length_squared() < (p - best.0).length_squared() {
            best = candidate;
        }
    }
    best
}

/// The point `start + along · numerator / denominator` of edge `i`, kept between the ends.
fn on_edge(start: DVec3, along: DVec3, numerator: f64, denominator: f64, i: u8) -> (DVec3, Part) {
    if numerator <= 0.0 || denominator <= 0.0 {
        return (start, Part::Corner(i));
    }
    if numerator >= denominator {
        return (start + along, Part::Corner((i + 1) % 3));
    }
    (start + along * (numerator / denominator), Part::Edge(i))
}

/// Parameters in \[0, 1\] of the nearest points of two segments, each from its first end.
#[must_use]
pub fn closest_on_segments(p: &[DVec3; 2], q: &[DVec3; 2]) -> (f64, f64) {
    let (d1, d2, r) = (p[1] - p[0], q[1] - q[0], p[0] - q[0]);
    let (a, e, f) = (d1.length_squared(), d2.length_squared(), d2.dot(r));
    if a <= 0.0 {
        return (0.0, if e > 0.0 { (f / e).clamp(0.0, 1.0) } else { 0.0 });
    }
    let c = d1.dot(r);
    if e <= 0.0 {
        return ((-c / a).clamp(0.0, 1.0), 0.0);
    }
    let b = d1.dot(d2);
    let denominator = a * e - b * b;
    let s = if denominator > 0.0 { ((b * f - c * e) / denominator).clamp(0.0, 1.0) } else { 0.0 };
    let t = (b * s + f) / e;
    if t < 0.0 {
        ((-c / a).clamp(0.0, 1.0), 0.0)
    } else if t > 1.0 {
        (((b - c) / a).clamp(0.0, 1.0), 1.0)
    } else {
        (s, t)
    }
}

/// The nearest points of two triangles. They must not intersect, or the answer is too large.
pub(crate) fn triangle_distance(a: &[DVec3; 3], b: &[DVec3; 3]) -> Nearest {
    let mut best =
        Nearest { squared: f64::INFINITY, points: [a[0], b[0]], parts: [Part::Corner(0); 2] };
    let mut offer = |points: [DVec3; 2], parts: [Part; 2]| {
        let squared = (points[1] - points[0]).length_squared();
        if squared < best.squared || (squared <= best.squared && parts < best.parts) {
            best = Nearest { squared, points, parts };
        }
    };
    for i in 0..3 {
        let corner = Part::Corner(i as u8);
        let (on_b, part_b) = closest_on_triangle(a[i], b);
        offer([a[i], on_b], [corner, part_b]);
        let (on_a, part_a) = closest_on_triangle(b[i], a);
        offer([on_a, b[i]], [part_a, corner]);
    }
    for i in 0..3 {
        let p = [a[i], a[(i + 1) % 3]];
        for j in 0..3 {
            let q = [b[j], b[(j + 1) % 3]];
            let (s, t) = closest_on_segments(&p, &q);
            if s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0 {
                let points = [p[0] + (p[1] - p[0]) * s, q[0] + (q[1] - q[0]) * t];
                offer(points, [Part::Edge(i as u8), Part::Edge(j as u8)]);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] =
        [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

    #[test]
    fn each_part_of_a_triangle_can_be_nearest() {
        let part = |x, y| closest_on_triangle(DVec3::new(x, y, 1.0), &FLOOR).1;
        assert_eq!(part(1.0, 1.0), Part::Inside);
        assert_eq!(part(-1.0, -1.0), Part::Corner(0));
        assert_eq!(part(9.0, -1.0), Part::Corner(1));
        assert_eq!(part(-1.0, 9.0), Part::Corner(2));
        assert_eq!(part(1.0, -1.0), Part::Edge(0));
        assert_eq!(part(3.0, 3.0), Part::Edge(1));
        assert_eq!(part(-1.0, 1.0), Part::Edge(2));
    }

    #[test]
    fn crossed_edges_are_nearest_between_their_insides() {
        let roof =
            [DVec3::new(1.0, -1.0, 2.0), DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 0.0, 9.0)];
        let wall =
            [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(2.0, 0.0, -5.0)];
        let nearest = triangle_distance(&roof, &wall);
        assert_eq!(nearest.squared, 4.0);
        assert_eq!(nearest.parts, [Part::Edge(0), Part::Edge(0)]);
        assert_eq!(nearest.points[0], DVec3::new(1.0, 0.0, 2.0));
    }

    #[test]
    fn triangles_without_area_are_segments_and_points() {
        let segment =
            [DVec3::new(0.0, 0.0, 3.0), DVec3::new(2.0, 0.0, 3.0), DVec3::new(1.0, 0.0, 3.0)];
        assert_eq!(triangle_distance(&segment, &FLOOR).squared, 9.0);
        let point = [DVec3::new(5.0, 0.0, 0.0); 3];
        assert_eq!(triangle_distance(&point, &FLOOR).squared, 1.0);
        assert_eq!(triangle_distance(&point, &segment).squared, 18.0);
    }
}
