//! `cranny inspect`: what is known of a mesh.

mod picture;
mod summary;
mod text;

use std::path::Path;

use cranny_ecs::check_outputs;
use cranny_exact::Tolerance;
use cranny_geometry::{BuildOptions, Flatness};
use cranny_scene::MODEL_EXTENSION;

use crate::args::{Format, InspectArgs, Up};
use crate::failure::Failure;
use crate::model_file::{load_with_report, save};
use crate::output::Output;
use crate::paths::check_output;
use crate::picture::Trouble;
use picture::View;
use summary::{Skipped, Summary};

/// Runs the command.
///
/// # Errors
///
/// A mesh that cannot be read, a picture or a model that cannot be written (the report is printed
/// all the same), standard output that cannot be written. Without a graphics adapter the report
/// says that the picture was skipped.
pub(crate) fn inspect(args: &InspectArgs, format: Option<Format>) -> Result<(), Failure> {
    let outputs: Vec<&Path> =
        [&args.render, &args.save].into_iter().flatten().map(|p| &**p).collect();
    check_outputs(&outputs, &[&args.mesh]).map_err(Failure::input)?;
    if let Some(path) = &args.render {
        check_output("--render", path, &["png"])?;
    }
    if let Some(path) = &args.save {
        check_output("--save", path, &[MODEL_EXTENSION])?;
    }
    let options = BuildOptions {
        repair: args.repair.into(),
        tolerance: args.weld.map(|weld_distance| Tolerance { weld_distance }),
        flatness: args.flat.map_or(Flatness::Auto, Flatness::Relative),
        ..BuildOptions::default()
    };
    let mut loaded = load_with_report(&args.mesh, &options)?;
    let concavities = loaded.make_concavities();
    picture::check(&concavities, args.show.unwrap_or_default()).map_err(|why| {
        Failure::input(format!("--show, for {}: {why}. Choose less.", args.mesh.display()))
    })?;
    let mut summary = Summary::new(&args.mesh, &loaded, &concavities);
    let mut failed = None;
    if let Some(path) = &args.save {
        match save(&loaded.model, path) {
            Ok(bytes) => {
                summary.bytes = Some(bytes);
                summary.outputs.push(path.display().to_string());
            }
            Err(failure) => {
                summary.skipped.push(Skipped::after(path, &failure));
                failed = Some(failure);
            }
        }
    }
    if let Some(path) = &args.render {
        let view = View {
            show: args.show.unwrap_or_default(),
            up: args.up.unwrap_or_else(|| Up::of_format(loaded.format)),
            cut: args.cut,
        };
        let name = args.mesh.file_name().unwrap_or_default().to_string_lossy();
        let findings = &loaded.report.findings;
        match picture::draw(&loaded.model, &concavities, findings, (view, &name), path) {
            Ok(legend) => {
                summary.outputs.push(path.display().to_string());
                summary.legend = legend;
            }
            Err(Trouble::NoGraphics(why)) => {
                tracing::warn!("no picture: {why}");
                summary.skipped.push(Skipped { what: path.display().to_string(), why });
            }
            Err(Trouble::Failed(failure)) => {
                summary.skipped.push(Skipped::after(path, &failure));
                failed.get_or_insert(failure);
            }
        }
    }
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&summary)?,
        Format::Text => output.line(&text::page(&summary))?,
    }
    failed.map_or(Ok(()), Err)
}
