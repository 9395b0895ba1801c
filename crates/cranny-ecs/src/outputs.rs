//! Whether outputs can be written, asked before anything is simulated.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::Path;

use crate::error::SceneAppError;

fn refused(path: &Path, error: &io::Error) -> SceneAppError {
    SceneAppError::Output { path: path.to_owned(), why: error.to_string() }
}

/// Whether a file of this name could be written: its folder exists and lets files be made. A file
/// that exists already is left as it is.
///
/// # Errors
///
/// [`SceneAppError::Output`] with the path and what the system says.
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
    OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .open(&probe)
        .and_then(|_| fs::remove_file(&probe))
        .map_err(|error| refused(path, &error))
}

/// Makes a folder, with those above it, unless it exists; and asks whether files can be made in it.
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
    fn what_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/out.mcap");
        for path in [folder.path(), &missing, Path::new("/"), Path::new("")] {
            let error = probe_file(path).unwrap_err().to_string();
            assert!(error.contains(&path.display().to_string()) && error.contains("cannot"));
        }
    }
}
