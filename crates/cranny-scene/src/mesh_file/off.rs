//! OFF, ASCII: a header, three counts, vertices, polygons. Colours, normals and texture
//! coordinates after the position or after the corners are passed over.

use super::builder::Builder;
use super::problem::{DecodeError, Place, Problem, excerpt};
use super::text::Words;
use super::{MeshFile, MeshFormat};

const FORMAT: MeshFormat = MeshFormat::Off;

pub(super) fn decode(bytes: &[u8]) -> Result<MeshFile, DecodeError> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(number, line)| (number + 1, line.split('#').next().unwrap_or_default().trim()))
        .filter(|(_, line)| !line.is_empty())
        .peekable();
    let last = text.lines().count();
    let mut builder = Builder::new(FORMAT);

    let Some(&(number, first)) = lines.peek() else {
        return Err(builder.error(Place::Whole, Problem::Empty));
    };
    let keyword = first.split_ascii_whitespace().next().unwrap_or_default();
    let mut counts = Words::new(FORMAT, number, first);
    check_header(&counts, keyword)?;
    if first == keyword {
        lines.next();
        let (number, second) = lines.next().ok_or_else(|| ended(&builder, last, "the counts"))?;
        counts = Words::new(FORMAT, number, second);
    } else {
        lines.next();
        counts.next_word();
    }
    let vertices = count(&mut counts, "the number of vertices")?;
    let faces = count(&mut counts, "the number of faces")?;

    for vertex in 0..vertices {
        let (number, line) = lines.next().ok_or_else(|| {
            ended(&builder, last, &format!("vertex {vertex} of {vertices} (numbered from 0)"))
        })?;
        let position = Words::new(FORMAT, number, line).position()?;
        builder.vertex(position, || Place::Line(number))?;
    }
    let mut corners = Vec::new();
    for face in 0..faces {
        let (number, line) = lines.next().ok_or_else(|| {
            ended(&builder, last, &format!("face {face} of {faces} (numbered from 0)"))
        })?;
        let mut words = Words::new(FORMAT, number, line);
        read_corners(&mut words, vertices, &mut corners)?;
        builder.polygon(&corners, || Place::Line(number));
    }
    if let Some((number, line)) = lines.next() {
        builder.note(format!(
            "lines after the last face were skipped, from line {number} on: {}",
            excerpt(line)
        ));
    }
    builder.finish()
}

/// `OFF` with any of the prefixes that add columns; more dimensions and binary are refused.
fn check_header(words: &Words<'_>, keyword: &str) -> Result<(), DecodeError> {
    let prefix = keyword.strip_suffix("OFF");
    match prefix {
        Some("" | "C" | "N" | "ST" | "CN" | "STC" | "STN" | "STCN") => Ok(()),
        Some("4" | "n" | "4n") => Err(words.error(Problem::Unsupported {
            what: format!("the header {keyword:?} (other than three dimensions)"),
            advice: "Export the mesh in three dimensions, with the header OFF",
        })),
        _ => Err(words.malformed(excerpt(keyword), "the header 'OFF'")),
    }
}

fn count(words: &mut Words<'_>, expected: &'static str) -> Result<usize, DecodeError> {
    let value = words.integer(expected)?;
    usize::try_from(value).map_err(|_| words.malformed(value.to_string(), expected))
}

fn read_corners(
    words: &mut Words<'_>,
    vertices: usize,
    corners: &mut Vec<u32>,
) -> Result<(), DecodeError> {
    let number = words.integer("the number of corners")?;
    if number < 3 {
        return Err(words
            .malformed(format!("a face whose number of corners is {number}"), "at least three"));
    }
    corners.clear();
    for _ in 0..number {
        let index = words.integer("a vertex number")?;
        let in_range = u32::try_from(index).ok().filter(|&i| (i as usize) < vertices);
        let corner =
            in_range.ok_or_else(|| words.error(Problem::Index { index, vertices, first: 0 }))?;
        corners.push(corner);
    }
    Ok(())
}

fn ended(builder: &Builder, line: usize, expected: &str) -> DecodeError {
    builder.error(
        Place::Line(line),
        Problem::Malformed {
            found: "the end of the file".to_owned(),
            expected: expected.to_owned(),
        },
    )
}
