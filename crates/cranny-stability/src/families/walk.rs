//! The closest-feature walk over hulls.

use cranny_exact::{DVec3, Pose, RigidMap};
use cranny_narrow_phase::walk::{HullAnswer, Relation, WalkCounters, WalkState, walk_hulls};

use crate::case::Case;
use crate::family::Family;
use crate::hull_judge::{Body, brute_force, cuboid, disk, faults, platonic_solids, sphere};
use crate::pair::peer_case;
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "walk",
    asked: "How two convex hulls lie: platonic solids, disks, spheres of points, needles and plates, anyhow; nearly \
            parallel, turned by 10^-12 to 10^-3 radians; slid together until f64 has nothing left between apart and \
            not; 10^-6 to 10^6 large.",
    made: "Brute force over all pairs of exact triangles tells whether they meet and how far they are apart; exact \
           rationals check that the normal told proves the lower end of the separation.",
    fails: "a wrong relation; an interval that does not hold the distance, or is wide; points that are not as far \
            apart; a bound without proof; another relation with memory than without",
    figure: "width of the interval of hulls that are apart, in sizes of the larger",
    cases,
};

/// Width of a needle of length 2, and how far a plate bulges. Other values make other cases; none decides
/// anything.
const NEEDLE: f64 = 1e-9;
const PLATE: f64 = 1e-12;

/// A gap between faces that are nearly parallel; likewise.
const NEAR: f64 = 1e-6;

fn bodies() -> Vec<(&'static str, Body)> {
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
        ("needle", Body::of(&needle)),
        ("plate", Body::of(&plate(PLATE))),
    ]);
    bodies
}

fn cases(trial: &mut Trial<'_>) {
    let bodies = bodies();
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
            let scaled = |body: &Body| {
                Body::of(&body.hull.positions().iter().map(|&p| scale * p).collect::<Vec<_>>())
            };
            let (a, b) = (scaled(a), scaled(b));
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
    Pose { rotation: trial.rotation(), translation: distance * trial.direction() }
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
    let (rotation, direction) = (trial.rotation(), trial.direction());
    let pose = |d: f64| Pose { rotation, translation: d * direction };
    let mut state = WalkState::default();
    let (mut low, mut high) = (0.0, 6.0);
    while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        match walked(bodies, &pose(middle).world_from_body(), &mut state, counters) {
            Some(HullAnswer { relation: Relation::Separated, .. }) => high = middle,
            _ => low = middle,
        }
    }
    for d in [low, high] {
        let name = format!("{names}, {d:?} along a line");
        ask(trial, name, bodies, pose(d), &mut state, counters);
    }
}

fn walked(
    [a, b]: [&Body; 2],
    map: &RigidMap,
    state: &mut WalkState,
    counters: &mut WalkCounters,
) -> Option<HullAnswer> {
    walk_hulls(a.walkable(), b.walkable(), map, state, counters).ok()
}

/// One question: with memory and without.
fn ask(
    trial: &mut Trial<'_>,
    name: String,
    [a, b]: [&Body; 2],
    pose: Pose,
    state: &mut WalkState,
    counters: &mut WalkCounters,
) {
    let map = pose.world_from_body();
    let (meets, distance) = brute_force(a, b, &map);
    let mut case = Case { name, truth: words(meets, distance), ..Case::default() };
    let warm = walked([a, b], &map, state, counters);
    let cold = walked([a, b], &map, &mut WalkState::default(), counters);
    let size = 2.0 * reach(a).max(reach(b));
    match (warm, cold) {
        (Some(warm), Some(cold)) => {
            case.told = format!("{:?}, {:?}", cold.relation, cold.separation);
            case.faults = faults(a, b, &map, &cold);
            case.faults.extend(faults(a, b, &map, &warm).into_iter().map(|f| format!("warm: {f}")));
            if warm.relation != cold.relation {
                case.faults.push(format!("with memory: {:?}", warm.relation));
            }
            if cold.relation == Relation::Separated {
                case.figure = Some(cold.separation.width().max(warm.separation.width()) / size);
            }
        }
        _ => case.faults.push("refused".to_owned()),
    }
    trial.count(if meets { "meeting" } else { "apart" }, 1);
    if let Some(peer) = trial.peer.as_mut() {
        let told = peer.hulls([a, b].map(|body| body.hull.positions()), pose);
        // Whether hulls that touch to rounding meet is for exact arithmetic to say.
        let near = distance <= f64::EPSILON * size;
        case.peer = Some(peer_case(told, (!near || !meets).then_some(meets), distance, size));
    }
    trial.push(case);
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
