//! Whether outputs can be written, checked before anything is simulated.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::SceneAppError;

#[cfg(any(feature = "record", feature = "render"))]
fn refused(path: &Path, error: &std::io::Error) -> SceneAppError {
    SceneAppError::Output { path: path.to_owned(), why: error.to_string() }
}

/// Refuses outputs that would replace an input, a device, a pipe or another output.
///
/// Outputs grow under another name and are renamed, which replaces whatever stands there: an older
/// output is meant to go, nothing else is.
///
/// # Errors
///
/// [`SceneAppError::OutputInTheWay`] with the first such path.
pub fn check_outputs(outputs: &[&Path], inputs: &[&Path]) -> Result<(), SceneAppError> {
    let refused = |path: &Path, why: String| {
        Err(SceneAppError::OutputInTheWay { path: path.to_owned(), why })
    };
    let read: Vec<PathBuf> = inputs.iter().map(|path| place(path)).collect();
    let mut written: Vec<PathBuf> = Vec::new();
    for &path in outputs {
        let place = place(path);
        if let Some(input) = read.iter().position(|input| *input == place) {
            return refused(path, format!("it is the input {}", inputs[input].display()));
        }
        if written.contains(&place) {
            return refused(path, "two outputs name it".to_owned());
        }
        let stands = fs::metadata(path);
        if stands.is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return refused(path, "it is a device, a pipe or a socket, no file".to_owned());
        }
        written.push(place);
    }
    Ok(())
}

/// The one name of a file, whether it exists or only its folder does.
fn place(path: &Path) -> PathBuf {
    let absolute = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    };
    path.canonicalize().ok().or_else(absolute).unwrap_or_else(|| path.to_owned())
}

/// Whether a file of this name could be written: its folder exists and lets files be made. A file
/// that exists already is left as it is.
///
/// # Errors
///
/// [`SceneAppError::Output`] with the path and what the system says.
#[cfg(any(feature = "record", feature = "render"))]
pub(crate) fn probe_file(path: &Path) -> Result<(), SceneAppError> {
    if path.is_dir() {
        let why = "it is a folder: name a file in it".to_owned();
        return Err(SceneAppError::Output { path: path.to_owned(), why });
    }
    let Some(name) = path.file_name() else {
        let why = "it names no file".to_owned();
        return Err(SceneAppError::Output { path: path.to_owned(), why });
    };
    // Under another name, as outputs themselves are while they grow.
    let mut probe = name.to_owned();
    probe.push(".probe");
    let probe = path.with_file_name(probe);
    fs::OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .open(&probe)
        .and_then(|_| fs::remove_file(&probe))
        .map_err(|error| refused(path, &error))
}

/// Makes a folder, with those above it, unless it exists; and checks that files can be made in it.
///
/// # Errors
///
/// As [`probe_file`].
#[cfg(feature = "render")]
pub(crate) fn prepare_folder(path: &Path) -> Result<(), SceneAppError> {
    fs::create_dir_all(path).map_err(|error| refused(path, &error))?;
    probe_file(&path.join("picture")).map_err(|error| match error {
        SceneAppError::Output { why, .. } => SceneAppError::Output { path: path.to_owned(), why },
        other => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(any(feature = "record", feature = "render"))]
    #[test]
    fn a_file_that_exists_is_left_as_it_is_and_no_probe_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.mcap");
        fs::write(&path, "before").unwrap();
        probe_file(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn inputs_other_outputs_and_devices_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("scene.ron"), "()").unwrap();
        fs::write(at("old.mcap"), "before").unwrap();
        let scene = at("scene.ron");
        let inputs = [scene.as_path()];
        let why = |outputs: &[&Path]| check_outputs(outputs, &inputs).unwrap_err().to_string();
        check_outputs(&[&at("old.mcap"), &at("new.png")], &inputs).unwrap();
        let roundabout = folder.path().join("./scene.ron");
        assert!(why(&[&roundabout]).contains("is the input"));
        assert!(why(&[&at("a.mcap"), &folder.path().join("./a.mcap")]).contains("two outputs"));
        if Path::new("/dev/null").exists() {
            assert!(why(&[Path::new("/dev/null")]).contains("device"));
        }
    }

    #[cfg(any(feature = "record", feature = "render"))]
    #[test]
    fn what_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/out.mcap");
        for path in [folder.path(), &missing, Path::new("/"), Path::new("")] {
            let error = probe_file(path).unwrap_err().to_string();
            assert!(error.contains(&path.display().to_string()) && error.contains("cannot"));
        }
    }
}
