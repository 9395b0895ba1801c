//! Tracked bodies: contacts under jitter, delay and loss, beside those of the true motion.
//! Lengths are millimetres.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_shapes::{Cuboid, Cup};
use cranny_world::Random;
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, Interpolation, Keyframe, KeyframedPath, OneEuro,
    PairDescription, PathEnd, SceneDescription, SimulatedDevice, TrackerDescription,
    TrackerSettings,
};

use crate::build::{cube, empty, gate, messages, scene, steps, unit, up, world};

/// Steps a second, and poses.
const RATE: f64 = 240.0;
const JITTER: f64 = 2.0;

/// Errs by 2 mm, and in nothing else.
fn shaky(seed: u64) -> SimulatedDevice {
    SimulatedDevice {
        rate: RATE,
        jitter: JITTER,
        latency: 0.0,
        latency_spread: 0.0,
        dropouts: 0.0,
        occlusions: 0.0,
        occluded_for: 0.0,
        seed,
    }
}

/// A pen in and about a cup: a way with keyframes so many seconds apart.
fn pen_and_cup(
    keyframes: &[(f64, Pose)],
    tracker: TrackerDescription,
    tolerance: f64,
) -> SceneDescription {
    let keyframes = keyframes.iter().map(|&(time, pose)| Keyframe { time, pose });
    let path = KeyframedPath::new(keyframes.collect(), Interpolation::Eased, PathEnd::Hold);
    let cup = Cup { radius: 40.0, height: 80.0, wall: 8.0, ..Cup::default() };
    let pen = Cuboid { size: [6.0, 6.0, 60.0] };
    let still = |name, kind| cube(name, kind, DVec3::ZERO, DVec3::ZERO);
    let bodies = vec![
        BodyDescription {
            collision: Arc::new(cup.build().unwrap()),
            ..still("cup", BodyKind::Fixed)
        },
        BodyDescription {
            collision: Arc::new(pen.build().unwrap()),
            path: Some(Arc::new(path.unwrap())),
            tracker: Some(tracker),
            effects: vec![Effect::TRIGGER, Effect::Tracking { tolerance }],
            ..still("pen", BodyKind::Kinematic)
        },
    ];
    SceneDescription { step: 1.0 / RATE, duration: 3.0, ..scene(bodies, &[]) }
}

/// A random way: the pen's middle within the cup's wall, in its well and above it.
fn wander(seed: u64, pause: f64) -> Vec<(f64, Pose)> {
    let mut random = Random::new(seed);
    let count = (3.0 / pause) as u32;
    let key = |i: u32| {
        let place = DVec3::new(45.0, 45.0, 40.0) * random.in_ball() + DVec3::Z * 80.0;
        let rotation = random.rotation();
        (f64::from(i) * pause, Pose { rotation, translation: place })
    };
    (0..count).map(key).collect()
}

fn run(scene: &SceneDescription) -> RunSummary {
    let mut app = SceneApp::new(scene, &RunOptions::default()).unwrap();
    while app.step().unwrap() {}
    app.finish().unwrap()
}

/// What happened over so many random ways, keyframes `pause` seconds apart.
#[expect(clippy::print_stdout, reason = "a failure names its seed")]
fn over_seeds(
    seeds: std::ops::Range<u64>,
    pause: f64,
    settings: TrackerSettings,
    tolerance: f64,
    device: impl Fn(u64) -> SimulatedDevice,
) -> TrackingSummary {
    let runs = seeds.map(|seed| {
        let tracker = TrackerDescription { settings, device: device(seed) };
        let summary = run(&pen_and_cup(&wander(seed, pause), tracker, tolerance));
        let [tracking] = <[_; 1]>::try_from(summary.tracking).unwrap();
        println!("seed {seed}: {tracking:?}");
        tracking
    });
    runs.reduce(joined).unwrap()
}

fn joined(a: TrackingSummary, b: TrackingSummary) -> TrackingSummary {
    TrackingSummary {
        body: a.body,
        truth: a.truth + b.truth,
        raw: a.raw.join(b.raw),
        filtered: a.filtered.join(b.filtered),
        poses: a.poses + b.poses,
        late: a.late + b.late,
        refused: a.refused + b.refused,
        missing: a.missing + b.missing,
        lost: a.lost + b.lost,
        uncompared: a.uncompared + b.uncompared,
    }
}

