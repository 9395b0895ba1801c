//! Where the mesh files that a URDF names are.

use std::path::{Path, PathBuf};

/// The first existing file that an address can mean.
///
/// - `package://name/rest` and `model://name/rest`: going up from the URDF's folder, a folder
///   called `name` or a folder beside the way called `name`; last, `rest` under any folder of the
///   way, for packages whose folder was renamed;
/// - `file:///path`: that path;
/// - anything else without a scheme: a path from the URDF's folder.
///
/// # Errors
///
/// Every place looked at, in order.
pub(super) fn find(urdf: &Path, address: &str) -> Result<PathBuf, Vec<PathBuf>> {
    let candidates = candidates(urdf, address);
    match candidates.iter().find(|path| path.is_file()) {
        Some(path) => Ok(path.clone()),
        None => Err(candidates),
    }
}

fn candidates(urdf: &Path, address: &str) -> Vec<PathBuf> {
    let folder = urdf.parent().unwrap_or(Path::new(""));
    let package = address.strip_prefix("package://").or_else(|| address.strip_prefix("model://"));
    if let Some((name, rest)) = package.and_then(|path| path.split_once('/')) {
        let mut places: Vec<PathBuf> = folder
            .ancestors()
            .flat_map(|above| {
                let itself = (above.file_name() == Some(name.as_ref())).then(|| above.join(rest));
                itself.into_iter().chain([above.join(name).join(rest)])
            })
            .collect();
        places.extend(folder.ancestors().map(|above| above.join(rest)));
        return places;
    }
    match address.strip_prefix("file://") {
        Some(path) => vec![PathBuf::from(path)],
        None if address.contains("://") => Vec::new(),
        None => vec![folder.join(address)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_found_going_up() {
        let root = tempfile::tempdir().unwrap();
        let urdf = root.path().join("arm_pkg/robots/urdf/arm.urdf");
        let mesh = root.path().join("arm_pkg/meshes/link.STL");
        for path in [&urdf, &mesh] {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "x").unwrap();
        }
        assert_eq!(find(&urdf, "package://arm_pkg/meshes/link.STL").unwrap(), mesh);
        assert_eq!(find(&urdf, "package://renamed/meshes/link.STL").unwrap(), mesh);
        assert_eq!(find(&urdf, &format!("file://{}", mesh.display())).unwrap(), mesh);
        let relative = find(&urdf, "../../meshes/link.STL").unwrap();
        assert_eq!(relative.canonicalize().unwrap(), mesh.canonicalize().unwrap());
        assert!(find(&urdf, "package://arm_pkg/meshes/other.STL").unwrap_err().len() > 3);
        assert!(find(&urdf, "https://example.org/link.stl").unwrap_err().is_empty());
    }
}
