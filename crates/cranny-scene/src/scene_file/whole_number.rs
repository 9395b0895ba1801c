//! What the reader of RON refuses where a whole number must stand, with the numbers that may.
//!
//! The reader knows the type of a field and does not name it ('Integer is out of bounds'), and
//! takes the point in `1.5` for the end of the number. So what may stand there is found by trial.

use std::ops::Range;

use ron::Error;
use ron::error::SpannedError;

use super::reading::{range, read};

/// Greatest numbers of the types that fields have.
const GREATEST: [u64; 4] = [u64::MAX, u32::MAX as u64, u16::MAX as u64, u8::MAX as u64];

/// What must stand where a number is refused since it is no whole one, or too small or too large;
/// `None` where that is not what is wrong.
pub(super) fn expected(text: &str, error: &SpannedError) -> Option<String> {
    let place = number_at(text, range(text, error).start)?;
    let found = &text[place.clone()];
    let is_integer = found.trim_start_matches(['-', '+']).bytes().all(|byte| byte.is_ascii_digit());
    let trial = Trial { text, place };
    // Of a message the number was read, and a field refuses it.
    let is_of_type = match error.code {
        Error::Message(_) => false,
        Error::IntegerOutOfBounds => is_integer,
        _ => !is_integer,
    };
    if !is_of_type || trial.takes(found) || !trial.takes("1") {
        return None;
    }
    let least = if trial.takes("0") { 0 } else { 1 };
    let greatest = GREATEST.into_iter().find(|greatest| trial.takes(&greatest.to_string()));
    let range = match greatest {
        Some(greatest) => format!("from {least} to {greatest}"),
        None => format!("of at least {least}"),
    };
    let point = if is_integer { "" } else { ", written without a point" };
    Some(format!("expected a whole number {range}{point}, found {found}"))
}

/// The number that stands at a byte, or around it.
fn number_at(text: &str, byte: usize) -> Option<Range<usize>> {
    let is_of_number = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+' | '_');
    let (before, after) = (text.get(..byte)?, text.get(byte..)?);
    let start = before.trim_end_matches(is_of_number).len();
    let end = byte + after.find(|c| !is_of_number(c)).unwrap_or(after.len());
    let number = start..end;
    text[number.clone()].parse::<f64>().is_ok_and(f64::is_finite).then_some(number)
}

/// The text with another number in the place of one.
struct Trial<'a> {
    text: &'a str,
    place: Range<usize>,
}

impl Trial<'_> {
    /// Whether the reader gets beyond the place.
    fn takes(&self, number: &str) -> bool {
        let Range { start, end } = self.place;
        let text = [&self.text[..start], number, &self.text[end..]].concat();
        read(&text).map_or_else(|error| range(&text, &error).start > start + number.len(), |_| true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_s_own_range_is_named() {
        for (text, says) in [
            ("(most_parts: -1)", "from 1 to 4294967295, found -1"),
            ("(seed: -1)", "from 0 to 18446744073709551615, found -1"),
            ("(seed: 18446744073709551616)", "to 18446744073709551615, found 18446744073709551616"),
            ("(most_parts: 1.5)", "from 1 to 4294967295, written without a point, found 1.5"),
            ("(seed: 2.0, step: 0.1)", "written without a point, found 2.0"),
            ("(seed: 1e3)", "written without a point, found 1e3"),
            ("(accuracy: Tree(300))", "from 0 to 255, found 300"),
            ("(groups: [Grid(count: (2, 2, 1.5))])", "to 4294967295, written without a point"),
            ("(groups: [Grid(count: (-2, 2, 1))])", "to 4294967295, found -2"),
        ] {
            let said = expected(text, &read(text).unwrap_err());
            assert!(said.as_ref().is_some_and(|said| said.contains(says)), "{text}: {said:?}");
        }
    }

    #[test]
    fn what_is_wrong_otherwise_is_left_to_the_reader() {
        for text in [
            "(step: -1)",
            "(gravity: (0 1.5 2))",
            "(most_parts: 0)",
            "(seed: x)",
            "(sed: 1.5)",
            "(",
        ] {
            assert_eq!(expected(text, &read(text).unwrap_err()), None, "{text}");
        }
    }
}