/// Nothing is wrong: no contact is spurious, in pieces, ends too early or comes after the true one.
/// Few stand for two true ones, and they end soon.
fn assert_right(all: &TrackingSummary) {
    let TrackedContacts { contacts, spurious, repeated, cut_short, late, merged, .. } =
        all.filtered;
    assert_eq!([spurious, repeated, cut_short, late], [0; 4], "{all:?}");
    assert!(5 * merged < contacts, "{all:?}");
    // What moves on is farther away than the tolerance in half a second.
    assert!(all.filtered.end_latency_steps < 120, "{all:?}");
}

/// At a tolerance of the jitter and without smoothing: what overlaps by twice as much for a
/// pose is reported in the next step.
#[test]
fn two_millimetres_of_jitter_make_no_contact_and_hide_none() {
    for pause in [0.25, 0.5, 1.0] {
        let all = over_seeds(0..16, pause, TrackerSettings::default(), JITTER, shaky);
        assert_right(&all);
        assert_eq!(all.filtered.missed, 0, "{all:?}");
        assert!(all.filtered.latency_steps <= 2, "{all:?}");
        assert!(all.raw.spurious > 20 && all.raw.repeated > 20, "without: {all:?}");
        assert!(all.raw.cut_short > 20, "without: {all:?}");
        assert!(all.filtered.contacts > all.truth / 2, "{all:?}");
    }
}

const SMOOTHING: Option<OneEuro> = Some(OneEuro { min_cutoff: 1.0, per_speed: 0.05 });

/// Smoothing makes up for a tolerance of half the jitter, at the price of latency.
#[test]
fn smoothed_poses_bear_half_the_tolerance() {
    let settings = TrackerSettings { smoothing: SMOOTHING, ..TrackerSettings::default() };
    let all = over_seeds(0..24, 1.0, settings, 0.5 * JITTER, shaky);
    assert_right(&all);
    assert_eq!(all.filtered.missed, 0, "{all:?}");
    assert!((2..60).contains(&all.filtered.latency_steps), "{all:?}");
    assert!(all.raw.spurious > 20, "without: {all:?}");
}

#[test]
fn late_disordered_and_missing_poses_make_no_contact_either() {
    let settings = TrackerSettings { delay: 0.02, ..TrackerSettings::default() };
    let device = |seed| SimulatedDevice {
        rate: 120.0,
        latency: 0.01,
        latency_spread: 0.03,
        dropouts: 0.2,
        occlusions: 0.5,
        occluded_for: 0.25,
        ..shaky(seed)
    };
    let all = over_seeds(0..16, 0.5, settings, JITTER, device);
    assert!(all.late > 100 && all.missing > 1000 && all.lost >= 10, "{all:?}");
    assert_right(&all);
    assert!(all.raw.spurious + all.raw.repeated > 20, "without: {all:?}");
    // What falls into a time in which nobody sees the body is missed, and that is all.
    assert!(all.filtered.missed <= 2, "{all:?}");
}

/// The pen upright, so far above the cup's rim (below 0: into it) from half a second on.
fn above_rim(gap: f64) -> Vec<(f64, Pose)> {
    let up = |z: f64| Pose::at(DVec3::new(36.0, 0.0, 110.0 + z));
    vec![(0.0, up(20.0)), (0.5, up(gap)), (3.0, up(gap))]
}

#[test]
fn what_waits_half_a_millimetre_from_a_rim_does_not_touch_it() {
    let tracker = TrackerDescription { settings: TrackerSettings::default(), device: shaky(1) };
    let mut scene = pen_and_cup(&above_rim(0.5), tracker, JITTER);
    let summary = run(&scene);
    let tracking = &summary.tracking[0];
    assert_eq!((tracking.truth, tracking.filtered.contacts), (0, 0), "{tracking:?}");
    assert!(tracking.raw.spurious > 40, "{tracking:?}");
    assert!(summary.triggers.is_empty());
    // At a tolerance of next to nothing triggers say what the poses do: more than forty times.
    scene.bodies[1].effects = vec![Effect::TRIGGER, Effect::Tracking { tolerance: 1e-9 }];
    assert!(run(&scene).triggers[0].times > 40);
}

