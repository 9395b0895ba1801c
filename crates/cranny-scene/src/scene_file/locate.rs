//! Places in RON text: the line and column of an error, and the place of a field's value.
//!
//! An error of syntax comes from the `ron` crate with line and column ([`byte_at`]). An error that
//! shows only once the whole scene is known is at the value of a field ([`find`]). Both become a
//! range of bytes, and [`line_and_column`] gives every error the line and column that it reports
//! (`problem` puts them into the message).

use std::ops::Range;

/// Line and column of a byte, both from 1; columns count characters.
pub(super) fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line = 1 + before.matches('\n').count();
    let column = 1 + before.rsplit('\n').next().unwrap_or_default().chars().count();
    (line, column)
}

/// The byte at a line and column (characters), both from 1.
pub(super) fn byte_at(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let rest = text.get(start..).unwrap_or_default();
    start + rest.chars().take(column.saturating_sub(1)).map(char::len_utf8).sum::<usize>()
}

/// The `nth` place (from 0) where `field: "value"` stands in RON text, as the range of the value
/// with its quotes. Comments and longer strings that contain it do not count.
pub(super) fn find(text: &str, field: &str, value: &str, nth: usize) -> Option<Range<usize>> {
    let tokens = tokens(text);
    let mut matches = tokens.windows(3).filter_map(|window| {
        let fits = text.get(window[0].range.clone()) == Some(field)
            && text.get(window[1].range.clone()) == Some(":")
            && window[2].string.as_deref() == Some(value);
        fits.then(|| window[2].range.clone())
    });
    matches.nth(nth)
}

/// The first place where a string stands in RON text, with its quotes.
pub(super) fn find_string(text: &str, value: &str) -> Option<Range<usize>> {
    let mut tokens = tokens(text).into_iter();
    tokens.find(|token| token.string.as_deref() == Some(value)).map(|token| token.range)
}

/// The first `Kind(…)` that states no `name` of its own.
pub(super) fn find_unnamed(text: &str, kind: &str) -> Option<Range<usize>> {
    let tokens = tokens(text);
    let word = |index: usize| tokens.get(index).map_or("", |token| &text[token.range.clone()]);
    let is_named = |opening: usize| {
        let mut depth = 0i32;
        for index in opening..tokens.len() {
            match word(index) {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth -= 1,
                "name" if depth == 1 && word(index + 1) == ":" => return true,
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
        false
    };
    let mut places =
        (0..tokens.len()).filter(|&index| word(index) == kind && word(index + 1) == "(");
    places.find(|&index| !is_named(index + 1)).map(|index| tokens[index].range.clone())
}

/// A word, a string or a single character; comments and blanks are none.
pub(super) struct Token {
    pub(super) range: Range<usize>,
    /// Content of a string literal.
    pub(super) string: Option<String>,
}

pub(super) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            block_comment(rest)
        } else if c.is_whitespace() {
            c.len_utf8()
        } else {
            let (length, string) = token(rest, c);
            tokens.push(Token { range: at..at + length, string });
            length
        };
        at += length;
    }
    tokens
}

/// Length of a word, a string or a single character.
fn token(rest: &str, first: char) -> (usize, Option<String>) {
    if first == '"' {
        return string(rest);
    }
    let word = |c: char| c.is_alphanumeric() || c == '_';
    if word(first) {
        return (rest.find(|c| !word(c)).unwrap_or(rest.len()), None);
    }
    (first.len_utf8(), None)
}

/// A quoted string; escapes other than of quotes and backslashes are kept as written.
fn string(rest: &str) -> (usize, Option<String>) {
    let mut content = String::new();
    let mut characters = rest.char_indices().skip(1);
    while let Some((at, c)) = characters.next() {
        match c {
            '"' => return (at + 1, Some(content)),
            '\\' => match characters.next() {
                Some((_, escaped @ ('"' | '\\'))) => content.push(escaped),
                Some((_, other)) => content.extend(['\\', other]),
                None => break,
            },
            _ => content.push(c),
        }
    }
    (rest.len(), None)
}

/// Comments of this kind nest.
fn block_comment(rest: &str) -> usize {
    let mut depth = 0usize;
    let mut at = 0;
    while at < rest.len() {
        let here = &rest[at..];
        if here.starts_with("/*") {
            depth += 1;
            at += 2;
        } else if here.starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += here.chars().next().map_or(1, char::len_utf8);
        }
    }
    rest.len()
}

/// The field whose value ends at a byte, or goes on there.
pub(super) fn field_before(text: &str, byte: usize) -> Option<&str> {
    let (before, _) = text.get(..byte)?.rsplit_once(':')?;
    let is_of_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let name = before.rsplit(|c| !is_of_name(c)).next();
    name.filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_and_order_are_respected() {
        let text = r#"// name: "a"
            /* name: "a" /* name: "a" */ */
            (title: "name: \"a\"", name : "a", other: "a", /* ü */ name: "a")"#;
        let first = find(text, "name", "a", 0).unwrap();
        let second = find(text, "name", "a", 1).unwrap();
        assert_eq!(&text[first.clone()], "\"a\"");
        assert!(text[..first.start].ends_with("name : "));
        assert!(text[..second.start].ends_with("/* ü */ name: "));
        assert_eq!(find(text, "name", "a", 2), None);
        assert!(find(text, "title", "name: \"a\"", 0).is_some());
    }

    #[test]
    fn a_kind_without_a_name_of_its_own_is_found() {
        let text = r#"[Pile(name: "a", count: 1), Pile(shapes: [(name: "b")]), Pile()]"#;
        assert_eq!(find_unnamed(text, "Pile").map(|range| range.start), text.find("Pile(shapes"));
        assert_eq!(find_unnamed(r#"[Pile(name: "a")]"#, "Pile"), None);
    }

    #[test]
    fn columns_count_characters() {
        let text = "(\n  \u{fc}ber: 1,\n)";
        let comma = text.find(',').unwrap();
        assert_eq!(line_and_column(text, comma), (2, 10));
        assert_eq!(byte_at(text, 2, 10), comma);
        assert_eq!(line_and_column(text, 0), (1, 1));
        assert_eq!(line_and_column(text, text.len() + 1), (3, 2));
    }

    #[test]
    fn unfinished_text_ends() {
        for text in ["name: \"a", "/* name", "\"\\", "é\"ü\\"] {
            assert_eq!(find(text, "name", "a", 0), None);
        }
    }

    #[test]
    fn the_field_of_a_value_is_the_one_before_it() {
        let text = "(material: (density: -1), layers: [])";
        let end = text.find("-1").unwrap() + 2;
        assert_eq!(field_before(text, end), Some("density"));
        assert_eq!(field_before("(1, 2", 5), None);
        assert_eq!(field_before("é: 1", 1), None, "within a letter");
        assert_eq!(field_before(": 1", 3), None);
    }
}
