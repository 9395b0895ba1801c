//! What scene files may say, and the errors when they say something else.

use std::path::Path;

use cranny_exact::{DVec3, Pose};
use cranny_scene::scene_file::SceneProblem;
use cranny_scene::{
    LoadOptions, LoadedScene, SceneError, load_scene, load_scene_with, parse_scene,
};
use cranny_world::description::{
    Accuracy, BodyKind, CameraView, Effect, Interpolation, JointKind, Material, Motor, Normals,
    PathEnd, Spring,
};
use miette::Diagnostic;

fn parse(text: &str) -> Result<LoadedScene, SceneError> {
    parse_scene(text.to_owned(), Path::new("test.ron"), &LoadOptions::default())
}

/// Everything that the format has, in one scene.
const FULL: &str = r#"(version: 1, gravity: (0, 0, -1), step: 0.01, most_parts: 4, duration: 2, seed: 3,
 bodies: [(name: "nut", shape: Generator(Torus(major_radius: 2)), kind: Dynamic,
           pose: (at: (0, 0, 20), rotation: (0, 0, 0.6, 0.8)), velocity: (linear: (1, 0, 0), angular: (0, 0, 6.25)),
           material: (density: 2, friction: 0, restitution: 1), layers: ["a", "b"], effects: [Trigger()]),
          (name: "mug", shape: Generator(Cup()), visual: Generator(Cuboid()), kind: Fixed),
          (name: "arm", shape: Generator(Cuboid(size: (1, 2, 3))), kind: Kinematic)],
 groups: [Pile(name: "p", count: 3, region: (min: (10, 10, 10), max: (20, 20, 20)), shapes: [Generator(LPrism())])],
 robots: [],
 joints: [(name: "j", parent: "mug", child: "nut", kind: Revolute(axis: (0, 0, 2), limits: (-1, 1)), target: 0.5)],
 effects: [Response(), Contacts(margin: 0.05)],
 pairs: [(a: "mug", b: "nut", effects: [Contacts()])],
 cameras: [(name: "main", preset: Top), (name: "own", look_at: (eye: (1, 2, 3), target: (0, 0, 0)))],
 record: (every: 5))"#;

#[test]
fn everything_in_a_scene_arrives() {
    let loaded = parse(FULL).unwrap();
    assert_eq!((loaded.source_text.as_str(), loaded.path.as_path()), (FULL, Path::new("test.ron")));
    let scene = loaded.description;
    assert_eq!(
        (scene.name.as_str(), scene.step, scene.most_parts, scene.duration, scene.seed),
        ("test", 0.01, Some(4), 2.0, 3)
    );
    assert_eq!(scene.gravity, -DVec3::Z);
    let nut = &scene.bodies[0];
    assert_eq!(nut.pose.translation, DVec3::new(0.0, 0.0, 20.0));
    assert!((nut.pose.rotation.z - 0.6).abs() < 1e-15);
    assert_eq!((nut.linear_velocity, nut.angular_velocity), (DVec3::X, DVec3::Z * 6.25));
    assert_eq!(nut.material, Material { density: 2.0, friction: 0.0, restitution: 1.0 });
    assert_eq!(
        (nut.layers.as_slice(), nut.effects.as_slice()),
        (&["a".to_owned(), "b".to_owned()][..], &[Effect::TRIGGER][..])
    );
    let mug = &scene.bodies[1];
    assert_eq!(
        (mug.kind, mug.pose, mug.material),
        (BodyKind::Fixed, Pose::IDENTITY, Material::default())
    );
    assert_eq!(mug.visual.as_ref().unwrap().faces().len(), 12);
    assert_eq!((mug.layers.as_slice(), mug.effects.len()), (&["all".to_owned()][..], 0));
    assert_eq!(scene.bodies[2].collision.bounds().max, DVec3::new(0.5, 1.0, 1.5));
    assert_eq!((scene.bodies.len(), scene.bodies[5].name.as_str()), (6, "p_2"));
    assert!(std::sync::Arc::ptr_eq(&scene.bodies[3].collision, &scene.bodies[4].collision));
    let joint = &scene.joints[0];
    assert_eq!((joint.parent, joint.child, joint.motor), (1, 0, Some(Motor::at(0.5))));
    assert_eq!(joint.kind, JointKind::Revolute { axis: DVec3::Z, limits: Some([-1.0, 1.0]) });
    assert_eq!(scene.excluded_pairs, [(0, 1)]);
    assert_eq!(scene.effects, [Effect::Response, Effect::Contacts { margin: 0.05 }]);
    assert_eq!(scene.pairs[0].effects, [Effect::Contacts { margin: 0.0 }]);
    assert_eq!(scene.cameras[0].view, CameraView::Top);
    assert!(
        matches!(scene.cameras[1].view, CameraView::LookAt { eye, .. } if eye == DVec3::new(1.0, 2.0, 3.0))
    );
    assert_eq!(scene.record.every, 5);
}

#[test]
fn bodies_have_colors_and_what_is_none_is_refused_with_its_value() {
    let colored = |color: &str| {
        parse(&format!("(bodies: [(name: \"a\", shape: Generator(Cuboid()),\ncolor: {color})])"))
    };
    let color = |text: &str| colored(text).unwrap().description.bodies[0].color.unwrap().0;
    assert_eq!(color("\"#d08030\""), [0xd0, 0x80, 0x30]);
    assert_eq!(color("(1, 0.5, 0)"), [255, 128, 0]);
    for (wrong, says) in [
        ("\"#d0803\"", "\"#d0803\""),
        ("\"#+08030\"", "\"#+08030\""),
        ("\"red\"", "or three numbers from 0 to 1"),
        ("(208, 128, 48)", "from 0 to 1, found [208.0, 128.0, 48.0]"),
        ("(1, 0.5)", "3"),
    ] {
        let error = colored(wrong).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("line 2"), "{wrong}: {error}");
    }
}