/// A slight contact that stays is within the jitter: smoothing finds it.
#[test]
fn what_lies_on_a_rim_lightly_is_found_by_smoothing() {
    let found = |smoothing, tolerance| {
        let settings = TrackerSettings { smoothing, ..TrackerSettings::default() };
        let tracker = TrackerDescription { settings, device: shaky(1) };
        let summary = run(&pen_and_cup(&above_rim(-0.7), tracker, tolerance));
        (summary.tracking[0].truth, summary.tracking[0].filtered.contacts)
    };
    assert!(found(None, 0.4).1 > 3, "it comes and goes");
    let slow = Some(OneEuro { min_cutoff: 0.5, per_speed: 0.01 });
    assert_eq!(found(slow, 0.4), (1, 1));
}

#[test]
fn one_seed_makes_one_run_and_another_another() {
    let state = |seed| {
        let settings = TrackerSettings { smoothing: SMOOTHING, ..TrackerSettings::default() };
        let device = SimulatedDevice { dropouts: 0.1, latency_spread: 0.01, ..shaky(seed) };
        let tracker = TrackerDescription { settings, device };
        let summary = run(&pen_and_cup(&wander(3, 0.5), tracker, JITTER));
        (summary.state_hash, summary.tracking)
    };
    assert_eq!(state(1), state(1));
    assert_ne!(state(1).0, state(2).0);
}

/// A unit cube at the origin, and a tracked one that an app moves along x.
fn tracked_app(effects: &[Effect], other: RigidBody) -> (SceneApp, [Entity; 2]) {
    let mut app = empty(effects);
    let fixed = world(&mut app).spawn((other, unit(), up(0.0))).id();
    let tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let tracked = (RigidBody::Kinematic, unit(), tracker, Tracking { tolerance: 0.1 });
    let tracked = world(&mut app).spawn((tracked, Transform::from_xyz(3.0, 0.0, 0.0))).id();
    (app, [fixed, tracked])
}

/// Shows the tracked body at x for some steps; returns what began (true) and ended in each.
fn show(app: &mut SceneApp, tracked: Entity, place: Option<f64>, count: usize) -> Vec<bool> {
    let mut seen = Vec::new();
    for _ in 0..count {
        let time = app.app().world().resource::<SimulatedTime>().seconds();
        if let Some(x) = place {
            let mut tracker = world(app).get_mut::<Tracker>(tracked).unwrap();
            tracker.report(TrackedPose { time, pose: Pose::at(DVec3::X * x) }).unwrap();
        }
        steps(app, 1);
        seen.extend(messages::<CollisionStart>(app).iter().map(|_| true));
        seen.extend(messages::<CollisionEnd>(app).iter().map(|_| false));
    }
    seen
}

const FILTERED: [Effect; 2] = [Effect::TRIGGER, Effect::Tracking { tolerance: 0.1 }];

#[test]
fn a_contact_begins_beyond_the_tolerance_and_ends_beyond_it() {
    let (mut app, [fixed, tracked]) = tracked_app(&FILTERED, RigidBody::Fixed);
    let mut at = |x: f64| {
        let seen = show(&mut app, tracked, Some(x), 3);
        let mut touching = SystemState::<Collisions>::new(world(&mut app));
        let touches = touching.get(app.app().world()).unwrap().are_touching(fixed, tracked);
        let listed = !app.app().world().get::<TouchingBodies>(fixed).unwrap().is_empty();
        assert_eq!(touches, listed, "two ways to one answer");
        (seen, touches)
    };
    assert_eq!(at(1.05), (vec![], false));
    assert_eq!(at(0.95), (vec![], false), "an overlap within the tolerance");
    assert_eq!(at(0.85), (vec![true], true));
    assert_eq!(at(0.95), (vec![], true));
    assert_eq!(at(1.05), (vec![], true), "a gap within the tolerance");
    assert_eq!(at(1.15), (vec![false], false));
    assert_eq!(at(0.95), (vec![], false));
}

