//! Values in place of those in a scene's text: `gravity.z=-1.6`.
//!
//! A setting changes the text before it is read. So what it may say is what the text may say, the
//! reader checks it, and a recording holds the scene that ran.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

use ron::error::SpannedError;
use ron::{Error as RonError, Value};
use thiserror::Error;

use super::advice::{advised, perhaps};
use super::locate::{Token, tokens};
use super::problem::{SceneError, SceneProblem, located};
use super::reading::{explained, options, read, refused, start};
use super::syntax::{SceneFile, default_of_vector};

/// A value of a scene, in place of the one in its text or of a default: `bodies.nut.mass=Total(2)`.
///
/// A path leads from part to part: a field, an element of a list by its `name`, by its kind or by
/// its number from 0, a coordinate (`x`, `y`, `z`, `w`). Kinds of shapes are passed over
/// (`bodies.nut.shape.pitch`). A step that holds a dot stands in quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    steps: Vec<String>,
    value: String,
    /// As somebody wrote it.
    written: String,
}

/// Why a text is no [`Setting`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SettingError {
    /// There is no `=` in it.
    #[error("a setting is PATH=VALUE, such as gravity.z=-1.6")]
    NoValue,
    /// The path has a step without letters.
    #[error("the path {0:?} has an empty step: write it as in bodies.nut.material.friction")]
    EmptyStep(String),
    /// Nothing stands after the `=`.
    #[error(
        "nothing stands after `{0}=`. Write a value, as in gravity.z=-1.6; an empty text is \"\""
    )]
    Empty(String),
    /// The value is no value of a scene file.
    #[error(
        "{value} is no value: {why}. Texts stand in quotes, and the shell takes them as they are between others: 'name=\"moon\"'"
    )]
    NoSuchValue {
        /// What stands after `=`.
        value: String,
        /// What the reader says.
        why: String,
    },
}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(written: &str) -> Result<Self, SettingError> {
        let (path, value) = written.split_once('=').ok_or(SettingError::NoValue)?;
        let steps = steps(path);
        if steps.iter().any(String::is_empty) {
            return Err(SettingError::EmptyStep(path.to_owned()));
        }
        if value.trim().is_empty() {
            return Err(SettingError::Empty(path.trim().to_owned()));
        }
        let refused = |why| SettingError::NoSuchValue { value: value.trim().to_owned(), why };
        let read = options().from_str::<Value>(value);
        read.map_err(|error| refused(advised(&error.code)))?;
        Ok(Self { steps, value: without_outer_comments(value), written: written.to_owned() })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.written)
    }
}

/// Steps of a path; dots within quotes are part of a step.
fn steps(path: &str) -> Vec<String> {
    let mut steps = vec![String::new()];
    let mut quoted = false;
    for c in path.trim().chars() {
        match c {
            '"' => quoted = !quoted,
            '.' if !quoted => steps.push(String::new()),
            _ => steps.last_mut().into_iter().for_each(|step| step.push(c)),
        }
    }
    steps
}

/// A comment at the end would take what follows in the text with it.
fn without_outer_comments(value: &str) -> String {
    let tokens = tokens(value);
    let ends = tokens.first().zip(tokens.last());
    ends.map_or(String::new(), |(first, last)| value[first.range.start..last.range.end].to_owned())
}

impl Setting {
    /// The file that it is for, as the including scene names it, and the setting within: where its
    /// path begins with `includes.NAME` and leads on.
    pub(super) fn for_included(&self) -> Option<(&str, Self)> {
        match self.steps.as_slice() {
            [includes, name, rest @ ..] if includes == "includes" && !rest.is_empty() => {
                Some((name, Self { steps: rest.to_vec(), ..self.clone() }))
            }
            _ => None,
        }
    }

    /// The field of a scene that its path begins with.
    pub(super) fn field(&self) -> &str {
        &self.steps[0]
    }

    /// Its path and value, without the files that lead to it.
    pub(super) fn shown(&self) -> String {
        format!("{}={}", self.steps.join("."), self.value)
    }

