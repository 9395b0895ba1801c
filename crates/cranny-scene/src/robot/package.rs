//! Where the mesh files that a URDF names are.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The first existing file that an address can mean.
///
/// - `package://name/rest` and `model://name/rest`: going up from the URDF's folder, a folder
///   called `name` or a folder beside the way called `name`; then `name` under the folders of
///   `ROS_PACKAGE_PATH` (or one of these, where it is called so) and under `share` of those of
///   `AMENT_PREFIX_PATH`; last, `rest` under any folder of the way, for packages whose folder was
///   renamed;
/// - `file:///path`: that path;
/// - anything else without a scheme: a path from the URDF's folder.
///
/// # Errors
///
/// Every place looked at, in order.
pub(super) fn find(
    urdf: &Path,
    address: &str,
    installed: &Installed,
) -> Result<PathBuf, Vec<PathBuf>> {
    let candidates = candidates(urdf, address, installed);
    match candidates.iter().find(|path| path.is_file()) {
        Some(path) => Ok(path.clone()),
        None => Err(candidates),
    }
}

/// Folders in which packages are installed.
#[derive(Clone, Debug, Default)]
pub(super) struct Installed {
    /// Hold packages, or are packages.
    folders: Vec<PathBuf>,
}

impl Installed {
    /// What the environment of a ROS workspace says.
    pub(super) fn from_environment() -> Self {
        let paths = |name| std::env::var_os(name).unwrap_or_default();
        Self::of(&paths("ROS_PACKAGE_PATH"), &paths("AMENT_PREFIX_PATH"))
    }

    fn of(ros: &OsStr, ament: &OsStr) -> Self {
        let folders = |paths: &OsStr| std::env::split_paths(paths).collect::<Vec<_>>();
        let shares = folders(ament).into_iter().map(|prefix| prefix.join("share"));
        let all = folders(ros).into_iter().chain(shares);
        Self { folders: all.filter(|folder| !folder.as_os_str().is_empty()).collect() }
    }

    fn places(&self, name: &str, rest: &str) -> impl Iterator<Item = PathBuf> {
        self.folders.iter().flat_map(move |folder| {
            let itself = (folder.file_name() == Some(name.as_ref())).then(|| folder.join(rest));
            itself.into_iter().chain([folder.join(name).join(rest)])
        })
    }
}

fn candidates(urdf: &Path, address: &str, installed: &Installed) -> Vec<PathBuf> {
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
        places.extend(installed.places(name, rest));
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
        let find = |urdf: &Path, address: &str| find(urdf, address, &Installed::default());
        assert_eq!(find(&urdf, "package://arm_pkg/meshes/link.STL").unwrap(), mesh);
        assert_eq!(find(&urdf, "package://renamed/meshes/link.STL").unwrap(), mesh);
        assert_eq!(find(&urdf, &format!("file://{}", mesh.display())).unwrap(), mesh);
        let relative = find(&urdf, "../../meshes/link.STL").unwrap();
        assert_eq!(relative.canonicalize().unwrap(), mesh.canonicalize().unwrap());
        assert!(find(&urdf, "package://arm_pkg/meshes/other.STL").unwrap_err().len() > 3);
        assert!(find(&urdf, "https://example.org/link.stl").unwrap_err().is_empty());
    }

    #[test]
    fn packages_are_found_where_they_are_installed() {
        let root = tempfile::tempdir().unwrap();
        let urdf = root.path().join("somewhere/arm.urdf");
        let source = root.path().join("ros/src/arm_pkg/link.STL");
        let share = root.path().join("ament/share/hand_pkg/link.STL");
        for path in [&urdf, &source, &share] {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "x").unwrap();
        }
        let ros = root.path().join("ros/src");
        let ament = root.path().join("ament");
        let both = Installed::of(ros.as_os_str(), ament.as_os_str());
        assert_eq!(find(&urdf, "package://arm_pkg/link.STL", &both).unwrap(), source);
        assert_eq!(find(&urdf, "package://hand_pkg/link.STL", &both).unwrap(), share);
        let one = Installed::of(ros.join("arm_pkg").as_os_str(), "".as_ref());
        assert_eq!(find(&urdf, "package://arm_pkg/link.STL", &one).unwrap(), source);
        assert!(find(&urdf, "package://hand_pkg/link.STL", &one).is_err());
    }
}
