//! Rigid bodies.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_rapier::{BodySpec, Detector as Detection, MassSource};
use cranny_shapes::{Cuboid, Cup, Torus};
use cranny_world::description::{BodyKind, Effect, Normals, PairDescription, SceneDescription};

use crate::build::{cube, drop, scene};

const CONTACTS: Effect = Effect::Contacts { margin: 0.005 };

fn run(app: &mut SceneApp) {
    while app.step().unwrap() {}
}

fn entity(app: &SceneApp, name: &str) -> Entity {
    let bodies = app.app().world().resource::<Bodies>();
    bodies.get(bodies.find(name).unwrap()).unwrap().entity
}

fn height(app: &SceneApp, name: &str) -> f32 {
    app.app().world().get::<Transform>(entity(app, name)).unwrap().translation.z
}

/// A cube flies at another, by more than its radius a step. By volume and area it is a third thick.
#[test]
fn a_scene_says_into_how_many_parts_its_steps_are_divided() {
    let parts = |most_parts: Option<u32>, options: &PluginOptions| {
        let bodies = vec![
            cube("wall", BodyKind::Fixed, DVec3::X * 6.0, DVec3::ZERO),
            cube("thrown", BodyKind::Dynamic, DVec3::ZERO, DVec3::X * 64.0),
        ];
        let gravity = DVec3::ZERO;
        let scene = SceneDescription { gravity, most_parts, ..scene(bodies, &[Effect::Response]) };
        let run = RunOptions { plugins: options.clone(), ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &run).unwrap();
        let mut most = 0;
        while app.step().unwrap() {
            let world = app.app().world();
            most = most.max(world.resource::<RigidBodies>().simulation().parts());
        }
        most
    };
    let by_scene = PluginOptions::default();
    assert_eq!([None, Some(1), Some(2), Some(4)].map(|most| parts(most, &by_scene)), [2, 1, 2, 3]);
    let by_program = PluginOptions { most_parts: Some(1), ..PluginOptions::default() };
    assert_eq!(parts(Some(4), &by_program), 1, "the program's word is the last");
}

#[test]
fn a_box_falls_and_rests_and_is_detected_once() {
    let effects = [Effect::Response, CONTACTS, Effect::TRIGGER];
    let mut app = SceneApp::new(&drop(&effects), &RunOptions::default()).unwrap();
    run(&mut app);
    assert!((height(&app, "box") - 1.0).abs() < 0.01, "{}", height(&app, "box"));
    let world = app.app().world();
    let stats = world.resource::<Detected>().report.as_ref().unwrap().stats;
    assert_eq!((stats.supplied_pairs, stats.queried_pairs), (1, 0));
    assert_eq!(world.resource::<ContactReport>().pairs.len(), 1);
    assert_eq!(world.get::<TouchingBodies>(entity(&app, "box")).unwrap().len(), 1);
    let summary = app.finish().unwrap();
    assert!(summary.energy_drift.unwrap() < 0.01);
    assert!(summary.energy.unwrap().loss > 0.5);
    assert!(summary.deepest.unwrap().depth < 0.05);
    assert!(summary.contacts.max >= 3 && summary.pairs.max == 1);
    assert!(summary.skipped.is_empty(), "{:?}", summary.skipped);
}

#[test]
fn the_same_run_ends_in_the_same_state_whoever_watches() {
    let state = |effects: &[Effect]| {
        let mut app = SceneApp::new(&drop(effects), &RunOptions::default()).unwrap();
        run(&mut app);
        app.finish().unwrap().state_hash
    };
    let alone = state(&[Effect::Response]);
    assert_eq!(alone, state(&[Effect::Response]));
    assert_eq!(alone, state(&[Effect::Response, CONTACTS, Effect::TRIGGER]));
    let mut moved = drop(&[Effect::Response]);
    moved.bodies[1].pose.translation.x += 0.25;
    let mut app = SceneApp::new(&moved, &RunOptions::default()).unwrap();
    run(&mut app);
    assert_ne!(alone, app.finish().unwrap().state_hash);
}