#[test]
fn an_empty_scene_has_defaults_and_the_seed_can_be_replaced() {
    let scene = parse("()").unwrap().description;
    assert_eq!((scene.bodies.len(), scene.record.every), (0, 4));
    assert_eq!(
        (scene.gravity, scene.step, scene.duration),
        (DVec3::new(0.0, 0.0, -9.81), 1.0 / 240.0, 5.0)
    );
    let poses = |options: &LoadOptions| {
        let loaded = parse_scene(FULL.to_owned(), Path::new("x.ron"), options).unwrap();
        loaded.description.bodies.iter().map(|body| body.pose.bits()).collect::<Vec<_>>()
    };
    assert_eq!(
        poses(&LoadOptions::default()),
        poses(&LoadOptions { seed: Some(3), ..LoadOptions::default() })
    );
    assert_ne!(
        poses(&LoadOptions::default()),
        poses(&LoadOptions { seed: Some(4), ..LoadOptions::default() })
    );
}

#[test]
fn meshes_are_found_beside_the_scene_and_shared() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("meshes")).unwrap();
    std::fs::write(
        folder.path().join("meshes/t.OBJ"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2 4\n",
    )
    .unwrap();
    let path = folder.path().join("s.ron");
    let text = r#"(bodies: [(name: "a", shape: Mesh(path: "meshes/t.OBJ"), visual: Mesh(path: "meshes/t.OBJ")), (name: "b", shape: Mesh(path: "meshes/t.OBJ")),
        (name: "c", shape: Mesh(path: "meshes/t.OBJ", scale: (1, 1, -2)), visual: Mesh(path: "meshes/t.OBJ", scale: (1, 1, -2)))])"#;
    std::fs::write(&path, text).unwrap();
    let loaded = load_scene(&path).unwrap();
    let bodies = &loaded.description.bodies;
    assert!(std::sync::Arc::ptr_eq(&bodies[0].collision, &bodies[1].collision));
    assert_eq!(bodies[2].collision.vertices()[3], DVec3::new(0.0, 0.0, -2.0));
    // As filed; what collides looks outwards, mirrored or not.
    let face = |body: usize| bodies[body].visual.as_ref().unwrap().faces()[0];
    let [a, b, c] = face(0);
    assert_eq!(face(2), [a, c, b], "mirrored faces are turned");
    assert_eq!(loaded.files, [folder.path().join("meshes/t.OBJ")]);
    assert!(loaded.notes[0].contains("1 polygon with"), "{:?}", loaded.notes);
    std::fs::write(&path, text.replace("1, 1, -2", "1, 0, 1")).unwrap();
    assert!(load_scene(&path).unwrap_err().to_string().contains("line 2, column 16"));
    std::fs::write(&path, text.replace("meshes/t.OBJ\", scale", "meshes/u.OBJ\", scale")).unwrap();
    let missing = load_scene(&path).unwrap_err().to_string();
    assert!(missing.contains("line 2, column 39") && missing.contains("u.OBJ"), "{missing}");
    let none = load_scene_with(&folder.path().join("none.ron"), &LoadOptions::default());
    assert!(matches!(none, Err(SceneError::Unreadable { .. })));
}

/// Text of a scene with a change, and the error that it must give.
fn refused(from: &str, to: &str) -> SceneError {
    assert!(FULL.contains(from), "{from}");
    match parse(&FULL.replacen(from, to, 1)) {
        Ok(_) => panic!("{to} was accepted"),
        Err(error) => error,
    }
}

#[test]
fn errors_name_line_column_and_what_was_expected() {
    let cases = [
        ("gravity:", "gravitation:", "line 1, column 14", "Unexpected field named `gravitation`"),
        ("version: 1", "version: 2", "line 1, column", "expected version 1, found version 2"),
        (
            "step: 0.01",
            "step: 0",
            "line 1, column",
            "expected a finite number greater than 0, found 0",
        ),
        ("step: 0.01", "step: \"x\"", "line 1, column", "Expected float. A number is written"),
        ("at: (0, 0, 20)", "at: 20", "line 3, column", "written as `(0, 0, -9.81)`"),
        ("at: (0, 0, 20)", "at: (0, 0, 2,5)", "line 3, column", "numbers have a decimal point"),
        ("Cup()", "12", "line 5, column", "\"12\" is no name, and a choice stands here"),
        ("most_parts: 4", "most_parts: 0", "line 1, column", "at least 1, found 0"),
        ("duration: 2", "duration: -2", "line 1, column", "at least 0, found -2"),
        (
            "0, 0, 0.6, 0.8",
            "0, 0, 0.6, 0.9",
            "line 3, column",
            "rotation quaternion has length 1.08",
        ),
        (
            "kind: Dynamic,",
            "kind: Dynamic, normals: Smooth(crease_angle: 4),",
            "line 2, column",
            "from 0 to π, found 4",
        ),
        (
            "density: 2",
            "density: -2",
            "line 4, column",
            "`density`: expected a finite number greater than 0, found -2",
        ),
        ("restitution: 1", "restitution: 1.5", "line 4, column", "from 0 to 1, found 1.5"),
        ("at: (0, 0, 20)", "at: (0, NaN, 20)", "line 3, column", "coordinate y is NaN"),
        ("kind: Fixed", "kind: Static", "line 5, column", "Unexpected variant named `Static`"),
        ("Cup()", "Mug()", "line 5, column", "Unexpected variant named `Mug`"),
        ("Cup()", "Cup(handle: 1)", "line 5, column", "Unexpected field named `handle`"),
        ("Trigger()", "Trigger(margin: 1)", "line 4, column", "Unexpected field named `margin`"),
        (
            "Contacts(margin: 0.05)",
            "Contacts(marge: 0.05)",
            "line 10, column",
            "Unexpected field named `marge` in `Contacts`",
        ),
        (
            "Contacts(margin: 0.05)",
            "Contacts(margin: -1)",
            "line 10, column",
            "at least 0, found -1",
        ),
        ("axis: (0, 0, 2)", "axis: (0, 0, 0)", "line 9, column", "an axis must have a length"),
        ("gravity:", "gravty:", "line 1, column 14", "Perhaps `gravity` is meant"),
        ("kind: Fixed", "kind: \"Fixed\"", "line 5", "without quotes: Fixed"),
        ("kind: Fixed", "kind: \"fix\"", "line 5", "none of `Fixed`, `Kinematic`, `Dynamic`"),
        ("every: 5", "every: 0", "line 13, column", "at least 1, found 0"),
    ];
    for (from, to, place, says) in cases {
        let error = refused(from, to);
        let text = error.to_string();
        assert!(text.starts_with("scene file test.ron, "), "{text}");
        assert!(text.contains(place) && text.contains(says), "{to}: {text}");
        assert_eq!(error.labels().unwrap().count(), 1);
    }
}

