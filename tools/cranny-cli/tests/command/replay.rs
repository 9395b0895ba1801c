//! `cranny replay`: the same to the bit, whole or cut off; pictures of any moment; clear refusals.

use crate::harness::{Folder, argument, run};

/// A box that falls onto another one, askew, and keeps turning.
const DROP: &str = r#"(
    step: 0.015625, duration: 1, seed: 3,
    bodies: [
        (name: "floor", shape: Generator(Cuboid(size: (4, 4, 1))), kind: Fixed),
        (name: "box", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0.125, 0, 1.05)),
         velocity: (angular: (0.3, 0.2, 0.5))),
    ],
    effects: [Response(), Contacts(margin: 0.01)],
)"#;

/// A recording of the scene, without pictures.
fn recorded(folder: &Folder) -> String {
    let (scene, path) = (folder.write("drop.ron", DROP), argument(&folder.path("drop.mcap")));
    let outcome = run(&["run", &scene, "--record", &path]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    path
}

#[test]
fn a_recording_comes_out_the_same_to_the_bit() {
    let folder = Folder::new();
    let path = recorded(&folder);
    let line = run(&["replay", &path, "--format", "json"]).json_lines().remove(0);
    assert_eq!((&line["complete"], &line["frames"]), (&true.into(), &65.into()), "{line}");
    assert_eq!(line["verified"], true, "{line}");
    assert!(line["same"].as_u64().unwrap() > 40 && line["unknown"] == 0, "{line}");
    assert_eq!(line["different"].as_array().unwrap().len(), 0, "{line}");
    let some = run(&["replay", &path, "--from", "0.5", "--every", "8", "--format", "json"]);
    assert_eq!(some.json_lines()[0]["frames"], 5);
}

#[test]
fn a_recording_that_was_cut_off_is_read_as_far_as_it_is_whole() {
    let folder = Folder::new();
    let bytes = std::fs::read(recorded(&folder)).unwrap();
    let mut whole_frames = 0;
    for part in 1..16 {
        let path = folder.write("cut.mcap.partial", &bytes[..bytes.len() * part / 16]);
        let outcome = run(&["replay", &path]);
        match outcome.code {
            Some(0) => {
                assert!(outcome.stdout.contains("cut off"), "{outcome:?}");
                assert!(outcome.stdout.contains(" 0 different"), "{outcome:?}");
                whole_frames += 1;
            }
            _ => outcome.assert_refused(2, &["cut.mcap.partial"]),
        }
    }
    assert!(whole_frames > 3, "{whole_frames}");
}

#[test]
fn a_damaged_recording_is_refused_or_read_up_to_the_damage() {
    let folder = Folder::new();
    let bytes = std::fs::read(recorded(&folder)).unwrap();
    for part in 1..24 {
        let mut damaged = bytes.clone();
        damaged[bytes.len() * part / 24] ^= 0x10;
        let path = folder.write("damaged.mcap", &damaged);
        let outcome = run(&["replay", &path]);
        match outcome.code {
            // Damage in the index or in a picture costs no contact.
            Some(0) => assert!(outcome.stdout.contains(" 0 different"), "{outcome:?}"),
            _ => outcome.assert_refused(2, &["damaged.mcap"]),
        }
    }
}

#[test]
fn a_replay_that_compared_nothing_has_verified_nothing() {
    let folder = Folder::new();
    let path = argument(&folder.path("bare.mcap"));
    let bare = DROP.replace(", Contacts(margin: 0.01)", "");
    let scene = folder.write("bare.ron", &bare);
    assert_eq!(run(&["run", &scene, "--record", &path]).code, Some(0));
    let outcome = run(&["replay", &path]);
    assert_eq!(outcome.code, Some(1), "{outcome:?}");
    assert!(outcome.stderr.contains("the recording holds no pairs"), "{outcome:?}");
    assert!(outcome.stdout.contains("nothing anew: no pair of 65 frames"), "{outcome:?}");
    // Before the box is near.
    let early = run(&["replay", &recorded(&folder), "--at", "0", "--format", "json"]);
    assert_eq!(early.code, Some(1), "{early:?}");
    assert!(early.stdout.contains("\"verified\":false"), "{early:?}");
    assert!(early.stderr.contains("the frames that were chosen hold no pairs"), "{early:?}");
}

/// Nothing but the solver: no pair is recorded, and every pose is one of a run of the same scene.
#[test]
fn a_scene_simulated_again_comes_out_the_same_to_the_bit() {
    let folder = Folder::new();
    let path = argument(&folder.path("bare.mcap"));
    let scene = folder.write("bare.ron", DROP.replace(", Contacts(margin: 0.01)", ""));
    assert_eq!(run(&["run", &scene, "--record", &path, "--seed", "7"]).code, Some(0));
    let outcome = run(&["replay", &path, "--scene", &scene]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let says =
        "65 frames again: 130 poses of bodies the same to the bit, with their shapes, 0 different";
    assert!(outcome.stdout.contains(says), "{outcome:?}");
    let some = ["--from", "0.25", "--to", "0.5", "--every", "4", "--format", "json"];
    let line = run(&[&["replay", &path, "--scene", &scene][..], &some].concat()).json_lines();
    assert_eq!((&line[0]["verified"], &line[0]["simulated"]["same"]), (&true.into(), &10.into()));
    // Cut off in the middle: as far as it is whole.
    let bytes = std::fs::read(&path).unwrap();
    let cut = folder.write("cut.mcap.partial", &bytes[..bytes.len() * 3 / 4]);
    let outcome = run(&["replay", &cut, "--scene", &scene]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");

    let other = folder.write("other.ron", DROP);
    let refused = run(&["replay", &path, "--scene", &other]);
    refused.assert_refused(2, &["other.ron", "not the one that was recorded", "scene.ron"]);
    let unused = run(&["replay", &path, "--set", "gravity.z=-5"]);
    unused.assert_refused(2, &["--set", "Add --scene"]);
}

#[test]
fn another_floor_or_another_setting_is_noticed_where_it_is_simulated_again() {
    let folder = Folder::new();
    let floor = |size| cranny_shapes::Cuboid { size: [4.0, 4.0, size] }.build().unwrap();
    folder.mesh("floor.obj", &floor(1.0));
    let path = argument(&folder.path("drop.mcap"));
    let text = DROP.replace("Generator(Cuboid(size: (4, 4, 1)))", "Mesh(path: \"floor.obj\")");
    let scene = folder.write("drop.ron", text);
    let set = ["--set", "gravity.z=-5"];
    let record = ["run", &scene, "--record", &path];
    assert_eq!(run(&[&record[..], &set].concat()).code, Some(0));
    let again = ["replay", &path, "--scene", &scene];
    run(&again).assert_refused(2, &["drop.ron", "with the same --set"]);
    let again = [&again[..], &set].concat();
    assert_eq!(run(&again).code, Some(0));
    folder.mesh("floor.obj", &floor(0.99));
    let outcome = run(&again);
    assert_eq!(outcome.code, Some(1), "{outcome:?}");
    for line in ["floor has another shape, from 0.000000 s on", "box is at "] {
        assert!(outcome.stdout.contains(line), "{outcome:?}");
    }
    assert!(outcome.stderr.contains(" poses or shapes"), "{outcome:?}");
}

/// A box that comes down on a floor, and a trigger.
fn gate() -> String {
    DROP.replace("Response(), Contacts(margin: 0.01)", "Trigger()").replace(
        "velocity: (angular: (0.3, 0.2, 0.5))",
        "kind: Kinematic, velocity: (linear: (0, 0, -0.5))",
    )
}

#[test]
fn an_event_that_does_not_come_again_is_named() {
    let folder = Folder::new();
    let floor = |size| cranny_shapes::Cuboid { size: [4.0, 4.0, size] }.build().unwrap();
    folder.mesh("floor.obj", &floor(1.0));
    let text = gate().replace("Generator(Cuboid(size: (4, 4, 1)))", "Mesh(path: \"floor.obj\")");
    let (scene, path) = (folder.write("gate.ron", text), argument(&folder.path("gate.mcap")));
    assert_eq!(run(&["run", &scene, "--record", &path]).code, Some(0));
    let again = ["replay", &path, "--scene", &scene];
    let same = run(&again);
    assert_eq!(same.code, Some(0), "{same:?}");
    assert!(same.stdout.contains("0 different; 1 event the same"), "{same:?}");
    // The box does not come down so far.
    folder.mesh("floor.obj", &floor(0.01));
    let outcome = run(&again);
    assert_eq!(outcome.code, Some(1), "{outcome:?}");
    let says = "the first other event at 0.109375 s: floor and box: began";
    assert!(outcome.stdout.contains(says), "{outcome:?}");
    assert!(outcome.stderr.contains("65 poses or shapes and events"), "{outcome:?}");
}

/// A level from the command line, and events at it.
#[test]
fn a_run_at_another_level_is_simulated_again_at_that() {
    let folder = Folder::new();
    let (scene, path) = (folder.write("gate.ron", gate()), argument(&folder.path("gate.mcap")));
    let record = ["run", &scene, "--record", &path, "--accuracy", "boxes"];
    assert_eq!(run(&record).code, Some(0));
    let outcome = run(&["replay", &path, "--scene", &scene, "--format", "json"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let simulated = &outcome.json_lines()[0]["simulated"];
    assert_eq!((&simulated["events"], &simulated["other_event"]), (&1.into(), &().into()));
}

#[test]
fn any_moment_is_drawn_in_any_view() {
    let folder = Folder::new();
    let path = recorded(&folder);
    for view in ["page", "scene", "section", "xray", "wireframe", "motion", "heat"] {
        let picture = argument(&folder.path(&format!("{view}.png")));
        let outcome = run(&[
            "replay", &path, "--at", "0.3", "--render", &picture, "--view", view, "--size",
            "640x200",
        ]);
        if outcome.stderr.contains("no graphics adapter") {
            outcome.assert_refused(1, &["mesa-vulkan-drivers"]);
            continue;
        }
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        assert_eq!(outcome.stderr, "", "nobody else's noise");
        assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    }
}

#[test]
fn wrong_input_is_refused() {
    let folder = Folder::new();
    let text = folder.write("text.mcap", "no recording");
    run(&["replay", &text]).assert_refused(2, &["text.mcap", "no MCAP recording"]);
    let missing = argument(&folder.path("missing.mcap"));
    run(&["replay", &missing]).assert_refused(2, &["missing.mcap"]);
    let path = recorded(&folder);
    run(&["replay", &path, "--from", "7"]).assert_refused(2, &["--from 7", "from 0 to 1 s"]);
    let picture = argument(&folder.path("a.png"));
    let wrong = ["replay", &path, "--at", "0", "--render", &picture, "--camera", "aside"];
    let outcome = run(&wrong);
    if !outcome.stderr.contains("no graphics adapter") {
        outcome.assert_refused(2, &["aside", "isometric"]);
    }
    assert_eq!(run(&["replay", &path, "--size", "0x5"]).code, Some(2));
    let undrawn = run(&["replay", &path, "--camera", "front"]);
    undrawn.assert_refused(2, &["--camera front", "Add --render"]);
    for (option, says) in [
        ("--at", "a number of seconds of at least 0"),
        ("--from", "a number of seconds of at least 0"),
        ("--to", "a number of seconds of at least 0"),
        ("--every", "a whole number from 1 to 4294967295"),
    ] {
        let refused = run(&["replay", &path, option, "-1"]);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.stderr.contains(says) && !refused.stderr.contains("tip"), "{refused:?}");
    }
}

#[test]
fn a_scene_is_no_recording_and_one_without_bodies_is_not_called_damaged() {
    let folder = Folder::new();
    let (page, path) = (argument(&folder.path("a.html")), argument(&folder.path("empty.mcap")));
    let scene = folder.write("empty.ron", "(duration: 0.1, step: 0.01)");
    for command in [&["replay", &scene][..], &["report", &scene, "--out", &page]] {
        run(command).assert_refused(2, &["empty.ron", "is no recording", "cranny run"]);
    }
    assert_eq!(run(&["run", &scene, "--record", &path]).code, Some(0));
    for command in [&["replay", &path][..], &["report", &path, "--out", &page]] {
        run(command).assert_refused(2, &["empty.mcap", "its scene has no bodies"]);
    }
}

/// Two pictures are wider than three: where contacts are not recorded, none is magnified.
#[test]
fn a_page_without_recorded_contacts_has_no_blank_picture() {
    let folder = Folder::new();
    let bare = folder.write("bare.ron", DROP.replace(", Contacts(margin: 0.01)", ""));
    let path = argument(&folder.path("bare.mcap"));
    assert_eq!(run(&["run", &bare, "--record", &path]).code, Some(0));
    let picture = argument(&folder.path("page.png"));
    let outcome = run(&["replay", &path, "--at", "1", "--render", &picture]);
    if outcome.stderr.contains("no graphics adapter") {
        return;
    }
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let decoder = png::Decoder::new(std::io::Cursor::new(std::fs::read(&picture).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let (width, height) = (info.width as usize, info.height as usize);
    let bytes = pixels.len() / (width * height);
    // The right fifth, where the blank picture was: from the title's foot to the legend.
    let pixel = |x: usize, y: usize| &pixels[(y * width + x) * bytes..][..3];
    let right = (width * 4 / 5..width * 19 / 20)
        .flat_map(|x| (height / 5..height * 3 / 4).map(move |y| (x, y)));
    let mut colors: Vec<&[u8]> = right.map(|(x, y)| pixel(x, y)).collect();
    colors.sort_unstable();
    colors.dedup();
    assert!(colors.len() > 1, "a blank picture");
}

/// A preset that a camera shares its name with is listed once.
#[test]
fn a_recording_keeps_the_scenes_cameras() {
    let folder = Folder::new();
    let cameras = "cameras: [(name: \"front\", preset: Front), \
        (name: \"near\", look_at: (eye: (3, -3, 2), target: (0, 0, 1)))], effects: [";
    let scene = folder.write("seen.ron", DROP.replace("effects: [", cameras));
    let recording = argument(&folder.path("seen.mcap"));
    assert_eq!(run(&["run", &scene, "--record", &recording]).code, Some(0));
    let picture = argument(&folder.path("near.png"));
    let drawn = |camera: &str| {
        run(&["replay", &recording, "--at", "0.5", "--render", &picture, "--camera", camera])
    };
    let outcome = drawn("near");
    if outcome.stderr.contains("no graphics adapter") {
        return;
    }
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    drawn("far").assert_refused(2, &["Choose one of front, near, isometric, side, top"]);
}

#[test]
fn a_time_beyond_the_recording_is_refused() {
    let folder = Folder::new();
    let path = recorded(&folder);
    let says = "--at 99: the recording runs from 0 to 1 s";
    run(&["replay", &path, "--at", "99"]).assert_refused(2, &[says]);
    assert_eq!(run(&["replay", &path, "--at", "1.0001"]).code, Some(0));
}
