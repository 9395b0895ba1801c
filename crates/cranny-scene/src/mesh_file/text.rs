//! Numbers from text, with their line.

use cranny_exact::DVec3;

use super::MeshFormat;
use super::problem::{DecodeError, Place, Problem};

/// The words of one line and where it is.
pub(super) struct Words<'a> {
    format: MeshFormat,
    pub(super) line: usize,
    words: std::str::SplitAsciiWhitespace<'a>,
}

impl<'a> Words<'a> {
    pub(super) fn new(format: MeshFormat, line: usize, text: &'a str) -> Self {
        Self { format, line, words: text.split_ascii_whitespace() }
    }

    pub(super) fn error(&self, problem: impl Into<Problem>) -> DecodeError {
        DecodeError { format: self.format, place: Place::Line(self.line), problem: problem.into() }
    }

    pub(super) fn malformed(&self, found: String, expected: &str) -> DecodeError {
        self.error(Problem::Malformed { found, expected: expected.to_owned() })
    }

    pub(super) fn next_word(&mut self) -> Option<&'a str> {
        self.words.next()
    }

    /// The next word as a number; `expected` says what it means.
    pub(super) fn number(&mut self, expected: &'static str) -> Result<f64, DecodeError> {
        let word = self.required(expected)?;
        word.parse().map_err(|_| self.not_a_number(word, expected))
    }

    /// The next word as a count or index.
    pub(super) fn integer(&mut self, expected: &'static str) -> Result<i64, DecodeError> {
        let word = self.required(expected)?;
        word.parse().map_err(|_| self.not_a_number(word, expected))
    }

    /// The next three words as a position.
    pub(super) fn position(&mut self) -> Result<DVec3, DecodeError> {
        Ok(DVec3::new(
            self.number("coordinate x")?,
            self.number("coordinate y")?,
            self.number("coordinate z")?,
        ))
    }

    pub(super) fn not_a_number(&self, word: &str, expected: &'static str) -> DecodeError {
        let text = word.chars().take(40).collect();
        self.error(Problem::NotANumber { text, expected })
    }

    fn required(&mut self, expected: &str) -> Result<&'a str, DecodeError> {
        self.words.next().ok_or_else(|| self.malformed("the end of the line".to_owned(), expected))
    }
}
