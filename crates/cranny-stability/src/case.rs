//! A case: the question, the answer, pass or fail; and the sum of all.

use std::collections::BTreeMap;
use std::time::Duration;

/// One case.
#[derive(Clone, Debug, Default)]
pub struct Case {
    /// The question.
    pub name: String,
    /// What is so.
    pub truth: String,
    /// The answer.
    pub answer: String,
    /// What is wrong with it; nothing: passed.
    pub faults: Vec<String>,
    /// What the family calls its figure.
    pub figure: Option<f64>,
    /// The error as a share of what was claimed of it; above 1 it is a fault.
    pub of_claim: Option<f64>,
    /// The peer's answer.
    pub peer: Option<PeerCase>,
}

/// The peer's answer to a case.
#[derive(Clone, Debug)]
pub struct PeerCase {
    /// In words.
    pub answer: String,
    /// Not so. Where bodies only touch, either answer is right.
    pub wrong: bool,
    /// No answer at all.
    pub refused: bool,
    /// What the family calls its figure.
    pub figure: Option<f64>,
}

/// A family's cases.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its name.
    pub family: &'static str,
    /// Every case, in order.
    pub cases: Vec<Case>,
    /// What was counted beside them: how many touch, how often a fallback was needed.
    pub counts: BTreeMap<&'static str, u64>,
    /// How long it took, judges included; set by whoever has a clock.
    pub time: Duration,
}

impl Outcome {
    /// Cases with a fault.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.cases.iter().filter(|case| !case.faults.is_empty()).count()
    }

    /// The case of the largest figure.
    #[must_use]
    pub fn worst(&self) -> Option<(&Case, f64)> {
        let figures = self.cases.iter().filter_map(|case| Some((case, case.figure?)));
        figures.reduce(|worst, next| if next.1 > worst.1 { next } else { worst })
    }

    /// The case whose error took most of what was claimed.
    #[must_use]
    pub fn worst_of_claim(&self) -> Option<f64> {
        self.cases.iter().filter_map(|case| case.of_claim).reduce(f64::max)
    }

    /// Cases that the peer answered.
    pub fn peer_cases(&self) -> impl Iterator<Item = (&Case, &PeerCase)> {
        self.cases.iter().filter_map(|case| Some((case, case.peer.as_ref()?)))
    }

    /// The peer's largest figure.
    #[must_use]
    pub fn peer_worst(&self) -> Option<f64> {
        self.peer_cases().filter_map(|(_, peer)| peer.figure).reduce(f64::max)
    }
}
