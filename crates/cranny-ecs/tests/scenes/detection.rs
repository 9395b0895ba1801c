//! Triggers and contacts without a solver.

use bevy_ecs::message::Messages;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_world::description::{BodyKind, Effect, PairDescription};

use crate::build::{cube, gate, scene};

const CONTACTS: Effect = Effect::Contacts { margin: 0.5 };

#[derive(Resource, Default)]
struct Heard(Vec<(u64, &'static str, BodyId, BodyId)>);

fn listen(app: &mut SceneApp) {
    let app = app.app_mut();
    app.init_resource::<Heard>();
    app.add_observer(
        |e: On<CollisionStart>, time: Res<SimulatedTime>, mut heard: ResMut<Heard>| {
            heard.0.push((time.steps(), "start", e.ids[0], e.ids[1]));
        },
    );
    app.add_observer(|e: On<CollisionEnd>, time: Res<SimulatedTime>, mut heard: ResMut<Heard>| {
        heard.0.push((time.steps(), "end", e.ids[0], e.ids[1]));
    });
}

fn messages<M: Message + Copy>(app: &SceneApp) -> Vec<M> {
    app.app().world().resource::<Messages<M>>().iter_current_update_messages().copied().collect()
}

#[test]
fn touching_is_told_once_a_pair_by_message_and_to_each_body_by_event() {
    let mut app = SceneApp::new(&gate(&[Effect::TRIGGER]), &RunOptions::default()).unwrap();
    listen(&mut app);
    let guest = app.app().world().resource::<Bodies>().get(BodyId(1)).unwrap().entity;
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    let mut touching = Vec::new();
    while {
        let more = app.step().unwrap();
        let done = app.steps_done() - 1;
        starts.extend(messages::<CollisionStart>(&app).iter().map(|m| (done, m.ids)));
        ends.extend(messages::<CollisionEnd>(&app).iter().map(|m| (done, m.ids)));
        if !app.app().world().get::<TouchingBodies>(guest).unwrap().is_empty() {
            touching.push(done);
        }
        more
    } {}
    let (gate, guest) = (BodyId(0), BodyId(1));
    assert_eq!(starts, [(12, [gate, guest])]);
    assert_eq!(ends, [(21, [gate, guest])]);
    assert_eq!(touching, (12..21).collect::<Vec<_>>());
    let heard = &app.app().world().resource::<Heard>().0;
    let expected = [
        (12, "start", gate, guest),
        (12, "start", guest, gate),
        (21, "end", gate, guest),
        (21, "end", guest, gate),
    ];
    assert_eq!(heard[..], expected);
}

#[test]
fn a_body_that_is_despawned_ends_what_it_touched() {
    let mut app = SceneApp::new(&gate(&[Effect::TRIGGER]), &RunOptions::default()).unwrap();
    listen(&mut app);
    (0..15).for_each(|_| assert!(app.step().unwrap()));
    let guest = app.app().world().resource::<Bodies>().get(BodyId(1)).unwrap().entity;
    assert!(app.app_mut().world_mut().despawn(guest));
    let mut detector = app.app_mut().world_mut().resource_mut::<Detector>();
    assert_eq!(detector.world().bodies().len(), 1);
    app.step().unwrap();
    assert_eq!(messages::<CollisionEnd>(&app).len(), 1);
    let heard = &app.app().world().resource::<Heard>().0;
    assert_eq!(heard[2..], [(15, "end", BodyId(0), BodyId(1))]);
    let summary = app.finish().unwrap();
    assert_eq!(summary.steps, 16);
}

#[test]
fn pairs_without_the_effect_hear_nothing() {
    let mut description = gate(&[CONTACTS]);
    let far = cube("far", BodyKind::Fixed, DVec3::new(2.0, 0.0, 0.0), DVec3::ZERO);
    description.bodies.push(far);
    description.pairs = vec![PairDescription {
        a: "far".into(),
        b: "guest".into(),
        effects: vec![Effect::TRIGGER],
        accuracy: None,
    }];
    let mut app = SceneApp::new(&description, &RunOptions::default()).unwrap();
    listen(&mut app);
    while app.step().unwrap() {}
    let heard = &app.app().world().resource::<Heard>().0;
    assert_eq!(heard.len(), 4);
    assert!(heard.iter().all(|(_, _, a, b)| *a != BodyId(0) && *b != BodyId(0)));
}

#[test]
fn contacts_refer_to_the_poses_at_the_beginning_of_their_step() {
    let mut app = SceneApp::new(&gate(&[CONTACTS]), &RunOptions::default()).unwrap();
    (0..14).for_each(|_| assert!(app.step().unwrap()));
    // Step 13 began with the guest at x = -0.75: a quarter deep.
    let world = app.app().world();
    let report = world.resource::<ContactReport>();
    assert_eq!((report.step, report.pairs.len()), (13, 1));
    let pair = &report.pairs[0];
    assert_eq!(pair.poses[1].translation, DVec3::new(-0.75, 0.0, 0.0));
    // Flush faces are measured 2^-30 beside.
    assert!((pair.answer.regions[0].depth.unwrap() - 0.25).abs() < 1e-8);
    let guest = world.resource::<Bodies>().get(pair.b).unwrap().entity;
    assert_eq!(world.get::<Transform>(guest).unwrap().translation, Vec3::new(-0.5, 0.0, 0.0));
    let share = world.get::<BodyContacts>(guest).unwrap();
    assert_eq!((Some(share.depth), share.partners), (pair.answer.regions[0].depth, 1));
    // The end reports the final poses.
    app.interrupt();
    assert!(!app.step().unwrap());
    let summary = app.finish().unwrap();
    let deepest = summary.deepest.unwrap();
    assert!((deepest.depth - 0.5).abs() < 1e-8 && deepest.step == 14);
    assert_eq!((&*deepest.a, &*deepest.b), ("gate", "guest"));
    assert!(summary.interrupted);
    assert_eq!((summary.energy_drift, summary.motion[0].displacement[0]), (None, 3.5));
}

#[test]
fn without_a_solver_the_summary_reads_points_too_and_no_regions() {
    let plugins = PluginOptions { contact_fields: ContactFields::NONE, ..PluginOptions::default() };
    let options = RunOptions { plugins, ..RunOptions::default() };
    let mut askew = gate(&[CONTACTS]);
    // No faces flush.
    askew.bodies[1].pose.translation += DVec3::new(0.1, 0.3, 0.2);
    let mut app = SceneApp::new(&askew, &options).unwrap();
    let plan = app.plan().unwrap();
    assert_eq!(plan.effects[0].read_by, ["the summary reads depth, points"]);
    assert_eq!(plan.pairs[0].fields, ["depth", "points"]);
    while app.step().unwrap() {
        let world = app.app().world();
        let report = world.resource::<ContactReport>();
        // Deep overlaps have no other contacts than those of regions.
        let none = |pair: &ContactPair| pair.answer.solid || pair.answer.regions.is_empty();
        assert!(report.pairs.iter().all(none));
        assert_eq!(report.pairs.len(), usize::from((10..=21).contains(&report.step)));
    }
    let summary = app.finish().unwrap();
    assert!(summary.contacts.max >= 4 && summary.deepest.unwrap().depth > 0.0);
}

#[test]
fn whoever_moves_the_transform_moves_the_body() {
    let bodies = vec![
        cube("a", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO),
        cube("b", BodyKind::Dynamic, DVec3::new(5.0, 0.0, 0.0), DVec3::ZERO),
    ];
    let mut app = SceneApp::new(&scene(bodies, &[CONTACTS]), &RunOptions::default()).unwrap();
    app.step().unwrap();
    assert!(app.app().world().resource::<ContactReport>().pairs.is_empty());
    let b = app.app().world().resource::<Bodies>().get(BodyId(1)).unwrap().entity;
    app.app_mut().world_mut().get_mut::<Transform>(b).unwrap().translation.x = 1.25;
    app.step().unwrap();
    let report = app.app().world().resource::<ContactReport>();
    assert_eq!(report.pairs[0].answer.regions[0].deepest.separation, 0.25);
    app.app_mut().world_mut().get_mut::<Transform>(b).unwrap().scale.x = 2.0;
    let error = app.step().unwrap_err().to_string();
    assert!(error.contains("'b'") && error.contains("scale"), "{error}");
}

#[test]
fn what_nobody_moves_is_said_to_stand_still() {
    let bodies = vec![cube("b", BodyKind::Dynamic, DVec3::ZERO, DVec3::ZERO)];
    let app = SceneApp::new(&scene(bodies, &[Effect::TRIGGER]), &RunOptions::default()).unwrap();
    let summary = app.finish().unwrap();
    assert_eq!((summary.steps, summary.simulated_s), (0, 0.0));
    assert!(summary.skipped[0].what.contains("1 dynamic"));
    assert_eq!(summary.deepest, None);
}

#[test]
fn a_scene_that_contradicts_itself_is_refused() {
    let refused = |description| {
        SceneApp::new(&description, &RunOptions::default()).err().unwrap().to_string()
    };
    let mut unknown = gate(&[]);
    unknown.pairs = vec![PairDescription {
        a: "gate".into(),
        b: "nobody".into(),
        effects: vec![],
        accuracy: None,
    }];
    assert!(refused(unknown).contains("'nobody'"));
    let mut index = gate(&[]);
    index.excluded_pairs = vec![(0, 7)];
    assert!(refused(index).contains('7'));
    let mut step = gate(&[]);
    step.step = 0.0;
    assert!(refused(step).contains("above 0"));
}
