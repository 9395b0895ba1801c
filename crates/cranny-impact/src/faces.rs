//! Two moving faces: until when are they free, or when do they meet?
//!
//! Far apart, the directional bound of `reach` carries them forward. Near each other, the curved
//! motion is replaced by chords: over a piece of length `d` a corner at distance `r` from its
//! body's axis leaves its chord by at most `|turn|² r d² / 8`. The fifteen pairs of features (six
//! vertices with a face, nine pairs of edges) are then searched for a meeting of the *linear*
//! motion, with a separation that covers both chords' deviations and all rounding, so that what is
//! free there is free in truth.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;
use cranny_geometry::triangle_distance::{Nearest, Part, triangle_distance};
use cranny_narrow_phase::Feature;
use cranny_narrow_phase::operations::Side;

use crate::bodies::{Bodies, Moment};
use crate::impact::ImpactCounters;
use crate::linear::{LinearImpact, LinearLimits, linear_edge_edge, linear_vertex_face};
use crate::reach::triangles_lasting;

/// Chords may deviate by this part of the tolerance, and it is how finely a meeting is located.
/// Then what is called a meeting is within (√3 (1/8 + 2/8) + 1/8) < 4/5 of the tolerance; the rest
/// is left to rounding.
const PART_OF_TOLERANCE: f64 = 0.125;

/// Chords may always deviate by this part of the tolerance, however near two faces slide past each
/// other. Smaller: pieces become short without end; larger: bodies that turn past each other within
/// the tolerance are reported more often.
const LEAST_PART: f64 = 1.0 / 1024.0;

/// The most boxes of parameters for one pair of features and one piece. A meeting takes some
/// hundred. Fewer: meetings are located in more pieces; more: no use, since a spent budget only
/// makes the piece shorter.
const SUBDIVISIONS: u32 = 2_000;

/// How two faces go on after a moment.
pub(crate) enum Next {
    /// They share no point before this time, which is later than the moment.
    Later(f64),
    /// They share no point up to the end.
    Free,
    /// They share no point before `lower`, and are within the tolerance at the meeting's time.
    Met { lower: f64, meeting: FaceHit },
}

/// Two faces within the tolerance of each other.
pub(crate) struct FaceHit {
    pub(crate) time: f64,
    /// In the bodies' frame: on the first, on the second.
    pub(crate) witnesses: [(DVec3, Feature); 2],
    /// Unit, from first to second.
    pub(crate) normal: DVec3,
    pub(crate) distance: f64,
}

/// Settles two faces that share no point before the moment.
pub(crate) fn settle(
    bodies: &Bodies,
    faces: (FaceId, FaceId),
    moment: &Moment,
    end: f64,
    tolerance: f64,
    counters: &mut ImpactCounters,
) -> Next {
    counters.face_tests += 1;
    let time = moment.time;
    let arms = arms(bodies, faces, moment);
    let nearest = distance_of(&arms, moment);
    let apart = nearest.points[1] - nearest.points[0];
    let lasting = triangles_lasting(bodies, moment, &arms, apart);
    let waiting = (time + lasting).next_down();
    if waiting > end {
        return Next::Free;
    }
    let piece = Piece::after(bodies, &arms, moment, end, nearest.squared.sqrt(), tolerance);
    if waiting >= piece.end {
        return Next::Later(waiting);
    }
    let limits = LinearLimits {
        separation: piece.deviation + bodies.rounding,
        tolerance: PART_OF_TOLERANCE * tolerance,
        subdivisions: SUBDIVISIONS,
    };
    let at_end = bodies.at(piece.end);
    let points_at_end = corners(bodies, faces, &at_end);
    let points = [0, 1].map(|i| arms[i].map(|arm| arm + moment.origin(Side::BOTH[i])));
    let first = first_meeting(&points, &points_at_end, &limits, counters);
    let duration = piece.end - time;
    // Rounded down; a time is off by an ulp or two, which the separation's rounding covers.
    let at = |part: f64| (time + part * duration).next_down().clamp(time, piece.end);
    match first {
        LinearImpact::Free if piece.end >= end => Next::Free,
        LinearImpact::Free => Next::Later(piece.end),
        LinearImpact::Near { time: part } => {
            let lower = at(part);
            match meeting(bodies, faces, &bodies.at(lower), tolerance) {
                Some(meeting) => Next::Met { lower, meeting },
                None => later_or_met(bodies, faces, moment, [lower, waiting], &nearest),
            }
        }
        LinearImpact::Open { from } => {
            let lower = at(from);
            if lower <= time
                && let Some(meeting) = meeting(bodies, faces, moment, tolerance)
            {
                return Next::Met { lower: time, meeting };
            }
            later_or_met(bodies, faces, moment, [lower, waiting], &nearest)
        }
    }
}

