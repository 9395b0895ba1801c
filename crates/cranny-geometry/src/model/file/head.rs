//! The head of a model file: [`MAGIC`], version, 0, length of the file, checksum.
//!
//! The checksum ([`mod@crate::codec`]'s `checksum`) is of all that is behind the head; every value
//! of the head but the checksum itself can only be one. So where the sections behind the head can
//! be read, and a value is another, it is the head that was damaged.

use thiserror::Error;

use super::super::Model;
use crate::codec::{Reader, Writer, checksum};

/// A model file begins with this: no text, and spoilt by whatever changes line ends.
const MAGIC: [u8; 8] = *b"\x89CRANNY\n";

/// Of the sections and what they hold; a file of any other version is refused.
const VERSION: u32 = 10;

/// What is before the checksum: magic, version, 0, length.
const BEFORE_CHECKSUM: usize = 8 + 4 + 4 + 8;

pub(super) const HEAD: usize = BEFORE_CHECKSUM + 8;

/// Bytes that are no model.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// They do not begin as a model does.
    #[error(
        "it is no saved model: it does not begin as one. Save one with `cranny inspect MESH --save MODEL`, or name a mesh file"
    )]
    NotAModel,
    /// They were written by another version of this crate.
    #[error(
        "it is a saved model of version {found}, and version {supported} is read here. Prepare the mesh again and save it, or use the Cranny that saved it"
    )]
    Version {
        /// Version found.
        found: u32,
        /// Version that is read.
        supported: u32,
    },
    /// There are fewer or more bytes than were written.
    #[error(
        "the saved model has {found} bytes where {stated} were written: it was cut off or added to. Copy it again"
    )]
    Length {
        /// Bytes there are.
        found: usize,
        /// Bytes there should be.
        stated: u64,
    },
    /// What is behind the head is whole, and a value of the head is not what was written.
    #[error(
        "the saved model is damaged: the {field} in its head is not what was written; what follows the head is whole by its checksum. Copy or save it again"
    )]
    Head {
        /// Which value.
        field: &'static str,
    },
    /// A byte is not what was written.
    #[error("the saved model is damaged: its checksum does not match. Copy or save it again")]
    Checksum,
    /// The checksum is right, yet a section cannot be part of a model: no such file was written by
    /// [`Model::encode`].
    #[error(
        "the saved model is not one that Cranny wrote: in its section of the {section}, {flaw}. Prepare the mesh again and save it"
    )]
    Section {
        /// The section.
        section: &'static str,
        /// What is wrong with it.
        flaw: String,
    },
}

impl Model {
    /// Whether some bytes begin as a saved model does.
    #[must_use]
    pub fn is_encoded(bytes: &[u8]) -> bool {
        bytes.starts_with(&MAGIC)
    }
}

/// Writes the head; length and checksum are [sealed](seal) in the end.
pub(super) fn write_head(out: &mut Writer) {
    out.one(MAGIC);
    out.one([VERSION, 0]);
    out.one(0u64);
    out.one(0u64);
}

/// Writes length and checksum into the head of a whole file.
pub(super) fn seal(bytes: &mut [u8]) {
    let length = bytes.len() as u64;
    bytes[BEFORE_CHECKSUM - 8..BEFORE_CHECKSUM].copy_from_slice(&length.to_le_bytes());
    let sum = checksum(&bytes[HEAD..]);
    bytes[BEFORE_CHECKSUM..HEAD].copy_from_slice(&sum.to_le_bytes());
}

/// Everything but the sections.
pub(super) fn check_head(bytes: &[u8]) -> Result<(), DecodeError> {
    if !Model::is_encoded(bytes) {
        return Err(DecodeError::NotAModel);
    }
    let cut_off = |_| DecodeError::Length { found: bytes.len(), stated: HEAD as u64 };
    let mut head = Reader::new(&bytes[MAGIC.len()..]);
    let [version, reserved]: [u32; 2] = head.one().map_err(cut_off)?;
    if version != VERSION {
        return Err(DecodeError::Version { found: version, supported: VERSION });
    }
    let stated: u64 = head.one().map_err(cut_off)?;
    let stored: u64 = head.one().map_err(cut_off)?;
    if stated != bytes.len() as u64 {
        return Err(DecodeError::Length { found: bytes.len(), stated });
    }
    match (checksum(&bytes[HEAD..]) == stored, reserved) {
        (true, 0) => Ok(()),
        (true, _) => Err(DecodeError::Head { field: "reserved value" }),
        (false, _) => Err(DecodeError::Checksum),
    }
}

/// Which value of the head it was that did not fit, where what follows the head may be whole all
/// the same: its checksum is right, which zeros added or cut off at the end do not change.
pub(super) fn doubtful_field(bytes: &[u8], error: &DecodeError) -> Option<&'static str> {
    let field = match error {
        DecodeError::NotAModel => "beginning",
        DecodeError::Version { .. } => "version",
        DecodeError::Length { .. } => "length",
        _ => return None,
    };
    let stored = bytes.get(BEFORE_CHECKSUM..)?.first_chunk()?;
    (u64::from_le_bytes(*stored) == checksum(&bytes[HEAD..])).then_some(field)
}
