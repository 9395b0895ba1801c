//! `cranny check`: is a scene file right?

use cranny_ecs::{check_duration, check_effects};
use cranny_world::description::{BodyKind, Effect, SceneDescription};
use serde::Serialize;

use crate::args::{CheckArgs, Format};
use crate::failure::Failure;
use crate::output::Output;
use crate::overlaps;
use crate::scene_file::read;
use crate::simulation::failure;
use crate::words::counted;

/// What a right scene holds.
#[derive(Debug, Serialize)]
struct CheckSummary<'a> {
    version: u32,
    scene: String,
    ok: bool,
    bodies: usize,
    joints: usize,
    effects: usize,
    pairs: usize,
    cameras: usize,
    files: usize,
    notes: &'a [String],
    warnings: &'a [String],
}

/// Runs the command.
///
/// # Errors
///
/// A scene that cannot be read or is wrong; standard output that cannot be written.
pub(crate) fn check(args: &CheckArgs, format: Option<Format>) -> Result<(), Failure> {
    let mut scene = read(&args.scene, &args.set.load_options(None))?;
    overlaps::prepare(&mut scene.description);
    let what = &scene.description;
    check_effects(what).map_err(failure)?;
    check_duration(what).map_err(failure)?;
    let named = what.bodies.iter().map(|body| body.effects.len()).sum::<usize>()
        + what.pairs.iter().map(|pair| pair.effects.len()).sum::<usize>();
    let overlaps = overlaps::sentences(&overlaps::at_start(what));
    let mut warnings = [scene.warnings.clone(), overlaps].concat();
    warnings.extend(without_motion(what));
    let summary = CheckSummary {
        version: 1,
        scene: args.scene.display().to_string(),
        ok: true,
        bodies: what.bodies.len(),
        joints: what.joints.len(),
        effects: what.effects.len() + named,
        pairs: what.pairs.len(),
        cameras: what.cameras.len(),
        files: scene.files.len(),
        notes: &scene.notes,
        warnings: &warnings,
    };
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&summary),
        Format::Text => output.line(&text(&summary)),
    }
}

/// That dynamic bodies stand still, where nothing makes them respond.
fn without_motion(scene: &SceneDescription) -> Option<String> {
    let dynamic = scene.bodies.iter().filter(|body| body.kind == BodyKind::Dynamic).count();
    let responds = scene.all_effects().any(|effect| matches!(effect, Effect::Response));
    (dynamic > 0 && !responds).then(|| {
        format!(
            "no effect asks for Response(): nothing moves {}. The effects of included scenes do \
             not count",
            counted(dynamic, "Dynamic body")
        )
    })
}

fn text(summary: &CheckSummary) -> String {
    let warnings: String =
        summary.warnings.iter().map(|warning| format!("\nwarning: {warning}")).collect();
    format!(
        "ok: {}: {}, {}, {}, {}{warnings}",
        summary.scene,
        counted(summary.bodies, "body"),
        counted(summary.joints, "joint"),
        counted(summary.effects, "effect"),
        counted(summary.cameras, "camera"),
    )
}
