//! The byte order mark that some editors put before UTF-8; it says nothing of the text.

const MARK: &str = "\u{feff}";

/// A text without the byte order mark that some editors put before it.
#[must_use]
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix(MARK).unwrap_or(text)
}

/// The same of a file's bytes, which need not be text.
pub(crate) fn bytes_without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK.as_bytes()).unwrap_or(bytes)
}
