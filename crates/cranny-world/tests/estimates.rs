//! Levels and budgets of a world: nothing that exact answers find is excluded, the budget goes to
//! where it buys most, and what stands still becomes exact.

use cranny_exact::{DQuat, DVec3, Interval, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_shapes::{Cuboid, Cup, Hook, LPrism, Sphere, Torus};
use cranny_testkit::shape;
use cranny_world::description::{Accuracy, Effect};
use cranny_world::{BodyId, BodySpec, EstimateStats, StepReport, Verdict, World};
use proptest::prelude::*;

const WITHIN: f64 = 0.8;

const LEVELS: [Accuracy; 6] = [
    Accuracy::Boxes,
    Accuracy::Hulls,
    Accuracy::Caps,
    Accuracy::Tree(2),
    Accuracy::Tree(6),
    Accuracy::Exact,
];

fn torus() -> Model {
    shape(Torus { major_radius: 1.0, minor_radius: 0.2, major_segments: 24, minor_segments: 10 })
}

fn bodies() -> Vec<Model> {
    vec![
        torus(),
        torus(),
        shape(Hook::default()),
        shape(Cup { segments: 12, ..Cup::default() }),
        shape(LPrism::default()),
        shape(Cuboid { size: [0.6, 0.9, 0.3] }),
        shape(Sphere { radius: 0.5, ..Sphere::default() }),
    ]
}

/// All bodies, with an effect, at a level and within a budget.
fn world(effects: &[Effect], accuracy: Accuracy, budget: Option<u64>) -> World {
    let mut world = World::new();
    world.set_scene_effects(effects).unwrap();
    world.set_accuracy(accuracy);
    world.set_budget(budget);
    for (index, model) in bodies().into_iter().enumerate() {
        world.insert(BodySpec::new(index.to_string(), model)).unwrap();
    }
    world
}

/// What an exact report says of a pair is what an estimating one leaves possible.
fn check(exact: &StepReport, found: &StepReport, what: &str) {
    for (a, b) in &exact.touching {
        assert!(found.touching.contains(&(*a, *b)), "{what}: {a} and {b} touch, and are excluded");
    }
    for answer in &exact.answers {
        let estimate = found.estimate(answer.a, answer.b);
        let estimate = estimate.unwrap_or_else(|| panic!("{what}: {} {}", answer.a, answer.b));
        let meets = answer.answer.touches();
        match estimate.verdict {
            Verdict::Certain => assert!(meets, "{what}: {estimate:?}"),
            Verdict::Excluded => assert!(!meets, "{what}: {estimate:?}"),
            Verdict::Open => assert!(!estimate.is_settled || estimate.accuracy != Accuracy::Exact),
        }
        match answer.answer.distance {
            Some(distance) if distance.is_finite() => {
                assert!(estimate.separation.contains(distance), "{what}: {distance}, {estimate:?}");
            }
            Some(_) => assert!(estimate.separation.hi >= WITHIN, "{what}: {estimate:?}"),
            None => {}
        }
        if let (Some([p, q]), true) = (estimate.points, estimate.is_settled) {
            let distance = answer.answer.distance.filter(|_| estimate.accuracy == Accuracy::Exact);
            let off = distance.filter(|d| *d < WITHIN).map_or(0.0, |d| (q - p).length() - d);
            assert!(off.abs() < 1e-9, "{what}: {estimate:?}");
        }
    }
    assert_eq!(exact.answers.len(), found.estimates.len(), "{what}");
}

/// Where a body is after so many steps: it turns and swings, and stands still in every third phase.
fn place(body: u32, step: u32, seed: u64) -> Pose {
    let phase = f64::from(body) * 1.7 + (seed % 1000) as f64 * 0.37;
    let moving = step.min(step / 12 * 12 + 8); // eight steps on the way, four at rest
    let t = f64::from(moving) * (0.03 + 0.01 * f64::from(body % 3)) + phase;
    let place = DVec3::new((1.3 * t).sin(), (0.9 * t + phase).cos(), (0.7 * t).sin());
    let axis = DVec3::new(1.0, f64::from(body % 4), f64::from(body % 7)).normalize();
    Pose { translation: 1.2 * place, rotation: DQuat::from_axis_angle(axis, t) }
}

fn put(world: &mut World, step: u32, seed: u64) {
    let ids: Vec<BodyId> = world.bodies().map(|(id, _)| id).collect();
    ids.iter().for_each(|&id| world.set_pose(id, place(id.0, step, seed)).unwrap());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3))]

    /// Every level, every budget: what exact answers find is never excluded, intervals hold the
    /// distance, and the budget is kept to.
    #[test]
    fn no_level_and_no_budget_excludes_what_exact_finds(seed in any::<u64>()) {
        let near = Effect::proximity(WITHIN);
        for effects in [vec![Effect::TRIGGER], vec![Effect::TRIGGER, near]] {
            let mut exact = world(&effects, Accuracy::Exact, None);
            let budgets = [None, Some(0), Some(7), Some(150), Some(1_500)];
            let mut worlds: Vec<(World, Accuracy, Option<u64>, usize)> = LEVELS
                .iter()
                .flat_map(|&level| budgets.map(|budget| (level, budget)))
                .filter(|&(level, budget)| level != Accuracy::Exact || budget.is_some())
                .map(|(level, budget)| (world(&effects, level, budget), level, budget, 0))
                .collect();
            for step in 0..24 {
                put(&mut exact, step, seed);
                let expected = exact.step().unwrap();
                prop_assert!(expected.estimates.is_empty());
                for (world, level, budget, decided) in &mut worlds {
                    put(world, step, seed);
                    let found = world.step().unwrap();
                    world.validate().unwrap();
                    let what = format!("step {step}, {level} within {budget:?}");
                    check(&expected, &found, &what);
                    let EstimateStats { tests, unsettled, pairs, open } = found.stats.estimates;
                    *decided += pairs - open;
                    let is_at_rest = step % 12 == 0 || step % 12 > 8;
                    match budget {
                        None => prop_assert_eq!(unsettled, 0, "{}", &what),
                        // One step of a pair that stands still overdraws it.
                        Some(budget) if is_at_rest && *budget > 0 => {
                            prop_assert!(tests <= 2 * *budget + 400, "{}: {}", &what, tests);
                        }
                        // A walk is not interrupted.
                        Some(budget) if matches!(level, Accuracy::Hulls | Accuracy::Caps) => {
                            prop_assert!(tests <= 2 * *budget + 400, "{}: {}", &what, tests);
                        }
                        Some(budget) => prop_assert!(tests <= *budget, "{}: {}", &what, tests),
                    }
                }
            }
            // What is never decided would pass all of the above.
            for (_, level, budget, decided) in &worlds {
                let is_fine = matches!(level, Accuracy::Caps | Accuracy::Tree(6) | Accuracy::Exact);
                if is_fine && budget.is_none_or(|budget| budget >= 1_500) {
                    prop_assert!(*decided > 0, "{} within {:?} decides nothing", level, budget);
                }
            }
        }
    }
}

