//! `inspect --repair`: seeded defects, refused distances, and the corpus.

use std::path::{Path, PathBuf};

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_shapes::{Cuboid, Cup};
use cranny_testkit::Rng;
use serde_json::Value;

use crate::harness::{Folder, argument, corpus, run};

fn inspected(mesh: &str, more: &[&str]) -> Value {
    run(&[&["inspect", mesh, "--format", "json"], more].concat()).json_lines().remove(0)
}

/// How many of a kind.
fn count(report: &Value, kind: &str) -> u64 {
    let of_kind = |finding: &&Value| finding["kind"] == kind;
    let findings = report["findings"].as_array().unwrap().iter().filter(of_kind);
    findings.map(|finding| finding["count"].as_u64().unwrap()).sum()
}

fn repairs(report: &Value) -> Vec<&str> {
    report["repairs"].as_array().unwrap().iter().map(|r| r["kind"].as_str().unwrap()).collect()
}

/// A box with a vertex in the middle of one side of face 0, a little off, that its neighbour lacks.
fn with_t_vertex(folder: &Folder) -> String {
    let cuboid = Cuboid { size: [2.0, 4.0, 8.0] }.build().unwrap();
    let (mut vertices, mut faces) = (cuboid.vertices().to_vec(), cuboid.faces().to_vec());
    let [a, b, c] = faces[0];
    let new = vertices.len() as u32;
    vertices.push(0.5 * (vertices[a as usize] + vertices[b as usize]) + DVec3::splat(0.001));
    faces[0] = [a, new, c];
    faces.push([new, b, c]);
    folder.mesh("cracked.obj", &Mesh::new(vertices, faces).unwrap())
}

