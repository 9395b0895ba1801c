//! An effect that the scene does not name is not in the app: no system, no component, no message,
//! no resource.

use std::collections::BTreeSet;
use std::sync::Arc;

use bevy_app::App;
use bevy_ecs::message::Messages;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{InternedSystemSet, ScheduleLabel, Schedules};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_narrow_phase::Counters;
use cranny_shapes::Cup;

use crate::build::{gate, unit};

const CONTACTS: Effect = Effect::Contacts { margin: 0.1 };
const PROXIMITY: Effect = Effect::proximity(0.5);
const FEEDBACK: Effect = Effect::ForceFeedback { stiffness: 100.0 };
const TRACKING: Effect = Effect::Tracking { tolerance: 0.1 };
const SOUND: Effect = Effect::Sound { above: 0.1 };
const DENTS: Effect = Effect::Deformation { hardness: 100.0, radius: 0.1 };

fn app(effects: &[Effect]) -> SceneApp {
    SceneApp::new(&gate(effects), &RunOptions::default()).unwrap()
}

/// Whether a set is in one of the schedules at all.
fn scheduled(app: &App, set: InternedSystemSet) -> bool {
    let schedules = app.world().resource::<Schedules>();
    [CrannyStep.intern(), CrannyEnd.intern()]
        .into_iter()
        .any(|label| schedules.get(label).unwrap().graph().system_sets.contains(set))
}

#[test]
fn trigger_exists_where_it_is_named_and_only_there() {
    for effects in [&[Effect::TRIGGER][..], &[CONTACTS], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&Effect::TRIGGER));
        let world = app.world();
        assert_eq!(scheduled(app, TriggerSystems::Report.intern()), named);
        assert_eq!(scheduled(app, TriggerSystems::Detect.intern()), named);
        assert_eq!(world.component_id::<TouchingBodies>().is_some(), named);
        assert_eq!(world.contains_resource::<Messages<CollisionStart>>(), named);
        assert_eq!(world.contains_resource::<Messages<CollisionEnd>>(), named);
        // Detection serves both effects, and nobody else.
        assert_eq!(scheduled(app, DetectionSystems::Pairs.intern()), !effects.is_empty());
        assert_eq!(world.contains_resource::<Detector>(), !effects.is_empty());
        assert_eq!(world.contains_resource::<Detected>(), !effects.is_empty());
    }
}

#[test]
fn contacts_exist_where_they_are_named_and_only_there() {
    for effects in [&[CONTACTS][..], &[Effect::TRIGGER], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&CONTACTS));
        let world = app.world();
        assert_eq!(scheduled(app, ContactsSystems::Report.intern()), named);
        assert_eq!(scheduled(app, ContactsSystems::Detect.intern()), named);
        assert_eq!(world.component_id::<BodyContacts>().is_some(), named);
        assert_eq!(world.contains_resource::<ContactReport>(), named);
    }
}

#[test]
fn proximity_exists_where_it_is_named_and_only_there() {
    for effects in [&[PROXIMITY][..], &[Effect::TRIGGER], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&PROXIMITY));
        assert_eq!(scheduled(app, ProximitySystems::Report.intern()), named);
        assert_eq!(scheduled(app, ProximitySystems::Detect.intern()), named);
        assert_eq!(app.world().contains_resource::<ProximityReport>(), named);
    }
}

#[cfg(feature = "rapier")]
#[test]
fn response_exists_where_it_is_named_and_only_there() {
    for effects in [&[Effect::Response][..], &[CONTACTS, Effect::TRIGGER], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&Effect::Response));
        for set in [ResponseSystems::Sync, ResponseSystems::Solve, ResponseSystems::Advance] {
            assert_eq!(scheduled(app, set.intern()), named);
        }
        assert_eq!(app.world().component_id::<SolverBody>().is_some(), named);
        assert_eq!(app.world().contains_resource::<RigidBodies>(), named);
        assert_eq!(app.world().contains_resource::<Gravity>(), named);
        assert_eq!(app.world().component_id::<Friction>().is_some(), named);
        assert_eq!(app.world().component_id::<ExternalForce>().is_some(), named);
        // A kinematic body is moved by one of the two, not by both.
        let guest = app.world().resource::<Bodies>().get(BodyId(1)).unwrap().entity;
        assert_eq!(app.world().get::<Kinematic>(guest).is_some(), !named);
    }
}

