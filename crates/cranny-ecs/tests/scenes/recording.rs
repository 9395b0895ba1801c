//! What a run writes to MCAP.

use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_record::Recording;
use cranny_world::description::Effect;

use crate::build::gate;

const EFFECTS: [Effect; 2] = [Effect::TRIGGER, Effect::Contacts { margin: 0.1 }];

#[test]
fn frames_hold_the_poses_and_contacts_of_their_step_and_the_last_the_final_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut scene = gate(&EFFECTS);
    scene.record.every = 4;
    // A recording reads everything, though the program reads nothing.
    let plugins = PluginOptions { contact_fields: ContactFields::NONE, ..PluginOptions::default() };
    let options = RunOptions {
        plugins,
        duration: Some(4.5),
        record: Some(path.clone()),
        source: Some("(text)".into()),
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    let world = app.app().world();
    let guest = world.resource::<Bodies>().get(BodyId(1)).unwrap().entity;
    let last = pose_of(world.get::<Transform>(guest).unwrap());
    let summary = app.finish().unwrap();
    assert_eq!(summary.outputs, [path.display().to_string()]);

    let recording = Recording::open(&path).unwrap();
    assert!(recording.is_complete() && !recording.was_interrupted());
    assert_eq!(recording.attachments()[0].data, b"(text)");
    let transforms = recording.transforms().unwrap();
    // Steps 0, 4, 8, 12, 16 and the end, 18.
    let times: Vec<u64> = transforms.iter().map(|(time, _)| *time / 250_000_000).collect();
    assert_eq!(times, [0, 4, 8, 12, 16, 18]);
    assert_eq!(transforms[5].1["guest"], last);
    assert_eq!(last.translation.x, 0.5);
    assert_eq!(transforms[3].1["guest"].translation.x, -1.0);

    let contacts = recording.contacts().unwrap();
    assert!(contacts[2].1.pairs.is_empty());
    assert!(!contacts[3].1.pairs[0].regions.is_empty(), "touching");
    let pair = &contacts[5].1.pairs[0];
    assert_eq!((&*pair.a, &*pair.b), ("gate", "guest"));
    assert_eq!(pair.pose_b.0, last);
    // Flush faces are measured 2^-30 beside.
    assert!((pair.regions[0].depth.unwrap() - 0.5).abs() < 1e-8);
    let events = recording.events().unwrap();
    assert_eq!(events[3].1.events[0].kind, "began");
}

#[test]
fn events_between_frames_are_told_by_the_next_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut scene = gate(&EFFECTS);
    scene.record.every = 30;
    let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    app.finish().unwrap();
    let events = Recording::open(&path).unwrap().events().unwrap();
    let kinds: Vec<Vec<&str>> =
        events.iter().map(|(_, m)| m.events.iter().map(|e| &*e.kind).collect()).collect();
    // Frames at steps 0, 30 and 32; the guest touches from step 12 to 21.
    assert_eq!(kinds, [vec![], vec!["began", "ended"], vec![]]);
}

#[test]
fn an_interrupted_run_leaves_a_whole_recording_that_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
    let mut app = SceneApp::new(&gate(&EFFECTS), &options).unwrap();
    (0..5).for_each(|_| assert!(app.step().unwrap()));
    app.interrupt();
    assert!(!app.step().unwrap());
    let summary = app.finish().unwrap();
    assert_eq!((summary.steps, summary.interrupted), (5, true));
    let recording = Recording::open(&path).unwrap();
    assert!(recording.is_complete() && recording.was_interrupted());
    assert_eq!(recording.transforms().unwrap().len(), 6);
}

