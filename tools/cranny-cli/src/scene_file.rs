//! From the name of a scene file to its description.

use std::path::Path;

use cranny_scene::{LoadOptions, LoadedScene, SceneError, load_scene_with};

use crate::failure::Failure;
use crate::progress;

/// Loads a scene and all that it names; `seed` replaces the scene's own. Notes are logged.
///
/// # Errors
///
/// A scene that cannot be read or is wrong.
pub(crate) fn load(path: &Path, seed: Option<u64>) -> Result<LoadedScene, Failure> {
    let waiting = progress::spinner(format!("reading {}", path.display()));
    let scene = load_scene_with(path, &LoadOptions { seed }).map_err(wrong_scene)?;
    waiting.finish_and_clear();
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
