//! glTF 2.0, JSON or GLB: every mesh of the default scene under its node transforms, joined.
//!
//! Node transforms are read from the JSON as `f64` and composed so. Coordinates stay as filed
//! (y up, metres): a scene's `pose` or `scale` says otherwise where it matters. A node that mirrors
//! turns its faces, so that outside stays outside. Points and lines are skipped with a note; skins
//! and morph targets are not applied.

mod accessor;
mod document;

use cranny_exact::{DMat3, DQuat, DVec3};

use super::affine::Affine;
use super::builder::Builder;
use super::problem::{DecodeError, Place, Problem, counted, excerpt};
use super::{Fetch, MeshFile, MeshFormat};
use accessor::Buffers;
use document::{Document, Node, Primitive};

const FORMAT: MeshFormat = MeshFormat::Gltf;

/// glTF's numbers of the primitive modes that have triangles.
const TRIANGLES: u32 = 4;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

pub(super) fn decode(bytes: &[u8], fetch: Fetch<'_>) -> Result<MeshFile, DecodeError> {
    let (json, blob) = split_container(bytes)?;
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        let line = error.line();
        let problem = Problem::Malformed {
            found: format!("what cannot be read ({error})"),
            expected: "glTF 2.0 in JSON".to_owned(),
        };
        DecodeError { format: FORMAT, place: Place::Line(line), problem }
    })?;
    document.check_extensions()?;
    let buffers = Buffers::load(&document, blob, fetch)?;
    let mut scene = GltfScene {
        document: &document,
        buffers,
        builder: Builder::new(FORMAT),
        visited: vec![false; document.nodes.len()],
        skipped: 0,
        skinned: 0,
    };
    for root in document.roots()? {
        scene.walk(root)?;
    }
    scene.finish()
}

/// How many bytes of what is no glTF are quoted.
const HEAD: usize = 16;

/// The JSON and the binary chunk of a GLB; or the whole file as JSON.
fn split_container(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), DecodeError> {
    let error = |at, problem| DecodeError { format: FORMAT, place: Place::Byte(at), problem };
    if !bytes.starts_with(b"glTF") {
        if bytes.trim_ascii_start().starts_with(b"{") {
            return Ok((bytes, None));
        }
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
        let problem = Problem::Malformed {
            found: excerpt(&head),
            expected: "'glTF', with which a .glb begins, or '{', with which a .gltf does"
                .to_owned(),
        };
        return Err(error(0, problem));
    }
    let word = |at: usize, what: &str| -> Result<u32, DecodeError> {
        let found = bytes.len().saturating_sub(at) as u64;
        let four = bytes.get(at..at + 4).and_then(|b| b.try_into().ok());
        let problem = || Problem::Truncated { what: what.to_owned(), needed: 4, found };
        four.map(u32::from_le_bytes).ok_or_else(|| error(at, problem()))
    };
    let version = word(4, "the version")?;
    if version != 2 {
        let problem = Problem::Unsupported {
            what: format!("glTF version {version}"),
            advice: "Export as glTF 2.0",
        };
        return Err(error(4, problem));
    }
    let total = u64::from(word(8, "the file length")?);
    if total > bytes.len() as u64 {
        let what = "the file (by its own header)".to_owned();
        let found = bytes.len() as u64;
        return Err(error(8, Problem::Truncated { what, needed: total, found }));
    }
    let (mut json, mut blob) = (None, None);
    let mut at = 12;
    while at < total as usize {
        let length = word(at, "a chunk's length")? as usize;
        let kind = word(at + 4, "a chunk's type")?;
        let end = at.saturating_add(8).saturating_add(length);
        let chunk = bytes.get(at + 8..end).ok_or_else(|| {
            let found = bytes.len().saturating_sub(at + 8) as u64;
            error(
                at,
                Problem::Truncated { what: "a chunk".to_owned(), needed: length as u64, found },
            )
        })?;
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            _ => {}
        }
        at = end;
    }
    let missing = || Problem::Malformed {
        found: "a GLB without a JSON chunk".to_owned(),
        expected: "one".to_owned(),
    };
    Ok((json.ok_or_else(|| error(12, missing()))?, blob))
}

struct GltfScene<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    builder: Builder,
    /// A node has one place in the tree; a second visit means a cycle or a shared child.
    visited: Vec<bool>,
    skipped: usize,
    skinned: usize,
}

