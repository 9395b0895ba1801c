//! Buffers and the typed numbers in them, every access checked.

use std::borrow::Cow;

use cranny_exact::DVec3;

use super::document::{Accessor, Document};
use super::{FORMAT, address, missing_element};
use crate::mesh_file::Fetch;
use crate::mesh_file::problem::{DecodeError, Place, Problem};

const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// The buffers of a document, fetched.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(
        document: &'a Document,
        blob: Option<&'a [u8]>,
        fetch: Fetch<'_>,
    ) -> Result<Self, DecodeError> {
        let mut bytes = Vec::with_capacity(document.buffers.len());
        for (index, buffer) in document.buffers.iter().enumerate() {
            let error = |problem| DecodeError {
                format: FORMAT,
                place: Place::Element(format!("buffer {index}")),
                problem,
            };
            let content = match (&buffer.uri, blob) {
                (None, Some(blob)) => Cow::Borrowed(blob),
                (None, None) => {
                    return Err(error(Problem::Malformed {
                        found: "a buffer without uri in a file without binary chunk".to_owned(),
                        expected: "either".to_owned(),
                    }));
                }
                (Some(uri), _) => Cow::Owned(resolve(uri, fetch).map_err(error)?),
            };
            let found = content.len() as u64;
            if found < buffer.byte_length {
                let needed = buffer.byte_length;
                return Err(error(Problem::Truncated {
                    what: "the buffer".to_owned(),
                    needed,
                    found,
                }));
            }
            bytes.push(content);
        }
        Ok(Self { document, bytes })
    }

    /// Positions: three floats each.
    pub(super) fn positions(&self, index: usize) -> Result<Vec<DVec3>, DecodeError> {
        let accessor = self.accessor(index)?;
        if accessor.component_type != FLOAT || accessor.shape != "VEC3" {
            return Err(wrong_type(index, accessor, "VEC3 of floats (5126)"));
        }
        let number = |b: &[u8], k: usize| {
            f64::from(f32::from_le_bytes([b[4 * k], b[4 * k + 1], b[4 * k + 2], b[4 * k + 3]]))
        };
        let items = self.items(index, accessor, 12)?;
        Ok(items.map(|b| DVec3::new(number(b, 0), number(b, 1), number(b, 2))).collect())
    }

    /// Vertex indices of any unsigned type.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, DecodeError> {
        let accessor = self.accessor(index)?;
        let size = match accessor.component_type {
            UNSIGNED_BYTE => 1,
            UNSIGNED_SHORT => 2,
            UNSIGNED_INT => 4,
            _ => 0,
        };
        if size == 0 || accessor.shape != "SCALAR" {
            return Err(wrong_type(
                index,
                accessor,
                "SCALAR of unsigned bytes, shorts or ints (5121, 5123, 5125)",
            ));
        }
        let items = self.items(index, accessor, size)?;
        Ok(items
            .map(|b| b.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte)))
            .collect())
    }

    fn accessor(&self, index: usize) -> Result<&Accessor, DecodeError> {
        let accessor = self.document.accessors.get(index);
        let accessor = accessor.ok_or_else(|| at_accessor(index, missing_element("accessor")))?;
        if accessor.sparse.is_some() || accessor.buffer_view.is_none() {
            let what = "a sparse accessor, or one without a buffer view,".to_owned();
            let advice = "Export the mesh without sparse accessors";
            return Err(at_accessor(index, Problem::Unsupported { what, advice }));
        }
        Ok(accessor)
    }

    /// The bytes of each item. The whole range is checked before the first is read.
    fn items(
        &self,
        index: usize,
        accessor: &Accessor,
        size: u64,
    ) -> Result<impl Iterator<Item = &[u8]>, DecodeError> {
        let view = accessor.buffer_view.and_then(|view| self.document.buffer_views.get(view));
        let view = view.ok_or_else(|| at_accessor(index, missing_element("buffer view")))?;
        let buffer = self.bytes.get(view.buffer);
        let buffer = buffer.ok_or_else(|| at_accessor(index, missing_element("buffer")))?;
        let stride = view.byte_stride.unwrap_or(size);
        if stride < size {
            return Err(at_accessor(
                index,
                Problem::Malformed {
                    found: format!("a stride of {stride} bytes"),
                    expected: format!("at least {size}, the size of an item"),
                },
            ));
        }
        let used = match accessor.count {
            0 => 0,
            n => (n - 1).saturating_mul(stride).saturating_add(size),
        };
        let needed = accessor.byte_offset.saturating_add(used);
        let start = view.byte_offset;
        let end = start.saturating_add(view.byte_length).min(buffer.len() as u64);
        let found = end.saturating_sub(start);
        if needed > found || view.byte_offset.saturating_add(view.byte_length) > buffer.len() as u64
        {
            let what = format!("{} items in the buffer view", accessor.count);
            let needed = needed.max(view.byte_length);
            return Err(at_accessor(index, Problem::Truncated { what, needed, found }));
        }
        let first = start + accessor.byte_offset;
        let bytes = buffer.get(first as usize..(start + needed) as usize).unwrap_or_default();
        let (stride, size) = (stride as usize, size as usize);
        Ok((0..accessor.count as usize)
            .filter_map(move |k| bytes.get(k * stride..k * stride + size)))
    }
}

fn at_accessor(index: usize, problem: Problem) -> DecodeError {
    DecodeError { format: FORMAT, place: Place::Element(format!("accessor {index}")), problem }
}

fn wrong_type(index: usize, accessor: &Accessor, expected: &str) -> DecodeError {
    at_accessor(
        index,
        Problem::Malformed {
            found: format!("{} of component type {}", accessor.shape, accessor.component_type),
            expected: expected.to_owned(),
        },
    )
}

/// The content of a data URI, or of a file beside this one.
fn resolve(uri: &str, fetch: Fetch<'_>) -> Result<Vec<u8>, Problem> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        return encoded.and_then(decode_base64).ok_or_else(|| Problem::Malformed {
            found: format!("the data URI {}", address(uri)),
            expected: "base64 content".to_owned(),
        });
    }
    let name = percent_decoded(uri);
    fetch(&name).map_err(|error| Problem::Buffer { name: name.clone(), reason: error.to_string() })
}

/// `%20` and its like as the bytes they stand for.
fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) if bytes[at] == b'%' => {
                decoded.push(byte);
                at += 3;
            }
            _ => {
                decoded.push(bytes[at]);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

/// RFC 4648, with or without padding.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_all_lengths() {
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmFy", "foobar")]
        {
            assert_eq!(decode_base64(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(decode_base64("Zm9v!"), None);
    }

    #[test]
    fn percent_codes_are_bytes() {
        assert_eq!(percent_decoded("a%20b%C3%A9%zz"), "a bé%zz");
    }
}
