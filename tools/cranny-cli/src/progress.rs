//! Progress on standard error, for whoever waits at a terminal.

use std::borrow::Cow;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How often a spinner turns.
const TICK: Duration = Duration::from_millis(100);

/// How often the progress of a run is drawn, at most.
const REDRAWS_PER_SECOND: u8 = 5;

/// Whether `--quiet` was said: the command's own setting, made once at its start.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Notes whether progress is to be shown.
pub(crate) fn start(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// The steps of a run.
pub(crate) struct RunProgress {
    bar: ProgressBar,
    /// Seconds a step.
    dt: f64,
}

impl RunProgress {
    /// Of so many steps; nothing is shown where standard error is no terminal.
    pub(crate) fn new(steps: u64, dt: f64) -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(REDRAWS_PER_SECOND);
        let bar = match is_quiet() {
            true => ProgressBar::hidden(),
            false => ProgressBar::with_draw_target(Some(steps), target),
        };
        let style = "simulating [{bar:30}] step {pos}/{len}, {msg}, {eta} left";
        let bar = match ProgressStyle::with_template(style) {
            Ok(style) => bar.with_style(style.progress_chars("=> ")),
            Err(_) => bar,
        };
        Self { bar, dt }
    }

    /// So many steps are done.
    pub(crate) fn set(&self, steps: u64) {
        if self.bar.is_hidden() {
            return;
        }
        let wall = self.bar.elapsed().as_secs_f64();
        if wall > 0.0 {
            self.bar.set_message(format!("{:.2} x real time", steps as f64 * self.dt / wall));
        }
        self.bar.set_position(steps);
    }

    /// All steps are done; files are completed.
    pub(crate) fn finishing(&self) {
        self.bar.set_message("finishing");
    }

    /// Takes the line away.
    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Work of unknown length; nothing is shown where standard error is no terminal.
pub(crate) fn spinner(message: impl Into<Cow<'static, str>>) -> ProgressBar {
    if is_quiet() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(message);
    bar.enable_steady_tick(TICK);
    bar
}

/// Work of `count` pieces that print a line each; nothing is shown where standard error is no
/// terminal, nor where standard output is one: its lines show the progress.
pub(crate) fn bar(count: u64, message: impl Into<Cow<'static, str>>) -> ProgressBar {
    if is_quiet() || std::io::stdout().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count).with_message(message);
    match ProgressStyle::with_template("{msg} [{bar:30}] {pos}/{len} ({eta} left)") {
        Ok(style) => bar.with_style(style.progress_chars("=> ")),
        Err(_) => bar,
    }
}
