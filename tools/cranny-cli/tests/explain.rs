//! End-to-end tests of `cranny explain`.

use std::collections::BTreeSet;
use std::fs;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn explain(effects: &str, more: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.ron");
    let text = format!(
        r#"(bodies: [
            (name: "lower", shape: Generator(Cuboid(size: (1, 1, 1))), kind: Fixed),
            (name: "upper", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0, 0, 2))),
        ], effects: [{effects}])"#
    );
    fs::write(&path, text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_cranny"));
    command.env_remove("RUST_LOG").stdin(Stdio::null());
    let output = command.arg("explain").arg(&path).args(more).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    output
}

fn plan(effects: &str) -> Value {
    serde_json::from_slice(&explain(effects, &["--format", "json"]).stdout).unwrap()
}

/// Schedule, system and its effects.
fn systems(plan: &Value) -> BTreeSet<(String, String, Vec<String>)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let list = |value: &Value| value.as_array().unwrap().clone();
    list(&plan["schedules"])
        .iter()
        .flat_map(|schedule| {
            list(&schedule["systems"]).into_iter().map(|system| {
                let effects = list(&system["effects"]).iter().map(text).collect();
                (text(&schedule["name"]), text(&system["name"]), effects)
            })
        })
        .collect()
}

#[test]
fn scenes_that_differ_by_one_effect_differ_by_its_systems() {
    let cases = [
        ("Response()", "Contacts(margin: 0.1)", "Contacts"),
        ("Response()", "Trigger()", "Trigger"),
        ("", "Response()", "Response"),
        ("Contacts(margin: 0.1)", "Trigger()", "Trigger"),
    ];
    for (less, more, name) in cases {
        let both = if less.is_empty() { more.to_owned() } else { format!("{less}, {more}") };
        let (without, with) = (plan(less), plan(&both));
        let (before, after) = (systems(&without), systems(&with));
        let added: Vec<_> =
            after.iter().filter(|a| !before.iter().any(|b| (&a.0, &a.1) == (&b.0, &b.1))).collect();
        assert!(!added.is_empty());
        for (schedule, system, effects) in added {
            assert!(effects.iter().any(|e| e == name), "{system} of {schedule}: {effects:?}");
        }
        for (schedule, system, _) in &before {
            let stays = after.iter().any(|a| (&a.0, &a.1) == (schedule, system));
            assert!(stays, "{system} of {schedule} is gone with {name}");
        }
        let absent = |plan: &Value| {
            plan["absent"].as_array().unwrap().iter().any(|effect| effect["name"] == name)
        };
        assert!(absent(&without) && !absent(&with));
    }
}

#[test]
fn the_text_has_pairs_first_then_effects_systems_and_what_is_absent() {
    let text = String::from_utf8(explain("Response(), Trigger()", &[]).stdout).unwrap();
    for word in [
        "Response: named by the scene",
        "CrannyStep, in this order",
        "response::step_solver ",
        "ResponseSystems::Solve",
        "CrannyEnd, in this order",
        "1: Trigger, Response, detected by solver",
        "lower and upper",
        "Contacts: the scene, its bodies and pairs name no Contacts",
        "Recording: no recording is asked for",
    ] {
        assert!(text.contains(word), "{word:?} is missing in\n{text}");
    }
    let at = |heading: &str| text.find(&format!("\n{heading}")).unwrap();
    let order = ["pairs", "effects", "CrannyStep", "CrannyEnd", "absent"].map(at);
    assert!(order.is_sorted(), "{text}");
}

#[test]
fn what_is_read_of_contacts_is_told_and_no_regions_are() {
    let effects = "Response(), Contacts(margin: 0.1)";
    let text = String::from_utf8(explain(effects, &[]).stdout).unwrap();
    for word in ["the summary reads depth", "computed: depth, solver contacts"] {
        assert!(text.contains(word), "{word:?} is missing in\n{text}");
    }
    let plan = plan(effects);
    assert_eq!(plan["effects"][0]["read_by"][0], "the summary reads depth");
    assert_eq!(plan["pairs"][0]["fields"], serde_json::json!(["depth", "solver contacts"]));
}
