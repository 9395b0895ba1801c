//! What the reader of RON says about a text, with what to write instead.

use ron::Error;

use super::locate::{line_and_column, tokens};

/// An error of the reader in a sentence that somebody can act on.
pub(super) fn advised(error: &Error) -> String {
    match error {
        Error::SuggestRawIdentifier(found) | Error::InvalidIdentifier(found) => format!(
            "{found:?} is no name, and a choice stands here: `Name`, `Name(…)` or `Name(field: …)`, \
             as the reference of scenes (docs/scenes.md) lists them for this field"
        ),
        Error::MissingStructField { field, outer } => {
            let whole = outer.as_ref().map_or(String::new(), |outer| format!("`{outer}` "));
            format!("{whole}lacks the field `{field}`, which has no default. Add `{field}: …`")
        }
        Error::NoSuchStructField { expected, found, .. }
        | Error::NoSuchEnumVariant { expected, found, .. } => {
            format!("{error}{}", perhaps(found, expected.iter().copied()))
        }
        _ => format!("{error}{}", hint(error)),
    }
}

fn hint(error: &Error) -> &'static str {
    match error {
        Error::ExpectedStructLike => {
            ". Three numbers are written as `(0, 0, -9.81)`, a choice with parentheses, as \
             `Response()`"
        }
        Error::ExpectedNamedStructLike(_) | Error::ExpectedDifferentStructName { .. } => {
            ". It is written in parentheses, with fields by name: `(step: 0.01, duration: 5)`"
        }
        Error::ExpectedStructLikeEnd | Error::ExpectedComma => {
            ". Parts are separated by commas, and numbers have a decimal point: `(0, 0, -9.81)`"
        }
        Error::ExpectedArray => ". A list is written in brackets: `[…, …]`",
        Error::ExpectedMap => ". Values by name are written in braces: `{\"elbow\": 0.5}`",
        Error::ExpectedInteger => {
            ". A whole number is wanted here, written without a point, a unit and quotes: `2`"
        }
        Error::ExpectedFloat => ". A number is written without a unit and without quotes: `2.0`",
        Error::ExpectedString => ". A text is written in quotes: `\"cup\"`",
        Error::ExpectedIdentifier => {
            ". A choice is written without quotes, as `Fixed`: the reference of scenes \
             (docs/scenes.md) lists them for this field"
        }
        Error::ExpectedStringEnd => ". The text that begins here has no closing `\"`",
        Error::UnclosedBlockComment => ". Close the comment with `*/`",
        _ => "",
    }
}

/// Which of the known names somebody may have meant, as a sentence; nothing where none is near.
pub(super) fn perhaps<'a>(found: &str, known: impl Iterator<Item = &'a str>) -> String {
    /// A name of so many letters may have one wrong. Less: short names are guessed at random.
    const LETTERS_A_SLIP: usize = 3;
    let found = found.to_lowercase();
    let slips = |name: &&str| strsim::damerau_levenshtein(&found, &name.to_lowercase());
    let is_near = |name: &&str| slips(name) <= found.len().max(name.len()) / LETTERS_A_SLIP;
    let nearest = known.min_by_key(slips).filter(is_near);
    nearest.map_or(String::new(), |name| format!(". Perhaps `{name}` is meant"))
}

/// That a text ends within brackets, where it does: a file that was cut off.
pub(super) fn cut_off(text: &str) -> Option<String> {
    let mut open = Vec::new();
    for token in tokens(text) {
        match &text[token.range.clone()] {
            opening @ ("(" | "[" | "{") => open.push((opening, token.range.start)),
            ")" | "]" | "}" => _ = open.pop(),
            _ => {}
        }
    }
    let (opening, at) = open.pop()?;
    let (line, column) = line_and_column(text, at);
    let closing = match opening {
        "(" => ")",
        "[" => "]",
        _ => "}",
    };
    Some(format!(
        "the text ends before the `{opening}` of line {line}, column {column} is closed. Close it with `{closing}`, or copy the file anew if it was cut off"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_a_slip_is_guessed_and_another_is_not() {
        let known = ["pose", "path", "gravity", "a"];
        for (found, meant) in [("poze", "pose"), ("gravtiy", "gravity"), ("POSE", "pose")] {
            let says = format!(". Perhaps `{meant}` is meant");
            assert_eq!(perhaps(found, known.into_iter()), says);
        }
        for found in ["nope", "q", "b", "velocity", ""] {
            assert_eq!(perhaps(found, known.into_iter()), "", "{found}");
        }
    }
}
