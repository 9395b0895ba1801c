//! Linking numbers of circles.

use cranny_exact::{DVec3, Pose, RigidMap};

/// Straight pieces of a circle: enough to tell a crossing of the disc from a miss.
const PIECES: usize = 256;

/// How often the circle of body B passes through the disc of body A, signed: the linking number of
/// the two circles. Both have their centre at their body's origin and z for an axis.
pub(crate) fn linking_number(a: &Pose, b: &Pose, radius: f64) -> i32 {
    let a_from_b = RigidMap::between(a, b);
    let point = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / PIECES as f64;
        a_from_b.apply(radius * DVec3::new(angle.cos(), angle.sin(), 0.0))
    };
    (0..PIECES)
        .map(|k| {
            let (p, q) = (point(k), point(k + 1));
            if (p.z > 0.0) == (q.z > 0.0) {
                return 0;
            }
            let through = p.lerp(q, p.z / (p.z - q.z));
            match (through.truncate().length() < radius, q.z > p.z) {
                (true, true) => 1,
                (true, false) => -1,
                (false, _) => 0,
            }
        })
        .sum()
}

/// Least distance between the two circles.
pub(crate) fn circle_distance(a: &Pose, b: &Pose, radius: f64) -> f64 {
    let a_from_b = RigidMap::between(a, b);
    (0..PIECES * 16)
        .map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / (PIECES * 16) as f64;
            let p = a_from_b.apply(radius * DVec3::new(angle.cos(), angle.sin(), 0.0));
            (p.truncate().length() - radius).hypot(p.z)
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn links_and_neighbours_differ() {
    let upright = Pose {
        rotation: cranny_exact::DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()),
        translation: DVec3::X,
    };
    assert_eq!(linking_number(&Pose::IDENTITY, &upright, 1.0).abs(), 1);
    let beside = Pose { translation: 2.5 * DVec3::X, ..upright };
    assert_eq!(linking_number(&Pose::IDENTITY, &beside, 1.0), 0);
    let above = Pose { translation: 0.1 * DVec3::Z, ..Pose::IDENTITY };
    assert_eq!(linking_number(&Pose::IDENTITY, &above, 1.0), 0);
    assert!((circle_distance(&Pose::IDENTITY, &beside, 1.0) - 0.5).abs() < 1e-6);
}
