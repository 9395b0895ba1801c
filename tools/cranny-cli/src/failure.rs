//! How a command fails: the message, and the exit code.

use std::fmt::{self, Display, Formatter};
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use miette::{Diagnostic, GraphicalReportHandler, Report};

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.report)
    }
}

/// The message with a full stop, where it ends without one.
fn sentence(message: String) -> String {
    let ends = |c: char| c.is_alphanumeric() || matches!(c, ')' | ']' | '}' | '"' | '\'' | '`');
    if message.ends_with(ends) { message + "." } else { message }
}

/// A command's failure. One paragraph that names what is wrong, where, and what to do.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: Kind,
    report: Report,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Arguments or input are wrong.
    Input,
    /// Input/output or the work itself failed.
    Run,
    /// Whoever read our output has gone: no failure of ours, and nobody to report it to.
    ReaderGone,
}

impl Failure {
    /// Exit code of wrong arguments and input.
    pub(crate) const INPUT: u8 = 2;
    /// Exit code of failed input/output and failed work.
    pub(crate) const RUN: u8 = 1;

    /// Wrong arguments or input.
    pub(crate) fn input(message: impl Display) -> Self {
        Self { kind: Kind::Input, report: Report::msg(message.to_string()) }
    }

    /// Wrong input that knows its place in a file.
    pub(crate) fn input_at(diagnostic: impl Diagnostic + Send + Sync + 'static) -> Self {
        Self { kind: Kind::Input, report: Report::new(diagnostic) }
    }

    /// Input/output or work that failed.
    pub(crate) fn run(message: impl Display) -> Self {
        Self { kind: Kind::Run, report: Report::msg(message.to_string()) }
    }

    /// A file that could not be read: where it is not there, or is no text, the input is wrong;
    /// otherwise input/output failed.
    pub(crate) fn unreadable(message: impl Display, kind: io::ErrorKind) -> Self {
        match kind {
            io::ErrorKind::NotFound | io::ErrorKind::IsADirectory | io::ErrorKind::InvalidData => {
                Self::input(message)
            }
            _ => Self::run(message),
        }
    }

    /// Standard output that could not be written.
    pub(crate) fn of_stdout(error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self { kind: Kind::ReaderGone, report: Report::msg("the reader has gone") }
        } else {
            Self::run(format!(
                "standard output cannot be written ({error}). Lines already printed are whole; free the device or choose another."
            ))
        }
    }

    /// Writes it to standard error; on a terminal with the place in the file as well.
    pub(crate) fn report(&self) -> ExitCode {
        let code = match self.kind {
            Kind::ReaderGone => return ExitCode::SUCCESS,
            Kind::Input => Self::INPUT,
            Kind::Run => Self::RUN,
        };
        let mut stderr = io::stderr().lock();
        let mut shown = String::new();
        let drawn = stderr.is_terminal()
            && self.report.source_code().is_some()
            && GraphicalReportHandler::new()
                .render_report(&mut shown, self.report.as_ref())
                .is_ok();
        // Where standard error itself fails, the exit code is all that can be reported.
        let _ = if drawn {
            write!(stderr, "{shown}")
        } else {
            writeln!(stderr, "error: {}", sentence(self.report.to_string()))
        };
        ExitCode::from(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_ends_with_one_full_stop() {
        for (message, ends) in [
            ("no faces. Export them", "them."),
            ("Write `1`", "`1`."),
            ("Choose another.", "another."),
            ("Set all of it: pairs=…", "pairs=…"),
        ] {
            assert!(sentence(message.to_owned()).ends_with(ends), "{message}");
        }
    }
}
