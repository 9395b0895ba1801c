//! Wavefront OBJ: vertices and polygonal faces. Normals, texture coordinates, groups and materials
//! say nothing about where the surface is and are passed over.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use cranny_geometry::Mesh;

use super::builder::Builder;
use super::problem::{DecodeError, Place, Problem, counted, excerpt};
use super::text::Words;
use super::{MeshFile, MeshFormat};

/// Keywords without bearing on the surface.
const PASSED_OVER: [&str; 13] = [
    "vn",
    "vt",
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "lod",
    "shadow_obj",
];

pub(super) fn decode(bytes: &[u8]) -> Result<MeshFile, DecodeError> {
    let text = String::from_utf8_lossy(bytes);
    let mut builder = Builder::new(MeshFormat::Obj);
    let mut polygons = ObjFaces::default();
    let mut skipped: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (line, content) in logical_lines(&text) {
        let content = content.split('#').next().unwrap_or_default();
        let mut words = Words::new(MeshFormat::Obj, line, content);
        match words.next_word() {
            None => {}
            Some("v") => {
                let position = words.position()?;
                builder.vertex(position, || Place::Line(line))?;
            }
            Some("f") => {
                polygons.read(&mut words, builder.vertex_count())?;
            }
            Some(keyword) if PASSED_OVER.contains(&keyword) => {}
            Some(keyword) => {
                skipped.entry(excerpt(keyword)).or_insert((0, line)).0 += 1;
            }
        }
    }
    for (keyword, (count, first)) in &skipped {
        builder.note(match count {
            1 => format!("line {first}, beginning with {keyword}, was skipped"),
            _ => format!(
                "{count} lines beginning with {keyword} were skipped, the first is line {first}"
            ),
        });
        builder.remark(format!("line {first} begins with {keyword}, which is no OBJ surface"));
    }
    polygons.add_to(&mut builder)?;
    builder.finish()
}

/// Lines with their number; a backslash at the end of a line continues it.
fn logical_lines(text: &str) -> Vec<(usize, std::borrow::Cow<'_, str>)> {
    let mut lines: Vec<(usize, std::borrow::Cow<'_, str>)> = Vec::new();
    let mut continued = false;
    for (number, line) in text.lines().enumerate() {
        let (body, more) = match line.trim_end().strip_suffix('\\') {
            Some(body) => (body, true),
            None => (line, false),
        };
        match lines.last_mut() {
            Some((_, whole)) if continued => {
                let whole = whole.to_mut();
                whole.push(' ');
                whole.push_str(body);
            }
            _ => lines.push((number + 1, body.into())),
        }
        continued = more;
    }
    lines
}

/// Faces as read. They may come before their vertices, so their range is checked at the end.
#[derive(Default)]
struct ObjFaces {
    /// Of all faces, one after another, from 0.
    corners: Vec<i64>,
    /// Line of each face, and where its corners end.
    faces: Vec<(usize, usize)>,
}

impl ObjFaces {
    /// Reads the corners of a face; negative numbers count back from the last vertex.
    fn read(&mut self, words: &mut Words<'_>, vertices: usize) -> Result<(), DecodeError> {
        const EXPECTED: &str = "a vertex number (v, v/vt, v//vn or v/vt/vn)";
        let first = self.corners.len();
        while let Some(word) = words.next_word() {
            let number = word.split('/').next().unwrap_or_default();
            let index: i64 = number.parse().map_err(|_| words.not_a_number(word, EXPECTED))?;
            let from_zero = match index {
                1.. => index - 1,
                0 => -1,
                _ => index.saturating_add(vertices as i64),
            };
            if from_zero < 0 {
                return Err(words.error(Problem::Index { index, vertices, first: 1 }));
            }
            self.corners.push(from_zero);
        }
        let count = self.corners.len() - first;
        if count < 3 {
            return Err(words
                .malformed(format!("a face with {}", counted(count, "corner")), "at least three"));
        }
        self.faces.push((words.line, self.corners.len()));
        Ok(())
    }

    fn add_to(&self, builder: &mut Builder) -> Result<(), DecodeError> {
        let vertices = builder.vertex_count();
        let mut start = 0;
        let mut checked = Vec::new();
        for &(line, end) in &self.faces {
            checked.clear();
            for &index in &self.corners[start..end] {
                let in_range = u32::try_from(index).ok().filter(|&i| (i as usize) < vertices);
                checked.push(in_range.ok_or_else(|| {
                    let index = index.saturating_add(1);
                    let problem = Problem::Index { index, vertices, first: 1 };
                    builder.error(Place::Line(line), problem)
                })?);
            }
            builder.polygon(&checked, || Place::Line(line));
            start = end;
        }
        Ok(())
    }
}

/// A mesh as OBJ text that [`decode_mesh`](super::decode_mesh) reads back to the bit: every
/// coordinate in the fewest digits that name it uniquely, faces numbered from 1.
#[must_use]
pub fn encode_obj(mesh: &Mesh) -> String {
    let mut text = String::with_capacity(48 * (mesh.vertices().len() + mesh.faces().len()));
    for p in mesh.vertices() {
        // Writing to a `String` cannot fail.
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in mesh.faces() {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}
