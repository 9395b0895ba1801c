//! `cranny query`: two meshes at a list of poses, a line each.

mod heat;
mod line;

use std::path::Path;
use std::time::Instant;

use cranny_ecs::check_outputs;
use cranny_estimate::{Accuracy, Budget, Effort, EstimateMemory, estimate};
use cranny_geometry::BuildOptions;
use cranny_narrow_phase::operations::{Pair, common_point};
use cranny_narrow_phase::{Counters, Demand, Method, Placed, Query, Surface};

use crate::args::{DemandArg, Format, MethodArg, QueryArgs};
use crate::certificate_line::{CertifiedLine, Certifier, sealed};
use crate::failure::Failure;
use crate::model_file::load;
use crate::output::Output;
use crate::paths::check_output;
use crate::picture::Trouble;
use crate::pose_file::read_poses;
use crate::progress;
use heat::Searched;
use line::{Line, ShownFields};

/// Runs the command.
///
/// # Errors
///
/// Wrong meshes, poses or options; standard output that cannot be written.
pub(crate) fn query(args: &QueryArgs, format: Option<Format>) -> Result<(), Failure> {
    check_certificate_options(args, format)?;
    if let Some(path) = &args.heat {
        check_heat_options(args)?;
        check_output("--heat", path, &["png"])?;
        let inputs = [&args.pair.mesh_a, &args.pair.mesh_b, &args.poses].map(|path| &**path);
        check_outputs(&[path], &inputs).map_err(Failure::input)?;
    }
    // Poses first: they are read in no time, and a mistake in them is reported before the long
    // work.
    let poses = read_poses(&args.poses)?;
    // Nobody reads the report of preparation here.
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let a = load(&args.pair.mesh_a, args.pair.scale_a, &options)?;
    let b = load(&args.pair.mesh_b, args.pair.scale_b, &options)?;
    // Preparation is no part of a query's time.
    a.clusters();
    b.clusters();
    let certifier = args.certificate.then(|| Certifier::new(&args.pair)).transpose()?;
    let question = Query::of(demand_of(args.demand)).by(method_of(args.method));

    let format = format.unwrap_or(Format::Json);
    let mut output = Output::new();
    if format == Format::Text {
        output.line(&line::heading(args.demand))?;
    }
    let bar = progress::bar(poses.len() as u64, "querying");
    let budget = args.budget.map_or(Budget::Unlimited, Budget::Tests);
    let effort = Effort { accuracy: args.accuracy, budget };
    let mut memory = EstimateMemory::default();
    for (index, &[pose_a, pose_b]) in poses.iter().enumerate() {
        if args.cold {
            memory.clear();
        }
        let placed = [Placed { model: &a, pose: pose_a }, Placed { model: &b, pose: pose_b }];
        let start = Instant::now();
        let found = estimate(placed[0], placed[1], &question, &effort, &mut memory);
        // Whole nanoseconds: that is what the clock gives.
        let micros = start.elapsed().as_nanos() as f64 / 1e3;
        let wrong = |error| {
            Failure::input(format!("pose file {}: pose {index}: {error}", args.poses.display()))
        };
        let mut found = found.map_err(wrong)?;
        let distance = found.answer.as_ref().and_then(|answer| answer.distance);
        if found.surface == Some(Surface::Cross) && distance.is_some() {
            // That it is 0 is known from any crossing; the line shows one.
            let pair = Pair::new(placed[0], placed[1]).map_err(wrong)?;
            let common = || common_point(&pair, &mut Counters::default());
            found.witnesses = found.witnesses.or_else(common);
        }
        let shown = ShownFields { demand: args.demand, closed: [a.is_closed(), b.is_closed()] };
        let line = Line::new(index, &found, micros, shown);
        match (format, &certifier) {
            (Format::Text, _) => output.line(&line.text()),
            (Format::Json, None) => output.json(&line),
            (Format::Json, Some(certifier)) => {
                let certificate = certifier.certify(placed, &found).map_err(|error| {
                    Failure::run(format!("pose {index}: no certificate: {error}."))
                })?;
                output.line(&sealed(&CertifiedLine { line, certificate })?)
            }
        }?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let Some(path) = &args.heat else { return Ok(()) };
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let names = [&args.pair.mesh_a, &args.pair.mesh_b].map(|path| name(path));
    let searched = Searched { models: [&a, &b], names, question, poses: &poses, cold: args.cold };
    match searched.draw(path) {
        Ok(()) => Ok(()),
        Err(Trouble::NoGraphics(why)) => {
            tracing::warn!("no picture: {why}");
            Ok(())
        }
        Err(Trouble::Failed(failure)) => Err(failure),
    }
}

/// Heat is that of the exact search.
fn check_heat_options(args: &QueryArgs) -> Result<(), Failure> {
    let wrong = |option: &str| {
        Err(Failure::input(format!(
            "--heat: it shows what the exact search compares; leave {option} out."
        )))
    };
    match () {
        () if args.accuracy != Accuracy::Exact => wrong("--accuracy"),
        () if args.budget.is_some() => wrong("--budget"),
        () => Ok(()),
    }
}

/// Certificates are about exact verdicts, and go into JSON lines.
fn check_certificate_options(args: &QueryArgs, format: Option<Format>) -> Result<(), Failure> {
    let wrong = |option: &str| {
        Err(Failure::input(format!(
            "--certificate: it proves exact verdicts, in JSON lines; leave {option} out."
        )))
    };
    match () {
        () if !args.certificate => Ok(()),
        () if args.accuracy != Accuracy::Exact => wrong("--accuracy"),
        () if args.budget.is_some() => wrong("--budget"),
        () if format == Some(Format::Text) => wrong("--format text"),
        () => Ok(()),
    }
}

fn method_of(method: MethodArg) -> Method {
    match method {
        MethodArg::Boxes => Method::Boxes,
        MethodArg::Envelopes => Method::Envelopes,
    }
}

/// Contacts are wanted where the surfaces meet, so the margin is 0.
fn demand_of(demand: DemandArg) -> Demand {
    match demand {
        DemandArg::Intersects => Demand::Intersects,
        DemandArg::Distance => Demand::Distance { below: None },
        DemandArg::Contacts => Demand::contacts(0.0),
        DemandArg::Regions => Demand::Regions { margin: 0.0 },
    }
}
