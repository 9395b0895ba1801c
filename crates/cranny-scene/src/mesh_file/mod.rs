//! Mesh files: many formats, one result.
//!
//! Coordinates written as text are read at the full precision of `f64`, whatever the format calls
//! their type, since every exact decision later reads these numbers. Positions are kept as filed;
//! only formats that carry a scene (glTF, COLLADA) apply its node transforms, and COLLADA its unit
//! and up-axis. Polygons are split into triangles that cover them once
//! ([`cranny_geometry::split_polygon`]); what is no flat, simple polygon is split too, with a note.
//! Indexing is kept as filed, except for STL, which has none: there, equal positions become one
//! vertex.

mod affine;
mod builder;
mod collada;
mod gltf;
mod looks;
mod obj;
mod off;
mod ply;
mod polygons;
mod problem;
mod stl;
mod text;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use cranny_geometry::{Flatness, Mesh};
use thiserror::Error;

use crate::text_file::{bytes_without_mark, remedy};

pub use collada::UpAxis;
pub use looks::Looks;
pub use obj::encode_obj;
pub use problem::{DecodeError, Place, Problem};

/// A mesh format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography, ASCII or binary (recognized by content).
    Stl,
    /// Polygon file format, ASCII or binary of either byte order.
    Ply,
    /// Object file format of Geomview, ASCII.
    Off,
    /// glTF 2.0, JSON or GLB (recognized by content).
    Gltf,
    /// COLLADA 1.4 and 1.5.
    Collada,
}

/// How the names of saved models ([`Model::encode`](cranny_geometry::Model::encode)) end.
pub const MODEL_EXTENSION: &str = "cranny";

/// Whether a file is a saved model, by its name.
#[must_use]
pub fn is_saved_model(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(MODEL_EXTENSION))
}

impl MeshFormat {
    /// Every accepted extension with its format.
    pub const EXTENSIONS: [(&'static str, Self); 7] = [
        ("obj", Self::Obj),
        ("stl", Self::Stl),
        ("ply", Self::Ply),
        ("off", Self::Off),
        ("gltf", Self::Gltf),
        ("glb", Self::Gltf),
        ("dae", Self::Collada),
    ];

    /// The format that a file name's extension stands for, in upper or lower case.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::EXTENSIONS.iter().find(|(known, _)| *known == extension).map(|&(_, format)| format)
    }

    /// Its usual name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::Gltf => "glTF",
            Self::Collada => "COLLADA",
        }
    }
}

/// A mesh as read, with what the reader left out or changed.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Vertices and triangles, in the file's coordinates.
    pub mesh: Mesh,
    /// The format it was read as.
    pub format: MeshFormat,
    /// One sentence each: polygons split, lines skipped, solids joined, units applied.
    pub notes: Vec<String>,
    /// How flat is flat ([`BuildOptions::flatness`](cranny_geometry::BuildOptions::flatness)):
    /// [`Flatness::Single`] where single precision was transformed since, as by nodes of glTF,
    /// which coordinates no longer show.
    pub flatness: Flatness,
}

/// Why a mesh file was not read.
#[derive(Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// The file cannot be opened or read.
    #[error("mesh file {}: cannot be read ({source}). {}.", path.display(), remedy(source))]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The extension names no known format.
    #[error(
        "mesh file {}: its extension {extension:?} names no mesh format known here. Known extensions are .obj, .stl, .ply, .off, .gltf, .glb and .dae; convert the file, or rename it where its content is one of these. (A saved model, .cranny, is read where a whole model is asked for: as a command's mesh, and as the path of a body.)",
        path.display()
    )]
    UnknownExtension {
        /// The path.
        path: PathBuf,
        /// Its extension; empty where it has none.
        extension: String,
    },
    /// The content is not a mesh of its format.
    #[error("mesh file {}: {source}", path.display())]
    Decode {
        /// The path.
        path: PathBuf,
        /// Where and what.
        source: DecodeError,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for MeshFileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Reads a mesh file; its extension names the format.
///
/// COLLADA files are turned so that z is up. A `.gltf` may name buffer files beside it.
///
/// # Errors
///
/// [`MeshFileError`]: missing or unreadable file, unknown extension, or content that is no mesh,
/// with the line, byte or element at fault.
pub fn read_mesh(path: &Path) -> Result<MeshFile, MeshFileError> {
    read_mesh_with(path, UpAxis::Z)
}

/// [`read_mesh`] with a choice of how COLLADA's up-axis is treated; other formats ignore it.
///
/// # Errors
///
/// As [`read_mesh`].
pub fn read_mesh_with(path: &Path, up_axis: UpAxis) -> Result<MeshFile, MeshFileError> {
    let format = MeshFormat::of_path(path).ok_or_else(|| MeshFileError::UnknownExtension {
        path: path.to_owned(),
        extension: path.extension().unwrap_or_default().to_string_lossy().into_owned(),
    })?;
    let bytes = fs::read(path)
        .map_err(|source| MeshFileError::Unreadable { path: path.to_owned(), source })?;
    let beside = path.parent().unwrap_or(Path::new(""));
    let fetch = |name: &str| fs::read(beside.join(name));
    decode(&bytes, format, up_axis, &fetch)
        .map_err(|source| MeshFileError::Decode { path: path.to_owned(), source })
}

/// Decodes a mesh from the bytes of a file. COLLADA is turned so that z is up.
///
/// # Errors
///
/// [`DecodeError`]: where in the content, and what is wrong. A glTF file whose buffers lie in
/// other files cannot be decoded alone; [`read_mesh`] finds them.
pub fn decode_mesh(bytes: &[u8], format: MeshFormat) -> Result<MeshFile, DecodeError> {
    let fetch = |_: &str| {
        Err(io::Error::new(
            io::ErrorKind::NotFound,
            "the content was handed over without a folder to look in",
        ))
    };
    decode(bytes, format, UpAxis::Z, &fetch)
}

/// Fetches a file named by another, by its relative path.
type Fetch<'a> = &'a dyn Fn(&str) -> io::Result<Vec<u8>>;

fn decode(
    bytes: &[u8],
    format: MeshFormat,
    up_axis: UpAxis,
    fetch: Fetch<'_>,
) -> Result<MeshFile, DecodeError> {
    let refused = |problem| DecodeError { format, place: Place::Whole, problem };
    let text = bytes_without_mark(bytes);
    if text.iter().all(u8::is_ascii_whitespace) {
        return Err(refused(Problem::Empty));
    }
    let read = match format {
        MeshFormat::Obj => obj::decode(text),
        // Of binary ones, the first bytes mean nothing.
        MeshFormat::Stl => stl::decode(bytes),
        MeshFormat::Ply => ply::decode(text),
        MeshFormat::Off => off::decode(text),
        MeshFormat::Gltf => gltf::decode(text, fetch),
        MeshFormat::Collada => collada::decode(text, up_axis),
    };
    // What cannot be read and plainly is something else has one fault: its name.
    read.map_err(|error| match Looks::of(text) {
        Some(looks) if looks.format() != Some(format) => refused(Problem::Misnamed { looks }),
        _ => error,
    })
}
