//! Contacts across a gap, within a margin.

use std::f64::consts::PI;

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Contact, Demand, Feature, Placed};
use cranny_shapes::{Cuboid, Cup, GolfBall, Torus};
use cranny_testkit::{Rng, from_surface, world_triangles};

use crate::solids::{ask, at, model, octahedron, shape};

/// Asks with a margin, after checking what holds of every contact across a gap.
fn gaps(a: Placed, b: Placed, margin: f64) -> Answer {
    let answer = ask(a, b, Demand::Regions { margin });
    let (faces_a, faces_b) = (world_triangles(a.model, &a.pose), world_triangles(b.model, &b.pose));
    let tiny = 1e-12 * (a.model.radius() + b.model.radius());
    for r in answer.regions.iter().filter(|r| r.deepest.separation > 0.0) {
        assert_eq!((r.depth, r.area, r.curves.len(), r.triangle_pairs), (None, None, 0, 0));
        assert_eq!(r.deepest, r.points[0]);
        assert_eq!(r.normal, r.deepest.normal);
        for c in &r.points {
            assert!(c.separation > 0.0 && c.separation <= margin + tiny, "{c:?}");
            assert!(c.separation >= r.deepest.separation, "{c:?}");
            assert!((c.normal.length() - 1.0).abs() < 1e-12, "{c:?}");
            let along = c.point_b - c.point_a;
            assert!((along - c.normal * c.separation).length() < tiny, "{c:?}");
            assert!(from_surface(c.point_a, &faces_a) < tiny, "{c:?}");
            assert!(from_surface(c.point_b, &faces_b) < tiny, "{c:?}");
        }
    }
    if answer.surface == Meeting::None && answer.distance.unwrap() > margin {
        assert!(answer.regions.is_empty());
    }
    answer
}

fn has(contacts: &[Contact], spot: DVec3, bound: f64) -> bool {
    contacts.iter().any(|c| (c.point_b - spot).length() < bound)
}

#[test]
fn a_box_over_a_box_stands_on_its_four_corners() {
    let (slab, unit) = (shape(Cuboid { size: [4.0, 4.0, 1.0] }), shape(Cuboid::default()));
    for (x, y) in [(0.0, 0.0), (0.3, -0.7), (1.25, 1.25)] {
        let answer = gaps(at(&slab, 0.0, 0.0, 0.0), at(&unit, x, y, 1.01), 0.02);
        assert_eq!(answer.regions.len(), 1);
        for c in &answer.contacts {
            assert_eq!(c.normal, DVec3::Z);
            assert!((c.separation - 0.01).abs() < 1e-15, "{c:?}");
        }
        for (dx, dy) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
            let corner = DVec3::new(x + dx, y + dy, 0.51);
            assert!(has(&answer.contacts, corner, 1e-12), "{corner}: {:#?}", answer.contacts);
        }
        assert!(answer.contacts.len() <= 8, "{}", answer.contacts.len());
    }
}

#[test]
fn a_tilted_box_still_has_its_four_corners() {
    let (slab, unit) = (shape(Cuboid { size: [4.0, 4.0, 1.0] }), shape(Cuboid::default()));
    let tilt = 0.05 * PI / 180.0;
    let rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), tilt);
    let pose = Pose { rotation, translation: DVec3::new(0.31, -0.17, 1.01) };
    let placed = Placed { model: &unit, pose };
    let answer = gaps(at(&slab, 0.0, 0.0, 0.0), placed, 0.02);
    let map = pose.world_from_body();
    for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
        let corner = map.apply(DVec3::new(x, y, -0.5));
        assert!(has(&answer.contacts, corner, 1e-12), "{corner}: {:#?}", answer.contacts);
    }
    for c in &answer.contacts {
        assert!(c.normal.dot(DVec3::Z) > (2.0 * tilt).cos(), "{c:?}");
    }
}