impl GltfScene<'_> {
    /// Depth first, children in file order, without recursion: files may nest deeply.
    fn walk(&mut self, root: usize) -> Result<(), DecodeError> {
        let mut stack = vec![(root, Affine::IDENTITY)];
        while let Some((index, scene_from_parent)) = stack.pop() {
            let place = || Place::Element(format!("node {index}"));
            let Some(node) = self.document.nodes.get(index) else {
                return Err(self.builder.error(place(), missing_element("node")));
            };
            if std::mem::replace(&mut self.visited[index], true) {
                let problem = Problem::Malformed {
                    found: "a node that is reached twice".to_owned(),
                    expected: "a tree of nodes".to_owned(),
                };
                return Err(self.builder.error(place(), problem));
            }
            let scene_from_node = scene_from_parent.compose(&local_transform(node, index)?);
            if let Some(mesh) = node.mesh {
                self.skinned += usize::from(node.skin.is_some());
                self.add_mesh(mesh, &scene_from_node)?;
            }
            stack.extend(node.children.iter().rev().map(|&child| (child, scene_from_node)));
        }
        Ok(())
    }

    fn add_mesh(&mut self, mesh: usize, scene_from_mesh: &Affine) -> Result<(), DecodeError> {
        let Some(found) = self.document.meshes.get(mesh) else {
            let place = Place::Element(format!("mesh {mesh}"));
            return Err(self.builder.error(place, missing_element("mesh")));
        };
        for (k, primitive) in found.primitives.iter().enumerate() {
            let mode = primitive.mode.unwrap_or(TRIANGLES);
            if (TRIANGLES..=TRIANGLE_FAN).contains(&mode) {
                let name = format!("mesh {mesh}, primitive {k}");
                self.add_primitive(primitive, mode, &name, scene_from_mesh)?;
            } else {
                self.skipped += 1;
            }
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        primitive: &Primitive,
        mode: u32,
        name: &str,
        scene_from_mesh: &Affine,
    ) -> Result<(), DecodeError> {
        let place = || Place::Element(name.to_owned());
        let Some(&positions) = primitive.attributes.get("POSITION") else {
            let problem = Problem::Malformed {
                found: "a primitive without the attribute POSITION".to_owned(),
                expected: "one".to_owned(),
            };
            return Err(self.builder.error(place(), problem));
        };
        let positions = self.buffers.positions(positions)?;
        let first = self.builder.vertex_count();
        if *scene_from_mesh != Affine::IDENTITY {
            self.builder.was_single();
        }
        for (vertex, &p) in positions.iter().enumerate() {
            let posed = scene_from_mesh.apply(p);
            self.builder.vertex(posed, || Place::Element(format!("{name}, vertex {vertex}")))?;
        }
        let corners = match primitive.indices {
            Some(accessor) => self.buffers.indices(accessor)?,
            None => (0..positions.len() as u32).collect(),
        };
        if let Some(&bad) = corners.iter().find(|&&i| i as usize >= positions.len()) {
            let problem =
                Problem::Index { index: i64::from(bad), vertices: positions.len(), first: 0 };
            return Err(self.builder.error(place(), problem));
        }
        if mode == TRIANGLES && corners.len() % 3 != 0 {
            let problem = Problem::Malformed {
                found: format!("{} corners of triangles", corners.len()),
                expected: "a multiple of three".to_owned(),
            };
            return Err(self.builder.error(place(), problem));
        }
        let mirrored = scene_from_mesh.mirrors();
        for [a, b, c] in triangles(mode, &corners) {
            let face = if mirrored { [a, c, b] } else { [a, b, c] };
            self.builder.polygon(&face.map(|i| i + first as u32), place);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<MeshFile, DecodeError> {
        if self.skipped > 0 {
            let were = if self.skipped == 1 { "was" } else { "were" };
            let primitives = counted(self.skipped, "primitive");
            let note = format!("{primitives} of points or lines {were} skipped");
            self.builder.remark(note.clone());
            self.builder.note(note);
        }
        if self.skinned > 0 {
            self.builder.note(match self.skinned {
                1 => "one skinned mesh was read in its bind pose".to_owned(),
                n => format!("{n} skinned meshes were read in their bind pose"),
            });
        }
        self.builder.finish()
    }
}

/// Triangles of a list, strip or fan, all turned the same way.
fn triangles(mode: u32, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        TRIANGLE_STRIP => corners
            .windows(3)
            .enumerate()
            .map(|(k, w)| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        TRIANGLE_FAN => corners.windows(2).skip(1).map(|w| [w[0], w[1], corners[0]]).collect(),
        _ => corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
    }
}

/// `parent_from_node`: its matrix, or translation · rotation · scale.
fn local_transform(node: &Node, index: usize) -> Result<Affine, DecodeError> {
    if let Some(m) = &node.matrix {
        return Ok(Affine {
            linear: DMat3::from_cols(
                DVec3::new(m[0], m[1], m[2]),
                DVec3::new(m[4], m[5], m[6]),
                DVec3::new(m[8], m[9], m[10]),
            ),
            translation: DVec3::new(m[12], m[13], m[14]),
        });
    }
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let length = rotation.length();
    if !length.is_normal() {
        let problem = Problem::Malformed {
            found: format!("a rotation quaternion of length {length}"),
            expected: "length 1".to_owned(),
        };
        let place = Place::Element(format!("node {index}"));
        return Err(DecodeError { format: FORMAT, place, problem });
    }
    let scale = DVec3::from_array(node.scale.unwrap_or([1.0; 3]));
    Ok(Affine {
        linear: DMat3::from_quat(rotation * (1.0 / length)) * DMat3::from_diagonal(scale),
        translation: DVec3::from_array(node.translation.unwrap_or_default()),
    })
}

fn missing_element(kind: &str) -> Problem {
    Problem::Malformed {
        found: format!("a {kind} that the file does not have"),
        expected: "a number of one that it has".to_owned(),
    }
}

/// A buffer's address in a message: data URIs are long.
fn address(uri: &str) -> String {
    excerpt(uri)
}
