//! The closest-feature walk over hulls.

use cranny_concavity::walk::{HullAnswer, Relation, WalkCounters, WalkState, walk_hulls};
use cranny_exact::{DVec3, Interval, Pose, RigidMap};
use cranny_geometry::hull::HullKind;
use cranny_testkit::error_of_root;

use crate::case::Case;
use crate::family::Family;
use crate::hull_judge::{
    Body, brute_force_depth, cuboid, disk, faults_beside, platonic_solids, rounding, sphere,
};
use crate::hull_truth::HullTruth;
use crate::pair::peer_case;
use crate::trial::{Trial, caught};

pub(super) const FAMILY: Family = Family {
    name: "walk",
    question: "How two convex hulls lie: platonic solids, disks, spheres of points, needles and plates, anyhow; nearly \
            parallel, turned by 10^-12 to 10^-3 radians; slid together until f64 has nothing left between apart and \
            not; 10^-6 to 10^6 large.",
    made: "Exact rationals over pairs of triangles tell whether they meet and how far they are apart, and check that the \
           normal reported proves the lower end of the separation. All faces of the set of differences of two small \
           hulls, in f64, tell their depth.",
    fails: "a wrong relation; an interval that by more than rounding misses the distance, or is wide; points that are \
            not as far apart; a bound without proof; of small hulls a depth below the least that parts them; another \
            relation with memory than without",
    figure: "error of the distance of hulls that are apart, in sizes of the larger",
    cases,
};

/// Width of a needle of length 2, and how far a plate bulges. Other values make other cases; none
/// decides anything.
const NEEDLE: f64 = 1e-9;
const PLATE: f64 = 1e-12;

/// Hulls of so many triangles are small: all faces of their set of differences are tried.
const SMALL: usize = 20;

/// A gap between faces that are nearly parallel; likewise.
const NEAR: f64 = 1e-6;

/// A hull whose features break their promises is a case that failed.
fn body(trial: &mut Trial<'_>, name: &str, points: &[DVec3]) -> Option<Body> {
    caught(|| Body::of(points)).map_err(|fault| trial.failed(name, fault)).ok()
}

fn bodies(trial: &mut Trial<'_>) -> Vec<(&'static str, Body)> {
    let plate = |by: f64| {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, by * z);
        [
            corner(-1.0, -1.0, 0.0),
            corner(1.0, -1.0, 1.0),
            corner(1.0, 1.0, 0.0),
            corner(-1.0, 1.0, 1.0),
        ]
    };
    let needle = [
        DVec3::new(-1.0, 0.0, 0.0),
        DVec3::new(1.0, NEEDLE, 0.0),
        DVec3::new(1.0, -NEEDLE, NEEDLE),
        DVec3::new(0.9, 0.0, -NEEDLE),
    ];
    let names = ["tetrahedron", "cube", "octahedron", "icosahedron", "dodecahedron"];
    let mut bodies: Vec<_> = names.into_iter().zip(platonic_solids()).collect();
    bodies.extend([
        ("box", cuboid(DVec3::new(1.0, 0.5, 0.25))),
        ("disk", disk(12, 0.5)),
        ("flat disk", disk(9, 0.0)),
        ("sphere", sphere(30, 7)),
    ]);
    bodies.extend(body(trial, "needle", &needle).map(|body| ("needle", body)));
    bodies.extend(body(trial, "plate", &plate(PLATE)).map(|body| ("plate", body)));
    bodies
}

