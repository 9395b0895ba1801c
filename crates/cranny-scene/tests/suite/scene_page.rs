//! The examples and settings of `docs/scenes.md` are right. That the page names every field and
//! variant is a test of `scene_file::reference`.

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

fn section_of_page(name: &str) -> String {
    let page = page();
    let (_, section) = page.split_once(&format!("\n## {name}\n")).unwrap();
    section.split("\n## ").next().unwrap().to_owned()
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

/// With all fields that there are.
#[test]
fn the_error_of_the_readme_is_the_one_that_shows() {
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md");
    let readme = fs::read_to_string(readme).unwrap();
    let (_, shown) = readme.split_once("error: scene file bad.ron, line 8, column 10: ").unwrap();
    let text = "(bodies: [(name: \"nut\", shape: Generator(Torus()), velocty: ())])".to_owned();
    let error = parse_scene(text, Path::new("bad.ron"), &LoadOptions::default()).unwrap_err();
    let error = error.to_string();
    // The command ends it with a full stop.
    let shown = shown.lines().next().and_then(|line| line.strip_suffix('.'));
    assert_eq!(shown, error.split_once(": ").map(|(_, what)| what));
}
