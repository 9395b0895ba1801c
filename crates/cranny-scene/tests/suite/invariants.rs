//! The invariants of concavities and caps on every mesh of the corpus, where `CRANNY_CORPUS` names
//! its folder: as stored, scaled, renumbered, turned.

use std::path::PathBuf;

use crate::bodies;
use crate::body::Body;
use crate::check::{checked_with, closed_checked_with};
use crate::corpus_files::mesh_files;
use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::{
    BuildOptions, EdgeKind, Element, FaceId, FindingKind, Flatness, MeetingScan, Mesh, VertexId,
};
use cranny_scene::read_mesh;
use cranny_testkit::Rng;

/// Every mesh with its name, and the options that take the flatness which was read off it as
/// stored.
fn corpus() -> Vec<(String, Mesh, BuildOptions)> {
    let read = |path: PathBuf| {
        let mesh = read_mesh(&path).unwrap().mesh;
        let flatness = Flatness::Relative(Flatness::Auto.resolve(&mesh));
        let options = BuildOptions { flatness, self_intersections: false, ..Default::default() };
        (path.display().to_string(), mesh, options)
    };
    mesh_files().into_iter().map(read).collect()
}

/// Builds, and checks what this mesh promises.
fn checked(name: &str, mesh: &Mesh, options: &BuildOptions) -> Option<Body> {
    let (model, report) = Body::build(mesh.clone(), options).ok()?;
    eprintln!("{name}: {} faces, closed: {}", report.faces, report.closed);
    Some(match report.closed {
        true => closed_checked_with(mesh, options),
        false => {
            drop(model);
            checked_with(mesh, options)
        }
    })
}

fn moved(mesh: &Mesh, to: impl Fn(DVec3) -> DVec3) -> Mesh {
    Mesh::new(mesh.vertices().iter().map(|&p| to(p)).collect(), mesh.faces().to_vec()).unwrap()
}

/// The faces of each concavity with its kind and its number of lids, by the names that `name` gives
/// to faces; sorted. (Into how many loops a boundary that touches itself is split is a matter of
/// numbers.)
fn classes(model: &Body, name: impl Fn(FaceId) -> usize) -> Vec<Vec<usize>> {
    let class = |c: cranny_concavity::Concavity<'_>| {
        let mut class: Vec<usize> = c.faces.iter().map(|&f| name(f)).collect();
        class.sort_unstable();
        class.extend([c.lids().len(), c.kind as usize]);
        class
    };
    let mut all: Vec<_> = model.concavities().iter().map(class).collect();
    all.sort_unstable();
    all
}

#[test]
fn as_stored_and_scaled_by_powers_of_two() {
    for (name, mesh, options) in corpus() {
        // How finely the coordinates were stored is seen whatever the power.
        let options = BuildOptions { flatness: Flatness::Auto, ..options };
        let Some(model) = checked(&name, &mesh, &options) else { continue };
        let scale = 2f64.powi(-9);
        let scaled = checked(&name, &moved(&mesh, |p| scale * p), &options).unwrap();
        assert_eq!(classes(&model, FaceId::index), classes(&scaled, FaceId::index), "{name}");
    }
}

#[test]
fn turned_the_pockets_hold_as_much() {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize());
    for (name, mesh, options) in corpus() {
        let Some(model) = checked(&name, &mesh, &options).filter(|body| body.is_closed()) else {
            continue;
        };
        let turned = checked(&name, &moved(&mesh, |p| turn * p), &options).unwrap();
        let volume = |model: &Body| -> f64 {
            model.concavities().iter().map(|c| c.measures.pocket_volume).sum()
        };
        let hull = model.hull();
        let skin = model.features().slab_depth().max(turned.features().slab_depth()) * hull.area();
        let gained = volume(&model) - volume(&turned);
        assert!(gained.abs() <= 2.0 * skin, "{name}: {gained:e} gained, skin {skin:e}");
    }
}

/// Closed meshes of the corpus that lie upon themselves or pass through themselves on the hull, and
/// how: their caps may overlap. All others are covered once.
const COVERED_TWICE: [(&str, &str); 1] = [(
    "openscad-nonmanifold-crash.obj",
    "hundreds of faces lie on others in the planes of its box",
)];

