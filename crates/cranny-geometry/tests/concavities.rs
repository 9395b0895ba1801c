//! Features, caps, concavities and boundary loops: counted by hand, and their invariants.

mod concavities {
    pub(crate) mod bodies;
    pub(crate) mod check;
}

use concavities::bodies;
use concavities::check::{checked, closed_checked};
use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::concavity::{Border, ConcavityKind, Cover};
use cranny_geometry::features::Feature;
use cranny_geometry::hull::{FacetId, HullKind};
use cranny_geometry::{
    BuildOptions, CapId, ConvexHull, FaceId, Finding, FindingKind, Flatness, Mesh, Model,
};
use cranny_shapes::{
    Comb, Cuboid, Cup, Gear, GolfBall, IsoBolt, IsoNut, NestedShells, PyramidInCavity, Shape,
    Sphere, Torus, UPrism,
};
use cranny_testkit::Rng;

/// An arbitrary rotation; applying it rounds.
fn turned(mesh: &Mesh) -> Mesh {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize());
    moved(mesh, |p| turn * p)
}

fn rounded_to_single(mesh: &Mesh) -> Mesh {
    moved(mesh, |p| p.as_vec3().as_dvec3())
}

fn moved(mesh: &Mesh, to: impl Fn(DVec3) -> DVec3) -> Mesh {
    Mesh::new(mesh.vertices().iter().map(|&p| to(p)).collect(), mesh.faces().to_vec()).unwrap()
}

/// As generated, turned, rounded to single precision, and both.
fn four_ways(mesh: &Mesh) -> [Mesh; 4] {
    [mesh.clone(), turned(mesh), rounded_to_single(mesh), rounded_to_single(&turned(mesh))]
}

/// Of each concavity: kind, lids, loops; sorted.
fn census(model: &Model) -> Vec<(ConcavityKind, usize, usize)> {
    let mut all: Vec<_> =
        model.concavities().iter().map(|c| (c.kind, c.lids().len(), c.loops().len())).collect();
    all.sort_unstable();
    all
}

#[test]
fn convex_bodies_have_one_convex_set_and_nothing_else() {
    for mesh in [
        Cuboid { size: [1.0, 2.0, 4.0] }.build(),
        Sphere::default().build(),
        Sphere { segments: 7, rings: 5, ..Sphere::default() }.build(),
    ] {
        for mesh in four_ways(&mesh.unwrap()) {
            let model = closed_checked(&mesh);
            assert_eq!(model.features().convex_sets().len(), 1);
            assert!(model.concavities().is_empty());
            let facets = 0..model.hull().facet_count() as u32;
            assert!(facets.map(FacetId).all(|f| model.concavities().cover(f) == Cover::Solid));
        }
    }
}

#[test]
fn sides_rounded_to_single_precision_are_flat() {
    let cube = bodies::gridded_cuboid([7, 5, 6], |_, _| false);
    for mesh in four_ways(&moved(&cube, |p| p * 0.1 + DVec3::new(1.0, 2.0, 3.0))) {
        let model = closed_checked(&mesh);
        assert_eq!((model.features().convex_sets().len(), model.concavities().len()), (1, 0));
    }
}

#[test]
fn a_torus_is_one_passage_however_it_is_rounded() {
    for (major_segments, minor_segments) in [(64, 16), (33, 11), (48, 7), (5, 40), (3, 3)] {
        let torus = Torus { major_segments, minor_segments, ..Torus::default() };
        for mesh in four_ways(&torus.build().unwrap()) {
            let model = closed_checked(&mesh);
            assert_eq!(model.features().convex_sets().len(), 1);
            assert_eq!(census(&model), [(ConcavityKind::Passage, 2, 2)]);
            let concavity = model.concavities().iter().next().unwrap();
            for rim in concavity.loops() {
                assert_eq!(rim.vertices.len(), major_segments as usize);
                assert!(rim.borders.iter().all(|&b| b == Border::Convex));
            }
        }
    }
}

