//! What is around a snapshot's content: `CRANNYRS`, version of the form, what it is of, length and
//! checksum.

use thiserror::Error;

/// A snapshot begins with this.
const MAGIC: &[u8; 8] = b"CRANNYRS";

/// Of the form; a snapshot of any other is refused.
const VERSION: u32 = 9;

const CHECKSUM: usize = 32;

/// Magic, version, what it is of, length, checksum.
const HEAD: usize = 8 + 4 + 4 + 8 + CHECKSUM;

/// What a snapshot is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    World,
    Simulation,
}

impl Kind {
    fn code(self) -> u32 {
        match self {
            Self::World => 1,
            Self::Simulation => 2,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::World => "a world of rapier, for `cranny_rapier::restore`",
            Self::Simulation => "a simulation, for `Simulation::restore`",
        }
    }
}

/// Bytes that are no snapshot, or not the one that was written.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FrameError {
    /// They do not begin as one.
    #[error("these {found} bytes are no snapshot: they do not begin as one")]
    NotASnapshot {
        /// Bytes there are.
        found: usize,
    },
    /// Written in another form.
    #[error("the snapshot has the form {found}, and form {VERSION} is read here")]
    Version {
        /// Form found.
        found: u32,
    },
    /// Of something else.
    #[error("the snapshot is not of {expected}")]
    Kind {
        /// What was to be read.
        expected: &'static str,
    },
    /// Cut off, or added to.
    #[error("the snapshot has {found} bytes where {stated} were written")]
    Length {
        /// Bytes there are.
        found: usize,
        /// Bytes there should be.
        stated: u64,
    },
    /// Not the bytes that were written.
    #[error("the snapshot is damaged: its checksum does not match")]
    Checksum,
}

pub(super) fn framed(kind: Kind, content: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + content.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(kind.code().to_le_bytes());
    bytes.extend(((HEAD + content.len()) as u64).to_le_bytes());
    bytes.extend(checksum(&bytes, content));
    bytes.extend(content);
    bytes
}

/// The content of a whole snapshot.
pub(super) fn content(kind: Kind, bytes: &[u8]) -> Result<&[u8], FrameError> {
    let found = bytes.len();
    if found < HEAD || !bytes.starts_with(MAGIC) {
        return Err(FrameError::NotASnapshot { found });
    }
    let (head, content) = bytes.split_at(HEAD);
    let (before, stated_checksum) = head.split_at(HEAD - CHECKSUM);
    let word = |at: usize| u32::from_le_bytes([at, at + 1, at + 2, at + 3].map(|i| before[i]));
    let stated = u64::from(word(16)) | u64::from(word(20)) << 32;
    if word(8) != VERSION {
        return Err(FrameError::Version { found: word(8) });
    }
    if stated != found as u64 {
        return Err(FrameError::Length { found, stated });
    }
    if checksum(before, content) != *stated_checksum {
        return Err(FrameError::Checksum);
    }
    if word(12) != kind.code() {
        return Err(FrameError::Kind { expected: kind.name() });
    }
    Ok(content)
}

fn checksum(before: &[u8], content: &[u8]) -> [u8; CHECKSUM] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(before).update(content);
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_framed_is_read_and_nothing_else() {
        let bytes = framed(Kind::World, b"content");
        assert_eq!(content(Kind::World, &bytes), Ok(b"content".as_slice()));
        let expected = Kind::Simulation.name();
        assert_eq!(content(Kind::Simulation, &bytes), Err(FrameError::Kind { expected }));
        for length in 0..bytes.len() {
            let refused = content(Kind::World, &bytes[..length]).unwrap_err();
            let cut = FrameError::Length { found: length, stated: bytes.len() as u64 };
            let none = FrameError::NotASnapshot { found: length };
            assert_eq!(refused, if length < HEAD { none } else { cut });
        }
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(content(Kind::World, &damaged).is_err(), "bit {bit}");
        }
        let mut later = bytes;
        later[8] = VERSION as u8 + 1;
        assert_eq!(content(Kind::World, &later), Err(FrameError::Version { found: VERSION + 1 }));
    }
}
