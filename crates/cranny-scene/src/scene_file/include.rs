//! Scenes within scenes: a file, and before it every file that it includes.
//!
//! Each file is read once, however often it is included. Settings are for the file that is loaded.

use std::fs;
use std::path::{Path, PathBuf};

use super::assemble::{Source, is_mesh};
use super::problem::{SceneError, SceneProblem};
use super::setting::stated_fields;
use super::syntax::{SceneFile, parse};
use super::{LoadOptions, locate};
use crate::byte_order_mark::without_mark;

/// Fields whose elements an included file adds; all others are those of the file that is loaded.
const ADDED: [&str; 7] = ["includes", "bodies", "groups", "robots", "joints", "pairs", "cameras"];

/// A scene, and the files that it includes, directly or not, each after those that it includes.
pub(super) struct Sheets {
    pub(super) own: Sheet,
    pub(super) included: Vec<Sheet>,
}

/// A file that was read, and what it says.
pub(super) struct Sheet {
    pub(super) path: PathBuf,
    pub(super) text: String,
    pub(super) scene: SceneFile,
}

impl Sheet {
    pub(super) fn source(&self) -> Source<'_> {
        Source { text: &self.text, path: &self.path }
    }

    /// What it says beside what it adds.
    pub(super) fn unheeded(&self) -> Vec<String> {
        let adds = |field: &String| ADDED.contains(&field.as_str()) || field == "version";
        stated_fields(&self.text).into_iter().filter(|field| !adds(field)).collect()
    }
}

/// Reads a scene with the settings in it, and what it includes.
///
/// # Errors
///
/// Text that is no scene; an included file that cannot be read, or that includes itself.
pub(super) fn sheets(text: &str, path: &Path, options: &LoadOptions) -> Result<Sheets, SceneError> {
    let mut text = without_mark(text).to_owned();
    let mut scene = parse(&text, path)?;
    for setting in &options.settings {
        text = setting.applied(&text, path)?;
        scene = parse(&text, path).map_err(|error| setting.blamed(error))?;
    }
    let own = Sheet { path: path.to_owned(), text, scene };
    let mut reading = Reading { sheets: Vec::new(), open: Vec::new() };
    reading.included_by(&own)?;
    Ok(Sheets { own, included: reading.sheets })
}

struct Reading {
    sheets: Vec<Sheet>,
    /// Files that include what is being read, the outermost first.
    open: Vec<PathBuf>,
}

impl Reading {
    fn included_by(&mut self, sheet: &Sheet) -> Result<(), SceneError> {
        self.open.push(place(&sheet.path));
        sheet.scene.includes.iter().try_for_each(|name| self.include(sheet, name))?;
        self.open.pop();
        Ok(())
    }

    fn include(&mut self, from: &Sheet, name: &str) -> Result<(), SceneError> {
        let source = from.source();
        let path = source.resolve(name);
        let refused = |why: String| {
            let range = locate::find_string(&from.text, name);
            source.error(range, SceneProblem::Include { path: path.clone(), why })
        };
        if is_mesh(&path) {
            return Err(refused("it is a mesh. Name it as the shape of a body".to_owned()));
        }
        if let Some(at) = self.open.iter().position(|open| *open == place(&path)) {
            let circle: Vec<_> =
                self.open[at..].iter().map(|open| open.display().to_string()).collect();
            let why = format!("it includes itself ({}). Take one of them out", circle.join(", "));
            return Err(refused(why));
        }
        if self.sheets.iter().any(|sheet| place(&sheet.path) == place(&path)) {
            return Ok(());
        }
        let text = fs::read_to_string(&path).map_err(|error| {
            refused(format!("cannot be read ({error}). Check the path and its permissions"))
        })?;
        let text = without_mark(&text).to_owned();
        let scene = parse(&text, &path)?;
        let sheet = Sheet { path: path.clone(), text, scene };
        self.included_by(&sheet)?;
        self.sheets.push(sheet);
        Ok(())
    }
}

/// The one name of a file; as it is written where there is none.
fn place(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}
