//! Recordings, written and read back: whole, interrupted, killed, cut, and refused.

mod pendulum;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use cranny_exact::DVec3;
use cranny_record::{
    Frame, LogLevel, ReadError, RecordError, Recorder, Recording, RecordingInfo, answer_digest,
    topic,
};
use foxglove::Decode;
use foxglove::messages::{PointCloud, PosesInFrame, SceneUpdate};
use pendulum::{BODIES, DT, PNG, Pendulum, record};

const STEPS: u64 = 80;

/// All messages of a topic, through the container's own reader.
fn messages(path: &Path, topic: &str) -> Vec<Vec<u8>> {
    let bytes = fs::read(path).unwrap();
    mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .filter(|m| m.channel.topic == topic)
        .map(|m| m.data.into_owned())
        .collect()
}

#[test]
fn what_was_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, pendulum) = record(&path, STEPS).unwrap();
    assert!(!path.exists() && recorder.partial_path().exists());
    let summary = recorder.finish().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "the partial file is gone");
    assert_eq!(summary.bytes, fs::metadata(&path).unwrap().len());

    let expected = [
        (topic::BODIES, "foxglove.SceneUpdate", 1),
        (topic::TRANSFORMS, "foxglove.FrameTransforms", STEPS),
        (topic::CONTACT_SCENE, "foxglove.SceneUpdate", STEPS),
        (topic::CONTACT_POINTS, "foxglove.PointCloud", STEPS),
        (topic::CONTACT_NORMALS, "foxglove.PosesInFrame", STEPS),
        (topic::CONTACTS, "cranny.Contacts", STEPS),
        (topic::EVENTS, "cranny.PairEvents", STEPS),
        (topic::STATS, "cranny.StepStats", STEPS),
        (topic::LOG, "foxglove.Log", 1),
        ("/camera/main", "foxglove.CompressedImage", 1),
    ];
    let recording = Recording::open(&path).unwrap();
    assert!(recording.is_complete() && !recording.was_interrupted());
    let read: BTreeMap<&str, (&str, u64)> = recording
        .topics()
        .iter()
        .map(|(name, t)| (name.as_str(), (t.schema.as_str(), t.messages)))
        .collect();
    let expected: BTreeMap<&str, (&str, u64)> =
        expected.into_iter().map(|(name, schema, n)| (name, (schema, n))).collect();
    assert_eq!(read, expected);
    for (name, (_, count)) in &expected {
        assert_eq!(summary.messages[*name], *count);
        assert_eq!(messages(&path, name).len() as u64, *count);
    }

    let metadata = recording.metadata(topic::METADATA).unwrap();
    assert_eq!((&metadata["scene"][..], &metadata["seed"][..]), ("pendulum", "7"));
    assert_eq!(metadata["dt_bits"], format!("{:016x}", DT.to_bits()));
    assert_eq!(recording.attachments(), Pendulum::info().attachments);
    let transforms = recording.transforms().unwrap();
    for (step, (time, poses)) in (0u64..).zip(&transforms) {
        assert_eq!(*time, (step as f64 * DT * 1e9).round() as u64);
        assert_eq!(poses["bob"], Pendulum::pose(step, STEPS));
    }
    let (_, last) = transforms.last().unwrap();
    let final_poses: BTreeMap<String, _> =
        pendulum.world.bodies().map(|(_, b)| (b.name().to_owned(), b.pose())).collect();
    assert_eq!(*last, final_poses);
}