/// The later of the two times, both of which are certified; where neither is later than the
/// moment, rounding leaves no step, and the faces count as meeting, at the distance found.
fn later_or_met(
    bodies: &Bodies,
    faces: (FaceId, FaceId),
    moment: &Moment,
    times: [f64; 2],
    nearest: &Nearest,
) -> Next {
    let later = times[0].max(times[1]);
    if later > moment.time {
        return Next::Later(later);
    }
    let meeting = meeting_of(bodies, faces, moment, nearest);
    Next::Met { lower: moment.time, meeting }
}

/// A stretch of time over which both faces are taken to move linearly.
struct Piece {
    end: f64,
    /// The most by which corners leave their chords, both faces together.
    deviation: f64,
}

impl Piece {
    fn after(
        bodies: &Bodies,
        arms: &[[DVec3; 3]; 2],
        moment: &Moment,
        end: f64,
        distance: f64,
        tolerance: f64,
    ) -> Self {
        // |turn|² r, the acceleration, is |turn| times the speed |turn × arm|.
        let acceleration: f64 = Side::BOTH
            .map(|side| {
                let spin = bodies.spin(side);
                let speed = |arm: &DVec3| spin.cross(*arm).length();
                let fastest = arms[side.index()].iter().map(speed).fold(0.0, f64::max);
                spin.length() * fastest
            })
            .iter()
            .sum();
        let wanted = (0.25 * distance).clamp(LEAST_PART * tolerance, PART_OF_TOLERANCE * tolerance);
        let duration = (8.0 * wanted / acceleration).sqrt();
        let end = end.min(moment.time + duration).max(moment.time.next_up()).min(1.0);
        let duration = end - moment.time;
        // Rounded up.
        let deviation = 0.125 * acceleration * duration * duration * (1.0 + 16.0 * f64::EPSILON);
        Self { end, deviation }
    }
}

/// The earliest meeting among all pairs of features; an open result counts from its beginning.
fn first_meeting(
    start: &[[DVec3; 3]; 2],
    end: &[[DVec3; 3]; 2],
    limits: &LinearLimits,
    counters: &mut ImpactCounters,
) -> LinearImpact {
    let mut first = LinearImpact::Free;
    let mut offer = |(impact, subdivisions): (LinearImpact, u32)| {
        counters.linear_tests += 1;
        counters.subdivisions += u64::from(subdivisions);
        let time = |i: LinearImpact| match i {
            LinearImpact::Free => f64::INFINITY,
            LinearImpact::Near { time } => time,
            LinearImpact::Open { from } => from,
        };
        if time(impact) < time(first) {
            first = impact;
        }
    };
    for (vertices, face) in [(0, 1), (1, 0)] {
        for i in 0..3 {
            let with_face = |p: &[[DVec3; 3]; 2]| {
                let [a, b, c] = p[face];
                [p[vertices][i], a, b, c]
            };
            offer(linear_vertex_face(&with_face(start), &with_face(end), limits));
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let edges =
                |p: &[[DVec3; 3]; 2]| [p[0][i], p[0][(i + 1) % 3], p[1][j], p[1][(j + 1) % 3]];
            offer(linear_edge_edge(&edges(start), &edges(end), limits));
        }
    }
    first
}

fn arms(bodies: &Bodies, (f, g): (FaceId, FaceId), moment: &Moment) -> [[DVec3; 3]; 2] {
    [bodies.arms(Side::First, f, moment), bodies.arms(Side::Second, g, moment)]
}

fn corners(bodies: &Bodies, (f, g): (FaceId, FaceId), moment: &Moment) -> [[DVec3; 3]; 2] {
    [bodies.triangle(Side::First, f, moment), bodies.triangle(Side::Second, g, moment)]
}

fn distance_of(arms: &[[DVec3; 3]; 2], moment: &Moment) -> Nearest {
    triangle_distance(&arms[0], &arms[1].map(|arm| arm + moment.offset))
}

/// The faces at a moment, if they are within the tolerance.
fn meeting(
    bodies: &Bodies,
    faces: (FaceId, FaceId),
    moment: &Moment,
    tolerance: f64,
) -> Option<FaceHit> {
    let nearest = distance_of(&arms(bodies, faces, moment), moment);
    (nearest.squared.sqrt() <= tolerance).then(|| meeting_of(bodies, faces, moment, &nearest))
}