    /// The text with the value in its place, and what it then says.
    ///
    /// # Errors
    ///
    /// A path that leads nowhere, with the place where it ends and a hint where else it may lead;
    /// a text that the reader refuses with the value in it.
    pub(super) fn applied(
        &self,
        text: &str,
        path: &Path,
        hint: &str,
    ) -> Result<(String, SceneFile), SceneError> {
        let tokens = tokens(text);
        let mut part = Part { text, tokens: value_of_file(text, &tokens) };
        let mut added = None;
        for (depth, step) in self.steps.iter().enumerate() {
            part = part.within_kinds();
            match part.find(step) {
                Some(found) => part = found,
                None => {
                    let addition = self.addition(part, depth);
                    let (at, addition) = addition.map_err(|what| {
                        located(path, text, Some(part.range()), self.problem(what + hint))
                    })?;
                    added = Some(Added { depth, at, addition });
                    break;
                }
            }
        }
        let changed = match &added {
            Some(Added { at, addition, .. }) => replaced(text, *at..*at, addition),
            None => replaced(text, part.range(), &self.value),
        };
        match read(&changed) {
            Ok(scene) => Ok((changed, scene)),
            Err(error) => {
                if let Some(added) = &added
                    && let Some(what) = self.unknown_field(&error.code, added)
                {
                    return Err(located(path, text, Some(part.range()), self.problem(what)));
                }
                let what =
                    added.and_then(|added| self.explained_addition(&changed, &error, &added));
                let what = what.unwrap_or_else(|| explained(&changed, &error));
                Err(refused(&changed, path, &error, self.problem(what)))
            }
        }
    }

    /// What the reader says of a step that no value has, with the path that leads to it.
    fn unknown_field(&self, error: &RonError, Added { depth, .. }: &Added) -> Option<String> {
        let RonError::NoSuchStructField { expected, found, .. } = error else { return None };
        let at = depth + self.steps[*depth..].iter().position(|step| step == found)?;
        let perhaps = perhaps(found, expected.iter().copied());
        let fields: Vec<_> = expected.iter().map(|field| format!("`{field}`")).collect();
        Some(format!(
            "{} has no field `{found}`{perhaps}. Its fields are {}",
            self.whole(at),
            fields.join(", ")
        ))
    }

    /// What the steps up to one lead to.
    fn whole(&self, depth: usize) -> String {
        match self.steps[..depth].join(".") {
            path if path.is_empty() => "the scene".to_owned(),
            path => format!("`{path}`"),
        }
    }

    /// Why the reader refuses fields that are not in the file, where it knows their names and has
    /// not come to the value: what they are in is no whole without others.
    fn explained_addition(
        &self,
        text: &str,
        error: &SpannedError,
        Added { depth, at, addition }: &Added,
    ) -> Option<String> {
        let inner = &self.steps[depth + 1..];
        let of_value =
            addition.rfind(&self.value).is_some_and(|value| at + value <= start(text, error));
        let is_unknown = matches!(error.code, RonError::NoSuchStructField { .. });
        if inner.is_empty() || of_value || is_unknown {
            return None;
        }
        let (whole, inner) = (self.steps[..=*depth].join("."), inner.join("."));
        Some(format!(
            "`{whole}` is not in the file, and its `{inner}` cannot be set alone. Set all of it: {whole}=…"
        ))
    }

    /// What is inserted, and where, for a step that the part does not have.
    fn addition(&self, part: Part<'_>, depth: usize) -> Result<(usize, String), String> {
        let (step, whole) = (&self.steps[depth], self.whole(depth));
        let Some(parts) = part.parts() else {
            return Err(format!("{whole} is {}, which has no `{step}`", part.shown()));
        };
        let takes_fields = parts.opening != "[" && parts.list.iter().all(|(key, _)| key.is_some());
        if !takes_fields {
            let known = parts.names();
            let perhaps = perhaps(step, known.iter().map(String::as_str));
            return Err(format!("{whole} has no `{step}`{perhaps}. {}", listed(&known)));
        }
        let key = if parts.opening == "{" { format!("{step:?}") } else { step.clone() };
        Ok((parts.begin, format!("{key}: {}, ", self.value_of(step, &self.steps[depth + 1..])?)))
    }

