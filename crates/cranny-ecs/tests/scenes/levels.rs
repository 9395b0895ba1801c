//! Levels and budgets: what messages and reports say at them, and what is refused.

use std::collections::BTreeSet;
use std::num::NonZeroUsize;

use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_world::StepReport;
use cranny_world::description::{BodyKind, Effect, PairDescription, SceneDescription};

use crate::build::{cube, empty, gate, messages, steps, unit, up, world};

const NEAR: Effect = Effect::proximity(0.6);

fn at(level: Accuracy) -> RunOptions {
    RunOptions { accuracy: Some(level), ..RunOptions::default() }
}

fn pair(effects: &[Effect], accuracy: Option<Accuracy>) -> PairDescription {
    PairDescription { a: "gate".into(), b: "guest".into(), effects: effects.to_vec(), accuracy }
}

fn report(app: &SceneApp) -> &StepReport {
    app.app().world().resource::<Detected>().report.as_ref().unwrap()
}

/// Steps at which the guest began and ended to touch, and whether that was certain.
fn passage(description: &SceneDescription, options: &RunOptions) -> Vec<(u64, Option<bool>)> {
    let mut app = SceneApp::new(description, options).unwrap();
    let mut seen = Vec::new();
    while app.step().unwrap() {
        let step = report(&app).step;
        seen.extend(messages::<CollisionStart>(&app).iter().map(|m| (step, Some(m.is_certain))));
        seen.extend(messages::<CollisionEnd>(&app).iter().map(|_| (step, None)));
    }
    seen
}

/// A cube is its hull: every level begins and ends where exact answers do, and says whether it
/// knows.
#[test]
fn a_message_says_whether_it_is_certain() {
    let scene = gate(&[Effect::TRIGGER]);
    let exact = passage(&scene, &RunOptions::default());
    assert_eq!(exact, [(12, Some(true)), (21, None)]);
    for (level, certain) in [
        (Accuracy::Boxes, false),
        (Accuracy::Hulls, false),
        (Accuracy::Caps, true),
        (Accuracy::Tree(20), true),
        (Accuracy::Exact, true),
    ] {
        let found = passage(&scene, &at(level));
        assert_eq!(found, [(12, Some(certain)), (21, None)], "{level}");
    }
    // Without a test nothing is known: they may touch as long as their boxes do.
    let options = RunOptions { budget: Some(Some(0)), ..RunOptions::default() };
    let found = passage(&scene, &options);
    assert!(found[0].0 <= 12 && found[0].1 == Some(false) && found[1].0 >= 21, "{found:?}");
}

#[test]
fn the_log_and_the_summary_say_what_was_open() {
    let scene = gate(&[Effect::TRIGGER]);
    let run = |options: &RunOptions| {
        let mut app = SceneApp::new(&scene, options).unwrap();
        while app.step().unwrap() {}
        app.finish().unwrap()
    };
    let exact = run(&RunOptions::default());
    assert_eq!((exact.accuracy.as_deref(), exact.budget), (Some("exact"), None));
    assert_eq!((exact.triggers[0].times, exact.triggers[0].open), (1, 0));
    assert!(exact.estimates.is_none() && exact.tests.is_some_and(|tests| tests.mean > 0.0));
    let hulls = run(&at(Accuracy::Hulls));
    assert_eq!(hulls.accuracy.as_deref(), Some("hulls"));
    assert_eq!((hulls.triggers[0].times, hulls.triggers[0].open), (1, 1));
    let estimates = hulls.estimates.unwrap();
    let overlap = 9.0 / 32.0; // of hulls: from step 12 to step 20
    assert_eq!((estimates.open.mean, estimates.certain), (overlap, 0.0));
    assert_eq!(estimates.unsettled.max, 0, "no budget ends anything");
    let options = RunOptions { budget: Some(Some(20)), ..RunOptions::default() };
    let within = run(&options);
    assert_eq!((within.accuracy.as_deref(), within.budget), (Some("exact"), Some(20)));
    assert!(within.estimates.is_some_and(|estimates| estimates.tests.max <= 20));
    assert_eq!(within.state_hash, exact.state_hash, "nothing moves by it");
}