#[test]
fn continuous_exists_where_it_is_named_and_only_there() {
    for effects in [&[Effect::TRIGGER, Effect::Continuous][..], &[Effect::Continuous], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&Effect::Continuous));
        assert_eq!(scheduled(app, ContinuousSystems::Hold.intern()), named);
        assert_eq!(scheduled(app, ContinuousSystems::Sync.intern()), named);
        assert_eq!(scheduled(app, ContinuousSystems::Report.intern()), named);
        assert_eq!(app.world().contains_resource::<HeldBack>(), named);
    }
}

#[test]
fn penetration_exists_where_it_is_named_and_only_there() {
    for effects in [&[Effect::Penetration][..], &[Effect::TRIGGER], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&Effect::Penetration));
        assert_eq!(scheduled(app, PenetrationSystems::Report.intern()), named);
        assert_eq!(scheduled(app, PenetrationSystems::Detect.intern()), named);
        assert_eq!(app.world().contains_resource::<PenetrationReport>(), named);
    }
}

#[test]
fn force_feedback_exists_where_it_is_named_and_only_there() {
    for effects in [&[FEEDBACK][..], &[Effect::TRIGGER], &[]] {
        let app = app(effects);
        let (app, named) = (app.app(), effects.contains(&FEEDBACK));
        assert_eq!(scheduled(app, ForceFeedbackSystems::Feel.intern()), named);
        assert_eq!(app.world().contains_resource::<ForceFeedbackReport>(), named);
        // It detects by itself.
        assert_eq!(app.world().contains_resource::<Detector>(), effects.contains(&Effect::TRIGGER));
    }
}

#[test]
fn tracking_exists_where_it_is_named_and_only_there() {
    for effects in [&[Effect::TRIGGER, TRACKING][..], &[Effect::TRIGGER], &[]] {
        let mut app = app(effects);
        // Systems register what they read as they first run.
        assert!(app.step().unwrap());
        let (app, named) = (app.app(), effects.contains(&TRACKING));
        assert_eq!(scheduled(app, TrackingSystems::Lead.intern()), named);
        assert_eq!(scheduled(app, TrackingSystems::Decide.intern()), named);
        assert_eq!(app.world().component_id::<Tracker>().is_some(), named);
        // Nothing is simulated where no body of the scene has a tracker.
        assert!(!scheduled(app, TrackingSystems::Simulate.intern()));
        assert!(!scheduled(app, TrackingSystems::Compare.intern()));
        assert!(!app.world().contains_resource::<TrackingLog>());
        assert!(app.world().component_id::<SimulatedTracker>().is_none());
    }
}

#[cfg(feature = "rapier")]
#[test]
fn sound_and_dents_exist_where_they_are_named_and_only_there() {
    let sound = [Effect::Response, SOUND];
    let dents = [Effect::Response, DENTS];
    for effects in [&sound[..], &dents, &[Effect::Response], &[]] {
        let app = app(effects);
        let app = app.app();
        let (heard, dented) = (effects.contains(&SOUND), effects.contains(&DENTS));
        assert_eq!(scheduled(app, SoundSystems::Report.intern()), heard);
        assert_eq!(app.world().contains_resource::<OngoingSounds>(), heard);
        assert_eq!(app.world().contains_resource::<Messages<SoundEvent>>(), heard);
        assert_eq!(scheduled(app, DeformationSystems::Dent.intern()), dented);
        assert_eq!(app.world().contains_resource::<Messages<Dented>>(), dented);
        assert!(!app.world().contains_resource::<Detector>());
    }
    for alone in [SOUND, DENTS] {
        let refused = SceneApp::new(&gate(&[alone]), &RunOptions::default());
        let (refused, name) = (refused.err().expect("nobody moves bodies"), alone.name());
        let says = format!("{name} needs Response: name Response too, or leave {name} out");
        assert_eq!(refused.to_string(), says);
    }
}

