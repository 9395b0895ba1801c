//! From the name of a scene file to its description.

use std::path::Path;

use cranny_scene::{
    LoadOptions, LoadedScene, MeshFormat, SceneError, is_saved_model, load_scene_with,
};

use crate::failure::Failure;
use crate::paths::check_input;
use crate::progress;
use crate::words::counted;

/// Loads a scene and all that it names. Warnings and notes are logged.
///
/// # Errors
///
/// As [`read`].
pub(crate) fn load(path: &Path, options: &LoadOptions) -> Result<LoadedScene, Failure> {
    let scene = read(path, options)?;
    for warning in &scene.warnings {
        tracing::warn!(scene = %path.display(), "{warning}");
    }
    Ok(scene)
}

/// Loads a scene and all that it names, for a command whose result has the warnings. Notes are
/// logged.
///
/// # Errors
///
/// A scene that cannot be read or is wrong.
pub(crate) fn read(path: &Path, options: &LoadOptions) -> Result<LoadedScene, Failure> {
    check_input("scene file", path)?;
    if MeshFormat::of_path(path).is_some() || is_saved_model(path) {
        return Err(Failure::input(format!(
            "scene file {}: by its name it is a mesh or a model, no scene. Name a scene (.ron); `cranny inspect` takes meshes and models.",
            path.display()
        )));
    }
    let waiting = progress::spinner(format!("reading {}", path.display()));
    let scene = load_scene_with(path, options).map_err(wrong_scene)?;
    waiting.finish_and_clear();
    let (bodies, files) = (scene.description.bodies.len(), scene.files.len());
    let [bodies, files] = [counted(bodies, "body"), counted(files, "file")];
    tracing::info!("{}: {bodies}, and {files} that it names", path.display());
    for note in &scene.notes {
        tracing::info!(scene = %path.display(), "{note}");
    }
    Ok(scene)
}

fn wrong_scene(error: SceneError) -> Failure {
    match &error {
        SceneError::Unreadable { source, .. } => {
            let kind = source.kind();
            Failure::unreadable(error, kind)
        }
        _ => Failure::input_at(error),
    }
}