#[test]
fn contacts_events_and_stats_agree_with_the_world() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, STEPS).unwrap();
    recorder.finish().unwrap();
    let recording = Recording::open(&path).unwrap();
    let (contacts, stats, events) =
        (recording.contacts().unwrap(), recording.stats().unwrap(), recording.events().unwrap());

    let mut pendulum = Pendulum::new();
    let (mut touching, mut reported, mut of_regions) = (BTreeSet::new(), 0, 0);
    for step in 0..STEPS {
        pendulum.world.set_pose(pendulum.bob, Pendulum::pose(step, STEPS)).unwrap();
        let report = pendulum.world.step().unwrap();
        let at = usize::try_from(step).unwrap();
        let message = &contacts[at].1;
        assert_eq!((message.step, message.pairs.len()), (step, report.answers.len()));
        for (pair, found) in message.pairs.iter().zip(&report.answers) {
            let body = |id| pendulum.world.body(id).unwrap();
            assert_eq!((&pair.a[..], &pair.b[..]), (body(found.a).name(), body(found.b).name()));
            // To the bit: -0 and 0 are different here.
            for (read, pose) in
                [(pair.pose_a.0, body(found.a).pose()), (pair.pose_b.0, body(found.b).pose())]
            {
                let bits = |p: cranny_exact::Pose| {
                    let (q, t) = (p.rotation.to_array(), p.translation.to_array());
                    q.into_iter().chain(t).map(f64::to_bits).collect::<Vec<u64>>()
                };
                assert_eq!(bits(read), bits(pose));
            }
            assert_eq!(pair.regions.len(), found.answer.regions.len());
            assert_eq!(pair.solid, found.answer.solid);
            for (read, region) in pair.regions.iter().zip(&found.answer.regions) {
                assert_eq!(read.id, region.id.0);
                assert_eq!(read.point_count as usize, region.points.len());
                assert_eq!(read.curve_count as usize, region.curves.len());
                let deepest = region.deepest.separation;
                assert!((read.deepest.separation - deepest).abs() <= 1e-15 * deepest.abs());
            }
            assert_eq!(pair.contact_count as usize, found.answer.contacts.len());
            assert_eq!(pair.digest, answer_digest(&found.answer));
            reported += pair.regions.len();
        }
        let (_, stats) = &stats[at];
        assert_eq!(stats.contacts, report.stats.contacts);
        assert_eq!(stats.deepest.is_some(), report.stats.deepest.is_some());
        assert_eq!(stats.measures[0].name, "swing");
        for event in &events[at].1.events {
            let pair = (event.a.clone(), event.b.clone());
            let ids = [event.region, event.other];
            let changed = match &event.kind[..] {
                "began" => ids == [None; 2] && touching.insert(pair),
                "ended" => ids == [None; 2] && touching.remove(&pair),
                "region_split" | "region_merged" => {
                    of_regions += 1;
                    ids[0].is_some() && ids[1].is_some() && ids[0] != ids[1]
                }
                _ => false,
            };
            assert!(changed, "{event:?} at {step}");
        }
    }
    assert!(reported > 0 && touching.is_empty(), "the bob met both and left them: {reported}");
    assert!(of_regions > 0, "no region merged or split");
}

#[test]
fn marks_are_stable_and_those_of_parted_pairs_are_deleted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, STEPS).unwrap();
    recorder.finish().unwrap();
    let contacts = Recording::open(&path).unwrap().contacts().unwrap();
    let scenes = messages(&path, topic::CONTACT_SCENE);
    let clouds = messages(&path, topic::CONTACT_POINTS);
    let normals = messages(&path, topic::CONTACT_NORMALS);
    let (mut shown, mut deleted, mut curves) = (BTreeSet::new(), 0, 0);
    for (((scene, cloud), poses), (_, message)) in
        scenes.iter().zip(&clouds).zip(&normals).zip(&contacts)
    {
        let scene = SceneUpdate::decode(&scene[..]).unwrap();
        for deletion in &scene.deletions {
            assert!(shown.remove(&deletion.id), "only what is shown is deleted");
            deleted += 1;
        }
        let now: BTreeSet<String> = scene.entities.iter().map(|e| e.id.clone()).collect();
        assert_eq!(now.len(), scene.entities.len(), "ids are unique");
        assert!(now.is_superset(&shown), "what is not deleted is drawn again");
        shown = now;
        let points: usize =
            message.pairs.iter().flat_map(|p| &p.regions).map(|r| r.point_count as usize).sum();
        let spheres: usize = scene.entities.iter().map(|e| e.spheres.len()).sum();
        let cloud = PointCloud::decode(&cloud[..]).unwrap();
        let regions: usize = message.pairs.iter().map(|p| p.regions.len()).sum();
        assert_eq!((spheres, cloud.data.len()), (regions, points * 20));
        assert_eq!(PosesInFrame::decode(&poses[..]).unwrap().poses.len(), points);
        curves += scene.entities.iter().map(|e| e.lines.len()).sum::<usize>();
    }
    let near = |i: usize| -> BTreeSet<(&str, &str)> {
        let pairs = contacts[i].1.pairs.iter().filter(|p| !p.regions.is_empty());
        pairs.map(|p| (&p.a[..], &p.b[..])).collect()
    };
    let parted: usize = (1..contacts.len()).map(|i| near(i - 1).difference(&near(i)).count()).sum();
    assert_eq!((deleted, shown.len()), (parted, 0));
    assert!(curves > 0 && parted >= 2, "the bob met ring and post and left them: {parted}");
    let bodies = SceneUpdate::decode(&messages(&path, topic::BODIES)[0][..]).unwrap();
    let frames: Vec<&str> = bodies.entities.iter().map(|e| e.frame_id.as_str()).collect();
    assert_eq!(frames, BODIES);
    assert!(bodies.entities.iter().all(|e| e.frame_locked && e.triangles.len() == 1));
}