#[test]
fn a_box_over_the_rim_of_a_box_keeps_hold_of_the_rim() {
    // Half of the unit hangs over: it is held where its sides cross the slab's rim and at two
    // corners.
    let (slab, unit) = (shape(Cuboid { size: [4.0, 4.0, 1.0] }), shape(Cuboid::default()));
    let answer = gaps(at(&slab, 0.0, 0.0, 0.0), at(&unit, 2.1, 0.3, 1.01), 0.02);
    for y in [-0.2, 0.8] {
        assert!(has(&answer.contacts, DVec3::new(1.6, y, 0.51), 1e-12), "{:#?}", answer.contacts);
        assert!(has(&answer.contacts, DVec3::new(2.0, y, 0.51), 1e-12), "{:#?}", answer.contacts);
    }
    assert!(answer.contacts.iter().all(|c| c.normal.dot(DVec3::Z) > 1.0 - 1e-12));
}

#[test]
fn crossed_bars_meet_edge_to_edge() {
    // Square bars on edge, at right angles: the common perpendicular is z.
    let bar = shape(Cuboid { size: [0.5, 0.5, 4.0] });
    let lying = DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt());
    let on_edge = DQuat::from_axis_angle(DVec3::Y, PI / 4.0) * lying;
    let across = DQuat::from_axis_angle(DVec3::Z, PI / 2.0) * on_edge;
    let reach = 0.5 * 0.5 * 2f64.sqrt();
    let above = Pose { rotation: across, translation: DVec3::new(0.1, 0.2, 2.0 * reach + 0.01) };
    let lower = Pose { rotation: on_edge, translation: DVec3::ZERO };
    let answer =
        gaps(Placed { model: &bar, pose: lower }, Placed { model: &bar, pose: above }, 0.02);
    assert_eq!(answer.contacts.len(), 1, "{:#?}", answer.contacts);
    let c = &answer.contacts[0];
    assert!(matches!(c.id, (Feature::Edge(_), Feature::Edge(_))), "{c:?}");
    assert!((c.normal - DVec3::Z).length() < 1e-12, "{c:?}");
    assert!((c.separation - 0.01).abs() < 1e-12, "{c:?}");
    assert!((answer.distance.unwrap() - 0.01).abs() < 1e-12);
}

#[test]
fn a_knife_on_its_side_still_cuts() {
    // Knives of 20 degrees along z, edges crossed; the upper one leans by 60 degrees about its
    // edge, so that the contact's normal lies more than 90 degrees from one of its faces' normals.
    let blade = (10.0 * PI / 180.0).tan();
    let outline = [[0.0, 0.0], [blade, 1.0], [-blade, 1.0]];
    let knife = model(crate::solids::prism(&outline, &[[0, 1, 2]], 4.0));
    let below = DQuat::from_axis_angle(DVec3::Z, PI);
    let lean = DQuat::from_axis_angle(DVec3::Z, PI / 3.0);
    let across = DQuat::from_axis_angle(DVec3::Y, PI / 2.0);
    let lower = Placed { model: &knife, pose: Pose { rotation: below, translation: DVec3::ZERO } };
    let rotation = across * lean;
    let translation = DVec3::new(-2.0, 0.01, 2.1);
    let upper = Placed { model: &knife, pose: Pose { rotation, translation } };
    let answer = gaps(lower, upper, 0.02);
    assert!((answer.distance.unwrap() - 0.01).abs() < 1e-12);
    assert_eq!(answer.contacts.len(), 1, "{:#?}", answer.contacts);
    assert!((answer.contacts[0].normal - DVec3::Y).length() < 1e-9, "{:?}", answer.contacts);
}

#[test]
fn corner_to_corner_has_a_contact_too() {
    // Two octahedra, apex over apex: nearest are two vertices, in front of no face and no edge.
    let spike = model(octahedron());
    for offset in [DVec3::new(0.0, 0.0, 2.01), DVec3::new(0.002, 0.001, 2.01)] {
        let answer =
            gaps(at(&spike, 0.0, 0.0, 0.0), at(&spike, offset.x, offset.y, offset.z), 0.02);
        let distance = answer.distance.unwrap();
        assert!((distance - (offset - 2.0 * DVec3::Z).length()).abs() < 1e-12);
        let nearest = answer.contacts.first().expect("something within the margin");
        assert!((nearest.separation - distance).abs() < 1e-12, "{nearest:?}");
    }
}

