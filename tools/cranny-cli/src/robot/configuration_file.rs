//! Configuration files: a list of `{"joint": position}`.

use std::fmt::{self, Formatter};
use std::io;
use std::path::Path;

use cranny_scene::without_mark;
use cranny_world::description::JointPositions;
use serde::de::{self, Deserialize, Deserializer, MapAccess, Visitor};

use crate::failure::Failure;
use crate::paths::read_text;

/// What stands for standard input in place of a file.
const STANDARD_INPUT: &str = "-";

/// What a configuration file must look like, for messages.
const SHAPE: &str = "a configuration file is a list of {\"joint\": position, ...}, positions being radians, or metres for prismatic joints";

/// Reads every configuration of a file. Whether the robot has such joints is the robot's to say.
///
/// # Errors
///
/// A missing file, or text of another shape, with line and column.
pub(super) fn read_configurations(path: &Path) -> Result<Vec<JointPositions>, Failure> {
    let text = match path.to_str() {
        Some(STANDARD_INPUT) => io::read_to_string(io::stdin()).map_err(|error| {
            Failure::run(format!("{} cannot be read ({error}). Name a file.", named(path)))
        })?,
        _ => read_text("configuration file", path)?,
    };
    parse(&text).map_err(|what| Failure::input(format!("{}: {what}; {SHAPE}.", named(path))))
}

/// What messages call the file.
pub(super) fn named(path: &Path) -> String {
    match path.to_str() {
        Some(STANDARD_INPUT) => "standard input".to_owned(),
        _ => format!("configuration file {}", path.display()),
    }
}

fn parse(text: &str) -> Result<Vec<JointPositions>, String> {
    if without_mark(text).trim_start().starts_with('{') {
        return Err("it begins with `{`: one configuration, where a list is wanted. Put it in brackets, as [{...}]".to_owned());
    }
    let configurations: Vec<Configuration> =
        serde_json::from_str(without_mark(text)).map_err(|error| error.to_string())?;
    if configurations.is_empty() {
        return Err("the list is empty: give at least one configuration".to_owned());
    }
    Ok(configurations.into_iter().map(|configuration| configuration.0).collect())
}

/// Positions by joint, each named once: of two, JSON readers take the last one.
struct Configuration(JointPositions);

impl<'de> Deserialize<'de> for Configuration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ConfigurationVisitor)
    }
}

struct ConfigurationVisitor;

impl<'de> Visitor<'de> for ConfigurationVisitor {
    type Value = Configuration;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("a configuration, {\"joint\": position, ...}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Configuration, A::Error> {
        let mut positions = JointPositions::new();
        while let Some((joint, position)) = map.next_entry::<String, f64>()? {
            if let Some(first) = positions.insert(joint.clone(), position) {
                let what = format!(
                    "the joint {joint:?} is named twice, with {first} and {position}. Keep one"
                );
                return Err(de::Error::custom(what));
            }
        }
        Ok(Configuration(positions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn configurations_are_read_and_what_is_none_is_refused_with_its_place() {
        let read = parse("[{}, {\"elbow\": 1.5, \"wrist\": -2}]").unwrap();
        assert_eq!((read.len(), read[1]["wrist"]), (2, -2.0));
        for (text, says) in [
            ("", "line 1 column 0"),
            ("[]", "at least one"),
            ("{}", "one configuration, where a list is wanted. Put it in brackets"),
            ("[{\"elbow\":\n\"bent\"}]", "line 2"),
            ("[{\"elbow\": 1e999}]", "out of range"),
            ("[{},\n{\"a\": 1, \"b\": 0, \"a\": 2}]", "\"a\" is named twice, with 1 and 2. Keep"),
            ("[{},\n{\"a\": 1, \"a\": 1}]", "line 2"),
            ("[3]", "expected a configuration"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