/// Triangles of a cup, each with corners of its own that are a little off: repairs join them, and
/// leave dents in what was flat.
#[test]
fn dents_that_repairs_leave_are_told_with_the_flatness_that_undoes_them() {
    let folder = Folder::new();
    let cup = Cup::default().build().unwrap();
    let mut rng = Rng::new(5);
    let mut off = || 1e-7 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
    let corners = cup.faces().iter().flatten().map(|&v| cup.vertices()[v as usize] + off());
    let faces = (0..cup.faces().len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let soup = folder.mesh("soup.obj", &Mesh::new(corners.collect(), faces).unwrap());
    let repair = ["--repair", "safe", "--weld", "1e-6"];
    let page = run(&[&["inspect", &soup], &repair[..]].concat()).stdout;
    let (_, advice) = page.split_once("--flat ").expect("advice");
    let flat = advice.split_whitespace().next().expect("a flatness");
    let concavities = |more: &[&str]| {
        let report = inspected(&soup, &[&repair[..], more].concat());
        assert_eq!(report["closed"], true);
        report["concavities"].as_array().unwrap().len()
    };
    assert!(concavities(&[]) > 1, "no dents");
    assert_eq!(concavities(&["--flat", flat]), 1);
}

#[test]
fn a_crack_is_told_and_closed_on_demand() {
    let folder = Folder::new();
    let mesh = with_t_vertex(&folder);
    let filed = inspected(&mesh, &["--weld", "0.01"]);
    assert_eq!((&filed["closed"], &filed["weld_distance"]), (&false.into(), &0.01.into()));
    assert_eq!((count(&filed, "t_vertex"), count(&filed, "open_edge")), (1, 3));
    let reported = filed["findings"].as_array().unwrap().iter().find(|f| f["kind"] == "t_vertex");
    assert_eq!(
        (&reported.unwrap()["of"], reported.unwrap()["ids"].as_array().unwrap().len()),
        (&"vertex".into(), 3)
    );

    let mended = inspected(&mesh, &["--repair", "safe", "--weld", "0.01"]);
    assert_eq!(
        (&mended["closed"], &mended["filed_faces"], &mended["faces"]),
        (&true.into(), &13.into(), &14.into())
    );
    assert_eq!(repairs(&mended), ["split_edges"]);
    let off = mended["deviation"].as_f64().unwrap();
    assert!(off > 0.001 && off < 0.002, "{off}");
    assert_eq!(mended["repairs"][0]["moved"], off);

    let text = run(&["inspect", &mesh, "--repair", "safe", "--weld", "0.01"]).stdout;
    for words in [
        "14 (13 in the file)",
        "closed: bounds a solid",
        "edges were split at 1 vertex",
        "same place",
    ] {
        assert!(text.contains(words), "{words:?} is missing in\n{text}");
    }
    let finer = inspected(&mesh, &["--repair", "full", "--weld", "0.0001"]);
    assert_eq!((&finer["closed"], repairs(&finer).len()), (&false.into(), 0));
}

#[test]
fn distances_and_policies_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    let mesh = folder.mesh("box.obj", &Cuboid::default().build().unwrap());
    run(&["inspect", &mesh, "--weld", "1"]).assert_refused(2, &["weld distance 1.0", "--weld"]);
    for (option, value, word) in
        [("--weld", "-1", "below 0"), ("--weld", "near", "such as"), ("--repair", "most", "safe")]
    {
        let refused = run(&["inspect", &mesh, option, value]);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.stderr.contains(word) && refused.stdout.is_empty(), "{refused:?}");
    }
}
#[test]
fn the_nut_and_the_hole_close_and_the_newt_is_turned() {
    let Some(corpus) = corpus() else { return };
    let safe = |file: &str| inspected(&argument(&corpus.join(file)), &["--repair", "safe"]);
    for (file, t_vertices) in [
        ("isaac_factory/factory_nut_m12_loose_subdiv_3x.obj", 84),
        ("isaac_factory/factory_round_hole_16mm_subdiv_3x.obj", 28),
    ] {
        let filed = inspected(&argument(&corpus.join(file)), &[]);
        assert_eq!((&filed["closed"], count(&filed, "t_vertex")), (&false.into(), t_vertices));
        let mended = safe(file);
        assert_eq!(
            (&mended["closed"], &mended["oriented"]),
            (&true.into(), &true.into()),
            "{file}"
        );
        assert!(mended["volume"].as_f64().unwrap() > 0.0);
        // Coordinates have six decimals: two steps of a micrometre.
        assert_eq!(mended["weld_distance"], 2e-6);
        assert!(mended["deviation"].as_f64().unwrap() <= 8e-7, "{file}");
    }
    for policy in ["none", "safe"] {
        let newt = argument(&corpus.join("bepu/newt.obj"));
        let turned = inspected(&newt, &["--repair", policy]);
        assert_eq!(repairs(&turned), ["turned_right_side_out"]);
        assert!(turned["volume"].as_f64().unwrap() > 0.0);
    }
}

fn meshes(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match name {
            _ if path.is_dir() => meshes(&path, found),
            "obj" | "off" | "ply" | "glb" | "dae" | "stl" => found.push(path),
            _ => {}
        }
    }
}

#[test]
fn every_mesh_is_accepted_and_stays_within_the_distance() {
    let Some(corpus) = corpus() else { return };
    let mut found = Vec::new();
    for folder in ["kenney", "manifold", "npm", "pyvista", "rigid_ipc", "coal", "ur5e"] {
        meshes(&corpus.join(folder), &mut found);
    }
    assert!(found.len() > 30, "{found:?}");
    for path in found {
        let filed = inspected(&argument(&path), &[]);
        let mended = inspected(&argument(&path), &["--repair", "safe"]);
        let name = path.display();
        assert!(mended["deviation"].as_f64() <= mended["weld_distance"].as_f64(), "{name}");
        assert_eq!(mended["findings_complete"], true, "{name}");
        // A closed mesh stays closed, an open one says by its findings where and what that limits.
        assert!(mended["closed"] == true || filed["closed"] == false, "{name}");
        let loose = ["open_edge", "contradictory_edge", "non_manifold_edge"];
        let reported = loose.iter().any(|kind| count(&mended, kind) > 0);
        assert!(mended["closed"] == true || reported, "{name}");
        let open = |report: &Value| count(report, "open_edge");
        assert!(open(&mended) <= open(&filed), "{name}");
    }
}
