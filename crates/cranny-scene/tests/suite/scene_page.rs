//! `docs/scenes.md` says everything that a scene may say, and its examples are right.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use cranny_scene::{LoadOptions, parse_scene};

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scenes.md");
    fs::read_to_string(path).unwrap()
}

/// A folder with the files that the examples name.
fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(folder.path().join("u.obj"), mesh).unwrap();
    let link = |name: &str, at: f64| {
        let geometry = "<geometry><box size='0.1 0.1 0.1'/></geometry>";
        format!(
            "<link name='{name}'><collision><origin xyz='{at} 0 0'/>{geometry}</collision></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        let limit = "<limit lower='-1' upper='1' effort='50' velocity='1'/>";
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><axis xyz='0 0 1'/>{limit}</joint>"
        )
    };
    let links = [link("base", 0.0), link("upper", 1.0), link("hand", 2.0)].concat();
    let joints = [joint("elbow", "base", "upper"), joint("wrist", "upper", "hand")].concat();
    let urdf = format!("<robot name='arm'>{links}{joints}</robot>");
    fs::write(folder.path().join("arm.urdf"), urdf).unwrap();
    fs::write(folder.path().join("arm.srdf"), "<robot name='arm'><group_state name='bent' group='arm'><joint name='wrist' value='0.1'/></group_state></robot>").unwrap();
    let room = "(bodies: [(name: \"floor\", shape: Generator(Cuboid()), kind: Fixed)])";
    fs::write(folder.path().join("room.ron"), room).unwrap();
    let scene = folder.path().join("s.ron");
    (folder, scene)
}

fn error(text: &str) -> String {
    let (_folder, path) = folder();
    let parsed = parse_scene(text.to_owned(), &path, &LoadOptions::default());
    parsed.err().map(|error| error.to_string()).unwrap_or_default()
}

