//! A family of hard cases: what it is, in words, and how it is run.

use crate::case::{Case, Outcome};
use crate::peer::Peer;
use crate::trial::{Trial, caught};

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Cases that are made at random depend on it, and on nothing else.
    pub seed: u64,
    /// How often each sort of case is made anew; the work is in proportion.
    pub variants: u32,
}

impl Settings {
    /// What is run by default: some seconds in all.
    pub const DEFAULT: Self = Self { seed: 1, variants: 4 };
}

/// A family of hard cases.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// A word, as on the command line.
    pub name: &'static str,
    /// The question.
    pub question: &'static str,
    /// How cases are made, and how their truth is known.
    pub made: &'static str,
    /// What counts as a failure.
    pub fails: &'static str,
    /// What [`Case::figure`](crate::Case::figure) measures; the larger, the worse.
    pub figure: &'static str,
    pub(crate) cases: fn(&mut Trial<'_>),
}

impl Family {
    /// Makes and judges all cases. Families do not share random numbers: one gives the same cases
    /// alone. A panic is a case that failed.
    #[must_use]
    pub fn run(&self, settings: &Settings, peer: Option<&mut dyn Peer>) -> Outcome {
        let mut trial = Trial::new(self.name, settings, peer);
        if let Err(fault) = caught(|| (self.cases)(&mut trial)) {
            let name = "whatever came after the case above".to_owned();
            trial.push(Case { name, faults: vec![fault], ..Case::default() });
        }
        trial.finish()
    }
}