fn meeting_of(
    bodies: &Bodies,
    faces: (FaceId, FaceId),
    moment: &Moment,
    nearest: &Nearest,
) -> FaceHit {
    let feature =
        |side: Side, face| Feature::of_part(nearest.parts[side.index()], bodies.model(side), face);
    let apart = nearest.points[1] - nearest.points[0];
    let distance = nearest.squared.sqrt();
    let normal = if distance > bodies.rounding {
        apart / distance
    } else {
        normal_of_features(bodies, faces, moment, nearest)
    };
    FaceHit {
        time: moment.time,
        witnesses: [
            (nearest.points[0], feature(Side::First, faces.0)),
            (nearest.points[1], feature(Side::Second, faces.1)),
        ],
        normal,
        distance,
    }
}

/// The common normal of two features that coincide, turned so that the bodies approach along it.
fn normal_of_features(
    bodies: &Bodies,
    faces: (FaceId, FaceId),
    moment: &Moment,
    nearest: &Nearest,
) -> DVec3 {
    let triangles = corners(bodies, faces, moment);
    let of_face = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let edge = |t: [DVec3; 3], i: u8| t[(usize::from(i) + 1) % 3] - t[usize::from(i)];
    let velocity = |side: Side| {
        let arm = nearest.points[side.index()] - moment.origin(side);
        bodies.spin(side).cross(arm)
    };
    let approach = bodies.drift + velocity(Side::Second) - velocity(Side::First);
    let normal = match nearest.parts {
        [Part::Edge(i), Part::Edge(j)] => edge(triangles[0], i).cross(edge(triangles[1], j)),
        [Part::Inside, _] => of_face(triangles[0]),
        [_, Part::Inside] => of_face(triangles[1]),
        // A corner at a corner or an edge: nothing but the motion has a direction.
        _ => -approach,
    };
    let normal = normal.try_normalize().or((-approach).try_normalize()).unwrap_or(DVec3::X);
    if normal.dot(approach) > 0.0 { -normal } else { normal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Motion, Moving};
    use cranny_exact::Pose;
    use cranny_geometry::{BuildOptions, Mesh, Model};

    const FACE: FaceId = FaceId(0);

    fn triangle(corners: [DVec3; 3]) -> Model {
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    #[test]
    fn chords_deviate_by_what_is_said() {
        let blade = triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let turning =
            Motion { turn: 3.0 * DVec3::Z, ..Motion::straight(Pose::at(5.0 * DVec3::X), DVec3::Y) };
        let a = Moving { model: &blade, motion: Motion::at_rest(Pose::IDENTITY) };
        let bodies = Bodies::new(a, Moving { model: &blade, motion: turning }).unwrap();
        let start = bodies.at(0.25);
        let piece =
            Piece::after(&bodies, &arms(&bodies, (FACE, FACE), &start), &start, 1.0, 4.0, 0.5);
        assert!((piece.deviation - PART_OF_TOLERANCE * 0.5).abs() < 1e-12);
        let at = |t: f64| corners(&bodies, (FACE, FACE), &bodies.at(t));
        let (from, middle, to) = (at(0.25), at(0.5 * (0.25 + piece.end)), at(piece.end));
        let mut most = 0.0f64;
        for side in 0..2 {
            for i in 0..3 {
                let chord = 0.5 * (from[side][i] + to[side][i]);
                most = most.max((middle[side][i] - chord).length());
            }
        }
        assert!(most <= piece.deviation && most > 0.95 * piece.deviation, "{most}");
    }

    #[test]
    fn features_that_coincide_have_a_normal_against_the_approach() {
        // A corner of the second in the first's face, moving down or up.
        let floor = triangle([DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::Y]);
        let spike = triangle([DVec3::ONE, DVec3::new(1.0, 1.0, 2.0), DVec3::new(2.0, 1.0, 2.0)]);
        for speed in [-1.0, 1.0] {
            let motion = Motion::straight(Pose::at(-DVec3::Z), speed * DVec3::Z);
            let a = Moving { model: &floor, motion: Motion::at_rest(Pose::IDENTITY) };
            let bodies = Bodies::new(a, Moving { model: &spike, motion }).unwrap();
            let start = bodies.at(0.0);
            let found = meeting(&bodies, (FACE, FACE), &start, 1e-6).unwrap();
            assert!(found.distance <= bodies.rounding);
            let from_a_to_b = bodies.ordered_normal(found.normal);
            assert!((from_a_to_b + speed * DVec3::Z).length() < 1e-12, "{from_a_to_b}");
        }
    }
}
