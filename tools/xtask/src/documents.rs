//! Markdown files: links that resolve, bounds that hold. And the bounds of comments in source
//! files.
//!
//! A page that grows past its bound has become a diary: what was tried goes to `docs/notebook`.

use crate::comments::{self, COLUMNS};
use crate::report::Violation;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The most lines of ARCHITECTURE.md: what one reads at a sitting.
const ARCHITECTURE_LINES: usize = 250;

/// The most lines of a crate's README.
const README_LINES: usize = 120;

/// The most lines of an example, which shows one capability.
const EXAMPLE_LINES: usize = 80;

/// Examples that are whole programs, which show how capabilities go together.
const WHOLE_PROGRAMS: [&str; 1] = ["examples/marble_run.rs"];

/// Folders that hold no pages of ours.
const FOREIGN: [&str; 3] = [".git", "target", "out"];

/// Returns the number of files read, and everything that is wrong.
pub(crate) fn check(root: &Path) -> Result<(usize, Vec<Violation>), String> {
    let mut paths = Vec::new();
    collect(root, &mut paths)?;
    paths.sort();
    let mut violations = Vec::new();
    for path in &paths {
        let text = read(path)?;
        let relative = path.strip_prefix(root).unwrap_or(path);
        if path.extension().is_some_and(|extension| extension == "rs") {
            violations.extend(comments::check(relative, &text));
            violations.extend(check_example(&relative.display().to_string(), &text));
            continue;
        }
        let shown = relative.display().to_string();
        violations.extend(check_length(&shown, &text));
        violations.extend(check_columns(&shown, &text));
        for (line, link) in links(&text) {
            if let Some(reason) = broken(path, &link)? {
                violations.push(Violation {
                    place: format!("{shown}:{line}"),
                    rule: "link",
                    found: format!("`{link}`"),
                    reason,
                });
            }
        }
    }
    Ok((paths.len(), violations))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Every Markdown file and source file beneath a folder.
fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), String> {
    let wrong = |e: std::io::Error| format!("{}: {e}", folder.display());
    for entry in fs::read_dir(folder).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(wrong)?);
        let name = entry.file_name();
        if kind.is_dir() && !FOREIGN.iter().any(|foreign| name == *foreign) {
            collect(&path, paths)?;
        } else if kind.is_file() && path.extension().is_some_and(|e| e == "md" || e == "rs") {
            paths.push(path);
        }
    }
    Ok(())
}

fn check_length(file: &str, text: &str) -> Option<Violation> {
    let most = match file {
        "ARCHITECTURE.md" => ARCHITECTURE_LINES,
        _ if file.starts_with("crates/") && file.ends_with("/README.md") => README_LINES,
        _ => return None,
    };
    let lines = text.lines().count();
    (lines > most).then(|| Violation {
        place: file.to_owned(),
        rule: "page-length",
        found: format!("{lines} lines, at most {most}"),
        reason: "a newcomer reads this page: move what was tried, with its figures, to docs/notebook",
    })
}

fn check_example(file: &str, text: &str) -> Option<Violation> {
    let lines = text.lines().count();
    let is_bound = file.starts_with("examples/") && !WHOLE_PROGRAMS.contains(&file);
    (is_bound && lines >= EXAMPLE_LINES).then(|| Violation {
        place: file.to_owned(),
        rule: "example-length",
        found: format!("{lines} lines, where fewer than {EXAMPLE_LINES} are allowed"),
        reason: "an example shows one capability: leave out what it does not need, or split it",
    })
}

fn check_columns(file: &str, text: &str) -> Vec<Violation> {
    let is_long = |line: &str| line.chars().count() > COLUMNS && !line.starts_with('|');
    prose(text)
        // A line without a blank cannot be broken.
        .filter(|(_, line)| is_long(line) && line.trim().contains(' '))
        .map(|(number, line)| Violation {
            place: format!("{file}:{number}"),
            rule: "columns",
            found: format!("{} columns", line.chars().count()),
            reason: "break lines of prose at 100 columns",
        })
        .collect()
}

