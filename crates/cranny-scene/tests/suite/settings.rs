//! Values in place of those in a scene's text.

use std::path::Path;

use cranny_exact::DVec3;
use cranny_scene::scene_file::SettingError;
use cranny_scene::{LoadOptions, LoadedScene, SceneError, Setting, parse_scene};
use cranny_world::description::Effect;

const SCENE: &str = r#"// gravity: none
(
    step: 0.01, /* gravity: (0, 0, 1) */
    bodies: [
        (name: "nut", shape: Generator(Torus(major_radius: 2)), pose: (at: (0, 0, 20)),
         material: (density: 2)),
        (name: "a.b", shape: Generator(Cuboid(size: (1, 2, 3))), kind: Kinematic),
    ],
    groups: [Pile(name: "p", count: 3, region: (min: (10, 10, 10), max: (20, 20, 20)),
                  shapes: [Generator(LPrism())])],
    effects: [Response(), Contacts(margin: 0.05)],
    cameras: [(name: "main", preset: Top)],
)"#;

fn set(text: &str, settings: &[&str]) -> Result<LoadedScene, SceneError> {
    let settings = settings.iter().map(|setting| setting.parse().unwrap()).collect();
    let options = LoadOptions { settings, ..LoadOptions::default() };
    parse_scene(text.to_owned(), Path::new("test.ron"), &options)
}

