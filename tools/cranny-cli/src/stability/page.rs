//! The page: the questions, the answers, pass or fail; for whoever has not read anything else.

use cranny_stability::{Outcome, Settings};

use super::rows::{Row, number};
use super::{FamilyOutcome, summary};

/// So many cases are written out where there are more.
const EXAMPLES: usize = 10;

/// Of what parry got wrong, so many.
const PEER_EXAMPLES: usize = 3;

/// The page in Markdown, beside `stability.svg`.
pub(super) fn page(outcomes: &[FamilyOutcome], settings: &Settings) -> String {
    let mut text = "# Do hard cases come out right?\n\n".to_owned();
    text += &format!(
        "{}. Seed {}, variants {}.\n\n",
        summary(outcomes),
        settings.seed,
        settings.variants
    );
    text += "The truth of a pair of bodies is known by how it was made, or from exact rationals, which construct \
             what the detector decides by signs; hulls are held against rationals too, a walk's lengths to \
             some hundred roundings and its depths in f64. In the family memory the detector is compared \
             with itself: without memory, and with its own search of all pairs of faces. A case fails for \
             any wrong verdict, for a length outside the interval that is claimed to hold it, for an \
             interval that is wide, and for any difference that memory, the order of faces or exchanging \
             the bodies makes.\n\n";
    text += "| family | cases | failed | worst | of claim | parry: wrong | parry: refused | parry: worst |\n";
    text += "|---|---:|---:|---:|---:|---:|---:|---:|\n";
    for (_, outcome) in outcomes {
        text += &line(&Row::of(outcome));
    }
    text += "\n*worst*: the largest figure of all cases, which for pairs of bodies is the error of the distance \
             in sizes of the larger body. *Of claim*: the largest error as a share of what the certified \
             interval allows. *parry*: its triangle meshes, for hulls its convex polyhedra, given the same in \
             single precision, as its default build takes numbers; wrong where it reports bodies apart that \
             overlap or the other way round. Where bodies only touch, either answer counts as right; a hull is wrong where it \
             is not closed, or a point lies farther outside than single precision explains. Many cases differ \
             from others by less than single precision can hold: what parry gets wrong shows what that \
             precision decides, not that its methods are at fault.\n\n";
    text += "![worst figure of each family](stability.svg)\n";
    for (family, outcome) in outcomes {
        text += &format!("\n## {}\n\n", family.name);
        text += &format!(
            "- **Question**: {}
",
            family.question
        );
        text += &format!("- **Made and judged**: {}\n", family.made);
        text += &format!("- **Fails**: {}.\n", family.fails);
        text += &format!("- **Figure**: {}.\n", family.figure);
        text += &details(outcome);
    }
    text += "\nEvery case stands in `cases.csv`, the table in `stability.csv`.\n";
    text
}

fn line(row: &Row) -> String {
    let failed = match row.failed {
        0 => "0".to_owned(),
        failed => format!("**{failed}**"),
    };
    let (wrong, refused) = match row.peer_cases {
        0 => ("-".to_owned(), "-".to_owned()),
        cases => (format!("{} of {cases}", row.peer_wrong), row.peer_refused.to_string()),
    };
    format!(
        "| [{}](#{}) | {} | {failed} | {} | {} | {wrong} | {refused} | {} |\n",
        row.family,
        row.family,
        row.cases,
        number(row.worst),
        number(row.of_claim),
        number(row.peer_worst)
    )
}

fn details(outcome: &Outcome) -> String {
    let mut text = String::new();
    if !outcome.counts.is_empty() {
        let counts: Vec<String> =
            outcome.counts.iter().map(|(what, count)| format!("{what} {count}")).collect();
        text += &format!("- **Counted**: {}.\n", counts.join(", "));
    }
    if let Some((case, figure)) = outcome.worst() {
        text += &format!("- **Worst**: {} ({}).\n", number(Some(figure)), case.name);
    }
    let failed: Vec<_> = outcome.cases.iter().filter(|case| !case.faults.is_empty()).collect();
    match failed.len() {
        0 => text += &format!("- **Result**: all {} cases passed.\n", outcome.cases.len()),
        count => {
            text += &format!("- **Result**: {count} of {} cases failed:\n", outcome.cases.len());
            for case in failed.iter().take(EXAMPLES) {
                text += &format!(
                    "  - {}: it is so: {}; answer: {}; {}\n",
                    case.name,
                    case.truth,
                    case.answer,
                    case.faults.join("; ")
                );
            }
            if count > EXAMPLES {
                text += &format!("  - and {} more\n", count - EXAMPLES);
            }
        }
    }
    let mut wrong: Vec<_> = outcome.peer_cases().filter(|(_, peer)| peer.wrong).collect();
    wrong.sort_by(|(_, p), (_, q)| q.figure.unwrap_or(0.0).total_cmp(&p.figure.unwrap_or(0.0)));
    if !wrong.is_empty() {
        text +=
            &format!("- **parry** is wrong in {} cases, the farthest off first:\n", wrong.len());
        for (case, peer) in wrong.iter().take(PEER_EXAMPLES) {
            text +=
                &format!("  - {}: it is so: {}; answer: {}\n", case.name, case.truth, peer.answer);
        }
    }
    text
}
