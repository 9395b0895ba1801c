//! Envelopes beside the box tree: what is opened for a thing in a pocket.

use cranny_concavity::envelope::{EnvelopeOptions, Envelopes, Opened, Pocket, Probe};
use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::{DisjointSets, EdgeId, FaceId, FaceTree, Mesh, Patches, Topology};
use cranny_shapes::{Cup, IsoNut, ShapeError, Torus};

use super::corners;
use super::scenes::Scene;
use crate::report::{Cell, Table};
use crate::solid;
use crate::stopwatch::{Repeats, keep, race};

/// A pocket, and what is in it: convex things given by points in its frame.
struct PocketCase {
    name: &'static str,
    mesh: Mesh,
    faces: Vec<FaceId>,
    openings: Vec<DVec3>,
    things: Vec<Vec<DVec3>>,
}

pub(super) fn tables(scenes: &[Scene], quick: bool) -> Result<Vec<Table>, ShapeError> {
    Ok(vec![opened(&cases(scenes)?), dimples(quick)?])
}

/// Faces that look towards the z axis, or up from below `top`.
fn inner(mesh: &Mesh, top: f64) -> Vec<FaceId> {
    let looks_in = |f: &FaceId| {
        let [a, b, c] = mesh.triangle(*f);
        let (middle, normal) = ((a + b + c) / 3.0, mesh.area_vector(*f));
        let outward = middle.x * normal.x + middle.y * normal.y;
        let size = middle.truncate().length() * normal.length();
        outward < -1e-3 * size || (normal.z > 0.9 * normal.length() && middle.z < top)
    };
    (0..mesh.faces().len() as u32).map(FaceId).filter(looks_in).collect()
}

/// The patches of a mesh as boxes, posed.
fn patch_boxes(mesh: &Mesh, map: &RigidMap) -> Vec<Vec<DVec3>> {
    let patches = Patches::of(mesh, &Topology::of(mesh));
    let posed =
        |p: &cranny_geometry::Patch| corners(&p.bounds).iter().map(|&c| map.apply(c)).collect();
    patches.patches().iter().map(posed).collect()
}

fn cases(scenes: &[Scene]) -> Result<Vec<PocketCase>, ShapeError> {
    let cup = Cup::default().build()?;
    let top = cup.bounds().max.z;
    let torus = Torus::default();
    let hole = torus.build()?;
    let radius = 0.9 * (torus.major_radius - torus.minor_radius);
    let peg: Vec<DVec3> = hole
        .vertices()
        .iter()
        .filter_map(|p| p.truncate().try_normalize())
        .flat_map(|d| [-4.0, 4.0].map(|z| (radius * d).extend(z)))
        .collect();
    let nut = IsoNut::default().build()?;
    let cup_faces = inner(&cup, 0.999 * top);
    let mut cases = vec![PocketCase {
        name: "peg in a torus",
        faces: inner(&hole, f64::NEG_INFINITY),
        mesh: hole,
        openings: vec![DVec3::Z, -DVec3::Z],
        things: vec![peg],
    }];
    for scene in scenes {
        let map = &scene.poses[0];
        match scene.name {
            "ball in cup" => {
                let ball: Vec<DVec3> = scene.meshes[1]
                    .vertices()
                    .iter()
                    .map(|&p| map.apply(p) - 0.01 * DVec3::Z)
                    .collect();
                for (name, things) in [
                    ("ball on a cup's floor", vec![ball.clone()]),
                    (
                        "ball in a cup's middle",
                        vec![ball.iter().map(|&p| p + 0.3 * DVec3::Z).collect()],
                    ),
                    ("the ball's patches, on the floor", patch_boxes(&scene.meshes[1], map)),
                ] {
                    let (mesh, faces) = (cup.clone(), cup_faces.clone());
                    cases.push(PocketCase { name, mesh, faces, openings: vec![DVec3::Z], things });
                }
            }
            "nut on bolt" => cases.push(PocketCase {
                name: "the bolt's patches in a nut",
                faces: inner(&nut, f64::NEG_INFINITY),
                mesh: nut.clone(),
                openings: vec![DVec3::Z, -DVec3::Z],
                things: patch_boxes(&scene.meshes[0], &map.inverse()),
            }),
            _ => {}
        }
    }
    Ok(cases)
}

