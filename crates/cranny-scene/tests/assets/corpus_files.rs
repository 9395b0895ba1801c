//! The files of the corpus, where `CRANNY_CORPUS` names its folder.

use std::path::{Path, PathBuf};

use cranny_scene::MeshFormat;

/// The corpus; `None`, and a word about it, where it is not there.
pub(crate) fn corpus() -> Option<PathBuf> {
    let folder = std::env::var_os("CRANNY_CORPUS").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("skipped: CRANNY_CORPUS not set");
    }
    folder
}

/// Files in and beneath a folder, sorted.
pub(crate) fn files_under(folder: &Path, accept: &dyn Fn(&Path) -> bool) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if accept(&path) {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// Every mesh file of the corpus; none where it is not there.
pub(crate) fn mesh_files() -> Vec<PathBuf> {
    let Some(corpus) = corpus() else { return Vec::new() };
    let meshes = files_under(&corpus, &|path| MeshFormat::of_path(path).is_some());
    assert!(meshes.len() >= 59, "{}", meshes.len());
    meshes
}