#[test]
fn an_interrupted_run_is_a_whole_file_that_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, 5).unwrap();
    recorder.finish_interrupted("Ctrl-C").unwrap();
    let recording = Recording::open(&path).unwrap();
    assert!(recording.is_complete() && recording.was_interrupted());
    let end = recording.metadata(topic::METADATA_END).unwrap();
    assert_eq!((&end["why"][..], &end["frames"][..], &end["last_step"][..]), ("Ctrl-C", "5", "4"));
}

#[test]
fn a_kill_loses_less_than_a_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    // A kill: nothing that the process still holds reaches the file. Its bytes are what lies in the
    // file while the recorder lives.
    let (recorder, _) = record(&path, STEPS).unwrap();
    let killed = folder.path().join("killed.mcap.partial");
    fs::copy(recorder.partial_path(), &killed).unwrap();
    drop(recorder);
    let recording = Recording::open(&killed).unwrap();
    assert!(!recording.is_complete() && recording.was_interrupted());
    let frames = recording.transforms().unwrap().len() as u64;
    assert!(frames + u64::from(cranny_record::FRAMES_PER_CHUNK) > STEPS, "{frames} of {STEPS}");
    assert_eq!(recording.topics()[topic::BODIES].messages, 1);
    assert_eq!(recording.metadata(topic::METADATA).unwrap()["scene"], "pendulum");
}

#[test]
fn a_dropped_recorder_leaves_a_readable_partial_file_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, STEPS).unwrap();
    let partial = recorder.partial_path().to_owned();
    drop(recorder);
    assert!(!path.exists());
    let recording = Recording::open(&partial).unwrap();
    assert_eq!(recording.transforms().unwrap().len() as u64, STEPS);
    assert!(recording.was_interrupted(), "it has no end");
}

#[test]
fn a_file_cut_anywhere_is_read_up_to_the_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, STEPS).unwrap();
    recorder.finish().unwrap();
    let whole = fs::read(&path).unwrap();
    let all = Recording::open(&path).unwrap().transforms().unwrap();
    let cut_path = folder.path().join("cut.mcap");
    let mut counts = Vec::new();
    for part in 0..=20 {
        let length = whole.len() * part / 20;
        fs::write(&cut_path, &whole[..length]).unwrap();
        match Recording::open(&cut_path) {
            Ok(recording) => {
                let read = recording.transforms().unwrap();
                assert_eq!(read, all[..read.len()], "cut at {length}");
                assert_eq!(recording.is_complete(), part == 20);
                counts.push(read.len());
            }
            Err(error) => assert!(matches!(error, ReadError::NotMcap { .. }) && part == 0),
        }
    }
    assert!(counts.is_sorted() && counts.last() == Some(&all.len()), "{counts:?}");
    assert!(counts.iter().any(|&n| n > 0 && n < all.len()), "{counts:?}");
}

