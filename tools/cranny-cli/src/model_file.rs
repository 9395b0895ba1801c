//! From the name of a mesh file, or of a saved model, to a prepared model.

mod saved;

use std::path::Path;
use std::time::{Duration, Instant};

use cranny_certificate::Triangles;
use cranny_concavity::Concavities;
use cranny_concavity::Stage as ConcavityStage;
use cranny_exact::DVec3;
use cranny_geometry::{BuildError, BuildOptions, Flatness, Mesh, Model, Report, Stage};
use cranny_prover::filed;
use cranny_scene::{MeshFile, MeshFileError, is_saved_model, read_mesh};

use crate::failure::Failure;
use crate::paths::check_input;
use crate::progress;
pub(crate) use saved::save;

/// A model, where it came from and what was found on the way.
pub(crate) struct LoadedModel {
    /// The prepared model.
    pub(crate) model: Model,
    /// What was found and mended.
    pub(crate) report: Report,
    /// The format that the file has.
    pub(crate) format: &'static str,
    /// What the reader left out or changed.
    pub(crate) notes: Vec<String>,
    /// How long it took.
    pub(crate) times: Times,
}

/// Time spent on each stage.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Times {
    /// Reading and decoding the file.
    pub(crate) read: Duration,
    /// Weld, repair, adjacency.
    pub(crate) repair: Duration,
    /// Scan for findings.
    pub(crate) scan: Duration,
    /// Convex hull.
    pub(crate) hull: Duration,
    /// Which features lie on the hull.
    pub(crate) classify: Duration,
    /// Caps, concavities, boundary loops.
    pub(crate) caps: Duration,
    /// Box trees, over all faces and of each concavity, and patches.
    pub(crate) trees: Duration,
    /// Envelopes of concavities.
    pub(crate) envelopes: Duration,
}

/// Prepares the model of a mesh file, scaled about the origin, or loads a saved one.
///
/// # Errors
///
/// As [`prepare`]; a broken model file, or a scale for one.
pub(crate) fn load(path: &Path, scale: f64, options: &BuildOptions) -> Result<Model, Failure> {
    check_input("mesh file", path)?;
    match is_saved_model(path) {
        true => saved::load(path, scale, options),
        false => prepare(path, scale, options).map(|loaded| loaded.model),
    }
}

/// The triangles of a mesh file, scaled about the origin, or of a saved model: what [`load`]
/// prepares, for certificates.
///
/// # Errors
///
/// As [`load`].
pub(crate) fn triangles(path: &Path, scale: f64) -> Result<Triangles, Failure> {
    check_input("mesh file", path)?;
    Ok(filed(&match is_saved_model(path) {
        true => saved::load(path, scale, &BuildOptions::default())?.mesh().clone(),
        false => scaled(path, read_mesh(path).map_err(unreadable)?.mesh, scale)?,
    }))
}

/// [`load`], and what was found: a saved model is scanned for it.
///
/// # Errors
///
/// As [`load`].
pub(crate) fn load_with_report(
    path: &Path,
    options: &BuildOptions,
) -> Result<LoadedModel, Failure> {
    check_input("mesh file", path)?;
    match is_saved_model(path) {
        true => saved::load_with_report(path, options),
        false => prepare(path, 1.0, options),
    }
}

