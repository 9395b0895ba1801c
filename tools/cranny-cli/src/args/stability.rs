//! Arguments of `cranny stability`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use cranny_stability::{FAMILIES, Settings};

use super::scene::seed;

/// Arguments of `cranny stability`.
#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub(crate) struct StabilityArgs {
    /// Folder for stability.md, stability.svg, stability.csv and cases.csv; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Run this family only; several may be named, with commas or by naming the option again
    #[arg(long = "family", value_name = "NAME", value_delimiter = ',', value_parser = PossibleValuesParser::new(FAMILIES.map(|f| f.name)))]
    pub(crate) families: Vec<String>,

    /// Make each sort of case anew this often; time is in proportion
    #[arg(long, value_name = "N", default_value_t = Settings::DEFAULT.variants, value_parser = variants, allow_hyphen_values = true)]
    pub(crate) variants: u32,

    /// What cases that are made at random depend on: the same seed, the same cases, everywhere
    #[arg(long, value_name = "N", default_value_t = Settings::DEFAULT.seed, value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: u64,

    /// Leave parry out
    #[arg(long)]
    pub(crate) no_peers: bool,

    /// Say what the families are, and run none
    #[arg(long, conflicts_with_all = ["out", "families"])]
    pub(crate) list: bool,
}

/// How often each sort of case is made anew.
fn variants(text: &str) -> Result<u32, String> {
    let wrong = || format!("a number of variants is a whole one from 1 to {}", u32::MAX);
    text.parse().ok().filter(|&count| count > 0).ok_or_else(wrong)
}

const NOTES: &str = "\
Bodies that touch, miss each other by a hair or are nearly parallel, needles, tiny and huge ones: the truth of
a case is known by how it was made or from exact rationals; --list says how each family is judged. Any wrong verdict, any length outside what is
claimed of it, any difference that memory, order or exchanging A and B makes fails the run: exit code 1.
parry's triangle meshes (for hulls, its convex polyhedra) get the same in single precision, as they
come; what they get wrong fails nobody. Where bodies only touch, either of its answers counts as right.

Columns, also of stability.csv (the larger a figure, the worse; --list says what it is; empty: none):
  family, cases, failed   cases that were made, and those with any fault
  worst                   the largest figure, of all cases; lengths are in sizes of the larger body
  of_claim                the largest error of a distance or depth, as a share of what its interval allows
  peer_cases, peer_wrong  given to parry; apart by its answer but they overlap, or the other way round
  peer_refused            it gave no answer, or panicked; peer_worst: its largest figure
  seconds                 judges and parry included
cases.csv has every case: the question, what is so, the answer, what is wrong with it, parry's answer.

Examples:
  cranny stability
  cranny stability --out report --variants 20
  cranny stability --family contacts,needles --seed 7 --format json";
