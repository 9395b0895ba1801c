//! The invariants that hold for every body.

use crate::body::Body;
use cranny_concavity::ConcavityKind;
use cranny_exact::{DVec2, DVec3};
use cranny_geometry::hull::FacetId;
use cranny_geometry::{BuildOptions, FaceId, Finding, Mesh};

/// Pairs of points and triangles up to which hulls are validated here, every pair of which is
/// looked at.
const LARGEST_HULL: usize = 4_000_000;

/// Builds and validates.
pub(crate) fn checked(mesh: &Mesh) -> Body {
    checked_with(mesh, &BuildOptions::default())
}

/// [`checked`], with other options.
pub(crate) fn checked_with(mesh: &Mesh, options: &BuildOptions) -> Body {
    let (model, _) = built_with(mesh, options);
    covered_once(&model);
    model
}

/// [`closed_checked`], and what is reported of the mesh; but whether each facet is covered once is
/// not checked.
pub(crate) fn checked_told(mesh: &Mesh) -> (Body, Vec<Finding>) {
    let (model, findings) = built_with(mesh, &BuildOptions::default());
    check_sums(&model);
    (model, findings)
}

/// Builds and validates, but whether each facet is covered once is not checked.
pub(crate) fn built_with(mesh: &Mesh, options: &BuildOptions) -> (Body, Vec<Finding>) {
    let (model, report) = Body::build(mesh.clone(), options).unwrap();
    model.features().validate(model.mesh(), model.topology()).unwrap();
    let (topology, hull) = (model.topology(), model.hull());
    let points = model.mesh().vertices();
    if points.len() * hull.triangle_count() <= LARGEST_HULL {
        assert_eq!(hull.validate(points), []);
    }
    model.concavities().validate(model.mesh(), topology, hull, model.features()).unwrap();
    (model, report.findings)
}

/// As [`checked`]; and what only a closed mesh promises: volumes and areas add up, no opening.
pub(crate) fn closed_checked(mesh: &Mesh) -> Body {
    closed_checked_with(mesh, &BuildOptions::default())
}

/// [`closed_checked`], with other options.
pub(crate) fn closed_checked_with(mesh: &Mesh, options: &BuildOptions) -> Body {
    let model = checked_with(mesh, options);
    check_sums(&model);
    model
}

/// Volumes and areas of a closed body add up; what is left over is skin, and a pocket's volume is
/// not negative but for skin. The sums alone would add up whatever caps were.
pub(crate) fn check_sums(model: &Body) {
    assert!(model.is_closed());
    let all = model.concavities();
    let is_flaw = |kind| matches!(kind, ConcavityKind::Opening | ConcavityKind::Overlay);
    assert!(!all.iter().any(|c| is_flaw(c.kind)));
    let hull = model.hull();
    let volume = model.mass_properties().unwrap().volume;
    let area: f64 = (0..model.mesh().faces().len() as u32)
        .map(|f| model.mesh().area_vector(FaceId(f)).length())
        .sum();
    let pockets: f64 = all.iter().map(|c| c.measures.pocket_volume).sum();
    let missing = hull.volume() - volume - pockets - all.skin().volume;
    let rounding = Rounding::of(model);
    assert!(missing.abs() <= 1e-12 * hull.volume() + rounding.volume, "volume: {missing:e}");
    let gained: f64 = all.iter().map(|c| c.measures.cap_area - c.measures.face_area).sum();
    let missing = hull.area() - area - gained - all.skin().area;
    assert!(missing.abs() <= 1e-11 * area + rounding.area, "area: {missing:e}");

    let (slab, skin) = (model.features().slab_depth(), all.skin());
    assert!(skin.volume.abs() <= slab * hull.area() + rounding.volume, "{skin:?}");
    let edges = model.topology().edges().iter();
    let at = |v| model.mesh().position(v);
    let around = |[a, b, c]: [DVec3; 3]| a.distance(b) + b.distance(c) + c.distance(a);
    // Skin goes along edges of faces, and of caps where these are needles between shells.
    let along = edges.map(|e| at(e.from).distance(at(e.to))).sum::<f64>()
        + all.caps().map(|cap| around(cap.corners.map(at))).sum::<f64>();
    assert!(skin.area.abs() <= slab * along, "{skin:?} along {along}");
    // A volume is a sum of products of coordinates, which round however small the pocket is.
    let rounding = f64::EPSILON * hull.volume() + rounding.volume;
    for concavity in all.iter().filter(|c| !c.caps.is_empty()) {
        let sizes = concavity.measures;
        // Of caps back to back `cap_area` is the difference; what lies between them does not follow
        // that.
        let of_cap = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
        let caps: f64 = concavity.caps.iter().map(|c| of_cap(all.cap(*c).corners.map(at))).sum();
        let layer = slab * (sizes.face_area + caps);
        assert!(sizes.pocket_volume >= -layer - rounding, "{sizes:?}");
    }
}