/// As a file keeps it that writes so many decimals.
fn rounded_to_decimals(mesh: &Mesh, decimals: usize) -> Mesh {
    let written = |x: f64| format!("{x:.decimals$}").parse::<f64>().unwrap();
    moved(mesh, |p| DVec3::from_array(p.to_array().map(written)))
}

/// As a file keeps it that writes so many significant digits.
fn rounded_to_digits(mesh: &Mesh, digits: usize) -> Mesh {
    let places = digits - 1;
    let written = |x: f64| format!("{x:.places$e}").parse::<f64>().unwrap();
    moved(mesh, |p| DVec3::from_array(p.to_array().map(written)))
}

#[test]
fn decimals_make_no_dents() {
    let passage = (ConcavityKind::Passage, 2, 2);
    let torus = Torus { major_segments: 40, minor_segments: 10, ..Torus::default() };
    let mut teeth = vec![(ConcavityKind::Pocket, 1, 1); 16];
    teeth.push(passage);
    let bodies = [
        (torus.build().unwrap(), vec![passage]),
        (Gear::default().build().unwrap(), teeth),
        (Sphere { segments: 24, rings: 12, ..Sphere::default() }.build().unwrap(), vec![]),
    ];
    for (mesh, expected) in bodies {
        for mesh in [mesh.clone(), turned(&mesh)] {
            for decimals in 4..=6 {
                let model = closed_checked(&rounded_to_decimals(&mesh, decimals));
                assert_eq!(census(&model), expected, "{decimals} decimals");
                let model = closed_checked(&rounded_to_digits(&mesh, decimals + 1));
                assert_eq!(census(&model), expected, "{} digits", decimals + 1);
            }
        }
    }
}

#[test]
fn a_quadrilateral_divided_the_other_way_is_no_dent() {
    // The top of a cube, one corner lower: the hull folds it from 5 to 6, the mesh from 4 to 7, which
    // makes a dent half as deep as the corner is low. Facets merge up to 1, slabs are 2 deep.
    let built = |low: f64| {
        let corner =
            |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let mut vertices: Vec<DVec3> = (0..8).map(corner).collect();
        vertices[7].z -= low * 1e-3;
        let sides = [[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut faces = vec![[4, 5, 7], [4, 7, 6]];
        faces.extend(sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]));
        let options =
            BuildOptions { flatness: Flatness::Relative(1e-3), ..BuildOptions::default() };
        let model = Model::build(Mesh::new(vertices, faces).unwrap(), &options).unwrap().0;
        let (features, all) = (model.features(), model.concavities());
        all.validate(model.mesh(), model.topology(), model.hull(), features).unwrap();
        (model.hull().facet_count(), census(&model), all.negative_caps().len())
    };
    assert_eq!(built(0.5), (6, vec![], 0));
    assert_eq!(built(1.5), (7, vec![], 0));
    assert_eq!(built(3.0), (7, vec![(ConcavityKind::Pocket, 1, 1)], 0));
}