fn cases(trial: &mut Trial<'_>) {
    let bodies = bodies(trial);
    let mut counters = WalkCounters::default();
    let mut state = WalkState::default();
    for _ in 0..trial.variants {
        for i in 0..2 * bodies.len() {
            let ((name_a, a), (name_b, b)) = (&bodies[i % bodies.len()], trial.pick(&bodies));
            let names = format!("{name_b} by {name_a}");
            let distance = 1.2 * (trial.rng.unit() + 1.0);
            let pose = anyhow(trial, distance);
            ask(trial, format!("{names}, anyhow"), [a, b], pose, &mut state, &mut counters);
            slide_together(trial, &names, [a, b], &mut counters);
        }
        for power in 3..=12 {
            let angle = 10f64.powi(-power) * (1.5 + trial.rng.unit());
            nearly_parallel(trial, angle, &mut counters);
        }
        for power in [-6, -3, 3, 6] {
            let scale = 10f64.powi(power);
            let [(_, a), (name, b)] = [trial.pick(&bodies), trial.pick(&bodies)];
            let mut scaled = |of: &Body| {
                let points: Vec<DVec3> = of.hull.positions().iter().map(|&p| scale * p).collect();
                body(trial, name, &points)
            };
            let (Some(a), Some(b)) = (scaled(a), scaled(b)) else { continue };
            let unit = anyhow(trial, 1.5);
            let pose = Pose { translation: scale * unit.translation, ..unit };
            ask(trial, format!("{name}, 10^{power}"), [&a, &b], pose, &mut state, &mut counters);
        }
    }
    trial.count("queries", counters.queries);
    trial.count("proved at once", counters.proved_at_once);
    trial.count("steps", counters.steps);
    trial.count("walks that came back", counters.cycles);
    trial.count("left to exact triangles", counters.exhausted);
}

/// The second turned anyhow, its origin so far away.
fn anyhow(trial: &mut Trial<'_>, distance: f64) -> Pose {
    Pose { rotation: trial.rng.rotation(), translation: distance * trial.rng.direction() }
}

/// A box over a box, or a disk over a disk, turned a little: face to face but for the angle.
fn nearly_parallel(trial: &mut Trial<'_>, angle: f64, counters: &mut WalkCounters) {
    let (a, b) = match trial.rng.below(2) {
        0 => (cuboid(DVec3::ONE), cuboid(DVec3::new(0.75, 0.75, 1.0))),
        _ => (disk(12, 1.0), disk(7, 1.0)),
    };
    let rotation = trial.tilt(angle);
    let beside = 0.25 * DVec3::new(trial.rng.unit(), trial.rng.unit(), 0.0);
    let mut state = WalkState::default();
    for gap in [1e-2, NEAR, angle, 0.5 * angle, 0.0, -0.5 * angle] {
        let translation = beside + (2.0 + gap) * DVec3::Z;
        let name = format!("{angle:.0e} rad from parallel, {gap:.0e} off");
        ask(trial, name, [&a, &b], Pose { rotation, translation }, &mut state, counters);
    }
}

/// Bisects the way along a line until f64 has no number left between; both ends are cases.
fn slide_together(
    trial: &mut Trial<'_>,
    names: &str,
    bodies: [&Body; 2],
    counters: &mut WalkCounters,
) {
    let (rotation, direction) = (trial.rng.rotation(), trial.rng.direction());
    let pose = |d: f64| Pose { rotation, translation: d * direction };
    let mut state = WalkState::default();
    let (mut low, mut high) = (0.0, 6.0);
    while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        match walked(bodies, &pose(middle).world_from_body(), &mut state, counters) {
            Ok(HullAnswer { relation: Relation::Separated, .. }) => high = middle,
            Ok(_) => low = middle,
            Err(fault) => return trial.failed(&format!("{names}, {middle:?} along a line"), fault),
        }
    }
    for d in [low, high] {
        let name = format!("{names}, {d:?} along a line");
        ask(trial, name, bodies, pose(d), &mut state, counters);
    }
}

/// Why there is no answer, a panic included.
fn walked(
    [a, b]: [&Body; 2],
    map: &RigidMap,
    state: &mut WalkState,
    counters: &mut WalkCounters,
) -> Result<HullAnswer, String> {
    let walk = || walk_hulls(a.walkable(), b.walkable(), map, state, counters);
    caught(walk)?.map_err(|error| format!("refused: {error}"))
}

/// One question: with memory and without.
fn ask(
    trial: &mut Trial<'_>,
    name: String,
    bodies: [&Body; 2],
    pose: Pose,
    state: &mut WalkState,
    counters: &mut WalkCounters,
) {
    trial.case(name, |trial, case| {
        let map = pose.world_from_body();
        let warm = walked(bodies, &map, state, counters);
        let cold = walked(bodies, &map, &mut WalkState::default(), counters);
        let towards = cold.as_ref().map_or(DVec3::Z, |cold| cold.normal);
        let truth = HullTruth::of(bodies[0], bodies[1], &map, towards);
        let distance = truth.distance();
        case.truth = words(truth.meets, distance);
        trial.count(if truth.meets { "meeting" } else { "apart" }, 1);
        let size = 2.0 * reach(bodies[0]).max(reach(bodies[1]));
        if let Some(peer) = trial.peer.as_mut() {
            let reply = peer.hulls(bodies.map(|body| body.hull.positions()), pose);
            // Whether hulls that touch to rounding meet is for exact arithmetic to say.
            let near = distance <= f64::EPSILON * size;
            let meets = (!near || !truth.meets).then_some(truth.meets);
            case.peer = Some(peer_case(reply, meets, distance, size));
        }
        match (warm, cold) {
            (Ok(warm), Ok(cold)) => judge(case, bodies, &map, &truth, [&warm, &cold], size),
            (warm, cold) => case.faults.extend([warm.err(), cold.err()].into_iter().flatten()),
        }
    });
}

