//! Writes a recording to look at: `cargo run -p cranny-record --example record_pendulum OUT.mcap`.

#[path = "../tests/pendulum/mod.rs"]
mod pendulum;

use std::path::PathBuf;
use std::process::ExitCode;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to a person")]
fn main() -> ExitCode {
    let path = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "pendulum.mcap".to_owned()));
    match pendulum::record(&path, 240).and_then(|(recorder, _)| recorder.finish()) {
        Ok(summary) => {
            println!("{}: {} bytes, {:#?}", path.display(), summary.bytes, summary.messages);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
