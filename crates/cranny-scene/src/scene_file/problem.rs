//! What can be wrong with a scene. `locate` computes the line and column of an error.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use cranny_shapes::ShapeError;
use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

use super::locate::line_and_column;
use crate::mesh_file::MeshFileError;
use crate::robot::{PositionError, RobotError};
use crate::text_file::remedy;

/// Why a scene was not loaded. [`miette`] shows the place in the file.
#[derive(Error, Diagnostic)]
#[non_exhaustive]
pub enum SceneError {
    /// The file cannot be opened or read.
    #[error("scene file {}: cannot be read ({source}). {}.", path.display(), remedy(source))]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Something in it is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(Box<Located>),
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Something wrong at a place of a scene file.
#[derive(Debug, Error, Diagnostic)]
#[error("scene file {}{}: {problem}", path.display(), at(*place))]
pub struct Located {
    /// The path.
    pub path: PathBuf,
    /// Line and column from 1, columns counting characters; `None` where the file has no place for
    /// it.
    pub place: Option<(usize, usize)>,
    /// What is wrong.
    pub problem: SceneProblem,
    #[source_code]
    source_code: NamedSource<String>,
    #[label("here")]
    span: Option<SourceSpan>,
}

/// What is wrong with a scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneProblem {
    /// The text is no scene: says what was expected.
    #[error("{0}")]
    Syntax(String),
    /// A [`Setting`](super::Setting) that leads nowhere, or that the reader refuses.
    #[error("the setting {setting}: {what}")]
    Setting {
        /// As somebody wrote it.
        setting: String,
        /// What is wrong.
        what: String,
    },
    /// A file that a scene includes.
    #[error("the included scene {}: {why}", path.display())]
    Include {
        /// The path.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// Two things of one kind have one name.
    #[error(
        "there are two {kind} called {name:?}. Names are frame ids and must be unique: rename one"
    )]
    DuplicateName {
        /// "bodies", "joints", "cameras" or "robots".
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A name that cannot be used.
    #[error("the name {name:?} {reason}. Choose another")]
    Name {
        /// The name.
        name: String,
        /// Why not.
        reason: &'static str,
    },
    /// A body is named that the scene does not have.
    #[error("there is no body {name:?}. The scene has {known}")]
    UnknownBody {
        /// The name.
        name: String,
        /// Some that exist.
        known: String,
    },
    /// Values that contradict each other.
    #[error("{0}")]
    Contradiction(String),
    /// A mesh file that is missing or broken.
    #[error("body {body:?}: {source}")]
    Mesh {
        /// Body or group that wants it.
        body: String,
        /// What is wrong with the file.
        source: MeshFileError,
    },
    /// Parameters that a generator refuses.
    #[error("body {body:?}: {source}")]
    Shape {
        /// Body or group that wants it.
        body: String,
        /// Which parameter.
        source: ShapeError,
    },
    /// A robot that is missing or broken.
    #[error("{0}")]
    Robot(RobotError),
    /// A joint position that a robot refuses.
    #[error("robot {robot:?}: {source}")]
    Position {
        /// Name of the robot in the scene.
        robot: String,
        /// Which joint.
        source: PositionError,
    },
}

fn at(place: Option<(usize, usize)>) -> String {
    place.map_or_else(String::new, |(line, column)| format!(", line {line}, column {column}"))
}

/// A problem at a range of bytes of the text; [`line_and_column`] makes its line and column.
pub(super) fn located(
    path: &Path,
    text: &str,
    range: Option<Range<usize>>,
    problem: SceneProblem,
) -> SceneError {
    let name = path.display().to_string();
    SceneError::Invalid(Box::new(Located {
        path: path.to_owned(),
        place: range.as_ref().map(|range| line_and_column(text, range.start)),
        problem,
        source_code: NamedSource::new(name, text.to_owned()),
        span: range.map(|range| range.into()),
    }))
}
