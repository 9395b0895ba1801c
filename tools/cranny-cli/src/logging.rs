//! Logs on standard error: warnings, and more where an option or the environment says so.

use std::io::{self, IsTerminal};

use tracing_subscriber::EnvFilter;

/// Starts logging. `RUST_LOG` decides where it is set; else `verbose` (0: warnings; 1: notes; 2:
/// details; more: everything). `quiet` keeps warnings back. Colours are for terminals, unless
/// `NO_COLOR` is set.
pub(crate) fn start(verbose: u8, quiet: bool) {
    let level = match verbose {
        _ if quiet => "off",
        0 => "warn",
        1 => "warn,cranny=info",
        2 => "info,cranny=debug",
        _ => "trace",
    };
    let wanted = std::env::var(EnvFilter::DEFAULT_ENV).ok().filter(|filter| !filter.is_empty());
    let no_color = std::env::var_os("NO_COLOR").is_some_and(|set| !set.is_empty());
    let filter = EnvFilter::new(wanted.as_deref().unwrap_or(level));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal() && !no_color)
        .without_time()
        .with_target(false)
        .init();
}
