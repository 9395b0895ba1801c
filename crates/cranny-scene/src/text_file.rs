//! Text files as editors leave them.

use std::fs;
use std::io;
use std::path::Path;

/// What some editors put before UTF-8; it says nothing of the text.
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

/// The text of a file.
///
/// # Errors
///
/// As [`fs::read_to_string`]; what is no UTF-8 is [`io::ErrorKind::InvalidData`], with its line.
pub fn read_text(path: &Path) -> io::Result<String> {
    String::from_utf8(fs::read(path)?).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        io::Error::new(io::ErrorKind::InvalidData, no_utf8(error.as_bytes(), valid))
    })
}

/// What is to be done about a file that is not read, as by [`read_text`].
#[must_use]
pub fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::InvalidData => "Save it as UTF-8 text",
        io::ErrorKind::IsADirectory => "It is a folder: name a file in it",
        _ => "Check the path and its permissions",
    }
}

fn no_utf8(bytes: &[u8], valid: usize) -> String {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return "it is UTF-16, not UTF-8".to_owned();
    }
    let line = 1 + bytes[..valid].iter().filter(|&&byte| byte == b'\n').count();
    format!("byte {:#04x} of line {line} is no UTF-8", bytes[valid])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_utf8_is_refused_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        for (bytes, says) in [
            (&b"(\n\n // \xfc\n)"[..], "byte 0xfc of line 3 is no UTF-8"),
            (b"\xff\xfe(\0)\0", "it is UTF-16, not UTF-8"),
        ] {
            fs::write(&path, bytes).unwrap();
            let error = read_text(&path).unwrap_err();
            assert_eq!(
                (error.to_string().as_str(), remedy(&error)),
                (says, "Save it as UTF-8 text")
            );
        }
        fs::write(&path, "ü").unwrap();
        assert_eq!(read_text(&path).unwrap(), "ü");
        let of_a_folder = remedy(&read_text(folder.path()).unwrap_err());
        assert_eq!(of_a_folder, "It is a folder: name a file in it");
        let nothing = remedy(&read_text(&folder.path().join("b.ron")).unwrap_err());
        assert_eq!(nothing, "Check the path and its permissions");
    }
}
