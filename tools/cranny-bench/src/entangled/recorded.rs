//! Poses of our own simulations, recorded step by step.
//!
//! A revision with other contacts simulates other poses. Recordings are kept beside the build;
//! revisions that share a folder (`--recordings`) are measured on the same poses.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy_transform::components::Transform;
use cranny_ecs::{Bodies, RunOptions, SceneApp, pose_of};
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_scene::{LoadedScene, load_scene};
use cranny_world::description::{BodyKind, Effect, SceneDescription};

use super::digest::Digest;
use super::stage::Motion;

/// The scenes of the project.
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes");

/// Steps of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Excerpt {
    /// Name of the scene's file, without its ending.
    pub(super) scene: &'static str,
    /// Names of the bodies of each pair; empty: all pairs of which a body moves.
    pub(super) pairs: &'static [[&'static str; 2]],
    /// Steps before the first frame.
    pub(super) start: u64,
}

/// A folder of recordings.
#[derive(Clone, Debug)]
pub(super) struct Recordings {
    pub(super) folder: PathBuf,
    /// Whether recordings that exist are replaced.
    pub(super) anew: bool,
}

impl Recordings {
    /// Returns `target/entangled`, beside the folder of the running program.
    pub(super) fn default_folder() -> PathBuf {
        let program = std::env::current_exe().ok();
        let target = program.as_deref().and_then(|path| path.parent()?.parent());
        target.unwrap_or(Path::new(".")).join("entangled")
    }

    /// Reads the motion of an excerpt, or simulates and writes it.
    ///
    /// # Errors
    ///
    /// A scene that cannot be read or run, a folder that cannot be written.
    pub(super) fn motion(&self, excerpt: &Excerpt, frames: usize) -> Result<Motion, String> {
        let path = Path::new(SCENES).join(format!("{}.ron", excerpt.scene));
        let scene = load_scene(&path).map_err(|error| error.to_string())?;
        let bodies = scene.description.bodies.len();
        let file = self.folder.join(file_name(&scene, excerpt, frames));
        let kept = fs::read_to_string(&file).ok().filter(|_| !self.anew);
        let frames = match kept.and_then(|text| decode(&text, bodies)) {
            Some(frames) => frames,
            None => {
                let frames = simulate(&scene.description, excerpt.start, frames)?;
                fs::create_dir_all(&self.folder)
                    .and_then(|()| fs::write(&file, encode(&frames)))
                    .map_err(|error| format!("{}: {error}", file.display()))?;
                frames
            }
        };
        motion(&scene.description, excerpt, frames)
    }
}

fn file_name(scene: &LoadedScene, excerpt: &Excerpt, frames: usize) -> String {
    let mut digest = Digest::default();
    scene.source_text.bytes().for_each(|byte| digest.word(byte.into()));
    let Excerpt { scene, start, .. } = excerpt;
    format!("{scene}-{start}-{frames}-{:016x}.poses", digest.value())
}

/// Simulates a scene. Returns the poses of all bodies after each step from `start + 1` on.
fn simulate(scene: &SceneDescription, start: u64, frames: usize) -> Result<Vec<Vec<Pose>>, String> {
    let mut scene = scene.clone();
    // Effects that only report move nothing.
    scene.effects.retain(|effect| matches!(effect, Effect::Response));
    scene.duration = scene.step * (start + frames as u64) as f64;
    let mut app =
        SceneApp::new(&scene, &RunOptions::default()).map_err(|error| error.to_string())?;
    let mut recorded = Vec::with_capacity(frames);
    while recorded.len() < frames {
        app.step().map_err(|error| error.to_string())?;
        if app.steps_done() > start {
            recorded.push(poses(&app)?);
        }
    }
    Ok(recorded)
}

fn poses(app: &SceneApp) -> Result<Vec<Pose>, String> {
    let world = app.app().world();
    let bodies = world.get_resource::<Bodies>().ok_or("a scene without bodies")?;
    bodies
        .iter()
        .map(|(_, record)| world.get::<Transform>(record.entity).map(pose_of))
        .collect::<Option<_>>()
        .ok_or_else(|| "a body went away".to_owned())
}

