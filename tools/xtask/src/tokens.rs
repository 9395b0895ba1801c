//! Words, numbers and marks of a stripped source text, and the paths they form.

/// A piece of source text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) line: usize,
    pub(crate) text: String,
    pub(crate) kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Word,
    Number,
    /// `::`, or one character.
    Mark,
}

/// Splits a stripped text. Lifetimes and quotes yield nothing.
pub(crate) fn of(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let chars: Vec<char> = line.chars().collect();
        let mut at = 0;
        while at < chars.len() {
            let start = at;
            let c = chars[at];
            let kind = if c.is_ascii_digit() {
                at = number_end(&chars, at);
                Some(Kind::Number)
            } else if is_word(c) {
                at = word_end(&chars, at);
                Some(Kind::Word)
            } else if c == '\'' {
                at = word_end(&chars, at + 1);
                None
            } else if chars[at..].starts_with(&[':', ':']) {
                at += 2;
                Some(Kind::Mark)
            } else {
                at += 1;
                (!c.is_whitespace() && c != '"').then_some(Kind::Mark)
            };
            if let Some(kind) = kind {
                let text = chars[start..at].iter().collect();
                tokens.push(Token { line: number + 1, text, kind });
            }
        }
    }
    tokens
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word_end(chars: &[char], at: usize) -> usize {
    at + chars[at.min(chars.len())..].iter().take_while(|c| is_word(**c)).count()
}

/// The end of a number; `1.5e-3_f64` is one, `0..n`, `1.max(x)` and `t.0.x` are not read past
/// theirs.
fn number_end(chars: &[char], at: usize) -> usize {
    let peek = |at: usize| chars.get(at).copied().unwrap_or(' ');
    let is_float = chars[at] != '0' || !matches!(peek(at + 1), 'x' | 'b' | 'o');
    let mut end = at;
    while is_word(peek(end))
        || (is_float && matches!(peek(end), '+' | '-') && matches!(peek(end - 1), 'e' | 'E'))
    {
        end += 1;
    }
    let is_field = at > 0 && chars[at - 1] == '.';
    let point = peek(end) == '.' && peek(end + 1) != '.' && !chars[at..end].contains(&'.');
    if is_float && point && !is_field && (peek(end + 1).is_ascii_digit() || !is_word(peek(end + 1)))
    {
        end += 1;
        while is_word(peek(end))
            || (matches!(peek(end), '+' | '-') && matches!(peek(end - 1), 'e' | 'E'))
        {
            end += 1;
        }
    }
    end
}

/// A path as it was meant: `use std::{fs, io::{self, Read}}` gives `std::fs`, `std::io::self`,
/// `std::io::Read`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PathAt {
    pub(crate) line: usize,
    pub(crate) segments: Vec<String>,
    /// Whether it follows a `.`: a field or a method.
    pub(crate) is_member: bool,
    /// The mark or word after it; empty at the end of the text.
    pub(crate) followed_by: String,
}

/// Every path of the text, words on their own included.
pub(crate) fn paths(tokens: &[Token]) -> Vec<PathAt> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at].kind == Kind::Word {
            let is_member = at > 0 && tokens[at - 1].text == ".";
            at = read_path(tokens, at, &[], is_member, &mut found);
        } else {
            at += 1;
        }
    }
    found
}

/// Reads the path that starts at `at` under a prefix; returns where it ends.
fn read_path(
    tokens: &[Token],
    mut at: usize,
    prefix: &[String],
    is_member: bool,
    found: &mut Vec<PathAt>,
) -> usize {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let is_segment =
        |at: usize| tokens.get(at).is_some_and(|t| t.kind == Kind::Word || t.text == "*");
    let line = tokens[at].line;
    let mut segments = prefix.to_vec();
    segments.push(text(at).to_owned());
    at += 1;
    while text(at) == "::" && is_segment(at + 1) {
        segments.push(text(at + 1).to_owned());
        at += 2;
    }
    if text(at) == "::" && text(at + 1) == "{" {
        at += 2;
        while at < tokens.len() && text(at) != "}" {
            at = if is_segment(at) {
                read_path(tokens, at, &segments, false, found)
            } else {
                at + 1
            };
        }
        return at + 1;
    }
    found.push(PathAt { line, segments, is_member, followed_by: text(at).to_owned() });
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<String> {
        of(text).into_iter().map(|token| token.text).collect()
    }

    fn joined(text: &str) -> Vec<String> {
        paths(&of(text)).into_iter().map(|path| path.segments.join("::")).collect()
    }

    #[test]
    fn numbers_are_read_whole_and_no_further() {
        assert_eq!(texts("1e-9+2.5E-3_f64"), ["1e-9", "+", "2.5E-3_f64"]);
        assert_eq!(texts("0..3"), ["0", ".", ".", "3"]);
        assert_eq!(texts("1.max(2)"), ["1", ".", "max", "(", "2", ")"]);
        assert_eq!(texts("t.0.1"), ["t", ".", "0", ".", "1"]);
        assert_eq!(texts("0xe-1"), ["0xe", "-", "1"]);
        assert_eq!(texts("1.;"), ["1.", ";"]);
    }

    #[test]
    fn lifetimes_yield_nothing() {
        assert_eq!(texts("&'static X<'_>"), ["&", "X", "<", ">"]);
    }

    #[test]
    fn groups_are_spelt_out() {
        assert_eq!(
            joined("use std::{fs, io::{self, Read as R}, time::*};"),
            [
                "use",
                "std::fs",
                "std::io::self",
                "std::io::Read",
                "std::io::as",
                "std::io::R",
                "std::time::*"
            ]
        );
        assert_eq!(joined("std :: fs\n::read(x)"), ["std::fs::read", "x"]);
    }

    #[test]
    fn members_are_told_from_functions() {
        let found = paths(&of("x.sin() + f64::cos(y)"));
        assert!(found[1].is_member && found[1].followed_by == "(");
        assert!(!found[2].is_member && found[2].segments == ["f64", "cos"]);
    }
}
