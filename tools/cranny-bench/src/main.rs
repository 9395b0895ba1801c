//! `cranny-bench`: what Cranny costs, beside what its peers cost.
//!
//! Every figure of a peer comes from the same run as ours, on the same input, the two taking turns;
//! ratios carry over to other machines, absolute times do not. Times are of the thread's own CPU
//! clock, so that a busy machine disturbs them little. Each command is a module of its name.
//!
//! ```text
//! cargo run --release -p cranny-bench -- hulls --quick
//! ```

mod broad;
mod cloud;
mod count;
mod deform;
mod effects;
mod entangled;
mod export;
mod hulls;
mod pairs;
mod prepare;
mod python;
mod report;
mod robots;
mod scenes;
mod solid;
mod stopwatch;
mod support;
mod trees;
mod turns;
mod walk;

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};

use report::Report;

/// Measures Cranny against its peers.
#[derive(Debug, Parser)]
#[command(name = "cranny-bench", version, arg_required_else_help = true)]
struct Cli {
    /// What to measure.
    #[command(subcommand)]
    command: Command,

    /// How results are printed
    #[arg(long, global = true, value_enum, default_value = "text")]
    format: Format,

    /// Smaller inputs and fewer runs: seconds instead of minutes
    #[arg(long, global = true)]
    quick: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Convex hulls of point clouds, against parry's `convex_hull`
    Hulls {
        /// Only clouds whose name contains this
        #[arg(long, value_name = "PART", default_value = "")]
        only: String,
    },
    /// Support queries on hulls, warm, against a scan of all vertices
    Support,
    /// Closest features of hull pairs in motion, against parry's GJK
    Walk,
    /// Boxes and envelopes, the two ways to the faces that meet, on bodies in each other's pockets
    Methods,
    /// Sorting boxes level by level, beside the kept front and a descent from the top
    Sorting,
    /// Pairs whose hulls overlap, warm and cold, against parry's meshes and decompositions and Coal
    Entangled(entangled::EntangledArgs),
    /// Links of robots against each other, as `cranny robot` checks them, beside FCL and Coal
    Robots(robots::RobotsArgs),
    /// Whole scenes under our detector and under rapier's own, by `cranny compare`
    Scenes(scenes::ScenesArgs),
    /// Overlapping boxes in motion, against parry's `Bvh`
    Broad {
        /// Only scenes whose name contains this
        #[arg(long, value_name = "PART", default_value = "")]
        only: String,
    },
    /// Does fixed pieces of work, for a counter of instructions; without a name, lists them
    Count {
        /// Which, in this order: deformations begin at what those before them have left
        #[arg(value_name = "NAME")]
        names: Vec<String>,
    },
    /// Writes pairs in motion as files, for `cranny accuracy`
    Export {
        /// Folder for the files; made if it is not there
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Whole preparation of meshes, against parry's convex decomposition and hull; stages; growth
    Prepare,
    /// Moved vertices and all that follows them, against building the moved mesh
    Deform,
    /// What each effect costs in a scene of 500 bodies, beside the solver: the table of
    /// docs/effects.md
    Effects(effects::EffectsArgs),
    /// Kinds of box trees by what they open; patches; envelopes beside a box tree
    Trees,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: aligned columns.
    Text,
    /// For programs: one JSON value.
    Json,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let report = match &cli.command {
        Command::Hulls { only } => Ok(hulls::measure(cli.quick, only)),
        Command::Support => Ok(support::measure(cli.quick)),
        Command::Walk => Ok(walk::measure(cli.quick)),
        Command::Sorting => Ok(pairs::sorting::measure(cli.quick)),
        Command::Methods => Ok(pairs::methods::measure(cli.quick)),
        Command::Entangled(args) => return exit(compare_entangled(&cli, args)),
        Command::Robots(args) => robots::measure(cli.quick, args),
        Command::Scenes(args) => scenes::measure(cli.quick, args),
        Command::Broad { only } => Ok(broad::measure(cli.quick, only)),
        Command::Count { names } => return exit(count::count(names)),
        Command::Export { folder } => export::write(folder, cli.quick),
        Command::Prepare => Ok(prepare::measure(cli.quick)),
        Command::Deform => Ok(deform::measure(cli.quick)),
        Command::Effects(args) => return exit(effects::tabulate(args)),
        Command::Trees => Ok(trees::measure(cli.quick)),
    };
    exit(report.and_then(|report| print(&report, cli.format)))
}

fn exit(outcome: io::Result<()>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            // Where standard error fails as well, the exit code is all that can be reported.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the name of the next case if standard error is a terminal.
fn progress(name: &str) {
    let mut err = io::stderr();
    if err.is_terminal() {
        // A missing name makes no figure worse.
        let _ = writeln!(err, "{name} ...");
    }
}

/// Prints the report, then fails if answers differ.
fn compare_entangled(cli: &Cli, args: &entangled::EntangledArgs) -> io::Result<()> {
    let outcomes = entangled::measure(cli.quick, args)?;
    print(&outcomes.report, cli.format)?;
    if outcomes.differences.is_empty() {
        return Ok(());
    }
    Err(io::Error::other(format!("answers differ:\n  {}", outcomes.differences.join("\n  "))))
}

fn print(report: &Report, format: Format) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match format {
        Format::Text => write!(out, "{report}"),
        Format::Json => writeln!(out, "{}", report.to_json()),
    }
}