/// An answer for people.
fn in_words(answer: &HullAnswer) -> String {
    let Interval { lo, hi } = answer.separation;
    match answer.relation {
        Relation::Separated => format!("apart by {lo:.3e} to {hi:.3e}"),
        Relation::Touching => "touch".to_owned(),
        Relation::Penetrating => format!("overlap, {:.3e} to {:.3e} deep", 0.0 - hi, 0.0 - lo),
    }
}

/// The answers with memory and without.
fn judge(
    case: &mut Case,
    [a, b]: [&Body; 2],
    map: &RigidMap,
    truth: &HullTruth,
    [warm, cold]: [&HullAnswer; 2],
    size: f64,
) {
    case.answer = in_words(cold);
    for (how, answer) in [("", cold), ("warm: ", warm)] {
        let faults = faults_beside(a, b, map, answer, (truth.meets, truth.distance()));
        case.faults.extend(faults.into_iter().map(|fault| format!("{how}{fault}")));
        if answer.relation == Relation::Separated && !truth.meets {
            let [p, q] = answer.points;
            let error = error_of_root(p.distance(q), &truth.squared).abs() / size;
            case.figure = Some(case.figure.unwrap_or(0.0).max(error));
        }
    }
    if warm.relation != cold.relation {
        case.faults.push(format!("with memory: {:?}", warm.relation));
    }
    let is_small = |body: &Body| (1..=SMALL).contains(&body.hull.triangle_count());
    let is_judged = cold.relation == Relation::Penetrating && is_small(a) && is_small(b);
    if is_judged && [a, b].iter().all(|body| body.hull.kind() == HullKind::Volume) {
        let least = brute_force_depth(a, b, map);
        let reported = -cold.separation.lo.max(warm.separation.lo);
        if reported < least - rounding(a, b, map) {
            case.faults.push(format!("{reported:e} deep, but parting them takes {least:e}"));
        }
    }
}

fn reach(body: &Body) -> f64 {
    body.hull.positions().iter().map(|p| p.length()).fold(0.0, f64::max)
}

fn words(meets: bool, distance: f64) -> String {
    match meets {
        true => "meet".to_owned(),
        false => format!("apart by {distance:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull_judge::at;

    fn faults(x: f64, alter: impl Fn(&mut HullAnswer)) -> Vec<String> {
        let (a, b, map) = (cuboid(DVec3::ONE), cuboid(DVec3::splat(0.5)), at(x, 0.125, 0.25));
        let truth = HullTruth::of(&a, &b, &map, DVec3::X);
        let mut answer = walked([&a, &b], &map, &mut Default::default(), &mut Default::default())
            .expect("boxes");
        alter(&mut answer);
        let mut case = Case::default();
        judge(&mut case, [&a, &b], &map, &truth, [&answer, &answer], 2.0);
        case.faults
    }

    #[test]
    fn a_wrong_relation_distance_or_depth_is_a_fault() {
        for x in [1.25, 1.5, 1.75] {
            assert_eq!(faults(x, |_| {}), [""; 0], "{x}");
            let other = |relation| move |answer: &mut HullAnswer| answer.relation = relation;
            assert!(x > 1.5 || !faults(x, other(Relation::Separated)).is_empty());
            assert!(x <= 1.5 || !faults(x, other(Relation::Touching)).is_empty());
        }
        let shallow = faults(1.25, |answer| answer.separation.lo = -0.125);
        assert!(shallow.iter().any(|fault| fault.contains("parting them takes 2.5e-1")));
        assert!(!faults(1.75, |answer| answer.points[0].x -= 0.5).is_empty());
    }
}
