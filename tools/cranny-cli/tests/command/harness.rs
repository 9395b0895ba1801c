//! Runs the command, and writes the files that it is given.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use cranny_geometry::Mesh;
use cranny_scene::encode_obj;
use serde_json::Value;
use tempfile::TempDir;

/// What the command said.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Outcome {
    fn of(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Standard output as JSON values, one a line; the command must have succeeded.
    pub(crate) fn json_lines(&self) -> Vec<Value> {
        assert_eq!(self.code, Some(0), "{self:?}");
        self.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// Checks that the command refused with this exit code and one paragraph that says all of
    /// `words`, that nothing was printed as a result, and that nothing panicked.
    pub(crate) fn assert_refused(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert_eq!(self.stdout, "", "{self:?}");
        assert!(self.stderr.starts_with("error: "), "{self:?}");
        assert!(!self.stderr.trim_end().contains('\n'), "more than a paragraph: {self:?}");
        assert!(self.stderr.trim_end().ends_with(['.', '…']), "no full stop: {self:?}");
        assert!(!self.stderr.contains("panicked"), "{self:?}");
        for word in words {
            assert!(self.stderr.contains(word), "{word:?} is missing in {self:?}");
        }
    }
}

/// The command, in an environment of its own.
pub(crate) fn cranny() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cranny"));
    command.env_remove("RUST_LOG").env_remove("WGPU_BACKEND").stdin(Stdio::null());
    command
}

/// Runs the command.
pub(crate) fn run(arguments: &[&str]) -> Outcome {
    Outcome::of(cranny().args(arguments).output().unwrap())
}

/// Runs a prepared command.
pub(crate) fn run_command(command: &mut Command) -> Outcome {
    Outcome::of(command.output().unwrap())
}

/// A folder of input files, deleted at the end.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file and returns its path as an argument.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        std::fs::write(&path, content).unwrap();
        argument(&path)
    }

    /// Writes a mesh as OBJ, to the bit.
    pub(crate) fn mesh(&self, name: &str, mesh: &Mesh) -> String {
        self.write(name, encode_obj(mesh))
    }
}

/// A path as an argument.
pub(crate) fn argument(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

/// The folder of real meshes and robots, where there is one.
pub(crate) fn corpus() -> Option<PathBuf> {
    let corpus = std::env::var_os("CRANNY_CORPUS").map(PathBuf::from);
    if corpus.is_none() {
        println!("skipped: CRANNY_CORPUS not set");
    }
    corpus
}
