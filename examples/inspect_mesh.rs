//! What is known of a mesh file before it moves: defects and repairs, hull, solid.
//!
//! `cargo run --example inspect_mesh --features scene [MESH]`, with .obj, .stl, .ply, .off, .gltf,
//! .glb or .dae. For a table, a picture or JSON there is the command `cranny inspect`.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to a person")]

use cranny::prelude::*;
use cranny::scene::read_mesh;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/u.obj");
    let path = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| own.to_owned()));
    match inspect(&path) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn inspect(path: &Path) -> Result<(), Box<dyn Error>> {
    let file = read_mesh(path)?;
    let options = BuildOptions { flatness: file.flatness, ..BuildOptions::default() };
    let (model, report) = Model::build(file.mesh, &options)?;

    println!("{}", path.display());
    println!(
        "{} vertices, {} faces, {} components, area {:.4}",
        report.vertices, report.faces, report.components, report.area
    );
    if let Some(filed) = &report.provenance {
        println!("filed: {} vertices, {} faces", filed.vertices, filed.faces);
    }
    for repair in report.repairs() {
        println!("repaired: {repair}");
    }
    let mut found = BTreeMap::<&str, (usize, &[&str])>::new();
    for finding in &report.findings {
        found.entry(finding.kind.name()).or_insert((0, finding.kind.limits())).0 += finding.count;
    }
    for (kind, (count, limits)) in found {
        println!("found: {count} {kind} {limits:?}");
    }
    match (model.mass_properties(), model.hull().volume()) {
        (Some(solid), hull) if hull > 0.0 => println!(
            "a solid of volume {:.4} that fills {:.1} % of its convex hull",
            solid.volume,
            100.0 * solid.volume / hull
        ),
        _ => println!("not closed: a surface, without inside, depth or mass"),
    }
    Ok(())
}