/// What touches as `Tracking` comes goes on, though it overlaps by less than the tolerance.
#[test]
fn tracking_that_comes_to_a_contact_does_not_end_it() {
    let tracking = Effect::Tracking { tolerance: 0.1 };
    let far = cube("far", BodyKind::Kinematic, 900.0 * DVec3::X, DVec3::ZERO);
    let far = BodyDescription { effects: vec![tracking], ..far };
    let scene = scene(vec![far], &[Effect::TRIGGER]);
    let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
    world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0)));
    let hand = world(&mut app).spawn((RigidBody::Kinematic, unit(), up(0.95))).id();
    let seen = |app: &mut SceneApp| {
        steps(app, 1);
        [messages::<CollisionStart>(app).len(), messages::<CollisionEnd>(app).len()]
    };
    assert_eq!(seen(&mut app), [1, 0]);
    world(&mut app).entity_mut(hand).insert(Tracking { tolerance: 0.1 });
    assert_eq!([seen(&mut app), seen(&mut app)], [[0; 2]; 2]);
    world(&mut app).get_mut::<Transform>(hand).unwrap().translation.z = 1.05;
    assert_eq!(seen(&mut app), [0; 2], "a gap within the tolerance");
    world(&mut app).entity_mut(hand).remove::<Tracking>();
    assert_eq!(seen(&mut app), [0, 1], "without it a gap is a gap");
}

#[test]
fn a_body_that_is_lost_begins_no_contact_and_keeps_its_own() {
    let (mut app, [_, tracked]) = tracked_app(&FILTERED, RigidBody::Fixed);
    let other = world(&mut app).spawn((RigidBody::Kinematic, unit(), up(0.0))).id();
    world(&mut app).get_mut::<Transform>(other).unwrap().translation.x = 5.0;
    assert_eq!(show(&mut app, tracked, Some(0.5), 3), [true]);
    assert!(show(&mut app, tracked, None, 30).is_empty(), "it is held, and so is its contact");
    assert!(app.app().world().get::<Tracker>(tracked).unwrap().is_lost());
    world(&mut app).get_mut::<Transform>(other).unwrap().translation.x = 1.0;
    let seen = show(&mut app, tracked, None, 5);
    assert!(seen.is_empty(), "nobody knows whether it is there");
    assert_eq!(show(&mut app, tracked, Some(0.5), 3), [true], "now somebody does");
}

/// Beside the cup's wall a second pen that is tracked too: where it really is counts, not where it
/// is shown.
#[test]
fn two_that_are_tracked_are_compared_where_both_really_are() {
    let settings = TrackerSettings::default();
    let tracker = |seed| TrackerDescription { settings, device: shaky(seed) };
    let mut scene = pen_and_cup(&above_rim(300.0), tracker(1), 2.0 * JITTER);
    scene.bodies.remove(0);
    let beside = |x: f64| {
        let keys = above_rim(300.0).into_iter().map(|(time, mut pose)| {
            pose.translation.x += x;
            Keyframe { time, pose }
        });
        Arc::new(KeyframedPath::new(keys.collect(), Interpolation::Eased, PathEnd::Hold).unwrap())
    };
    let mut second = BodyDescription { name: "second".into(), ..scene.bodies[0].clone() };
    (second.path, second.tracker) = (Some(beside(6.5)), Some(tracker(2)));
    scene.bodies.push(second);
    let both = run(&scene).tracking;
    let [first, second] = both.as_slice() else { panic!("{both:?}") };
    assert_eq!((first.truth, first.filtered.contacts), (0, 0), "{first:?}");
    assert!(first.raw.spurious > 20 && first.raw.contacts == first.raw.spurious, "{first:?}");
    assert_eq!((second.truth, second.raw.contacts), (0, 0), "a pair counts once: {second:?}");
    scene.bodies[1].path = Some(beside(3.0));
    let deep = &run(&scene).tracking[0];
    assert_eq!((deep.truth, deep.filtered.contacts, deep.filtered.missed), (1, 1, 0), "{deep:?}");
}

/// Other readers change no trigger: neither regions nor a recording of all.
#[test]
fn triggers_are_the_same_whoever_reads_contacts() {
    let triggers = |effects: &[Effect], fields| {
        let tracker = TrackerDescription { settings: TrackerSettings::default(), device: shaky(4) };
        let mut scene = pen_and_cup(&wander(4, 0.25), tracker, JITTER);
        scene.effects = effects.to_vec();
        let plugins = PluginOptions { contact_fields: fields, ..PluginOptions::default() };
        let options = RunOptions { plugins, ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &options).unwrap();
        let mut seen = Vec::new();
        while app.step().unwrap() {
            let step = app.app().world().resource::<SimulatedTime>().steps();
            seen.extend(messages::<CollisionStart>(&app).iter().map(|_| (step, true)));
            seen.extend(messages::<CollisionEnd>(&app).iter().map(|_| (step, false)));
        }
        seen
    };
    let contacts = [Effect::Contacts { margin: 0.1 }];
    let none = triggers(&contacts, ContactFields::NONE);
    assert!(none.len() > 4, "{none:?}");
    assert_eq!(triggers(&contacts, ContactFields::ALL), none);
    assert_eq!(triggers(&[Effect::Penetration], ContactFields::NONE), none);
    assert_eq!(triggers(&[], ContactFields::NONE), none);
}