#[test]
fn a_face_on_two_facets_leaves_a_cap_that_both_share() {
    // A pentagon A B E C D, C the tip. The hull has A B C, with D somewhat lower and E lower still. The mesh is a fan
    // about D: A B D lies on A B C, to within its slab, and on A C D beside it; B E D and E C D are off the hull.
    const FLATNESS: f64 = 1e-3;
    let merged = 2.0 * FLATNESS; // the largest coordinate is 2
    let [low, lower] = [1.4 * merged, 3.0 * merged];
    let rim = [(-1.0, -1.0), (1.0, -1.0), (1.5, 0.5), (0.0, 2.0), (-1.5, 0.5)];
    let top = rim.iter().zip([0.0, 0.0, -lower, 0.0, -low]).map(|(&(x, y), z)| DVec3::new(x, y, z));
    let bottom = rim.map(|(x, y)| DVec3::new(x, y, -1.0));
    let mut faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [5, 7, 6], [5, 8, 7], [5, 9, 8]];
    faces.extend((0..5).flat_map(|i| {
        let j = (i + 1) % 5;
        [[i, 5 + i, 5 + j], [i, 5 + j, j]]
    }));
    let mesh = Mesh::new(top.chain(bottom).collect(), faces).unwrap();
    let options =
        BuildOptions { flatness: Flatness::Relative(FLATNESS), ..BuildOptions::default() };
    let (model, report) = Model::build(mesh, &options).unwrap();
    let (hull, all) = (model.hull(), model.concavities());
    all.validate(model.mesh(), model.topology(), hull, model.features()).unwrap();
    assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 1)]);
    assert_eq!((all.negative_caps(), all.crossed_facets()), (&[][..], &[][..]));
    assert!(report.findings.iter().all(|f| f.kind == FindingKind::CoplanarAdjacent));
    // D B E C, but for how it bends.
    let pocket = all.iter().next().unwrap();
    assert!((pocket.measures.cap_area - 4.5).abs() < 1e-4, "{:?}", pocket.measures);

    let facet_of = |corners: [u32; 3]| {
        let is_it = |t: &usize| {
            let mut sources = hull.triangle(*t).map(|v| hull.source(v).0);
            sources.sort_unstable();
            sources == corners
        };
        hull.facet_of_triangle((0..hull.triangle_count()).find(is_it).unwrap())
    };
    // Vertices are numbered as faces use them: A B D E C.
    let (own, beside) = (facet_of([0, 1, 4]), facet_of([0, 2, 4]));
    let shared: Vec<FacetId> = all.shared_facets().map(|[facet, _]| facet).collect();
    assert!(shared.contains(&own) && shared.contains(&beside), "{shared:?}");
    for facet in [own, beside] {
        assert!(matches!(all.cover(facet), Cover::Mixed(_)));
        let over: f64 = all
            .caps_over(facet)
            .map(|c| all.cap(c).corners)
            .map(|c| {
                let [a, b, c] = c.map(|v| model.mesh().position(v));
                0.5 * (b - a).cross(c - a).length()
            })
            .sum();
        assert!(over > 3.0, "{over}");
    }
}

/// A convex polygon of the plane, counter-clockwise, cut into triangles anyhow.
fn cut_anyhow(corners: u32, rng: &mut Rng) -> Vec<[u32; 3]> {
    let mut left: Vec<u32> = (0..corners).collect();
    let mut triangles = Vec::new();
    while left.len() > 2 {
        let n = left.len();
        let ear = rng.below(n);
        triangles.push([left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]]);
        left.remove(ear);
    }
    triangles
}

/// A prism of height 1 over a convex polygon, its top cut anyhow. Every corner of the top lies as far
/// below its plane as `depth` says.
fn prism_cut_anyhow(corners: u32, rng: &mut Rng, mut depth: impl FnMut(&mut Rng) -> f64) -> Mesh {
    let step = std::f64::consts::TAU / f64::from(corners);
    let angle = |k: u32, rng: &mut Rng| step * (f64::from(k) + 0.1 * f64::from(rng.between(-4, 4)));
    let rim: Vec<DVec3> = (0..corners)
        .map(|k| {
            let (sin, cos) = angle(k, rng).sin_cos();
            DVec3::new(cos, sin, 0.0)
        })
        .collect();
    let top = rim.iter().map(|&p| p + (1.0 - depth(rng)) * DVec3::Z).collect::<Vec<_>>();
    let mut faces = cut_anyhow(corners, rng);
    faces.extend((1..corners - 1).map(|k| [corners, corners + k + 1, corners + k]));
    for i in 0..corners {
        let j = (i + 1) % corners;
        faces.extend([[i, corners + i, corners + j], [i, corners + j, j]]);
    }
    Mesh::new([top, rim].concat(), faces).unwrap()
}

