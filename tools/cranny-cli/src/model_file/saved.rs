//! Saved models: written whole or not at all, and loaded in place of meshes.

use std::fs;
use std::path::Path;
use std::time::Instant;

use cranny_geometry::{BuildOptions, Flatness, Model, Repair};
use cranny_record::write_whole;

use super::{LoadedModel, Times};
use crate::failure::Failure;

/// Loads a saved model.
///
/// # Errors
///
/// A missing or broken file; a scale, a repair, a weld distance or a flatness, which need the mesh.
pub(super) fn load(path: &Path, scale: f64, options: &BuildOptions) -> Result<Model, Failure> {
    let needs_mesh = |what: &str| {
        Err(Failure::input(format!(
            "model file {}: {what} needs the mesh that it was prepared from. Name the mesh file, or leave the option out.",
            path.display()
        )))
    };
    if scale != 1.0 {
        return needs_mesh("a scale");
    }
    if options.repair != Repair::None {
        return needs_mesh("--repair");
    }
    if options.tolerance.is_some() {
        return needs_mesh("--weld");
    }
    if options.flatness != Flatness::Auto {
        return needs_mesh("--flat");
    }
    let bytes = fs::read(path).map_err(|error| {
        let kind = error.kind();
        let advice = "Check its name and whether it may be read.";
        let message =
            format!("model file {}: it cannot be read ({error}). {advice}", path.display());
        Failure::unreadable(message, kind)
    })?;
    let start = Instant::now();
    let model = Model::decode(&bytes)
        .map_err(|error| Failure::input(format!("model file {}: {error}.", path.display())))?;
    let (faces, ms) = (model.mesh().faces().len(), start.elapsed().as_secs_f64() * 1e3);
    tracing::info!("{}: saved model of {faces} faces loaded in {ms:.1} ms", path.display());
    Ok(model)
}

/// Loads a saved model and scans it.
///
/// # Errors
///
/// As [`load`].
pub(super) fn load_with_report(
    path: &Path,
    options: &BuildOptions,
) -> Result<LoadedModel, Failure> {
    let start = Instant::now();
    let model = load(path, 1.0, options)?;
    let mut times = Times { read: start.elapsed(), ..Times::default() };
    let start = Instant::now();
    let report = model
        .survey(options.tolerance, options.self_intersections)
        .map_err(|error| Failure::input(format!("model file {}: {error}.", path.display())))?;
    times.scan = start.elapsed();
    let notes =
        vec!["a saved model does not say what was filed and mended before it was saved".to_owned()];
    let format = "saved model";
    Ok(LoadedModel { model, report, format, notes, times })
}

/// Writes a model under a partial name, which is its own when all is there; returns the number of
/// bytes.
///
/// # Errors
///
/// Where it cannot be written; no partial file stays.
pub(crate) fn save(model: &Model, path: &Path) -> Result<usize, Failure> {
    let bytes = model.encode();
    write_whole(path, &bytes).map_err(|error| {
        Failure::run(format!(
            "model file {}: it cannot be written ({error}). Check the folder, its rights and its space.",
            path.display()
        ))
    })?;
    tracing::info!("{}: {} bytes written", path.display(), bytes.len());
    Ok(bytes.len())
}
