//! Rounding, scale, numbering and the choice of diagonals change no class.

use crate::body::Body;
use cranny_concavity::{Border, ConcavityKind, Cover};
use cranny_exact::DVec3;
use cranny_geometry::hull::FacetId;
use cranny_geometry::{BuildOptions, FaceId, Finding, FindingKind, Flatness, Mesh};
use cranny_shapes::{Cuboid, Cylinder, Gear, Shape, Sphere, Torus};
use cranny_testkit::Rng;

use super::bodies;
use super::check::closed_checked;
use super::ways::{
    census, four_ways, moved, rounded_to_decimals, rounded_to_digits, rounded_to_single, turned,
};

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

/// A cup whose base and floor are fans about their middles.
fn cup_of_fans(segments: u32) -> Mesh {
    let rings = [(1.0, 0.0), (1.0, 2.0), (0.9, 2.0), (0.9, 0.1)];
    let mut vertices = vec![DVec3::ZERO];
    for (radius, height) in rings {
        vertices.extend((0..segments).map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(segments);
            DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
        }));
    }
    vertices.push(DVec3::new(0.0, 0.0, 0.1));
    let at = |ring: u32, k: u32| 1 + ring * segments + k % segments;
    let mut faces = Vec::new();
    for k in 0..segments {
        faces.push([0, at(0, k + 1), at(0, k)]);
        for ring in 0..3 {
            let [a, b] = [at(ring, k), at(ring, k + 1)];
            let [c, d] = [at(ring + 1, k + 1), at(ring + 1, k)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
        faces.push([at(3, k), at(3, k + 1), 1 + 4 * segments]);
    }
    Mesh::new(vertices, faces).unwrap()
}

/// The base and rim of a cup as it is drawn lie in planes to the last digit: no lid of theirs is
/// left over.
#[test]
fn drawn_sides_are_flat_at_any_flatness() {
    for segments in 5..40 {
        for flatness in [0.0, f64::NAN, f64::EPSILON, 1e-15] {
            let options =
                BuildOptions { flatness: Flatness::Relative(flatness), ..BuildOptions::default() };
            let model = Body::build(cup_of_fans(segments), &options).unwrap().0;
            assert_eq!(census(&model), [(ConcavityKind::Pocket, 1, 1)], "{segments}, {flatness}");
            assert_eq!(model.concavities().negative_caps().len(), 0, "{segments}, {flatness}");
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
    // The top of a cube, one corner lower: the hull folds it from 5 to 6, the mesh from 4 to 7,
    // which makes a dent half as deep as the corner is low. Facets merge up to 1, slabs are 2 deep.
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
        let model = Body::build(Mesh::new(vertices, faces).unwrap(), &options).unwrap().0;
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
    // A pentagon A B E C D, C the tip. The hull has A B C, with D somewhat lower and E lower still.
    // The mesh is a fan about D: A B D lies on A B C, to within its slab, and on A C D beside it; B
    // E D and E C D are off the hull.
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
    let (model, report) = Body::build(mesh, &options).unwrap();
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

/// A prism of height 1 over a convex polygon, its top cut anyhow. Every corner of the top lies as
/// far below its plane as `depth` says.
pub(crate) fn prism_cut_anyhow(
    corners: u32,
    rng: &mut Rng,
    mut depth: impl FnMut(&mut Rng) -> f64,
) -> Mesh {
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
        let (model, report) = Body::build(mesh, &options).unwrap();
        let all = model.concavities();
        all.validate(model.mesh(), model.topology(), model.hull(), model.features()).unwrap();
        shared += usize::from(all.shared_facets().next().is_some());
        let reported =
            |f: &&Finding| matches!(f.kind, FindingKind::NegativeCap | FindingKind::CrossedCap);
        let found = report.findings.iter().find(reported);
        assert_eq!(found, None, "round {round}");
    }
    assert!(shared > 40, "{shared}");
}

#[test]
fn shallow_pockets_on_a_lattice_stay() {
    // Whole numbers: holes of a thousandth of the body's size deep, and less, in plates that reach
    // to 2000 and on.
    let plate = bodies::gridded_cuboid([3, 3, 2], |x, y| (x, y) == (1, 1));
    for (side, depth) in [(500.0, 1.0), (3_000.0, 1.0), (10_000.0, 4.0), (100_000.0, 40.0)] {
        let deep = |p: DVec3| DVec3::new(p.x * side, p.y * side, p.z * depth);
        let model = closed_checked(&moved(&plate, deep));
        assert_eq!(census(&model), [(ConcavityKind::Passage, 2, 2)], "{side} by {depth}");
    }
}

#[test]
fn flatness_is_chosen_by_the_coordinates() {
    let mesh = turned(&Torus::default().build().unwrap());
    let single = rounded_to_single(&mesh);
    let flatness = |mesh: &Mesh, flatness: Flatness| {
        let options = BuildOptions { flatness, ..BuildOptions::default() };
        Body::build(mesh.clone(), &options).unwrap().1.flatness
    };
    assert_eq!(flatness(&mesh, Flatness::Auto), cranny_geometry::hull::FLATNESS);
    assert_eq!(flatness(&single, Flatness::Auto), Flatness::SINGLE);
    assert_eq!(flatness(&single, Flatness::Double), cranny_geometry::hull::FLATNESS);
    // The default torus reaches to 1.4: its largest coordinate decides.
    let largest = mesh.vertices().iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let decimals = |n| flatness(&rounded_to_decimals(&mesh, n), Flatness::Auto) * largest;
    assert!((decimals(6) - 2e-6).abs() < 1e-11 && (decimals(5) - 2e-5).abs() < 1e-9);
    assert_eq!(decimals(3) / largest, Flatness::GRID_LIMIT);
    // Nine decimals are finer than single precision.
    assert!((decimals(9) - 2e-9).abs() < 1e-14);
    assert_eq!(flatness(&rounded_to_digits(&mesh, 9), Flatness::Auto), Flatness::SINGLE);
    assert_eq!(flatness(&mesh, Flatness::Relative(-1.0)), Flatness::LEAST);
    assert_eq!(flatness(&mesh, Flatness::Relative(f64::NAN)), Flatness::LEAST);
}

/// Everything that must not depend on scale and numbering: per face its class, and per concavity
/// its kind, lids, loops and the faces in it, by the names that `name` gives them.
pub(crate) fn classification(model: &Body, name: impl Fn(FaceId) -> usize) -> Vec<Vec<usize>> {
    let mut classes = Vec::new();
    for concavity in model.concavities().iter() {
        let mut class: Vec<usize> = concavity.faces.iter().map(|&f| name(f)).collect();
        class.sort_unstable();
        class.extend([concavity.lids().len(), concavity.loops().len(), concavity.kind as usize]);
        classes.push(class);
    }
    for set in 0..model.features().convex_sets().len() as u32 {
        let of_set = |&f: &FaceId| {
            model.features().convex_set_of(f) == Some(cranny_concavity::ConvexSetId(set))
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
fn rounded_meshes_in_other_units_keep_their_classes() {
    let torus =
        Torus { major_segments: 48, minor_segments: 24, ..Torus::default() }.build().unwrap();
    let peg = Cylinder { segments: 144, ..Cylinder::default() }.build().unwrap();
    let gear = Gear::default().build().unwrap();
    for mesh in [torus, peg, gear].map(|mesh| turned(&mesh)) {
        for stored in [rounded_to_decimals(&mesh, 6), rounded_to_digits(&mesh, 6)] {
            let expected = census(&closed_checked(&stored));
            for unit in [2f64.powi(-9), 8.0, 2f64.powi(30)] {
                let model = closed_checked(&moved(&stored, |p| unit * p));
                assert_eq!(census(&model), expected, "unit {unit:e}");
            }
        }
        let stored = rounded_to_decimals(&mesh, 6);
        let expected = census(&closed_checked(&stored));
        for unit in [1e-3, 0.0254, 25.4] {
            let model = closed_checked(&moved(&stored, |p| unit * p));
            assert_eq!(census(&model), expected, "unit {unit:e}");
        }
        // Six decimals of a body of this size are still seen in single precision.
        assert_eq!(census(&closed_checked(&rounded_to_single(&stored))), expected);
    }
}

/// A frustum between two regular polygons.
fn frustum(corners: u32, bottom: (f64, f64), top: (f64, f64)) -> Mesh {
    let ring = |(radius, z): (f64, f64)| {
        (0..corners).map(move |i| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(corners);
            DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
    };
    let side = |i: u32| {
        let j = (i + 1) % corners;
        [[i, j, corners + j], [i, corners + j, corners + i]]
    };
    let lids = (2..corners).flat_map(|i| [[0, i, i - 1], [corners, corners + i - 1, corners + i]]);
    let faces = (0..corners).flat_map(side).chain(lids).collect();
    Mesh::new(ring(bottom).chain(ring(top)).collect(), faces).unwrap()
}

#[test]
fn frusta_with_round_sizes_have_no_dents_of_rounding() {
    for corners in [6, 8, 12] {
        for (bottom, top) in
            [((4.7, 0.0), (5.5, 2.5)), ((1.0, -1.0), (0.7, 1.0)), ((1.0, 0.0), (0.8, 1.0))]
        {
            let frustum = rounded_to_decimals(&frustum(corners, bottom, top), 6);
            assert_eq!(census(&closed_checked(&frustum)), [], "{corners} corners, {top:?}");
        }
    }
}
