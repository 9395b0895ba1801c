//! What a check says when it fails.

use std::fmt;

/// One broken rule at one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Violation {
    /// A path, relative to the workspace, with `:line` where there is one.
    pub(crate) place: String,
    /// The rule in short, as one would search for it.
    pub(crate) rule: &'static str,
    /// What was found.
    pub(crate) found: String,
    /// Why the rule is there, and what to do instead.
    pub(crate) reason: &'static str,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: [{}] {}", self.place, self.rule, self.found)?;
        write!(f, "    {}", self.reason)
    }
}
