//! The source files of a crate that end up in the product.

use crate::strip::{self, Stripped};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

pub(crate) struct SourceFile {
    pub(crate) path: PathBuf,
    pub(crate) stripped: Stripped,
}

/// Every `.rs` file under `src/`, stripped, in order of paths; without the files of modules that
/// are declared `#[cfg(test)]`. None of a crate that is built from the sources of another, where
/// they are seen.
pub(crate) fn of_crate(folder: &Path) -> Result<Vec<SourceFile>, String> {
    let mut paths = Vec::new();
    if shares_sources(folder)? {
        return Ok(Vec::new());
    }
    collect(&folder.join("src"), &mut paths)?;
    paths.sort();
    let mut files = Vec::new();
    for path in paths {
        let text = std::fs::read_to_string(&path).map_err(|e| with_path(&path, &e))?;
        files.push(SourceFile { stripped: strip::strip(&text), path });
    }
    let tests: BTreeSet<PathBuf> = files.iter().flat_map(test_modules).collect();
    let is_test = |path: &Path| path.ancestors().any(|part| tests.contains(part));
    files.retain(|file| !is_test(&file.path));
    Ok(files)
}

/// Whether a crate's manifest names the sources of a crate beside it.
fn shares_sources(folder: &Path) -> Result<bool, String> {
    let manifest = folder.join("Cargo.toml");
    let text = std::fs::read_to_string(&manifest).map_err(|e| with_path(&manifest, &e))?;
    let shared = text
        .lines()
        .filter_map(|line| line.strip_prefix("path = \"../")?.strip_suffix("/src/lib.rs\""))
        .any(|name| folder.with_file_name(name).join("src").is_dir());
    Ok(shared)
}

/// The files and folders that a file's `#[cfg(test)] mod name;` may stand for.
fn test_modules(file: &SourceFile) -> Vec<PathBuf> {
    let parent = file.path.parent().unwrap_or(Path::new(""));
    let stem = file.path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("");
    let folder = match stem {
        "lib" | "main" | "mod" => parent.to_path_buf(),
        _ => parent.join(stem),
    };
    let both = |name: &String| [folder.join(format!("{name}.rs")), folder.join(name)];
    file.stripped.test_modules.iter().flat_map(both).collect()
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), String> {
    for entry in std::fs::read_dir(folder).map_err(|e| with_path(folder, &e))? {
        let path = entry.map_err(|e| with_path(folder, &e))?.path();
        if path.is_dir() {
            collect(&path, paths)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
    Ok(())
}

fn with_path(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_module_in_a_file_of_its_own_is_found_beside_its_parent() {
        let stripped = strip::strip("#[cfg(test)]\nmod tests;\n");
        let of = |path: &str| {
            test_modules(&SourceFile { path: path.into(), stripped: stripped.clone() })
        };
        assert_eq!(of("src/lib.rs")[0], Path::new("src/tests.rs"));
        assert_eq!(of("src/hull/mod.rs")[0], Path::new("src/hull/tests.rs"));
        assert_eq!(
            of("src/hull.rs"),
            [Path::new("src/hull/tests.rs"), Path::new("src/hull/tests")]
        );
    }

    #[test]
    fn this_crate_is_read_and_a_missing_one_is_an_error() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let names: Vec<_> = of_crate(here).expect("sources").into_iter().map(|f| f.path).collect();
        assert!(names.iter().any(|path| path.ends_with("src/sources.rs")), "{names:?}");
        assert!(of_crate(&here.join("missing")).is_err_and(|e| e.contains("missing")));
    }
}