#[test]
fn equal_runs_give_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = folder.path().join(name);
        record(&path, 20).unwrap().0.finish().unwrap();
        fs::read(path).unwrap()
    };
    assert!(write("a.mcap") == write("b.mcap"));
}

#[test]
fn places_that_cannot_be_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let info = RecordingInfo::new(DT);
    let refusal = |path: &Path| Recorder::create(path, &info).err().unwrap();

    let error = refusal(folder.path());
    assert!(matches!(error, RecordError::NotAFile { .. }), "{error}");
    let error = refusal(Path::new(""));
    assert!(matches!(error, RecordError::NotAFile { .. }), "{error}");
    let error = refusal(&folder.path().join("no/such/run.mcap"));
    assert!(matches!(error, RecordError::MissingFolder { .. }), "{error}");
    assert!(error.to_string().contains("no/such"), "{error}");
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let error = refusal(&file.join("run.mcap"));
    assert!(matches!(error, RecordError::MissingFolder { .. }), "{error}");
    // A folder has the partial file's place: it cannot be created, whoever asks.
    let taken = folder.path().join("run.mcap");
    fs::create_dir(folder.path().join("run.mcap.partial")).unwrap();
    let error = refusal(&taken);
    assert!(matches!(error, RecordError::Create { .. }), "{error}");
    assert!(error.to_string().contains("run.mcap.partial"), "{error}");
    assert!(!taken.exists());
}

#[test]
fn what_viewers_draw_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (mut recorder, _) = record(&path, STEPS).unwrap();
    recorder.remove_body(STEPS, "bob").unwrap();
    recorder.finish().unwrap();
    let recording = Recording::open(&path).unwrap();
    let changes = recording.body_changes().unwrap();
    let [(0, came), (_, left)] = &changes[..] else { panic!("bodies come, and one leaves") };
    assert!(came.came.iter().all(|body| body.color == [0.6, 0.7, 0.8, 1.0]));
    assert_eq!((came.came.len(), &left.left[..]), (BODIES.len(), &["bob".to_owned()][..]));
    assert_eq!(recording.pictures().unwrap()[0].1.camera, "main");

    let (points, normals) =
        (recording.contact_points().unwrap(), recording.contact_normals().unwrap());
    let (curves, contacts) = (recording.contact_curves().unwrap(), recording.contacts().unwrap());
    let mut pendulum = Pendulum::new();
    let (mut most, mut closed) = (0, 0);
    for step in 0..STEPS {
        pendulum.world.set_pose(pendulum.bob, Pendulum::pose(step, STEPS)).unwrap();
        let report = pendulum.world.step().unwrap();
        let at = usize::try_from(step).unwrap();
        let drawn = &points[at].1;
        let found: Vec<_> = report
            .answers
            .iter()
            .enumerate()
            .flat_map(|(i, pair)| pair.answer.contacts.iter().map(move |contact| (i, contact)))
            .collect();
        assert_eq!([drawn.len(), normals[at].1.len()], [found.len(); 2]);
        for ((drawn, pose), (pair, contact)) in drawn.iter().zip(&normals[at].1).zip(&found) {
            let middle = (0.5 * (contact.point_a + contact.point_b)).as_vec3();
            let separation = contact.separation as f32;
            let expected = (middle.to_array(), separation, *pair);
            assert_eq!((drawn.point, drawn.separation, drawn.pair), expected);
            assert_eq!(pose.translation.as_vec3(), middle);
            assert!((pose.rotation * DVec3::X - contact.normal).length() < 1e-6);
        }
        let expected: u32 =
            contacts[at].1.pairs.iter().flat_map(|p| &p.regions).map(|r| r.curve_count).sum();
        assert_eq!(curves[at].1.len(), expected as usize);
        assert!(curves[at].1.iter().all(|curve| curve.points.len() > 1));
        closed += curves[at].1.iter().filter(|curve| curve.closed).count();
        most = most.max(found.len());
    }
    assert!(most > 3 && closed > 3, "{most} {closed}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_and_leaves_no_final_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::os::unix::fs::symlink("/dev/full", folder.path().join("run.mcap.partial")).unwrap();
    let error = record(&path, STEPS).and_then(|(recorder, _)| recorder.finish()).unwrap_err();
    assert!(matches!(error, RecordError::Write { .. }), "{error}");
    let message = error.to_string();
    assert!(message.contains("run.mcap.partial") && message.contains("No space"), "{message}");
    assert!(!path.exists());
}

