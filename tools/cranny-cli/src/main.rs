//! The `cranny` command: results on standard output; logs, progress and errors on standard error.
//!
//! Exit codes: 0 all went well, 1 input/output or the work itself failed, 2 the arguments or the
//! input are wrong. `args` has the arguments; each command is a module of its name.

mod accuracy;
mod args;
mod certificate_line;
mod chart;
mod check;
mod compare;
mod csv;
mod explain;
mod failure;
mod inspect;
mod logging;
mod model_file;
mod output;
mod overlaps;
mod page;
mod parry;
mod paths;
mod picture;
mod png;
mod pose_file;
mod progress;
mod query;
mod quiet_driver;
mod recover;
mod replay;
mod report;
mod rerun;
mod robot;
mod run;
mod scene_file;
mod signals;
mod simulation;
mod stability;
mod verify;
mod words;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};

fn main() -> ExitCode {
    let cli = Cli::parse();
    quiet_driver::restart_without_noise(&cli.command);
    logging::start(cli.verbose, cli.quiet);
    progress::start(cli.quiet);
    signals::report_size_limits();
    let outcome = match &cli.command {
        Command::Run(args) => run::run(args, cli.format),
        Command::Replay(args) => replay::replay(args, cli.format),
        Command::Recover(args) => recover::recover(args, cli.format),
        Command::Report(args) => report::report(args, cli.format),
        Command::Explain(args) => explain::explain(args, cli.format),
        Command::Query(args) => query::query(args, cli.format),
        Command::Verify(args) => verify::verify(args, cli.format),
        Command::Compare(args) => compare::compare(args, cli.format),
        Command::Accuracy(args) => accuracy::accuracy(args, cli.format),
        Command::Stability(args) => stability::stability(args, cli.format),
        Command::Inspect(args) => inspect::inspect(args, cli.format),
        Command::Robot(args) => robot::robot(args, cli.format),
        Command::Check(args) => check::check(args, cli.format),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
