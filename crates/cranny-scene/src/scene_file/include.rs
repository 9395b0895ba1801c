//! Scenes within scenes: a file, and before it every file that it includes.
//!
//! Each file is read once, however often it is included. Settings are for the file that is loaded,
//! or for the one to which `includes.NAME` leads.

use std::fs;
use std::path::{Path, PathBuf};

use super::assemble::{Source, is_mesh};
use super::problem::{SceneError, SceneProblem};
use super::reading::parse;
use super::setting::{Setting, stated_fields};
use super::syntax::SceneFile;
use super::{LoadOptions, locate};
use crate::text_file::{read_text, remedy, without_mark};

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
    /// Settings for what it includes.
    handed_on: Vec<Setting>,
}

impl Sheet {
    /// Reads a text with the settings in it.
    fn read(text: &str, path: &Path, settings: &[Setting]) -> Result<Self, SceneError> {
        let mut text = without_mark(text).to_owned();
        let mut scene = parse(&text, path)?;
        let (handed_on, own): (Vec<_>, Vec<_>) =
            settings.iter().cloned().partition(|setting| setting.for_included().is_some());
        for setting in own {
            (text, scene) = setting.applied(&text, path, &hint(&scene.includes))?;
        }
        Ok(Self { path: path.to_owned(), text, scene, handed_on })
    }

    /// Fails if a setting leads to no file that it includes, or to what does not count there.
    fn check_handed_on(&self) -> Result<(), SceneError> {
        for setting in &self.handed_on {
            let Some((name, rest)) = setting.for_included() else { continue };
            let names = &self.scene.includes;
            let refused = |what: String| {
                let place = names.first().and_then(|name| locate::find_string(&self.text, name));
                self.source().error(place, setting.problem(what))
            };
            if !names.iter().enumerate().any(|include| is_named(include, name)) {
                let known: Vec<_> = names.iter().map(|name| format!("{name:?}")).collect();
                let what = match known.is_empty() {
                    true => "the scene includes no file".to_owned(),
                    false => {
                        format!("the scene includes no {name:?}. It includes {}", known.join(", "))
                    }
                };
                return Err(refused(what));
            }
            let field = rest.field();
            if !ADDED.contains(&field) {
                return Err(refused(format!(
                    "`{field}` of a file that is included does not count. Set that of the scene itself: {}",
                    rest.shown()
                )));
            }
        }
        Ok(())
    }

    /// Its settings for an included file, by the file's number.
    fn settings_for(&self, number: usize) -> Vec<Setting> {
        let include = (number, &self.scene.includes[number]);
        let handed = self.handed_on.iter().filter_map(Setting::for_included);
        handed.filter(|(name, _)| is_named(include, name)).map(|(_, rest)| rest).collect()
    }

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
    let own = Sheet::read(text, path, &options.settings)?;
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
        sheet.check_handed_on()?;
        self.open.push(place(&sheet.path));
        (0..sheet.scene.includes.len()).try_for_each(|number| self.include(sheet, number))?;
        self.open.pop();
        Ok(())
    }

    fn include(&mut self, from: &Sheet, number: usize) -> Result<(), SceneError> {
        let (name, settings) = (&from.scene.includes[number], from.settings_for(number));
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
            let Some(late) = settings.first() else { return Ok(()) };
            let what = format!(
                "{} is read before, since another file includes it. Set it by the way through that one",
                path.display()
            );
            let range = locate::find_string(&from.text, name);
            return Err(source.error(range, late.problem(what)));
        }
        let text = read_text(&path)
            .map_err(|error| refused(format!("cannot be read ({error}). {}", remedy(&error))))?;
        let sheet = Sheet::read(&text, &path, &settings)?;
        self.included_by(&sheet)?;
        self.sheets.push(sheet);
        Ok(())
    }
}

/// Whether a step of a setting's path leads to an included file: its name as the scene has it, or
/// its number.
fn is_named((number, name): (usize, &String), step: &str) -> bool {
    name == step || step.parse() == Ok(number)
}

/// Where else a part may be that a setting does not find.
fn hint(includes: &[String]) -> String {
    let first = includes.first();
    first.map_or(String::new(), |name| {
        format!(". What an included file has is set by its name: includes.{name:?}.bodies…")
    })
}

/// The one name of a file; as it is written where there is none.
fn place(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}