#[test]
fn an_unwritable_recording_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().to_owned(), folder.path().join("missing/run.mcap")] {
        let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
        let error = SceneApp::new(&gate(&[]), &options).err().unwrap().to_string();
        assert!(error.contains(&path.display().to_string()), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A replay has one shape a body.
#[test]
fn a_body_that_changes_its_shape_is_refused_in_a_replay() {
    use cranny_exact::Pose;
    use cranny_geometry::{BuildOptions, Model};
    use cranny_record::{Frame, RecordedBody, Recorder, RecordingInfo};

    let model = |size| {
        let mesh = cranny_shapes::Cuboid { size: [1.0, 1.0, size] }.build().unwrap();
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        Model::build(mesh, &options).unwrap().0
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dent.mcap");
    let replayed = |sizes: [f64; 2]| {
        let mut recorder = Recorder::create(&path, &RecordingInfo::new(0.5)).unwrap();
        for (step, model) in sizes.map(model).iter().enumerate() {
            let body = RecordedBody {
                name: "can",
                mesh: model.mesh(),
                color: [1.0; 4],
                color_is_stated: false,
                number: None,
                sensor: false,
                model: Some(model),
                primitive: None,
                kind: None,
            };
            if step > 0 {
                recorder.remove_body("can").unwrap();
            }
            recorder.bodies(&[body]).unwrap();
            let mut frame = Frame::at_step(step as u64);
            frame.poses = vec![("can", Pose::IDENTITY)];
            recorder.frame(&frame).unwrap();
        }
        recorder.finish().unwrap();
        Replay::open(&path).err().map(|error| error.to_string())
    };
    let refused = replayed([1.0, 0.9]).unwrap();
    assert!(refused.contains("dent.mcap") && refused.contains("'can' changes"), "{refused}");
    assert_eq!(replayed([1.0, 1.0]), None, "another one like it");
}

/// A pair; one of its poses is recorded a bit off.
#[test]
fn a_pose_that_is_a_bit_off_is_noticed_in_a_replay() {
    use cranny_exact::{DVec3, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
    use cranny_record::{Frame, PairContacts, RecordedBody, Recorder, RecordingInfo};
    use cranny_world::description::BodyKind;

    let mesh = cranny_shapes::Cuboid { size: [1.0, 1.0, 1.0] }.build().unwrap();
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let (model, _) = Model::build(mesh, &options).unwrap();
    let at = |x: f64| Pose::at(DVec3::new(x, 0.25, 0.125));
    let placed = |pose| Placed { model: &model, pose };
    let margin = 0.01;
    let question = Query::of(Demand::Regions { margin });
    let memory = &mut PairMemory::default();
    let answer = query(placed(Pose::IDENTITY), placed(at(0.75)), &question, memory).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (recorded, different) in [(0.75, 0), (f64::from_bits(0.75f64.to_bits() + 1), 1)] {
        let path = folder.path().join("pair.mcap");
        let mut recorder = Recorder::create(&path, &RecordingInfo::new(0.5)).unwrap();
        let body = |name| RecordedBody {
            name,
            mesh: model.mesh(),
            color: [1.0; 4],
            color_is_stated: false,
            number: None,
            sensor: false,
            model: Some(&model),
            primitive: None,
            kind: Some(BodyKind::Dynamic),
        };
        recorder.bodies(&[body("a"), body("b")]).unwrap();
        let mut frame = Frame::at_step(0);
        frame.poses = vec![("a", Pose::IDENTITY), ("b", at(recorded))];
        frame.contacts = vec![PairContacts {
            a: "a",
            b: "b",
            pose_a: Pose::IDENTITY,
            pose_b: at(recorded),
            frame: None,
            margin: Some(margin),
            answer: &answer,
        }];
        recorder.frame(&frame).unwrap();
        recorder.finish().unwrap();
        let replay = Replay::open(&path).unwrap();
        let report = replay.compare(replay.frames().iter());
        assert_eq!((report.frames, report.different.len()), (1, different), "{report:?}");
        assert_eq!(report.same, 1 - different as u64);
    }
}

/// A replay numbers bodies as the run did, whatever their names, and knows sensors.
#[cfg(feature = "render")]
#[test]
fn a_replay_has_the_runs_numbers_and_sensors() {
    let mut scene = gate(&[Effect::TRIGGER, Effect::Contacts { margin: 0.1 }]);
    scene.bodies[0].name = "z".to_owned();
    scene.bodies[1].sensor = true;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sensed.mcap");
    let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    app.finish().unwrap();
    let replay = Replay::open(&path).unwrap();
    let replayed = replay.scene(&replay.frames()[0]);
    let facts = |scene: &cranny_world::description::SceneDescription| -> Vec<(String, bool)> {
        scene.bodies.iter().map(|body| (body.name.clone(), body.sensor)).collect()
    };
    assert_eq!(facts(&replayed), facts(&scene));
    let moments: Vec<Moment> = replay.frames().iter().map(|frame| replay.moment(frame)).collect();
    let pairs = || moments.iter().flat_map(|moment| &moment.pairs);
    assert!(pairs().count() > 0 && pairs().all(|pair| pair.sensed));
}

/// What a scene says of its looks comes back from its recording.
#[test]
fn a_replay_has_the_scenes_colors_and_cameras() {
    use cranny_exact::DVec3;
    use cranny_world::description::{BodyColor, CameraDescription, CameraView, SceneDescription};

    let mut scene = gate(&EFFECTS);
    scene.bodies[0].color = Some(BodyColor([255, 128, 0]));
    let view = CameraView::LookAt {
        eye: DVec3::new(1.6, -1.2, 0.9),
        target: DVec3::new(0.35, 0.1, 0.2),
        field_of_view: 0.8,
    };
    scene.cameras = vec![CameraDescription { name: "near".to_owned(), view }];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("seen.mcap");
    let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    app.finish().unwrap();
    let replay = Replay::open(&path).unwrap();
    let replayed = replay.scene(&replay.frames()[0]);
    assert_eq!(replayed.cameras, scene.cameras);
    let color = |scene: &SceneDescription, name: &str| {
        scene.bodies.iter().find(|body| body.name == name).unwrap().color
    };
    for body in &scene.bodies {
        assert_eq!(color(&replayed, &body.name), body.color, "{}", body.name);
    }
}