#[test]
fn a_distance_is_an_interval_that_holds_the_exact_one() {
    let exact: Vec<Option<f64>> = distances(&RunOptions::default())
        .into_iter()
        .map(|found| found.map(|[low, high]| (low == high).then_some(low).unwrap()))
        .collect();
    assert!(exact.iter().flatten().count() > 8);
    let budget = |tests| RunOptions { budget: Some(Some(tests)), ..RunOptions::default() };
    for options in [
        at(Accuracy::Boxes),
        at(Accuracy::Hulls),
        at(Accuracy::Caps),
        at(Accuracy::Tree(1)),
        budget(0),
        budget(12),
        budget(100_000),
    ] {
        for (exact, found) in exact.iter().zip(distances(&options)) {
            let Some(exact) = *exact else { continue };
            let [low, high] = found.expect("what is near is reported at every level");
            assert!(low <= exact && exact <= high, "{exact} in {low}..{high}: {options:?}");
        }
    }
    // Enough tests: exact but for rounding.
    for (exact, found) in exact.iter().zip(distances(&budget(100_000))) {
        assert!(found.is_none_or(|[low, high]| high - low < 1e-12), "{exact:?} {found:?}");
    }
}

fn distances(options: &RunOptions) -> Vec<Option<[f64; 2]>> {
    let mut app = SceneApp::new(&gate(&[NEAR]), options).unwrap();
    let mut found = Vec::new();
    while app.step().unwrap() {
        let near = app.app().world().resource::<ProximityReport>().pairs.first().copied();
        let knows = |near: ProximityPair| near.points.is_some() || near.at_most == 0.0;
        assert!(near.is_none_or(|near| knows(near) == near.speed.is_some()));
        found.push(near.map(|near| [near.distance, near.at_most]));
    }
    found
}

/// The table that explains a scene and the world that answers have one rule.
#[test]
fn the_table_and_the_world_agree_on_levels() {
    let hulls = Effect::Trigger { accuracy: Some(Accuracy::Hulls) };
    let mut scene = gate(&[Effect::TRIGGER]);
    scene.accuracy = Accuracy::Caps;
    scene.bodies.push(cube("sensor", BodyKind::Fixed, DVec3::X, DVec3::ZERO));
    scene.bodies.push(cube("exact", BodyKind::Fixed, DVec3::Y, DVec3::ZERO));
    scene.bodies.push(cube("coarse", BodyKind::Kinematic, DVec3::Z, DVec3::ZERO));
    scene.bodies[2].sensor = true;
    scene.bodies[3].effects = vec![Effect::Contacts { margin: 0.0 }];
    scene.bodies[4].effects = vec![hulls];
    scene.pairs = vec![
        pair(&[], Some(Accuracy::Tree(4))),
        PairDescription { b: "coarse".into(), ..pair(&[], Some(Accuracy::Boxes)) },
    ];
    let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
    assert!(app.step().unwrap());
    let world = world(&mut app);
    let table = world.resource::<EffectTable>().clone();
    let ids: Vec<BodyId> = table.bodies().collect();
    let mut detector = world.resource_mut::<Detector>();
    let mut levels = Vec::new();
    for (i, &a) in ids.iter().enumerate() {
        for &b in &ids[i + 1..] {
            let Some(level) = table.accuracy_of(a, b) else { continue };
            assert_eq!(detector.world().accuracy_of(a, b), Ok(level), "{a} {b}");
            levels.push((a.0, b.0, level));
        }
    }
    let known = |a, b| levels.iter().find(|(x, y, _)| (*x, *y) == (a, b)).unwrap().2;
    let of_guest = [known(0, 1), known(1, 2), known(1, 3)];
    assert_eq!(of_guest, [Accuracy::Tree(4), Accuracy::Caps, Accuracy::Exact]);
    let of_coarse = [known(0, 4), known(1, 4), known(3, 4)];
    assert_eq!(of_coarse, [Accuracy::Hulls, Accuracy::Caps, Accuracy::Exact]);
    // What explains a scene says the same.
    let plan = app.plan().unwrap();
    let group = plan.pairs.iter().find(|p| p.examples.contains(&["gate".into(), "guest".into()]));
    assert_eq!(group.unwrap().accuracy.as_deref(), Some("tree:4"));
}

