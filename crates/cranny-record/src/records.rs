//! The records of a file, whole or damaged: what is whole is handed over, the rest is counted.

use mcap::MAGIC;
use mcap::read::parse_record;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// What could not be read.
#[derive(Default)]
pub(crate) struct Extent {
    /// Chunks that do not match their sums.
    pub(crate) damaged: u64,
    /// Bytes behind the last whole record.
    pub(crate) lost: u64,
}

/// An operation code and a length.
const RECORD_HEAD: usize = 9;

/// Hands over all records of whole chunks and all records beside chunks, in their order.
pub(crate) fn for_each_record(bytes: &[u8], visit: &mut dyn FnMut(Record<'static>)) -> Extent {
    let mut extent = Extent::default();
    let mut rest = bytes.get(MAGIC.len()..).unwrap_or_default();
    while let Some((code, body, behind)) = next_record(rest) {
        match parsed(code, body) {
            None => extent.damaged += 1,
            Some(Record::Chunk { .. }) => match unpacked(&rest[..RECORD_HEAD + body.len()]) {
                None => extent.damaged += 1,
                Some(records) => records.into_iter().for_each(&mut *visit),
            },
            Some(record) => {
                let ends = matches!(record, Record::Footer(_));
                visit(record.into_owned());
                if ends {
                    return extent;
                }
            }
        }
        rest = behind;
    }
    extent.lost = rest.len() as u64;
    extent
}

/// The first record of some bytes, if it is whole, and what stands behind it.
fn next_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = bytes.split_at_checked(RECORD_HEAD)?;
    let length = u64::from_le_bytes(head[1..].try_into().ok()?);
    let (body, behind) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((head[0], body, behind))
}

/// A record that is whole in itself.
fn parsed(code: u8, body: &[u8]) -> Option<Record<'_>> {
    // The container's parser takes for granted that an attachment's sum is there.
    let is_short =
        code == op::ATTACHMENT && attachment_length(body).is_none_or(|n| n != body.len());
    if is_short { None } else { parse_record(code, body).ok() }
}

/// How long an attachment's record is, by what it says of its parts.
fn attachment_length(body: &[u8]) -> Option<usize> {
    let number = |at: usize, size: usize| {
        let bytes = body.get(at..at.checked_add(size)?)?;
        let value = bytes.iter().rev().fold(0u64, |value, &byte| value << 8 | u64::from(byte));
        usize::try_from(value).ok()
    };
    let mut at = 16usize;
    for _ in 0..2 {
        at = at.checked_add(4)?.checked_add(number(at, 4)?)?;
    }
    at.checked_add(8)?.checked_add(number(at, 8)?)?.checked_add(4)
}

/// A chunk that says it unpacks to more is damaged. Smaller: bodies of many millions of triangles
/// are refused, which come in one message. Larger: a flipped bit takes all memory.
const MOST_UNPACKED: usize = 1 << 30;

/// All records of a chunk; `None` where it does not match its sum.
fn unpacked(chunk: &[u8]) -> Option<Vec<Record<'static>>> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(MOST_UNPACKED);
    let mut reader = LinearReader::new_with_options(options);
    let (mut rest, mut records) = (chunk, Vec::new());
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (now, later) = rest.split_at(wanted.min(rest.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                rest = later;
            }
            LinearReadEvent::Record { data, opcode } => {
                records.push(parsed(opcode, data)?.into_owned());
            }
        }
    }
    Some(records)
}