#[test]
fn sides_divided_otherwise_than_the_hull_divides_them_are_covered_once() {
    const FLATNESS: f64 = 1e-3;
    let options =
        BuildOptions { flatness: Flatness::Relative(FLATNESS), ..BuildOptions::default() };
    let mut rng = Rng::new(17);
    let mut shared = 0;
    for round in 0..400 {
        // Facets merge up to 1, slabs are 2 deep: below that all is flat, not far below nothing is.
        let depth = |rng: &mut Rng| 0.01 * FLATNESS * f64::from(rng.between(0, 300));
        let corners = 4 + round % 9;
        let mesh = prism_cut_anyhow(corners, &mut rng, depth);
        let (model, report) = Model::build(mesh, &options).unwrap();
        let all = model.concavities();
        all.validate(model.mesh(), model.topology(), model.hull(), model.features()).unwrap();
        shared += usize::from(all.shared_facets().next().is_some());
        let told =
            |f: &&Finding| matches!(f.kind, FindingKind::NegativeCap | FindingKind::CrossedCap);
        let found = report.findings.iter().find(told);
        assert_eq!(found, None, "round {round}");
    }
    assert!(shared > 40, "{shared}");
}

#[test]
fn shallow_pockets_on_a_lattice_stay() {
    // Whole numbers: a hole a thousandth of the body's size deep, in a plate that reaches to 2000.
    let plate = bodies::gridded_cuboid([3, 3, 2], |x, y| (x, y) == (1, 1));
    let deep = |p: DVec3| DVec3::new(p.x * 500.0, p.y * 500.0, p.z);
    let model = closed_checked(&moved(&plate, deep));
    assert_eq!(census(&model), [(ConcavityKind::Passage, 2, 2)]);
}

#[test]
fn vessels_are_counted_by_hand() {
    let pocket = |loops| (ConcavityKind::Pocket, 1, loops);
    for mesh in four_ways(&Cup::default().build().unwrap()) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [pocket(1)]);
        let cup = model.concavities().iter().next().unwrap();
        // A well of radius 0.4 and depth 0.9, 64 segments.
        let circle = 32.0 * (std::f64::consts::TAU / 64.0).sin() * 0.16;
        assert!((cup.measures.pocket_volume - 0.9 * circle).abs() < 1e-6);
        assert!((cup.measures.cap_area - circle).abs() < 1e-6);
        assert!((cup.measures.opening.length() - circle).abs() < 1e-6);
        assert_eq!(cup.lids().next().unwrap().outlines().len(), 1);
    }
    let tall = PyramidInCavity { pyramid_height: 3.0, ..PyramidInCavity::default() };
    for mesh in four_ways(&tall.build().unwrap()) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [pocket(1)]);
        assert_eq!(model.features().isolated_vertices().len(), 1);
    }
    for mesh in four_ways(&PyramidInCavity::default().build().unwrap()) {
        assert_eq!(census(&closed_checked(&mesh)), [pocket(1)]);
    }
    for shells in 1..=4 {
        let nested = NestedShells { shells, wall: 0.05, gap: 0.1, ..NestedShells::default() };
        for mesh in four_ways(&nested.build().unwrap()) {
            let model = closed_checked(&mesh);
            // The well has one loop, each groove between two lips has two.
            let mut expected = vec![pocket(1)];
            expected.extend((1..shells).map(|_| pocket(2)));
            assert_eq!(census(&model), expected);
            assert_eq!(model.features().convex_sets().len(), shells as usize);
            for concavity in model.concavities().iter() {
                let lid = concavity.lids().next().unwrap();
                assert_eq!(lid.outlines().len(), concavity.loops().len());
            }
        }
    }
    for mesh in four_ways(&bodies::bottle(24)) {
        let model = closed_checked(&mesh);
        // Inside; and outside between shoulder and lip, where the neck is.
        assert_eq!(census(&model), [pocket(1), pocket(2)]);
        assert_eq!(model.features().convex_sets().len(), 2);
    }
}

