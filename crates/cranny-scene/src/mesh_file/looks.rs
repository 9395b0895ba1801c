//! What a file plainly is, whatever its name says.

use cranny_geometry::Model;

use super::{MeshFormat, stl};

/// How much of a file is looked at.
const HEAD: usize = 4096;

/// What a file is by its first bytes, or, of a binary STL, by its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Looks {
    /// A mesh of a format.
    Mesh(MeshFormat),
    /// A saved model.
    Model,
}

impl Looks {
    /// Nothing where the bytes do not plainly begin as any of them does.
    pub(super) fn of(bytes: &[u8]) -> Option<Self> {
        if Model::is_encoded(bytes) {
            return Some(Self::Model);
        }
        if stl::is_binary(bytes) {
            return Some(Self::Mesh(MeshFormat::Stl));
        }
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
        let lines = head.lines().map(|line| line.split_ascii_whitespace().collect::<Vec<_>>());
        let mut lines = lines.filter(|words| !words.is_empty());
        let first = lines.next()?;
        let vertex = is_obj_vertex(&first);
        let format = match first[0] {
            "ply" => MeshFormat::Ply,
            "OFF" | "COFF" | "NOFF" | "STOFF" => MeshFormat::Off,
            _ if head.starts_with("glTF") => MeshFormat::Gltf,
            _ if head.trim_start().starts_with('{') && head.contains("\"asset\"") => {
                MeshFormat::Gltf
            }
            _ if head.contains("<COLLADA") => MeshFormat::Collada,
            "solid" if lines.next().is_some_and(|words| words[0] == "facet") => MeshFormat::Stl,
            _ if vertex || lines.any(|words| is_obj_vertex(&words)) => MeshFormat::Obj,
            _ => return None,
        };
        Some(Self::Mesh(format))
    }

    /// The format, of a mesh.
    pub(super) fn format(self) -> Option<MeshFormat> {
        match self {
            Self::Mesh(format) => Some(format),
            Self::Model => None,
        }
    }

    /// What it is and what to do, for a message.
    pub(super) fn advice(self) -> String {
        let Self::Mesh(format) = self else {
            return "a saved model. Give it the extension .cranny, also where a scene names it"
                .to_owned();
        };
        let name = format.name();
        let extension = MeshFormat::EXTENSIONS.iter().find(|(_, known)| *known == format);
        let extension = extension.map_or("", |(extension, _)| extension);
        format!(
            "{name} content. Give it the extension .{extension}, also where a scene or a robot names it"
        )
    }
}

/// A line `v x y z`.
fn is_obj_vertex(words: &[&str]) -> bool {
    words.len() >= 4
        && words[0] == "v"
        && words[1..4].iter().all(|word| word.parse::<f64>().is_ok())
}
