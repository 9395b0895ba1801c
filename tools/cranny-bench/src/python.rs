//! Peers with a Python package: a process of their own, a line of JSON each way.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::Value;

/// Names the interpreter that has the packages; `python3` unless set.
const PYTHON: &str = "CRANNY_PYTHON";

/// A process that answers each line with a line.
pub(crate) struct Python {
    child: Child,
    /// Dropped first, which ends the process.
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Python {
    /// Returns whether the interpreter imports a module.
    pub(crate) fn has(module: &str) -> bool {
        let mut command = Command::new(interpreter());
        let import = format!("import numpy, {module}");
        command.args(["-c", &import]).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    }

    /// Starts a script and sends its first line, which is not answered.
    ///
    /// # Errors
    ///
    /// An interpreter that does not start.
    pub(crate) fn start(script: &str, first: &Value) -> io::Result<Self> {
        let mut child = Command::new(interpreter())
            .args(["-c", script])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let input = child.stdin.take();
        let output = child.stdout.take().ok_or(io::ErrorKind::BrokenPipe)?;
        let mut python = Self { child, input, output: BufReader::new(output) };
        python.send(first)?;
        Ok(python)
    }

    /// Sends a line and returns the answer.
    ///
    /// # Errors
    ///
    /// A process that has ended, or an answer that is not JSON.
    pub(crate) fn ask(&mut self, line: &Value) -> io::Result<Value> {
        self.send(line)?;
        let mut answer = String::new();
        self.output.read_line(&mut answer)?;
        serde_json::from_str(&answer).map_err(io::Error::other)
    }

    fn send(&mut self, line: &Value) -> io::Result<()> {
        let input = self.input.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
        writeln!(input, "{line}")?;
        input.flush()
    }
}

impl Drop for Python {
    fn drop(&mut self) {
        drop(self.input.take());
        // A process that cannot be waited for leaves nothing to do.
        let _ = self.child.wait();
    }
}

fn interpreter() -> OsString {
    std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into())
}