#[test]
fn machine_parts_are_counted_by_hand() {
    for mesh in four_ways(&Comb::default().build().unwrap()) {
        assert_eq!(census(&closed_checked(&mesh)), [(ConcavityKind::Pocket, 1, 1); 7]);
    }
    for mesh in four_ways(&UPrism::default().build().unwrap()) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 1)]);
        // The cap spans the top and both ends.
        let lid = model.concavities().lid(cranny_geometry::LidId(0));
        assert_eq!(lid.outlines().map(|(facet, _)| facet).collect::<Vec<_>>().len(), 3);
    }
    for mesh in four_ways(&Gear::default().build().unwrap()) {
        let mut expected = vec![(ConcavityKind::Pocket, 1, 1); 16];
        expected.push((ConcavityKind::Passage, 2, 2));
        assert_eq!(census(&closed_checked(&mesh)), expected);
    }
    let nut = IsoNut { segments: 36, ..IsoNut::default() };
    for mesh in four_ways(&nut.build().unwrap()) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [(ConcavityKind::Passage, 2, 2)]);
        assert_eq!(model.features().convex_sets().len(), 1);
    }
    let bolt = IsoBolt { segments: 36, ..IsoBolt::default() };
    for mesh in four_ways(&bolt.build().unwrap()) {
        closed_checked(&mesh);
    }
}

#[test]
fn plates_with_holes_have_a_passage_for_each() {
    for mesh in four_ways(&bodies::gridded_cuboid([9, 7, 2], |x, y| x % 2 == 1 && y % 2 == 1)) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [(ConcavityKind::Passage, 2, 2); 12]);
        assert_eq!(model.features().convex_sets().len(), 1);
        // Both sides with holes are covered in part; the others wholly.
        let facets = (0..model.hull().facet_count() as u32).map(FacetId);
        let (mixed, solid): (Vec<_>, Vec<_>) =
            facets.map(|f| model.concavities().cover(f)).partition(|c| *c != Cover::Solid);
        assert_eq!((mixed.len(), solid.len()), (2, 4));
        for cover in mixed {
            let Cover::Mixed(caps) = cover else { panic!("{cover:?}") };
            assert_eq!(caps.len(), 24);
            assert!(caps.map(CapId).all(|c| model.concavities().cap(c).concavity.is_some()));
        }
    }
}

#[test]
fn holes_that_touch_at_a_corner_share_loops_split_there() {
    // Two square holes, corner to corner: one edge of four faces joins them from top to bottom.
    let mesh = bodies::gridded_cuboid([4, 4, 1], |x, y| (x, y) == (1, 1) || (x, y) == (2, 2));
    let model = closed_checked(&mesh);
    let [hole] = model.concavities().iter().collect::<Vec<_>>()[..] else {
        panic!("{:?}", census(&model))
    };
    assert_eq!((hole.kind, hole.lids().len()), (ConcavityKind::Passage, 4));
    assert_eq!(hole.loops().len(), 4);
    for rim in hole.loops() {
        assert_eq!(rim.vertices.len(), 4);
        assert_eq!(rim.touches.iter().filter(|&&t| t).count(), 1);
    }
}

#[test]
fn a_small_stellated_dodecahedron_has_no_convex_face() {
    for mesh in four_ways(&bodies::small_stellated_dodecahedron()) {
        let model = closed_checked(&mesh);
        let features = model.features();
        assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 0)]);
        assert_eq!(features.convex_sets().len(), 0);
        assert_eq!(features.isolated_vertices().len(), 12);
        assert_eq!(features.boundary_edge_count(), 0);
        let facets = (0..model.hull().facet_count() as u32).map(FacetId);
        let lid = Cover::Lid(cranny_geometry::ConcavityId(0));
        assert!(facets.map(|f| model.concavities().cover(f)).all(|c| c == lid));
    }
}

#[test]
fn a_star_prism_has_a_notch_between_any_two_points() {
    for mesh in four_ways(&bodies::star_prism(5)) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 1); 5]);
        assert_eq!(model.features().ridges().len(), 5);
        assert_eq!(model.features().convex_sets().len(), 2);
        for notch in model.concavities().iter() {
            let rim = notch.loops().next().unwrap();
            assert_eq!(rim.borders.iter().filter(|&&b| b == Border::Ridge).count(), 2);
        }
    }
}

