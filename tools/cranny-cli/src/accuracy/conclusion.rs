//! What the figures say, in sentences.

use super::chart::{percent, rounded};
use super::figures::MethodFigures;
use super::panel::Panel;

/// Errors that are looked for, as shares of a body's size: ten times smaller each.
const LADDER: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// An error below this share of a body's size counts as none. Smaller: single precision, which
/// parry computes in, counts as an error; larger: what misses a contact by a hair is called exact.
const NONE: f64 = 1e-5;

/// A method that is wrong about whether bodies meet at a larger part of the poses is no better
/// choice, however quick.
const MISJUDGED: f64 = 0.01;

/// A method that is wrong about it at a larger part is none.
const USELESS: f64 = 0.5;

/// A kind of poses, in words, and its panel of a row.
type NamedPanel = (&'static str, fn(&MethodFigures) -> &Panel);

const PANELS: [NamedPanel; 2] =
    [("where bodies are apart", |row| &row.apart), ("where they overlap", |row| &row.overlapping)];

/// A paragraph for each kind of poses that there are.
pub(super) fn paragraphs(all: &[MethodFigures]) -> Vec<String> {
    PANELS.iter().filter_map(|kind| paragraph(all, kind)).collect()
}

fn paragraph(all: &[MethodFigures], (place, of): &NamedPanel) -> Option<String> {
    let exact = quickest(all, *of, 0.0)?;
    let mut sentences = vec![format!(
        "{}, an exact answer takes {} us on average.",
        capital(place),
        micros(exact.us)
    )];
    sentences.extend(ladder(all, *of, exact));
    for (name, method) in [
        ("Parry's triangle mesh is", "parry-trimesh"),
        ("Its convex pieces are", "parry-decomposition"),
    ] {
        let peer = all.iter().find(|row| row.name.method == method);
        sentences.extend(peer.and_then(|row| beside(name, of(row), all, *of, exact)));
    }
    Some(sentences.join(" "))
}

/// A time and the error that it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost {
    us: f64,
    error: f64,
}

/// The least time in which a method of ours keeps within an error.
fn quickest(all: &[MethodFigures], of: fn(&MethodFigures) -> &Panel, error: f64) -> Option<Cost> {
    let costs = all.iter().filter(|row| row.name.is_ours()).filter_map(|row| cost(of(row)));
    let enough = costs.filter(|cost| cost.error <= error.max(NONE));
    enough.min_by(|x, y| x.us.total_cmp(&y.us))
}

fn cost(panel: &Panel) -> Option<Cost> {
    Some(Cost { us: panel.mean_us?, error: panel.error? })
}

/// What ten times more error saves, step by step.
fn ladder(all: &[MethodFigures], of: fn(&MethodFigures) -> &Panel, exact: Cost) -> Option<String> {
    let steps = LADDER.map(|error| quickest(all, of, error).map(|cost| (error, cost.us)));
    let mut steps: Vec<(f64, f64)> = steps.into_iter().flatten().collect();
    // Of errors that take the same time, the least.
    steps.reverse();
    steps.dedup_by_key(|(_, us)| *us);
    steps.reverse();
    let cheaper: Vec<String> = steps
        .into_iter()
        .filter(|(_, us)| *us < 0.9 * exact.us)
        .map(|(error, us)| format!("{} us within {}", micros(us), percent(error)))
        .collect();
    if cheaper.is_empty() {
        return Some("No coarser answer of ours comes within 10 % for less.".to_owned());
    }
    Some(format!("Coarser ones take {} of the size of the smaller body.", cheaper.join(", ")))
}

