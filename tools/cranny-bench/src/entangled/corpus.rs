//! Pairs of meshes of the corpus, whose folder `CRANNY_CORPUS` names.

use std::fs;
use std::path::{Path, PathBuf};

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_scene::read_mesh;
use serde_json::Value;

use super::kinematic::{Thread, Way, on_thread};
use super::stage::Motion;

/// Names the folder.
const CORPUS: &str = "CRANNY_CORPUS";

/// Scale of files in metres: peers compare lengths with constants.
const MILLIMETRES: f64 = 1e3;

/// Frames of a stroll from its middle to where it turns.
const STRIDE: usize = 20;

/// The M12 nut on its bolt, with the loose fit of its files.
pub(super) fn m12_nut(way: Way, degrees: f64, frames: usize) -> Result<Motion, String> {
    let folder = folder()?;
    let bolt = mesh(&folder, "isaac_factory/factory_bolt_m12_loose.obj", MILLIMETRES)?;
    let nut = mesh(&folder, "isaac_factory/factory_nut_m12_loose_subdiv_3x.obj", MILLIMETRES)?;
    // The nut fits between 5.05 and 5.2, where gaps of 0.03 are left.
    let thread = Thread { pitch: 1.75, radius: 6.0, start: 5.05, play: 0.1, middle: 0.075 };
    Ok(on_thread(bolt, nut, thread, way, degrees, frames))
}

/// A pair with expected answers: the second body turns to and fro about its origin, at the pose
/// that is 1e-4 of the pair's size off contact.
pub(super) fn stroll(pair: &str, degrees: f64, frames: usize) -> Result<Motion, String> {
    let folder = folder()?;
    let path = folder.join(format!("expected/{pair}.json"));
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let expected: Value =
        serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    let wrong = || format!("{}: no pair of meshes 1e-4 off contact", path.display());
    let body = |key: &str| {
        let file = expected[key].as_str().ok_or_else(wrong)?;
        let scale = expected[format!("scale_{key}")].as_f64().unwrap_or(1.0);
        mesh(&folder, file, scale * unit(file))
    };
    let near = expected["poses"].as_array().into_iter().flatten();
    let near = near.into_iter().find(|pose| pose["kind"] == "near+1e-04").ok_or_else(wrong)?;
    let rows: Vec<f64> =
        near["b"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    let rows = rows.try_into().map_err(|_| wrong())?;
    let mut middle = Pose::from_row_major(&rows).map_err(|error| error.to_string())?;
    middle.translation *= expected["a"].as_str().map_or(1.0, unit);
    let (a, b) = (body("a")?, body("b")?);
    let axis = DVec3::new(0.3, 1.0, 0.2).normalize();
    let pose = |frame: usize| {
        let turn = degrees.to_radians() * saw(frame);
        let rotation = DQuat::from_axis_angle(axis, turn) * middle.rotation;
        Pose { rotation: rotation.normalize(), ..middle }
    };
    let margin = 0.002 * b.bounds().diagonal();
    Ok(Motion::of_pair(a, b, (0..frames).map(pose).collect(), margin))
}

/// Frames away from the middle, one more or less each frame.
fn saw(frame: usize) -> f64 {
    let phase = (frame + STRIDE) % (4 * STRIDE);
    let rising = phase.min(4 * STRIDE - phase);
    rising as f64 - STRIDE as f64
}

fn folder() -> Result<PathBuf, String> {
    std::env::var_os(CORPUS).map(PathBuf::from).ok_or_else(|| format!("{CORPUS} is not set"))
}

fn unit(file: &str) -> f64 {
    if file.starts_with("isaac_factory") { MILLIMETRES } else { 1.0 }
}

fn mesh(folder: &Path, file: &str, scale: f64) -> Result<Mesh, String> {
    let read = read_mesh(&folder.join(file)).map_err(|error| error.to_string())?;
    read.mesh.scaled(DVec3::splat(scale)).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strolls_turn_where_they_end_and_never_jump() {
        assert_eq!(saw(0), 0.0);
        let way: Vec<f64> = (0..100).map(saw).collect();
        assert!(way.windows(2).all(|pair| (pair[1] - pair[0]).abs() == 1.0));
        assert!(way.contains(&20.0) && way.contains(&-20.0) && way.iter().all(|x| x.abs() <= 20.0));
    }
}