/// A file that was not copied to its end.
#[test]
fn a_text_that_is_cut_off_names_the_bracket_that_is_open() {
    let body = "(name: \"a\", shape: Generator(Cup()))";
    for (text, says) in [
        (format!("(\n bodies: [{body},\n {body}"), "the `[` of line 2, column 10 is closed"),
        (format!("(\n bodies: [{body}], "), "the `(` of line 1, column 1 is closed"),
        (format!("(\n bodies: [{body}], // )"), "the `(` of line 1, column 1 is closed"),
        ("(robots: [(path: \"a\", positions: {".to_owned(), "the `{` of line 1, column 34"),
        ("(\n name: \"a".to_owned(), "line 2, column 8: Expected end of string. The text that"),
    ] {
        let error = parse(&text).unwrap_err().to_string();
        assert!(error.contains(says), "{text}: {error}");
    }
}

#[test]
fn levels_and_budgets_are_read() {
    let text = "(bodies: [(name: \"a\", shape: Generator(Cuboid())), (name: \"b\", shape: Generator(Cuboid()))],
        effects: [Trigger(), Trigger(accuracy: Hulls), Proximity(within: 2, accuracy: Tree(3))],
        accuracy: Caps, budget: 500, pairs: [(a: \"a\", b: \"b\", accuracy: Boxes)])";
    let scene = parse_scene(text.to_owned(), Path::new("s.ron"), &LoadOptions::default()).unwrap();
    let scene = scene.description;
    let hulls = Effect::Trigger { accuracy: Some(Accuracy::Hulls) };
    let near = Effect::Proximity { within: 2.0, accuracy: Some(Accuracy::Tree(3)) };
    assert_eq!(scene.effects, [Effect::TRIGGER, hulls, near]);
    assert_eq!((scene.accuracy, scene.budget), (Accuracy::Caps, Some(500)));
    assert_eq!(scene.pairs[0].accuracy, Some(Accuracy::Boxes));
    assert_eq!(
        scene.levels(),
        [Accuracy::Boxes, Accuracy::Hulls, Accuracy::Caps, Accuracy::Tree(3)]
    );
    let mut at = scene;
    at.set_accuracy(Accuracy::Exact);
    assert_eq!((at.levels(), at.pairs[0].accuracy), (vec![Accuracy::Exact], None));
    let refused = |text: &str| {
        let parsed = parse_scene(text.to_owned(), Path::new("s.ron"), &LoadOptions::default());
        parsed.err().unwrap().to_string()
    };
    for (text, says) in [
        ("(accuracy: Perfect)", "Boxes"),
        ("(accuracy: Tree(256))", "line 1"),
        ("(accuracy: Tree())", "line 1"),
        ("(budget: -1)", "line 1"),
        ("(budget: 1.5)", "line 1"),
        ("(effects: [Trigger(accuracy: Nice)])", "Hulls"),
        ("(effects: [Contacts(accuracy: Hulls)])", "effect Contacts is always exact"),
        ("(effects: [Sound(above: 1, accuracy: Caps)])", "effect Sound is always exact"),
        ("(effects: [Response(accuracy: Caps)])", "effect Response is always exact"),
        ("(effects: [Penetration(accuracy: Exact)])", "Trigger and Proximity have one"),
    ] {
        let error = refused(text);
        assert!(error.contains(says) && error.contains("line 1"), "{text}: {error}");
    }
}

#[test]
fn effects_that_are_unknown_or_not_listed_or_miss_a_parameter_are_refused() {
    let cases = [
        ("Penetration(depth: 3)", "unexpected parameter depth: this effect has none"),
        ("Sound()", "above"),
        ("Sound(above: 0)", "0"),
        ("Sound(above: 1, below: 2)", "below"),
        ("Deformation(hardness: 5)", "radius"),
        ("Deformation(hardness: -5, radius: 1)", "-5"),
        ("ForceFeedback()", "stiffness"),
        ("Tracking()", "tolerance"),
        ("Tracking(tolerance: 0)", "0"),
        ("Proximity()", "within"),
        ("Contacts(margin: -1)", "-1"),
    ];
    for (effect, says) in cases {
        let text = refused("[Trigger()]", &format!("[{effect}]")).to_string();
        assert!(text.contains(says) && text.contains("line 4"), "{effect}: {text}");
    }
    let recording = refused("[Trigger()]", "[Recording()]").to_string();
    assert!(recording.contains("`record`") && recording.contains("--record"), "{recording}");
    let friction = refused("[Trigger()]", "[Friction()]").to_string();
    assert!(friction.contains("not listed: a scene has it by the `friction`"), "{friction}");
    let unknown = refused("[Trigger()]", "[Triger()]").to_string();
    assert!(
        unknown.contains("unknown effect Triger")
            && unknown
                .contains("Trigger, Proximity, Contacts, Penetration, Response, Continuous, Sound")
    );
}

#[test]
fn what_only_shows_in_the_whole_is_placed_too() {
    let cases = [
        ("name: \"arm\"", "name: \"mug\"", "line 6, column 18", "two bodies called \"mug\""),
        ("name: \"arm\"", "name: \"world\"", "line 6, column 18", "frame in which all bodies"),
        ("name: \"arm\"", "name: \"\"", "line 6, column 18", "is empty"),
        (
            "b: \"nut\"",
            "b: \"bolt\"",
            "line 11, column 24",
            "no body \"bolt\". The scene has \"nut\", \"mug\", \"arm\"",
        ),
        ("b: \"nut\"", "b: \"mug\"", "line 11, column 24", "names \"mug\" twice"),
        ("child: \"nut\"", "child: \"mug\"", "line 9, column 18", "joins a body to itself"),
        (
            "limits: (-1, 1)",
            "limits: (1, -1)",
            "line 9, column 18",
            "its lower limit, 1, is above its upper one, -1",
        ),
        ("name: \"own\"", "name: \"main\"", "line 12, column", "two cameras called"),
        ("name: \"own\"", "name: \"a b\"", "line 12, column", "no topic name"),
        (
            "preset: Top",
            "preset: Top, look_at: (eye: (1, 1, 1), target: (0, 0, 0))",
            "line 12, column",
            "both a preset",
        ),
        ("eye: (1, 2, 3)", "eye: (0, 0, 0)", "line 12, column", "its eye is its target"),
        (
            "max: (20, 20, 20)",
            "max: (20, 5, 20)",
            "line 7, column 22",
            "min must lie below its max",
        ),
        ("count: 3", "count: 30000000", "line 7, column 22", "its region has room for"),
        ("[Generator(LPrism())]", "[]", "line 7, column 22", "its `shapes` is empty"),
        ("major_radius: 2", "major_radius: -2", "line 2, column 18", "Torus: major_radius is -2"),
        ("kind: Dynamic,", "kind: Fixed,", "line 2, column 18", "is Fixed but has a velocity"),
    ];
    for (from, to, place, says) in cases {
        let text = refused(from, to).to_string();
        assert!(text.contains(place) && text.contains(says), "{to}: {text}");
    }
}

/// Two cubes 3 apart along x, joined by what is given.
fn joined(joint: &str) -> Result<LoadedScene, SceneError> {
    parse(&format!(
        "(bodies: [(name: \"a\", shape: Generator(Cuboid()), kind: Fixed),
           (name: \"b\", shape: Generator(Cuboid()), pose: (at: (3, 0, 0)))],
          joints: [(name: \"j\", parent: \"a\", child: \"b\", {joint})])"
    ))
}

#[test]
fn joints_hold_points_and_distances() {
    let spring = Spring { length: 2.0, stiffness: 40.0, damping: 0.0 };
    for (joint, kind) in [
        ("kind: Ball(), child_anchor: (at: (-3, 0, 0))", JointKind::Ball),
        ("kind: Rope(length: 3)", JointKind::Rope { length: 3.0 }),
        ("kind: Spring(length: 2, stiffness: 40)", JointKind::Spring(spring)),
    ] {
        let scene = joined(joint).unwrap();
        assert_eq!((scene.description.joints[0].kind, scene.warnings.len()), (kind, 0), "{joint}");
        assert_eq!(scene.description.excluded_pairs, [(0, 1)]);
    }
    let collide = joined("kind: Rope(length: 3), collide: true").unwrap();
    assert_eq!(collide.description.excluded_pairs, []);
}

#[test]
fn anchors_that_are_apart_at_the_start_are_warned_of() {
    for (joint, says) in [
        ("kind: Ball()", "3.000000 apart at the start, but it holds them in one place"),
        ("kind: Rope(length: 2)", "3.000000 apart at the start, but its length is 2"),
    ] {
        let [warning] = &joined(joint).unwrap().warnings[..] else { panic!("{joint}") };
        assert!(warning.starts_with("joint \"j\": its anchors are ") && warning.contains(says));
    }
}

#[test]
fn joints_that_are_wrong_are_refused_with_their_place() {
    for (joint, says) in [
        ("kind: Rope(length: 0)", "`length`: expected a finite number greater than 0, found 0"),
        ("kind: Spring(length: 1, stiffness: 0)", "`stiffness`: expected a finite number greater"),
        ("kind: Spring(length: 1)", "`Spring` lacks the field `stiffness`"),
        ("kind: Ball(), target: 0.5", "joint \"j\": a Ball joint has no position to drive"),
        ("kind: Rope(length: 3), motor: (velocity: 1)", "a Rope joint has no position to drive"),
        ("kind: Fixed(), target: 0", "a Fixed joint has no position to drive"),
    ] {
        let error = joined(joint).unwrap_err().to_string();
        assert!(error.contains("line 3, column ") && error.contains(says), "{joint}: {error}");
    }
}

#[test]
fn problems_are_typed_and_shown_with_their_source() {
    let error = refused("b: \"nut\"", "b: \"bolt\"");
    let SceneError::Invalid(located) = &error else { panic!("{error}") };
    assert!(matches!(&located.problem, SceneProblem::UnknownBody { name, .. } if name == "bolt"));
    assert_eq!(located.place, Some((11, 24)));
    let mut shown = String::new();
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none());
    handler.render_report(&mut shown, &error).unwrap();
    assert!(shown.contains("test.ron:11:24") && shown.contains("here"), "{shown}");
}

#[test]
fn no_prefix_and_no_changed_character_panics() {
    for length in (0..FULL.len()).filter(|&i| FULL.is_char_boundary(i)) {
        assert!(parse(&FULL[..length]).is_err(), "{length}");
    }
    for at in 0..FULL.len() {
        for c in ["\"", ")", "9", "\\", "ü"] {
            let mut text = FULL.to_owned();
            text.replace_range(at..=at, c);
            if let Err(error) = parse(&text) {
                assert!(error.to_string().starts_with("scene file test.ron"));
            }
        }
    }
}

/// Flat unless stated; of bodies, piles and robots alike.
#[test]
fn normals_are_smooth_where_a_scene_says_so() {
    let body = |normals: &str| {
        format!("(bodies: [(name: \"a\", shape: Generator(Sphere()), kind: Fixed{normals})])")
    };
    let reported = |text: &str| parse(text).map(|loaded| loaded.description.bodies[0].normals);
    assert_eq!(reported(&body("")).unwrap(), Normals::Flat);
    assert_eq!(reported(&body(", normals: Flat")).unwrap(), Normals::Flat);
    let smooth = reported(&body(", normals: Smooth(crease_angle: 0.17)")).unwrap();
    assert_eq!(smooth, Normals::Smooth { crease_angle: 0.17 });
    let pile = "(groups: [Pile(count: 2, region: (min: (0, 0, 0), max: (9, 9, 9)), shapes: [Generator(Sphere())], normals: Smooth(crease_angle: 0.3))])";
    assert_eq!(reported(pile).unwrap(), Normals::Smooth { crease_angle: 0.3 });
    for wrong in ["Smooth()", "Smooth(crease_angle: -0.1)", "Smooth(crease_angle: 3.2)", "Round"] {
        assert!(parse(&body(&format!(", normals: {wrong}"))).is_err(), "{wrong}");
    }
}

fn cup(pose: &str) -> String {
    format!("(bodies: [(name: \"a\", shape: Generator(Cup()), pose: ({pose}))])")
}

#[test]
fn an_orientation_is_written_in_one_of_three_ways() {
    let pose = |pose: &str| parse(&cup(pose)).unwrap().description.bodies[0].pose;
    let quarter = pose("rotation: (0.7071067811865476, 0, 0, 0.7071067811865476)").rotation;
    for written in [
        "euler_degrees: (90, 0, 0)",
        "turn: (axis: (7, 0, 0), degrees: 90)",
        "turn: (axis: (-1, 0, 0), degrees: -90)",
    ] {
        let turned = pose(&format!("at: (1, 2, 3), {written}"));
        assert_eq!(turned.translation, DVec3::new(1.0, 2.0, 3.0));
        assert!((turned.rotation - quarter).length() < 1e-15, "{written}: {turned:?}");
    }
    // About x first, then y, then z, all fixed: z stays up until y lays it along x, and z turns
    // that.
    let turned = pose("euler_degrees: (30, 90, 90)").rotation * DVec3::X;
    assert!((turned + DVec3::Z).length() < 1e-15, "{turned}");
    let up = pose("euler_degrees: (0, 90, 90)").rotation * DVec3::Z;
    assert!((up - DVec3::Y).length() < 1e-15, "{up}");
    let both = parse(&cup("euler_degrees: (0, 0, 1), turn: (axis: (0, 0, 1), degrees: 1)"));
    let both = both.unwrap_err().to_string();
    assert!(both.contains("line 1") && both.contains("keep one"), "{both}");
}

/// A layer with a slip in it parts a body from all others.
#[test]
fn a_body_that_shares_no_layer_is_warned_of() {
    let warnings = |layers: &[&str]| {
        let body = |(index, layers): (usize, &&str)| {
            format!("(name: \"{index}\", shape: Generator(Cuboid()), kind: Fixed, {layers})")
        };
        let bodies: Vec<String> = layers.iter().enumerate().map(body).collect();
        parse(&format!("(bodies: [{}])", bodies.join(", "))).unwrap().warnings
    };
    let found = warnings(&["layers: [\"world\"]", "layers: [\"world\"]", "layers: [\"wrold\"]"]);
    let [warning] = found.as_slice() else { panic!("{found:?}") };
    assert!(warning.starts_with("body \"2\" shares no layer with any other body"), "{warning}");
    assert!(warning.contains("[\"wrold\"]. Layers of other bodies are \"world\"."), "{warning}");
    let none = warnings(&["", "", "layers: []"]);
    assert!(none.len() == 1 && none[0].contains("its layers are []"), "{none:?}");
    assert_eq!(warnings(&["layers: [\"a\", \"b\"]", "layers: [\"b\"]"]), [""; 0]);
    assert_eq!(warnings(&["layers: [\"alone\"]"]), [""; 0], "nobody else is there");
}

#[test]
fn a_sensor_that_no_effect_reads_is_warned_of() {
    let warnings = |gate: &str, ball: &str, rest: &str| {
        let body = |name: &str, fields: &str| {
            format!("(name: \"{name}\", shape: Generator(Cuboid()), kind: Kinematic, {fields})")
        };
        let gate = body("gate", &format!("sensor: true, {gate}"));
        parse(&format!("(bodies: [{gate}, {}], {rest})", body("ball", ball))).unwrap().warnings
    };
    let unread = [
        ("", "", ""),
        ("", "", "effects: [Response()]"),
        ("effects: [ForceFeedback(stiffness: 1)]", "", ""),
        ("layers: [\"a\"]", "layers: [\"b\"], effects: [Trigger()]", ""),
        ("", "effects: [Trigger()]", "pairs: [(a: \"gate\", b: \"ball\", collide: false)]"),
    ];
    for (gate, ball, rest) in unread {
        let found = warnings(gate, ball, rest);
        let [warning, ..] = found.as_slice() else { panic!("{gate} {ball} {rest}: {found:?}") };
        assert!(warning.starts_with("body \"gate\" is a sensor, and no effect"), "{warning}");
    }
    let read = [
        ("", "", "effects: [Response(), Trigger()]"),
        ("effects: [Contacts()]", "", ""),
        ("", "effects: [Proximity(within: 1)]", ""),
        ("", "", "pairs: [(a: \"ball\", b: \"gate\", effects: [Penetration()])]"),
    ];
    for (gate, ball, rest) in read {
        assert_eq!(warnings(gate, ball, rest), [""; 0], "{gate} {ball} {rest}");
    }
}

#[test]
fn a_quaternion_of_few_digits_is_normalised_and_named() {
    let loaded = parse(&cup("rotation: (0.706, 0, 0, 0.706)")).unwrap();
    let rotation = loaded.description.bodies[0].pose.rotation;
    assert!((rotation.length() - 1.0).abs() < 1e-15 && rotation.x == rotation.w);
    let [warning] = loaded.warnings.as_slice() else { panic!("{:?}", loaded.warnings) };
    assert!(warning.contains("body \"a\"") && warning.contains("0.998"), "{warning}");
    assert!(parse(&cup("rotation: (0.6, 0, 0, 0.8)")).unwrap().warnings.is_empty());
    for none in ["(0.69, 0, 0, 0.7)", "(0, 0, 0, 0)", "(1, 1, 0, 0)"] {
        let refused = parse(&cup(&format!("rotation: {none}"))).unwrap_err().to_string();
        assert!(refused.contains("line 1") && refused.contains("quaternion"), "{refused}");
    }
}

#[test]
fn one_factor_stands_for_three_and_a_mesh_is_recentred() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 2 0 0\nv 4 0 0\nv 2 2 0\nv 2 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(folder.path().join("m.obj"), mesh).unwrap();
    let bounds = |fields: &str| {
        let shape = format!("Mesh(path: \"m.obj\"{fields})");
        let text = format!("(bodies: [(name: \"a\", shape: {shape})])");
        let path = folder.path().join("s.ron");
        let parsed = parse_scene(text, &path, &LoadOptions::default());
        parsed.map(|loaded| loaded.description.bodies[0].collision.bounds())
    };
    let [half, three] = [", scale: 0.5", ", scale: (0.5, 0.5, 0.5)"].map(|s| bounds(s).unwrap());
    assert_eq!(half, three);
    assert_eq!((half.min.x, half.max), (1.0, DVec3::new(2.0, 1.0, 1.0)));
    assert_eq!(bounds(", scale: 2").unwrap().max.x, 8.0);
    let centred = bounds(", scale: (1, -1, 2), recenter: true").unwrap();
    assert_eq!(
        (centred.min, centred.max),
        (DVec3::new(-1.0, -1.0, -2.0), DVec3::new(1.0, 1.0, 2.0))
    );
    for (scale, says) in [
        ("\"big\"", "a factor, or three of them"),
        ("(1, 2)", "line 1"),
        ("0", "flattens"),
        ("1e300", "line 1"),
    ] {
        let refused = bounds(&format!(", scale: {scale}")).unwrap_err().to_string();
        assert!(refused.contains(says), "{scale}: {refused}");
    }
}

/// A scene may be in any unit: no warning.
#[test]
fn a_mesh_that_may_be_in_millimetres_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 40\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(folder.path().join("m.obj"), mesh).unwrap();
    let notes = |fields: &str| {
        let shape = format!("Mesh(path: \"m.obj\"{fields})");
        let text = format!("(bodies: [(name: \"a\", shape: {shape})])");
        let loaded = parse_scene(text, &folder.path().join("s.ron"), &LoadOptions::default());
        let loaded = loaded.unwrap();
        assert_eq!(loaded.warnings, Vec::<String>::new());
        loaded.notes
    };
    let noted = notes("");
    assert!(noted[0].contains("m.obj: its box is 69 across") && noted[0].contains("Millimetres"));
    for stated in [", units: Metres", ", units: Millimetres", ", scale: 0.1"] {
        assert_eq!(notes(stated), Vec::<String>::new(), "{stated}");
    }
}

#[test]
fn a_mesh_without_an_area_is_refused_with_what_helps() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    for repair in ["None", "Safe", "Full"] {
        let text =
            format!("(bodies: [(name: \"a\", shape: Mesh(path: \"m.obj\", repair: {repair}))])");
        let loaded = parse_scene(text, &folder.path().join("s.ron"), &LoadOptions::default());
        let error = loaded.unwrap_err().to_string();
        assert!(error.contains("line 1") && error.contains("Export it again"), "{error}");
        assert!(!error.contains("`repair"), "no repair helps: {error}");
    }
}

#[test]
fn a_mesh_in_another_unit_is_converted_to_metres() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(folder.path().join("m.obj"), mesh).unwrap();
    let widths = |file: &str, fields: &str| {
        let shape = format!("Mesh(path: \"{file}\", {fields})");
        let text = format!("(bodies: [(name: \"a\", shape: {shape}, visual: {shape})])");
        let parsed = parse_scene(text, &folder.path().join("s.ron"), &LoadOptions::default());
        parsed.map_err(|error| error.to_string()).map(|loaded| {
            let body = &loaded.description.bodies[0];
            [&body.collision, body.visual.as_ref().unwrap()].map(|mesh| mesh.bounds().max.x)
        })
    };
    for (units, width) in [
        ("Metres", 4.0),
        ("Centimetres", 0.04),
        ("Millimetres", 0.004),
        ("Inches", 0.1016),
        ("Feet", 1.2192),
    ] {
        assert_eq!(widths("m.obj", &format!("units: {units}")), Ok([width; 2]), "{units}");
    }
    let both = widths("m.obj", "units: Millimetres, scale: (2, 1, -1)");
    assert_eq!(both, Ok([0.008; 2]));
    let unknown = widths("m.obj", "units: Furlongs").unwrap_err();
    assert!(unknown.contains("line 1") && unknown.contains("Millimetres"), "{unknown}");
    for (file, says) in [
        ("m.glb", "m.glb is in metres by its format. Leave `units` out"),
        ("m.gltf", "m.gltf is in metres by its format"),
        ("m.dae", "m.dae names its unit itself"),
        ("m.cranny", "m.cranny is a saved model, which is as it was prepared. Leave out `units`"),
    ] {
        let refused = widths(file, "units: Millimetres").unwrap_err();
        assert!(refused.contains(says) && refused.contains("line 1"), "{refused}");
    }
}

