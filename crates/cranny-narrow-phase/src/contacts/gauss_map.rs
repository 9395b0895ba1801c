//! Along which directions two edges touch as they are turned, told by their arcs on the Gauss map.
//!
//! An edge is touched along directions between the outward normals of its two faces, which are an arc of the sphere
//! of directions; two edges touch where the arc of one crosses the mirrored arc of the other, and do so along their cross
//! product. Four inner products tell: all of one sign, or some not. What they say is certain or left open: what is
//! left open is judged by the posed corners of all faces (`facing`), as everything was.
//!
//! Source: arcs that cross make those faces of a Minkowski sum that edges make; as a test of two edges, Gregorius (2013, GDC, "The
//! separating axis test between convex polyhedra"). There faces are given by normals; here, as `facing` has it,
//! by the directions that lead from the edge into them. The bounds of rounding are derived here.
//!
//! Cost: 30 multiplications, half of them for most pairs, where posed corners take some hundreds. On a thread nine of ten
//! pairs of ridges that are near do not touch.

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::{EdgeId, Mesh, Topology};

use super::facing::WEDGE_SLACK;

/// By how many errors of a posed point, each as seen across an edge's faces, inner products may be off: of an edge's ends two
/// and of a face's apex two, all of them doubled where vectors are made unit, and again as far as the edge's
/// direction, which the face's is measured by, is off. Smaller, and contacts of edges are lost by rounding; larger, and small
/// edges are compared in vain.
const ERRORS: f64 = 32.0;

/// Sine of the angle by which an edge is bent at least where its arc is plain. Smaller than what `facing` takes for sharp and
/// what rounding adds, and what is told is not what is found there; larger, and edges of fine meshes are judged twice.
const LEAST_BEND: f64 = 1e-6;

/// Cosine of the angle by which it is bent at most, 120 degrees: directions between the normals then lead out of the body for
/// certain.
const MOST_BEND: f64 = -0.5;

/// What arcs say of two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Touch {
    /// They do not touch.
    Never,
    /// They touch along the cross product of the first and the second, times this sign.
    Along(f64),
    Perhaps,
}

/// The directions along which an edge between two faces is touched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    /// Unit.
    along: DVec3,
    /// For each face, into it from the edge, crossed with `along`: unit, against the face's normal or along it.
    left: DVec3,
    right: DVec3,
    /// How far an error of a point turns these, per length: infinite where they say nothing.
    blur: f64,
    /// The edge is bent outwards, neither too little nor too much for all directions on the arc to be touched along.
    is_plain: bool,
}

impl Arc {
    /// Says nothing.
    const WHOLE: Self = Self {
        along: DVec3::ZERO,
        left: DVec3::ZERO,
        right: DVec3::ZERO,
        blur: f64::INFINITY,
        is_plain: false,
    };

    /// Of an edge, in the body's frame.
    pub(super) fn of(mesh: &Mesh, topology: &Topology, edge: EdgeId) -> Self {
        let [h, g] = topology.half_edges(edge) else { return Self::WHOLE };
        let ends = topology.edges()[edge.index()];
        let [start, end] = [ends.from, ends.to].map(|v| mesh.position(v));
        let span = end - start;
        let Some(along) = span.try_normalize() else { return Self::WHOLE };
        let (mut least, mut most) = (span.length(), span.length());
        let [left, right] = [h, g].map(|h| {
            let aside = mesh.triangle(h.face())[(h.corner() + 2) % 3] - start;
            let into = aside - along * along.dot(aside);
            (least, most) = (least.min(into.length()), most.max(aside.length()));
            into.normalize_or_zero().cross(along)
        });
        let blur = most / (least * least);
        if !blur.is_finite() {
            return Self::WHOLE;
        }
        // Of a face whose side leads as `along` does, against the normal; of the other face, along it.
        let leads = [h, g].map(|h| mesh.corners(h.face())[h.corner()] == ends.from);
        let bend = match leads {
            [true, false] => -left.cross(right).dot(along),
            [false, true] => left.cross(right).dot(along),
            _ => 0.0,
        };
        let is_plain = bend > LEAST_BEND && -left.dot(right) > MOST_BEND;
        Self { along, left, right, blur, is_plain }
    }

    /// As a rotation turns it.
    #[inline]
    pub(super) fn turned(&self, rotation: &DMat3) -> Self {
        let Self { along, left, right, blur, is_plain } = *self;
        let [along, left, right] = [*rotation * along, *rotation * left, *rotation * right];
        Self { along, left, right, blur, is_plain }
    }