/// The fields that a text with an unknown one is answered with.
fn fields(text: &str) -> BTreeSet<String> {
    let error = error(text);
    let (_, listed) = error.rsplit_once("expected").unwrap_or_else(|| panic!("{text}: {error}"));
    listed.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn section_of_page(name: &str) -> String {
    let page = page();
    let (_, section) = page.split_once(&format!("\n## {name}\n")).unwrap();
    section.split("\n## ").next().unwrap().to_owned()
}

#[test]
fn every_effect_is_on_the_page() {
    let error = error("(effects: [Zzz()])");
    let (_, listed) = error.split_once("available are ").unwrap();
    let names: Vec<&str> =
        listed.split(", ").take_while(|name| !name.starts_with("and ")).collect();
    assert!(names.len() >= 5, "{error}");
    let section = section_of_page("Effects");
    for name in names {
        assert!(section.contains(&format!("`{name}(")), "{name}");
    }
}

#[test]
fn every_setting_of_the_page_is_one() {
    let section = section_of_page("Settings");
    let (_folder, path) = folder();
    let (_, text) = section.split_once("```ron\n").unwrap();
    let text = text.split("```").next().unwrap();
    let (_, commands) = section.split_once("```sh\n").unwrap();
    let settings: Vec<_> = commands.split("--set ").skip(1).collect();
    assert!(settings.len() >= 6, "{}", settings.len());
    for written in settings {
        let written = written.split(['\n', '#']).next().unwrap().trim().trim_matches('\'');
        let settings = vec![written.parse().unwrap_or_else(|error| panic!("{written}: {error}"))];
        let options = LoadOptions { settings, ..LoadOptions::default() };
        let parsed = parse_scene(text.to_owned(), &path, &options);
        parsed.unwrap_or_else(|error| panic!("{error}\n{written}"));
    }
}

#[test]
fn every_example_of_the_page_is_a_scene() {
    let (_folder, path) = folder();
    let page = page();
    let blocks: Vec<&str> = page.split("```ron").skip(1).collect();
    assert!(blocks.len() >= 9, "{}", blocks.len());
    for block in blocks {
        let (_, text) = block.split_once('\n').unwrap();
        let (text, _) = text.split_once("```").unwrap();
        let parsed = parse_scene(text.to_owned(), &path, &LoadOptions::default());
        parsed.unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
}

#[test]
fn every_field_that_is_read_is_on_the_page() {
    let body = "name: \"a\", shape: Generator(Cuboid())";
    let scene = |inside: &str| format!("(bodies: [({body}, {inside})])");
    let asked = [
        ("Scene", "(zzz: 1)".to_owned()),
        ("Bodies", "(bodies: [(zzz: 1)])".to_owned()),
        ("Bodies", scene("velocity: (zzz: 1)")),
        ("Bodies", scene("material: (zzz: 1)")),
        ("Bodies", scene("kind: Zzz")),
        ("Bodies", scene("normals: Zzz")),
        ("Bodies", scene("normals: Smooth(zzz: 1)")),
        ("Shapes", "(bodies: [(name: \"a\", shape: Mesh(zzz: 1))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Zzz())])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Mesh(repair: Zzz))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Primitive(Zzz()))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Primitive(Ball(zzz: 1)))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Primitive(Capsule(zzz: 1)))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Primitive(Cylinder(zzz: 1)))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Primitive(Cone(zzz: 1)))])".to_owned()),
        ("Shapes", "(bodies: [(name: \"a\", shape: Primitive(HalfSpace(zzz: 1)))])".to_owned()),
        ("Masses", scene("mass: Zzz()")),
        ("Masses", scene("mass: Shell(zzz: 1)")),
        ("Masses", scene("mass: Stated(zzz: 1)")),
        ("Poses", scene("pose: (zzz: 1)")),
        ("Poses", scene("pose: (turn: (zzz: 1))")),
        ("Paths", scene("path: (zzz: 1)")),
        ("Paths", scene("path: (keyframes: [(zzz: 1)])")),
        ("Paths", scene("path: (keyframes: [], interpolation: Zzz)")),
        ("Paths", scene("path: (keyframes: [], end: Zzz)")),
        ("Accuracy", "(accuracy: Zzz)".to_owned()),
        ("Effects", "(effects: [Trigger(zzz: 1)])".to_owned()),
        ("Effects", "(effects: [Proximity(zzz: 1)])".to_owned()),
        ("Trackers", scene("tracker: (zzz: 1)")),
        ("Trackers", scene("tracker: (smoothing: (zzz: 1))")),
        ("Trackers", scene("tracker: (device: (zzz: 1))")),
        ("Groups", "(groups: [Pile(zzz: 1)])".to_owned()),
        ("Groups", "(groups: [Grid(zzz: 1)])".to_owned()),
        ("Groups", "(groups: [Zzz(zzz: 1)])".to_owned()),
        ("Groups", "(groups: [Pile(region: (zzz: 1))])".to_owned()),
        ("Robots", "(robots: [(zzz: 1)])".to_owned()),
        ("Robots", "(robots: [(motors: {\"a\": (zzz: 1)})])".to_owned()),
        ("Joints", "(robots: [(paths: {\"a\": (zzz: 1)})])".to_owned()),
        ("Joints", "(joints: [(path: (keyframes: [(zzz: 1)]))])".to_owned()),
        ("Robots", "(robots: [(self_collisions: Zzz)])".to_owned()),
        ("Joints", "(joints: [(zzz: 1)])".to_owned()),
        ("Joints", "(joints: [(kind: Zzz())])".to_owned()),
        ("Joints", "(joints: [(kind: Revolute(zzz: 1))])".to_owned()),
        ("Joints", "(joints: [(kind: Rope(zzz: 1))])".to_owned()),
        ("Joints", "(joints: [(kind: Spring(zzz: 1))])".to_owned()),
        ("Pairs", "(pairs: [(zzz: 1)])".to_owned()),
        ("Cameras", "(cameras: [(zzz: 1)])".to_owned()),
        ("Cameras", "(cameras: [(preset: Zzz)])".to_owned()),
        ("Cameras", "(cameras: [(look_at: (zzz: 1))])".to_owned()),
        ("Scene", "(record: (zzz: 1))".to_owned()),
    ];
    for (section, text) in asked {
        let of_section = section_of_page(section);
        let fields = fields(&text);
        assert!(!fields.is_empty(), "{text}");
        for field in fields {
            let named = [format!("`{field}`"), format!("`{field}("), format!("{field}:")];
            let is_there = named.iter().any(|name| of_section.contains(name.as_str()));
            assert!(is_there, "{section} does not name {field:?}");
        }
    }
}
