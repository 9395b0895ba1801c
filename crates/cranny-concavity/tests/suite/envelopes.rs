//! Envelopes: never a face missed, and few opened.

use std::collections::BTreeSet;

use crate::meshes::{scaled, soup, turned};
use cranny_concavity::envelope::{
    Cell, EnvelopeOptions, Envelopes, HalfSpace, Passage, Pocket, Probe,
};
use cranny_exact::{DVec3, Meeting, classify_triangles};
use cranny_geometry::{ConvexHull, DisjointSets, FaceId, Mesh, Topology};
use cranny_shapes::{Cup, GolfBall, IsoBolt, IsoNut, Shape, Torus};
use cranny_testkit::{Q, Q3, Rng};

/// Faces that do not lie in a facet of the hull, in groups that share edges: near enough to
/// concavities for these tests, which would hold for any groups.
fn pockets(mesh: &Mesh) -> Vec<Vec<FaceId>> {
    let hull = ConvexHull::of_points(mesh.vertices());
    let near = 1e-9 * mesh.bounds().diagonal();
    let planes: Vec<(DVec3, f64)> = hull.facets().map(|f| (f.normal, f.offset)).collect();
    let on_hull = |face: FaceId| {
        let t = mesh.triangle(face);
        planes.iter().any(|&(n, d)| {
            n.dot(mesh.area_vector(face)) > 0.0 && t.iter().all(|&p| (n.dot(p) - d).abs() < near)
        })
    };
    let open: Vec<bool> = (0..mesh.faces().len() as u32).map(|f| !on_hull(FaceId(f))).collect();
    let topology = Topology::of(mesh);
    let mut sets = DisjointSets::new(open.len());
    for edge in (0..topology.edges().len() as u32).map(cranny_geometry::EdgeId) {
        let around = topology.half_edges(edge);
        for pair in around.windows(2).map(|w| [w[0].face().index(), w[1].face().index()]) {
            if open[pair[0]] && open[pair[1]] {
                sets.union(pair[0], pair[1]);
            }
        }
    }
    let mut groups: Vec<Vec<FaceId>> = vec![Vec::new(); open.len()];
    for f in (0..open.len()).filter(|&f| open[f]) {
        groups[sets.find(f)].push(FaceId(f as u32));
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// The area vector of the cap that closes a pocket.
fn opening(mesh: &Mesh, faces: &[FaceId]) -> [DVec3; 1] {
    [faces.iter().map(|&f| mesh.area_vector(f)).sum()]
}

fn envelopes(mesh: &Mesh, groups: &[Vec<FaceId>], options: &EnvelopeOptions) -> Envelopes {
    let openings: Vec<[DVec3; 1]> = groups.iter().map(|g| opening(mesh, g)).collect();
    let pockets =
        || groups.iter().zip(&openings).map(|(faces, openings)| Pocket { faces, openings });
    let envelopes = Envelopes::of(mesh, pockets(), options);
    envelopes.validate(mesh, pockets()).unwrap();
    envelopes
}

fn all(mesh: &Mesh) -> Vec<FaceId> {
    (0..mesh.faces().len() as u32).map(FaceId).collect()
}

fn reached(envelopes: &Envelopes, corners: &[DVec3], margin: f64) -> BTreeSet<FaceId> {
    let thing = Probe::of_points(corners, margin);
    let mut found = BTreeSet::new();
    for index in 0..envelopes.len() {
        let mut faces = 0;
        let opened = envelopes.envelope(index).for_each_face(&thing, |f| {
            faces += 1;
            assert!(found.insert(f), "face {} is handed over twice", f.0);
        });
        assert_eq!(opened.faces, faces);
    }
    found
}

/// Whether the tetrahedron's surface meets the face.
fn meets(tetrahedron: &[DVec3; 4], face: &[DVec3; 3]) -> bool {
    let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    sides.iter().any(|s| classify_triangles(&s.map(|i| tetrahedron[i]), face) != Meeting::None)
}

fn anywhere(rng: &mut Rng, mesh: &Mesh) -> DVec3 {
    let b = mesh.bounds();
    b.center() + 0.6 * DVec3::new(rng.unit(), rng.unit(), rng.unit()) * (b.max - b.min)
}

fn hold_all_that_meets(mesh: &Mesh, groups: &[Vec<FaceId>], rounds: usize, rng: &mut Rng) {
    let envelopes = envelopes(mesh, groups, &EnvelopeOptions::default());
    let pocket: Vec<FaceId> = groups.concat();
    for round in 0..rounds {
        let size = mesh.bounds().diagonal() * 0.5f64.powi(round as i32 % 8);
        let at = anywhere(rng, mesh);
        let tetrahedron =
            [0; 4].map(|_| at + size * DVec3::new(rng.unit(), rng.unit(), rng.unit()));
        let found = reached(&envelopes, &tetrahedron, 0.0);
        for &f in &pocket {
            let missed = !found.contains(&f) && meets(&tetrahedron, &mesh.triangle(f));
            assert!(!missed, "face {} meets {tetrahedron:?} but was not reached", f.0);
        }
        // A point of the surface, and one that keeps a distance.
        let face = pocket[rng.below(pocket.len())];
        let corner = mesh.triangle(face)[round % 3];
        assert!(reached(&envelopes, &[corner], 0.0).contains(&face));
        let off = corner + size * DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let within = reached(&envelopes, &[off], (off - corner).length().next_up());
        assert!(within.contains(&face), "face {} at a distance", face.0);
    }
}

#[test]
fn no_face_that_meets_a_thing_is_missed_on_generated_solids() {
    let mut rng = Rng::new(11);
    for shape in Shape::defaults() {
        let mesh = turned(&shape.build().unwrap());
        let groups = if mesh.faces().len() < 6_000 { pockets(&mesh) } else { vec![all(&mesh)] };
        if !groups.is_empty() {
            hold_all_that_meets(&mesh, &groups, 16, &mut rng);
        }
    }
}

#[test]
fn no_face_that_meets_a_thing_is_missed_on_soups_and_at_any_scale() {
    let mut rng = Rng::new(5);
    for round in 0..150 {
        let mesh = soup(&mut rng, 1 + 3 * round);
        let some: Vec<FaceId> = all(&mesh).into_iter().filter(|_| rng.below(5) > 0).collect();
        let groups = [some.clone(), Vec::new(), vec![FaceId(0)]];
        if !some.contains(&FaceId(0)) && !some.is_empty() {
            let factor = [1.0, 2f64.powi(-150), 2f64.powi(117)][round % 3];
            hold_all_that_meets(&scaled(&mesh, factor), &groups, 6, &mut rng);
        }
    }
}

#[test]
fn planes_hold_what_lies_beneath_in_rational_arithmetic() {
    let holds = |h: &HalfSpace, p: DVec3| {
        let offset = Q::try_from(h.offset).unwrap();
        Q3::exactly(h.normal).dot(&Q3::exactly(p)) <= offset
    };
    let mesh = turned(&Torus::default().build().unwrap());
    let envelopes = envelopes(&mesh, &pockets(&mesh), &EnvelopeOptions::default());
    for facet in (0..envelopes.facets().len() as u32).step_by(7) {
        let id = cranny_concavity::EnvelopeFacetId(facet);
        let beneath = envelopes.facet(id).beneath;
        let corners = envelopes.faces_beneath(id).iter().flat_map(|&f| mesh.triangle(f));
        assert!(corners.clone().all(|p| holds(&beneath, p)));
        // Tight to rounding.
        let reach = corners.map(|p| beneath.normal.dot(p)).fold(f64::NEG_INFINITY, f64::max);
        assert!(beneath.offset - reach < 1e-14 * mesh.bounds().diagonal());
    }
}

/// A sphere in closed form.
fn ball(center: DVec3, radius: f64) -> Probe<impl Fn(DVec3) -> f64> {
    Probe::new(move |n: DVec3| n.dot(center) - radius * (1.0 + 1e-12), 0.0)
}

#[test]
fn a_ball_in_a_cup_comes_in_offends_nothing_lands_and_leaves() {
    let cup = Cup::default();
    let mesh = cup.build().unwrap();
    let groups = pockets(&mesh);
    assert_eq!(groups.len(), 1);
    let envelopes = envelopes(&mesh, &groups, &EnvelopeOptions::default());
    let inside = envelopes.envelope(0);
    assert!((inside.axis() - DVec3::Z).length() < 1e-9, "{}", inside.axis());
    let radius = 0.5 * (cup.radius - cup.wall);
    let top = mesh.bounds().max.z;
    let floor = inside.bounds().min.z;
    let faces = |z: f64| inside.for_each_face(&ball(DVec3::new(0.0, 0.0, z), radius), |_| {}).faces;
    let passage = |z: f64| inside.passage(&ball(DVec3::new(0.0, 0.0, z), radius));

    assert_eq!((passage(top + 1.01 * radius), faces(top + 1.01 * radius)), (Passage::Beyond(0), 0));
    assert_eq!((passage(top), faces(top)), (Passage::Through(0), 0));
    let middle = 0.5 * (top + floor);
    assert_eq!((passage(middle), faces(middle)), (Passage::Within, 0));
    // It lands where all faces of the floor meet, and the walls stay closed.
    let upward = |f: &&FaceId| mesh.area_vector(**f).normalize().z > 0.999;
    let landed = faces(floor + 0.99 * radius);
    assert!(landed > 0 && landed <= groups[0].iter().filter(upward).count(), "{landed}");
}

#[test]
fn a_peg_in_a_hole_stays_in_the_core() {
    let torus = Torus::default();
    let mesh = torus.build().unwrap();
    let hole: Vec<FaceId> = pockets(&mesh).concat();
    let openings = [DVec3::Z, -DVec3::Z];
    let pocket = || [Pocket { faces: &hole, openings: &openings }];
    let envelopes = Envelopes::of(&mesh, pocket(), &EnvelopeOptions::default());
    envelopes.validate(&mesh, pocket()).unwrap();
    let through = envelopes.envelope(0);
    assert_eq!((through.axis(), through.lids().len()), (DVec3::Z, 2));
    let radius = 0.8 * (torus.major_radius - torus.minor_radius);
    let peg = |x: f64| {
        let least = move |n: DVec3| {
            let across = (n.x * n.x + n.y * n.y).sqrt();
            n.x * x - radius * across - 10.0 * torus.major_radius * n.z.abs() - 1e-9
        };
        Probe::new(least, 0.0)
    };
    assert_eq!(through.for_each_face(&peg(0.0), |_| {}).faces, 0);
    assert_eq!(through.passage(&peg(0.0)), Passage::Through(0));
    let touching = through.for_each_face(&peg(0.25 * radius), |_| {});
    assert!(touching.faces > 0 && touching.faces < hole.len() / 8, "{touching:?}");
}

#[test]
fn a_tracked_cell_is_the_one_that_a_cold_look_finds() {
    let mesh = turned(&Cup::default().build().unwrap());
    let envelopes = envelopes(&mesh, &pockets(&mesh), &EnvelopeOptions::default());
    let inside = envelopes.envelope(0);
    let layer = inside.first_layer().unwrap();
    let mut rng = Rng::new(2);
    let size = mesh.bounds().diagonal();
    // Off the middle, where all walls are equally near.
    let start = mesh.bounds().center() + 0.1 * size * inside.axis().any_orthonormal_vector();
    let (mut at, mut warm): (DVec3, Option<Cell>) = (start, None);
    let (evaluations, mut spent) = (std::cell::Cell::new(0), 0);
    for frame in 0..2_000 {
        let step = DVec3::new(rng.unit(), rng.unit(), rng.unit()) * size * 3e-4;
        let next = if frame % 500 == 499 { start } else { at + step };
        // Rounding of the support function is part of the motion.
        let motion = (next - at).length() + 1e-12 * size;
        at = next;
        let thing = ball(at, 0.1);
        let counted = |n: DVec3| {
            evaluations.set(evaluations.get() + 1);
            thing.least(n)
        };
        let counted = Probe::new(counted, 0.0);
        let before = evaluations.get(); // after those for the box
        let cell = inside.track(layer, &counted, warm.as_ref().map(|cell| (cell, motion)));
        spent += evaluations.get() - before;
        let cold = inside.track(layer, &thing, None);
        assert_eq!((cell.facet, cell.slack), (cold.facet, cold.slack), "frame {frame}");
        warm = Some(cell);
    }
    let facets = envelopes.layer(layer).len();
    assert!(facets > 8 && spent < 2_000 * 4, "{spent} evaluations, {facets} facets");
}

#[test]
fn degenerate_pockets_are_enveloped() {
    let at = |i: u32| DVec3::new(f64::from(i % 7), f64::from(i / 7), 0.0);
    let vertices: Vec<DVec3> = (0..49).map(at).collect();
    let flat = (0..40).map(|i| [i, i + 1, i + 8]).collect();
    let coincident = vec![[0, 1, 8]; 100];
    let points = vec![[3, 3, 3]; 30];
    let line = (0..30).map(|i| [i % 7, (i + 1) % 7, (i + 2) % 7]).collect();
    for faces in [flat, coincident, points, line] {
        let mesh = Mesh::new(vertices.clone(), faces).unwrap();
        for openings in
            [vec![], vec![DVec3::ZERO], vec![DVec3::Z, -DVec3::Z], vec![DVec3::X * 1e-200]]
        {
            let faces = all(&mesh);
            let pocket = || [Pocket { faces: &faces, openings: &openings }];
            for (width, leaf_faces) in [(2, 1), (16, 4), (0, 0)] {
                let options = EnvelopeOptions { width, leaf_faces };
                let envelopes = Envelopes::of(&mesh, pocket(), &options);
                envelopes.validate(&mesh, pocket()).unwrap();
                let found = reached(&envelopes, &mesh.triangle(FaceId(9)), 0.0);
                assert!(found.contains(&FaceId(9)));
            }
        }
    }
}

#[test]
fn envelopes_of_other_pockets_are_refused() {
    let mesh = Cup::default().build().unwrap();
    let groups = pockets(&mesh);
    let envelopes = envelopes(&mesh, &groups, &EnvelopeOptions::default());
    let openings = opening(&mesh, &groups[0]);
    let refused = |mesh: &Mesh, faces: &[FaceId]| {
        envelopes.validate(mesh, [Pocket { faces, openings: &openings }]).is_err()
    };
    assert!(!refused(&mesh, &groups[0]));
    assert!(refused(&mesh, &groups[0][1..]));
    assert!(refused(&scaled(&mesh, 1.0 + 1e-15), &groups[0]));
}

#[test]
fn threads_and_dimples_have_bounded_layers() {
    let bolt = IsoBolt { segments: 48, ..IsoBolt::default() }.build().unwrap();
    let nut = IsoNut { segments: 48, ..IsoNut::default() }.build().unwrap();
    for mesh in [bolt, nut] {
        let faces = [all(&mesh)];
        let envelopes = envelopes(&mesh, &faces, &EnvelopeOptions::default());
        assert!(envelopes.facets().len() < mesh.faces().len());
    }
    let ball = GolfBall { dimples: 60, triangles: 8_000, ..GolfBall::default() }.build().unwrap();
    let groups = pockets(&ball);
    assert!(groups.len() >= 60, "{}", groups.len());
    envelopes(&ball, &groups, &EnvelopeOptions::default());
}
