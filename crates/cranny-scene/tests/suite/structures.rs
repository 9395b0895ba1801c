//! Trees, patches, envelopes, model files and deformation on every mesh of the corpus, where
//! `CRANNY_CORPUS` names its folder: all formats, each mesh with its own concavities.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::OnceLock;

use crate::body::Body;
use crate::corpus_files::mesh_files;
use crate::equal;
use crate::moves;
use cranny_concavity::envelope::Probe;
use cranny_exact::{DVec3, Meeting, classify_triangles};
use cranny_geometry::FaceId;
use cranny_scene::read_mesh;
use cranny_testkit::Rng;

/// Every mesh of the corpus, prepared once for all tests.
fn models() -> &'static [(String, Body)] {
    static MODELS: OnceLock<Vec<(String, Body)>> = OnceLock::new();
    MODELS.get_or_init(|| {
        let prepared = |path: PathBuf| {
            let mesh = read_mesh(&path).unwrap().mesh;
            let (model, _) = Body::build(mesh, &equal::options()).ok()?;
            // A mesh that was turned right side out is numbered anew when it is built again.
            let again = Body::build(model.mesh().clone(), &equal::options());
            Some((path.display().to_string(), again.unwrap().0))
        };
        let files = mesh_files();
        let models: Vec<_> = files.into_iter().filter_map(prepared).collect();
        assert!(models.is_empty() || models.len() >= 59, "{}", models.len());
        models
    })
}

/// Meshes of more than 400 flat sides, most of them of two faces.
const FLAT_SIDED: [&str; 2] = ["mengerSponge3.glb", "staircases_koroibot_hr.dae"];

#[test]
fn every_structure_keeps_its_promises() {
    for (name, model) in models() {
        equal::validate(model, name);
        // Each flat side is a patch: a sponge and a flight of stairs consist of thousands and
        // hundreds of squares.
        let (count, faces) = (model.patches().len(), model.mesh().faces().len());
        let most = if FLAT_SIDED.iter().any(|part| name.ends_with(part)) { faces / 2 } else { 400 };
        assert!(count <= faces.min(most), "{name}: {count} patches");
    }
}

#[test]
fn models_come_back_from_their_files() {
    for (name, model) in models() {
        let bytes = model.encode();
        let back = Body::decode(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(back.encode() == bytes, "{name}");
    }
}

/// Faces of a concavity that are looked at one by one; of larger ones, as many at equal strides.
const FACES_LOOKED_AT: usize = 500;

/// Concavities of a mesh that are looked at: the largest by faces.
const CONCAVITIES_LOOKED_AT: usize = 8;

/// Whether the tetrahedron's surface meets the face.
fn meets(tetrahedron: &[DVec3; 4], face: &[DVec3; 3]) -> bool {
    let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    sides.iter().any(|s| classify_triangles(&s.map(|i| tetrahedron[i]), face) != Meeting::None)
}

#[test]
fn envelopes_of_a_models_concavities_miss_no_face() {
    let mut met = 0;
    for (name, model) in models() {
        let mut rng = Rng::new(17);
        let mut all: Vec<_> = model.concavities().iter().collect();
        all.sort_by_key(|c| std::cmp::Reverse(c.faces.len()));
        for concavity in all.iter().take(CONCAVITIES_LOOKED_AT).filter(|c| !c.faces.is_empty()) {
            let envelope = model.envelopes().envelope(concavity.id().index());
            let size = envelope.bounds().diagonal();
            let stride = concavity.faces.len().div_ceil(FACES_LOOKED_AT);
            let looked_at: Vec<FaceId> = concavity.faces.iter().copied().step_by(stride).collect();
            for round in 0..8 {
                let face = looked_at[rng.below(looked_at.len())];
                let reach = size * 0.5f64.powi(round);
                let mut any = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
                let at = model.mesh().triangle(face)[0] + 0.5 * reach * any();
                let tetrahedron = [0; 4].map(|_| at + reach * any());
                let mut found = BTreeSet::new();
                envelope.for_each_face(&Probe::of_points(&tetrahedron, 0.0), |f| {
                    assert!(found.insert(f), "{name}: face {} is handed over twice", f.0);
                });
                for &f in &looked_at {
                    let is_met = meets(&tetrahedron, &model.mesh().triangle(f));
                    assert!(found.contains(&f) || !is_met, "{name}: face {} is missed", f.0);
                    met += usize::from(is_met);
                }
            }
        }
    }
    assert!(models().is_empty() || met > 1000, "{met}");
}

/// Faces up to which a mesh is deformed three times; larger ones once.
const MOVED_OFTEN: usize = 1500;

#[test]
fn deformed_meshes_equal_a_rebuild() {
    let mut rng = Rng::new(13);
    for (name, model) in models() {
        let mut model = model.clone();
        let steps = if model.mesh().faces().len() <= MOVED_OFTEN { 3 } else { 1 };
        for step in 0..steps {
            let moves = moves::random_moves(model.mesh(), &mut rng);
            if model.deform(&moves).is_ok() {
                equal::assert_equals_rebuild(&model, &format!("{name} step {step}"));
            }
        }
    }
}
