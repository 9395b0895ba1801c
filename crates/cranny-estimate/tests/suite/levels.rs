//! No level and no budget excludes what `Exact` finds, warm or cold; and what a budget leaves open
//! is narrowed from frame to frame.

use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use cranny_estimate::{
    Accuracy, Budget, Clock, Effort, Estimate, EstimateMemory, Verdict, estimate,
};
use cranny_exact::{Aabb, DQuat, DVec3, Interval, Meeting, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{
    Answer, Containment, Demand, Mismatch, PairMemory, Placed, Query, query,
};
use cranny_shapes::{Cuboid, Cup, GolfBall, PyramidInCavity, Sphere, Torus};
use cranny_testkit::{Rng, Walk, from_surface, model, shape, small_models, world_triangles};

/// The answer without memory.
fn ask(a: Placed, b: Placed, demand: Demand) -> Answer {
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

const LEVELS: [Accuracy; 9] = [
    Accuracy::Boxes,
    Accuracy::Hulls,
    Accuracy::Caps,
    Accuracy::Tree(0),
    Accuracy::Tree(3),
    Accuracy::Tree(6),
    Accuracy::Tree(9),
    Accuracy::Tree(255),
    Accuracy::Exact,
];

/// Those that are queried warm and cold, and such as only levels distinguish.
fn bodies() -> Vec<(&'static str, Model)> {
    let mut bodies = small_models();
    bodies.extend([
        ("pyramid in a well", shape(PyramidInCavity::default())),
        ("cup with full leaves", full_leaves(&shape(Cup { segments: 9, ..Cup::default() }))),
        ("well with full leaves", full_leaves(&shape(PyramidInCavity::default()))),
    ]);
    bodies
}

/// The same body, with leaves that hold faces on the hull and others.
fn full_leaves(model: &Model) -> Model {
    let options = BuildOptions { leaf_size: 5, ..BuildOptions::default() };
    Model::build(model.mesh().clone(), &options).unwrap().0
}

fn budgets(rng: &mut Rng) -> Budget<'static> {
    match rng.below(8) {
        0 => Budget::Tests(0),
        1 => Budget::Tests(1),
        2 => Budget::Tests(2 + rng.below(30) as u64),
        3 => Budget::Tests(30 + rng.below(300) as u64),
        4 => Budget::Tests(1_000),
        5 => Budget::Tests(u64::MAX),
        6 => Budget::Until { clock: &TICKS, deadline_ns: 0 },
        _ => Budget::Unlimited,
    }
}

/// Goes on by one whenever it is read.
struct Ticks(AtomicU64);

impl Clock for Ticks {
    fn now_ns(&self) -> u64 {
        self.0.fetch_add(1, Ordering::Relaxed)
    }
}

static TICKS: Ticks = Ticks(AtomicU64::new(0));

/// The same budget, or one that ends when the clock has been read a few times more.
fn begun(budget: Budget<'static>, rng: &mut Rng) -> Budget<'static> {
    match budget {
        Budget::Until { clock, .. } => {
            Budget::Until { clock, deadline_ns: clock.now_ns() + rng.below(30) as u64 }
        }
        budget => budget,
    }
}

fn meets(exact: &Answer) -> bool {
    exact.solid || exact.surface.meets()
}

/// What exact answers to the widest demand tell, all of it; `contacts` are those for a solver.
struct Truth {
    regions: Answer,
    contacts: Answer,
    margin: f64,
}

impl Truth {
    fn of(a: Placed, b: Placed, margin: f64) -> Self {
        Self {
            regions: ask(a, b, Demand::Regions { margin }),
            contacts: ask(a, b, Demand::contacts(margin)),
            margin,
        }
    }

    /// Whether an estimate claims nothing that is not so.
    fn check(&self, found: &Estimate, demand: Demand, what: &str) {
        let exact = &self.regions;
        match found.verdict {
            Verdict::Certain => assert!(meets(exact), "{what}: {found:?}"),
            Verdict::Excluded => assert!(!meets(exact), "{what}: {found:?}"),
            Verdict::Open => {}
        }
        assert!(found.surface.is_none_or(|s| s == exact.surface), "{what}: {found:?}");
        assert!(found.solid.is_none_or(|s| s == exact.solid), "{what}: {found:?}");
        match (found.solid, found.surface) {
            (Some(_), Some(Meeting::None)) => {
                assert_eq!(found.contained, exact.contained, "{what}");
            }
            _ => assert_eq!(found.contained, None, "{what}"),
        }
        let held = found.separation;
        assert!(held.lo <= held.hi, "{what}: {held:?}");
        if demand.margin().is_some() {
            let depth = exact.separation;
            assert!(held.lo <= depth.hi && depth.lo <= held.hi, "{what}: {depth:?} in {held:?}");
            self.check_places(found, what);
        } else {
            let distance = exact.distance.unwrap();
            assert!(held.contains(distance), "{what}: {distance:e} in {held:?}");
            assert!(found.answer.is_some() || held.hi.is_finite(), "{what}: {held:?}");
            assert!(found.places.is_empty() && held.lo >= 0.0, "{what}");
        }
    }

    fn check_places(&self, found: &Estimate, what: &str) {
        if found.answer.is_some() {
            return;
        }
        let held_by =
            |place: &Aabb, points: &[DVec3]| points.iter().all(|&p| place.contains_point(p));
        let covered = |points: &[DVec3]| found.places.iter().any(|p| held_by(&p.bounds, points));
        for contact in self.regions.contacts.iter().chain(&self.contacts.contacts) {
            let pair = [contact.point_a, contact.point_b];
            if contact.separation > 0.0 && contact.separation < self.margin {
                assert!(covered(&pair), "{what}: {contact:?} lies in no place of {found:?}");
            }
        }
        for point in self.regions.regions.iter().flat_map(|r| &r.curves).flat_map(|c| &c.points) {
            // Curves may have been read beside a special position.
            let tiny = 1e-8 * (1.0 + point.length());
            let near = found.places.iter().any(|p| p.bounds.grown(tiny).contains_point(*point));
            assert!(near, "{what}: {point} on a curve lies in no place");
        }
        assert!(
            found.places.windows(2).all(|w| w[0].separation.lo <= w[1].separation.lo),
            "{what}"
        );
    }
}

fn witnesses_are_near_enough(a: Placed, b: Placed, found: &Estimate, what: &str) {
    let Some([p, q]) = found.witnesses.map(|w| w.map(|w| w.point)) else { return };
    let tiny = 1e-13 * (a.model.radius() + b.model.radius() + 4.0);
    assert!(from_surface(p, &world_triangles(a.model, &a.pose)) <= tiny, "{what}: {p}");
    assert!(from_surface(q, &world_triangles(b.model, &b.pose)) <= tiny, "{what}: {q}");
}

fn demand(rng: &mut Rng, margin: f64) -> Demand {
    match rng.below(5) {
        0 => Demand::Intersects,
        1 => Demand::Distance { below: None },
        2 => Demand::Distance { below: Some(margin) },
        3 => Demand::contacts(margin),
        _ => Demand::Regions { margin },
    }
}

#[test]
fn no_level_or_budget_excludes_what_exact_finds() {
    let bodies = bodies();
    let mut rng = Rng::new(17);
    let mut verdicts = [[0u32; 3]; LEVELS.len()];
    let (mut contained, mut places, mut timed) = (0, 0, [0u32; 2]);
    for round in 0..66 {
        let (name_a, a) = &bodies[round % bodies.len()];
        // A speck in another's middle, where that one has material there: what chance rarely
        // brings.
        let within = name_a == &"golf ball";
        let speck = bodies.iter().position(|(name, _)| *name == "speck").unwrap();
        let (name_b, b) = &bodies[if within { speck } else { rng.below(bodies.len()) }];
        let reach = a.radius() + b.radius();
        let at = Pose {
            rotation: DQuat::from_axis_angle(rng.direction(), 1.0),
            translation: DVec3::ONE,
        };
        let mut walk = Walk::new(&mut rng, reach);
        if within {
            walk.pose.translation = 0.1 * reach * rng.direction();
        }
        let margin = [0.0, 1e-3, 0.05][rng.below(3)] * reach;
        // Some walks keep to one level and one budget, others change.
        let habit = (round % 3 != 0).then(|| (rng.below(LEVELS.len()), budgets(&mut rng)));
        let mut memory = EstimateMemory::default();
        for frame in 0..25 {
            walk.step(&mut rng, reach);
            if rng.below(20) == 0 {
                memory.clear();
            }
            let placed_a = Placed { model: a, pose: at };
            let placed_b = Placed { model: b, pose: at.compose(&walk.pose) };
            let truth = Truth::of(placed_a, placed_b, margin);
            for _ in 0..3 {
                let (level, budget) =
                    habit.unwrap_or_else(|| (rng.below(LEVELS.len()), budgets(&mut rng)));
                let budget = begun(budget, &mut rng);
                let effort = Effort { accuracy: LEVELS[level], budget };
                let demand = demand(&mut rng, margin);
                let cold = rng.below(3) == 0;
                let swapped = rng.below(4) == 0;
                let mut fresh = EstimateMemory::default();
                let memory = if cold { &mut fresh } else { &mut memory };
                let what = format!(
                    "{name_a} and {name_b}, round {round}, frame {frame}, {effort:?}, {demand:?}, cold: {cold}, swapped: {swapped}"
                );
                let question = Query::of(demand);
                let found = if swapped {
                    swapped_back(estimate(placed_b, placed_a, &question, &effort, memory).unwrap())
                } else {
                    estimate(placed_a, placed_b, &question, &effort, memory).unwrap()
                };
                truth.check(&found, demand, &what);
                if frame % 4 == 0 {
                    witnesses_are_near_enough(placed_a, placed_b, &found, &what);
                }
                if let Budget::Tests(tests) = budget {
                    assert!(found.counters.tests() <= tests, "{what}: {:?}", found.counters);
                }
                if let Budget::Until { deadline_ns, .. } = budget {
                    timed[usize::from(TICKS.0.load(Ordering::Relaxed) > deadline_ns)] += 1;
                }
                verdicts[level][found.verdict as usize] += 1;
                contained += u32::from(found.contained.is_some());
                places += found.places.len();
            }
        }
    }
    for (level, counts) in LEVELS.iter().zip(verdicts) {
        assert!(counts[Verdict::Excluded as usize] > 10, "{level:?}: {verdicts:?}");
        assert!(counts[Verdict::Open as usize] > 10, "{level:?}: {verdicts:?}");
    }
    assert!(timed.iter().all(|&times| times > 50), "in time, and late: {timed:?}");
    let certain = verdicts.map(|counts| counts[Verdict::Certain as usize]);
    assert!(certain[LEVELS.len() - 1] > 40, "{certain:?}");
    assert!(contained > 5 && places > 1_000, "{contained} {places}");
}

fn swapped_back(found: Estimate) -> Estimate {
    Estimate {
        contained: found.contained.map(Containment::swapped),
        witnesses: found.witnesses.map(|[a, b]| [b, a]),
        answer: found.answer.map(Answer::swapped),
        ..found
    }
}

#[test]
fn what_a_budget_leaves_open_is_narrowed_until_it_is_exact() {
    let bodies = bodies();
    let mut rng = Rng::new(23);
    for round in 0..24 {
        let a = &bodies[round % bodies.len()].1;
        let b = &bodies[rng.below(bodies.len())].1;
        let reach = a.radius() + b.radius();
        let walk = Walk::new(&mut rng, reach);
        let (a, b) =
            (Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose: walk.pose });
        for demand in [Demand::Intersects, Demand::Distance { below: None }] {
            let exact = ask(a, b, demand);
            let mut memory = EstimateMemory::default();
            let mut held = Interval::WHOLE;
            let mut frames = 0;
            loop {
                let found =
                    estimate(a, b, &Query::of(demand), &Effort::tests(60), &mut memory).unwrap();
                let now = found.separation;
                assert!(held.lo <= now.lo && now.hi <= held.hi, "{held:?} then {now:?}");
                held = now;
                frames += 1;
                if found.counters.tests() < 8 {
                    // Nothing was left to do.
                    let closed = if meets(&exact) { Verdict::Certain } else { Verdict::Excluded };
                    assert_eq!(found.verdict, closed);
                    if demand != Demand::Intersects {
                        let rounding = 1e-12 * (reach + walk.pose.translation.length());
                        assert!(held.width() <= rounding, "{held:?}");
                        if exact.surface == Meeting::None {
                            assert_eq!(found.witnesses, exact.witnesses);
                        }
                    }
                    break;
                }
                assert!(frames < 400, "{demand:?}: {found:?}");
            }
        }
    }
}

#[test]
fn a_slow_body_is_known_better_frame_by_frame_for_the_same_budget() {
    let ball = shape(GolfBall { dimples: 36, triangles: 2_000, ..GolfBall::default() });
    let question = Query::of(Demand::Distance { below: None });
    let mut memory = EstimateMemory::default();
    let (mut warm, mut cold) = (Vec::new(), Vec::new());
    for frame in 0..60 {
        let turn = DQuat::from_axis_angle(DVec3::Y, 1e-4 * f64::from(frame));
        let pose = Pose { rotation: turn, translation: DVec3::new(1.2, 1.3, 1.1) };
        let (a, b) = (Placed { model: &ball, pose: Pose::IDENTITY }, Placed { model: &ball, pose });
        let width = |memory: &mut EstimateMemory| {
            let found = estimate(a, b, &question, &Effort::tests(100), memory).unwrap();
            assert!(found.separation.contains(ask(a, b, question.demand).distance.unwrap()));
            found.separation.width()
        };
        warm.push(width(&mut memory));
        cold.push(width(&mut EstimateMemory::default()));
    }
    assert_eq!(warm[0], cold[0]);
    assert!(warm[20] < 0.5 * cold[20] && cold.iter().all(|w| *w > 0.05), "{warm:?}, {cold:?}");
    // What a hundred tests cannot find in one frame, they find in fifty, and keep.
    assert!(warm[50..].iter().all(|w| *w < 1e-12), "{warm:?}");
}

#[test]
fn poses_far_from_each_other_cost_no_more_with_memory_and_leave_no_more_open() {
    let ball = shape(GolfBall { dimples: 36, triangles: 2_000, ..GolfBall::default() });
    let torus = shape(Torus::default());
    let question = Query::of(Demand::Distance { below: None });
    let levels = [Accuracy::Tree(6), Accuracy::Tree(12)].map(Effort::of);
    let budgets = [100, 1_000, 10_000, 1_000_000].map(Effort::tests);
    for effort in levels.iter().chain(&budgets) {
        let mut rng = Rng::new(7);
        let mut memory = EstimateMemory::default();
        let (mut tests, mut open) = ([0u64; 2], [0; 2]);
        for _ in 0..60 {
            let translation = 2.5 * rng.unit() * rng.direction();
            let pose = Pose { rotation: rng.rotation(), translation };
            let (a, b) =
                (Placed { model: &torus, pose: Pose::IDENTITY }, Placed { model: &ball, pose });
            for (i, memory) in [&mut EstimateMemory::default(), &mut memory].into_iter().enumerate()
            {
                let found = estimate(a, b, &question, effort, memory).unwrap();
                tests[i] += found.counters.node_tests + found.counters.triangle_tests;
                open[i] += u32::from(found.verdict == Verdict::Open);
            }
        }
        let [cold, warm] = tests.map(|tests| tests as f64);
        assert!(warm <= 1.2 * cold && open[1] <= open[0], "{effort:?}: {tests:?}, {open:?}");
    }
}

#[test]
fn effort_without_limits_is_the_query() {
    let (cup, ball) = (shape(Cup::default()), shape(Sphere::default()));
    let (a, b) = (
        Placed { model: &cup, pose: Pose::IDENTITY },
        Placed { model: &ball, pose: Pose::at(DVec3::new(0.3, 0.2, 0.9)) },
    );
    for demand in [Demand::Intersects, Demand::contacts(0.1), Demand::Regions { margin: 0.0 }] {
        let mut memory = EstimateMemory::default();
        let found = estimate(a, b, &Query::of(demand), &Effort::default(), &mut memory).unwrap();
        let answer = found.answer.unwrap();
        assert_eq!(Mismatch::between(&answer, &ask(a, b, demand)), None);
        assert_eq!((found.surface, found.solid), (Some(Meeting::Cross), Some(true)));
    }
}

#[test]
fn two_cubes_level_by_level() {
    let cube = shape(Cuboid::default());
    let at = |x: f64, y: f64| {
        let pose = Pose::at(DVec3::new(x, y, 0.25));
        (Placed { model: &cube, pose: Pose::IDENTITY }, Placed { model: &cube, pose })
    };
    let reported = |(a, b): (Placed, Placed), level| {
        let question = Query::of(Demand::Distance { below: None });
        estimate(a, b, &question, &Effort::of(level), &mut EstimateMemory::default()).unwrap()
    };
    // Half an edge apart: boxes know it from below, but for rounding; hulls from corner to corner.
    let apart = at(1.5, 0.25);
    for level in LEVELS {
        let found = reported(apart, level);
        assert_eq!(found.verdict, Verdict::Excluded, "{level:?}");
        assert!((found.separation.lo - 0.5).abs() < 1e-12, "{level:?}: {found:?}");
    }
    let corners = reported(apart, Accuracy::Hulls).separation.hi;
    assert!(corners > 0.5 && corners < 1.0, "{corners}");
    assert!((reported(apart, Accuracy::Caps).separation.hi - 0.5).abs() < 1e-12);
    // Overlapping: boxes and hulls cannot be certain, faces can.
    for level in [Accuracy::Boxes, Accuracy::Hulls] {
        assert_eq!(reported(at(0.5, 0.25), level).verdict, Verdict::Open, "{level:?}");
    }
    for level in [Accuracy::Caps, Accuracy::Tree(9), Accuracy::Exact] {
        assert_eq!(reported(at(0.5, 0.25), level).verdict, Verdict::Certain, "{level:?}");
    }
}

#[test]
fn what_lies_in_a_pocket_is_open_until_boxes_are_small_enough() {
    let cup = shape(Cup { segments: 24, ..Cup::default() });
    let speck = shape(Cuboid { size: [0.06, 0.05, 0.04] });
    let middle = cup.bounds().center() + 0.1 * cup.bounds().half_extents();
    let (a, b) = (
        Placed { model: &cup, pose: Pose::IDENTITY },
        Placed { model: &speck, pose: Pose::at(middle) },
    );
    assert!(!meets(&ask(a, b, Demand::Intersects)));
    let verdict = |level| {
        let effort = Effort::of(level);
        estimate(a, b, &Query::of(Demand::Intersects), &effort, &mut EstimateMemory::default())
            .unwrap()
            .verdict
    };
    for level in [Accuracy::Boxes, Accuracy::Hulls, Accuracy::Tree(1)] {
        assert_eq!(verdict(level), Verdict::Open, "{level:?}");
    }
    assert_eq!(verdict(Accuracy::Tree(10)), Verdict::Excluded);
    assert_eq!(verdict(Accuracy::Exact), Verdict::Excluded);
}

#[test]
fn faces_off_the_hull_stay_closed_for_caps_in_whatever_leaf_they_are() {
    // A void in a tetrahedron, all in one leaf; what meets its faces meets no face on the hull.
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let small = corners.map(|p| 0.1 * p + DVec3::splat(0.2));
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let inner = faces.map(|[u, v, w]| [u + 4, w + 4, v + 4]);
    let mesh = Mesh::new([corners, small].concat(), [faces, inner].concat()).unwrap();
    let options = BuildOptions { leaf_size: 8, ..BuildOptions::default() };
    let hollow = Model::build(mesh, &options).unwrap().0;
    let speck = shape(Cuboid { size: [0.06, 0.05, 0.04] });
    let (a, b) = (
        Placed { model: &hollow, pose: Pose::IDENTITY },
        Placed { model: &speck, pose: Pose::at(DVec3::new(0.21, 0.22, 0.23)) },
    );
    for demand in [Demand::Intersects, Demand::Distance { below: None }] {
        let mut memory = EstimateMemory::default();
        let mut ask = |effort: Effort| {
            let found = estimate(a, b, &Query::of(demand), &effort, &mut memory).unwrap();
            (found.verdict, found.surface, found.separation.lo)
        };
        assert_eq!(ask(Effort::of(Accuracy::Caps)), (Verdict::Open, None, 0.0));
        let expected = (Verdict::Certain, Some(Meeting::Cross), 0.0);
        assert_eq!(ask(Effort::tests(1_000)), expected);
    }
}

#[test]
fn a_body_that_jumps_out_of_another_is_no_longer_inside() {
    let torus = shape(Torus { major_segments: 18, minor_segments: 8, ..Torus::default() });
    let speck = shape(Cuboid { size: [0.06, 0.05, 0.04] });
    let (bounds, mut memory) = (torus.bounds(), EstimateMemory::default());
    let tube = DVec3::new(bounds.max.x - 0.5 * (bounds.max.z - bounds.min.z), 0.0, 0.0);
    // Within the tube, in the hole, back, and a little along the tube.
    let frames = [(tube, true), (DVec3::ZERO, false), (tube, true), (1.0001 * tube, true)];
    for (translation, inside) in frames {
        let (a, b) = (
            Placed { model: &torus, pose: Pose::IDENTITY },
            Placed { model: &speck, pose: Pose::at(translation) },
        );
        let effort = Effort::tests(100_000);
        let found = estimate(a, b, &Query::of(Demand::Intersects), &effort, &mut memory).unwrap();
        let expected = if inside { Verdict::Certain } else { Verdict::Excluded };
        assert_eq!((found.verdict, found.surface), (expected, Some(Meeting::None)));
        assert_eq!(found.contained, inside.then_some(Containment::BInA));
        let still = translation.x > tube.x;
        assert_eq!(found.counters.inside_tests == 0, still, "{:?}", found.counters);
    }
}

/// Moves on by a microsecond whenever it is read.
struct Steps(Cell<u64>);

impl Clock for Steps {
    fn now_ns(&self) -> u64 {
        self.0.replace(self.0.get() + 1_000)
    }
}

#[test]
fn a_clock_ends_the_work_and_what_is_told_is_certain() {
    let torus = shape(Torus::default());
    let pose =
        Pose { rotation: DQuat::from_rotation_x(1.0), translation: DVec3::new(0.8, 0.9, 0.1) };
    let (a, b) = (Placed { model: &torus, pose: Pose::IDENTITY }, Placed { model: &torus, pose });
    let exact = ask(a, b, Demand::Distance { below: None }).distance.unwrap();
    let mut widths = Vec::new();
    for deadline_ns in [0, 2_000, 10_000, u64::MAX] {
        let clock = Steps(Cell::new(0));
        let budget = Budget::Until { clock: &clock, deadline_ns };
        let effort = Effort { accuracy: Accuracy::Exact, budget };
        let question = Query::of(Demand::Distance { below: None });
        let found = estimate(a, b, &question, &effort, &mut EstimateMemory::default()).unwrap();
        assert!(found.separation.contains(exact));
        assert!(
            found.counters.tests() <= 32 * (deadline_ns / 1_000).min(1 << 20) + 2,
            "{deadline_ns}"
        );
        widths.push(found.separation.width());
    }
    assert!(widths.windows(2).all(|w| w[1] <= w[0]) && widths[3] < 1e-12, "{widths:?}");
}

#[test]
fn what_is_told_scales_with_the_bodies() {
    // Of two equal bodies the pose decides which is first, and scaling keeps that.
    let cup = shape(Cup { segments: 12, ..Cup::default() });
    for power in [-190, -40, 60] {
        let factor = 2f64.powi(power);
        let large = model(cup.mesh().scaled(DVec3::splat(factor)).unwrap());
        for level in LEVELS {
            for x in [1.3, 0.9, 0.4] {
                let reported = |cup: &Model, scale: f64| {
                    let rotation = DQuat::from_xyzw(0.1, 0.2, -0.3, 0.9).normalize();
                    let translation = scale * DVec3::new(x, 0.3, 0.2);
                    let (a, b) = (
                        Placed { model: cup, pose: Pose::IDENTITY },
                        Placed { model: cup, pose: Pose { rotation, translation } },
                    );
                    let question = Query::of(Demand::Distance { below: None });
                    let effort = Effort { accuracy: level, budget: Budget::Tests(500) };
                    estimate(a, b, &question, &effort, &mut EstimateMemory::default()).unwrap()
                };
                let (here, there) = (reported(&cup, 1.0), reported(&large, factor));
                let what = format!("{level:?}, {power}, {x}");
                assert_eq!((here.verdict, here.surface), (there.verdict, there.surface), "{what}");
                let ends = |held: Interval| [held.lo, held.hi];
                for (x, y) in ends(here.separation).into_iter().zip(ends(there.separation)) {
                    assert!((x * factor - y).abs() <= 1e-12 * factor, "{what}: {x} and {y}");
                }
            }
        }
    }
}

#[test]
fn what_is_no_question_is_refused_as_by_the_query() {
    let cube = shape(Cuboid::default());
    let at = |x| Placed { model: &cube, pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
    for (x, demand) in [
        (f64::NAN, Demand::Intersects),
        (1e300, Demand::Intersects),
        (0.0, Demand::Distance { below: Some(-1.0) }),
        (0.0, Demand::contacts(f64::INFINITY)),
    ] {
        let question = Query::of(demand);
        let refused = query(at(0.0), at(x), &question, &mut PairMemory::default()).unwrap_err();
        for effort in [Effort::default(), Effort::of(Accuracy::Boxes), Effort::tests(9)] {
            let found =
                estimate(at(0.0), at(x), &question, &effort, &mut EstimateMemory::default());
            assert_eq!(found.unwrap_err().to_string(), refused.to_string());
        }
    }
    let nothing = Query::of(Demand::None);
    let memory = &mut EstimateMemory::default();
    let found = estimate(at(0.0), at(9.0), &nothing, &Effort::tests(9), memory).unwrap();
    assert_eq!((found.verdict, found.counters.tests()), (Verdict::Open, 0));
}

#[test]
fn what_was_prepared_changes_nothing_but_the_time() {
    let (cup, torus) = (shape(Cup::default()), shape(Torus::default()));
    let (a, b) = (
        Placed { model: &torus, pose: Pose::IDENTITY },
        Placed { model: &cup, pose: Pose::at(DVec3::new(0.4, 1.9, 0.3)) },
    );
    for level in LEVELS {
        let mut memory = EstimateMemory::default();
        memory.prepare(&torus, &cup, level);
        let question = Query::of(Demand::Distance { below: None });
        let found = estimate(a, b, &question, &Effort::of(level), &mut memory).unwrap();
        let cold = estimate(a, b, &question, &Effort::of(level), &mut EstimateMemory::default());
        assert_eq!(Ok(found), cold, "{level:?}");
    }
}

#[test]
fn memory_of_other_models_means_nothing_and_is_let_go() {
    let bodies = bodies();
    let mut memory = EstimateMemory::default();
    let question = Query::of(Demand::Distance { below: None });
    for i in 0..30 {
        let (a, b) = (&bodies[i % bodies.len()].1, &bodies[(i * i) % bodies.len()].1);
        let reach = a.radius() + b.radius();
        let (a, b) = (
            Placed { model: a, pose: Pose::IDENTITY },
            Placed { model: b, pose: Pose::at(DVec3::new(reach, 0.1, 0.2)) },
        );
        let effort = Effort { accuracy: LEVELS[i % LEVELS.len()], budget: Budget::Tests(90) };
        let warm = estimate(a, b, &question, &effort, &mut memory).unwrap();
        let cold = estimate(a, b, &question, &effort, &mut EstimateMemory::default()).unwrap();
        assert_eq!(warm, cold);
    }
    assert!(memory.bytes() > 0);
    memory.clear();
    assert_eq!(memory.bytes(), 0);
}
