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
