//! Concavities, lids and loops, counted by hand.

use crate::body::Body;
use cranny_concavity::features::Feature;
use cranny_concavity::{Border, ConcavityKind, Cover};
use cranny_concavity::{CapId, ConcavityId};
use cranny_exact::DVec3;
use cranny_geometry::hull::FacetId;
use cranny_geometry::{BuildOptions, FindingKind, Mesh};
use cranny_shapes::{
    Comb, Cuboid, Cup, Gear, GolfBall, IsoBolt, IsoNut, NestedShells, PyramidInCavity, UPrism,
};

use super::bodies;
use super::check::{checked, closed_checked};
use super::ways::{census, four_ways, moved, rounded_to_single, turned};

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
        let lid = model.concavities().lid(cranny_concavity::LidId(0));
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
        let lid = Cover::Lid(ConcavityId(0));
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
fn a_solid_in_the_matter_of_another_is_an_island_without_a_parent() {
    let shell = |size: f64| Cuboid { size: [size; 3] }.build().unwrap();
    let (model, report) =
        Body::build(shell(4.0).joined(&shell(1.0)), &BuildOptions::default()).unwrap();
    let all: Vec<_> = model.concavities().iter().map(|c| (c.kind, c.parent)).collect();
    assert_eq!(all, [(ConcavityKind::Island, None)]);
    assert!(report.findings.iter().any(|f| f.kind == FindingKind::NestedSolid));
}

#[test]
fn notches_that_share_nothing_but_an_edge_are_one_passage() {
    // Two cells side by side across the diagonal: four faces at the edge between them.
    let mesh = bodies::of_cells([2, 2, 1], |[x, y, _]| x == y);
    let model = closed_checked(&mesh);
    assert_eq!(census(&model), [(ConcavityKind::Passage, 2, 2)]);
    assert_eq!(model.concavities().get(ConcavityId(0)).faces.len(), 8);
}

#[test]
fn a_pebble_in_a_cup_has_the_well_for_parent_and_a_peg_flush_with_the_rim_shares_it() {
    let cup = Cup { segments: 12, ..Cup::default() }.build().unwrap();
    let pebble = moved(&Cuboid { size: [0.1; 3] }.build().unwrap(), |p| p + 0.5 * DVec3::Z);
    let model = closed_checked(&cup.clone().joined(&pebble));
    let kinds: Vec<_> = model.concavities().iter().map(|c| (c.kind, c.parent)).collect();
    let well = ConcavityId(0);
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
    assert_eq!(all.iter().map(|c| c.kind).collect::<Vec<_>>(), [ConcavityKind::Overlay]);
    assert_eq!(all.negative_caps().len(), 1);
    assert!(all.crossed_facets().is_empty());
    assert!((all.iter().map(|c| c.measures.cap_area).sum::<f64>() + 0.125).abs() < 1e-15);

    let (_, report) = Body::build(model.mesh().clone(), &BuildOptions::default()).unwrap();
    let found = report.findings.iter().find(|f| f.kind == FindingKind::NegativeCap).unwrap();
    let corners: Vec<u32> = (8..11).collect();
    assert_eq!((&found.ids, found.measure), (&corners, 0.125));
    assert!((found.at - DVec3::new(0.25 / 3.0, -0.25 / 3.0, 0.5)).length() < 1e-15);
    assert!(!report.is_sound());
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