/// Two rings, one through the other, none touching: the hardest of small pairs.
fn linked(world: &mut World, name: &str, at: DVec3) -> [BodyId; 2] {
    let model = torus();
    let turned = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let poses =
        [Pose::at(at), Pose { translation: at + DVec3::new(0.93, 0.02, 0.01), rotation: turned }];
    [0, 1].map(|i| {
        let spec = BodySpec::new(format!("{name} {i}"), model.clone());
        world.insert(BodySpec { pose: poses[i], ..spec }).unwrap()
    })
}

fn estimating(effects: &[Effect], budget: u64) -> World {
    let mut world = World::new();
    world.set_scene_effects(effects).unwrap();
    world.set_budget(Some(budget));
    world
}

/// The tests that a pair takes alone, without an end.
fn whole_cost(effects: &[Effect]) -> u64 {
    let mut world = estimating(effects, u64::MAX);
    linked(&mut world, "ring", DVec3::ZERO);
    let report = world.step().unwrap();
    assert!(report.estimates[0].is_settled);
    report.estimates[0].tests
}

#[test]
fn a_still_pair_becomes_exact_and_then_costs_nothing() {
    let effects = [Effect::TRIGGER, Effect::proximity(WITHIN)];
    let cost = whole_cost(&effects);
    let budget = 100;
    let mut world = estimating(&effects, budget);
    let [a, b] = linked(&mut world, "ring", DVec3::ZERO);
    let mut exact = world.clone();
    exact.set_budget(None);
    let truth = exact.step().unwrap().answers[0].answer.distance.unwrap();
    let mut widths = Vec::new();
    let settled = (1..).find(|_| {
        let report = world.step().unwrap();
        let found = report.estimate(a, b).unwrap();
        assert!(found.separation.contains(truth));
        widths.push(found.separation.hi - found.separation.lo);
        found.is_settled
    });
    // An estimate repeats a few tests as it begins, and ends before a step that it cannot afford.
    let most = 2 + cost.div_ceil(budget * 4 / 5);
    assert!(cost > 5 * budget, "it takes several steps: {cost}");
    assert!(settled.is_some_and(|steps| steps <= most), "{settled:?} of {most}: {widths:?}");
    assert!(widths.windows(2).all(|w| w[1] <= w[0]), "{widths:?}");
    assert!(widths.last().is_some_and(|width| *width < 1e-9), "{widths:?}");
    for _ in 0..3 {
        let report = world.step().unwrap();
        let found = report.estimate(a, b).unwrap();
        assert_eq!((found.tests, found.is_settled, found.verdict), (0, true, Verdict::Excluded));
    }
}

