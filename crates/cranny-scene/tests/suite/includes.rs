//! Scenes that include others.

use std::path::PathBuf;

use cranny_exact::DVec3;
use cranny_scene::{LoadOptions, LoadedScene, SceneError, Setting, load_scene_with};
use cranny_world::description::Effect;

const ROOM: &str = r#"(
    gravity: (0, 0, 0), effects: [Penetration()],
    bodies: [(name: "floor", shape: Mesh(path: "u.obj"), kind: Fixed)],
    groups: [Pile(name: "p", count: 2, region: (min: (1, 1, 1), max: (9, 9, 9)), shapes: [Generator(Cuboid())])],
    cameras: [(name: "door", preset: Front)],
)"#;

const SCENE: &str = r#"(
    includes: ["house/room.ron"],
    bodies: [(name: "cup", shape: Mesh(path: "u.obj"))],
    joints: [(name: "j", parent: "floor", child: "cup", kind: Fixed())],
    effects: [Response()],
    cameras: [(name: "main", preset: Top)],
)"#;

struct Files(tempfile::TempDir);

impl Files {
    /// A mesh of another size in the folder of the room.
    fn new() -> Self {
        let files = Self(tempfile::tempdir().unwrap());
        std::fs::create_dir(files.path("house")).unwrap();
        let mesh = |x: u32| {
            format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        };
        files.write("u.obj", &mesh(1));
        files.write("house/u.obj", &mesh(7));
        files.write("house/room.ron", ROOM);
        files.write("s.ron", SCENE);
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn load(&self, settings: Vec<Setting>) -> Result<LoadedScene, SceneError> {
        let options = LoadOptions { settings, ..LoadOptions::default() };
        load_scene_with(&self.path("s.ron"), &options)
    }

    fn refused(&self) -> String {
        self.load(Vec::new()).map(|_| "it was accepted").unwrap_err().to_string()
    }
}

#[test]
fn what_a_scene_includes_is_added_and_the_rest_is_its_own() {
    let files = Files::new();
    let loaded = files.load(Vec::new()).unwrap();
    let scene = &loaded.description;
    let names: Vec<_> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["floor", "cup", "p_0", "p_1"]);
    assert_eq!((scene.gravity.z, &scene.effects[..]), (-9.81, &[Effect::Response][..]));
    assert_eq!((scene.joints[0].parent, scene.joints[0].child), (0, 1));
    let cameras: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(cameras, ["main", "door"]);
    // Paths are relative to the file that names them.
    let widths = [0, 1].map(|body: usize| scene.bodies[body].collision.bounds().max.x);
    assert_eq!(widths, [7.0, 1.0]);
    let named = ["house/room.ron", "house/u.obj", "u.obj"].map(|name| files.path(name));
    assert_eq!(loaded.files, named);
    let [note] = &loaded.notes[..] else { panic!("{:?}", loaded.notes) };
    assert!(
        note.contains("room.ron: included, so its `gravity`, `effects` do not count"),
        "{note}"
    );
    assert_eq!(
        (loaded.source_text.as_str(), &loaded.included_texts[..]),
        (SCENE, &[ROOM.to_owned()][..])
    );
}

#[test]
fn groups_keep_clear_of_the_bodies_of_every_file() {
    let block = "(name: \"block\", shape: Generator(Cuboid(size: (4, 4, 4))), kind: Fixed)";
    let grid = "Grid(name: \"g\", count: (3, 1, 1), spacing: (3, 1, 1), shapes: [Generator(Cuboid())], kind: Fixed)";
    let files = Files::new();
    for (included, own) in [(block, ""), ("", block)] {
        let groups = |bodies: &str| if bodies.is_empty() { grid } else { "" };
        let text = |bodies: &str, more: &str| {
            format!("({more}bodies: [{bodies}], groups: [{}])", groups(bodies))
        };
        files.write("house/room.ron", &text(included, ""));
        files.write("s.ron", &text(own, "includes: [\"house/room.ron\"], "));
        let loaded = files.load(Vec::new()).unwrap();
        // The first of three stands in the block.
        assert_eq!(loaded.description.bodies.len(), 3);
        let [warning] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
        assert!(
            warning.contains("1 of its 3 bodies") && warning.contains("\"block\""),
            "{warning}"
        );
    }
}

#[test]
fn a_file_that_is_included_twice_is_read_once() {
    let files = Files::new();
    files.write("house/hall.ron", "(includes: [\"room.ron\", \"../house/room.ron\"])");
    files.write(
        "s.ron",
        &SCENE.replace("[\"house/room.ron\"]", "[\"house/hall.ron\", \"house/room.ron\"]"),
    );
    let loaded = files.load(Vec::new()).unwrap();
    assert_eq!((loaded.description.bodies.len(), loaded.included_texts.len()), (4, 2));
}