fn refused(setting: &str) -> String {
    match set(SCENE, &[setting]) {
        Ok(_) => panic!("{setting} was accepted"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn what_stands_in_the_text_is_replaced() {
    let settings = [
        "step=0.02",
        "bodies.nut.pose.at.z=-3",
        "bodies.nut.material.density=7",
        "bodies.nut.shape.major_radius=4",
        "bodies.\"a.b\".shape.size=(3, 3, 3)",
        "bodies.1.kind=Fixed",
        "groups.p.count=5",
        "effects.Contacts.margin=0.25",
    ];
    let scene = set(SCENE, &settings).unwrap().description;
    assert_eq!(scene.step, 0.02);
    let nut = &scene.bodies[0];
    assert_eq!(nut.pose.translation, DVec3::new(0.0, 0.0, -3.0));
    assert_eq!(nut.material.density, 7.0);
    assert!(nut.collision.bounds().max.x > 4.0);
    assert_eq!(scene.bodies[1].collision.bounds().max, DVec3::splat(1.5));
    assert_eq!(scene.bodies.len(), 7);
    assert_eq!(scene.effects[1], Effect::Contacts { margin: 0.25 });
}

#[test]
fn what_the_text_leaves_out_is_added() {
    let settings = [
        "gravity.z=-1.6",
        "gravity.x=0.5",
        "bodies.nut.velocity.linear.x=1",
        "bodies.\"a.b\".pose.at.z=3",
        "bodies.\"a.b\".pose.euler_degrees.x=90",
        "bodies.nut.shape.minor_radius=0.25",
        "bodies.nut.material.friction=0 // none",
        "cameras=[]",
    ];
    let scene = set(SCENE, &settings).unwrap();
    let description = &scene.description;
    assert_eq!(description.gravity, DVec3::new(0.5, 0.0, -1.6));
    let nut = &description.bodies[0];
    assert_eq!((nut.linear_velocity, nut.material.friction), (DVec3::X, 0.0));
    assert_eq!(nut.collision.bounds().max.z, 0.25);
    assert_eq!(description.bodies[1].pose.translation, DVec3::new(0.0, 0.0, 3.0));
    assert!((description.bodies[1].pose.rotation.x - 0.5f64.sqrt()).abs() < 1e-12);
    assert_eq!(description.cameras.len(), 0);
    // What ran is what a recording holds.
    let again = set(&scene.source_text, &[]).unwrap().description;
    assert_eq!((again.gravity, again.bodies.len()), (description.gravity, 5));
    assert_eq!(set("()", &["gravity.z=0"]).unwrap().description.gravity, DVec3::ZERO);
    assert_eq!(set("()", &["seed=9"]).unwrap().description.seed, 9);
}

#[test]
fn the_last_of_two_settings_counts() {
    let scene = set(SCENE, &["step=0.02", "step=0.005"]).unwrap();
    assert_eq!(scene.description.step, 0.005);
}

#[test]
fn a_path_that_leads_nowhere_is_refused_with_what_is_there() {
    for (setting, parts) in [
        (
            "bodies.bolt.mass=Total(1)",
            ["`bodies` has no `bolt`. It has nut, a.b", "line 4, column 13"],
        ),
        ("bodies.2.kind=Fixed", ["has no `2`", "line 4"]),
        ("step.x=1", ["`step` is 0.01, which has no `x`", "line 3, column 11"]),
        ("bodies.nut.pose.at.w=1", ["`bodies.nut.pose.at` has no `w`. It has x, y, z", "line 5"]),
        ("bodies.nut.pose.at.q=1", ["`bodies.nut.pose.at` has no `q`. It has x, y, z", "line 5"]),
        ("bodies.nutt.pose.at.z=1", ["has no `nutt`. Perhaps `nut` is meant", "line 4"]),
        ("gravity.w=1", ["`gravity` has no `w`. It has x, y, z", "line 2"]),
        ("gravity.q=1", ["`gravity` has no `q`. It has x, y, z", "line 2"]),
        ("gravitty.z=1", ["the scene has no field `gravitty`", "Perhaps `gravity` is meant"]),
        ("nope.x=1", ["the scene has no field `nope`. Its fields are `version`", ", `record`"]),
        ("bodies.nut.poze.at.z=1", ["`bodies.nut` has no field `poze`", "Perhaps `pose` is meant"]),
        ("bodies.1.pose.z=1", ["`bodies.1.pose` has no field `z`. Its fields are `at`", "line 7"]),
        (
            "cameras.main.look_at.eye.x=1",
            ["`cameras.main.look_at` is not in the file", "Set all of it: cameras.main.look_at=…"],
        ),
        (
            "pairs.0.a=\"nut\"",
            ["`pairs` is not in the file", "`0.a` cannot be set alone. Set all of it: pairs=…"],
        ),
        (
            "bodies.1.kind=\"Fixed\"",
            ["`kind`: a choice is written without quotes: Fixed", "line 7"],
        ),
        ("gravitty=(0, 0, 1)", ["gravitty", "`gravity`"]),
        ("bodies.nut.colour=1", ["`colour`", "`visual`"]),
        ("step=soon", ["the setting step=soon: `step`: Expected float", "line 3, column 10"]),
        ("step=-1", ["greater than 0, found -1", "line 3"]),
        ("bodies.nut.shape.teeth=3", ["`bodies.nut.shape` has no field `teeth`", "`minor_radius`"]),
        ("most_parts=-1", ["`most_parts`: expected a whole number from 1 to", "found -1"]),
        ("groups.p.count=2.5", ["`count`: expected a whole number from 0 to", "found 2.5"]),
        ("effects.Trigger.accuracy=Hulls", ["has no `Trigger`.", "It has Response, Contacts"]),
    ] {
        let error = refused(setting);
        assert!(error.contains(&format!("the setting {setting}: ")), "{error}");
        for part in parts {
            assert!(error.contains(part), "{setting}: {error}");
        }
    }
}

/// Shown only by the whole scene, which without the setting is right.
#[test]
fn what_a_setting_makes_wrong_names_it() {
    let settings = ["step=0.02", "groups.p.count=500", "seed=3"];
    let error = set(SCENE, &settings).unwrap_err().to_string();
    assert!(error.contains("the setting groups.p.count=500: pile \"p\": its region"), "{error}");
    assert!(error.contains("line 9") && error.contains("its count is 500"), "{error}");
    // What is wrong without it is no setting's fault.
    let broken = SCENE.replace("count: 3", "count: 500");
    let error = set(&broken, &["step=0.02"]).unwrap_err().to_string();
    assert!(!error.contains("setting") && error.contains("its count is 500"), "{error}");
    // Of two that only together are wrong, the later one.
    let error = set(SCENE, &["groups.p.gap=3", "groups.p.count=9"]).unwrap_err().to_string();
    assert!(error.contains("the setting groups.p.count=9"), "{error}");
}

#[test]
fn what_is_no_setting_is_refused() {
    let read = |text: &str| text.parse::<Setting>().unwrap_err();
    assert_eq!(read("gravity.z"), SettingError::NoValue);
    assert!(matches!(read(".z=1"), SettingError::EmptyStep(path) if path == ".z"));
    assert!(matches!(read("=1"), SettingError::EmptyStep(_)));
    for empty in ["step=", "step= "] {
        assert_eq!(read(empty), SettingError::Empty("step".to_owned()));
    }
    for value in ["1, seed: 2", "(1, 2", "1)", "nut.obj", "\"nut.obj", "1 /* one"] {
        let error = read(&format!("step={value}"));
        assert!(matches!(error, SettingError::NoSuchValue { .. }), "{value}: {error}");
        assert!(error.to_string().contains("is no value"), "{error}");
    }
}
