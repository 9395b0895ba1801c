//! `docs/generators.md` names every generator and parameter, with its default and its extents.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use cranny_geometry::{DVec3, Mesh};
use cranny_scene::{LoadOptions, SceneError, parse_scene};

/// Defaults that follow from other parameters: the page puts them in words.
const IN_WORDS: [(&str, &[&str]); 2] = [
    ("IsoBolt", &["length", "lead_in", "across_flats", "head_height"]),
    ("IsoNut", &["height", "lead_in", "across_flats"]),
];

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/generators.md");
    fs::read_to_string(path).unwrap()
}

/// What the page says of a generator.
fn entry(page: &str, name: &str) -> Option<String> {
    let (_, entry) = page.split_once(&format!("\n### {name}\n"))?;
    entry.split("\n##").next().map(str::to_owned)
}

/// The rows of an entry's table: parameter and default.
fn rows(entry: &str) -> Vec<[&str; 2]> {
    entry
        .lines()
        .filter_map(|line| {
            let (parameter, rest) = line.strip_prefix("| `")?.split_once("` | ")?;
            let (default, _) = rest.split_once(" | ")?;
            Some([parameter, default])
        })
        .collect()
}

fn read(generator: &str) -> Result<Arc<Mesh>, SceneError> {
    let text = format!("(bodies: [(name: \"a\", kind: Fixed, shape: Generator({generator}))])");
    let scene = parse_scene(text, Path::new("s.ron"), &LoadOptions::default())?;
    Ok(scene.description.bodies[0].collision.clone())
}

/// The names that the reader expects where it finds an unknown one.
fn expected(generator: &str) -> Vec<String> {
    let error = read(generator).unwrap_err().to_string();
    let (_, listed) = error.rsplit_once("expected").unwrap();
    listed.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn generators() -> Vec<String> {
    let names = expected("Zzz()");
    assert!(names.len() >= 34, "{names:?}");
    names
}

fn corner(p: DVec3) -> String {
    // No negative zero.
    let [x, y, z] = p.to_array().map(|x| (x * 1e3).round() / 1e3 + 0.0);
    format!("({x}, {y}, {z})")
}

fn is_in_words(name: &str, parameter: &str) -> bool {
    IN_WORDS.iter().any(|(of, parameters)| *of == name && parameters.contains(&parameter))
}

#[test]
fn the_page_has_an_entry_for_every_generator_and_for_no_other() {
    let page = page();
    let mut known = generators();
    let mut listed: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("### ")).collect();
    known.sort();
    listed.sort_unstable();
    assert_eq!(listed, known);
    for name in known {
        let link = format!("[{name}](#{})", name.to_lowercase());
        assert!(page.contains(&link), "the list at the top lacks {link}");
    }
}

#[test]
fn every_parameter_of_a_generator_is_in_its_entry_and_no_other() {
    let page = page();
    for name in generators() {
        let mut known = expected(&format!("{name}(zzz: 1)"));
        let entry = entry(&page, &name).unwrap_or_else(|| panic!("no entry {name}"));
        let mut listed: Vec<&str> = rows(&entry).into_iter().map(|[name, _]| name).collect();
        known.sort();
        listed.sort_unstable();
        assert!(!known.is_empty() && listed == known, "{name}: {listed:?}, but reads {known:?}");
    }
}

#[test]
fn the_defaults_on_the_page_are_those_of_the_reader() {
    let page = page();
    for name in generators() {
        let entry = entry(&page, &name).unwrap_or_else(|| panic!("no entry {name}"));
        let stated: Vec<String> = rows(&entry)
            .into_iter()
            .filter(|[parameter, _]| !is_in_words(&name, parameter))
            .map(|[parameter, default]| format!("{parameter}: {default}"))
            .collect();
        let stated = format!("{name}({})", stated.join(", "));
        let read_so = read(&stated).unwrap_or_else(|error| panic!("{stated}: {error}"));
        assert!(read_so == read(&format!("{name}()")).unwrap(), "{stated} is not the default");
    }
}

/// Extents show where the origin is.
#[test]
fn the_extents_on_the_page_are_those_of_the_meshes() {
    let page = page();
    let mut wrong = Vec::new();
    for name in generators() {
        let bounds = read(&format!("{name}()")).unwrap().bounds();
        let extents = format!("from {} to {}.", corner(bounds.min), corner(bounds.max));
        let entry = entry(&page, &name).unwrap_or_else(|| panic!("no entry {name}"));
        let words: Vec<&str> = entry.split_whitespace().collect();
        if !words.join(" ").contains(&format!("By default {extents}")) {
            wrong.push(format!("{name}: {extents}"));
        }
    }
    assert!(wrong.is_empty(), "the page does not say:\n{}", wrong.join("\n"));
}

#[test]
fn every_example_of_the_page_is_a_scene() {
    let page = page();
    let blocks: Vec<&str> = page.split("```ron\n").skip(1).collect();
    assert!(!blocks.is_empty());
    for block in blocks {
        let (text, _) = block.split_once("```").unwrap();
        let parsed = parse_scene(text.to_owned(), Path::new("s.ron"), &LoadOptions::default());
        parsed.unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
}