#[test]
fn components_state_levels() {
    let mut app = empty(&[Effect::TRIGGER]);
    let world = world(&mut app);
    let body = |z: f32| (RigidBody::Kinematic, unit(), up(z));
    let [a, b] = [0.0, 0.5].map(|z| world.spawn(body(z)).id());
    let coarse = EffectAccuracy { trigger: Some(Accuracy::Hulls), proximity: None };
    let level = |app: &mut SceneApp| {
        steps(app, 1);
        report(app).estimates.first().map(|estimate| estimate.accuracy)
    };
    assert_eq!(level(&mut app), None, "the app's is exact");
    let beside =
        crate::build::world(&mut app).spawn((BodyPair { a, b }, PairAccuracy(Accuracy::Caps)));
    let beside = beside.id();
    assert_eq!(level(&mut app), Some(Accuracy::Caps));
    crate::build::world(&mut app)
        .entity_mut(a)
        .insert((Trigger, EffectAccuracy { trigger: Some(Accuracy::Exact), ..coarse }));
    assert_eq!(level(&mut app), None, "the most exact counts");
    crate::build::world(&mut app).entity_mut(a).insert(coarse);
    assert_eq!(level(&mut app), Some(Accuracy::Caps));
    crate::build::world(&mut app).despawn(beside);
    assert_eq!(level(&mut app), None);
}

/// A scene that is spawned into an app has its pairs at their levels, not at the scene's.
#[test]
fn a_spawned_scene_keeps_the_levels_of_its_pairs() {
    for effect in [Effect::TRIGGER, NEAR] {
        for (stated, of_pair, expected) in [
            (None, Some(Accuracy::Exact), None),
            (None, Some(Accuracy::Caps), Some(Accuracy::Caps)),
            (None, None, Some(Accuracy::Hulls)),
            // The scene's is the more exact one.
            (None, Some(Accuracy::Boxes), Some(Accuracy::Hulls)),
            // What an effect states, it keeps.
            (Some(Accuracy::Caps), None, Some(Accuracy::Caps)),
            (Some(Accuracy::Caps), Some(Accuracy::Tree(3)), Some(Accuracy::Caps)),
            (Some(Accuracy::Exact), Some(Accuracy::Boxes), None),
        ] {
            let mut described = gate(&[effect.stating(stated)]);
            described.bodies[1].pose.translation = DVec3::new(0.9, 0.0, 0.0);
            described.bodies[1].linear_velocity = DVec3::ZERO;
            described.accuracy = Accuracy::Hulls;
            described.pairs = vec![pair(&[], of_pair)];
            let mut app = plugged(&[effect]);
            SpawnScene::new(&described).unwrap().spawn(world(&mut app));
            steps(&mut app, 1);
            let report = report(&app);
            let what = format!("{stated:?} of the effect, {of_pair:?} of the pair");
            assert_eq!(report.answers.len() + report.estimates.len(), 1, "{what}");
            let level = report.estimates.first().map(|estimate| estimate.accuracy);
            assert_eq!(level, expected, "{what}");
        }
    }
}

/// An app without bodies, with effects at the level of boxes.
fn plugged(effects: &[Effect]) -> SceneApp {
    let plugins = PluginOptions { length_unit: Some(1.0 / 3.0), ..PluginOptions::default() };
    let options = RunOptions { plugins, ..RunOptions::default() };
    let mut never = crate::build::scene(Vec::new(), effects);
    never.duration = 100.0;
    never.effects = effects.iter().map(|effect| effect.stating(Some(Accuracy::Boxes))).collect();
    SceneApp::new(&never, &options).unwrap()
}