/// Lines outside of code fences, by number.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_fence = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        if line.trim_start().starts_with("```") {
            in_fence = !in_fence;
            return None;
        }
        (!in_fence).then_some((index + 1, line))
    })
}

/// The targets of inline links and pictures, `[text](target)`, with their lines. Spans of code hold
/// none.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        let plain: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
        let mut rest = plain.as_str();
        while let Some(begin) = rest.find("](") {
            rest = &rest[begin + 2..];
            let Some(end) = rest.find(')') else { break };
            found.push((number, rest[..end].to_owned()));
            rest = &rest[end + 1..];
        }
    }
    found
}

/// What is wrong with a link of a page.
fn broken(page: &Path, link: &str) -> Result<Option<&'static str>, String> {
    if link.contains("://") || link.starts_with("mailto:") {
        return Ok(None);
    }
    let (file, anchor) = link.split_once('#').map_or((link, None), |(file, at)| (file, Some(at)));
    let target = match file {
        "" => page.to_owned(),
        file => page.with_file_name("").join(file),
    };
    if !target.exists() {
        return Ok(Some("no such file: links are relative to the page"));
    }
    let Some(anchor) = anchor.filter(|_| target.extension().is_some_and(|e| e == "md")) else {
        return Ok(None);
    };
    let known = anchors(&read(&target)?).contains(anchor);
    Ok((!known).then_some("no such heading in that page"))
}

/// The anchors that a viewer makes of headings: lower case, blanks as hyphens, punctuation left
/// out.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter_map(|(_, line)| {
        let title = line.trim_start_matches('#');
        (title.len() < line.len()).then(|| title.trim())
    });
    let slug = |title: &str| {
        let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
    };
    headings.map(slug).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_outside_of_code() {
        let text =
            "See [a](b.md) and [`c`](d.md#e).\n```\n[no](no.md)\n```\n`[no](no.md)` ![p](q.png)";
        let found: Vec<String> = links(text).into_iter().map(|(_, link)| link).collect();
        assert_eq!(found, ["b.md", "d.md#e", "q.png"]);
        assert_eq!(links("\n[a](b)")[0].0, 2);
    }

    #[test]
    fn headings_become_anchors() {
        let known = anchors("# Two lines\n## What `x` is, today\ntext\n```\n# none\n```");
        assert_eq!(known.into_iter().collect::<Vec<_>>(), ["two-lines", "what-x-is-today"]);
    }

    #[test]
    fn long_prose_is_found_and_tables_and_code_are_not() {
        let long = "word ".repeat(30);
        let text = format!("{long}\n| {long} |\n```\n{long}\n```\n{}", "x".repeat(200));
        let places: Vec<String> =
            check_columns("p.md", &text).into_iter().map(|v| v.place).collect();
        assert_eq!(places, ["p.md:1"]);
    }

    #[test]
    fn pages_have_bounds() {
        let lines = |n: usize| "x\n".repeat(n);
        assert!(check_length("crates/a/README.md", &lines(README_LINES)).is_none());
        assert!(check_length("crates/a/README.md", &lines(README_LINES + 1)).is_some());
        assert!(check_length("ARCHITECTURE.md", &lines(ARCHITECTURE_LINES + 1)).is_some());
        assert!(check_length("CHANGELOG.md", &lines(1000)).is_none());
        assert!(check_example("examples/a.rs", &lines(EXAMPLE_LINES - 1)).is_none());
        assert!(check_example("examples/a.rs", &lines(EXAMPLE_LINES)).is_some());
        assert!(check_example(WHOLE_PROGRAMS[0], &lines(EXAMPLE_LINES)).is_none());
        assert!(check_example("crates/a/examples/a.rs", &lines(1000)).is_none());
    }

    #[test]
    fn a_link_that_leads_nowhere_is_broken() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        assert_eq!(broken(&here, "https://example.org/x"), Ok(None));
        assert_eq!(broken(&here, "src/main.rs"), Ok(None));
        assert!(broken(&here, "src/missing.rs").is_ok_and(|wrong| wrong.is_some()));
        assert!(broken(&here, "../../README.md#no-such-heading").is_ok_and(|w| w.is_some()));
    }
}
