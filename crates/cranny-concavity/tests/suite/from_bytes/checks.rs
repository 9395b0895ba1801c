//! Checks of bytes: run by fuzz targets, and by tests on bytes of seeds.

use crate::body::Body;
use cranny_geometry::{BuildOptions, DeformError, FindingKind, hull};
use cranny_testkit::{Bytes, few_moves, nearly_flat_solid};

use crate::check::{built_with, check_sums};
use crate::equal::{assert_equals_rebuild, assert_tells_changes, options, validate};

/// Volumes and areas are only checked of bodies thicker than skin: of others either side lies on
/// the facets of both, and what caps cover is not always what is open. What bounds what adds up for
/// every body.
fn is_thick(model: &Body) -> bool {
    let hull = model.hull();
    hull.volume() > model.features().slab_depth() * hull.area()
}

/// A closed solid keeps every promise, volumes and areas among them, and comes back from its bytes.
pub(crate) fn nearly_flat(data: &[u8]) {
    let mesh = nearly_flat_solid(&mut Bytes(data));
    let (model, report) =
        Body::build(mesh.clone(), &BuildOptions::default()).expect("it has faces");
    let is_told = report.findings.iter().any(|f| f.kind == FindingKind::ThinBody);
    assert_eq!(is_told, !is_thick(&model) && model.hull().kind() == hull::HullKind::Volume);
    validate(&model, "a solid");
    let (built, _) = built_with(&mesh, &BuildOptions::default());
    if is_thick(&model) {
        check_sums(&built);
    }
    let file = model.encode();
    let back = Body::decode(&file).expect("a model that was just saved");
    assert!(back.encode() == file && back.digest() == model.digest());
}

/// Whatever happens to a solid's vertices, what follows equals a rebuild.
pub(crate) fn deform(data: &[u8]) {
    let mut bytes = Bytes(data);
    let steps = 1 + bytes.byte() % 4;
    let mesh = nearly_flat_solid(&mut bytes);
    let Ok((model, _)) = Body::build(mesh, &options()) else { return };
    // A mesh that was turned right side out is numbered anew when it is built again.
    let (mut model, _) = Body::build(model.mesh().clone(), &options()).expect("it was just built");
    for step in 0..steps {
        if bytes.byte() & 7 == 7 {
            model = Body::decode(&model.encode()).expect("a model that was just saved");
        }
        let moves = few_moves(model.mesh(), &mut bytes);
        let before = model.clone();
        let what = format!("step {step}");
        match model.deform(&moves) {
            Ok(change) => {
                validate(&model, &what);
                assert_equals_rebuild(&model, &what);
                assert_tells_changes(&before, &model, &change, &what);
            }
            Err(DeformError::InsideOut { .. } | DeformError::OnlyDegenerateFaces { .. }) => {
                assert!(model.is_same(&before), "{what}");
            }
            Err(error) => panic!("{what}: {error}"),
        }
    }
}