#[test]
fn a_pair_may_name_all_bodies_of_a_group() {
    let scene = |pair: &str| {
        let grid = "Grid(name: \"brick\", count: (3, 1, 1), spacing: (2, 1, 1), shapes: [Generator(Cuboid())])";
        let floor =
            "(name: \"floor\", shape: Generator(Cuboid()), kind: Fixed, pose: (at: (0, 0, -5)))";
        let text = format!("(bodies: [{floor}], groups: [{grid}], pairs: [({pair})])");
        parse(&text).map(|loaded| loaded.description)
    };
    let apart = scene("a: \"brick\", b: \"floor\", collide: false").unwrap();
    assert_eq!(apart.excluded_pairs, [(0, 1), (0, 2), (0, 3)]);
    let own = scene("a: \"brick\", b: \"brick\", collide: false").unwrap();
    assert_eq!(own.excluded_pairs, [(1, 2), (1, 3), (2, 3)]);
    let noticed = scene("a: \"floor\", b: \"brick\", effects: [Trigger()]").unwrap();
    let names: Vec<_> = noticed.pairs.iter().map(|pair| [&pair.a[..], &pair.b]).collect();
    assert_eq!(names, [["floor", "brick_0"], ["floor", "brick_1"], ["floor", "brick_2"]]);
    let unknown = scene("a: \"bricks\", b: \"floor\"").unwrap_err().to_string();
    assert!(unknown.contains("no body \"bricks\"") && unknown.contains("\"brick\""), "{unknown}");
}