/// All faces of two planes are equally near: the distance is known before all were tested.
#[test]
fn the_distance_of_parallel_planes_closes() {
    let mut world = estimating(&[Effect::TRIGGER, Effect::proximity(WITHIN)], 150);
    for (name, x) in [("left", 0.0), ("right", 1.4)] {
        let spec = BodySpec::new(name, shape(Cuboid::default()));
        world.insert(BodySpec { pose: Pose::at(DVec3::X * x), ..spec }).unwrap();
    }
    let found = world.step().unwrap().estimates[0];
    assert!(found.is_settled && found.separation.contains(0.4), "{found:?}");
}

/// Ten pairs of cubes whose distances are known after a few tests, and one pair of rings.
#[test]
fn what_easy_pairs_leave_goes_to_the_hard_one() {
    let effects = [Effect::TRIGGER, Effect::proximity(WITHIN)];
    let budget = 4_000;
    let mut world = estimating(&effects, budget);
    let cube = shape(Cuboid::default());
    let mut cubes = Vec::new();
    for i in 0..20 {
        let x = 10.0 + 5.0 * f64::from(i / 2) + 1.4 * f64::from(i % 2);
        let spec = BodySpec::new(format!("cube {i}"), cube.clone());
        let pose = Pose { translation: DVec3::X * x, rotation: DQuat::from_rotation_y(0.3 * x) };
        cubes.push(world.insert(BodySpec { pose, ..spec }).unwrap());
    }
    let [a, b] = linked(&mut world, "ring", DVec3::ZERO);
    let report = world.step().unwrap();
    let easy = report.estimates.iter().filter(|estimate| (estimate.a, estimate.b) != (a, b));
    assert_eq!(easy.clone().count(), 10);
    assert!(easy.clone().all(|estimate| estimate.is_settled), "{report:?}");
    let of_easy: u64 = easy.map(|estimate| estimate.tests).sum();
    let hard = report.estimate(a, b).unwrap();
    assert!(of_easy < budget / 2 && hard.tests > budget / 2, "{of_easy}, {hard:?}");
    assert!(of_easy + hard.tests > budget * 9 / 10, "it is spent");
    // They move on and cost again; the rings get on.
    let width = hard.separation.hi - hard.separation.lo;
    for (i, &cube) in cubes.iter().enumerate() {
        let pose = world.body(cube).unwrap().pose();
        let on = DVec3::new(0.0, 0.01 * (i % 2) as f64, 0.0);
        world.set_pose(cube, Pose { translation: pose.translation + on, ..pose }).unwrap();
    }
    let report = world.step().unwrap();
    let hard = report.estimate(a, b).unwrap();
    assert!(hard.tests > budget / 2 && hard.separation.hi - hard.separation.lo < width);
}

/// Open verdicts come before distances: a budget that is too small for both decides the former.
#[test]
fn open_verdicts_come_before_wide_intervals() {
    let mut world = estimating(&[Effect::TRIGGER, Effect::proximity(WITHIN)], 60);
    let mut insert = |name: &str, model: &Model, x: f64| {
        let turned = DQuat::from_rotation_z(x);
        let pose = Pose { translation: DVec3::X * x, rotation: turned };
        world.insert(BodySpec { pose, ..BodySpec::new(name, model.clone()) }).unwrap()
    };
    let rings = [insert("one", &torus(), 20.0), insert("other", &torus(), 22.7)];
    // They are apart, as is known at once; how far takes many steps.
    let known = |report: &StepReport, [a, b]: [BodyId; 2]| *report.estimate(a, b).unwrap();
    let first = known(&world.step().unwrap(), rings);
    assert_eq!((first.verdict, first.is_settled), (Verdict::Excluded, false), "{first:?}");
    let cube = shape(Cuboid::default());
    let mut insert = |name: &str, x: f64| {
        let spec = BodySpec::new(name, cube.clone());
        world.insert(BodySpec { pose: Pose::at(DVec3::X * x), ..spec }).unwrap()
    };
    let cubes = [insert("left", 0.0), insert("right", 0.9)];
    let report = world.step().unwrap();
    let [of_cubes, of_rings] = [cubes, rings].map(|pair| known(&report, pair));
    assert_eq!((of_cubes.verdict, of_cubes.is_settled), (Verdict::Certain, true), "{of_cubes:?}");
    assert_eq!((of_rings.verdict, of_rings.is_settled), (Verdict::Excluded, false));
    // What the cubes leave goes on to the rings, and all of it once the cubes are still.
    let later = known(&world.step().unwrap(), rings);
    assert!(of_cubes.tests > 0 && later.tests > of_rings.tests, "{of_rings:?} {later:?}");
}