#[test]
fn smooth_normals_are_told_in_the_plan() {
    for (detector, normals, told) in [
        (Detection::Cranny, Normals::Flat, "Response"),
        (Detection::Cranny, Normals::Smooth { crease_angle: 0.2 }, "Response(normals: smooth)"),
        // Nobody else has them.
        (Detection::RapierTrimesh, Normals::Smooth { crease_angle: 0.2 }, "Response"),
    ] {
        let plugins = PluginOptions { detector, ..PluginOptions::default() };
        let options = RunOptions { plugins, ..RunOptions::default() };
        let mut scene = drop(&[Effect::Response]);
        scene.bodies[1].normals = normals;
        let plan = SceneApp::new(&scene, &options).unwrap().plan().unwrap();
        assert_eq!(plan.pairs[0].effects, [told]);
    }
    let mut scene = drop(&[Effect::Response]);
    scene.bodies[1].normals = Normals::Smooth { crease_angle: -1.0 };
    let refused = SceneApp::new(&scene, &RunOptions::default()).err().unwrap();
    assert!(refused.to_string().contains("-1"), "{refused}");
}

#[test]
fn other_detectors_leave_exact_answers_to_the_world() {
    for (detector, exact) in [(Detection::RapierTrimesh, false), (Detection::Cranny, true)] {
        for effects in [&[Effect::Response][..], &[Effect::Response, CONTACTS]] {
            let plugins = PluginOptions { detector, ..PluginOptions::default() };
            let options = RunOptions { plugins, ..RunOptions::default() };
            let mut app = SceneApp::new(&drop(effects), &options).unwrap();
            let plan = app.plan().unwrap();
            let by_both = !exact && effects.len() == 2;
            assert_eq!(
                plan.pairs[0].detected_by,
                if by_both { "solver and world" } else { "solver" }
            );
            run(&mut app);
            let summary = app.finish().unwrap();
            assert_eq!(summary.deepest.is_some(), exact || effects.len() == 2);
            assert_eq!(summary.detector, detector.to_string());
            assert_eq!(summary.time_ms.report > 0.0, exact || effects.len() == 2);
        }
    }
}

#[test]
fn only_pairs_that_are_asked_respond() {
    let bodies = vec![
        cube("floor", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO),
        cube("solid", BodyKind::Dynamic, DVec3::new(0.0, 0.25, 1.125), DVec3::ZERO),
        cube("aside", BodyKind::Dynamic, DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO),
    ];
    let mut description = scene(bodies, &[]);
    description.pairs = vec![PairDescription {
        a: "solid".into(),
        b: "floor".into(),
        effects: vec![Effect::Response],
        accuracy: None,
    }];
    let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
    run(&mut app);
    assert!((height(&app, "solid") - 1.0).abs() < 0.01);
    assert_eq!(height(&app, "aside"), 5.0); // nothing moves it
}

#[test]
fn bodies_without_the_effect_pass_through_each_other() {
    let mut bodies = vec![
        cube("floor", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO),
        cube("ghost", BodyKind::Dynamic, DVec3::new(0.125, 0.0, 1.25), DVec3::ZERO),
        cube("solid", BodyKind::Dynamic, DVec3::new(5.0, 0.0, 1.0), DVec3::ZERO),
    ];
    bodies[2].effects = vec![Effect::Response];
    let mut app = SceneApp::new(&scene(bodies, &[]), &RunOptions::default()).unwrap();
    run(&mut app);
    // The ghost is in the solver's world because it would meet the solid body, but not the floor.
    assert!(height(&app, "ghost") < -2.0);
}

