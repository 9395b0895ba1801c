//! PLY, ASCII and binary of either byte order: the elements `vertex` (properties x, y, z) and
//! `face` (a list `vertex_indices` or `vertex_index`). Everything else is read past.

use cranny_exact::DVec3;

use super::builder::Builder;
use super::problem::{DecodeError, Place, Problem, excerpt};
use super::text::Words;
use super::{MeshFile, MeshFormat};

const FORMAT: MeshFormat = MeshFormat::Ply;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of as many little-endian bytes as its size; integers are exact in `f64`.
    fn value(self, b: [u8; 8]) -> f64 {
        let four = [b[0], b[1], b[2], b[3]];
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([b[0]])),
            Self::U8 => f64::from(b[0]),
            Self::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            Self::I32 => f64::from(i32::from_le_bytes(four)),
            Self::U32 => f64::from(u32::from_le_bytes(four)),
            Self::F32 => f64::from(f32::from_le_bytes(four)),
            Self::F64 => f64::from_le_bytes(b),
        }
    }
}

struct Property {
    name: String,
    /// Type of the length, for lists.
    length: Option<Scalar>,
    item: Scalar,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// First byte and first line after it.
    body: usize,
    line: usize,
}

pub(super) fn decode(bytes: &[u8]) -> Result<MeshFile, DecodeError> {
    let header = read_header(bytes)?;
    let mut builder = Builder::new(FORMAT);
    if let Some(strips) = header.elements.iter().find(|e| e.name == "tristrips") {
        return Err(builder.error(
            Place::Element(format!("element {:?}", strips.name)),
            Problem::Unsupported {
                what: "a PLY file of triangle strips".to_owned(),
                advice: "Export the mesh with an element 'face'",
            },
        ));
    }
    let body = bytes.get(header.body..).unwrap_or_default();
    let mut ascii;
    let mut binary;
    let values: &mut dyn Values = if header.encoding == Encoding::Ascii {
        ascii = Ascii::new(body, header.line);
        &mut ascii
    } else {
        let big_endian = header.encoding == Encoding::BigEndian;
        binary = Binary { bytes, at: header.body, big_endian };
        &mut binary
    };
    for element in &header.elements {
        read_element(element, &header, values, &mut builder)?;
    }
    builder.finish()
}

fn read_element(
    element: &Element,
    header: &Header,
    values: &mut dyn Values,
    builder: &mut Builder,
) -> Result<(), DecodeError> {
    let find =
        |names: &[&str]| element.properties.iter().position(|p| names.contains(&p.name.as_str()));
    let missing = |what: &str| {
        builder.error(
            Place::Element(format!("element {:?} of the header", element.name)),
            Problem::Malformed { found: "no such property".to_owned(), expected: what.to_owned() },
        )
    };
    let (mut axes, mut corners_at) = (None, None);
    match element.name.as_str() {
        "vertex" => {
            let axis = |name: &str| {
                let scalar = |&i: &usize| element.properties[i].length.is_none();
                find(&[name]).filter(scalar).ok_or_else(|| missing("the properties x, y and z"))
            };
            axes = Some([axis("x")?, axis("y")?, axis("z")?]);
        }
        "face" => {
            let list = find(&["vertex_indices", "vertex_index"])
                .filter(|&i| element.properties[i].length.is_some());
            corners_at =
                Some(list.ok_or_else(|| {
                    missing("a list property 'vertex_indices' or 'vertex_index'")
                })?);
        }
        _ => {}
    }
    let total = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    let mut scalars = vec![0.0; element.properties.len()];
    let mut corners = Vec::new();
    for row in 0..element.count {
        let context = Context { element: &element.name, row };
        for (k, property) in element.properties.iter().enumerate() {
            let Some(length) = property.length else {
                scalars[k] = values.next(property.item, &context)?;
                continue;
            };
            let length = values.next(length, &context)?;
            if length.fract() != 0.0 || length < 0.0 {
                let problem = Problem::Malformed {
                    found: format!("a list of {length} items"),
                    expected: "a whole number of items".to_owned(),
                };
                return Err(builder.error(values.place(), problem));
            }
            let wanted = corners_at == Some(k);
            corners.clear();
            for _ in 0..length as u64 {
                let value = values.next(property.item, &context)?;
                if wanted {
                    corners.push(index(value, total, values.place(), builder)?);
                }
            }
            if wanted && corners.len() < 3 {
                let problem = Problem::Malformed {
                    found: format!("face {row} with {} corners", corners.len()),
                    expected: "at least three".to_owned(),
                };
                return Err(builder.error(values.place(), problem));
            }
            if wanted {
                // A byte of a binary file helps nobody to find the place.
                let place = || match values.place() {
                    Place::Byte(_) => Place::Face(row as usize),
                    line => line,
                };
                builder.polygon(&corners, place);
            }
        }
        if let Some(axes) = axes {
            let place = values.place();
            builder.vertex(DVec3::from_array(axes.map(|k| scalars[k])), || place)?;
        }
    }
    Ok(())
}