#[test]
fn caps_of_closed_meshes_cover_the_hull_once() {
    for (name, mesh, options) in corpus() {
        let options = BuildOptions { self_intersections: true, ..options };
        let Ok((model, report)) = Body::build(mesh, &options) else { continue };
        if !report.closed {
            continue;
        }
        let found = |kinds: &[FindingKind]| {
            report.findings.iter().find(|f| kinds.contains(&f.kind)).cloned()
        };
        let twice = found(&[FindingKind::NegativeCap, FindingKind::CrossedCap]);
        if let Some((_, why)) = COVERED_TWICE.iter().find(|(file, _)| name.ends_with(file)) {
            assert!(twice.is_some(), "{name} is no exception any more: {why}");
            assert!(found(&[FindingKind::CoplanarOverlap]).is_some(), "{name}: {why}");
            continue;
        }
        assert_eq!(twice, None, "{name}");
        let depth = model.features().slab_depth();
        let at = |v: VertexId| model.mesh().position(v);
        for concavity in model.concavities().iter() {
            // What lies between rims that rounding crossed: strips no wider than a slab is deep.
            let rims = concavity.loops().map(|rim| rim.vertices);
            let length: f64 = rims
                .flat_map(|rim| rim.iter().zip(rim.iter().cycle().skip(1)))
                .map(|(&a, &b)| at(a).distance(at(b)))
                .sum();
            let area = concavity.measures.cap_area;
            assert!(area >= -depth * length, "{name}, {:?}: {area:e}", concavity.id());
        }
    }
}

#[test]
fn soups_are_surfaces_whose_report_names_every_open_edge() {
    let mut soups = 0;
    for (name, mesh, options) in corpus() {
        let options = BuildOptions { self_intersections: true, ..options };
        let Ok((model, report)) = Body::build(mesh, &options) else { continue };
        if report.closed {
            continue;
        }
        soups += 1;
        assert!(!model.is_closed() && model.mass_properties().is_none(), "{name}");
        assert!(report.volume.is_none() && !report.is_sound(), "{name}");
        assert_eq!(report.meetings, MeetingScan::Complete, "{name}");
        let reported = |kind| -> usize {
            report.findings.iter().filter(|f| f.kind == kind).map(|f| f.count).sum()
        };
        let edges = model.topology().edges().iter();
        let open = edges.filter(|e| e.kind == EdgeKind::Open).count();
        assert_eq!(reported(FindingKind::OpenEdge), open, "{name}");
        let others = [FindingKind::ContradictoryEdge, FindingKind::NonManifoldEdge];
        assert!(open + others.map(reported).iter().sum::<usize>() > 0, "{name}");
        let bounds = model.bounds().grown(report.weld_distance);
        for finding in &report.findings {
            let limit = match finding.kind.element() {
                Element::Vertex => report.vertices,
                Element::Face => report.faces,
                Element::Component => report.components,
            };
            assert!(finding.ids.iter().all(|&id| (id as usize) < limit), "{name}: {finding:?}");
            assert!(bounds.contains_point(finding.at), "{name}: {finding:?}");
            assert!(finding.measure.is_finite(), "{name}: {finding:?}");
        }
    }
    if std::env::var_os("CRANNY_CORPUS").is_some() {
        assert!(soups >= 10, "{soups}");
    }
}

#[test]
fn renumbered_the_pockets_are_the_same() {
    let mut rng = Rng::new(3);
    for (name, mesh, options) in corpus() {
        let Some(model) = checked(&name, &mesh, &options) else { continue };
        let (renumbered, names) = bodies::renumbered(&mesh, &mut rng);
        let other = checked(&name, &renumbered, &options).unwrap();
        let (own, others) = (classes(&model, FaceId::index), classes(&other, |f| names[f.index()]));
        if model.is_closed() {
            assert!(own == others, "{name}: {} concavities, then {}", own.len(), others.len());
        }
        // Along open edges of a surface, which face belongs with which cap is a matter of numbers.
        assert_eq!(own.len(), others.len(), "{name}");
    }
}
