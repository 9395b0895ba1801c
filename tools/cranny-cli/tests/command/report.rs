//! `cranny report`: the page, checked by a parser, and by a browser where there is one.

use std::path::Path;
use std::process::Command;

use roxmltree::{Document, Node, ParsingOptions};

use crate::harness::{Folder, argument, run};

/// A box that falls onto another one whose name is no markup.
const DROP: &str = r#"(
    step: 0.015625, duration: 0.5, seed: 3,
    bodies: [
        (name: "floor", shape: Generator(Cuboid(size: (4, 4, 1))), kind: Fixed),
        (name: "<b>box & \"co\"", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0.125, 0, 1.05)),
         velocity: (angular: (0.3, 0.2, 0.5))),
    ],
    effects: [Response(), Contacts(margin: 0.01)],
)"#;

fn recorded(folder: &Folder) -> String {
    let scene = folder.write("drop & fall.ron", DROP);
    let path = argument(&folder.path("drop.mcap"));
    assert_eq!(run(&["run", &scene, "--record", &path]).code, Some(0));
    path
}

fn elements<'a>(page: &'a Document<'_>, name: &str) -> Vec<Node<'a, 'a>> {
    page.descendants().filter(|node| node.has_tag_name(name)).collect()
}

fn text(node: &Node<'_, '_>) -> String {
    node.descendants().filter_map(|inner| inner.text().filter(|_| inner.is_text())).collect()
}