#[cfg(feature = "record")]
#[test]
fn recording_exists_where_it_is_asked_for_and_only_there() {
    let folder = tempfile::tempdir().unwrap();
    for record in [Some(folder.path().join("run.mcap")), None] {
        let named = record.is_some();
        let options = RunOptions { record, ..RunOptions::default() };
        let app = SceneApp::new(&gate(&[]), &options).unwrap();
        assert_eq!(scheduled(app.app(), RecordingSystems::Frame.intern()), named);
        assert_eq!(app.app().world().contains_resource::<FrameRecorder>(), named);
    }
}

#[cfg(feature = "render")]
#[test]
fn rendering_exists_where_it_is_asked_for_and_only_there() {
    let folder = tempfile::tempdir().unwrap();
    for preview in [Some(folder.path().join("run.png")), None] {
        let asked = preview.is_some();
        let pictures = PictureOptions { preview, ..PictureOptions::default() };
        let options = RunOptions { pictures, ..RunOptions::default() };
        let app = SceneApp::new(&gate(&[]), &options).unwrap();
        let present = app.app().world().contains_resource::<Painter>();
        assert_eq!(scheduled(app.app(), RenderingSystems::Picture.intern()), present);
        // Without an adapter there are no pictures though they are asked for.
        assert!(asked || !present);
        if asked && !present {
            let summary = app.finish().unwrap();
            assert_eq!(summary.skipped[0].what, "pictures");
        }
    }
}

#[test]
fn diagnostics_exist_where_they_are_added_and_tell_phases_and_effects() {
    let built = |diagnosed: bool| {
        let mut app = App::new();
        app.add_plugins(CrannyPlugins::new(0.25).unwrap().effects(&[PROXIMITY]).unwrap());
        if diagnosed {
            app.add_plugins(DiagnosticsPlugin);
        }
        app
    };
    let systems = |app: &mut App| Plan::of(app.world_mut()).unwrap().schedules[0].systems.len();
    let mut app = built(false);
    assert!(!app.world().contains_resource::<StepDiagnostics>());
    let before = systems(&mut app);
    let mut app = built(true);
    assert_eq!(systems(&mut app), before + StepSystems::ALL.len() + 1);
    for _ in 0..12 {
        app.world_mut().run_schedule(CrannyStep);
    }
    let costs = app.world().resource::<StepDiagnostics>();
    assert_eq!(costs.steps, 12);
    assert!(StepSystems::ALL.iter().all(|&phase| !costs.total.phase(phase).is_zero()));
    assert!(costs.last.step() < costs.total.step());
    let own = costs.total.effect(EffectKind::Proximity).expect("it reports");
    assert!(own <= costs.total.phase(StepSystems::Report), "{costs:?}");
    assert_eq!(costs.total.effect(EffectKind::Contacts), None);
}

/// Every system that stands in only one of two plans, by schedule and name.
fn difference(one: &Plan, other: &Plan) -> Vec<PlannedSystem> {
    let only_in = |one: &Plan, other: &Plan| -> Vec<PlannedSystem> {
        let schedules = one.schedules.iter().zip(&other.schedules);
        let lacks = |s: &PlannedSchedule, name: &str| s.systems.iter().all(|t| t.name != name);
        schedules
            .flat_map(|(s, t)| s.systems.iter().filter(|system| lacks(t, &system.name)))
            .cloned()
            .collect()
    };
    [only_in(one, other), only_in(other, one)].concat()
}

fn names(plan: &Plan) -> BTreeSet<String> {
    plan.schedules.iter().flat_map(|s| &s.systems).map(|s| s.name.clone()).collect()
}

