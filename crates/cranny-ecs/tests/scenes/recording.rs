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

/// Cans that are dented over and over: each pair is computed anew of the shapes that it was found
/// with, whatever steps are recorded, and a moment is drawn with them.
#[cfg(all(feature = "rapier", feature = "scene"))]
#[test]
fn a_replay_follows_shapes_that_change() {
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let loaded = cranny_scene::load_scene(&scenes.join("dented_cans.ron")).unwrap();
    let mut scene = loaded.description;
    scene.effects.push(Effect::Contacts { margin: 0.01 });
    let folder = tempfile::tempdir().unwrap();
    for every in [1, 3] {
        scene.record.every = every;
        scene.duration = 0.6;
        let path = folder.path().join("dents.mcap");
        let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
        let mut app = SceneApp::new(&scene, &options).unwrap();
        while app.step().unwrap() {}
        app.finish().unwrap();
        let replay = Replay::open(&path).unwrap();
        let report = replay.compare(replay.frames().iter());
        assert_eq!(report.different, []);
        let came: Vec<_> = replay.recording().body_changes().unwrap();
        let dents = came.len() - 1;
        assert!(dents > 8 && report.same > 50, "{dents} dents, {} pairs", report.same);
        // Backwards too: shapes are those of the frame, not of the one before.
        let again = replay.compare(replay.frames().iter().rev());
        assert_eq!((again.same, again.different.len()), (report.same, 0));
        let [first, last] = [0, replay.frames().len() - 1].map(|i| &replay.frames()[i]);
        let mesh = |frame| replay.scene(frame).bodies[2].visual.clone().unwrap();
        assert_eq!(mesh(first).bounds(), scene.bodies[2].collision.bounds());
        assert!(mesh(last) != mesh(first), "dented");
    }
}

/// A shape counts from the step on that it was recorded for.
#[test]
fn a_shape_of_another_moment_is_noticed_in_a_replay() {
    use cranny_exact::{DVec3, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
    use cranny_record::{Frame, PairContacts, RecordedBody, Recorder, RecordingInfo};

    let models = [1.0, 0.875].map(|size| {
        let mesh = cranny_shapes::Cuboid { size: [1.0, 1.0, size] }.build().unwrap();
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        Model::build(mesh, &options).unwrap().0
    });
    let poses = [Pose::IDENTITY, Pose::at(DVec3::new(0.25, 0.5, 0.75))];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dent.mcap");
    let margin = 0.01;
    let compared = |changes_at: u64| {
        let mut recorder = Recorder::create(&path, &RecordingInfo::new(0.5)).unwrap();
        let body = |name, model| RecordedBody {
            name,
            mesh: Model::mesh(model),
            color: [1.0; 4],
            color_is_stated: false,
            number: None,
            sensor: false,
            model: Some(model),
            primitive: None,
            kind: None,
        };
        recorder.bodies(0, &[body("can", &models[0]), body("table", &models[0])]).unwrap();
        for step in 0..4 {
            if step == changes_at {
                recorder.remove_body(step, "can").unwrap();
                recorder.bodies(step, &[body("can", &models[1])]).unwrap();
            }
            let shape = &models[usize::from(step >= 2)];
            let [a, b] = [(shape, poses[0]), (&models[0], poses[1])]
                .map(|(model, pose)| Placed { model, pose });
            let question = Query::of(Demand::Regions { margin });
            let answer = query(a, b, &question, &mut PairMemory::default()).unwrap();
            let mut frame = Frame::at_step(step);
            frame.poses = vec![("can", poses[0]), ("table", poses[1])];
            frame.contacts = vec![PairContacts {
                a: "can",
                b: "table",
                pose_a: poses[0],
                pose_b: poses[1],
                frame: None,
                margin: Some(margin),
                answer: &answer,
            }];
            recorder.frame(&frame).unwrap();
        }
        recorder.finish().unwrap();
        let replay = Replay::open(&path).unwrap();
        let report = replay.compare(replay.frames().iter());
        (report.same, report.different.iter().map(|d| d.time).collect::<Vec<_>>())
    };
    assert_eq!(compared(2), (4, vec![]));
    assert_eq!(compared(1), (3, vec![0.5]));
    assert_eq!(compared(3), (3, vec![1.0]));
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
        recorder.bodies(0, &[body("a"), body("b")]).unwrap();
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
