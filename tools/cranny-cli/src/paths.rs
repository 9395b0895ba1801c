//! Names of files, looked at before any work is done, so that all commands refuse them in the same
//! words; and folders of reports.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

use cranny_record::write_whole;

use crate::failure::Failure;

/// A file that is to be read. `what` says what it is: "mesh file".
///
/// # Errors
///
/// Where nothing stands there, or a folder.
pub(crate) fn check_input(what: &str, path: &Path) -> Result<(), Failure> {
    let name = path.display();
    if path.is_dir() {
        return Err(Failure::input(format!("{what} {name}: it is a folder. Name a file in it.")));
    }
    // Whatever else keeps it from being read is reported by who reads it.
    match path.try_exists() {
        Ok(false) => Err(Failure::input(format!(
            "{what} {name}: there is no such file. Check the name and the folder."
        ))),
        _ => Ok(()),
    }
}

/// A recording that is to be read.
///
/// # Errors
///
/// As [`check_input`], and for a scene file.
pub(crate) fn check_recording(path: &Path) -> Result<(), Failure> {
    check_input("recording", path)?;
    let is_scene = path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("ron"));
    match is_scene {
        false => Ok(()),
        true => Err(Failure::input(format!(
            "{0}: a scene file is no recording. Record a run of it with 'cranny run {0} --record run.mcap', and name run.mcap.",
            path.display()
        ))),
    }
}

/// The text of a file that is to be read. `what` says what it is: "pose file".
///
/// # Errors
///
/// As [`check_input`], and where it cannot be read or is no text.
pub(crate) fn read_text(what: &str, path: &Path) -> Result<String, Failure> {
    check_input(what, path)?;
    cranny_scene::read_text(path).map_err(|source| {
        let message = format!(
            "{what} {}: cannot be read ({source}). {}.",
            path.display(),
            cranny_scene::remedy(&source)
        );
        Failure::unreadable(message, source.kind())
    })
}

/// A file that is to be written by `option`, and must have one of the extensions by which its
/// format is known.
///
/// # Errors
///
/// Another extension is wrong input; a folder in its place or no folder around it fails the run.
pub(crate) fn check_output(option: &str, path: &Path, extensions: &[&str]) -> Result<(), Failure> {
    let name = path.display();
    let has = |known: &&str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(known));
    if path.is_dir() {
        return Err(Failure::run(format!("{option} {name}: it is a folder. Name a file in it.")));
    }
    if !extensions.iter().any(has) {
        let known: Vec<String> = extensions.iter().map(|known| format!(".{known}")).collect();
        return Err(Failure::input(format!(
            "{option} {name}: what is written is known by its name, which must end in {}.",
            known.join(" or ")
        )));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.filter(|folder| !folder.is_dir()) {
        Some(folder) => Err(Failure::run(format!(
            "{option} {name}: there is no folder {}. Create it or choose another.",
            folder.display()
        ))),
        None => Ok(()),
    }
}

/// A folder for what is written; made if it is not there.
///
/// # Errors
///
/// Where it cannot be made.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| {
        Failure::run(format!(
            "folder {}: cannot be made ({error}). Name another.",
            folder.display()
        ))
    })
}

/// Writes a file into such a folder.
///
/// # Errors
///
/// Where it cannot be written.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_whole(path, text.as_bytes()).map_err(|error| cannot_write(path, &error))
}

/// Checks that a file could be written into such a folder, and leaves everything as it is.
///
/// # Errors
///
/// Where it could not.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    let tried = match File::create_new(path) {
        Ok(_) => fs::remove_file(path),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            File::options().append(true).open(path).map(drop)
        }
        Err(error) => Err(error),
    };
    tried.map_err(|error| cannot_write(path, &error))
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::run(format!("{}: cannot be written ({error}). Name another folder.", path.display()))
}