#[test]
fn a_groove_with_all_corners_on_the_hull_is_a_concavity() {
    for mesh in four_ways(&bodies::grooved_block()) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 1)]);
        let features = model.features();
        let vertices = (0..mesh.vertices().len() as u32).map(cranny_geometry::VertexId);
        assert!(vertices.clone().all(|v| features.vertex(v) != Feature::Concavity));
        let groove = model.concavities().iter().next().unwrap();
        assert_eq!(groove.faces.len(), 4);
    }
}

#[test]
fn ridges_in_the_plane_of_a_side_part_grooves() {
    for mesh in four_ways(&bodies::knife_block()) {
        let model = closed_checked(&mesh);
        assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 1); 2]);
        assert_eq!(model.features().ridges().len(), 1);
    }
}

#[test]
fn shells_inside_shells_know_what_surrounds_them() {
    // From outside in: a body, a void, a piece in it, a void in the piece.
    let shell = |size: f64, inward: bool| {
        let mesh = Cuboid { size: [size; 3] }.build().unwrap();
        if inward { bodies::inside_out(&mesh) } else { mesh }
    };
    let mesh = shell(8.0, false)
        .joined(&shell(6.0, true))
        .joined(&shell(4.0, false))
        .joined(&shell(2.0, true));
    for mesh in four_ways(&mesh) {
        let model = closed_checked(&mesh);
        let all: Vec<_> = model.concavities().iter().collect();
        let kinds: Vec<_> = all.iter().map(|c| c.kind).collect();
        assert_eq!(kinds, [ConcavityKind::Void, ConcavityKind::Island, ConcavityKind::Void]);
        let parents: Vec<_> = all.iter().map(|c| c.parent.map(|p| p.0)).collect();
        assert_eq!(parents, [None, Some(0), Some(1)]);
        let volumes: Vec<_> = all.iter().map(|c| c.measures.pocket_volume.round()).collect();
        assert_eq!(volumes, [216.0, -64.0, 8.0]);
    }
}

#[test]
fn a_pebble_in_a_cup_has_the_well_for_parent_and_a_peg_flush_with_the_rim_shares_it() {
    let cup = Cup { segments: 12, ..Cup::default() }.build().unwrap();
    let pebble = moved(&Cuboid { size: [0.1; 3] }.build().unwrap(), |p| p + 0.5 * DVec3::Z);
    let model = closed_checked(&cup.clone().joined(&pebble));
    let kinds: Vec<_> = model.concavities().iter().map(|c| (c.kind, c.parent)).collect();
    let well = cranny_geometry::ConcavityId(0);
    assert_eq!(kinds, [(ConcavityKind::Pocket, None), (ConcavityKind::Island, Some(well))]);

    let peg = Cuboid { size: [0.1, 0.1, 0.5] }.build().unwrap();
    let model = closed_checked(&cup.joined(&moved(&peg, |p| p + 0.75 * DVec3::Z)));
    assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 2)]);
    assert_eq!(model.features().convex_sets().len(), 2);
}

#[test]
fn open_meshes_have_openings() {
    let mut faces = Cuboid::default().build().unwrap().faces().to_vec();
    let vertices = Cuboid::default().build().unwrap().vertices().to_vec();
    faces.truncate(10);
    let model = checked(&Mesh::new(vertices, faces).unwrap());
    assert_eq!(census(&model), [(ConcavityKind::Opening, 1, 0)]);
    let opening = model.concavities().iter().next().unwrap();
    assert_eq!((opening.measures.cap_area, opening.faces.len()), (1.0, 0));

    let triangle = Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let model = checked(&triangle);
    assert_eq!(census(&model), [(ConcavityKind::Opening, 1, 0)]);
}

