//! Pairs in motion as files, for `cranny accuracy` and `cranny query`: two meshes and a list of
//! poses.
//!
//! Each motion leads from apart to overlapping and back, slowly enough for memory to help.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_shapes::{GolfBall, IsoBolt, IsoNut, ShapeError, Torus};

use crate::report::{Cell, Report, Table};

/// Two meshes, the first at rest, and the second's poses.
struct ExportedMotion {
    name: &'static str,
    meshes: [Mesh; 2],
    poses: Vec<Pose>,
}

/// Writes all motions into a folder.
///
/// # Errors
///
/// Files that cannot be written.
pub(crate) fn write(folder: &Path, quick: bool) -> io::Result<Report> {
    fs::create_dir_all(folder)?;
    let frames = if quick { 60 } else { 240 };
    let mut rows = Vec::new();
    for motion in [golf_balls(frames), linked_tori(frames), nut_on_bolt(frames / 2)] {
        let motion = motion.map_err(io::Error::other)?;
        let path = |what: &str| folder.join(format!("{}-{what}", motion.name));
        for (mesh, what) in motion.meshes.iter().zip(["a.obj", "b.obj"]) {
            fs::write(path(what), obj(mesh))?;
        }
        let poses: Vec<_> = motion
            .poses
            .iter()
            .map(|pose| serde_json::json!({ "a": null, "b": pose.to_row_major() }))
            .collect();
        fs::write(path("poses.json"), serde_json::Value::Array(poses).to_string())?;
        let [a, b] = motion.meshes.each_ref().map(|m| Cell::Count(m.faces().len()));
        rows.push(vec![Cell::Text(motion.name.into()), a, b, Cell::Count(motion.poses.len())]);
    }
    let files = "for each: NAME-a.obj, NAME-b.obj, NAME-poses.json";
    Ok(Report {
        title: "Written",
        notes: vec![format!("{}: {files}", folder.display())],
        tables: vec![Table {
            title: "Motions",
            columns: vec!["name", "triangles of A", "of B", "poses"],
            rows,
        }],
    })
}

/// As OBJ; numbers read back to the bit.
fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for p in mesh.vertices() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in mesh.faces() {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}

/// From 1 to −1 and back.
fn swing(frame: usize, frames: usize) -> f64 {
    (TAU * frame as f64 / frames as f64).cos()
}

/// Balls of diameter 1, a gap of 5 % to an overlap of 2 %, spinning half a degree a frame.
fn golf_balls(frames: usize) -> Result<ExportedMotion, ShapeError> {
    let ball = GolfBall {
        triangles: 1_000,
        dimples: 36,
        radius: 0.5,
        dimple_depth: 0.015,
        ..GolfBall::default()
    };
    let mesh = ball.build()?;
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let pose = |frame| {
        let gap = 0.015 + 0.035 * swing(frame, frames);
        Pose {
            rotation: DQuat::from_axis_angle(axis, (0.5 * frame as f64).to_radians()),
            translation: (1.0 + gap) * DVec3::new(0.6, 0.64, 0.48),
        }
    };
    Ok(ExportedMotion {
        name: "golf-1k",
        meshes: [mesh.clone(), mesh],
        poses: (0..frames).map(pose).collect(),
    })
}

/// Two links of a chain: rings of diameter 1 through each other, pulled until they overlap a
/// little.
fn linked_tori(frames: usize) -> Result<ExportedMotion, ShapeError> {
    let ring =
        Torus { major_radius: 0.4, minor_radius: 0.1, major_segments: 44, minor_segments: 12 };
    let mesh = ring.build()?;
    // Wires touch where the middles are two major radii less two minor ones apart.
    let pose = |frame| {
        let pull = 0.47 - 0.14 * swing(frame, frames);
        let turn = (0.3 * frame as f64).to_radians();
        Pose {
            rotation: (DQuat::from_rotation_x(0.5 * PI) * DQuat::from_rotation_y(turn)).normalize(),
            translation: pull * DVec3::new(1.0, 0.02, 0.03),
        }
    };
    Ok(ExportedMotion {
        name: "torus-link",
        meshes: [mesh.clone(), mesh],
        poses: (0..frames).map(pose).collect(),
    })
}

/// An M16 nut screwed along its bolt, half a degree a frame, while it is shifted along the axis by
/// up to a twentieth of the pitch: more than the flanks' clearance.
fn nut_on_bolt(frames: usize) -> Result<ExportedMotion, ShapeError> {
    let (bolt, nut) = (IsoBolt::default(), IsoNut::default());
    let pitch = bolt.pitch;
    let pose = |frame| {
        let angle = (0.5 * frame as f64).to_radians();
        let shift = 0.05 * pitch * (0.5 - 0.5 * swing(frame, frames));
        Pose {
            rotation: DQuat::from_axis_angle(DVec3::Z, angle),
            translation: (12.0 + pitch * angle / TAU + shift) * DVec3::Z,
        }
    };
    Ok(ExportedMotion {
        name: "nut-on-bolt",
        meshes: [bolt.build()?, nut.build()?],
        poses: (0..frames).map(pose).collect(),
    })
}
