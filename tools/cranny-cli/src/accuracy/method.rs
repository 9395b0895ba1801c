//! A method that answers about pairs, and its answers.

use cranny_exact::{DVec3, Interval};
use serde::Serialize;

use super::motion::Posed;
use crate::csv::cell;

/// Something that answers about pairs.
pub(super) trait Method {
    fn name(&self) -> Name;

    /// Whether it is notified when a motion begins only, and keeps what it likes from then on.
    fn is_warm(&self) -> bool {
        false
    }

    /// Forgets what it knows of earlier poses.
    fn begin(&mut self, _posed: Posed) {}

    /// Whether the bodies meet, and how far they are apart.
    fn distance(&mut self, posed: Posed) -> PoseAnswer;

    /// Where the bodies are in contact, and how deep.
    fn contacts(&mut self, posed: Posed) -> ContactAnswer;
}

/// What a method answers about bodies that overlap.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactAnswer {
    /// Whether the bodies share a point; `None`: it does not say.
    pub(super) meets: Option<bool>,
    /// Where contact is, or may be.
    pub(super) points: Vec<DVec3>,
    /// Holds the depth of the deepest; a point where the method gives no bounds.
    pub(super) depth: Option<Interval>,
}

/// What a method answered at one pose.
#[derive(Clone, Debug, Default)]
pub(super) struct PoseAnswer {
    /// Whether the bodies share a point; `None`: it does not say.
    pub(super) meets: Option<bool>,
    /// Its distance, or the upper end of where that lies.
    pub(super) distance: Option<f64>,
    /// What certainly holds the distance, where a method gives bounds.
    pub(super) held: Option<Interval>,
    pub(super) witnesses: Option<[DVec3; 2]>,
    pub(super) tests: Option<u64>,
}

/// The method, how much it may spend, and what it remembers: the first columns of every table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Name {
    pub(super) method: &'static str,
    pub(super) level: Option<String>,
    /// Elementary tests a pose.
    pub(super) budget: Option<u64>,
    /// Microseconds a pose.
    pub(super) deadline_us: Option<u64>,
    pub(super) memory: &'static str,
}

impl Name {
    /// Something that is not ours, and keeps nothing from pose to pose.
    pub(super) fn of_peer(method: &'static str) -> Self {
        Self { method, level: None, budget: None, deadline_us: None, memory: "cold" }
    }

    pub(super) fn is_ours(&self) -> bool {
        self.level.is_some()
    }

    pub(super) fn is_warm(&self) -> bool {
        self.memory == "warm"
    }

    /// A level of ours, by itself.
    pub(super) fn is_level(&self) -> bool {
        self.is_ours() && self.budget.is_none() && self.deadline_us.is_none()
    }

    /// The exact answer, however long it takes.
    pub(super) fn is_exact(&self) -> bool {
        self.is_level() && self.level.as_deref() == Some("exact")
    }

    /// Names of the cells of [`csv`](Self::csv).
    pub(super) const COLUMNS: &'static str = "method,level,budget,deadline_us,memory";

    pub(super) fn csv(&self) -> String {
        let Self { method, level, budget, deadline_us, memory } = self;
        let [level, budget, deadline] = [cell(level.as_ref()), cell(*budget), cell(*deadline_us)];
        format!("{method},{level},{budget},{deadline},{memory}")
    }

    /// What it is, in a word.
    pub(super) fn label(&self) -> String {
        match (&self.level, self.budget, self.deadline_us) {
            (_, Some(budget), _) => format!("{budget} tests"),
            (_, _, Some(deadline)) => format!("{deadline} µs"),
            (Some(level), None, None) => level.clone(),
            (None, None, None) => self.method.to_owned(),
        }
    }
}
