//! Why a robot was not read.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::mesh_file::MeshFileError;
use crate::text_file::remedy;

/// Why a URDF file is no robot.
#[derive(Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The file cannot be opened or read.
    #[error("robot file {}: cannot be read ({source}). {}.", path.display(), remedy(source))]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is not well-formed XML.
    #[error("robot file {}, line {line}, column {column}: {problem}", path.display())]
    Xml {
        /// The path.
        path: PathBuf,
        /// From 1.
        line: u32,
        /// From 1.
        column: u32,
        /// What is wrong and what to do.
        problem: String,
    },
    /// It is XML, but not URDF.
    #[error("robot file {}: not a URDF robot ({message}). Correct the element or export the robot again.", path.display())]
    Urdf {
        /// The path.
        path: PathBuf,
        /// What the reader said.
        message: String,
    },
    /// A link or joint says something that cannot be.
    #[error("robot file {}{}, {element} {name:?}: {problem}", path.display(), at(*line))]
    Element {
        /// The path.
        path: PathBuf,
        /// Where the element begins, from 1.
        line: Option<u32>,
        /// "link" or "joint".
        element: &'static str,
        /// Its name.
        name: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The links do not form one tree.
    #[error("robot file {}: {problem}", path.display())]
    Tree {
        /// The path.
        path: PathBuf,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A mesh cannot be found.
    #[error(
        "robot file {}{}, link {link:?}: the mesh {uri:?} was not found. Looked for {}. Put the mesh there, correct the path, or name the folder above the package in ROS_PACKAGE_PATH.",
        path.display(), at(*line), list(tried)
    )]
    MeshNotFound {
        /// The path.
        path: PathBuf,
        /// Where the link begins, from 1.
        line: Option<u32>,
        /// Link that wants it.
        link: String,
        /// As written.
        uri: String,
        /// Every place looked at.
        tried: Vec<PathBuf>,
    },
    /// A collision mesh cannot be read.
    #[error("robot file {}{}, link {link:?}: {source}", path.display(), at(*line))]
    Mesh {
        /// The path.
        path: PathBuf,
        /// Where the link begins, from 1.
        line: Option<u32>,
        /// Link that wants it.
        link: String,
        /// What is wrong with the mesh file.
        source: Box<MeshFileError>,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for RobotError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

fn at(line: Option<u32>) -> String {
    line.map_or_else(String::new, |line| format!(", line {line}"))
}

fn list(paths: &[PathBuf]) -> String {
    /// Deep folders give dozens of candidates; the nearest ones are enough.
    const NAMED: usize = 4;
    let mut names: Vec<_> =
        paths.iter().take(NAMED).map(|path| path.display().to_string()).collect();
    if paths.len() > NAMED {
        names.push(format!("{} more places", paths.len() - NAMED));
    }
    if names.is_empty() { "no place: the address names none".to_owned() } else { names.join(", ") }
}
