//! Chores of the repository.
//!
//! `cargo run -p xtask -- check-deps` checks what the compiler does not: which crate may depend on
//! which, that the crates which compute do nothing but compute, that a type name means one thing in
//! a crate, and that a crate keeps its bound in lines. `lines` counts the lines of code of each
//! crate. `check-docs` checks that links of Markdown files resolve, and that pages and comments
//! keep their bounds. `instructions` counts the instructions of fixed pieces of work, and compares
//! them with those on file.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command speaks to a terminal")]

mod bans;
mod comments;
mod directions;
mod documents;
mod instructions;
mod literals;
mod names;
mod report;
mod sizes;
mod sources;
mod strip;
mod tokens;

use report::Violation;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str =
    "usage: cargo run -p xtask -- check-deps | check-docs | lines | instructions [--update]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["check-deps"] => run_check_deps(),
        ["check-docs"] => run_check_docs(),
        ["lines"] => run_lines(),
        ["instructions"] => run_instructions(false),
        ["instructions", "--update"] => run_instructions(true),
        _ => {
            eprintln!("{USAGE}");
            ExitCode::from(2)
        }
    }
}

fn run_instructions(update: bool) -> ExitCode {
    match root().and_then(|root| instructions::run(&root, update)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("instructions: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Prints the lines of code of each crate, and of those together that compute.
fn run_lines() -> ExitCode {
    match crate_lines() {
        Ok(crates) => {
            let computing = crates.iter().filter(|(name, _)| directions::computes(name));
            let together: usize = computing.map(|(_, lines)| lines).sum();
            crates.iter().for_each(|(name, lines)| println!("{lines:6} {name}"));
            println!("{together:6} of crates that compute, together");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("lines: {message}");
            ExitCode::FAILURE
        }
    }
}

fn crate_lines() -> Result<Vec<(String, usize)>, String> {
    let graph = directions::Graph::from_metadata(&cargo_metadata()?)?;
    let of_crate = |package: &directions::Package| {
        let files = sources::of_crate(Path::new(&package.folder))?;
        Ok((package.name.clone(), sizes::lines(&files)))
    };
    graph.members().map(of_crate).collect()
}

fn run_check_deps() -> ExitCode {
    report_result("check-deps", "crate directions hold, source files are clean", check_deps())
}

fn run_check_docs() -> ExitCode {
    let checked = root().and_then(|root| documents::check(&root));
    report_result("check-docs", "links resolve, pages and comments keep their bounds", checked)
}

/// Prints what a check found in so many files.
fn report_result(
    name: &str,
    good: &str,
    checked: Result<(usize, Vec<Violation>), String>,
) -> ExitCode {
    match checked {
        Ok((files, violations)) if violations.is_empty() => {
            println!("{name}: {good} ({files} files)");
            ExitCode::SUCCESS
        }
        Ok((_, violations)) => {
            for violation in &violations {
                println!("{violation}");
            }
            println!("{name}: {} violations", violations.len());
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("{name}: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the workspace.
fn root() -> Result<PathBuf, String> {
    let graph = directions::Graph::from_metadata(&cargo_metadata()?)?;
    Ok(PathBuf::from(graph.workspace_root()))
}

/// Returns the number of source files read, and everything that is wrong.
fn check_deps() -> Result<(usize, Vec<Violation>), String> {
    let metadata = cargo_metadata()?;
    let graph = directions::Graph::from_metadata(&metadata)?;
    let mut violations = graph.check();
    let root = Path::new(graph.workspace_root());
    let mut files = 0;
    for package in graph.members() {
        let mut type_names = names::TypeNames::new();
        let is_pure = directions::computes(&package.name);
        let sources = sources::of_crate(Path::new(&package.folder))?;
        let folder = Path::new(&package.folder);
        let shown = folder.strip_prefix(root).unwrap_or(folder).display().to_string();
        violations.extend(sizes::check(&package.name, &shown, sizes::lines(&sources)));
        for file in sources {
            files += 1;
            let shown = file.path.strip_prefix(root).unwrap_or(&file.path).display().to_string();
            let tokens = tokens::of(&file.stripped.text);
            if is_pure {
                violations.extend(bans::check(&shown, &tokens));
            }
            if !matches!(package.name.as_str(), "cranny-exact" | "xtask") {
                violations.extend(literals::check(&shown, &tokens));
            }
            type_names.add(&shown, &tokens);
        }
        violations.extend(type_names.check());
    }
    Ok((files, violations))
}

fn cargo_metadata() -> Result<serde_json::Value, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["metadata", "--format-version", "1"]);
    // Set by `cargo run`; without it the current folder decides.
    if let Ok(folder) = std::env::var("CARGO_MANIFEST_DIR") {
        command.arg("--manifest-path").arg(PathBuf::from(folder).join("Cargo.toml"));
    }
    let output = command.output().map_err(|e| format!("cannot run cargo metadata: {e}"))?;
    if !output.status.success() {
        let why = String::from_utf8_lossy(&output.stderr);
        return Err(format!("cargo metadata failed: {}", why.trim()));
    }
    serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))
}
