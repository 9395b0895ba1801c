//! Progress on standard error, for whoever waits at a terminal.

use std::borrow::Cow;
use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// How often a spinner turns.
const TICK: Duration = Duration::from_millis(100);

/// Work of unknown length; nothing is shown where standard error is no terminal.
pub(crate) fn spinner(message: impl Into<Cow<'static, str>>) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(message);
    bar.enable_steady_tick(TICK);
    bar
}

/// Work of `count` pieces that print a line each; nothing is shown where standard error is no
/// terminal, nor where standard output is one: its lines show the progress.
pub(crate) fn bar(count: u64, message: impl Into<Cow<'static, str>>) -> ProgressBar {
    if std::io::stdout().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count).with_message(message);
    match ProgressStyle::with_template("{msg} [{bar:30}] {pos}/{len} ({eta} left)") {
        Ok(style) => bar.with_style(style.progress_chars("=> ")),
        Err(_) => bar,
    }
}