/// Runs of other answers have other hashes; what is the default says nothing.
#[test]
fn the_hash_of_a_scene_knows_levels_and_budgets() {
    let hash = |options: &RunOptions| {
        let mut app = SceneApp::new(&gate(&[Effect::TRIGGER]), options).unwrap();
        steps(&mut app, 1);
        app.finish().unwrap().scene_hash
    };
    let budget = |budget| RunOptions { budget: Some(budget), ..RunOptions::default() };
    let exact = hash(&RunOptions::default());
    assert_eq!([hash(&at(Accuracy::Exact)), hash(&budget(None))], [exact.clone(), exact.clone()]);
    let others = [at(Accuracy::Hulls), at(Accuracy::Tree(3)), at(Accuracy::Tree(4))];
    let others = others.into_iter().chain([budget(Some(5)), budget(Some(6))]);
    let hashes: BTreeSet<String> = others.map(|options| hash(&options)).chain([exact]).collect();
    assert_eq!(hashes.len(), 6);
    // What an effect states and what a pair states are parts of the scene.
    let stating = |accuracy, of_pair| {
        let mut scene = gate(&[Effect::Trigger { accuracy: Some(accuracy) }]);
        scene.pairs = vec![pair(&[Effect::TRIGGER], of_pair)];
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        steps(&mut app, 1);
        app.finish().unwrap().scene_hash
    };
    let of_effects = [Accuracy::Hulls, Accuracy::Caps].map(|level| stating(level, None));
    let of_pairs = [Accuracy::Boxes, Accuracy::Tree(2)];
    let of_pairs = of_pairs.map(|level| stating(Accuracy::Hulls, Some(level)));
    let hashes: BTreeSet<String> = of_effects.into_iter().chain(of_pairs).collect();
    assert_eq!(hashes.len(), 4);
}

#[test]
fn what_would_change_nothing_is_refused_by_name() {
    let refused = |change: fn(&mut SceneDescription), effects: &[Effect]| {
        let mut scene = gate(effects);
        change(&mut scene);
        let error = SceneApp::new(&scene, &RunOptions::default()).err();
        error.expect("it changes nothing").to_string()
    };
    let contacts = Effect::Contacts { margin: 0.1 };
    let coarse = |scene: &mut SceneDescription| scene.accuracy = Accuracy::Caps;
    let budget = |scene: &mut SceneDescription| scene.budget = Some(100);
    for (message, says) in [
        (refused(coarse, &[contacts]), "`accuracy: Caps` changes nothing: only Trigger"),
        (
            refused(coarse, &[contacts, Effect::TRIGGER]),
            "`accuracy: Caps` changes nothing: Contacts needs exact contacts",
        ),
        (refused(budget, &[contacts, Effect::TRIGGER]), "`budget: 100` changes nothing: Contacts"),
        (refused(budget, &[]), "`budget: 100` changes nothing: only Trigger and Proximity"),
        (
            refused(
                |_| (),
                &[Effect::Trigger { accuracy: Some(Accuracy::Tree(3)) }, Effect::Penetration],
            ),
            "`Trigger(accuracy: Tree(3))` of the scene changes nothing: Penetration needs",
        ),
        (
            refused(
                |scene| scene.pairs = vec![pair(&[Effect::Penetration], Some(Accuracy::Hulls))],
                &[NEAR],
            ),
            "`accuracy: Hulls` of the pair 'gate' and 'guest' changes nothing: Penetration needs",
        ),
        (
            refused(
                |scene| {
                    let coarse = Effect::Trigger { accuracy: Some(Accuracy::Caps) };
                    scene.bodies[0].effects = vec![coarse, Effect::Penetration];
                },
                &[],
            ),
            "`Trigger(accuracy: Caps)` of body 'gate' changes nothing: Penetration needs",
        ),
        (
            refused(
                |scene| {
                    let coarse = NEAR.stating(Some(Accuracy::Boxes));
                    scene.pairs = vec![pair(&[coarse, Effect::Penetration], None)];
                },
                &[],
            ),
            "`Proximity(accuracy: Boxes)` of the pair 'gate' and 'guest' changes nothing: Penet",
        ),
        // A sensor is tracked as others are: within a budget it would never be certain to touch.
        (
            refused(
                |scene| (scene.budget, scene.bodies[0].sensor) = (Some(100), true),
                &[Effect::TRIGGER, Effect::Tracking { tolerance: 0.1 }],
            ),
            "`budget: 100` changes nothing: Tracking needs",
        ),
        (
            refused(|scene| scene.pairs = vec![pair(&[], Some(Accuracy::Hulls))], &[]),
            "`accuracy: Hulls` of the pair 'gate' and 'guest' changes nothing: only Trigger",
        ),
    ] {
        assert!(message.starts_with(says), "{message}");
    }
    // So does a command with a level.
    let error = SceneApp::new(&gate(&[contacts]), &at(Accuracy::Hulls)).err().unwrap();
    assert!(error.to_string().contains("`accuracy: Hulls`"), "{error}");
    assert!(SceneApp::new(&gate(&[contacts]), &at(Accuracy::Exact)).is_ok());
    let app = CrannyPlugins::new(0.1).unwrap().effects(&[contacts]).unwrap();
    assert!(app.accuracy(Accuracy::Caps).is_err());
}