/// Whichever comes first, and whichever of the two bodies is named first.
#[test]
fn a_pair_that_is_named_twice_with_contrary_wishes_is_refused_with_both() {
    let scene = |first: &str, second: &str| {
        let body = |name: &str, at: f64| {
            format!("(name: \"{name}\", shape: Generator(Cuboid()), pose: (at: ({at}, 0, 0)))")
        };
        let bodies = [body("a", 0.0), body("b", 3.0)].join(", ");
        let grid = "Grid(name: \"g\", count: (2, 1, 1), spacing: (3, 1, 1), pose: (at: (0, 9, 0)), shapes: [Generator(Cuboid())])";
        let text = format!(
            "(bodies: [{bodies}], groups: [{grid}], effects: [Trigger()],\npairs: [({first}),\n({second})])"
        );
        parse(&text).map(|loaded| loaded.description)
    };
    let apart = "a: \"a\", b: \"b\", collide: false";
    for wish in ["effects: [Contacts(margin: 0.1)]", "accuracy: Exact", "effects: []"] {
        let meet = format!("a: \"b\", b: \"a\", {wish}");
        for (first, second) in [(apart, &meet[..]), (&meet, apart)] {
            let error = scene(first, second).unwrap_err().to_string();
            let says = "the pair \"b\" and \"a\" may meet, but the pair \"a\" and \"b\" with";
            assert!(error.contains(says) && error.contains("line "), "{wish}: {error}");
        }
    }
    let of_group = "a: \"g\", b: \"a\", collide: false";
    let error = scene("a: \"g_1\", b: \"a\"", of_group).unwrap_err().to_string();
    assert!(error.contains("the pair \"g\" and \"a\" with"), "{error}");
    let [hulls, caps] =
        ["Hulls", "Caps"].map(|level| format!("a: \"a\", b: \"b\", accuracy: {level}"));
    let error = scene(&hulls, &caps).unwrap_err().to_string();
    assert!(error.contains("accuracy Caps") && error.contains("has Hulls"), "{error}");
    // The same twice, what adds up, and a group of which one is kept apart, are no contradictions.
    assert!(scene(apart, apart).is_ok() && scene(&hulls, &hulls).is_ok());
    let [contacts, distance] = ["Contacts(margin: 0.1)", "Proximity(within: 1)"]
        .map(|effect| format!("a: \"a\", b: \"b\", effects: [{effect}]"));
    assert_eq!(scene(&contacts, &distance).unwrap().pairs.len(), 2);
    let but_one = "a: \"g_1\", b: \"a\", collide: false";
    let all = "a: \"g\", b: \"a\", effects: [Contacts(margin: 0.1)]";
    for (first, second) in [(all, but_one), (but_one, all)] {
        let scene = scene(first, second).unwrap();
        assert_eq!((scene.pairs.len(), &scene.pairs[0].a[..]), (1, "g_0"));
    }
}