#[test]
fn faces_that_cover_a_side_twice_count_negative() {
    // A second, separate patch in the plane of a cube's top.
    let cube = Cuboid::default().build().unwrap();
    let patch = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25]];
    let patch = patch.map(|[x, y]| DVec3::new(x, y, 0.5)).to_vec();
    let model = checked(&cube.joined(&Mesh::new(patch, vec![[0, 1, 2]]).unwrap()));
    let all = model.concavities();
    assert_eq!(all.negative_caps().len(), 1);
    assert!(all.crossed_facets().is_empty());
    assert!((all.iter().map(|c| c.measures.cap_area).sum::<f64>() + 0.125).abs() < 1e-15);

    let (_, report) = Model::build(model.mesh().clone(), &BuildOptions::default()).unwrap();
    let found = report.findings.iter().find(|f| f.kind == FindingKind::NegativeCap).unwrap();
    let corners: Vec<u32> = (8..11).collect();
    assert_eq!((&found.ids, found.measure), (&corners, 0.125));
    assert!((found.at - DVec3::new(0.25 / 3.0, -0.25 / 3.0, 0.5)).length() < 1e-15);
    assert!(!report.is_sound());
}

#[test]
fn flatness_is_chosen_by_the_coordinates() {
    let mesh = turned(&Torus::default().build().unwrap());
    let single = rounded_to_single(&mesh);
    let flatness = |mesh: &Mesh, flatness: Flatness| {
        let options = BuildOptions { flatness, ..BuildOptions::default() };
        Model::build(mesh.clone(), &options).unwrap().1.flatness
    };
    assert_eq!(flatness(&mesh, Flatness::Auto), cranny_geometry::hull::FLATNESS);
    assert_eq!(flatness(&single, Flatness::Auto), Flatness::SINGLE);
    assert_eq!(flatness(&single, Flatness::Double), cranny_geometry::hull::FLATNESS);
    // The default torus reaches to 1.4: its largest coordinate decides.
    let largest = mesh.vertices().iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let decimals = |n| flatness(&rounded_to_decimals(&mesh, n), Flatness::Auto) * largest;
    assert!((decimals(6) - 2e-6).abs() < 1e-11 && (decimals(5) - 2e-5).abs() < 1e-9);
    assert_eq!(decimals(3) / largest, Flatness::DECIMAL_LIMIT);
    assert!((decimals(9) - 2e-9).abs() < 1e-14);
    assert_eq!(flatness(&rounded_to_digits(&mesh, 9), Flatness::Auto), Flatness::SINGLE);
    assert_eq!(flatness(&mesh, Flatness::Relative(-1.0)), 0.0);
    assert_eq!(flatness(&mesh, Flatness::Relative(f64::NAN)), 0.0);
}

/// Everything that must not depend on scale and numbering: per face its class, and per concavity its
/// kind, lids, loops and the faces in it, by the names that `name` gives them.
fn classification(model: &Model, name: impl Fn(FaceId) -> usize) -> Vec<Vec<usize>> {
    let mut classes = Vec::new();
    for concavity in model.concavities().iter() {
        let mut class: Vec<usize> = concavity.faces.iter().map(|&f| name(f)).collect();
        class.sort_unstable();
        class.extend([concavity.lids().len(), concavity.loops().len(), concavity.kind as usize]);
        classes.push(class);
    }
    for set in 0..model.features().convex_sets().len() as u32 {
        let of_set = |&f: &FaceId| {
            model.features().convex_set_of(f) == Some(cranny_geometry::ConvexSetId(set))
        };
        let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
        let mut class: Vec<usize> = faces.filter(of_set).map(&name).collect();
        class.sort_unstable();
        classes.push(class);
    }
    classes.sort_unstable();
    classes
}

#[test]
fn scaling_by_powers_of_two_and_renumbering_change_nothing() {
    let mut rng = Rng::new(11);
    for shape in Shape::defaults() {
        let mesh = turned(&shape.build().unwrap());
        if mesh.faces().len() > 10_000 {
            continue;
        }
        let model = closed_checked(&mesh);
        let expected = classification(&model, FaceId::index);
        for scale in [2f64.powi(-30), 2f64.powi(40)] {
            let scaled = closed_checked(&moved(&mesh, |p| scale * p));
            assert_eq!(classification(&scaled, FaceId::index), expected, "{}", shape.name());
        }
        let (renumbered, name) = bodies::renumbered(&mesh, &mut rng);
        let model = closed_checked(&renumbered);
        assert_eq!(classification(&model, |f| name[f.index()]), expected, "{}", shape.name());
    }
}

