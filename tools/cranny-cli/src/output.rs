//! Results on standard output, a line at a time.

use std::io::{self, BufWriter, StdoutLock, Write};

use serde::Serialize;

use crate::failure::Failure;

/// Standard output. Every line is flushed, so that a reader sees each result when it is there.
pub(crate) struct Output(BufWriter<StdoutLock<'static>>);

impl Output {
    /// Locks standard output.
    pub(crate) fn new() -> Self {
        Self(BufWriter::new(io::stdout().lock()))
    }

    /// Prints a line (or several).
    ///
    /// # Errors
    ///
    /// Where it cannot be written; a reader that has gone ends the command quietly.
    pub(crate) fn line(&mut self, text: &str) -> Result<(), Failure> {
        let write = |out: &mut BufWriter<StdoutLock<'static>>| {
            out.write_all(text.as_bytes())?;
            out.write_all(b"\n")?;
            out.flush()
        };
        write(&mut self.0).map_err(|error| Failure::of_stdout(&error))
    }

    /// Prints a value as one line of JSON.
    ///
    /// # Errors
    ///
    /// As [`line`](Self::line).
    pub(crate) fn json(&mut self, value: &impl Serialize) -> Result<(), Failure> {
        let text = serde_json::to_string(value).map_err(|error| {
            Failure::run(format!("the result cannot be written as JSON: {error}"))
        })?;
        self.line(&text)
    }
}
