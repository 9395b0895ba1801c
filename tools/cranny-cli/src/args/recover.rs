//! Arguments of `cranny recover`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `cranny recover`.
#[derive(Debug, Args)]
#[command(after_help = RECOVER_NOTES)]
pub(crate) struct RecoverArgs {
    /// What a killed run left, or a damaged recording
    #[arg(value_name = "REC.mcap.partial")]
    pub(crate) recording: PathBuf,

    /// The whole recording [default: the name without .partial]
    #[arg(long, value_name = "REC.mcap")]
    pub(crate) out: Option<PathBuf>,
}

const RECOVER_NOTES: &str = "\
All whole frames are written, and what belongs to them: bodies, events, pictures, the log, attachments. Chunks
that do not match their sums are left out. The file that is read stays as it is, and nothing is overwritten
unless --out names it.

A run that records writes out what it has after a second of work, or 32 frames: a kill loses no more.

Examples:
  cranny recover run.mcap.partial
  cranny recover damaged.mcap --out mended.mcap && cranny replay mended.mcap";