fn opened(cases: &[PocketCase]) -> Table {
    let mut rows = Vec::new();
    for case in cases {
        let tree = FaceTree::over(&case.mesh, &case.faces, EnvelopeOptions::DEFAULT_LEAF_FACES);
        let (mut boxes, mut faces) = (0, 0);
        for points in &case.things {
            let thing = Probe::of_points(points, 0.0);
            let keep = |b: &cranny_exact::Aabb| {
                boxes += 1;
                thing.bounds().overlaps(b)
            };
            tree.visit(keep, |_| faces += 1);
        }
        let row = |kind: &str, bytes: usize, boxes, planes, faces| {
            vec![
                Cell::Text(case.name.into()),
                Cell::Text(kind.into()),
                Cell::Count(case.faces.len()),
                Cell::Count(case.things.len()),
                Cell::Count(boxes),
                planes,
                Cell::Count(faces),
                Cell::Count(bytes),
            ]
        };
        let bytes = size_of_val(tree.nodes());
        rows.push(row("box tree", bytes, boxes, Cell::Absent, faces));
        for width in [8, 16, 32] {
            let pocket = Pocket { faces: &case.faces, openings: &case.openings };
            let options = EnvelopeOptions { width, ..EnvelopeOptions::default() };
            let envelopes = Envelopes::of(&case.mesh, [pocket], &options);
            let mut sum = Opened::default();
            for points in &case.things {
                let envelope = envelopes.envelope(0);
                let opened = envelope.for_each_face(&Probe::of_points(points, 0.0), |_| {});
                sum.boxes += opened.boxes;
                sum.planes += opened.planes;
                sum.faces += opened.faces;
            }
            let bytes = size_of_val(envelopes.facets());
            let planes = Cell::Count(sum.planes);
            rows.push(row(&format!("layers of {width}"), bytes, sum.boxes, planes, sum.faces));
        }
    }
    let columns =
        vec!["case", "structure", "faces", "things", "boxes", "planes", "faces opened", "bytes"];
    Table { title: "envelopes beside a box tree (leaves of 4 in both)", columns, rows }
}

/// How far below the unit sphere a vertex lies at least that belongs to a dimple. Smaller: rounding
/// makes dimples of the sphere; larger: their rims are lost.
const BELOW_THE_SPHERE: f64 = 1e-9;

/// All dimples of a golf ball.
fn dimples(quick: bool) -> Result<Table, ShapeError> {
    let mesh = solid::golf_ball(if quick { 10_000 } else { 100_000 })?;
    let topology = Topology::of(&mesh);
    let low = |f: usize| {
        let t = mesh.triangle(FaceId(f as u32));
        t.iter().any(|p| p.length() < 1.0 - BELOW_THE_SPHERE)
    };
    let mut sets = DisjointSets::new(mesh.faces().len());
    for edge in (0..topology.edges().len() as u32).map(EdgeId) {
        let around = topology.half_edges(edge);
        let [f, g] = [around[0], around[around.len() - 1]].map(|h| h.face().index());
        if low(f) && low(g) {
            sets.union(f, g);
        }
    }
    let mut groups: Vec<Vec<FaceId>> = vec![Vec::new(); mesh.faces().len()];
    for f in (0..mesh.faces().len()).filter(|&f| low(f)) {
        groups[sets.find(f)].push(FaceId(f as u32));
    }
    groups.retain(|g| !g.is_empty());
    let openings: Vec<[DVec3; 1]> =
        groups.iter().map(|g| [g.iter().map(|&f| mesh.area_vector(f)).sum()]).collect();
    let mut rows = Vec::new();
    for width in [8, 16, 32] {
        let options = EnvelopeOptions { width, ..EnvelopeOptions::default() };
        let build = || {
            let pockets = groups.iter().zip(&openings);
            let pockets = pockets.map(|(faces, openings)| Pocket { faces, openings });
            Envelopes::of(&mesh, pockets, &options)
        };
        let [seconds] = race(Repeats::of(quick), [&mut || keep(build())]);
        rows.push(vec![
            Cell::Count(width),
            Cell::Count(groups.len()),
            Cell::Count(groups.iter().map(Vec::len).sum()),
            Cell::Count(build().facets().len()),
            Cell::Time(seconds),
        ]);
    }
    let columns = vec!["width", "dimples", "faces", "facets", "build"];
    Ok(Table { title: "envelopes of all dimples of a golf ball", columns, rows })
}