#[test]
fn one_effect_more_is_exactly_its_systems_more() {
    let without_solver = [
        Effect::TRIGGER,
        PROXIMITY,
        CONTACTS,
        Effect::Penetration,
        FEEDBACK,
        TRACKING,
        Effect::Continuous,
    ];
    let of_response = [Effect::Response, SOUND, DENTS];
    let has_solver = cfg!(feature = "rapier");
    let all = [&without_solver[..], &of_response].concat();
    assert_eq!(all.len(), EffectKind::ALL.len(), "each effect is here");
    let all = if has_solver { &all[..] } else { &without_solver };
    // What works on what another effect does cannot be without it.
    let works = |effects: &[Effect]| {
        let needs = |effect: &Effect| of_response[1..].contains(effect);
        let has = |effect| effects.contains(&effect);
        (has(Effect::Response) || !effects.iter().any(needs))
            && (has(Effect::TRIGGER) || !has(TRACKING))
    };
    // Beside none, each other one, each other one with a solver, and all others.
    let cases = all.iter().flat_map(|&effect| {
        let others = move || all.iter().copied().filter(move |other| *other != effect);
        let with_solver = others().map(|other| vec![other, Effect::Response]);
        let beside = others().map(|other| vec![other]).chain(with_solver);
        let beside = beside.chain([vec![], others().collect()]);
        beside.map(move |without| (without, effect))
    });
    let cases = cases.filter(|(without, effect)| {
        !without.contains(effect) && (has_solver || !without.contains(&Effect::Response))
    });
    for (without, effect) in cases {
        let without = &without[..];
        let with: Vec<Effect> = without.iter().copied().chain([effect]).collect();
        if !works(without) || !works(&with) {
            continue;
        }
        let (less, more) = (app(without).plan().unwrap(), app(&with).plan().unwrap());
        let systems = difference(&less, &more);
        assert!(!systems.is_empty(), "{}", effect.name());
        for system in &systems {
            assert!(!names(&less).contains(&system.name), "{} takes {system:?}", effect.name());
            assert!(system.effects.contains(&effect.name()), "{system:?} for {}", effect.name());
        }
        // And it is the only effect that the plans tell apart.
        assert!(less.absent.iter().any(|absent| absent.name == effect.name()));
        assert_eq!(less.absent.len(), more.absent.len() + 1);
        assert_eq!(more.effects.len(), less.effects.len() + 1);
    }
}

#[test]
fn a_second_effect_shares_detection_with_the_first() {
    let one = app(&[Effect::TRIGGER]).plan().unwrap();
    let both = app(&[Effect::TRIGGER, CONTACTS]).plan().unwrap();
    let more: Vec<String> = names(&both).difference(&names(&one)).cloned().collect();
    assert_eq!(
        more,
        ["contacts::share_contacts", "contacts::take_contacts", "detection::read_deeper",]
    );
}

#[test]
fn the_plan_tells_order_pairs_and_reasons() {
    let mut description = gate(&[]);
    description.bodies[1].effects = vec![Effect::TRIGGER];
    let third = crate::build::cube(
        "aside",
        cranny_world::description::BodyKind::Fixed,
        cranny_exact::DVec3::new(0.0, 9.0, 0.0),
        cranny_exact::DVec3::ZERO,
    );
    description.bodies.push(third);
    let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
    let plan = app.plan().unwrap();
    let steps = &plan.schedules[0];
    let at = |name: &str| steps.systems.iter().position(|s| s.name == name).unwrap();
    assert!(at("detection::read_transforms") < at("detection::detect_pairs"));
    assert!(at("detection::detect_pairs") < at("trigger::report_collisions"));
    assert!(at("trigger::report_collisions") < at("kinematics::follow_velocities"));
    assert_eq!(plan.effects[0].asked_by, ["body 'guest'"]);
    assert_eq!(plan.pairs[0].count, 2);
    assert_eq!(plan.pairs[0].why, "body 'guest' asks for Trigger");
    assert_eq!(plan.pairs[0].detected_by, "world");
    assert_eq!((plan.pairs[1].count, &*plan.pairs[1].why), (1, "both are fixed"));
    assert_eq!(plan.pairs[1].examples, [["gate".to_owned(), "aside".to_owned()]]);
    // Reading the plan leaves the schedules where they were.
    assert!(app.step().unwrap());
    assert_eq!(app.plan().unwrap(), plan);
}

