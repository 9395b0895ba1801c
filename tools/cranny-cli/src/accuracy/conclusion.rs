//! What the figures say: what ten times less error costs, and when convex pieces are the better
//! choice.

use super::chart::{percent, rounded};
use super::figures::MethodFigures;
use super::panel::Panel;
use crate::compare::RunFigures;

/// Errors of the ladder, as shares of a body's size: ten times less each.
const LADDER: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// An error below this share of a body's size counts as none. Smaller: single precision, which
/// parry computes in, counts as an error; larger: what misses a contact by a hair is called exact.
const NONE: f64 = 1e-5;

/// A method that is wrong about whether bodies meet at a larger part of the poses is no better
/// choice, however quick.
const MISJUDGED: f64 = 0.01;

/// A kind of poses, in words, and its panel of a row.
struct PoseKind {
    place: &'static str,
    /// What is measured there.
    lengths: &'static str,
    of: fn(&MethodFigures) -> &Panel,
}

const KINDS: [PoseKind; 2] = [
    PoseKind { place: "where bodies are apart", lengths: "gaps", of: |row| &row.apart },
    PoseKind { place: "where they overlap", lengths: "depths", of: |row| &row.overlapping },
];

const PIECES: &str = "parry-decomposition";

/// An answer of ours.
struct Step {
    /// Mean.
    us: f64,
    method: String,
}

/// Headings and rows.
type Table = (Vec<String>, Vec<Vec<String>>);

/// A paragraph for each kind of poses that there are.
pub(super) fn paragraphs(all: &[MethodFigures]) -> Vec<String> {
    KINDS.iter().filter_map(|kind| kind.paragraph(all)).collect()
}

/// What ten times less error costs: a row for each error, from the largest to none; three columns
/// for each kind of poses that there are.
pub(super) fn ladder(all: &[MethodFigures]) -> Table {
    let mut headings = vec!["error at most".to_owned()];
    let errors = LADDER.map(Some).into_iter().chain([None]);
    let name = |error: Option<f64>| error.map_or("exact".to_owned(), percent);
    let mut rows: Vec<Vec<String>> = errors.map(|error| vec![name(error)]).collect();
    for kind in &KINDS {
        let Some(steps) = kind.steps(all) else { continue };
        let [_, place] = kind.place.split_once(' ').map_or([""; 2], |(a, b)| [a, b]);
        headings.extend([&*format!("{place}: µs"), "by", "times as long"].map(str::to_owned));
        let mut before: Option<f64> = None;
        for (row, step) in rows.iter_mut().zip(steps) {
            let us = step.as_ref().map(|step| step.us);
            let factor = us.zip(before).map_or(String::new(), |(us, before)| factor(us / before));
            row.extend([
                us.map_or("-".to_owned(), micros),
                step.map_or(String::new(), |step| step.method),
                factor,
            ]);
            before = us;
        }
    }
    (headings, rows)
}