#[test]
fn bad_calls_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Recorder::create(&path, &RecordingInfo::new(dt)).err().unwrap();
        assert!(matches!(error, RecordError::StepDuration { .. }));
    }
    let mut recorder = Recorder::create(&path, &RecordingInfo::new(DT)).unwrap();
    let pendulum = Pendulum::new();
    pendulum.tell_bodies(&mut recorder).unwrap();
    let error = pendulum.tell_bodies(&mut recorder).unwrap_err();
    assert!(
        matches!(error, RecordError::DuplicateBody { .. }) && error.to_string().contains("ring")
    );
    let error = recorder.image("main", 0, &PNG[1..]).unwrap_err();
    assert!(matches!(error, RecordError::NotPng { .. }));
    let error = recorder.frame(&Frame::at_step(u64::MAX)).unwrap_err();
    assert!(matches!(error, RecordError::TimeOutOfRange { .. }));
    // None of this harmed the recording.
    recorder.log(LogLevel::Warning, "refused").unwrap();
    recorder.frame(&Frame::at_step(0)).unwrap();
    let summary = recorder.finish().unwrap();
    assert_eq!((summary.frames, summary.messages[topic::BODIES]), (1, 1));

    let text = folder.path().join("notes.txt");
    fs::write(&text, "no recording").unwrap();
    assert!(matches!(Recording::open(&text), Err(ReadError::NotMcap { .. })));
    assert!(matches!(Recording::open(folder.path().join("none")), Err(ReadError::Open { .. })));
}

/// Every key that a schema requires is there, and every key that is there the schema knows.
fn check(schema: &serde_json::Value, value: &serde_json::Value, at: &str) {
    let kind = match value {
        serde_json::Value::Object(fields) => {
            for key in schema["required"].as_array().unwrap() {
                assert!(fields.contains_key(key.as_str().unwrap()), "{at} lacks {key}");
            }
            for (key, field) in fields {
                let known = &schema["properties"][key];
                assert!(!known.is_null(), "{at} has an unknown {key}");
                check(known, field, &format!("{at}.{key}"));
            }
            "object"
        }
        serde_json::Value::Array(items) => {
            items.iter().for_each(|item| check(&schema["items"], item, &format!("{at}[]")));
            "array"
        }
        serde_json::Value::String(_) => "string",
        serde_json::Value::Bool(_) => "boolean",
        serde_json::Value::Number(n) if n.is_f64() => "number",
        serde_json::Value::Number(_) => {
            assert!(["integer", "number"].contains(&schema["type"].as_str().unwrap()), "{at}");
            return;
        }
        serde_json::Value::Null => panic!("{at} is null"),
    };
    assert_eq!(schema["type"], kind, "{at}");
}

#[test]
fn json_messages_keep_to_their_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (recorder, _) = record(&path, STEPS).unwrap();
    recorder.finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut checked = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap) {
        let schema = message.channel.schema.as_ref().unwrap();
        if schema.encoding != "jsonschema" {
            continue;
        }
        let schema_json: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
        assert_eq!(schema_json["title"], schema.name);
        check(&schema_json, &serde_json::from_slice(&message.data).unwrap(), &schema.name);
        *checked.entry(schema.name.clone()).or_insert(0) += 1;
    }
    assert_eq!(checked.into_values().collect::<Vec<u64>>(), [STEPS; 3]);
}
