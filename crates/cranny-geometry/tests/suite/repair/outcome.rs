//! What came of preparing a mesh, in terms that tests compare.

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Tolerance};
use cranny_geometry::{BuildOptions, FaceId, FindingKind, Mesh, Model, Repair, RepairKind, Report};

pub(crate) fn built(mesh: &Mesh, repair: Repair) -> (Model, Report) {
    Model::build(mesh.clone(), &BuildOptions { repair, ..BuildOptions::default() }).unwrap()
}

pub(crate) fn within(mesh: &Mesh, repair: Repair, weld_distance: f64) -> (Model, Report) {
    let tolerance = Some(Tolerance { weld_distance });
    let options = BuildOptions { repair, tolerance, ..BuildOptions::default() };
    Model::build(mesh.clone(), &options).unwrap()
}

/// How many of each kind, but for edges within planes.
pub(crate) fn kinds(report: &Report) -> BTreeMap<&'static str, usize> {
    let mut kinds = BTreeMap::new();
    for finding in &report.findings {
        if finding.kind != FindingKind::CoplanarAdjacent {
            *kinds.entry(finding.kind.name()).or_default() += finding.count;
        }
    }
    kinds
}

pub(crate) fn repaired(report: &Report) -> Vec<(RepairKind, usize)> {
    report.repairs().iter().map(|r| (r.kind, r.count)).collect()
}

/// Every filed vertex became one as far away as repairs move, or one that no face uses.
pub(crate) fn assert_vertices_are_known(filed: &Mesh, model: &Model, report: &Report) {
    let provenance = report.provenance.as_ref().expect("built, not loaded");
    let (mut seen, mut lost) = (vec![false; model.mesh().vertices().len()], 0);
    for (old, &place) in (0..).zip(filed.vertices()) {
        let Some(vertex) = provenance.vertex(old) else {
            lost += 1;
            continue;
        };
        let off = model.mesh().position(vertex).distance(place);
        assert!(off <= report.weld_distance, "{old}: {off:e}");
        seen[vertex.index()] = true;
    }
    assert!(seen.iter().all(|&seen| seen), "a vertex from nowhere");
    let unused = (0..filed.vertices().len() as u32)
        .filter(|v| !filed.faces().iter().flatten().any(|corner| corner == v))
        .count();
    assert!(lost >= unused, "{lost} of {unused}");
    assert_eq!(provenance.vertex(filed.vertices().len() as u32), None);
}

/// How far repairs moved the surface.
pub(crate) fn deviation(report: &Report) -> f64 {
    report.provenance.as_ref().expect("built, not loaded").deviation
}

/// The corners of every face: preparation numbers vertices by their first use.
pub(crate) fn triangles(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    (0..mesh.faces().len() as u32).map(|f| mesh.triangle(FaceId(f))).collect()
}

/// Volume to a hundredth of a unit: the seeds' volumes are whole numbers.
pub(crate) fn volume(report: &Report) -> Option<f64> {
    report.volume.map(|v| (100.0 * v).round() / 100.0)
}
