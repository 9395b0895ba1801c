//! Configuration files: a list of `{"joint": position}`.

use std::path::Path;

use cranny_scene::without_mark;
use cranny_world::description::JointPositions;

use crate::failure::Failure;
use crate::paths::read_text;

/// What a configuration file must look like, for messages.
const SHAPE: &str = "a configuration file is a list of {\"joint\": position, ...}, positions being radians, or metres for prismatic joints";

/// Reads every configuration of a file. Whether the robot has such joints is the robot's to say.
///
/// # Errors
///
/// A missing file, or text of another shape, with line and column.
pub(super) fn read_configurations(path: &Path) -> Result<Vec<JointPositions>, Failure> {
    let (name, text) = (path.display(), read_text("configuration file", path)?);
    parse(&text)
        .map_err(|what| Failure::input(format!("configuration file {name}: {what}; {SHAPE}.")))
}

fn parse(text: &str) -> Result<Vec<JointPositions>, String> {
    let configurations: Vec<JointPositions> =
        serde_json::from_str(without_mark(text)).map_err(|error| error.to_string())?;
    if configurations.is_empty() {
        return Err("the list is empty: give at least one configuration".to_owned());
    }
    Ok(configurations)
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
            ("{}", "expected a sequence"),
            ("[{\"elbow\":\n\"bent\"}]", "line 2"),
            ("[{\"elbow\": 1e999}]", "out of range"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