/// Many pairs, and a budget for a few: all of them get their turn.
#[test]
fn pairs_that_wait_longest_come_first() {
    let effects = [Effect::TRIGGER, Effect::proximity(WITHIN)];
    let (cost, count) = (whole_cost(&effects), 6);
    let budget = 128;
    let mut world = estimating(&effects, budget);
    for i in 0..count {
        linked(&mut world, &i.to_string(), DVec3::X * (10.0 * i as f64));
    }
    let mut served = vec![0; count];
    let steps = 3 + (count as u64 * cost).div_ceil(budget * 3 / 4);
    for step in 0..steps {
        let report = world.step().unwrap();
        for (times, estimate) in served.iter_mut().zip(&report.estimates) {
            *times += u64::from(estimate.tests > 0);
        }
        if step == 3 {
            assert!(served.iter().all(|&times| times > 0), "{served:?}");
        }
        if report.stats.estimates.unsettled == 0 {
            return;
        }
    }
    panic!("not all are exact after {steps} steps: {served:?}");
}

/// 80 cubes in one mesh: whether another body holds them takes a point of each, at once.
fn pieces() -> Model {
    let cubes = (0..80).map(|i| {
        let [x, y] = [i % 9, i / 9].map(|k| f64::from(k) * 0.4 - 1.6);
        cranny_testkit::bodies::cuboid([x, y, -0.1], [x + 0.2, y + 0.2, 0.1])
    });
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for cube in cubes {
        let first = vertices.len() as u32;
        vertices.extend_from_slice(cube.vertices());
        faces.extend(cube.faces().iter().map(|face| face.map(|v| v + first)));
    }
    cranny_testkit::model(Mesh::new(vertices, faces).unwrap())
}

/// More than a share, and the pair gets it all the same.
#[test]
fn a_body_of_many_pieces_gets_a_share_that_suffices() {
    let pieces = pieces();
    let mut world = estimating(&[Effect::TRIGGER], 128);
    let large = shape(Cuboid { size: [20.0; 3] });
    world.insert(BodySpec::new("large", large)).unwrap();
    for i in 0..3 {
        let pose = Pose::at(DVec3::Z * f64::from(i) * 3.0);
        let spec = BodySpec::new(format!("pieces {i}"), pieces.clone());
        world.insert(BodySpec { pose, ..spec }).unwrap();
    }
    let known = (0..200).find(|_| world.step().unwrap().stats.estimates.unsettled == 0);
    let report = world.step().unwrap();
    let inside = report.estimates.iter().filter(|pair| pair.a == BodyId(0));
    assert!(known.is_some() && inside.clone().count() == 3, "{known:?} {report:?}");
    assert!(inside.clone().all(|pair| pair.verdict == Verdict::Certain), "{report:?}");
}

/// A step that takes more than the whole budget is made once the pair stands still, and a distance
/// beside it is narrowed meanwhile.
#[test]
fn a_budget_below_one_step_decides_in_the_end() {
    let pieces = pieces();
    for budget in [1, 3, 64] {
        let mut world = estimating(&[Effect::TRIGGER, Effect::proximity(WITHIN)], budget);
        let held = [
            BodySpec::new("large", shape(Cuboid { size: [20.0; 3] })),
            BodySpec::new("pieces", pieces.clone()),
        ];
        let held = held.map(|spec| world.insert(spec).unwrap());
        let rings = linked(&mut world, "ring", DVec3::X * 30.0);
        let mut served = [0; 2];
        let mut overdrawn = 0;
        let decided = (0..100).find(|_| {
            let report = world.step().unwrap();
            let known = [held, rings].map(|[a, b]| *report.estimate(a, b).unwrap());
            let tests = report.stats.estimates.tests;
            overdrawn += u64::from(tests > budget);
            assert!(tests <= budget.max(400), "one step of one pair: {tests}");
            for (served, found) in served.iter_mut().zip(&known) {
                *served += u64::from(found.tests > 0);
            }
            known.iter().all(|found| found.verdict != Verdict::Open)
        });
        assert!(decided.is_some() && overdrawn > 0, "{budget}: {served:?}");
        let width = |report: &StepReport| {
            let Interval { lo, hi } = report.estimate(rings[0], rings[1]).unwrap().separation;
            hi - lo
        };
        let before = width(&world.step().unwrap());
        let after = (0..200).map(|_| width(&world.step().unwrap())).last().unwrap();
        assert!(after < before, "{budget}: {before} {after}");
    }
}

