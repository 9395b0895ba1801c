//! `cranny check`: is a scene file right?

use cranny_scene::{LoadedScene, SceneError, load_scene};
use serde::Serialize;

use crate::args::{CheckArgs, Format};
use crate::failure::Failure;
use crate::output::Output;
use crate::progress;

/// What a right scene holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    version: u32,
    scene: String,
    ok: bool,
    bodies: usize,
    joints: usize,
    effects: usize,
    pairs: usize,
    cameras: usize,
    files: usize,
    notes: &'a [String],
}

/// Runs the command.
///
/// # Errors
///
/// A scene that cannot be read or is wrong; standard output that cannot be written.
pub(crate) fn check(args: &CheckArgs, format: Option<Format>) -> Result<(), Failure> {
    let scene = load(&args.scene)?;
    let what = &scene.description;
    let named = what.bodies.iter().map(|body| body.effects.len()).sum::<usize>()
        + what.pairs.iter().map(|pair| pair.effects.len()).sum::<usize>();
    let summary = Summary {
        version: 1,
        scene: args.scene.display().to_string(),
        ok: true,
        bodies: what.bodies.len(),
        joints: what.joints.len(),
        effects: what.effects.len() + named,
        pairs: what.pairs.len(),
        cameras: what.cameras.len(),
        files: scene.files.len(),
        notes: &scene.notes,
    };
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&summary),
        Format::Text => output.line(&text(&summary)),
    }
}

/// Loads a scene, notes told on the way.
///
/// # Errors
///
/// A scene that cannot be read or is wrong.
pub(crate) fn load(path: &std::path::Path) -> Result<LoadedScene, Failure> {
    let waiting = progress::spinner(format!("reading {}", path.display()));
    let scene = load_scene(path).map_err(wrong_scene)?;
    waiting.finish_and_clear();
    for note in &scene.notes {
        tracing::info!(scene = %path.display(), "{note}");
    }
    Ok(scene)
}

/// The failure of a scene that was not loaded.
pub(crate) fn wrong_scene(error: SceneError) -> Failure {
    match &error {
        SceneError::Unreadable { source, .. } => {
            let kind = std::io::Error::from(source.kind());
            Failure::unreadable(error, &kind)
        }
        _ => Failure::input_at(error),
    }
}

fn text(summary: &Summary) -> String {
    let counted = |count: usize, one: &str, many: &str| {
        format!("{count} {}", if count == 1 { one } else { many })
    };
    format!(
        "ok: {}: {}, {}, {}, {}",
        summary.scene,
        counted(summary.bodies, "body", "bodies"),
        counted(summary.joints, "joint", "joints"),
        counted(summary.effects, "effect", "effects"),
        counted(summary.cameras, "camera", "cameras"),
    )
}
