//! From the text of a scene to what it says, or to an error at a line and column.

use std::ops::Range;
use std::path::Path;

use ron::Error;
use ron::error::SpannedError;
use ron::extensions::Extensions;

use super::advice::{advised, cut_off};
use super::locate::{byte_at, field_before, tokens};
use super::problem::{SceneError, SceneProblem, located};
use super::syntax::SceneFile;
use super::whole_number;

/// How RON is read.
pub(super) fn options() -> ron::Options {
    let extensions = Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME;
    ron::Options::default().with_default_extension(extensions)
}

/// Reads the text as RON.
///
/// # Errors
///
/// What the `ron` crate says, with line and column; [`refused`] makes a scene's error of it.
pub(super) fn read(text: &str) -> Result<SceneFile, SpannedError> {
    options().from_str(text)
}

/// [`read`] with an error of scenes.
pub(super) fn parse(text: &str, path: &Path) -> Result<SceneFile, SceneError> {
    read(text).map_err(|error| {
        let problem = SceneProblem::Syntax(explained(text, &error));
        refused(text, path, &error, problem)
    })
}

/// An error at the place that the reader names.
pub(super) fn refused(
    text: &str,
    path: &Path,
    error: &SpannedError,
    problem: SceneProblem,
) -> SceneError {
    located(path, text, Some(range(text, error)), problem)
}

/// Where an error begins.
pub(super) fn start(text: &str, error: &SpannedError) -> usize {
    range(text, error).start
}

/// Where an error is.
pub(super) fn range(text: &str, error: &SpannedError) -> Range<usize> {
    let [start, end] = [error.span.start, error.span.end].map(|at| byte_at(text, at.line, at.col));
    start..end.max(start)
}

/// What is wrong, with the field if the reader does not name it, and what to write.
pub(super) fn explained(text: &str, error: &SpannedError) -> String {
    if tokens(text).is_empty() {
        return "there is no scene in the file. A scene is written in parentheses, such as \
                `(bodies: [(name: \"cube\", shape: Generator(Cuboid()))], effects: [Response()])`"
            .to_owned();
    }
    let Range { start, end } = range(text, error);
    let ends_here = tokens(&text[end..]).is_empty();
    if let Some(cut_off) = cut_off(text).filter(|_| ends_here) {
        return cut_off;
    }
    let number = whole_number::expected(text, error);
    let field = field_before(text, start).filter(|_| number.is_some() || is_of_value(&error.code));
    let said = field.map_or(String::new(), |field| format!("`{field}`: "));
    let choice = || choice_in_quotes(text, start, &error.code);
    said + &number.or_else(choice).unwrap_or_else(|| advised(&error.code))
}

/// Whether the reader speaks of a value, without naming its field.
fn is_of_value(error: &Error) -> bool {
    matches!(
        error,
        Error::Message(_)
            | Error::ExpectedIdentifier
            | Error::ExpectedInteger
            | Error::ExpectedFloat
            | Error::ExpectedBoolean
            | Error::ExpectedString
            | Error::ExpectedArray
            | Error::ExpectedMap
            | Error::IntegerOutOfBounds
    )
}

/// What to write where a choice stands in quotes.
fn choice_in_quotes(text: &str, start: usize, error: &Error) -> Option<String> {
    let token = tokens(&text[start..]).into_iter().next();
    let quoted = token.filter(|_| *error == Error::ExpectedIdentifier)?;
    let word = quoted.string.filter(|word| word.chars().all(char::is_alphanumeric))?;
    // The reader lists the choices once one stands there without quotes.
    let bare = [&text[..start], &word, &text[start + quoted.range.end..]].concat();
    match read(&bare).map_err(|error| error.code) {
        Err(Error::NoSuchEnumVariant { expected, found, .. }) if found == word => {
            let choices: Vec<_> = expected.iter().map(|choice| format!("`{choice}`")).collect();
            Some(format!("{word:?} is none of {}, written without quotes", choices.join(", ")))
        }
        _ => Some(format!("a choice is written without quotes: {word}")),
    }
}