/// When convex pieces are the better choice, by these figures; `None` where they have none.
/// `typical`: the gap and the depth in the middle, as shares of the size.
pub(super) fn about_pieces(
    all: &[MethodFigures],
    typical: [Option<f64>; 2],
    runs: &[RunFigures],
) -> Option<String> {
    let pieces = all.iter().find(|row| row.name.method == PIECES && row.note.is_none())?;
    let kinds = KINDS.iter().zip(typical);
    let judged: Vec<(bool, String)> =
        kinds.filter_map(|(kind, length)| kind.choice(all, pieces, length)).collect();
    let of_kind = |is_better: bool| -> Vec<&str> {
        judged.iter().filter(|(is, _)| *is == is_better).map(|(_, why)| &**why).collect()
    };
    let (better, worse) = (of_kind(true), of_kind(false));
    let mut sentences = Vec::new();
    if !better.is_empty() {
        sentences.push(format!("Convex pieces are the better choice {}.", better.join("; and ")));
    }
    if !worse.is_empty() {
        sentences
            .push(format!("Convex pieces are not the better choice {}.", worse.join("; nor ")));
    }
    sentences.extend(in_motion(runs));
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// What a solver makes of convex pieces, beside ours.
fn in_motion(runs: &[RunFigures]) -> Option<String> {
    let of = |detector| runs.iter().find(|run| run.setting.detector == detector);
    let (ours, pieces) = (of("cranny")?, of("rapier-decomposition")?);
    let time = pieces.step_ms?.mean / ours.step_ms?.mean;
    let mut words = format!(
        "In the motion a step takes {} times ours, after {:.1} s of making the pieces",
        times(time),
        pieces.setting.prepared_s
    );
    let depth = |run: &RunFigures| run.deepest.as_ref().map_or(0.0, |deepest| deepest.depth);
    words += &match (pieces.failure.is_some(), pieces.contained.is_some(), pieces.left.len()) {
        (true, ..) => ", and does not come to its end".to_owned(),
        (_, true, _) => ", and a body lies wholly within another".to_owned(),
        (_, _, left) if left > ours.left.len() => format!(", and {left} bodies leave the world"),
        _ => match (depth(pieces), depth(ours)) {
            (its, own) if its > 0.0 && own > 0.0 => {
                format!(", and the deepest overlap is {} times ours", times(its / own))
            }
            (its, _) if its > 0.0 => {
                format!(", and bodies overlap by {}, with ours not at all", rounded(its))
            }
            (_, own) if own > 0.0 => {
                format!(", and bodies do not overlap, with ours by {}", rounded(own))
            }
            _ => String::new(),
        },
    };
    Some(words + ".")
}

impl PoseKind {
    fn paragraph(&self, all: &[MethodFigures]) -> Option<String> {
        let exact = self.exact(all)?.us;
        let mut sentences = vec![format!(
            "{}, an exact answer takes {} µs on average.",
            capital(self.place),
            micros(exact)
        )];
        sentences.push(self.pace(all)?);
        for (name, method) in
            [("Parry's triangle mesh is", "parry-trimesh"), ("Its convex pieces are", PIECES)]
        {
            let peer = all.iter().find(|row| row.name.method == method);
            sentences.extend(peer.and_then(|row| self.beside(name, row, exact, self.poses(all))));
        }
        Some(sentences.join(" "))
    }

    /// The quickest answer of ours that promises to be exact.
    fn exact(&self, all: &[MethodFigures]) -> Option<Step> {
        self.quickest(all, |row, _| row.name.is_exact())
    }

    /// The quickest answer of ours that keeps within an error.
    fn within(&self, all: &[MethodFigures], error: f64) -> Option<Step> {
        self.quickest(all, |_, panel| panel.error.is_some_and(|found| found <= error))
    }

    fn quickest(
        &self,
        all: &[MethodFigures],
        serves: impl Fn(&MethodFigures, &Panel) -> bool,
    ) -> Option<Step> {
        let ours = all.iter().filter(|row| row.name.is_ours() && serves(row, (self.of)(row)));
        let steps = ours.filter_map(|row| {
            let method = format!("{}, {}", row.name.label(), row.name.memory);
            Some(Step { us: (self.of)(row).mean_us?, method })
        });
        steps.min_by(|a, b| a.us.total_cmp(&b.us))
    }

    /// The quickest answers by the errors of the ladder, the exact one last; `None` where there are
    /// no poses.
    fn steps(&self, all: &[MethodFigures]) -> Option<Vec<Option<Step>>> {
        let exact = self.exact(all)?;
        let within = LADDER.map(|error| self.within(all, error));
        Some(within.into_iter().chain([Some(exact)]).collect())
    }

    /// What ten times less error costs, in a sentence.
    fn pace(&self, all: &[MethodFigures]) -> Option<String> {
        let steps: Vec<f64> = self.steps(all)?.into_iter().flatten().map(|step| step.us).collect();
        let (first, last) = (*steps.first()?, *steps.last()?);
        if first >= 0.9 * last {
            return Some("No coarser answer of ours comes within 10 % for less.".to_owned());
        }
        let factors = || steps.windows(2).map(|pair| pair[1] / pair[0]);
        let least = factors().fold(f64::INFINITY, f64::min);
        let most = factors().fold(0.0, f64::max);
        Some(format!(
            "One within 10 % of the size of the smaller body takes {} µs, and each tenth of the \
             error {} to {} times as long.",
            micros(first),
            times(least),
            times(most)
        ))
    }

    /// How many poses there are.
    fn poses(&self, all: &[MethodFigures]) -> usize {
        all.iter().map(|row| (self.of)(row).poses).max().unwrap_or(0)
    }

    /// What a peer's answers cost, and what they are worth, at so many poses.
    fn beside(&self, name: &str, row: &MethodFigures, exact: f64, poses: usize) -> Option<String> {
        let peer = (self.of)(row);
        let (us, error) = (peer.mean_us?, peer.error?);
        let off = match error <= NONE {
            true => "nearly exact".to_owned(),
            false => format!("off by {} of the size", percent(error)),
        };
        let wrong = match peer.wrong {
            0 => String::new(),
            wrong if peer.poses < poses => format!(
                ", but wrong about whether bodies meet at {wrong} of the {} poses of {poses} for \
                 which there was time",
                peer.poses
            ),
            wrong => format!(", but wrong about whether bodies meet at {wrong} of {poses} poses"),
        };
        Some(format!("{name} {} and {off} on average{wrong}.", pace(us / exact)))
    }

    /// Whether a peer is the better choice, and why; `length`: the gap or the depth in the middle.
    fn choice(
        &self,
        all: &[MethodFigures],
        row: &MethodFigures,
        length: Option<f64>,
    ) -> Option<(bool, String)> {
        let peer = (self.of)(row);
        let (us, error) = (peer.mean_us?, peer.error?);
        let exact = self.exact(all)?.us;
        let place = self.place;
        if peer.wrong as f64 > MISJUDGED * peer.poses as f64 {
            let (wrong, poses) = (peer.wrong, peer.poses);
            let why = format!(
                "{place}: they are wrong about whether bodies meet at {wrong} of {poses} poses"
            );
            return Some((false, why));
        }
        if let Some(length) = length.filter(|length| error > length.max(NONE)) {
            let why = format!(
                "{place}: they are off by {}, and half of the {} are no more than {}",
                percent(error),
                self.lengths,
                percent(length)
            );
            return Some((false, why));
        }
        let ours = self.within(all, error.max(NONE)).map_or(exact, |step| step.us);
        let why = match (us < ours, error <= NONE) {
            (true, true) => format!("{place}: {}", pace(us / ours)),
            (true, false) => {
                format!("{place} and {} is good enough: {}", percent(error), pace(us / ours))
            }
            (false, _) => format!("{place}: ours is as good in {} µs", micros(ours)),
        };
        Some((us < ours, why))
    }
}

/// How many times faster or slower something is that takes so many times as long.
fn pace(ratio: f64) -> String {
    match ratio {
        r if r > 1.1 => format!("{} times slower", times(r)),
        r if r < 0.9 => format!("{} times faster", times(1.0 / r)),
        _ => "as fast".to_owned(),
    }
}

fn factor(ratio: f64) -> String {
    if ratio < 1.05 { "as long".to_owned() } else { format!("x {}", times(ratio)) }
}

pub(super) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Microseconds, to two digits.
fn micros(us: f64) -> String {
    let us = rounded(us);
    if us >= 10.0 { format!("{us:.0}") } else { format!("{us:.1}") }
}

pub(super) fn times(ratio: f64) -> String {
    let ratio = rounded(ratio);
    match ratio {
        r if r >= 10.0 => format!("{r:.0}"),
        r if r >= 1.0 => format!("{r:.1}"),
        r => format!("{r}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::method::Name;

    fn row(method: &'static str, level: &str, us: f64, error: f64) -> MethodFigures {
        let level = (method == "cranny").then(|| level.to_owned());
        let name = Name { level, ..Name::of_peer(method) };
        let (mean_us, error) = (Some(us), Some(error));
        let apart = Panel { poses: 700, mean_us, error, ..Panel::default() };
        MethodFigures { apart, ..MethodFigures::none(name, String::new()) }
    }

    fn peer(method: &'static str, us: f64, error: f64, wrong: usize) -> MethodFigures {
        let mut row = row(method, "", us, error);
        row.apart.wrong = wrong;
        row.note = None;
        row
    }

    fn ours() -> Vec<MethodFigures> {
        [("boxes", 1.0, 0.09), ("tree:4", 3.0, 0.005), ("exact", 12.0, 0.0)]
            .map(|(level, us, error)| row("cranny", level, us, error))
            .to_vec()
    }

    #[test]
    fn what_a_tenth_of_the_error_costs_is_a_table_and_a_sentence() {
        let (headings, rows) = ladder(&ours());
        assert_eq!(headings, ["error at most", "bodies are apart: µs", "by", "times as long"]);
        let rows: Vec<String> = rows.iter().map(|row| row.join(" | ")).collect();
        assert_eq!(
            rows,
            [
                "10 % | 1.0 | boxes, cold | ",
                "1 % | 3.0 | tree:4, cold | x 3.0",
                "0.1 % | 12 | exact, cold | x 4.0",
                "0.01 % | 12 | exact, cold | as long",
                "exact | 12 | exact, cold | as long"
            ]
        );
        let [said] = &paragraphs(&ours())[..] else { panic!("one kind") };
        assert_eq!(
            said,
            "Where bodies are apart, an exact answer takes 12 µs on average. One within 10 % of \
             the size of the smaller body takes 1.0 µs, and each tenth of the error 1.0 to 4.0 \
             times as long."
        );
        let all = [row("cranny", "exact", 1.0, 0.0), row("cranny", "boxes", 3.0, 0.5)];
        assert!(paragraphs(&all)[0].ends_with("comes within 10 % for less."));
        assert!(paragraphs(&[]).is_empty());
        assert_eq!(ladder(&[]).0, ["error at most"]);
    }

    /// A budget may have sufficed at all poses: it is quick there, and promises nothing.
    #[test]
    fn exact_is_what_promises_to_be() {
        let mut lucky = row("cranny", "exact", 2.0, 0.0);
        lucky.name.budget = Some(100);
        let all = [ours(), vec![lucky]].concat();
        assert!(paragraphs(&all)[0].contains("an exact answer takes 12 µs"));
        assert_eq!(ladder(&all).1[4][1], "12");
    }

    #[test]
    fn a_peer_that_misjudges_is_not_called_exact_alone() {
        let mesh = peer("parry-trimesh", 24.0, 1e-8, 3);
        let said = paragraphs(&[ours(), vec![mesh]].concat()).remove(0);
        let words = "Parry's triangle mesh is 2.0 times slower and nearly exact on average, but \
                     wrong about whether bodies meet at 3 of 700 poses.";
        assert!(said.ends_with(words), "{said}");
    }

    #[test]
    fn pieces_are_the_better_choice_where_they_are_quicker_at_their_error_and_right() {
        let about = |pieces| about_pieces(&[ours(), vec![pieces]].concat(), [None; 2], &[]);
        let said = about(peer(PIECES, 2.0, 0.005, 0)).unwrap();
        assert_eq!(
            said,
            "Convex pieces are the better choice where bodies are apart and 0.5 % is good enough: \
             1.5 times faster."
        );
        let said = about(peer(PIECES, 3.0, 1e-8, 2)).unwrap();
        assert!(said.ends_with("choice where bodies are apart: 4.0 times faster."), "{said}");
        let said = about(peer(PIECES, 2.0, 0.1, 0)).unwrap();
        assert!(
            said.ends_with("choice where bodies are apart: ours is as good in 1.0 µs."),
            "{said}"
        );
        let said = about(peer(PIECES, 1.0, 0.005, 8)).unwrap();
        assert!(said.ends_with("wrong about whether bodies meet at 8 of 700 poses."), "{said}");
        assert_eq!(about_pieces(&ours(), [None; 2], &[]), None);
        let coarse = [ours(), vec![peer(PIECES, 2.0, 0.005, 0)]].concat();
        let said = about_pieces(&coarse, [Some(0.001), None], &[]).unwrap();
        assert_eq!(
            said,
            "Convex pieces are not the better choice where bodies are apart: they are off by \
             0.5 %, and half of the gaps are no more than 0.1 %."
        );
    }
}