    /// The value of a field that is not in the text: the setting's, in the fields that lead there.
    /// Where a name is wrong, the reader says so.
    fn value_of(&self, field: &str, inner: &[String]) -> Result<String, String> {
        match (inner, default_of_vector(field)) {
            ([], _) => Ok(self.value.clone()),
            ([step], Some(vector)) => {
                let mut numbers = vector.to_array().map(|number| format!("{number:?}"));
                let number = coordinate(step).and_then(|axis| numbers.get_mut(axis));
                *number.ok_or_else(|| format!("`{field}` has no `{step}`. It has x, y, z"))? =
                    self.value.clone();
                Ok(format!("({})", numbers.join(", ")))
            }
            ([next, inner @ ..], _) => Ok(format!("({next}: {})", self.value_of(next, inner)?)),
        }
    }

    /// An error that the text has with this setting, and not without.
    pub(super) fn blamed(&self, error: SceneError) -> SceneError {
        match error {
            SceneError::Invalid(mut located) => {
                located.problem = self.problem(located.problem.to_string());
                SceneError::Invalid(located)
            }
            unreadable => unreadable,
        }
    }

    pub(super) fn problem(&self, what: String) -> SceneProblem {
        SceneProblem::Setting { setting: self.written.clone(), what }
    }
}

impl Parts<'_> {
    /// What its elements are called; numbers in parentheses are coordinates.
    fn names(&self) -> Vec<String> {
        let is_vector = self.opening == "("
            && self.list.len() <= COORDINATES.len()
            && self.list.iter().all(|(_, part)| {
                part.tokens.iter().all(|token| token.string.is_none()) && part.parts().is_none()
            });
        match is_vector {
            true => COORDINATES[..self.list.len()].iter().map(|&axis| axis.to_owned()).collect(),
            false => self.list.iter().map(|(_, part)| part.name()).collect(),
        }
    }
}

fn replaced(text: &str, range: Range<usize>, with: &str) -> String {
    [&text[..range.start], with, &text[range.end..]].concat()
}

/// The fields that the text of a scene states.
pub(super) fn stated_fields(text: &str) -> Vec<String> {
    let tokens = tokens(text);
    let parts = Part { text, tokens: value_of_file(text, &tokens) }.parts();
    let list = parts.map_or_else(Vec::new, |parts| parts.list);
    list.iter().filter_map(|(key, _)| key.map(str::to_owned)).collect()
}

/// The value of a file, without the attributes before it.
fn value_of_file<'a>(text: &str, mut tokens: &'a [Token]) -> &'a [Token] {
    while tokens.first().is_some_and(|token| &text[token.range.clone()] == "#") {
        let end = tokens.iter().position(|token| &text[token.range.clone()] == "]");
        tokens = end.map_or(&[], |end| &tokens[end + 1..]);
    }
    tokens
}

const COORDINATES: [&str; 4] = ["x", "y", "z", "w"];

/// The number of a coordinate.
fn coordinate(step: &str) -> Option<usize> {
    COORDINATES.iter().position(|&axis| axis == step)
}

fn listed(names: &[String]) -> String {
    /// Enough to see a typing error.
    const NAMED: usize = 8;
    match names.len() {
        0 => "It is empty".to_owned(),
        n if n > NAMED => format!("It has {} and {} more", names[..NAMED].join(", "), n - NAMED),
        _ => format!("It has {}", names.join(", ")),
    }
}

/// What is put into a text for a step that is not there.
struct Added {
    /// The number of the step.
    depth: usize,
    at: usize,
    addition: String,
}

/// A value in the text, as its tokens.
#[derive(Clone, Copy)]
struct Part<'a> {
    text: &'a str,
    tokens: &'a [Token],
}

