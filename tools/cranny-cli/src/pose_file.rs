//! Pose files: a list of `{"a": M|null, "b": M|null}`.

use std::path::Path;

use cranny_exact::Pose;
use cranny_scene::without_mark;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use thiserror::Error;

use crate::failure::Failure;
use crate::paths::read_text;

/// Poses of A and B, world-from-mesh.
pub(crate) type PosePair = [Pose; 2];

/// What a pose file must look like, for messages.
const SHAPE: &str = "a pose file is a list of {\"a\": M|null, \"b\": M|null}, M being 16 numbers, row-major, world-from-mesh";

/// Reads every pose of a file. `null`, and a body that is not named, stand for the identity.
///
/// # Errors
///
/// A missing file, text that is no JSON (with line and column), another shape, or a matrix that is
/// no rigid motion (with the index of the pose).
pub(crate) fn read_poses(path: &Path) -> Result<Vec<PosePair>, Failure> {
    let (name, text) = (path.display(), read_text("pose file", path)?);
    let poses = parse_poses(&text)
        .map_err(|error| Failure::input(format!("pose file {name}: {error}.")))?;
    tracing::info!("{name}: {} poses", poses.len());
    Ok(poses)
}

/// What is wrong with a pose file, and where.
#[derive(Debug, Error)]
enum PoseFileError {
    #[error("the file is empty; {SHAPE}")]
    Empty,
    #[error("no JSON ({0}); {SHAPE}")]
    Json(#[from] serde_json::Error),
    #[error("{0}: give each body one pose")]
    Twice(serde_json::Error),
    #[error("found {0} where the list of poses must stand; {SHAPE}")]
    NoList(String),
    #[error("the list of poses is empty: give at least one pose")]
    NoPoses,
    #[error("pose {index}: found {found}, expected {{\"a\": M|null, \"b\": M|null}}")]
    NoPair { index: usize, found: String },
    #[error("pose {index}: unknown key {key:?}; expected \"a\" and \"b\" only")]
    UnknownKey { index: usize, key: String },
    #[error(
        "pose {index}, body {body:?}: found {found}, expected null or 16 numbers (a 4 x 4 matrix, row-major, world-from-mesh)"
    )]
    NoMatrix { index: usize, body: &'static str, found: String },
    #[error("pose {index}, body {body:?}: {source}")]
    NotRigid { index: usize, body: &'static str, source: cranny_exact::PoseError },
    #[error(
        "pose {index}, body {body:?}: the last row is {row:?} where 0, 0, 0, 1 must stand: the matrix looks column-major; write it row by row"
    )]
    ColumnMajor { index: usize, body: &'static str, row: [f64; 4] },
}

fn parse_poses(text: &str) -> Result<Vec<PosePair>, PoseFileError> {
    if text.trim().is_empty() {
        return Err(PoseFileError::Empty);
    }
    let value: Value = serde_json::from_str(without_mark(text))?;
    let Value::Array(entries) = &value else {
        return Err(PoseFileError::NoList(described(&value)));
    };
    if entries.is_empty() {
        return Err(PoseFileError::NoPoses);
    }
    let pairs = entries.iter().enumerate().map(|(index, entry)| pose_pair(index, entry));
    let pairs = pairs.collect::<Result<_, _>>()?;
    let _: Vec<Keys> = serde_json::from_str(without_mark(text)).map_err(PoseFileError::Twice)?;
    Ok(pairs)
}

/// A pose's keys. A [`Value`] keeps the last of two that are equal; this refuses them, with line
/// and column.
#[derive(Deserialize)]
struct Keys {
    #[serde(default, rename = "a")]
    _a: IgnoredAny,
    #[serde(default, rename = "b")]
    _b: IgnoredAny,
}

fn pose_pair(index: usize, entry: &Value) -> Result<PosePair, PoseFileError> {
    let Value::Object(pair) = entry else {
        return Err(PoseFileError::NoPair { index, found: described(entry) });
    };
    if let Some(key) = pair.keys().find(|key| !matches!(key.as_str(), "a" | "b")) {
        return Err(PoseFileError::UnknownKey { index, key: key.clone() });
    }
    let pose = |body| pose(index, body, pair.get(body).unwrap_or(&Value::Null));
    Ok([pose("a")?, pose("b")?])
}

fn pose(index: usize, body: &'static str, value: &Value) -> Result<Pose, PoseFileError> {
    let numbers = match value {
        Value::Null => return Ok(Pose::IDENTITY),
        Value::Array(entries) => entries.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>(),
        _ => None,
    };
    let matrix: Option<[f64; 16]> = numbers.and_then(|numbers| numbers.try_into().ok());
    let matrix =
        matrix.ok_or_else(|| PoseFileError::NoMatrix { index, body, found: described(value) })?;
    Pose::from_row_major(&matrix).map_err(|source| {
        let turned = std::array::from_fn(|i| matrix[4 * (i % 4) + i / 4]);
        match Pose::from_row_major(&turned) {
            Ok(_) => {
                let row = [matrix[12], matrix[13], matrix[14], matrix[15]];
                PoseFileError::ColumnMajor { index, body, row }
            }
            Err(_) => PoseFileError::NotRigid { index, body, source },
        }
    })
}