#[test]
fn a_pair_may_be_kept_apart_and_a_body_only_noticed() {
    let scene = |pair: &str| {
        let body = |name: &str| {
            format!("(name: \"{name}\", shape: Generator(Cup()), sensor: {})", name == "b")
        };
        format!("(bodies: [{}, {}], pairs: [(a: \"b\", b: \"a\"{pair})])", body("a"), body("b"))
    };
    let apart = parse(&scene(", collide: false")).unwrap().description;
    assert_eq!((apart.excluded_pairs.as_slice(), apart.pairs.len()), (&[(0, 1)][..], 0));
    assert_eq!((apart.bodies[0].sensor, apart.bodies[1].sensor), (false, true));
    let together = parse(&scene(", effects: [Trigger()]")).unwrap().description;
    assert_eq!((together.excluded_pairs.len(), together.pairs.len()), (0, 1));
    let both = parse(&scene(", collide: false, effects: [Trigger()]")).unwrap_err().to_string();
    assert!(both.contains("collide: false") && both.contains("Keep one"), "{both}");
}

#[test]
fn a_path_is_read_with_its_poses_and_its_end() {
    let text = "(bodies: [(name: \"lift\", shape: Generator(Cuboid()), kind: Kinematic, path: (
        keyframes: [(time: 1, pose: (at: (1, 0, 0))), (time: 2, pose: (euler_degrees: (0, 0, 90)))],
        interpolation: Eased, end: Loop,
    ))])";
    let loaded = parse(text).unwrap();
    let body = &loaded.description.bodies[0];
    let path = body.path.as_ref().unwrap();
    assert_eq!(body.pose, path.keyframes()[0].pose);
    assert_eq!((path.interpolation(), path.end()), (Interpolation::Eased, PathEnd::Loop));
    assert_eq!(path.duration(), 2.0);
    let turned = path.keyframes()[1].pose.rotation * DVec3::X;
    assert!((turned - DVec3::Y).length() < 1e-12);
}

