//! The invariants that hold for every body.

use cranny_exact::{DVec2, DVec3};
use cranny_geometry::concavity::ConcavityKind;
use cranny_geometry::hull::FacetId;
use cranny_geometry::{BuildOptions, FaceId, Mesh, Model};

/// Builds and validates.
pub(crate) fn checked(mesh: &Mesh) -> Model {
    checked_with(mesh, &BuildOptions::default())
}

/// [`checked`], with other options.
pub(crate) fn checked_with(mesh: &Mesh, options: &BuildOptions) -> Model {
    let (model, _) = Model::build(mesh.clone(), options).unwrap();
    model.features().validate(model.mesh(), model.topology()).unwrap();
    let (topology, hull) = (model.topology(), model.hull());
    model.concavities().validate(model.mesh(), topology, hull, model.features()).unwrap();
    covered_once(&model);
    model
}

/// As [`checked`]; and what only a closed mesh promises: volumes and areas add up, no opening.
pub(crate) fn closed_checked(mesh: &Mesh) -> Model {
    closed_checked_with(mesh, &BuildOptions::default())
}

/// [`closed_checked`], with other options.
pub(crate) fn closed_checked_with(mesh: &Mesh, options: &BuildOptions) -> Model {
    let model = checked_with(mesh, options);
    assert!(model.is_closed());
    let all = model.concavities();
    assert!(all.iter().all(|c| c.kind != ConcavityKind::Opening));
    let hull = model.hull();
    let volume = model.mass_properties().unwrap().volume;
    let area: f64 = (0..model.mesh().faces().len() as u32)
        .map(|f| model.mesh().area_vector(FaceId(f)).length())
        .sum();
    let pockets: f64 = all.iter().map(|c| c.measures.pocket_volume).sum();
    let missing = hull.volume() - volume - pockets - all.skin().volume;
    assert!(missing.abs() <= 1e-12 * hull.volume(), "volume: {missing:e}");
    let gained: f64 = all.iter().map(|c| c.measures.cap_area - c.measures.face_area).sum();
    let missing = hull.area() - area - gained - all.skin().area;
    assert!(missing.abs() <= 1e-11 * area, "area: {missing:e}");
    assert!(all.skin().volume.abs() <= 4.0 * hull.flatness() * hull.area(), "{:?}", all.skin());
    model
}

/// In the projection along its dominant axis every facet has the area of its faces and caps; or it and
/// neighbours, into which a face of it reaches, have together.
fn covered_once(model: &Model) {
    let (hull, all) = (model.hull(), model.concavities());
    let mut left: Vec<f64> = Vec::new();
    for facet in hull.facets() {
        let triangles = facet.triangles.iter().map(|&t| hull.triangle(t as usize));
        let areas = triangles.map(|t| area(facet.normal, t.map(|v| hull.position(v))));
        left.push(areas.sum());
    }
    for f in (0..model.mesh().faces().len() as u32).map(FaceId) {
        if let Some(facet) = model.features().facet_of(f) {
            left[facet.index()] -= area(hull.facet(facet).normal, model.mesh().triangle(f));
        }
    }
    for cap in all.caps() {
        let corners = cap.corners.map(|v| model.mesh().position(v));
        left[cap.facet.index()] -= area(hull.facet(cap.facet).normal, corners);
    }
    let size = hull.bounds().diagonal();
    let planar = 8.0 * (hull.flatness() + 1e-13 * size) * size;
    let is_off = |facet: FacetId| left[facet.index()].abs() > planar;
    let mut seen = vec![false; left.len()];
    for first in (0..left.len() as u32).map(FacetId).filter(|&f| is_off(f)) {
        let (mut group, mut open) = (Vec::new(), vec![first]);
        while let Some(facet) = open.pop() {
            if !std::mem::replace(&mut seen[facet.index()], true) {
                group.push(left[facet.index()]);
                open.extend(hull.facet(facet).neighbours.iter().filter(|&&f| is_off(f)));
            }
        }
        let sum: f64 = group.iter().sum();
        let bent = planar * group.len() as f64;
        assert!(
            group.is_empty() || sum.abs() <= bent,
            "about {first:?}: {sum:e} of {group:?} left"
        );
    }
}

/// Signed area in the projection along the axis nearest the normal, outside up.
fn area(normal: DVec3, corners: [DVec3; 3]) -> f64 {
    let size = normal.abs();
    let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap();
    let flat = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    let [a, b, c] = corners.map(flat);
    0.5 * (b - a).perp_dot(c - a) * normal[axis].signum()
}