/// Reads a mesh file, scales it about the origin and prepares the model.
///
/// # Errors
///
/// A missing or broken file, a mesh that leaves the coordinate domain when scaled, one that has no
/// face with an area, or a weld distance that is too large for it.
fn prepare(path: &Path, scale: f64, options: &BuildOptions) -> Result<LoadedModel, Failure> {
    let waiting = progress::spinner(format!("reading {}", path.display()));
    let start = Instant::now();
    let MeshFile { mesh, format, notes, flatness, .. } = read_mesh(path).map_err(unreadable)?;
    let mut times = Times { read: start.elapsed(), ..Times::default() };
    let name = path.display();
    for note in &notes {
        tracing::info!(file = %name, "{note}");
    }
    let (vertices, faces) = (mesh.vertices().len(), mesh.faces().len());
    tracing::info!("{name}: {vertices} vertices and {faces} faces read as {}", format.name());

    waiting.set_message(format!("preparing {}", path.display()));
    let wrong = |error: BuildError| {
        let advice = match &error {
            BuildError::WeldDistance { .. } => "Choose another --weld.",
            _ => "Correct or export it again.",
        };
        Failure::input(format!("mesh file {}: {error}. {advice}", path.display()))
    };
    let mesh = scaled(path, mesh, scale)?;
    let flatness = if options.flatness == Flatness::Auto { flatness } else { options.flatness };
    let options = &BuildOptions { flatness, ..options.clone() };
    let mut stopwatch = Stopwatch::default();
    let (model, report) = Model::build_observed(mesh, options, &mut |stage| {
        stopwatch.enter(stage, &mut times);
    })
    .map_err(wrong)?;
    waiting.finish_and_clear();
    tracing::info!(
        "{name}: prepared in {:.1} ms; {}, {} findings, {} repairs",
        (start.elapsed() - times.read).as_secs_f64() * 1e3,
        if report.closed { "closed" } else { "open" },
        report.findings.len(),
        report.repairs().len(),
    );
    tracing::debug!("{name}: {times:?}");
    Ok(LoadedModel { model, report, format: format.name(), notes, times })
}

fn scaled(path: &Path, mesh: Mesh, scale: f64) -> Result<Mesh, Failure> {
    if scale == 1.0 {
        return Ok(mesh);
    }
    mesh.scaled(DVec3::splat(scale)).map_err(|error| {
        Failure::input(format!(
            "mesh file {}, scaled by {scale}: {error}. Choose another scale.",
            path.display()
        ))
    })
}

fn unreadable(error: MeshFileError) -> Failure {
    match &error {
        MeshFileError::Unreadable { source, .. } => {
            let kind = source.kind();
            Failure::unreadable(error, kind)
        }
        _ => Failure::input(error),
    }
}

impl LoadedModel {
    /// Makes the concavities, books the time on their stages, and takes their findings into the
    /// report.
    pub(crate) fn make_concavities(&mut self) -> Concavities {
        let Self { model, report, times, .. } = self;
        let mut stopwatch = Stopwatch::default();
        let concavities =
            Concavities::observed(model, Concavities::DEFAULT_LEAF_SIZE, &mut |stage| {
                stopwatch.enter_concavities(stage, times);
            });
        report.add(concavities.findings(model));
        concavities
    }
}

/// Books the time since the last stage began on it.
struct Stopwatch<S>(Option<(S, Instant)>);

impl<S> Default for Stopwatch<S> {
    fn default() -> Self {
        Self(None)
    }
}

impl Stopwatch<ConcavityStage> {
    fn enter_concavities(&mut self, stage: ConcavityStage, times: &mut Times) {
        if let Some((ended, began)) = self.0 {
            let spent = match ended {
                ConcavityStage::Classify => &mut times.classify,
                ConcavityStage::Caps => &mut times.caps,
                ConcavityStage::Trees => &mut times.trees,
                ConcavityStage::Envelopes => &mut times.envelopes,
                ConcavityStage::Done => return,
            };
            *spent += began.elapsed();
        }
        self.0 = Some((stage, Instant::now()));
    }
}

impl Stopwatch<Stage> {
    fn enter(&mut self, stage: Stage, times: &mut Times) {
        if let Some((ended, began)) = self.0 {
            let spent = match ended {
                Stage::Repair => &mut times.repair,
                Stage::Scan => &mut times.scan,
                Stage::Hull => &mut times.hull,
                Stage::Trees => &mut times.trees,
                Stage::Done => return,
            };
            *spent += began.elapsed();
        }
        self.0 = Some((stage, Instant::now()));
    }
}
