//! Meshes that several tests of this crate share.

#![allow(dead_code, reason = "each test uses some of them")]

use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::Mesh;
use cranny_testkit::Rng;

/// Turned so that nothing stands along an axis; turning rounds.
pub(crate) fn turned(mesh: &Mesh) -> Mesh {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize());
    let vertices = mesh.vertices().iter().map(|&p| turn * p).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

/// Scaled about the origin.
pub(crate) fn scaled(mesh: &Mesh, factor: f64) -> Mesh {
    let vertices = mesh.vertices().iter().map(|&p| factor * p).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

/// Random faces on few vertices of a small lattice, some of them a hair off: degenerate, coincident,
/// turned around, many at an edge.
pub(crate) fn soup(rng: &mut Rng, faces: usize) -> Mesh {
    let count = 3 + faces / 2;
    let vertices = (0..count).map(|_| {
        let mut whole = || f64::from(rng.between(-2, 2));
        let p = DVec3::new(whole(), whole(), whole());
        let hair = if rng.below(4) == 0 { f64::from(rng.between(-3, 3)) * 1e-12 } else { 0.0 };
        p + DVec3::new(0.0, hair, 0.5 * hair)
    });
    let vertices = vertices.collect();
    let faces = (0..faces).map(|_| [0; 3].map(|_: u32| rng.below(count) as u32)).collect();
    Mesh::new(vertices, faces).unwrap()
}

/// The corpus's OBJ meshes (a few lines of reader: this crate opens no files), where `CRANNY_CORPUS` names its folder.
#[expect(clippy::print_stderr, reason = "a skipped test must say so")]
pub(crate) fn corpus() -> Vec<(String, Mesh)> {
    let Ok(folder) = std::env::var("CRANNY_CORPUS") else {
        eprintln!("skipped: CRANNY_CORPUS not set");
        return Vec::new();
    };
    let mut found = Vec::new();
    let mut folders = vec![std::path::PathBuf::from(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "obj") {
                let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
                let mesh = from_obj(&text);
                found.extend(mesh.map(|m| (path.display().to_string(), m)));
            }
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// Positions and fans of polygons; `None` where there are no faces.
fn from_obj(text: &str) -> Option<Mesh> {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let xyz: Vec<f64> = words.take(3).filter_map(|w| w.parse().ok()).collect();
                vertices.push(DVec3::from_slice(&xyz));
            }
            Some("f") => {
                let corner = |word: &str| {
                    let index: i64 = word.split('/').next()?.parse().ok()?;
                    let from_start =
                        if index < 0 { vertices.len() as i64 + index } else { index - 1 };
                    u32::try_from(from_start).ok()
                };
                let corners: Vec<u32> = words.filter_map(corner).collect();
                for k in 2..corners.len() {
                    faces.push([corners[0], corners[k - 1], corners[k]]);
                }
            }
            _ => {}
        }
    }
    Mesh::new(vertices, faces).ok()
}
