//! `cranny stability`: the hard cases, their questions and answers, pass or fail.
//!
//! `cranny_stability` has the families and the judges; here they are run and reported: `rows` for a
//! line a family and the files of numbers, `page` for the page, `chart` for its drawing. `peer`
//! queries parry in the same cases.

mod chart;
mod page;
mod peer;
mod rows;

use std::time::Instant;

use cranny_stability::{FAMILIES, Family, Outcome, Peer, Settings};

use crate::args::{Format, StabilityArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{make_folder, write};
use crate::progress;
use peer::Parry;
use rows::Row;

/// How many failed cases of a family are printed on standard output; files have them all.
const MOST_PRINTED: usize = 5;

/// Runs the command.
///
/// # Errors
///
/// Any case that failed; files or standard output that cannot be written.
pub(crate) fn stability(args: &StabilityArgs, format: Option<Format>) -> Result<(), Failure> {
    let format = format.unwrap_or(Format::Text);
    let mut output = Output::new();
    if args.list {
        return list(&mut output, format);
    }
    if let Some(folder) = &args.out {
        make_folder(folder)?;
    }
    let chosen: Vec<&Family> = FAMILIES
        .iter()
        .filter(|family| args.families.is_empty() || args.families.iter().any(|f| f == family.name))
        .collect();
    let settings = Settings { seed: args.seed, variants: args.variants };
    let mut parry = (!args.no_peers).then(Parry::default);
    if format == Format::Text {
        output.line(&rows::heading())?;
    }
    let bar = progress::bar(chosen.len() as u64, "judging");
    let mut outcomes = Vec::new();
    for family in chosen {
        let start = Instant::now();
        let peer = parry.as_mut().map(|parry| parry as &mut dyn Peer);
        let mut outcome = family.run(&settings, peer);
        outcome.time = start.elapsed();
        print_outcome(&mut output, format, &outcome)?;
        outcomes.push((family, outcome));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if format == Format::Text {
        output.line(&summary(&outcomes))?;
    }
    if let Some(folder) = &args.out {
        write(&folder.join("stability.csv"), &rows::csv(&outcomes))?;
        write(&folder.join("cases.csv"), &rows::cases_csv(&outcomes))?;
        let chart = chart::drawn(&outcomes)?;
        write(&folder.join("stability.svg"), &chart)?;
        write(&folder.join("stability.md"), &page::page(&outcomes, &settings))?;
    }
    verdict(&outcomes)
}

/// A family and what came out of it.
type FamilyOutcome = (&'static Family, Outcome);

fn list(output: &mut Output, format: Format) -> Result<(), Failure> {
    for family in &FAMILIES {
        match format {
            Format::Json => output.json(&rows::Listed::of(family))?,
            Format::Text => output.line(&rows::Listed::of(family).text())?,
        }
    }
    Ok(())
}

fn print_outcome(output: &mut Output, format: Format, outcome: &Outcome) -> Result<(), Failure> {
    let row = Row::of(outcome);
    match format {
        Format::Json => output.json(&row),
        Format::Text => {
            output.line(&row.text())?;
            let failed = outcome.cases.iter().filter(|case| !case.faults.is_empty());
            for case in failed.take(MOST_PRINTED) {
                output.line(&format!("  failed: {}: {}", case.name, case.faults.join("; ")))?;
            }
            Ok(())
        }
    }
}

/// In one sentence, time included.
fn summary(outcomes: &[FamilyOutcome]) -> String {
    let cases: usize = outcomes.iter().map(|(_, outcome)| outcome.cases.len()).sum();
    let failed: usize = outcomes.iter().map(|(_, outcome)| outcome.failed()).sum();
    let seconds: f64 = outcomes.iter().map(|(_, outcome)| outcome.time.as_secs_f64()).sum();
    let result = match failed {
        0 => "none failed".to_owned(),
        _ => format!("{failed} FAILED"),
    };
    format!("{cases} cases in {seconds:.1} s: {result}")
}

fn verdict(outcomes: &[FamilyOutcome]) -> Result<(), Failure> {
    let failed: Vec<&str> = outcomes
        .iter()
        .filter(|(_, outcome)| outcome.failed() > 0)
        .map(|(family, _)| family.name)
        .collect();
    match failed.is_empty() {
        true => Ok(()),
        false => Err(Failure::run(format!(
            "{} ({}). This is a fault of Cranny's: please report it, with the seed.",
            summary(outcomes),
            failed.join(", ")
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_stability::Case;

    fn outcome_with(faults: &[&str]) -> FamilyOutcome {
        let faults = faults.iter().map(|&fault| fault.to_owned()).collect();
        let case = Case { name: "a case".to_owned(), faults, ..Case::default() };
        let outcome = Outcome {
            family: FAMILIES[0].name,
            cases: vec![case],
            counts: Default::default(),
            time: Default::default(),
        };
        (&FAMILIES[0], outcome)
    }

    #[test]
    fn one_fault_fails_the_run_and_stands_on_the_page() {
        let (good, bad) = (outcome_with(&[]), outcome_with(&["says: touch"]));
        assert!(verdict(std::slice::from_ref(&good)).is_ok());
        let failure = verdict(&[good.clone(), bad.clone()]).unwrap_err();
        assert!(format!("{failure:?}").contains("2 cases in 0.0 s: 1 FAILED (contacts)"));
        let page = page::page(&[good, bad], &Settings::DEFAULT);
        assert!(page.contains("**1**") && page.contains("says: touch"), "{page}");
    }
}
