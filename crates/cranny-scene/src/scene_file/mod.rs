//! Scene files: RON text that names bodies, robots, effects and what to record.
//!
//! ```ron
//! (
//!     version: 1, gravity: (0, 0, -9.81), step: 0.004, duration: 5.0, seed: 0,
//!     bodies: [
//!         (name: "ring", shape: Generator(Torus(major_radius: 1)), pose: (at: (0, 0, 3))),
//!         (name: "mug", shape: Mesh(path: "mug.obj", scale: (1, 1, 1)), kind: Fixed),
//!     ],
//!     groups: [Pile(name: "piece", count: 50, region: (min: (-2, -2, 1), max: (2, 2, 9)),
//!                   shapes: [Generator(LPrism())])],
//!     robots: [(path: "arm.urdf", positions: {"elbow": 0.5})],
//!     effects: [Response(), Contacts(margin: 0.05)],
//!     pairs: [(a: "ring", b: "mug", effects: [Trigger()])],
//!     cameras: [(name: "main", preset: Isometric)], record: (every: 1),
//! )
//! ```
//!
//! Everything but `bodies`' names and shapes has a default; unknown fields are refused. Paths are
//! relative to the scene file. Loading is deterministic: the same text, files and seed give the
//! same description to the bit (on one platform: generators use its sine and cosine).
//!
//! `setting` puts values into the text, `include` gathers files, `reading` reads them as `syntax`
//! says, `assemble` makes the description of it, `locate` gives an error its line and column.

mod advice;
mod assemble;
mod body_syntax;
mod effect;
mod feedback;
mod geometry;
mod group;
mod include;
mod layers;
mod locate;
mod mass;
mod motor_path;
mod obstacles;
mod pair;
mod pile;
mod place_joint;
mod place_robot;
mod primitive;
mod problem;
mod reading;
#[cfg(test)]
mod reference;
mod sensors;
mod setting;
mod syntax;
mod tracker;
mod values;
mod whole_number;

use std::path::{Path, PathBuf};

use cranny_world::description::SceneDescription;

use crate::text_file::read_text;
pub use problem::{Located, SceneError, SceneProblem};
pub use setting::{Setting, SettingError};

/// What a program may decide in place of the scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Replaces the scene's `seed`.
    pub seed: Option<u64>,
    /// Values in place of those in the text, in order.
    pub settings: Vec<Setting>,
}

/// A scene, ready to be built, with what it came from.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// Bodies, joints, effects.
    pub description: SceneDescription,
    /// The file's text with the settings in it, for recordings and hashes.
    pub source_text: String,
    /// The texts of the scene files that it includes, in the order in which they were read.
    pub included_texts: Vec<String>,
    /// The path.
    pub path: PathBuf,
    /// Every further file read: scenes, meshes, robots and their meshes; each once, in order.
    pub files: Vec<PathBuf>,
    /// One sentence each, from mesh and robot readers: what was left out or changed.
    pub notes: Vec<String>,
    /// One sentence each, about robots: what was mended, left out or supposed.
    pub warnings: Vec<String>,
}

/// Loads a scene file and every mesh and robot that it names.
///
/// # Errors
///
/// [`SceneError`]: the file cannot be read, or something in it is wrong, with line and column.
pub fn load_scene(path: &Path) -> Result<LoadedScene, SceneError> {
    load_scene_with(path, &LoadOptions::default())
}

/// [`load_scene`] with decisions of the program in place of the file's.
///
/// # Errors
///
/// As [`load_scene`].
pub fn load_scene_with(path: &Path, options: &LoadOptions) -> Result<LoadedScene, SceneError> {
    let text = read_text(path)
        .map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
    parse_scene(text, path, options)
}

/// Loads a scene from its text; `path` is where it would be, for messages and relative paths.
///
/// # Errors
///
/// As [`load_scene`].
pub fn parse_scene(
    text: String,
    path: &Path,
    options: &LoadOptions,
) -> Result<LoadedScene, SceneError> {
    let sheets = include::sheets(&text, path, options)?;
    let assembled = assemble::assemble(&sheets, options);
    let (description, files, [notes, warnings]) =
        assembled.map_err(|error| blamed(error, &text, path, options))?;
    Ok(LoadedScene {
        description,
        source_text: sheets.own.text,
        included_texts: sheets.included.into_iter().map(|sheet| sheet.text).collect(),
        path: path.to_owned(),
        files,
        notes,
        warnings,
    })
}

/// Names the setting that an error comes with, of a text that the reader takes: the last one
/// without which it is not there.
fn blamed(error: SceneError, text: &str, path: &Path, options: &LoadOptions) -> SceneError {
    let SceneError::Invalid(located) = &error else { return error };
    let (said, settings) = (located.problem.to_string(), &options.settings);
    let fails_with = |settings: &[Setting]| {
        let options = LoadOptions { settings: settings.to_vec(), ..options.clone() };
        let sheets = include::sheets(text, path, &options);
        let assembled = sheets.and_then(|sheets| assemble::assemble(&sheets, &options));
        matches!(assembled, Err(SceneError::Invalid(other)) if other.problem.to_string() == said)
    };
    let enough = (0..settings.len()).find(|&count| fails_with(&settings[..count]));
    match settings[..enough.unwrap_or(settings.len())].last() {
        Some(setting) => setting.blamed(error),
        None => error,
    }
}