/// Wherever a margin reaches the nearest points, a contact stands at that distance.
#[test]
fn the_nearest_points_are_a_contact() {
    let bodies = [
        shape(Cuboid::default()),
        shape(Cup { segments: 12, ..Cup::default() }),
        shape(Torus { major_segments: 16, minor_segments: 8, ..Torus::default() }),
        shape(GolfBall { dimples: 0, triangles: 80, ..GolfBall::default() }),
        model(octahedron()),
    ];
    let mut rng = Rng::new(31);
    for _ in 0..150 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let mut turn =
            || DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit() + 1.5).normalize();
        let a = Placed { model: a, pose: Pose { rotation: turn(), translation: DVec3::ZERO } };
        let far = turn() * DVec3::new(0.0, 0.0, 3.0);
        let pose = Pose { rotation: turn(), translation: far };
        let b = Placed { model: b, pose };
        let apart = ask(a, b, Demand::Distance { below: None }).distance.unwrap();
        let answer = gaps(a, b, apart + 0.01);
        assert_eq!(answer.distance, Some(apart));
        let nearest = answer.contacts.first().expect("something within the margin");
        assert!((nearest.separation - apart).abs() < 1e-9, "{nearest:?}, {apart}");
    }
}

#[test]
fn the_back_of_a_thin_plate_does_not_touch() {
    // 0.01 thick, the margin reaches through it.
    let (plate, unit) = (shape(Cuboid { size: [4.0, 4.0, 0.01] }), shape(Cuboid::default()));
    let answer = gaps(at(&plate, 0.0, 0.0, 0.0), at(&unit, 0.3, 0.2, 0.515), 0.1);
    assert!(!answer.contacts.is_empty());
    for c in &answer.contacts {
        assert!((c.normal - DVec3::Z).length() < 1e-12, "{c:?}");
        assert!((c.separation - 0.01).abs() < 1e-12, "{c:?}");
    }
    // A thin plate over a thin plate, both backs within the margin.
    let answer = gaps(at(&plate, 0.0, 0.0, 0.0), at(&plate, 0.3, 0.2, 0.03), 0.1);
    assert!(!answer.contacts.is_empty());
    for c in &answer.contacts {
        assert!((c.normal - DVec3::Z).length() < 1e-9, "{c:?}");
        assert!((c.separation - 0.02).abs() < 1e-12, "{c:?}");
    }
}

#[test]
fn nothing_beyond_the_margin() {
    let unit = shape(Cuboid::default());
    let near = gaps(at(&unit, 0.0, 0.0, 0.0), at(&unit, 0.1, 0.2, 1.1), 0.1 + 1e-9);
    assert!(!near.regions.is_empty());
    let far = gaps(at(&unit, 0.0, 0.0, 0.0), at(&unit, 0.1, 0.2, 1.1), 0.1 - 1e-9);
    assert!(far.regions.is_empty() && far.contacts.is_empty());
    assert!((far.distance.unwrap() - 0.1).abs() < 1e-15);
}

/// The normal of the torus about z at the point of it nearest to `p`, outward.
fn tube_normal(p: DVec3) -> DVec3 {
    let ring = DVec3::new(p.x, p.y, 0.0).normalize();
    (p - ring).normalize()
}

#[test]
fn contacts_of_fine_tori_have_the_normals_of_the_smooth_ones() {
    let torus: Model = shape(Torus { major_segments: 96, minor_segments: 32, ..Torus::default() });
    // B through A's hole, its tube 0.01 from A's inner side, and turned a bit so that nothing
    // aligns.
    let turned = DQuat::from_axis_angle(DVec3::new(1.0, 0.03, 0.02).normalize(), 1.5);
    let a = at(&torus, 0.0, 0.0, 0.0);
    let pose = Pose { rotation: turned, translation: DVec3::new(1.59, 0.01, 0.02) };
    let b = Placed { model: &torus, pose };
    let answer = gaps(a, b, 0.03);
    assert!(answer.contacts.len() >= 3, "{}", answer.contacts.len());
    let map = pose.world_from_body();
    // Chords span 2π/32 around the tube and as much as 0.8·2π/96 along it: half of each off.
    let tessellation = PI / 32.0 + PI / 96.0;
    for c in &answer.contacts {
        let of_a = tube_normal(c.point_a);
        let of_b = map.apply_vector(tube_normal(map.inverse().apply(c.point_b)));
        let off = c.normal.angle_between(of_a).min(c.normal.angle_between(-of_b));
        assert!(off <= 1.2 * tessellation, "{off}: {c:?}");
    }
}