#[test]
fn the_plan_names_who_reads_what_of_effects_and_pairs() {
    let mut description = gate(&[Effect::TRIGGER, PROXIMITY, CONTACTS]);
    let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
    let plan = app.plan().unwrap();
    let of = |name: &str| plan.effects.iter().find(|e| e.name == name).unwrap().read_by.clone();
    assert_eq!(of("Trigger"), ["CollisionStart, CollisionEnd and TouchingBodies read verdict"]);
    assert_eq!(of("Proximity"), ["ProximityReport reads distance, witnesses"]);
    assert!(of("Contacts").iter().any(|reads| reads.starts_with("the summary reads depth")));
    let [pairs] = plan.pairs.as_slice() else { panic!("{:?}", plan.pairs) };
    assert_eq!(
        pairs.read_by[..2],
        ["Trigger reads verdict", "Proximity reads distance, witnesses"]
    );
    assert_eq!(pairs.read_by[2..], of("Contacts"));
    // Every field that is computed has its reader.
    let mut fields = pairs.fields.iter();
    assert!(fields.all(|field| pairs.read_by.iter().any(|reads| reads.contains(field))));
    description.effects.clear();
    let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
    assert!(app.plan().unwrap().pairs[0].read_by.is_empty());
}

#[test]
fn no_concavity_is_made_for_a_scene_whose_effects_need_none() {
    // A cube goes through a cup's wall, across its well and out again.
    let mut scene = gate(&[Effect::TRIGGER, CONTACTS]);
    scene.bodies[0].collision = Arc::new(Cup::default().build().unwrap());
    let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
    let mut done = Counters::default();
    while app.step().unwrap() {
        let detected = app.app().world().resource::<Detected>();
        done += detected.report.as_ref().unwrap().stats.counters;
    }
    assert!(done.triangle_tests > 0, "{done:?}");
    assert_eq!((done.concavities_made, done.pockets_opened, done.pockets_passed), (0, 0, 0));
}

#[test]
fn only_a_summary_has_motion_links_and_energies_followed() {
    let effects = [Effect::TRIGGER, Effect::Response];
    let effects = if cfg!(feature = "rapier") { &effects[..] } else { &effects[..1] };
    let followed = ["motion::", "links::", "energy::"];
    let of = |plan: &Plan| -> Vec<String> {
        let all = names(plan).into_iter();
        all.filter(|name| followed.iter().any(|module| name.starts_with(module))).collect()
    };
    let mut bare = App::new();
    bare.add_plugins(CrannyPlugins::new(0.25).unwrap().effects(effects).unwrap());
    assert_eq!(of(&Plan::of(bare.world_mut()).unwrap()), Vec::<String>::new());
    assert!(!bare.world().contains_resource::<MotionLog>());
    let energies = ["energy::begin_energy", "energy::follow_energy"];
    let energies = if cfg!(feature = "rapier") { &energies[..] } else { &[] };
    let expected = [energies, &["motion::follow_motion"]].concat();
    assert_eq!(of(&app(effects).plan().unwrap()), expected);
}

/// How often a settled app allocates in 32 steps.
fn allocations(app: &mut App) -> u64 {
    let mut step = || app.world_mut().run_schedule(CrannyStep);
    (0..32).for_each(|_| step());
    allocation_counter::measure(|| (0..32).for_each(|_| step())).count_total
}

/// Bodies that stand apart, or cross.
fn bare(effects: &[Effect], kinds: &[EffectKind], apart: f32) -> App {
    let mut app = App::new();
    let plugins = CrannyPlugins::new(0.25).unwrap().effects(effects).unwrap();
    app.add_plugins(plugins.available(kinds).unwrap());
    for i in 0..5u8 {
        let place = Transform::from_xyz(apart * f32::from(i), 0.0, 0.0);
        app.world_mut().spawn((RigidBody::Kinematic, unit(), place));
    }
    app
}

#[test]
fn steps_allocate_nothing_where_nothing_is_asked_or_found() {
    assert_eq!(allocations(&mut bare(&[], &[], 0.25)), 0, "no effect");
    let found = allocations(&mut bare(&[Effect::TRIGGER], &[], 0.25));
    assert!(found > 0, "what is found is listed");
    for effect in [Effect::TRIGGER, PROXIMITY, CONTACTS, Effect::Penetration] {
        let count = allocations(&mut bare(&[effect], &[], 9.0));
        assert_eq!(count, 0, "{} that finds nothing", effect.name());
    }
}

