//! Any faces over a few points of a lattice become a model whose every invariant holds, which comes
//! back from its bytes, and which can be queried.

#![no_main]

use cranny_fuzz::{Bytes, ask, mesh};
use cranny_concavity::Concavities;
use cranny_geometry::{BuildOptions, FaceId, Model, Repair};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut bytes = Bytes(data);
    let repair = [Repair::None, Repair::Safe, Repair::Full][bytes.byte() as usize % 3];
    let Some(mesh) = mesh(&mut bytes, 48) else { return };
    let options = BuildOptions { repair, ..BuildOptions::default() };
    let Ok((model, _)) = Model::build(mesh, &options) else { return };
    validate(&model).expect("an invariant");
    let file = model.encode();
    let back = Model::decode(&file).expect("a model that was just saved");
    assert!(back.encode() == file && back.digest() == model.digest());
    ask(&model);
});

fn validate(model: &Model) -> Result<(), String> {
    let (mesh, topology, hull) = (model.mesh(), model.topology(), model.hull());
    topology.validate(mesh)?;
    let violations = hull.validate(mesh.vertices());
    if !violations.is_empty() {
        return Err(format!("{violations:?}"));
    }
    let concavities = Concavities::of(model);
    concavities.features().validate(mesh, topology)?;
    concavities.validate(mesh, topology, hull, concavities.features())?;
    let all: Vec<FaceId> = (0..mesh.faces().len() as u32).map(FaceId).collect();
    model.tree().validate(mesh, &all)?;
    concavities.trees().validate(mesh, concavities.iter().map(|c| c.faces))?;
    model.patches().validate(mesh, topology)
}