#[test]
fn golf_balls_have_a_concavity_for_each_dimple() {
    // Few dimples are far apart: a small share of the spacing makes them as small as many are.
    let few = (1..=9).map(|dimples| (dimples, 5_000, 0.2, 0.1));
    let many = [(24, 5_000, 0.4), (60, 12_000, 0.7), (150, 12_000, 0.7), (336, 20_480, 0.7)];
    for (dimples, triangles, coverage, dimple_depth) in
        few.chain(many.map(|(dimples, triangles, coverage)| (dimples, triangles, coverage, 0.03)))
    {
        let ball = GolfBall { dimples, triangles, coverage, dimple_depth, ..GolfBall::default() };
        let mesh = ball.build().unwrap();
        for mesh in [mesh.clone(), rounded_to_single(&turned(&mesh))] {
            let model = closed_checked(&mesh);
            let pocket = (ConcavityKind::Pocket, 1, 1);
            assert_eq!(census(&model), vec![pocket; dimples as usize], "{dimples} dimples");
            assert_eq!(model.features().convex_sets().len(), 1);
        }
    }
}

#[test]
fn random_bodies_keep_the_invariants() {
    let mut rng = Rng::new(5);
    for _ in 0..60 {
        let body = bodies::random_blocks(&mut rng);
        closed_checked(&body);
        closed_checked(&turned(&body));
        closed_checked(&rounded_to_single(&turned(&body)));
    }
}

/// The hull of some points, as a mesh of its triangles.
fn hull_of(points: &[DVec3]) -> Option<Mesh> {
    let hull = ConvexHull::of_points(points);
    let corners = |t: usize| hull.triangle(t).map(|v| v.0);
    let faces = (0..hull.triangle_count()).map(corners).collect();
    (hull.kind() == HullKind::Volume).then(|| Mesh::new(hull.positions().to_vec(), faces).unwrap())
}

#[test]
fn hulls_of_lattice_points_are_convex_however_they_are_rounded() {
    let mut rng = Rng::new(8);
    for round in 0..120 {
        let reach = rng.between(1, 6);
        let mut point = || DVec3::from_array([0; 3].map(|_| f64::from(rng.between(-reach, reach))));
        let points: Vec<DVec3> = (0..40).map(|_| point()).collect();
        let Some(mesh) = hull_of(&points) else { continue };
        let turned = turned(&mesh);
        for mesh in
            four_ways(&mesh).into_iter().chain([rounded_to_decimals(&turned, 4 + round % 3)])
        {
            let model = closed_checked(&mesh);
            assert_eq!(model.features().convex_sets().len(), 1, "round {round}");
            assert_eq!(census(&model), [], "round {round}");
        }
    }
}

#[test]
fn soups_of_triangles_keep_the_invariants_up_to_their_edges() {
    let mut rng = Rng::new(6);
    for round in 0..400 {
        let (points, faces) = (3 + rng.below(12), 1 + rng.below(30));
        // Reach 0 in an axis gives flat soups, reach 1 and 2 many coplanar and coincident faces.
        let reach = [rng.between(0, 3), rng.between(1, 3), rng.between(1, 8)];
        let mut point = || DVec3::from_array(reach.map(|r| f64::from(rng.between(-r, r))));
        let vertices: Vec<DVec3> = (0..points).map(|_| point()).collect();
        let faces = (0..faces).map(|_| [0; 3].map(|_| rng.below(points) as u32)).collect();
        let soup = Mesh::new(vertices, faces).unwrap();
        if Model::build(soup.clone(), &BuildOptions::default()).is_ok() {
            checked(&soup);
            if round % 2 == 0 {
                checked(&turned(&soup));
            }
        }
    }
}