/// A pen within a block is as deep in as can be, though no surface meets another.
#[test]
fn what_is_wholly_within_another_is_deep() {
    let tracker = TrackerDescription { settings: TrackerSettings::default(), device: shaky(1) };
    let inside = vec![(0.0, Pose::at(DVec3::ZERO)), (3.0, Pose::at(DVec3::ZERO))];
    let mut scene = pen_and_cup(&inside, tracker, 0.1);
    scene.bodies[0].collision = Arc::new(Cuboid { size: [200.0; 3] }.build().unwrap());
    scene.duration = 0.5;
    let tracking = &run(&scene).tracking[0];
    assert_eq!((tracking.truth, tracking.filtered.contacts, tracking.filtered.missed), (1, 1, 0));
    // A tracker that never sees it has missed it.
    scene.bodies[1].tracker.as_mut().unwrap().device.dropouts = 1.0;
    let missed = &run(&scene).tracking[0];
    assert_eq!((missed.truth, missed.filtered.missed), (1, 1), "{missed:?}");
}

#[cfg(feature = "rapier")]
#[test]
fn what_the_solver_moves_is_not_compared_and_counted() {
    let tracker = TrackerDescription { settings: TrackerSettings::default(), device: shaky(1) };
    let mut scene = pen_and_cup(&above_rim(50.0), tracker, JITTER);
    scene.bodies.push(cube("die", BodyKind::Dynamic, DVec3::Z * 900.0, DVec3::ZERO));
    scene.effects = vec![Effect::Response];
    scene.duration = 0.1;
    assert_eq!(run(&scene).tracking[0].uncompared, 1);
}

#[test]
fn a_first_overlap_is_named_where_penetration_alone_tells_depths() {
    let summary = |effects: &[Effect]| run(&gate(effects));
    let seen = summary(&[Effect::Penetration]);
    let first = seen.first_overlap.expect("they pass through each other");
    assert!(first.depth > 0.0 && seen.deepest.unwrap().depth >= first.depth);
    assert_eq!(summary(&[Effect::TRIGGER]).first_overlap, None);
}

/// It is led by velocities, and appears without one.
#[test]
fn a_tracked_body_appears_and_then_moves() {
    let (mut app, [_, tracked]) = tracked_app(&FILTERED, RigidBody::Fixed);
    let speed = |app: &SceneApp| app.app().world().get::<LinearVelocity>(tracked).unwrap().0.x;
    let x = |app: &SceneApp| app.app().world().get::<Transform>(tracked).unwrap().translation.x;
    show(&mut app, tracked, Some(9.0), 1);
    assert_eq!((x(&app), speed(&app)), (9.0, 0.0));
    show(&mut app, tracked, Some(9.5), 1);
    assert_eq!((x(&app), speed(&app)), (9.5, 32.0));
}

/// What the solver pushes away is never overlapped by as much as the tolerance.
#[cfg(feature = "rapier")]
#[test]
fn what_a_tracked_body_pushes_is_touched_by_it() {
    let effects = [&FILTERED[..], &[Effect::Response]].concat();
    let (mut app, [pushed, tracked]) = tracked_app(&effects, RigidBody::Dynamic);
    world(&mut app).entity_mut(pushed).insert(GravityScale(0.0));
    let mut seen = Vec::new();
    for i in 0..60 {
        seen.extend(show(&mut app, tracked, Some(2.0 - 0.03 * f64::from(i)), 1));
    }
    assert_eq!(seen, [true]);
    assert!(app.app().world().get::<Transform>(pushed).unwrap().translation.x < -0.5);
}

