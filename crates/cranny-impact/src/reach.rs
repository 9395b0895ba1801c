//! How long two boxes or triangles that are apart certainly stay apart: directional conservative
//! advancement.
//!
//! Along a fixed direction `n` a point with arm `x`, turning with angular velocity `w`, runs with
//! `n · x' = (n × w) · x` and `|n · x''| = |(n × w) · (w × x)| <= |n × w| |w × x|`, at all times.
//! So what a body reaches along `n` is bounded by a parabola in time, and a gap lasts at least
//! until the two parabolas meet. Motion across `n` costs nothing, to first order. (Conservative
//! advancement: Mirtich 1996; with directional bounds: Zhang, Redon, Lee and Kim 2007. Theirs are
//! linear in time; a parabola steps farther where bodies slide or turn away.)

use cranny_exact::DVec3;
use cranny_narrow_phase::operations::Side;

use crate::bodies::{Bodies, Moment, PosedBox};

/// Steps are shortened by this factor, for the roundings of the formula that makes them.
const SHORTENED: f64 = 1.0 - 64.0 * f64::EPSILON;

/// How far a body reaches along a direction `s` after a moment, from its pivot: at most
/// `value + rate · s + bend · s² / 2`.
#[derive(Clone, Copy, Debug)]
struct Reach {
    value: f64,
    rate: f64,
    bend: f64,
}

impl Reach {
    fn of_box(b: &PosedBox, radius: f64, spin: DVec3, n: DVec3) -> Self {
        let turned = n.cross(spin);
        let extent = |v: DVec3| b.axes.iter().map(|a| a.dot(v).abs()).sum::<f64>();
        Self {
            value: n.dot(b.center) + extent(n),
            rate: turned.dot(b.center) + extent(turned),
            bend: turned.length() * (spin.cross(b.center).length() + spin.length() * radius),
        }
    }

    fn of_point(arm: DVec3, spin: DVec3, n: DVec3) -> Self {
        let turned = n.cross(spin);
        Self {
            value: n.dot(arm),
            rate: turned.dot(arm),
            bend: turned.length() * spin.cross(arm).length(),
        }
    }
}

/// For how long a gap along `n` lasts: `n · offset` between the pivots, less what either body
/// reaches, less `rounding` for unit `n`; 0 if there is none, infinite if nothing closes it.
fn lasting(bodies: &Bodies, moment: &Moment, n: DVec3, first: Reach, second: Reach) -> f64 {
    let gap = n.dot(moment.offset) - first.value - second.value - bodies.rounding * n.length();
    if gap <= 0.0 {
        return 0.0;
    }
    let closing = first.rate + second.rate - n.dot(bodies.drift);
    let bend = first.bend + second.bend;
    // The positive root of gap − closing s − bend s²/2, in the form that does not cancel.
    let root = (closing * closing + 2.0 * bend * gap).sqrt();
    let s = if closing > 0.0 {
        2.0 * gap / (closing + root)
    } else if bend > 0.0 {
        (root - closing) / bend
    } else {
        f64::INFINITY
    };
    s * SHORTENED
}

/// Bounds for two boxes at a moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    /// They certainly share no point for this long.
    pub(crate) lasting: f64,
    /// A lower bound of their distance.
    pub(crate) gap: f64,
}

/// Bounds for the contents of two boxes, over the nine directions that most often decide: the
/// boxes' axes, the spins' axes, and the line of centres.
pub(crate) fn boxes_apart(
    bodies: &Bodies,
    moment: &Moment,
    [first, second]: &[PosedBox; 2],
    radii: [f64; 2],
) -> Apart {
    let between = moment.offset + second.center - first.center;
    let spins = Side::BOTH.map(|side| bodies.spin(side));
    let [ra, rb] = moment.rotations;
    let directions = [
        between.normalize_or_zero(),
        ra.x_axis,
        ra.y_axis,
        ra.z_axis,
        rb.x_axis,
        rb.y_axis,
        rb.z_axis,
        bodies.axes[0],
        bodies.axes[1],
    ];
    let mut apart = Apart { lasting: 0.0, gap: 0.0 };
    for n in directions {
        let n = if n.dot(between) < 0.0 { -n } else { n };
        let extent = |b: &PosedBox| b.axes.iter().map(|a| a.dot(n).abs()).sum::<f64>();
        let gap = n.dot(between) - extent(first) - extent(second) - bodies.rounding;
        if gap > 0.0 {
            let reach_first = Reach::of_box(first, radii[0], spins[0], n);
            let reach_second = Reach::of_box(second, radii[1], spins[1], -n);
            let lasting = lasting(bodies, moment, n, reach_first, reach_second);
            apart.gap = apart.gap.max(gap);
            apart.lasting = apart.lasting.max(lasting);
        }
    }
    apart
}

