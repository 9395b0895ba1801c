//! Files that are whole or absent.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use crate::output::PARTIAL;

/// Writes a file as `PATH.partial`, and gives it its own name when it is whole and on the disk.
///
/// # Errors
///
/// What the system says where the file cannot be written or renamed. What was there before stays
/// then, and no half-written file does.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("page.html");
/// cranny_record::write_whole(&path, b"<html></html>")?;
/// assert_eq!(std::fs::read(&path)?, b"<html></html>");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_whole(path: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    let path = path.as_ref();
    let mut partial = path.as_os_str().to_owned();
    partial.push(PARTIAL);
    let partial = Path::new(&partial);
    let written = File::create(partial)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(partial, path));
    // That the rest cannot be removed is not what failed.
    written.inspect_err(|_| _ = fs::remove_file(partial))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_renamed_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken");
        fs::create_dir_all(taken.join("within")).unwrap();
        assert!(write_whole(&taken, b"text").is_err());
        assert!(taken.join("within").is_dir());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        let file = folder.path().join("file");
        for text in ["one", "two"] {
            write_whole(&file, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
