//! What the reader of RON says about a text, with what to write instead.

use ron::Error;

/// An error of the reader in a sentence that somebody can act on.
pub(super) fn advised(error: &Error) -> String {
    match error {
        Error::SuggestRawIdentifier(found) | Error::InvalidIdentifier(found) => format!(
            "{found:?} is no name, and a choice stands here: `Name`, `Name(…)` or `Name(field: …)`, \
             as the reference of scenes (docs/scenes.md) lists them for this field"
        ),
        _ => format!("{error}{}", hint(error)),
    }
}

fn hint(error: &Error) -> &'static str {
    match error {
        Error::ExpectedStructLike => {
            ". Three numbers are written as `(0, 0, -9.81)`, a choice with parentheses, as \
             `Response()`"
        }
        Error::ExpectedStructLikeEnd | Error::ExpectedComma => {
            ". Parts are separated by commas, and numbers have a decimal point: `(0, 0, -9.81)`"
        }
        Error::ExpectedArray => ". A list is written in brackets: `[…, …]`",
        Error::ExpectedFloat | Error::ExpectedInteger => {
            ". A number is written without a unit and without quotes: `2.0`"
        }
        Error::ExpectedString => ". A text is written in quotes: `\"cup\"`",
        _ => "",
    }
}