/// What stands in the brackets of a value.
struct Parts<'a> {
    opening: &'a str,
    /// Where the first one begins, or would.
    begin: usize,
    /// Fields with their names, elements without.
    list: Vec<(Option<&'a str>, Part<'a>)>,
}

impl<'a> Part<'a> {
    fn range(&self) -> Range<usize> {
        let ends = self.tokens.first().zip(self.tokens.last());
        let end = self.text.len();
        ends.map_or(end..end, |(first, last)| first.range.start..last.range.end)
    }

    fn word(&self, index: usize) -> &'a str {
        self.tokens.get(index).map_or("", |token| &self.text[token.range.clone()])
    }

    /// The word before its brackets.
    fn kind(&self) -> Option<&'a str> {
        let word = self.word(0);
        word.starts_with(char::is_alphabetic).then_some(word)
    }

    fn parts(&self) -> Option<Parts<'a>> {
        let open = usize::from(self.kind().is_some());
        let opening = self.word(open);
        let inner = self.tokens.get(open + 1..self.tokens.len().checked_sub(1)?)?;
        if !["(", "[", "{"].contains(&opening) {
            return None;
        }
        let begin = self.tokens[open].range.end;
        let list = self.split(inner).into_iter().map(|tokens| self.with(tokens).keyed()).collect();
        Some(Parts { opening, begin, list })
    }

    fn with(&self, tokens: &'a [Token]) -> Self {
        Self { text: self.text, tokens }
    }

    /// What commas part, but for those within brackets.
    fn split(&self, tokens: &'a [Token]) -> Vec<&'a [Token]> {
        let mut depth = 0i32;
        let parted = tokens.split(|token| {
            let word = &self.text[token.range.clone()];
            depth += i32::from(matches!(word, "(" | "[" | "{"));
            depth -= i32::from(matches!(word, ")" | "]" | "}"));
            depth == 0 && word == ","
        });
        parted.filter(|part| !part.is_empty()).collect()
    }

    /// A field's name and value, or an element.
    fn keyed(self) -> (Option<&'a str>, Self) {
        match self.word(1) {
            ":" => (Some(self.word(0).trim_matches('"')), self.with(&self.tokens[2..])),
            _ => (None, self),
        }
    }

    /// Passes over kinds that hold nothing but another value: of `Generator(Cup(height: 2))` the
    /// cup is what has fields.
    fn within_kinds(self) -> Self {
        let parts = self.kind().and_then(|_| self.parts());
        match parts.as_ref().map(|parts| parts.list.as_slice()) {
            Some([(None, only)]) if only.parts().is_some() => only.within_kinds(),
            _ => self,
        }
    }

    fn find(&self, step: &str) -> Option<Self> {
        let list = self.parts()?.list;
        let field = list.iter().find(|(key, _)| *key == Some(step));
        let number = step.parse().ok().or_else(|| coordinate(step));
        let element = || {
            let unnamed = list.iter().all(|(key, _)| key.is_none());
            let named = || list.iter().find(|(_, part)| part.own_name().as_deref() == Some(step));
            let of_kind = || list.iter().find(|(_, part)| part.kind() == Some(step));
            let numbered = || list.get(number?);
            unnamed.then(|| named().or_else(of_kind).or_else(numbered)).flatten()
        };
        field.or_else(element).map(|(_, part)| *part)
    }

    /// The `name` that it states.
    fn own_name(&self) -> Option<String> {
        let list = self.within_kinds().parts()?.list;
        let (_, name) = list.iter().find(|(key, _)| *key == Some("name"))?;
        name.tokens.first()?.string.clone()
    }

    fn name(&self) -> String {
        self.own_name().or_else(|| self.kind().map(str::to_owned)).unwrap_or_else(|| self.shown())
    }

    /// Its text, if that is short.
    fn shown(&self) -> String {
        /// What a message may quote of a value.
        const QUOTED: usize = 40;
        let text = &self.text[self.range()];
        match text.char_indices().nth(QUOTED) {
            None => text.to_owned(),
            Some((end, _)) => format!("{}…", &text[..end]),
        }
    }
}