/// A value, in a few words.
fn described(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => format!("the number {number}"),
        Value::String(_) => "a string".to_owned(),
        Value::Array(entries) => match entries.iter().find(|entry| !entry.is_number()) {
            Some(other) => format!("a list of {} with {} in it", entries.len(), described(other)),
            None => format!("a list of {} numbers", entries.len()),
        },
        Value::Object(members) => {
            let keys: Vec<String> = members.keys().take(4).map(|key| format!("{key:?}")).collect();
            match keys.is_empty() {
                true => "an object without keys".to_owned(),
                false => format!("an object with {}", keys.join(", ")),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    const QUARTER: &str = "[0,-1,0,1.5, 1,0,0,-2, 0,0,1,0.25, 0,0,0,1]";

    fn complaint(text: &str) -> String {
        parse_poses(text).unwrap_err().to_string()
    }

    #[test]
    fn matrices_are_row_major_and_null_is_the_identity() {
        let text = format!(r#"[{{"a": null, "b": {QUARTER}}}, {{"a": {QUARTER}}}, {{}}]"#);
        let poses = parse_poses(&text).unwrap();
        assert_eq!(poses.len(), 3);
        let b = poses[0][1].world_from_body();
        assert_eq!(b.apply(DVec3::X), DVec3::new(1.5, -1.0, 0.25));
        assert_eq!(poses[0][0], Pose::IDENTITY);
        assert_eq!(poses[1], [poses[0][1], Pose::IDENTITY]);
        assert_eq!(poses[2], [Pose::IDENTITY; 2]);
    }

    #[test]
    fn a_byte_order_mark_is_passed_over() {
        assert_eq!(parse_poses("\u{feff}[{}]").unwrap(), [[Pose::IDENTITY; 2]]);
    }

    #[test]
    fn a_matrix_written_column_by_column_is_told_as_such() {
        let text = complaint(r#"[{"b": [1,0,0,0, 0,1,0,0, 0,0,1,0, 3,0,0,1]}]"#);
        assert!(text.contains("column-major") && text.contains("3.0, 0.0, 0.0, 1.0"), "{text}");
        // Scaled as well: no rigid motion either way.
        let text = complaint(r#"[{"b": [2,0,0,0, 0,2,0,0, 0,0,2,0, 3,0,0,1]}]"#);
        assert!(!text.contains("column-major"), "{text}");
    }

    #[test]
    fn numbers_are_read_to_the_last_bit() {
        // `serde_json` misses this one, as one number in ten, without its feature
        // `float_roundtrip`.
        let text = r#"[{"b": [1,0,0,0.9796215956506859, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]"#;
        let expected: f64 = "0.9796215956506859".parse().unwrap();
        assert_eq!(parse_poses(text).unwrap()[0][1].translation.x.to_bits(), expected.to_bits());
    }

    #[test]
    fn every_other_shape_is_refused_with_its_place() {
        assert!(complaint(" \n").contains("empty"));
        assert!(complaint("[{\n \"a\": nul}]").contains("line 2"));
        assert!(complaint(r#"{"poses": []}"#).contains(r#"an object with "poses""#));
        assert!(complaint("[]").contains("at least one"));
        assert!(complaint("[null, 3]").starts_with("pose 0: found null"));
        assert!(complaint(r#"[{}, {"c": null}]"#).contains(r#"pose 1: unknown key "c""#));
        let short = complaint(r#"[{"b": [1, 2, 3]}]"#);
        assert!(short.contains(r#"pose 0, body "b": found a list of 3 numbers"#), "{short}");
        let nested = complaint(r#"[{"a": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]"#);
        assert!(nested.contains("a list of 4 with a list of 4 numbers in it"), "{nested}");
        assert!(complaint(r#"[{"a": "one"}]"#).contains("found a string"));
    }

    #[test]
    fn a_body_with_two_poses_is_refused_with_its_line() {
        let text = format!("[{{}},\n{{\"b\": null, \"a\": null, \"b\": {QUARTER}}}]");
        let complaint = complaint(&text);
        assert!(complaint.contains("duplicate field `b` at line 2"), "{complaint}");
    }

    #[test]
    fn matrices_that_scale_mirror_or_leave_the_domain_are_refused() {
        let pose = |diagonal: &str, x: &str| {
            let [a, b, c]: [&str; 3] = diagonal.split(' ').collect::<Vec<_>>().try_into().unwrap();
            complaint(&format!(r#"[{{}}, {{"b": [{a},0,0,{x}, 0,{b},0,0, 0,0,{c},0, 0,0,0,1]}}]"#))
        };
        let refused = [
            ("2 2 2", "0", "scale the mesh itself"),
            ("1.0004 1 1", "0", "seven digits"),
            ("-1 1 1", "0", "mirrors"),
            ("1 1 1", "1e200", "translation"),
        ];
        for (diagonal, x, why) in refused {
            let complaint = pose(diagonal, x);
            assert!(complaint.starts_with(r#"pose 1, body "b": "#), "{complaint}");
            assert!(complaint.contains(why), "{complaint}");
        }
        let row = complaint(r#"[{"a": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]}]"#);
        assert!(row.contains("last row [0.0, 0.0, 0.0, 2.0]"), "{row}");
    }
}