#[test]
fn no_test_is_made_of_pairs_about_which_nobody_asks() {
    let kinds = [EffectKind::Trigger, EffectKind::Proximity, EffectKind::Contacts];
    let mut app = bare(&[], &kinds, 0.25);
    let mut tests = |asks: bool| {
        let world = app.world_mut();
        if asks {
            let first = world.resource::<Bodies>().get(BodyId(0)).unwrap().entity;
            world.entity_mut(first).insert(Trigger);
        }
        world.run_schedule(CrannyStep);
        let report = world.resource::<Detected>().report.clone().unwrap();
        (report.stats.queried_pairs, report.stats.counters.tests() > 0)
    };
    assert_eq!(tests(false), (0, false), "all overlap, and nobody asks");
    assert_eq!(tests(true), (4, true), "one asks, about its four pairs");
}

/// As large as `SmoothNormals`, and nobody's.
#[derive(Component)]
struct Beside(#[expect(dead_code, reason = "only its size counts")] f64);

/// Bytes that it takes to admit a sphere.
fn admitted(effects: &[Effect], smooth: bool) -> u64 {
    let sphere = cranny_shapes::Sphere::default().build().unwrap();
    let sphere = Collider::from_mesh(sphere).unwrap();
    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(0.25).unwrap().effects(effects).unwrap());
    let world = app.world_mut();
    (0..2).for_each(|_| world.run_schedule(CrannyStep));
    let mut body = world.spawn((RigidBody::Kinematic, sphere));
    // A component more is a table of entities more, with or without normals.
    match smooth {
        true => body.insert(SmoothNormals { crease_angle: 0.5 }),
        false => body.insert(Beside(0.5)),
    };
    let mut admit = || world.run_schedule(CrannyStep);
    allocation_counter::measure(&mut admit).bytes_total
}

#[test]
fn smooth_normals_are_made_for_a_solver_alone() {
    for effect in [Effect::TRIGGER, CONTACTS, PROXIMITY] {
        let [flat, smooth] = [false, true].map(|smooth| admitted(&[effect], smooth));
        assert!(smooth.abs_diff(flat) < 1_000, "{}: {flat} {smooth}", effect.name());
    }
    if cfg!(feature = "rapier") {
        let [flat, smooth] = [false, true].map(|smooth| admitted(&[Effect::Response], smooth));
        assert!(smooth > flat + 10_000, "{flat} {smooth}");
    }
}

/// Of these components, those that an app knows after a step.
macro_rules! known {
    ($app:expr; $($component:ident),+) => {
        [$((stringify!($component), $app.world().component_id::<$component>())),+]
            .into_iter()
            .filter_map(|(name, id)| id.map(|_| name))
            .collect::<Vec<_>>()
    };
}

#[test]
fn no_component_of_any_effect_exists_where_none_is_named() {
    let mut app = bare(&[], &[], 0.25);
    app.world_mut().run_schedule(CrannyStep);
    // What asks for an effect, and what effects give.
    let asking = known!(app; Trigger, Proximity, Contacts, Penetration, Response, Continuous, Sound,
        Deformation, ForceFeedback, Tracking, EffectAccuracy, PairAccuracy);
    assert_eq!(asking, [""; 0]);
    let given = known!(app; TouchingBodies, BodyContacts, Tracker, SimulatedTracker);
    assert_eq!(given, [""; 0]);
    #[cfg(feature = "rapier")]
    {
        let solved = known!(app; SolverBody, Friction, Restitution, Density, Mass, GravityScale,
            LockedAxes, ExternalForce, ExternalImpulse, Joint);
        assert_eq!(solved, [""; 0]);
    }
    let mut app = bare(&[Effect::TRIGGER, CONTACTS], &[], 0.25);
    app.world_mut().run_schedule(CrannyStep);
    let given = known!(app; TouchingBodies, BodyContacts, Tracker, SimulatedTracker);
    assert_eq!(given, ["TouchingBodies", "BodyContacts"]);
}
