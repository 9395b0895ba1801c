//! The page that `cranny inspect` prints for people.

mod concavities;

use super::summary::{FindingLine, Summary};
use crate::words::{counted, number, point};

/// So many findings of one kind are listed; the rest is counted.
const LISTED: usize = 3;

/// So many faces, vertices or components of a finding are named.
const LISTED_IDS: usize = 8;

/// The report as lines of text.
pub(super) fn page(summary: &Summary) -> String {
    let mut lines = vec![format!("{} ({})", summary.file, summary.format)];
    let mut row = |label: &str, value: String| lines.push(format!("  {label:<11}{value}"));
    row("vertices", vertices(summary));
    row("faces", format!("{} in {}", faces(summary), counted(summary.components, "component")));
    row("surface", surface(summary));
    let [low, high] = summary.bounds;
    row("bounds", format!("{} to {}", point(low), point(high)));
    row("area", number(summary.area));
    row("volume", summary.volume.map_or_else(|| "none: not closed".to_owned(), number));
    row("same place", within(summary));
    if let Some(dents) = dents(summary) {
        row("", dents);
    }
    let hull = &summary.hull;
    row(
        "hull",
        format!(
            "{}: {}, {}, {}",
            hull.kind,
            counted(hull.vertices, "vertex"),
            counted(hull.triangles, "triangle"),
            counted(hull.facets, "facet")
        ),
    );
    row(
        "",
        format!("area {}, volume {}{}", number(hull.area), number(hull.volume), share(summary)),
    );
    row("", format!("facets up to {} thick", number(hull.thickness_max)));
    row("on hull", on_the_hull(summary));
    row("off hull", concavities::in_short(summary));
    row("patches", summary.patches.to_string());
    let time = &summary.time_ms;
    row(
        "time",
        format!(
            "read {:.1} ms, repair {:.1} ms, trees {:.1} ms, scan {:.1} ms, hull {:.1} ms, \
             classify {:.1} ms, caps {:.1} ms, envelopes {:.1} ms",
            time.read,
            time.repair,
            time.trees,
            time.scan,
            time.hull,
            time.classify,
            time.caps,
            time.envelopes
        ),
    );
    row("digest", summary.digest.clone());
    concavities::table(&mut lines, &summary.concavities);
    list(&mut lines, "notes from reading", summary.notes.iter().cloned());
    list(&mut lines, "repairs", summary.repairs.iter().flatten().map(|repair| repair.text.clone()));
    findings(&mut lines, &summary.findings);
    if !summary.findings_complete {
        lines.push("  - too many faces meet: the search for them was given up".to_owned());
    }
    list(&mut lines, "written", summary.outputs.iter().cloned());
    list(&mut lines, "in the picture", summary.legend.iter().cloned());
    list(&mut lines, "skipped", summary.skipped.iter().map(|s| format!("{}: {}", s.what, s.why)));
    lines.join("\n")
}

fn vertices(summary: &Summary) -> String {
    as_filed(summary.vertices, summary.filed_vertices)
}

fn faces(summary: &Summary) -> String {
    as_filed(summary.faces, summary.filed_faces)
}

fn as_filed(count: usize, filed: Option<usize>) -> String {
    match filed {
        Some(filed) if filed != count => format!("{count} ({filed} in the file)"),
        _ => count.to_string(),
    }
}

/// That repairs moved the surface by more than counts as flat, so that what they left of planes is
/// reported as concavities.
fn dents(summary: &Summary) -> Option<String> {
    let moved = summary.deviation?;
    let largest = summary.bounds.iter().flatten().fold(0.0, |most, x| x.abs().max(most));
    (moved > summary.flatness * largest).then(|| {
        format!(
            "that is more than counts as flat: dents so deep are reported as concavities; --flat {:.0e} takes them for rounding",
            // Either side of a plane.
            2.0 * moved / largest
        )
    })
}

/// What 'the same place' meant, and how far repairs moved the surface.
fn within(summary: &Summary) -> String {
    match summary.deviation {
        None | Some(0.0) => format!("within {}", number(summary.weld_distance)),
        Some(off) => format!(
            "within {}; the surface is the filed one within {}",
            number(summary.weld_distance),
            number(off)
        ),
    }
}

fn surface(summary: &Summary) -> String {
    let closed = match summary.closed {
        true => "closed: bounds a solid",
        false => "open: a surface without inside",
    };
    let oriented = match summary.oriented {
        true => "consistently oriented",
        false => "orientations contradict",
    };
    format!("{closed}; {oriented}")
}