/// What works on a solver has no part in pairs of sensors, so levels of these mean something.
#[cfg(feature = "rapier")]
#[test]
fn with_a_solver_levels_are_for_sensors() {
    let mut scene = gate(&[Effect::Response, Effect::TRIGGER]);
    scene.accuracy = Accuracy::Hulls;
    let error = SceneApp::new(&scene, &RunOptions::default()).err().unwrap().to_string();
    assert!(error.contains("Response needs exact contacts"), "{error}");
    scene.bodies[0].sensor = true;
    let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
    // What explains a scene and what answers have one rule here, too.
    assert!(app.step().unwrap());
    let app_world = world(&mut app);
    let table = app_world.resource::<EffectTable>().clone();
    let ids: Vec<BodyId> = table.bodies().collect();
    assert_eq!(table.accuracy_of(ids[0], ids[1]), Some(Accuracy::Hulls));
    let mut detector = app_world.resource_mut::<Detector>();
    assert_eq!(detector.world().accuracy_of(ids[0], ids[1]), Ok(Accuracy::Hulls));
    let mut certain = Vec::new();
    while app.step().unwrap() {
        certain.extend(messages::<CollisionStart>(&app).iter().map(|start| start.is_certain));
    }
    assert_eq!(certain, [false]);
    assert!(app.finish().unwrap().estimates.is_some());
}

/// Twenty bodies turn about one another within a budget that is too small: twice, and with two
/// threads, all that is known is the same to the bit.
#[test]
fn a_run_within_a_budget_is_the_same_twice_and_with_any_threads() {
    let mut scene = crate::build::scene(Vec::new(), &[Effect::TRIGGER, NEAR]);
    for i in 0..20 {
        let at = DVec3::new(f64::from(i % 5) * 1.2, f64::from(i / 5) * 1.2, 0.0);
        let mut body = cube(&format!("cube {i}"), BodyKind::Kinematic, at, DVec3::ZERO);
        body.angular_velocity = DVec3::new(f64::from(i % 3), 1.0, f64::from(i % 2)) * 2.0;
        scene.bodies.push(body);
    }
    let run = |threads| {
        let plugins =
            PluginOptions { threads: NonZeroUsize::new(threads), ..PluginOptions::default() };
        let options = RunOptions { plugins, budget: Some(Some(300)), ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &options).unwrap();
        let mut told = Vec::new();
        for _ in 0..40 {
            assert!(app.step().unwrap());
            told.push((report(&app).estimates.clone(), report(&app).events.clone()));
        }
        told
    };
    let first = run(1);
    assert!(first.iter().any(|(found, _)| found.iter().any(|pair| !pair.is_settled)));
    assert!(run(1) == first);
    #[cfg(feature = "parallel")]
    assert!(run(2) == first);
}

/// Motions of scenes, with a solver and exact contacts: at every level and within every budget,
/// what touches is touching or open, and the distance lies in the interval.
#[cfg(all(feature = "rapier", feature = "scene"))]
#[test]
fn no_level_excludes_what_exact_finds_in_recorded_motions() {
    let (mut scenes_that_touch, mut scenes_decided) = (0, 0);
    for (name, seconds, every) in [
        ("hook_on_ring.ron", 0.4, 8),
        ("peg_in_hole.ron", 0.4, 12),
        ("key_in_lock.ron", 0.6, 12),
        ("nut_of_48_facets.ron", 0.2, 8),
        ("gears.ron", 0.2, 8),
        ("l_on_slab.ron", 0.4, 12),
        ("triggers_only.ron", 2.0, 6),
        ("budgeted_triggers.ron", 1.5, 10),
    ] {
        let (touched, open, decided) = recorded::compare(name, seconds, every);
        assert!(open > 0, "{name}: {touched} touched, {decided} decided");
        scenes_that_touch += usize::from(touched > 0);
        scenes_decided += usize::from(decided > 0);
    }
    assert!(scenes_that_touch >= 5, "{scenes_that_touch}");
    // Of a thread that moves, no coarse level and no such budget decides.
    assert!(scenes_decided >= 7, "{scenes_decided}");
}

