//! STL, ASCII and binary.
//!
//! The word 'solid' at the start proves nothing: many binary files begin with it. A file is binary
//! when its size is what its face count implies, or when it holds bytes that no text has.

use cranny_exact::DVec3;

use super::builder::{Builder, Weld};
use super::problem::{DecodeError, Place, Problem, excerpt};
use super::text::Words;
use super::{MeshFile, MeshFormat};
use crate::text_file::bytes_without_mark;

const HEADER: usize = 84;
const RECORD: usize = 50;

pub(super) fn decode(bytes: &[u8]) -> Result<MeshFile, DecodeError> {
    let promised = promised(bytes);
    let fits = promised.is_some_and(|n| size(n) == bytes.len() as u64);
    let text = bytes_without_mark(bytes);
    let word = text.trim_ascii_start().get(..5).unwrap_or_default();
    if !fits && word.eq_ignore_ascii_case(b"solid") && is_text(text) {
        decode_ascii(text)
    } else {
        decode_binary(bytes, promised)
    }
}

/// The number of faces that a binary file states.
fn promised(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(count)))
}

/// The size of a binary file of so many faces.
fn size(faces: u64) -> u64 {
    HEADER as u64 + faces * RECORD as u64
}

/// Whether a file plainly is a binary one, whatever its name: it has the size that its number of
/// faces implies.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    promised(bytes).is_some_and(|faces| faces > 0 && size(faces) == bytes.len() as u64)
}

/// No control characters but blanks. Names may be in any encoding.
fn is_text(bytes: &[u8]) -> bool {
    bytes.iter().all(|&b| b >= b' ' || b.is_ascii_whitespace() || b == 0x0b)
}

fn decode_binary(bytes: &[u8], promised: Option<u64>) -> Result<MeshFile, DecodeError> {
    let mut builder = Builder::new(MeshFormat::Stl);
    let found = bytes.len() as u64;
    let Some(count) = promised else {
        let what = "the header of a binary file (the file is no ASCII STL either: that begins with 'solid')";
        let problem = Problem::Truncated { what: what.to_owned(), needed: HEADER as u64, found };
        return Err(builder.error(Place::Whole, problem));
    };
    let needed = size(count);
    if found < needed && is_text(bytes) {
        let head = String::from_utf8_lossy(bytes.trim_ascii());
        let head = excerpt(head.lines().next().unwrap_or_default());
        return Err(builder.error(Place::Whole, Problem::OtherText { head, count, needed }));
    }
    if found < needed {
        let what = format!(
            "a binary file of {count} faces, as its bytes 80 to 83 say (an ASCII file begins with 'solid'),"
        );
        let problem = Problem::Truncated { what, needed, found };
        return Err(builder.error(Place::Whole, problem));
    }
    if found > needed {
        builder.note(match found - needed {
            1 => "1 byte after the last face was skipped".to_owned(),
            n => format!("{n} bytes after the last face were skipped"),
        });
    }
    let mut weld = Weld::default();
    for (face, record) in bytes[HEADER..needed as usize].chunks_exact(RECORD).enumerate() {
        let mut corners = [0; 3];
        for (k, corner) in corners.iter_mut().enumerate() {
            let at = 12 + 12 * k;
            let position =
                DVec3::new(float(record, at), float(record, at + 4), float(record, at + 8));
            let place = || {
                Place::Element(format!(
                    "face {face}, corner {k} (both numbered from 0), byte {}",
                    HEADER + face * RECORD + at
                ))
            };
            *corner = weld.index(&mut builder, position, place)?;
        }
        builder.polygon(&corners, || Place::Face(face));
    }
    builder.finish()
}

fn float(record: &[u8], at: usize) -> f64 {
    let mut bytes = [0; 4];
    bytes.copy_from_slice(&record[at..at + 4]);
    f64::from(f32::from_le_bytes(bytes))
}

/// What the next line of an ASCII file may be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    File,
    Solid,
    Facet,
    Loop,
    FacetEnd,
}

impl Inside {
    fn expected(self) -> &'static str {
        match self {
            Self::File => "'solid' or the end of the file",
            Self::Solid => "'facet' or 'endsolid'",
            Self::Facet => "'outer loop'",
            Self::Loop => "three lines 'vertex x y z', then 'endloop'",
            Self::FacetEnd => "'endfacet'",
        }
    }
}

fn decode_ascii(bytes: &[u8]) -> Result<MeshFile, DecodeError> {
    let text = String::from_utf8_lossy(bytes);
    let mut builder = Builder::new(MeshFormat::Stl);
    let mut weld = Weld::default();
    let mut corners = Vec::with_capacity(3);
    let mut inside = Inside::File;
    let mut solids = 0;
    let mut last = 1;
    for (number, content) in text.lines().enumerate() {
        last = number + 1;
        let mut words = Words::new(MeshFormat::Stl, last, content);
        let Some(keyword) = words.next_word() else { continue };
        inside = match (inside, keyword.to_ascii_lowercase().as_str()) {
            (Inside::File, "solid") => {
                solids += 1;
                Inside::Solid
            }
            (Inside::Solid, "facet") => Inside::Facet,
            (Inside::Solid, "endsolid") => Inside::File,
            (Inside::Facet, "outer") => Inside::Loop,
            (Inside::Loop, "vertex") if corners.len() < 3 => {
                let position = words.position()?;
                corners.push(weld.index(&mut builder, position, || Place::Line(last))?);
                Inside::Loop
            }
            (Inside::Loop, "endloop") if corners.len() == 3 => {
                builder.polygon(&corners, || Place::Line(last));
                corners.clear();
                Inside::FacetEnd
            }
            (Inside::FacetEnd, "endfacet") => Inside::Solid,
            _ => return Err(words.malformed(excerpt(content.trim()), inside.expected())),
        };
    }
    if inside != Inside::File {
        let problem = Problem::Malformed {
            found: "the end of the file".to_owned(),
            expected: inside.expected().to_owned(),
        };
        return Err(builder.error(Place::Line(last), problem));
    }
    if solids > 1 {
        builder.note(format!("{solids} solids were joined into one mesh"));
    }
    builder.finish()
}