/// What a peer's answers cost, and what they are worth.
fn beside(
    name: &str,
    peer: &Panel,
    all: &[MethodFigures],
    of: fn(&MethodFigures) -> &Panel,
    exact: Cost,
) -> Option<String> {
    let cost = cost(peer)?;
    let ratio = cost.us / exact.us;
    let pace = match ratio {
        r if r > 1.1 => format!("{} times slower", times(r)),
        r if r < 0.9 => format!("{} times faster", times(1.0 / r)),
        _ => "as fast".to_owned(),
    };
    let mut words = format!("{name} {pace}");
    words += &match cost.error {
        error if error <= NONE => " and as exact".to_owned(),
        error => format!(" and off by {} of the size on average", percent(error)),
    };
    if peer.wrong > 0 {
        words +=
            &format!(", and wrong about whether they meet at {} of {}", peer.wrong, peer.poses);
    }
    let matched = quickest(all, of, cost.error);
    let wins = cost.us < matched.map_or(f64::INFINITY, |ours| ours.us);
    let misjudged = peer.wrong as f64 / peer.poses.max(1) as f64;
    words += match (wins && misjudged <= MISJUDGED, cost.error <= NONE) {
        (true, true) => ": the better choice here.",
        (true, false) => ": the better choice where that is good enough.",
        (false, _) if misjudged > USELESS => ": no choice here.",
        (false, _) => ".",
    };
    Some(words)
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn micros(us: f64) -> String {
    let us = rounded(us);
    if us >= 10.0 { format!("{us:.0}") } else { format!("{us:.2}") }
}

fn times(ratio: f64) -> String {
    let ratio = rounded(ratio);
    if ratio >= 10.0 { format!("{ratio:.0}") } else { format!("{ratio:.1}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::method::Name;

    fn row(method: &'static str, us: f64, error: f64) -> MethodFigures {
        let level = (method == "cranny").then(|| "tree:4".to_owned());
        let name = Name { level, ..Name::of_peer(method) };
        let (mean_us, error) = (Some(us), Some(error));
        let apart = Panel { poses: 700, mean_us, error, wrong: 2, ..Panel::default() };
        MethodFigures { apart, ..MethodFigures::none(name, String::new()) }
    }

    #[test]
    fn what_a_tenth_of_the_error_costs_is_said() {
        let all = [row("cranny", 1.0, 0.09), row("cranny", 3.0, 0.005), row("cranny", 12.0, 1e-9)];
        let [said] = &paragraphs(&all)[..] else { panic!("one kind") };
        assert_eq!(
            said,
            "Where bodies are apart, an exact answer takes 12 us on average. Coarser ones take \
             1.00 us within 10 %, 3.00 us within 1 % of the size of the smaller body."
        );
        let same = [row("cranny", 1.0, 0.0005), row("cranny", 12.0, 0.0)];
        let said = paragraphs(&same).remove(0);
        assert!(
            said.ends_with(
                "Coarser ones take 1.00 us within 0.1 % of the size of the smaller body."
            ),
            "{said}"
        );
        let said = paragraphs(&[row("cranny", 1.0, 0.0), row("cranny", 3.0, 0.5)]).remove(0);
        assert!(said.ends_with("comes within 10 % for less."), "{said}");
        assert!(paragraphs(&[]).is_empty());
    }

    #[test]
    fn a_peer_is_the_better_choice_where_it_is_quicker_at_its_error() {
        let ours = [row("cranny", 1.0, 0.5), row("cranny", 12.0, 0.0)];
        let beside = |peer| paragraphs(&[&ours[..], &[peer]].concat()).remove(0);
        let quick = beside(row("parry-decomposition", 3.0, 0.012));
        let said = "Its convex pieces are 4.0 times faster and off by 1.2 % of the size on \
                    average, and wrong about whether they meet at 2 of 700: the better choice where \
                    that is good enough.";
        assert!(quick.ends_with(said), "{quick}");
        let slow = beside(row("parry-trimesh", 24.0, 1e-8));
        assert!(slow.contains("2.0 times slower and as exact, and wrong"), "{slow}");
        assert!(!slow.contains("better choice"), "{slow}");
        let mut misjudging = row("parry-decomposition", 3.0, 0.012);
        misjudging.apart.wrong = 8;
        assert!(beside(misjudging.clone()).ends_with("at 8 of 700."));
        misjudging.apart.wrong = 700;
        assert!(beside(misjudging).ends_with("at 700 of 700: no choice here."));
        // Its error is one that ours reaches sooner.
        assert!(!beside(row("parry-trimesh", 2.0, 0.6)).contains("better choice"));
    }
}