#[cfg(all(feature = "rapier", feature = "scene"))]
mod recorded {
    use std::ops::Range;
    use std::path::PathBuf;

    use bevy_transform::components::Transform;
    use cranny_ecs::*;
    use cranny_exact::Pose;
    use cranny_scene::load_scene;
    use cranny_world::description::Effect;
    use cranny_world::{BodySpec, World};

    const LEVELS: [(Accuracy, Option<u64>); 8] = [
        (Accuracy::Boxes, None),
        (Accuracy::Hulls, None),
        (Accuracy::Caps, None),
        (Accuracy::Tree(5), None),
        (Accuracy::Caps, Some(200)),
        (Accuracy::Exact, Some(0)),
        (Accuracy::Exact, Some(100)),
        (Accuracy::Exact, Some(2_000)),
    ];

    /// A stretch in which memory goes on from step to step.
    const EVERY_STEP: Range<usize> = 20..32;

    /// Follows a scene's motion; returns how many pairs touched, how many were open, and how many
    /// were decided.
    pub(super) fn compare(name: &str, seconds: f64, every: usize) -> (usize, usize, usize) {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes").join(name);
        let scene = load_scene(&path).unwrap().description;
        let options = RunOptions { duration: Some(seconds), ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &options).unwrap();
        let mut exact = world(&app, Accuracy::Exact, None);
        let mut worlds = LEVELS.map(|(level, budget)| world(&app, level, budget));
        let (mut touched, mut open, mut decided) = (0, 0, 0);
        for step in 0.. {
            if step % every == 0 || EVERY_STEP.contains(&step) {
                let poses = poses(&app);
                let put = |world: &mut World| {
                    poses.iter().for_each(|&(id, pose)| world.set_pose(id, pose).unwrap());
                    world.step().unwrap()
                };
                let truth = put(&mut exact);
                touched += truth.touching.len();
                for (world, (level, budget)) in worlds.iter_mut().zip(LEVELS) {
                    let found = put(world);
                    open += found.stats.estimates.open;
                    decided += found.stats.estimates.pairs - found.stats.estimates.open;
                    let what = format!("{name}, step {step}, {level} within {budget:?}");
                    for answer in &truth.answers {
                        let estimate = found.estimate(answer.a, answer.b).expect(&what);
                        let touches = answer.answer.touches();
                        assert!(!touches || estimate.may_touch(), "{what}: {estimate:?}");
                        assert!(touches || estimate.verdict != Verdict::Certain, "{what}");
                        let distance = answer.answer.distance.filter(|d| d.is_finite());
                        assert!(distance.is_none_or(|d| estimate.separation.contains(d)), "{what}");
                    }
                }
            }
            if !app.step().unwrap() {
                return (touched, open, decided);
            }
        }
        (touched, open, decided)
    }

    fn world(app: &SceneApp, accuracy: Accuracy, budget: Option<u64>) -> World {
        let mut world = World::new();
        let size = app.app().world().resource::<Bodies>().iter();
        let size = size
            .map(|(_, record)| record.model().unwrap().bounds().diagonal())
            .fold(f64::MAX, f64::min);
        world.set_scene_effects(&[Effect::TRIGGER, Effect::proximity(0.2 * size)]).unwrap();
        world.set_accuracy(accuracy);
        world.set_budget(budget);
        for (id, record) in app.app().world().resource::<Bodies>().iter() {
            let spec = BodySpec::new(record.name.clone(), record.shape.clone());
            world.insert_as(id, BodySpec { kind: record.kind, ..spec }).unwrap();
        }
        world
    }

    fn poses(app: &SceneApp) -> Vec<(BodyId, Pose)> {
        let world = app.app().world();
        let pose = |entity| pose_of(world.get::<Transform>(entity).unwrap());
        let bodies = world.resource::<Bodies>().iter();
        bodies.map(|(id, record)| (id, pose(record.entity))).collect()
    }
}