/// With a body that is lost no contact begins, also where the solver presses it on another one.
#[cfg(feature = "rapier")]
#[test]
fn what_presses_on_a_lost_body_begins_no_contact() {
    let effects = [&FILTERED[..], &[Effect::Response]].concat();
    let (mut app, [pushed, tracked]) = tracked_app(&effects, RigidBody::Dynamic);
    world(&mut app).entity_mut(pushed).insert(GravityScale(0.0));
    assert!(show(&mut app, tracked, Some(2.0), 3).is_empty());
    assert!(show(&mut app, tracked, None, 30).is_empty());
    assert!(app.app().world().get::<Tracker>(tracked).unwrap().is_lost());
    world(&mut app).get_mut::<LinearVelocity>(pushed).unwrap().0.x = 5.0;
    let mut pressed = 0;
    for _ in 0..60 {
        assert!(show(&mut app, tracked, None, 1).is_empty(), "nobody knows where it is");
        let mut collisions = SystemState::<Collisions>::new(world(&mut app));
        let collisions = collisions.get(app.app().world()).unwrap();
        let found = collisions.get(pushed, tracked);
        pressed += usize::from(found.is_some_and(|collision| collision.impulse > 0.0));
    }
    assert!(pressed > 0, "the solver stops it");
    assert!(app.app().world().get::<Transform>(pushed).unwrap().translation.x < 1.1);
}

#[test]
fn what_does_not_go_together_is_refused_with_its_remedy() {
    let refused = |change: fn(&mut SceneDescription)| {
        let tracker = TrackerDescription { settings: TrackerSettings::default(), device: shaky(1) };
        let mut scene = pen_and_cup(&wander(1, 1.0), tracker, JITTER);
        change(&mut scene);
        let refused = check_effects(&scene).err();
        let refused = refused.or_else(|| SceneApp::new(&scene, &RunOptions::default()).err());
        refused.expect("refused").to_string()
    };
    let alone = refused(|scene| scene.bodies[1].effects = vec![Effect::TRIGGER]);
    assert!(alone.starts_with("body 'pen' has a tracker, but none of its pairs"), "{alone}");
    // The one effect is the pen's, and the other is for a pair that it is not of.
    let apart = refused(|scene| {
        scene.bodies[1].effects = vec![Effect::TRIGGER];
        scene.pairs = vec![PairDescription {
            a: "cup".into(),
            b: "post".into(),
            effects: vec![Effect::Tracking { tolerance: 1.0 }],
            accuracy: None,
        }];
        scene.bodies.push(cube("post", BodyKind::Kinematic, DVec3::X * 900.0, DVec3::ZERO));
    });
    assert!(apart.starts_with("body 'pen' has a tracker, but none of its pairs"), "{apart}");
    let nobody = refused(|scene| {
        scene.bodies[1].effects = vec![Effect::Tracking { tolerance: 1.0 }];
        scene.bodies[1].tracker = None;
        for name in ["post", "beam"] {
            let far = cube(name, BodyKind::Kinematic, DVec3::X * 900.0, DVec3::ZERO);
            scene.bodies.push(far);
        }
        scene.pairs = vec![PairDescription {
            a: "beam".into(),
            b: "post".into(),
            effects: vec![Effect::TRIGGER],
            accuracy: None,
        }];
    });
    assert!(nobody.starts_with("Tracking of body 'pen' is for none of its pairs"), "{nobody}");
    let silent =
        refused(|scene| scene.bodies[1].effects = vec![Effect::Tracking { tolerance: 1.0 }]);
    assert_eq!(silent, "Tracking needs Trigger: name Trigger too, or leave Tracking out");
    let nowhere = refused(|scene| scene.bodies[1].path = None);
    assert!(nowhere.contains("'pen'") && nowhere.contains("path"), "{nowhere}");
    let (mut app, _) = tracked_app(&FILTERED, RigidBody::Fixed);
    let tracker = TrackerDescription { settings: TrackerSettings::default(), device: shaky(1) };
    SpawnScene::new(&pen_and_cup(&wander(1, 1.0), tracker, JITTER)).unwrap().spawn(world(&mut app));
    let unsimulated = app.step().unwrap_err().to_string();
    assert!(unsimulated.contains("'pen'") && unsimulated.contains("SimulatedTrackersPlugin"));
    let slow = refused(|scene| scene.bodies[1].tracker.as_mut().unwrap().device.rate = 5.0);
    assert!(slow.contains("'pen'") && slow.contains("lost_after"), "{slow}");
}
