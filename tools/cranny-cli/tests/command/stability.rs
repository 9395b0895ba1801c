//! What `stability` prints and writes.

use std::fs;

use crate::harness::{Folder, argument, run};

fn text(folder: &Folder, name: &str) -> String {
    fs::read_to_string(folder.path("out").join(name)).unwrap()
}

#[test]
fn a_family_is_judged_told_and_written() {
    let folder = Folder::new();
    let out = argument(&folder.path("out"));
    let outcome = run(&["stability", "--family", "contacts", "--variants", "1", "--out", &out]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    let lines: Vec<&str> = outcome.stdout.lines().collect();
    assert_eq!(lines.len(), 3, "{outcome:?}");
    assert!(lines[0].starts_with("family") && lines[1].starts_with("contacts"), "{lines:?}");
    assert!(lines[2].starts_with("55 cases in ") && lines[2].ends_with("none failed"), "{lines:?}");

    let (row, cases) = (text(&folder, "stability.csv"), text(&folder, "cases.csv"));
    assert_eq!((row.lines().count(), cases.lines().count()), (2, 56));
    assert!(row.lines().nth(1).unwrap().starts_with("contacts,55,0,"), "{row}");
    assert!(cases.lines().skip(1).all(|case| case.contains(",true,\"\",")), "{cases}");
    // In single precision a gap of 2^-50 beside coordinates of 1 is none: whoever sees one is
    // lucky.
    let wrong = cases.lines().filter(|case| case.contains(",true,false,")).count();
    assert!(wrong > 0, "{cases}");
    let (page, chart) = (text(&folder, "stability.md"), text(&folder, "stability.svg"));
    for words in ["| [contacts](#contacts) | 55 | 0 |", "all 55 cases passed", "(stability.svg)"] {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert!(chart.starts_with("<svg") && chart.trim_end().ends_with("</svg>"));
    assert!(chart.contains("failed: 0 of 55") && !chart.contains("NaN"));
}

#[test]
fn the_same_seed_gives_the_same_cases_alone_or_with_others() {
    let folder = Folder::new();
    let cases = |families: &[&str], seed: &str| {
        let out = argument(&folder.path("out"));
        let named = families.iter().flat_map(|family| ["--family", family]);
        let fixed = ["stability", "--variants", "1", "--no-peers", "--seed", seed, "--out", &out];
        let lines =
            run(&fixed.into_iter().chain(named).chain(["--format", "json"]).collect::<Vec<_>>())
                .json_lines();
        assert_eq!(lines.len(), families.len());
        for line in &lines {
            assert_eq!((&line["failed"], &line["peer_cases"]), (&0.into(), &0.into()), "{line}");
        }
        let all = text(&folder, "cases.csv");
        all.lines().filter(|line| line.starts_with("order")).map(str::to_owned).collect::<Vec<_>>()
    };
    let alone = cases(&["order"], "5");
    assert!(alone.len() > 20 && alone == cases(&["contacts", "order"], "5"));
    assert_ne!(alone, cases(&["order"], "6"));
}

#[test]
fn families_are_listed_and_others_refused() {
    let listed = run(&["stability", "--list", "--format", "json"]).json_lines();
    let names: Vec<&str> = listed.iter().map(|line| line["family"].as_str().unwrap()).collect();
    assert!(names.contains(&"needles") && names.contains(&"memory"), "{names:?}");
    let text = run(&["stability", "--list"]);
    assert!(names.iter().all(|name| text.stdout.contains(name)), "{text:?}");
    let help = run(&["stability", "--help"]);
    assert!(help.code == Some(0) && help.stdout.contains("exact rationals"), "{help:?}");

    let unknown = run(&["stability", "--family", "noodles"]);
    assert!(unknown.code == Some(2) && unknown.stderr.contains("needles"), "{unknown:?}");
    for wrong in [["--variants", "0"], ["--seed", "x"], ["--list", "--out=x"]] {
        assert_eq!(run(&["stability", wrong[0], wrong[1]]).code, Some(2), "{wrong:?}");
    }
    let folder = Folder::new();
    let taken = folder.write("taken", "a file");
    run(&["stability", "--out", &taken]).assert_refused(1, &["taken"]);
}
