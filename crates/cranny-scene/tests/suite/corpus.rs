//! Real meshes and robots, where `CRANNY_CORPUS` names their folder.

use std::path::Path;

use crate::corpus_files::{corpus, files_under, mesh_files};
use crate::meeting;
use cranny_concavity::Concavities;
use cranny_concavity::ConcavityKind;
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_scene::{Robot, read_mesh, read_robot};
use cranny_world::Wanted;
use cranny_world::description::JointPositions;
use serde_json::Value;

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Faces with three different corner positions: what the corpus counts.
fn proper_faces(mesh: &Mesh) -> usize {
    let at = |i: u32| mesh.vertices()[i as usize];
    let proper = |&&[a, b, c]: &&[u32; 3]| at(a) != at(b) && at(b) != at(c) && at(c) != at(a);
    mesh.faces().iter().filter(proper).count()
}

#[test]
fn every_mesh_of_the_corpus_loads() {
    for path in mesh_files() {
        let read = read_mesh(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(!read.mesh.faces().is_empty());
    }
}

#[test]
fn concavities_of_the_corpus_keep_their_invariants() {
    for path in mesh_files() {
        let mesh = read_mesh(&path).unwrap().mesh;
        let Ok((model, report)) = Model::build(mesh, &BuildOptions::default()) else { continue };
        let all = Concavities::of(&model);
        let (hull, features) = (model.hull(), all.features());
        let name = path.display();
        let checked = features
            .validate(model.mesh(), model.topology())
            .and_then(|()| all.validate(model.mesh(), model.topology(), hull, features));
        checked.unwrap_or_else(|broken| panic!("{name}: {broken}"));
        let kinds = |kind| all.iter().filter(|c| c.kind == kind).count();
        eprintln!(
            "{name}: {} faces, closed: {}; {} convex sets; {} pockets, {} passages, {} voids, \
             {} islands, {} openings, {} overlays; {} cap triangles, {} of skin, {} negative; {} facets crossed",
            report.faces,
            report.closed,
            features.convex_sets().len(),
            kinds(ConcavityKind::Pocket),
            kinds(ConcavityKind::Passage),
            kinds(ConcavityKind::Void),
            kinds(ConcavityKind::Island),
            kinds(ConcavityKind::Opening),
            kinds(ConcavityKind::Overlay),
            all.cap_count(),
            all.skin().caps,
            all.negative_caps().len(),
            all.crossed_facets().len(),
        );
        if let Some(volume) = report.volume {
            let pockets: f64 = all.iter().map(|c| c.measures.pocket_volume).sum();
            let missing = hull.volume() - volume - pockets - all.skin().volume;
            assert!(missing.abs() <= 1e-11 * hull.volume(), "{name}: {missing:e}");
            let (skin, layer) = (all.skin(), features.slab_depth() * hull.area());
            assert!(skin.volume.abs() <= layer, "{name}: {skin:?}, a layer {layer:e}");
        }
    }
}

#[test]
fn face_counts_are_those_of_the_expected_answers() {
    let Some(corpus) = corpus() else { return };
    let answers =
        files_under(&corpus.join("expected"), &|path| path.extension() == Some("json".as_ref()));
    assert_eq!(answers.len(), 6);
    for path in answers {
        let pair = json(&path);
        for (file, side) in [("a", "A"), ("b", "B")] {
            let name = pair[file].as_str().unwrap();
            let mesh = read_mesh(&corpus.join(name)).unwrap().mesh;
            assert_eq!(proper_faces(&mesh) as u64, pair[side]["tris"].as_u64().unwrap(), "{name}");
        }
    }
}

#[test]
fn the_staircase_stands_as_its_nodes_place_it() {
    let Some(corpus) = corpus() else { return };
    let read = read_mesh(&corpus.join("coal/staircases_koroibot_hr.dae")).unwrap();
    // Metres, z up, as filed: nothing was turned or scaled.
    assert!(read.notes.iter().all(|note| !note.contains("turned") && !note.contains("multiplied")));
    let bounds = read.mesh.bounds();
    let [low, high] = STAIRCASE.map(DVec3::from_array);
    assert!((bounds.min - low).abs().max_element() < 1e-12, "{bounds:?}");
    assert!((bounds.max - high).abs().max_element() < 1e-12, "{bounds:?}");
}

/// Least and greatest corner of the staircase: 69 instances under their node matrices, multiplied
/// out by another program.
const STAIRCASE: [[f64; 3]; 2] =
    [[-2.2775, -0.3000000218557, 0.0], [2.75, 1.7000000218557, 1.25167506]];

#[test]
fn robots_load_with_the_links_and_pairs_expected() {
    let Some(corpus) = corpus() else { return };
    for name in ["panda", "go2"] {
        let expected = json(&corpus.join(format!("robots/{name}.expected.json")));
        let urdf = corpus
            .join(format!("robots/example-robot-data/robots/{name}_description/urdf/{name}.urdf"));
        let robot = read_robot(&urdf).unwrap();
        let meshes = robot.links.iter().filter_map(|link| link.collision.as_ref());
        let (links, triangles) =
            meshes.fold((0, 0), |(n, t), mesh| (n + 1, t + mesh.faces().len()));
        assert_eq!(links, expected["links_with_collision"].as_u64().unwrap());
        assert_eq!(triangles as u64, expected["tris"].as_u64().unwrap(), "{name}");
        let mut adjacent: Vec<[String; 2]> = robot
            .adjacent_links()
            .iter()
            .map(|&(a, b)| {
                let mut pair = [a, b].map(|i| robot.links[i].name.clone());
                pair.sort();
                pair
            })
            .collect();
        adjacent.sort();
        let named: Vec<[String; 2]> =
            serde_json::from_value(expected["adjacent_excluded"].clone()).unwrap();
        assert_eq!(adjacent, named);
        let mut as_they_are = robot.self_collisions(&[]).unwrap();
        for config in expected["configs"].as_array().unwrap() {
            let positions: JointPositions = serde_json::from_value(config["q"].clone()).unwrap();
            let poses = robot.forward_kinematics(&positions).unwrap();
            let hits: Vec<[String; 2]> = serde_json::from_value(config["hits"].clone()).unwrap();
            assert_eq!(meeting_links(&robot, &poses), hits, "{name} {positions:?}");
            // The same of spheres and cylinders as what they are.
            let found = as_they_are.at(&poses, Wanted::Meeting).unwrap().meeting;
            let mut named: Vec<[String; 2]> = found
                .into_iter()
                .map(|(a, b)| {
                    let mut pair = [a, b].map(|i| robot.links[i].name.clone());
                    pair.sort();
                    pair
                })
                .collect();
            named.sort();
            assert_eq!(named, hits, "{name} {positions:?}");
        }
    }
}

/// Names of the links that are not adjacent and whose collision surfaces meet, sorted.
fn meeting_links(robot: &Robot, poses: &[Pose]) -> Vec<[String; 2]> {
    let adjacent = robot.adjacent_links();
    let mut hits = Vec::new();
    for b in 0..robot.links.len() {
        for a in (0..b).filter(|&a| !adjacent.contains(&(a, b))) {
            let placed = |i: usize| Some((robot.links[i].collision.as_deref()?, &poses[i]));
            if let (Some(p), Some(q)) = (placed(a), placed(b))
                && meeting::surfaces_meet(p, q)
            {
                let mut pair = [a, b].map(|i| robot.links[i].name.clone());
                pair.sort();
                hits.push(pair);
            }
        }
    }
    hits.sort();
    hits
}

#[test]
fn an_unbound_prefix_is_mended_and_noted_with_its_line() {
    let Some(corpus) = corpus() else { return };
    let file = corpus.join("ur5e/ur5e_airo.urdf");
    // Its meshes are not in the corpus: the prefix is not what stops it.
    let missing = read_robot(&file).unwrap_err().to_string();
    assert!(missing.contains("shoulder_link") && missing.contains("collision/shoulder.obj"));
    assert!(missing.contains("32"), "{missing}");
    // Without them it is read, and says what was mended.
    let text = std::fs::read_to_string(&file).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let bare = folder.path().join("bare.urdf");
    let ball = |line: &str| match line.contains("<mesh") {
        true => "<sphere radius=\"0.1\"/>".to_owned(),
        false => line.to_owned(),
    };
    std::fs::write(&bare, text.lines().map(ball).collect::<Vec<_>>().join("\n")).unwrap();
    let robot = read_robot(&bare).expect("the prefix alone is wrong");
    let said = robot.notes.iter().find(|note| note.contains("prefix \"drake\""));
    assert!(said.is_some_and(|note| note.starts_with("line 166:")), "{:?}", robot.notes);
}