#[test]
fn a_page_stands_alone_and_says_what_happened() {
    let folder = Folder::new();
    let (recording, out) = (recorded(&folder), argument(&folder.path("page.html")));
    let outcome = run(&["report", &recording, "--out", &out, "--pictures", "3"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    assert!(outcome.stdout.contains("page.html") && outcome.stdout.contains("33 frames"));
    let html = std::fs::read_to_string(&out).unwrap();
    let page = Document::parse_with_options(
        &html,
        ParsingOptions { allow_dtd: true, ..ParsingOptions::default() },
    )
    .unwrap();
    let body = text(&elements(&page, "body")[0]);
    for words in [
        "drop & fall",
        "1 moving body and 1 fixed one for 0.500 s",
        "The deepest overlap is",
        "floor and <b>box & \"co\"",
        "Response",
        "Nothing was skipped",
        "cranny replay",
        "velocity: (angular",
    ] {
        assert!(body.contains(words), "{words:?} is missing: {body}");
    }
    let pictures = elements(&page, "img");
    assert_eq!(pictures.len(), 3 + 1, "three of the strip, one close-up");
    for picture in pictures {
        let source = picture.attribute("src").unwrap();
        assert!(source.starts_with("data:image/png;base64,iVBORw0KGgo"), "{}", &source[..40]);
        assert!(picture.attribute("alt").is_some_and(|alt| !alt.is_empty()));
    }
    let plots = elements(&page, "svg");
    let names: Vec<_> = plots.iter().filter_map(|plot| plot.attribute("aria-label")).collect();
    assert_eq!(names, ["contacts", "deepest overlap", "mechanical energy", "cost"]);
    for plot in plots {
        let is_line =
            |node: &Node<'_, '_>| node.attribute("class").is_some_and(|c| c.contains("line"));
        let lines: Vec<_> = plot.descendants().filter(is_line).collect();
        assert!(!lines.is_empty());
        for line in lines {
            assert!(!line.attribute("d").unwrap().contains("NaN"));
        }
        for label in plot.descendants().filter(|node| node.has_tag_name("text")) {
            assert!(text(&label).chars().count() <= 8, "{}", text(&label));
        }
    }
    for outside in ["http:", "https:", "<script", "<link", "url("] {
        assert!(!html.contains(outside), "{outside} leads out of the page");
    }
    look_by_a_browser(&out);
}

/// Where nobody reports contacts, none recorded does not mean none.
#[test]
fn a_page_without_contacts_does_not_say_that_there_were_none() {
    let folder = Folder::new();
    let scene = folder.write("drop.ron", DROP.replace(", Contacts(margin: 0.01)", ""));
    let (recording, out) =
        (argument(&folder.path("drop.mcap")), argument(&folder.path("page.html")));
    assert_eq!(run(&["run", &scene, "--record", &recording]).code, Some(0));
    let outcome = run(&["report", &recording, "--out", &out, "--pictures", "1"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let html = std::fs::read_to_string(&out).unwrap();
    assert!(html.contains("Contacts and depths are not recorded"), "{html}");
    for wrong in ["No overlap was found", "0 contacts", "aria-label=\"contacts\""] {
        assert!(!html.contains(wrong), "{wrong}");
    }
    assert!(html.contains("aria-label=\"mechanical energy\""));
}

/// No complaint in the console at the width of a telephone and of a desk.
fn look_by_a_browser(page: &str) {
    let browsers = ["chromium", "chromium-browser", "google-chrome"];
    let found = |name: &&&str| Command::new(name).arg("--version").output().is_ok();
    let Some(browser) = browsers.iter().find(found) else {
        println!("skipped: none of {browsers:?} is installed; the page was not shown to a browser");
        return;
    };
    for width in [400, 1400] {
        let shot = format!("{page}.{width}.png");
        let outcome = Command::new(browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr"])
            .arg(format!("--window-size={width},1600"))
            .arg(format!("--screenshot={shot}"))
            .arg(format!("file://{page}"))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&outcome.stderr);
        assert!(!said.contains("CONSOLE"), "{said}");
        assert!(Path::new(&shot).metadata().unwrap().len() > 10_000, "an empty picture");
    }
}

#[test]
fn what_is_no_recording_or_no_page_is_refused() {
    let folder = Folder::new();
    let out = argument(&folder.path("page.html"));
    let broken = folder.write("broken.mcap", "no recording");
    run(&["report", &broken, "--out", &out]).assert_refused(2, &["broken.mcap", "MCAP"]);
    run(&["report", "missing.mcap", "--out", &out]).assert_refused(2, &["missing.mcap"]);
    run(&["report", &broken, "--out", "page.txt"]).assert_refused(2, &["page.txt", ".html"]);
    assert!(!folder.path("page.html").exists());
}

/// Every topic that the layout shows is one that a recording holds.
#[test]
fn the_layout_for_viewers_names_topics_that_exist() {
    let folder = Folder::new();
    let recording = cranny_record::Recording::open(recorded(&folder)).unwrap();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/layouts/cranny.json");
    let text = std::fs::read_to_string(file).unwrap();
    let layout: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut named = Vec::new();
    let mut open = vec![&layout["configById"]];
    while let Some(value) = open.pop() {
        match value {
            serde_json::Value::String(text) if text.starts_with('/') => named.push(text.as_str()),
            serde_json::Value::Array(all) => open.extend(all),
            serde_json::Value::Object(all) => {
                named.extend(all.keys().map(String::as_str).filter(|key| key.starts_with('/')));
                open.extend(all.values());
            }
            _ => {}
        }
    }
    assert!(named.len() > 10, "{named:?}");
    let measures: Vec<String> = recording.stats().unwrap()[1]
        .1
        .measures
        .iter()
        .map(|measure| measure.name.clone())
        .collect();
    for path in named {
        let topic = path.split('.').next().unwrap();
        // A viewer shows the log where there is one.
        let known = recording.topics().contains_key(topic) || topic == "/log";
        assert!(known, "{path}");
        if let Some((_, name)) = path.split_once("name==\"") {
            let name = name.split('"').next().unwrap();
            assert!(measures.iter().any(|measure| measure == name), "{path}: {measures:?}");
        }
    }
}

#[test]
fn a_strip_has_1_to_24_pictures() {
    for count in ["0", "25", "-1", "x"] {
        let outcome = run(&["report", "a.mcap", "--out", "a.html", "--pictures", count]);
        let says = "a strip has a whole number of pictures from 1 to 24";
        assert!(outcome.code == Some(2) && outcome.stderr.contains(says), "{outcome:?}");
    }
}