/// For how long two triangles, given by the arms of their corners, certainly stay apart along `n`
/// (from the first to the second).
pub(crate) fn triangles_lasting(
    bodies: &Bodies,
    moment: &Moment,
    [first, second]: &[[DVec3; 3]; 2],
    n: DVec3,
) -> f64 {
    let n = n.normalize_or_zero();
    let first = first.map(|arm| Reach::of_point(arm, bodies.spin(Side::First), n));
    let second = second.map(|arm| Reach::of_point(arm, bodies.spin(Side::Second), -n));
    let mut least = f64::INFINITY;
    for reach in first {
        for other in second {
            least = least.min(lasting(bodies, moment, n, reach, other));
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Motion, Moving};
    use cranny_exact::Pose;
    use cranny_geometry::{BuildOptions, Mesh, Model};

    /// A triangle with its corner at the origin, in the plane x = 0, as one body.
    fn blade() -> Model {
        let vertices = vec![DVec3::ZERO, DVec3::Y, DVec3::Z];
        let mesh = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap();
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    fn lasting_of(first: Motion, second: Motion, n: DVec3) -> (f64, f64) {
        let model = blade();
        let moving = |motion| Moving { model: &model, motion };
        let bodies = Bodies::new(moving(first), moving(second)).unwrap();
        let moment = bodies.at(0.0);
        let ordered = bodies.ordered_normal(n);
        let face = cranny_geometry::FaceId(0);
        let arms = Side::BOTH.map(|side| bodies.arms(side, face, &moment));
        let boxes = Side::BOTH.map(|s| bodies.posed_box(s, &model.bounds(), &moment));
        let apart = boxes_apart(&bodies, &moment, &boxes, boxes.map(|b| b.radius()));
        (triangles_lasting(&bodies, &moment, &arms, ordered), apart.lasting)
    }

    #[test]
    fn a_straight_approach_is_met_on_time_and_a_slide_never() {
        let still = Motion::at_rest(Pose::IDENTITY);
        let coming = |travel| Motion::straight(Pose::at(DVec3::X), travel);
        let (faces, boxes) = lasting_of(still, coming(-4.0 * DVec3::X), DVec3::X);
        for s in [faces, boxes] {
            assert!(s <= 0.25 && s > 0.25 - 1e-12, "{s}");
        }
        for travel in [DVec3::new(0.0, -9.0, 0.0), DVec3::X, DVec3::ZERO] {
            assert_eq!(lasting_of(still, coming(travel), DVec3::X), (f64::INFINITY, f64::INFINITY));
        }
    }

    #[test]
    fn a_turn_away_is_bounded_by_its_acceleration() {
        // About z by one radian: the corner (0, 1, 0) starts with velocity (-1, 0, 0) and bends by
        // 1.
        let still = Motion::at_rest(Pose::IDENTITY);
        let turning = Motion { turn: DVec3::Z, ..Motion::at_rest(Pose::at(DVec3::X)) };
        let (faces, _) = lasting_of(still, turning, DVec3::X);
        let expected = 3f64.sqrt() - 1.0; // 1 − s − s²/2 = 0
        assert!(faces <= expected && faces > expected - 1e-12, "{faces}");
        let away = Motion { turn: -DVec3::Z, ..turning };
        let (faces, _) = lasting_of(still, away, DVec3::X);
        let expected = 3f64.sqrt() + 1.0; // 1 + s − s²/2 = 0
        assert!(faces <= expected && faces > expected - 1e-12, "{faces}");
    }
}