fn index(value: f64, vertices: u64, place: Place, builder: &Builder) -> Result<u32, DecodeError> {
    if value.fract() == 0.0
        && value >= 0.0
        && value < vertices as f64
        && value < f64::from(u32::MAX)
    {
        return Ok(value as u32);
    }
    let vertices = vertices as usize;
    Err(builder.error(place, Problem::Index { index: value as i64, vertices, first: 0 }))
}

/// Which number is being read, for messages.
struct Context<'a> {
    element: &'a str,
    row: u64,
}

impl Context<'_> {
    fn name(&self) -> String {
        format!("{} {} (numbered from 0)", self.element, self.row)
    }
}

/// The numbers of a body, one after another.
trait Values {
    fn next(&mut self, scalar: Scalar, context: &Context<'_>) -> Result<f64, DecodeError>;
    /// Where the last number was.
    fn place(&self) -> Place;
}

struct Ascii<'a> {
    lines: Box<dyn Iterator<Item = (usize, &'a [u8])> + 'a>,
    words: Vec<&'a [u8]>,
    line: usize,
}

impl<'a> Ascii<'a> {
    fn new(body: &'a [u8], first_line: usize) -> Self {
        let lines = body.split(|&b| b == b'\n').enumerate().map(move |(n, l)| (first_line + n, l));
        Self { lines: Box::new(lines), words: Vec::new(), line: first_line }
    }
}

impl Values for Ascii<'_> {
    fn next(&mut self, _: Scalar, context: &Context<'_>) -> Result<f64, DecodeError> {
        while self.words.is_empty() {
            let Some((line, content)) = self.lines.next() else {
                let problem = Problem::Malformed {
                    found: "the end of the file".to_owned(),
                    expected: context.name(),
                };
                return Err(DecodeError { format: FORMAT, place: self.place(), problem });
            };
            self.line = line;
            self.words = content.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).collect();
            self.words.reverse();
        }
        let word = String::from_utf8_lossy(self.words.pop().unwrap_or_default());
        word.parse().map_err(|_| DecodeError {
            format: FORMAT,
            place: self.place(),
            problem: Problem::NotANumber {
                text: word.chars().take(40).collect(),
                expected: if context.element == "face" {
                    "a corner or colour of a face"
                } else {
                    "a property of an element"
                },
            },
        })
    }

    fn place(&self) -> Place {
        Place::Line(self.line)
    }
}

struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl Values for Binary<'_> {
    fn next(&mut self, scalar: Scalar, context: &Context<'_>) -> Result<f64, DecodeError> {
        let size = scalar.size();
        let found = self.bytes.get(self.at..).unwrap_or_default();
        let Some(found) = found.get(..size) else {
            let problem = Problem::Truncated {
                what: context.name(),
                needed: size as u64,
                found: found.len() as u64,
            };
            return Err(DecodeError { format: FORMAT, place: Place::Byte(self.at), problem });
        };
        let mut value = [0; 8];
        value[..size].copy_from_slice(found);
        if self.big_endian {
            value[..size].reverse();
        }
        self.at += size;
        Ok(scalar.value(value))
    }

    fn place(&self) -> Place {
        Place::Byte(self.at)
    }
}

fn read_header(bytes: &[u8]) -> Result<Header, DecodeError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut at = 0;
    let mut number = 0;
    loop {
        let rest = bytes.get(at..).unwrap_or_default();
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        number += 1;
        let content = String::from_utf8_lossy(&rest[..length]);
        let mut words = Words::new(FORMAT, number, &content);
        if rest.is_empty() {
            return Err(words.malformed("the end of the file".to_owned(), "'end_header'"));
        }
        at += length + 1;
        match (number, words.next_word()) {
            (1, Some("ply")) => {}
            (1, _) => return Err(words.malformed(excerpt(content.trim()), "the header 'ply'")),
            (_, Some("format")) => encoding = Some(read_encoding(&mut words)?),
            (_, Some("element")) => elements.push(read_element_line(&mut words)?),
            (_, Some("property")) => {
                let property = read_property(&mut words)?;
                let Some(element) = elements.last_mut() else {
                    return Err(words.malformed("'property'".to_owned(), "'element' before it"));
                };
                element.properties.push(property);
            }
            (_, Some("comment" | "obj_info") | None) => {}
            (_, Some("end_header")) => {
                let encoding = encoding.ok_or_else(|| {
                    words.malformed("'end_header'".to_owned(), "a line 'format' before it")
                })?;
                // An element without properties takes no bytes: its rows say nothing.
                elements.retain(|element| !element.properties.is_empty());
                return Ok(Header { encoding, elements, body: at, line: number + 1 });
            }
            (_, Some(_)) => {
                let expected = "'format', 'comment', 'element', 'property' or 'end_header'";
                return Err(words.malformed(excerpt(content.trim()), expected));
            }
        }
    }
}

fn read_encoding(words: &mut Words<'_>) -> Result<Encoding, DecodeError> {
    match words.next_word() {
        Some("ascii") => Ok(Encoding::Ascii),
        Some("binary_little_endian") => Ok(Encoding::LittleEndian),
        Some("binary_big_endian") => Ok(Encoding::BigEndian),
        other => Err(words.malformed(
            excerpt(other.unwrap_or_default()),
            "'ascii', 'binary_little_endian' or 'binary_big_endian'",
        )),
    }
}

fn read_element_line(words: &mut Words<'_>) -> Result<Element, DecodeError> {
    let name = words.next_word().unwrap_or_default().to_owned();
    let count = words.integer("the number of elements")?;
    let count = u64::try_from(count)
        .map_err(|_| words.malformed(count.to_string(), "a number of elements"))?;
    Ok(Element { name, count, properties: Vec::new() })
}

fn read_property(words: &mut Words<'_>) -> Result<Property, DecodeError> {
    let first = words.next_word().unwrap_or_default();
    let (length, item) = if first == "list" {
        let length = words.next_word().unwrap_or_default();
        (Some(scalar(words, length)?), words.next_word().unwrap_or_default())
    } else {
        (None, first)
    };
    let item = scalar(words, item)?;
    match words.next_word() {
        Some(name) => Ok(Property { name: name.to_owned(), length, item }),
        None => Err(words.malformed("the end of the line".to_owned(), "the property's name")),
    }
}

fn scalar(words: &Words<'_>, name: &str) -> Result<Scalar, DecodeError> {
    const EXPECTED: &str = "a type: char, uchar, short, ushort, int, uint, float, double, or the same with bits (int8 … float64)";
    Scalar::named(name).ok_or_else(|| words.malformed(excerpt(name), EXPECTED))
}