    /// Whether an edge of the first body touches one of the second, both in one frame, in which points may be off by `error`.
    ///
    /// With d and e along the edges, faces fall away from n = s (d × e), for s = 1 or −1, where s (d × e) · into <= 0,
    /// which is s e · (into × d) <= 0; and those of the other edge from −n, where s d · (into × e) <= 0. Between two
    /// normals of an edge that is bent outwards all directions lead out of the body.
    #[inline]
    pub(super) fn touch(&self, other: &Self, error: f64) -> Touch {
        let rounding = ERRORS * error * (self.blur + other.blur);
        let slack = WEDGE_SLACK + rounding;
        let less = |x: f64, y: f64| if x < y { x } else { y };
        let more = |x: f64, y: f64| if x > y { x } else { y };
        let (p, q) = (self.left.dot(other.along), self.right.dot(other.along));
        let (least, most) = (less(p, q), more(p, q));
        // Most are told by this half.
        if most > slack && least < -slack {
            return Touch::Never;
        }
        let (r, s) = (other.left.dot(self.along), other.right.dot(self.along));
        let (least, most) = (less(least, less(r, s)), more(most, more(r, s)));
        if most > slack && least < -slack {
            return Touch::Never;
        }
        // Smaller than a bend, and so is what rounding does to it.
        if !self.is_plain || !other.is_plain || slack > 0.125 * LEAST_BEND {
            return Touch::Perhaps;
        }
        if most < -slack {
            Touch::Along(1.0)
        } else if least > slack {
            Touch::Along(-1.0)
        } else {
            Touch::Perhaps
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::feature_pair::edges_face;
    use super::*;
    use crate::pair::{Pair, PosedVertices, Side};
    use crate::query::Placed;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, LPrism, Shape, Torus};
    use cranny_testkit::Rng;
    use std::f64::consts::FRAC_PI_2;

    fn models() -> Vec<Model> {
        let shapes: [Shape; 6] = [
            Cuboid::default().into(),
            Cup { segments: 9, ..Cup::default() }.into(),
            Comb { teeth: 2, ..Comb::default() }.into(),
            Torus { major_segments: 12, minor_segments: 7, ..Torus::default() }.into(),
            GolfBall { dimples: 12, triangles: 320, ..GolfBall::default() }.into(),
            LPrism::default().into(),
        ];
        let build = |shape: Shape| Model::build(shape.build().unwrap(), &BuildOptions::default());
        shapes.map(|shape| build(shape).unwrap().0).into()
    }

    /// Whatever arcs say is what posed corners say: nine of ten times they do say something, unless turns are nearly those at
    /// which edges lie in faces, or bodies so far apart that places are rounded by more than what counts.
    #[test]
    fn what_arcs_say_is_what_posed_corners_say() {
        let (models, mut rng) = (models(), Rng::new(11));
        let mut told = [[0; 3]; 3];
        for round in 0..3_000 {
            let kind = round % 3;
            let (a, b) = (&models[rng.below(6)], &models[rng.below(6)]);
            let mut turn = || {
                DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit() + 1.5).normalize()
            };
            let (slant, free) = (turn(), turn());
            // By quarters against each other, but for rounding; and for what is of the size of rounding far away.
            let quarter = DQuat::from_rotation_x((round / 3 % 4) as f64 * FRAC_PI_2);
            let tilt = DVec3::new(rng.unit(), rng.unit(), rng.unit()) * 1e-8;
            let tilted = DQuat::from_scaled_axis(tilt);
            let rotation = [free, slant * quarter, slant * quarter * tilted][kind].normalize();
            let far = [1.0, 1.0, 1e7][kind];
            let translation = far * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let mut posed = PosedVertices::default();
            let pair = Pair::new(
                Placed { model: a, pose: Pose { rotation: slant, translation: DVec3::ZERO } },
                Placed { model: b, pose: Pose { rotation, translation } },
                &mut posed,
            );
            for _ in 0..40 {
                let edges = Side::BOTH
                    .map(|side| EdgeId(rng.below(pair.topology(side).edges().len()) as u32));
                let arc =
                    |side: Side| Arc::of(pair.mesh(side), pair.topology(side), edges[side.index()]);
                let posed = arc(Side::Second).turned(&pair.first_from_second.linear);
                let touch = arc(Side::First).touch(&posed, pair.culling_error());
                let [p, q] = Side::BOTH.map(|side| pair.segment(side, edges[side.index()]));
                let cross = (p[1] - p[0]).cross(q[1] - q[0]);
                // Where edges are parallel nobody asks.
                let least = 1e-3 * (p[1] - p[0]).length() * (q[1] - q[0]).length();
                if cross.length() <= least {
                    continue;
                }
                let found = edges_face(&pair, edges, cross.normalize());
                let expected = match found {
                    None => Touch::Never,
                    Some(normal) => Touch::Along(normal.dot(cross).signum()),
                };
                assert!(
                    touch == expected || touch == Touch::Perhaps,
                    "{round}: {touch:?} {found:?}"
                );
                let name = match touch {
                    Touch::Never => 0,
                    Touch::Along(_) => 1,
                    Touch::Perhaps => 2,
                };
                told[kind][name] += 1;
            }
        }
        let [free, quarter, far] = told;
        assert!(free[0] > 20_000 && free[1] > 300 && free[2] < free[0] / 10, "{told:?}");
        assert!(quarter.iter().all(|&n| n > 50) && far[2] > 1_000, "{told:?}");
    }

    #[test]
    fn edges_without_two_faces_are_left_open() {
        let sheet = Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let topology = Topology::of(&sheet);
        let arc = Arc::of(&sheet, &topology, EdgeId(0));
        assert_eq!(arc.touch(&arc, 1e-15), Touch::Perhaps);
    }
}