#[test]
fn settings_are_for_the_file_that_is_loaded() {
    let files = Files::new();
    let set = |setting: &str| files.load(vec![setting.parse().unwrap()]);
    assert_eq!(set("gravity.z=1").unwrap().description.gravity, DVec3::Z);
    let unknown = set("bodies.floor.kind=Kinematic").unwrap_err().to_string();
    assert!(unknown.contains("`bodies` has no `floor`. It has cup"), "{unknown}");
    assert!(unknown.contains("by its name: includes.\"house/room.ron\".bodies"), "{unknown}");
}

#[test]
fn settings_reach_the_files_that_are_included() {
    let files = Files::new();
    files.write("hall.ron", "(includes: [\"house/room.ron\"])");
    let set = |setting: &str| files.load(vec![setting.parse().unwrap()]);
    for way in ["includes.\"house/room.ron\"", "includes.0"] {
        let loaded = set(&format!("{way}.bodies.floor.pose.at=(0, 0, -3)")).unwrap();
        assert_eq!(loaded.description.bodies[0].pose.translation.z, -3.0);
        assert!(loaded.included_texts[0].contains("(0, 0, -3)"), "{:?}", loaded.included_texts);
        assert_eq!(loaded.source_text, SCENE);
    }
    files.write("s.ron", &SCENE.replace("house/room.ron", "hall.ron"));
    let deep = set("includes.\"hall.ron\".includes.0.groups.p.count=5").unwrap().description;
    assert_eq!(deep.bodies.len(), 7);
}

#[test]
fn settings_that_lead_into_no_included_file_are_refused_with_the_reason() {
    let files = Files::new();
    files.write("hall.ron", "(includes: [\"house/room.ron\"])");
    let refused = |setting: &str| {
        let error = files.load(vec![setting.parse().unwrap()]).unwrap_err().to_string();
        assert!(error.contains(setting), "{error}");
        error
    };
    for (setting, says) in [
        ("includes.attic.bodies.a.mass=Total(1)", "s.ron, line 2, column 16"),
        (
            "includes.attic.bodies.a.mass=Total(1)",
            "includes no \"attic\". It includes \"house/room.ron\"",
        ),
        (
            "includes.0.gravity.z=-1",
            "`gravity` of a file that is included does not count. Set that of the scene itself: gravity.z=-1",
        ),
        ("includes.0.bodies.roof.kind=Fixed", "room.ron, line 3"),
        ("includes.0.bodies.roof.kind=Fixed", "`bodies` has no `roof`. It has floor"),
        ("includes.0.bodies.floor.kind=Solid", "room.ron, line 3"),
    ] {
        let error = refused(setting);
        assert!(error.contains(says), "{says}: {error}");
    }
    files.write(
        "s.ron",
        &SCENE.replace("[\"house/room.ron\"]", "[\"hall.ron\", \"house/room.ron\"]"),
    );
    let late = refused("includes.1.bodies.floor.kind=Fixed");
    assert!(late.contains("is read before, since another file includes it"), "{late}");
    files.write("s.ron", "()");
    assert!(refused("includes.0.bodies.a.kind=Fixed").contains("the scene includes no file"));
}

#[test]
fn what_cannot_be_included_is_refused_with_its_place() {
    let files = Files::new();
    let include = |names: &str| files.write("s.ron", &SCENE.replace("\"house/room.ron\"", names));
    for (names, says) in [
        ("\"none.ron\"", "none.ron: cannot be read"),
        ("\"u.obj\"", "u.obj: it is a mesh. Name it as the shape of a body"),
        ("\"s.ron\"", "s.ron: it includes itself ("),
    ] {
        include(names);
        let error = files.refused();
        assert!(error.contains("s.ron, line 2, column 16: the included scene "), "{error}");
        assert!(error.contains(says), "{error}");
    }
    include("\"house/room.ron\"");
    files.write("house/room.ron", "(includes: [\"../s.ron\"])");
    let circle = files.refused();
    assert!(
        circle.contains("room.ron, line 1, column 13") && circle.contains("s.ron, "),
        "{circle}"
    );
    files.write(
        "house/room.ron",
        "(\nbodies: [(name: \"cup\", shape: Generator(Cuboid()), colour: 1)])",
    );
    let field = files.refused();
    assert!(field.contains("room.ron, line 2") && field.contains("colour"), "{field}");
    files.write("house/room.ron", "(bodies: [(name: \"cup\", shape: Generator(Cuboid()))])");
    let twice = files.refused();
    assert!(
        twice.contains("s.ron, line 3, column 21: there are two bodies called \"cup\""),
        "{twice}"
    );
}