#[test]
fn a_path_that_is_none_is_refused_at_its_body() {
    let refused = |kind: &str, more: &str, keyframes: &str| {
        let text = format!(
            "(bodies: [\n  (name: \"lift\", shape: Generator(Cuboid()), kind: {kind}, {more}\n   path: (keyframes: [{keyframes}]))])"
        );
        let error = parse(&text).unwrap_err().to_string();
        assert!(error.contains("test.ron, line 2, column"), "{error}");
        assert!(error.contains("body \"lift\": it") && error.contains("path"), "{error}");
        error
    };
    let two = "(time: 0), (time: 1)";
    assert!(refused("Fixed", "", two).contains("not Kinematic"));
    assert!(refused("Kinematic", "pose: (at: (1, 0, 0)),", two).contains("and a pose"));
    assert!(refused("Kinematic", "velocity: (linear: (1, 0, 0)),", two).contains("a velocity"));
    assert!(refused("Kinematic", "", "").contains("at least one"));
    let order = refused("Kinematic", "", "(time: 2), (time: 1)");
    assert!(order.contains("keyframe 1 is at 1 s, not after 2 s"), "{order}");
}

/// Of one noise two hands would keep their distance, and nothing would be tested.
#[test]
fn devices_of_two_bodies_err_each_on_its_own() {
    let seeds = |scene: u64, own: &str| {
        let body = |name| {
            format!(
                "(name: \"{name}\", shape: Generator(Cuboid()), kind: Kinematic, path: (keyframes: [(time: 0)]), tracker: (device: (rate: 100{own})))"
            )
        };
        let text = format!("(seed: {scene}, bodies: [{}, {}])", body("left"), body("right"));
        let bodies = parse(&text).unwrap().description.bodies;
        [0, 1].map(|i: usize| bodies[i].tracker.unwrap().device.seed)
    };
    let (one, other) = (seeds(1, ""), seeds(2, ""));
    assert_eq!(seeds(1, ""), one);
    assert!(one[0] != one[1] && one[0] != other[0] && one[1] != other[1], "{one:?} {other:?}");
    assert_eq!(seeds(1, ", seed: 7"), [7, 7], "as stated");
}