/// What sums over a hull, faces and caps may be off by. Of a solid body it is less than a hundredth
/// of what is allowed anyway; of a thin one products of coordinates are much larger than what they
/// leave.
struct Rounding {
    volume: f64,
    area: f64,
}

impl Rounding {
    fn of(model: &Body) -> Self {
        let (hull, mesh, all) = (model.hull(), model.mesh(), model.concavities());
        let center = hull.bounds().center();
        let mut sums = (0.0, 0.0);
        let add = |sums: &mut (f64, f64), corners: [DVec3; 3]| {
            let [a, b, c] = corners.map(|p| (p - center).abs());
            let cross =
                DVec3::new(b.y * c.z + b.z * c.y, b.z * c.x + b.x * c.z, b.x * c.y + b.y * c.x);
            sums.0 += a.dot(cross);
            let [a, b, c] = corners;
            sums.1 += a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        };
        (0..mesh.faces().len() as u32).for_each(|f| add(&mut sums, mesh.triangle(FaceId(f))));
        // A sum of faces no larger than this is reported as 0 (`MassProperties`), and may have been
        // as large.
        let is_none = model.mass_properties().is_some_and(|mass| mass.volume == 0.0);
        let roundings = 16.0 + mesh.faces().len() as f64;
        let left_out = if is_none { 0.5 * f64::EPSILON * roundings * sums.0 / 6.0 } else { 0.0 };
        let triangles = 0..hull.triangle_count();
        triangles.for_each(|t| add(&mut sums, hull.triangle(t).map(|v| hull.position(v))));
        all.caps().for_each(|cap| add(&mut sums, cap.corners.map(|v| mesh.position(v))));
        let (products, squares) = sums;
        // Volumes are summed about other points, too, from which coordinates are up to twice as
        // large.
        Self {
            volume: 4.0 * f64::EPSILON * products + left_out,
            area: 4.0 * f64::EPSILON * squares,
        }
    }
}

/// In the projection along its dominant axis every facet, or every group that is covered together,
/// has the area of its faces and caps; or it and neighbours, between which straddling pieces were
/// dropped, have together.
fn covered_once(model: &Body) {
    let (hull, all) = (model.hull(), model.concavities());
    let facets = || (0..hull.facet_count() as u32).map(FacetId);
    let mut home: Vec<FacetId> = facets().collect();
    for [facet, first] in all.shared_facets() {
        home[facet.index()] = first;
    }
    let mut members = vec![Vec::new(); home.len()];
    facets().for_each(|facet| members[home[facet.index()].index()].push(facet));

    let mut left = vec![0.0; home.len()];
    let mut book = |facet: FacetId, sign: f64, corners: [DVec3; 3]| {
        let home = home[facet.index()];
        left[home.index()] += sign * area(hull.facet(home).normal, corners);
    };
    for facet in facets() {
        for &t in hull.facet(facet).triangles {
            book(facet, 1.0, hull.triangle(t as usize).map(|v| hull.position(v)));
        }
    }
    for f in (0..model.mesh().faces().len() as u32).map(FaceId) {
        if let Some(facet) = model.features().facet_of(f) {
            book(facet, -1.0, model.mesh().triangle(f));
        }
    }
    for cap in all.caps() {
        book(cap.facet, -1.0, cap.corners.map(|v| model.mesh().position(v)));
    }

    let size = hull.bounds().diagonal();
    let planar = 8.0 * (hull.flatness() + 1e-13 * size) * size;
    let is_off = |f: FacetId| left[f.index()].abs() > planar * members[f.index()].len() as f64;
    let mut seen = vec![false; left.len()];
    for first in facets().filter(|&f| is_off(f)) {
        let (mut group, mut bent, mut open) = (Vec::new(), 0.0, vec![first]);
        while let Some(facet) = open.pop() {
            if !std::mem::replace(&mut seen[facet.index()], true) {
                group.push(left[facet.index()]);
                bent += planar * members[facet.index()].len() as f64;
                let beside = members[facet.index()].iter().flat_map(|&f| hull.facet(f).neighbours);
                open.extend(beside.map(|f| home[f.index()]).filter(|&f| is_off(f)));
            }
        }
        let sum: f64 = group.iter().sum();
        assert!(sum.abs() <= bent, "about {first:?}: {sum:e} of {group:?} left");
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