/// The pieces are in motion within a budget that never decides them: they may not keep a pair that
/// stands still from its distance.
#[test]
fn a_distance_is_narrowed_beside_open_verdicts() {
    let effects = [Effect::TRIGGER, Effect::proximity(WITHIN)];
    let mut world = estimating(&effects, 64);
    let ring = shape(Torus { major_segments: 48, minor_segments: 24, ..Torus::default() });
    let mut insert = |i: u32, model: &Model, pose: Pose| {
        let spec = BodySpec::new(i.to_string(), model.clone());
        world.insert(BodySpec { pose, ..spec }).unwrap()
    };
    let movers = [0, 1].map(|i| insert(i, &ring, Pose::at(DVec3::X * f64::from(i) * 0.01)));
    let still = linked(&mut world, "ring", DVec3::X * 30.0);
    let mut seen = Vec::new();
    for step in 0..200 {
        let turned = DQuat::from_rotation_x(f64::from(step) * 0.4 + 0.3);
        let at = DVec3::new(1.0, 0.1 * f64::from(step % 7), 0.0);
        world.set_pose(movers[1], Pose { translation: at, rotation: turned }).unwrap();
        let report = world.step().unwrap();
        assert!(report.stats.estimates.tests <= 64 + 400);
        let open = report.estimate(movers[0], movers[1]).unwrap();
        let found = report.estimate(still[0], still[1]).unwrap();
        seen.push((open.verdict, found.tests, found.separation.hi - found.separation.lo));
    }
    let open = seen.iter().filter(|(verdict, ..)| *verdict == Verdict::Open).count();
    assert!(open > 150, "the movers stay open: {open}");
    let rests: Vec<usize> = seen.split(|&(_, tests, _)| tests > 0).map(<[_]>::len).collect();
    assert!(rests.iter().all(|&rest| rest <= 20), "{rests:?}");
    assert!(seen[199].2 < seen[0].2, "{seen:?}");
}

#[test]
fn levels_of_pairs_and_what_needs_contacts() {
    let mut world = World::new();
    world.set_scene_effects(&[Effect::TRIGGER]).unwrap();
    world.set_accuracy(Accuracy::Hulls);
    let [a, b] = linked(&mut world, "ring", DVec3::ZERO);
    assert_eq!(world.accuracy_of(b, a).unwrap(), Accuracy::Hulls);
    let report = world.step().unwrap();
    let open = *report.estimate(a, b).unwrap();
    assert_eq!(
        (open.verdict, open.is_settled, open.accuracy),
        (Verdict::Open, true, Accuracy::Hulls)
    );
    assert!(report.is_open(b, a) && report.touching == [(a, b)] && report.answers.is_empty());
    assert_eq!(report.stats.touching_pairs, 0, "it is not certain");
    world.set_pair_accuracy(a, b, Some(Accuracy::Tree(9))).unwrap();
    let report = world.step().unwrap();
    assert_eq!(report.estimate(a, b).unwrap().verdict, Verdict::Excluded);
    assert_eq!((report.events.len(), report.touching.len()), (1, 0));
    world.set_pair_accuracy(a, b, None).unwrap();
    world.set_pair_effects(a, b, &[Effect::Contacts { margin: 0.0 }]).unwrap();
    assert_eq!(world.accuracy_of(a, b).unwrap(), Accuracy::Exact);
    let report = world.step().unwrap();
    assert_eq!((report.answers.len(), report.estimates.len()), (1, 0));
    // What works on a solver does not count where one body is a sensor.
    world.set_pair_effects(a, b, &[Effect::Response]).unwrap();
    assert_eq!(world.accuracy_of(a, b).unwrap(), Accuracy::Exact);
    world.set_sensor(a, true).unwrap();
    assert_eq!(world.accuracy_of(a, b).unwrap(), Accuracy::Hulls);
    world.remove(b).unwrap();
    world.validate().unwrap();
    assert!(world.set_pair_accuracy(a, b, None).is_err() && world.set_sensor(b, true).is_err());
}