#[test]
fn a_sensor_of_a_scene_is_noticed_and_stops_nothing() {
    let fallen = |sensor: bool| {
        let mut floor = cube("floor", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
        floor.sensor = sensor;
        let falling = cube("box", BodyKind::Dynamic, DVec3::Z * 1.25, DVec3::ZERO);
        let effects = [Effect::Response, Effect::TRIGGER];
        let options = RunOptions::default();
        let mut app = SceneApp::new(&scene(vec![floor, falling], &effects), &options).unwrap();
        let mut starts = 0;
        while app.step().unwrap() {
            starts += app.app().world().resource::<Messages<CollisionStart>>().len();
        }
        (height(&app, "box") < -1.0, starts > 0)
    };
    assert_eq!(fallen(true), (true, true));
    assert_eq!(fallen(false), (false, true));
}

#[test]
fn a_moved_transform_moves_the_rigid_body_and_a_despawned_one_meets_nothing() {
    let mut app = SceneApp::new(&drop(&[Effect::Response]), &RunOptions::default()).unwrap();
    (0..4).for_each(|_| assert!(app.step().unwrap()));
    let thing = entity(&app, "box");
    let lifted = Vec3::new(0.0, 0.0, 40.0);
    app.app_mut().world_mut().get_mut::<Transform>(thing).unwrap().translation = lifted;
    app.step().unwrap();
    assert!((39.8..40.0).contains(&height(&app, "box")));
    app.app_mut().world_mut().get_mut::<Transform>(thing).unwrap().translation.z = 1.02;
    let floor = entity(&app, "floor");
    app.app_mut().world_mut().despawn(floor);
    run(&mut app);
    assert!(height(&app, "box") < -1.0);
}

/// What an app puts into the solver's world by hand has no `Transform`: it holds bodies of the
/// scene, and no answer names it.
#[test]
fn bodies_rest_on_what_only_the_solver_knows() {
    let effects = [Effect::Response, CONTACTS];
    let mut app = SceneApp::new(&drop(&effects), &RunOptions::default()).unwrap();
    let plate = Cuboid { size: [1.0, 1.0, 1.0] }.build().unwrap();
    let (plate, _) = Model::build(plate, &BuildOptions::default()).unwrap();
    let spec = BodySpec {
        shape: (&plate).into(),
        kind: cranny_rapier::BodyKind::Fixed,
        pose: Pose::at(DVec3::new(0.125, 0.0, 0.1)),
        linear_velocity: DVec3::ZERO,
        angular_velocity: DVec3::ZERO,
        mass: MassSource::Density(1.0),
        friction: 0.5,
        restitution: 0.0,
        normals: Normals::Flat,
        groups: u32::MAX,
    };
    let mut bodies = app.app_mut().world_mut().resource_mut::<RigidBodies>();
    let index = bodies.simulation_mut().insert(&spec).unwrap();
    assert_eq!(bodies.id(index), None);
    run(&mut app);
    // A tenth higher than on the floor.
    assert!((height(&app, "box") - 1.1).abs() < 0.01, "{}", height(&app, "box"));
    let bodies = app.app().world().resource::<RigidBodies>();
    let told = bodies.simulation().contact_pairs();
    assert!(told.iter().any(|pair| pair.b == index || pair.a == index), "they do meet");
    assert_eq!(bodies.answers().count(), told.iter().filter(|pair| pair.b != index).count());
}

/// A plank falls past a fixed post, never nearer to it than 0.3.
#[test]
fn contacts_are_told_as_far_as_they_are_asked_for_though_the_solver_looks_less_far() {
    let bodies = vec![
        cube("post", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO),
        cube("plank", BodyKind::Dynamic, DVec3::new(1.3, 0.0, 0.1), DVec3::ZERO),
    ];
    let effects = |margin| [Effect::Response, Effect::Contacts { margin }];
    for (margin, told) in [(0.5, true), (0.29, false)] {
        let description = scene(bodies.clone(), &effects(margin));
        let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
        app.step().unwrap();
        let report = app.app().world().resource::<ContactReport>();
        let separations: Vec<f64> = report
            .pairs
            .iter()
            .flat_map(|p| &p.answer.regions)
            .map(|r| r.deepest.separation)
            .collect();
        assert_eq!(!separations.is_empty(), told, "{margin}: {separations:?}");
        assert!(separations.iter().all(|s| (s - 0.3).abs() < 1e-6), "{separations:?}");
        assert!(app.finish().unwrap().skipped.is_empty());
    }
}

/// The solver gets contacts by patches; regions, curves and depths are reported all the same, and
/// are those of a query at the poses reported with them.
#[test]
fn contacts_of_fine_meshes_are_regions_with_curves_too() {
    let mut lying = cube("lying", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
    let mut falling = cube("falling", BodyKind::Dynamic, DVec3::new(0.3, 0.1, 0.399), DVec3::ZERO);
    for body in [&mut lying, &mut falling] {
        body.collision = Arc::new(Torus::default().build().unwrap());
    }
    let margin = 0.02;
    let effects = [Effect::Response, Effect::Contacts { margin }];
    let mut app =
        SceneApp::new(&scene(vec![lying, falling], &effects), &RunOptions::default()).unwrap();
    let (mut curves, mut depth) = (0, 0.0f64);
    for _ in 0..24 {
        app.step().unwrap();
        let world = app.app().world();
        let stats = world.resource::<Detected>().report.as_ref().unwrap().stats;
        assert_eq!(stats.queried_pairs, 0, "detected a second time");
        for pair in &world.resource::<ContactReport>().pairs {
            let models = [pair.a, pair.b]
                .map(|id| world.resource::<Bodies>().get(id).unwrap().model().unwrap().clone());
            let [a, b] = [0, 1].map(|i| Placed { model: &models[i], pose: pair.poses[i] });
            let ask = Query::of(Demand::Regions { margin });
            let direct = query(a, b, &ask, &mut PairMemory::default()).unwrap();
            assert_eq!(pair.answer.regions.len(), direct.regions.len());
            for (told, direct) in pair.answer.regions.iter().zip(&direct.regions) {
                assert_eq!(told.curves.len(), direct.curves.len());
                let [told, direct] =
                    [told, direct].map(|r| r.depth.unwrap_or(-r.deepest.separation));
                assert!((told - direct).abs() < 1e-9, "{told}, not {direct}");
                depth = depth.max(told);
            }
            curves += pair.answer.regions.iter().map(|r| r.curves.len()).sum::<usize>();
        }
    }
    assert!(curves > 0 && depth > 0.0, "{curves} curves, depth {depth}");
    assert_eq!(app.finish().unwrap().deepest.unwrap().depth, depth);
}

/// Two tori, one falling onto the other, and a program that reads none of their contacts itself.
fn tori(margin: f64) -> SceneApp {
    let mut lying = cube("lying", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
    let mut falling = cube("falling", BodyKind::Dynamic, DVec3::new(0.3, 0.1, 0.399), DVec3::ZERO);
    for body in [&mut lying, &mut falling] {
        body.collision = Arc::new(Torus::default().build().unwrap());
    }
    let description = scene(vec![lying, falling], &[Effect::Response, Effect::Contacts { margin }]);
    let plugins = PluginOptions { contact_fields: ContactFields::NONE, ..PluginOptions::default() };
    let options = RunOptions { plugins, duration: Some(0.375), ..RunOptions::default() };
    SceneApp::new(&description, &options).unwrap()
}

#[test]
fn only_what_is_read_is_computed_and_the_summary_reads_the_solvers_contacts() {
    let mut app = tori(0.02);
    let plan = app.plan().unwrap();
    assert_eq!(plan.effects[0].read_by, ["the summary reads depth"]);
    assert_eq!(plan.pairs[0].fields, ["depth", "solver contacts"]);
    let mut deepest = 0.0f64;
    while app.step().unwrap() {
        for pair in &app.app().world().resource::<ContactReport>().pairs {
            assert!(pair.answer.regions.is_empty() && pair.answer.distance.is_none());
            let depths = pair.answer.contacts.iter().map(|c| -c.separation);
            deepest = depths.fold(deepest, f64::max);
        }
    }
    assert!(deepest > 0.0);
    assert_eq!(app.finish().unwrap().deepest.unwrap().depth, deepest);
}

/// The deepest overlap of a run is the same whether or not somebody reads the depth of each step;
/// who reads it for the run alone has most pairs not searched for it.
#[test]
fn the_summary_has_pairs_searched_for_depths_beyond_the_deepest_alone() {
    let ended = |reads: ContactFields| {
        let mut outer = cube("outer", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
        let mut inner = cube("inner", BodyKind::Dynamic, DVec3::Z * 1.01, DVec3::ZERO);
        for cup in [&mut outer, &mut inner] {
            cup.collision = Arc::new(Cup { segments: 24, ..Cup::default() }.build().unwrap());
        }
        let effects = [Effect::Response, Effect::Contacts { margin: 0.02 }];
        let plugins = PluginOptions { contact_fields: reads, ..PluginOptions::default() };
        let options = RunOptions { plugins, duration: Some(3.0), ..RunOptions::default() };
        let mut app = SceneApp::new(&scene(vec![outer, inner], &effects), &options).unwrap();
        let mut answers = 0;
        for _ in 0..480 {
            app.step().unwrap();
            answers += app.app().world().resource::<RigidBodies>().answers().count();
        }
        (app.finish().unwrap(), answers)
    };
    let (each, of_each) = ended(ContactFields { depth: Some(0.0), ..ContactFields::NONE });
    let (run, of_run) = ended(ContactFields::NONE);
    assert!(run.deepest.as_ref().is_some_and(|deepest| deepest.depth > 0.0));
    assert_eq!((run.deepest, run.state_hash), (each.deepest, each.state_hash));
    assert!(2 * of_run < of_each, "{of_run} answers of {of_each}");
}

#[test]
fn who_reads_more_is_told_more_from_the_next_step_on() {
    let mut app = tori(0.3);
    let regions = ContactFields { regions: true, ..ContactFields::NONE };
    let points = ContactFields { points: true, ..ContactFields::NONE };
    let seen = [ContactFields::NONE, points, regions, ContactFields::NONE].map(|fields| {
        let mut readers = app.app_mut().world_mut().resource_mut::<ContactReaders>();
        readers.set("the test", fields);
        app.step().unwrap();
        let report = app.app().world().resource::<ContactReport>();
        let answers = || report.pairs.iter().map(|pair| &pair.answer);
        let farthest =
            answers().flat_map(|a| &a.contacts).map(|c| c.separation).fold(0.0, f64::max);
        (answers().map(|a| a.regions.len()).sum::<usize>() > 0, farthest > 0.1)
    });
    // The solver itself does not look a tenth of a unit ahead.
    assert_eq!(seen, [(false, false), (false, true), (true, true), (false, false)]);
    while app.step().unwrap() {}
    let mut unread = tori(0.3);
    while unread.step().unwrap() {}
    assert_eq!(app.finish().unwrap().state_hash, unread.finish().unwrap().state_hash);
}

/// Regions of one pair are read, of the others a depth: with the solver and without.
#[test]
fn a_reader_of_one_pair_costs_the_others_nothing() {
    for effects in [&[Effect::Response, Effect::Contacts { margin: 0.1 }][..], &CONTACTS_ALONE] {
        let stacked = |i: usize| {
            let kind = if i == 0 { BodyKind::Fixed } else { BodyKind::Dynamic };
            cube(&format!("cube_{i}"), kind, DVec3::Z * (1.001 * i as f64), DVec3::ZERO)
        };
        let description = scene((0..3).map(stacked).collect(), effects);
        let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
        let regions = ContactFields { regions: true, ..ContactFields::NONE };
        let depth = ContactFields { depth: Some(0.0), ..ContactFields::NONE };
        let pair = [BodyId(2), BodyId(1)];
        let mut found = |of_pair: ContactFields| {
            let mut readers = app.app_mut().world_mut().resource_mut::<ContactReaders>();
            readers.set(ContactReaders::PROGRAM, depth);
            readers.set_of_pair("the test", (pair[0], pair[1]), of_pair);
            app.step().unwrap();
            let report = app.app().world().resource::<ContactReport>();
            let with_regions = report.pairs.iter().filter(|p| !p.answer.regions.is_empty());
            let pairs = with_regions.map(|pair| (pair.a.0, pair.b.0)).collect::<Vec<_>>();
            // What the solver's step found is not searched for again.
            let queried = app.app().world().resource::<Detected>().report.as_ref().unwrap();
            assert!(effects.len() == 1 || queried.stats.queried_pairs == 0);
            pairs
        };
        assert_eq!(found(regions), [(1, 2)]);
        assert_eq!(found(ContactFields::NONE), []);
    }
}

const CONTACTS_ALONE: [Effect; 1] = [Effect::Contacts { margin: 0.1 }];

#[test]
fn more_layers_than_bits_are_refused() {
    let mut description = drop(&[Effect::Response]);
    description.bodies[0].layers = (0..33).map(|i| format!("layer {i}")).collect();
    let error = SceneApp::new(&description, &RunOptions::default()).err().unwrap().to_string();
    assert!(error.contains("34") && error.contains("32"), "{error}");
}