fn motion(
    scene: &SceneDescription,
    excerpt: &Excerpt,
    frames: Vec<Vec<Pose>>,
) -> Result<Motion, String> {
    let mut meshes: Vec<&Arc<Mesh>> = Vec::new();
    let mut mesh_of = Vec::new();
    for body in &scene.bodies {
        let known = meshes.iter().position(|mesh| ***mesh == *body.collision);
        mesh_of.push(known.unwrap_or(meshes.len()));
        if known.is_none() {
            meshes.push(&body.collision);
        }
    }
    let margin = scene.effects.iter().find_map(|effect| match effect {
        Effect::Contacts { margin } => Some(*margin),
        _ => None,
    });
    let margin = margin.unwrap_or(0.0);
    Ok(Motion {
        meshes: meshes.into_iter().map(|mesh| Mesh::clone(mesh)).collect(),
        mesh_of,
        pairs: pairs(scene, excerpt)?,
        frames,
        contact_margin: margin,
        region_margin: margin,
    })
}

fn pairs(scene: &SceneDescription, excerpt: &Excerpt) -> Result<Vec<[usize; 2]>, String> {
    let find = |name: &&str| {
        let found = scene.bodies.iter().position(|body| body.name == *name);
        found.ok_or_else(|| format!("{}: no body is called {name:?}", excerpt.scene))
    };
    let mut pairs = Vec::new();
    for [a, b] in excerpt.pairs {
        let (a, b) = (find(a)?, find(b)?);
        pairs.push([a.min(b), a.max(b)]);
    }
    if excerpt.pairs.is_empty() {
        let moves = |body: usize| scene.bodies[body].kind != BodyKind::Fixed;
        let all = (0..scene.bodies.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        pairs.extend(all.filter(|&[a, b]| moves(a) || moves(b)));
    }
    Ok(pairs)
}

/// A line a frame, seven numbers a body, their bits in hexadecimal.
fn encode(frames: &[Vec<Pose>]) -> String {
    let mut text = String::new();
    for poses in frames {
        for Pose { rotation: r, translation: t } in poses {
            for x in [r.x, r.y, r.z, r.w, t.x, t.y, t.z] {
                let _ = write!(text, "{:016x} ", x.to_bits());
            }
        }
        text.push('\n');
    }
    text
}

/// Returns `None` if the text is no recording of this many bodies.
fn decode(text: &str, bodies: usize) -> Option<Vec<Vec<Pose>>> {
    let frame = |line: &str| -> Option<Vec<Pose>> {
        let numbers: Vec<f64> = line
            .split_ascii_whitespace()
            .map(|word| u64::from_str_radix(word, 16).ok().map(f64::from_bits))
            .collect::<Option<_>>()?;
        let pose = |n: &[f64]| Pose {
            rotation: DQuat::from_xyzw(n[0], n[1], n[2], n[3]),
            translation: DVec3::new(n[4], n[5], n[6]),
        };
        (numbers.len() == 7 * bodies).then(|| numbers.chunks_exact(7).map(pose).collect())
    };
    text.lines().map(frame).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOOK: Excerpt = Excerpt { scene: "hook_on_ring", pairs: &[["hook", "ring"]], start: 2 };

    #[test]
    fn recordings_are_read_back_to_the_bit() {
        let folder = std::env::temp_dir().join(format!("cranny-bench-{}", std::process::id()));
        let recordings = Recordings { folder: folder.clone(), anew: false };
        let simulated = recordings.motion(&HOOK, 3).unwrap();
        assert_eq!((simulated.frames.len(), &simulated.pairs), (3, &vec![[0, 1]]));
        assert!(simulated.frames[0][1] != simulated.frames[2][1], "the hook falls");
        let read = recordings.motion(&HOOK, 3).unwrap();
        fs::remove_dir_all(folder).unwrap();
        assert_eq!(simulated.frames, read.frames);
        assert_eq!(decode(&encode(&read.frames), 3), None);
    }

    #[test]
    fn an_unknown_body_is_named() {
        let scene = load_scene(&Path::new(SCENES).join("hook_on_ring.ron")).unwrap();
        let wrong = Excerpt { pairs: &[["hook", "eye"]], ..HOOK };
        assert!(pairs(&scene.description, &wrong).unwrap_err().contains("eye"));
    }
}