/// How much of its hull the solid fills.
fn share(summary: &Summary) -> String {
    match summary.volume {
        Some(volume) if summary.hull.volume > 0.0 => {
            format!(" ({:.1} % of it filled)", 100.0 * volume / summary.hull.volume)
        }
        _ => String::new(),
    }
}

/// The convex sets, and what borders them.
fn on_the_hull(summary: &Summary) -> String {
    let features = &summary.features;
    let mut parts = vec![counted(features.convex_sets, "convex set")];
    for (count, what) in [
        (features.boundary_edges, "boundary edge"),
        (features.ridges, "ridge"),
        (features.isolated_vertices, "isolated vertex"),
    ] {
        if count > 0 {
            parts.push(counted(count, what));
        }
    }
    parts.join(", ")
}

fn list(lines: &mut Vec<String>, title: &str, entries: impl Iterator<Item = String>) {
    let mut entries = entries.peekable();
    if entries.peek().is_some() {
        lines.push(title.to_owned());
        lines.extend(entries.map(|entry| format!("  - {entry}")));
    }
}

/// Each kind once: how many, what they mean, the first few.
fn findings(lines: &mut Vec<String>, findings: &[FindingLine]) {
    let mut kinds: Vec<&str> = Vec::new();
    for finding in findings {
        if !kinds.contains(&finding.kind) {
            kinds.push(finding.kind);
        }
    }
    lines.push(if kinds.is_empty() { "findings: none" } else { "findings" }.to_owned());
    for kind in kinds {
        let of_kind: Vec<_> = findings.iter().filter(|finding| finding.kind == kind).collect();
        let count: usize = of_kind.iter().map(|finding| finding.count).sum();
        let meaning = of_kind[0].meaning;
        lines.push(format!("  - {count} x {}: {meaning}", kind.replace('_', " ")));
        lines.extend(of_kind[0].limits.iter().map(|limit| format!("      {limit}")));
        lines.extend(of_kind.iter().take(LISTED).map(|finding| place(finding)));
        if of_kind.len() > LISTED {
            lines.push(format!(
                "      and {} more (all with --format json)",
                of_kind.len() - LISTED
            ));
        }
    }
}

/// Where one finding is: a point, its size, the first few of what it concerns.
fn place(finding: &FindingLine) -> String {
    let (at, size) = (point(finding.at), number(finding.measure));
    if finding.count > 1 {
        return format!("      the largest at {at}, size {size}");
    }
    let named: Vec<String> = finding.ids.iter().take(LISTED_IDS).map(u32::to_string).collect();
    let more = match finding.ids.len().saturating_sub(LISTED_IDS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let what = match (finding.of, finding.ids.len()) {
        (of, 1) => of.to_owned(),
        ("vertex", _) => "vertices".to_owned(),
        (of, _) => format!("{of}s"),
    };
    format!("      at {at}, size {size}, {what} {}{more}", named.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_are_counted_by_kind_and_the_first_few_listed() {
        let finding = |kind, id| FindingLine {
            kind,
            meaning: "what it is",
            of: "face",
            ids: vec![id],
            at: [0.0, 0.5, 1.0],
            measure: 2.0,
            count: 1,
            limits: &["no volume"],
        };
        let mut all: Vec<_> = (0..5).map(|id| finding("open_edge", id)).collect();
        all.push(finding("zero_area_face", 9));
        let mut lines = Vec::new();
        findings(&mut lines, &all);
        assert_eq!(lines[0], "findings");
        assert_eq!(lines[1], "  - 5 x open edge: what it is");
        assert_eq!(lines[2], "      no volume");
        assert_eq!(lines[3], "      at (0, 0.5, 1), size 2, face 0");
        assert!(lines[6].contains("and 2 more"));
        assert_eq!(lines[7], "  - 1 x zero area face: what it is");
        assert_eq!(lines.len(), 10);
        let summed = FindingLine { count: 40, ids: Vec::new(), ..finding("flat_edge", 0) };
        let long = FindingLine { ids: (0..10).collect(), ..finding("open_edge", 0) };
        assert_eq!(place(&summed), "      the largest at (0, 0.5, 1), size 2");
        assert!(place(&long).ends_with("faces 0, 1, 2, 3, 4, 5, 6, 7 and 2 more"));
        let mut none = Vec::new();
        findings(&mut none, &[]);
        assert_eq!(none, ["findings: none"]);
    }
}