#[test]
fn numbers_that_no_solver_holds_are_refused_with_their_place_and_range() {
    let body = |fields: &str| {
        parse(&format!("(bodies: [(name: \"a\", shape: Generator(Cuboid()),\n{fields})])"))
    };
    for (fields, says) in [
        ("material: (density: 1e300)", "from 1e-30 to 1e30"),
        ("material: (friction: 1e300)", "from 0 to 1e30, which solvers hold, found 1e300"),
        ("mass: Total(1e-40)", "from 1e-30 to 1e30, which solvers hold, found 1e-40"),
        ("mass: Stated(mass: 1e40, inertia: (1, 1, 1))", "from 1e-30 to 1e30"),
    ] {
        let error = body(fields).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("line 2"), "{fields}: {error}");
    }
    let large = "(bodies: [(name: \"a\", shape: Generator(Cuboid(size: (1e9, 1e9, 1e9))), material: (density: 1e9))])";
    let error = parse(large).unwrap_err().to_string();
    assert!(
        error.contains("body \"a\": its mass is 1.000e36") && error.contains("1e-30 to 1e30"),
        "{error}"
    );
}

#[test]
fn motors_that_lead_outside_the_limits_or_two_ways_are_refused() {
    let hinge =
        |drive: &str| joined(&format!("kind: Revolute(axis: (0, 0, 1), limits: (-1, 1)), {drive}"));
    for (drive, says) in [
        ("target: 2", "joint \"j\": its target is 2, outside its limits, -1 to 1"),
        ("motor: (position: -1.5)", "its motor's position is -1.5, outside its limits, -1 to 1"),
        (
            "target: 1, motor: (position: -1)",
            "its target is 1, but the position of its motor is -1",
        ),
    ] {
        let error = hinge(drive).unwrap_err().to_string();
        assert!(error.contains("line 3, column ") && error.contains(says), "{drive}: {error}");
    }
    for drive in ["target: -1", "motor: (position: 1)", "target: 0.5, motor: (stiffness: 2)"] {
        hinge(drive).unwrap();
    }
}

#[test]
fn joints_that_change_nothing_are_warned_of() {
    let scene = |kind: &str, joints: &str| {
        let body =
            |name: &str| format!("(name: \"{name}\", shape: Generator(Cuboid()), kind: {kind})");
        parse(&format!("(bodies: [{}, {}], joints: [{joints}])", body("a"), body("b")))
            .unwrap()
            .warnings
    };
    let joint = |name: &str, kind: &str| {
        format!("(name: \"{name}\", parent: \"a\", child: \"b\", kind: {kind})")
    };
    let [ball, fixed] = [joint("ball", "Ball()"), joint("stiff", "Fixed()")];
    let found = scene("Fixed", &ball);
    assert!(
        found[0].starts_with("joint \"ball\": it joins two Fixed bodies, \"a\" and \"b\""),
        "{found:?}"
    );
    let found = scene("Dynamic", &format!("{ball}, {fixed}"));
    assert!(
        found[0].starts_with("joint \"stiff\": the joint \"ball\" joins the same two"),
        "{found:?}"
    );
    assert_eq!(scene("Dynamic", &fixed), [""; 0]);
    assert_eq!(scene("Dynamic", &format!("{ball}, {}", joint("rope", "Rope(length: 1)"))), [""; 0]);
}

#[test]
fn effects_are_named_once_and_force_feedback_where_somebody_feels_it() {
    let body = |name: &str, fields: &str| {
        format!("(name: \"{name}\", shape: Generator(Cuboid()), {fields})")
    };
    let twice = body("a", "effects: [Trigger(), Contacts(), Trigger()]");
    let error = parse(&format!("(bodies: [{twice}])")).unwrap_err().to_string();
    assert!(error.contains("the effect Trigger is named twice"), "{error}");
    const FELT: &str = "effects: [ForceFeedback(stiffness: 1)]";
    let warnings = |own: &str, other: &str, scene: &str| {
        parse(&format!("(bodies: [{}, {}], {scene})", body("a", own), body("b", other)))
            .unwrap()
            .warnings
    };
    let kinematic = "kind: Kinematic";
    for (own, other, scene, owner) in [
        (FELT, "", "", "body \"a\""),
        (FELT, "kind: Kinematic, layers: [\"b\"]", "", "body \"a\""),
        ("", "", FELT, "the scene"),
        ("", "", &format!("pairs: [(a: \"a\", b: \"b\", {FELT})]"), "the pair \"a\" and \"b\""),
    ] {
        let found = warnings(own, other, scene);
        let says = format!("{owner} names ForceFeedback, which only Kinematic bodies feel");
        assert!(found[0].starts_with(&says), "{own} {other} {scene}: {found:?}");
    }
    assert_eq!(warnings(FELT, kinematic, ""), [""; 0]);
    assert_eq!(warnings("", kinematic, FELT), [""; 0]);
}
