//! What can be wrong with the content of a mesh file, and where.

use std::fmt;

use cranny_exact::DomainError;
use cranny_geometry::MeshError;
use thiserror::Error;

use super::{Looks, MeshFormat};

/// Content that is no mesh of its format.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{} content, {place}: {problem}", format.name())]
pub struct DecodeError {
    /// The format it was read as.
    pub format: MeshFormat,
    /// Where.
    pub place: Place,
    /// What.
    pub problem: Problem,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A line of a text format, from 1.
    Line(usize),
    /// A byte of a binary format, from 0.
    Byte(usize),
    /// A vertex, from 0.
    Vertex(usize),
    /// A face, from 0.
    Face(usize),
    /// An element that the format numbers or names itself, as "accessor 3".
    Element(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => f.write_str("whole file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Vertex(vertex) => write!(f, "vertex {vertex} (numbered from 0)"),
            Self::Face(face) => write!(f, "face {face} (numbered from 0)"),
            Self::Element(element) => f.write_str(element),
        }
    }
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Problem {
    /// No byte, or nothing but blanks.
    #[error("the file is empty. Export the mesh again")]
    Empty,
    /// The file plainly is something else than its name says.
    #[error("this is {}", looks.advice())]
    Misnamed {
        /// What it is.
        looks: Looks,
    },
    /// Text that no reader of this format knows.
    #[error(
        "found text that begins with {head}, expected 'solid' or a binary file (as one it would have {count} faces and {needed} bytes). Give the file the extension of its format, or export it again"
    )]
    OtherText {
        /// How it begins, quoted.
        head: String,
        /// The number of faces that a binary file would state with these bytes.
        count: u64,
        /// The size that it would have.
        needed: u64,
    },
    /// A word where a number must stand.
    #[error(
        "{text:?} is not a number where {expected} must stand. Correct the number or export the mesh again"
    )]
    NotANumber {
        /// The word found.
        text: String,
        /// What the number would mean.
        expected: &'static str,
    },
    /// A coordinate outside the domain.
    #[error("{0}. Correct the coordinate or export the mesh again")]
    Coordinate(#[from] DomainError),
    /// A face names a vertex that is not there.
    #[error(
        "index {index} is out of range: the file has {vertices} vertices, numbered from {first}. Correct the face or export the mesh again"
    )]
    Index {
        /// Index as written.
        index: i64,
        /// Number of vertices.
        vertices: usize,
        /// What the format gives the first vertex as its number.
        first: u32,
    },
    /// The file ends too early.
    #[error(
        "{what} needs {needed} bytes, but only {found} are there: the file is truncated. Copy or export it again"
    )]
    Truncated {
        /// What was being read.
        what: String,
        /// Bytes needed.
        needed: u64,
        /// Bytes found.
        found: u64,
    },
    /// Something other than what the format prescribes.
    #[error("found {found}, expected {expected}. Correct the file or export the mesh again")]
    Malformed {
        /// What is there.
        found: String,
        /// What must be there.
        expected: String,
    },
    /// Something that the format allows but this reader does not know.
    #[error("{what} is not supported. {advice}")]
    Unsupported {
        /// What.
        what: String,
        /// What to do instead.
        advice: &'static str,
    },
    /// A buffer in another file cannot be read.
    #[error(
        "the buffer file {name:?} cannot be read ({reason}). Put it beside the mesh file, or export as one .glb"
    )]
    Buffer {
        /// Its relative path.
        name: String,
        /// What the system said.
        reason: String,
    },
    /// Everything was read, and there is no triangle.
    #[error("no faces were found ({vertices} vertices{}): nothing can collide with it. Export the mesh with its faces", aside(.remark))]
    NoFaces {
        /// Number of vertices found.
        vertices: usize,
        /// What else was in the file; empty where nothing was.
        remark: String,
    },
    /// Everything was read, but it makes no mesh.
    #[error("{0}. Correct the file or export the mesh again")]
    Mesh(MeshError),
}

fn aside(remark: &str) -> String {
    if remark.is_empty() { String::new() } else { format!("; {remark}") }
}

/// A number of things, in words: "1 line", "2 lines".
pub(super) fn counted(count: usize, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{plural}")
}

/// At most this many characters of a file are quoted in a message.
const QUOTED: usize = 40;

/// A piece of a file, short enough to be quoted in a message.
pub(super) fn excerpt(text: &str) -> String {
    let clean: String = text.chars().take(QUOTED).collect();
    if text.chars().count() > QUOTED { format!("{clean:?} …") } else { format!("{clean:?}") }
}
