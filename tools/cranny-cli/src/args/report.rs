//! Arguments of `cranny report`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `cranny report`.
#[derive(Debug, Args)]
#[command(after_help = REPORT_NOTES)]
pub(crate) struct ReportArgs {
    /// Recording of `cranny run --record`
    #[arg(value_name = "REC.mcap")]
    pub(crate) recording: PathBuf,

    /// The page
    #[arg(long, value_name = "PAGE.html")]
    pub(crate) out: PathBuf,

    /// Pictures in the strip
    #[arg(long, value_name = "N", default_value = "6", value_parser = pictures, allow_hyphen_values = true)]
    pub(crate) pictures: u32,
}

fn pictures(text: &str) -> Result<u32, String> {
    let count = text.parse().ok().filter(|count| (1..=24).contains(count));
    count.ok_or_else(|| "a strip has a whole number of pictures from 1 to 24".to_owned())
}

const REPORT_NOTES: &str = "\
One page that needs nothing beside it: pictures from start to end, contacts, depth, energy and cost over time,
the deepest overlaps cut open, effects, what was skipped, the scene file, and how to do it again.

Example:
  cranny run scene.ron --record run.mcap && cranny report run.mcap --out run.html";
