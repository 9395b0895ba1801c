//! Regions of contact against closed forms.

use std::f64::consts::PI;

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Contact, Demand, Placed, Region};
use cranny_shapes::{Cuboid, Sphere, Torus};
use cranny_testkit::{from_surface, world_triangles};

use crate::solids::{ask, at, cells, channel, cuboid, inverted, model, shape};

/// Special positions are read from 2^-30 of the pair's scale beside; the pairs here are a few long.
const SPECIAL: f64 = 1e-7;

/// Asks for regions, after checking what holds of all of them.
pub(crate) fn regions(a: Placed, b: Placed) -> Answer {
    let answer = ask(a, b, Demand::Regions { margin: 0.0 });
    let (faces_a, faces_b) = (world_triangles(a.model, &a.pose), world_triangles(b.model, &b.pose));
    let size = a.model.radius() + b.model.radius();
    let closed = a.model.is_closed() && b.model.is_closed();
    for r in &answer.regions {
        assert!((r.normal.length() - 1.0).abs() < 1e-12, "{}", r.normal);
        assert_eq!(r.deepest, r.points[0]);
        assert!(r.triangle_pairs > 0);
        for c in &r.points {
            assert!((c.normal.length() - 1.0).abs() < 1e-12, "{c:?}");
            assert!(r.deepest.separation <= c.separation, "{r:?}");
            let along = (c.point_b - c.point_a).dot(c.normal);
            assert!((along - c.separation).abs() < 1e-12 * size, "{along}, {c:?}");
            assert!(c.separation <= 0.0, "{c:?}");
            let off = from_surface(c.point_a, &faces_a).max(from_surface(c.point_b, &faces_b));
            assert!(off < SPECIAL * size, "{off}: {c:?}");
        }
        for curve in &r.curves {
            assert!(curve.closed || !closed, "{curve:?}");
            for &p in &curve.points {
                let off = from_surface(p, &faces_a).max(from_surface(p, &faces_b));
                assert!(off < SPECIAL * size, "{off}");
            }
        }
        if closed {
            assert!(r.area.unwrap() >= 0.0 && r.depth.unwrap() >= 0.0);
            assert!((r.deepest.separation + r.depth.unwrap()).abs() <= 1e-12 * size);
        }
    }
    let contacts: Vec<_> = answer.regions.iter().flat_map(|r| r.points.clone()).collect();
    assert_eq!(answer.contacts, contacts);
    assert_eq!(answer.regions.is_empty(), answer.surface == Meeting::None);
    answer
}

fn reported(answer: &Answer) -> String {
    let line = |r: &Region| {
        let n = r.points.len();
        format!("normal {} depth {:?} area {:?}, {n} points\n", r.normal, r.depth, r.area)
    };
    answer.regions.iter().map(line).collect()
}

fn only(answer: &Answer) -> &Region {
    assert_eq!(answer.regions.len(), 1, "{}", reported(answer));
    &answer.regions[0]
}

fn assert_near(found: f64, expected: f64, bound: f64) {
    assert!((found - expected).abs() <= bound, "{found}, not {expected} to within {bound}");
}

fn assert_along(found: DVec3, expected: DVec3, bound: f64) {
    let off = (found - expected).length();
    assert!(off <= bound, "{found}, not {expected}: {off} off, more than {bound}");
}

#[test]
fn boxes_flush_on_four_sides_overlap_by_a_slice() {
    let unit = shape(Cuboid::default());
    for (x, y, z) in [(0.9, 0.0, 0.0), (0.0, 0.9, 0.0), (0.0, 0.0, -0.9)] {
        let answer = regions(at(&unit, 0.0, 0.0, 0.0), at(&unit, x, y, z));
        let region = only(&answer);
        assert_near(region.depth.unwrap(), 0.1, 1e-6);
        assert_near(region.area.unwrap(), 1.0, 1e-6);
        assert_along(region.normal, DVec3::new(x, y, z) / 0.9, 1e-6);
        assert!(answer.separation.contains(-0.1), "{:?}", answer.separation);
        assert!(answer.separation.width() < 1e-6, "{:?}", answer.separation);
    }
}

#[test]
fn boxes_that_overlap_at_a_corner_share_a_cube() {
    // The overlap is a cube of 0.2. Its border runs along six of its edges, a hexagon about the
    // diagonal. Along it the cube is √3 · 0.2 long; the hexagon's shadow is two faces' worth,
    // 2/√3 · …
    let unit = shape(Cuboid::default());
    let answer = regions(at(&unit, 0.0, 0.0, 0.0), at(&unit, 0.8, 0.8, 0.8));
    let region = only(&answer);
    let side = 0.2;
    assert_along(region.normal, DVec3::ONE / 3f64.sqrt(), 1e-6);
    assert_near(region.depth.unwrap(), 3f64.sqrt() * side, 1e-6);
    assert_near(region.area.unwrap(), 3f64.sqrt() * side * side, 1e-6);
    assert_eq!(region.curves.len(), 1);
}

#[test]
fn a_generic_overlap_of_boxes_is_measured_to_rounding() {
    // A corner of B, turned so that its diagonal points down, dips into A's top.
    let slab = shape(Cuboid { size: [4.0, 4.0, 1.0] });
    let unit = shape(Cuboid::default());
    let down = DQuat::from_rotation_arc(DVec3::ONE.normalize(), -DVec3::Z);
    let dip = 0.125;
    let pose =
        Pose { rotation: down, translation: DVec3::new(0.1, 0.2, 0.5 + 0.75f64.sqrt() - dip) };
    let answer =
        regions(Placed { model: &slab, pose: Pose::IDENTITY }, Placed { model: &unit, pose });
    let region = only(&answer);
    assert_near(region.depth.unwrap(), dip, 1e-13);
    assert_along(region.normal, DVec3::Z, 1e-12);
    // Section of a cube's corner at height h over the apex: an equilateral triangle, side √6 h.
    assert_near(region.area.unwrap(), 3f64.sqrt() / 4.0 * 6.0 * dip * dip, 1e-12);
    assert_eq!(region.curves.len(), 1);
    assert_eq!(region.triangle_pairs, answer.triangle_pairs);
}

#[test]
fn a_sphere_in_a_sphere_is_as_deep_as_they_overlap() {
    let fine = |radius| shape(Sphere { radius, segments: 64, rings: 32 });
    let (large, small) = (fine(1.0), fine(0.5));
    let sagitta = 1.0 - (PI / 64.0).cos().powi(2);
    for direction in [DVec3::new(0.6, 0.48, 0.64), DVec3::X, DVec3::new(-0.8, 0.0, 0.6)] {
        for overlap in [0.05, 0.2] {
            let center = direction * (1.5 - overlap);
            let answer =
                regions(at(&large, 0.0, 0.0, 0.0), at(&small, center.x, center.y, center.z));
            let region = only(&answer);
            assert_near(region.depth.unwrap(), overlap, 2.0 * sagitta);
            assert_along(region.normal, direction, 0.05);
            assert_eq!(region.curves.len(), 1);
            // The circle in which the spheres meet.
            let d = 1.5 - overlap;
            let x = (d * d + 1.0 - 0.25) / (2.0 * d);
            let circle = PI * (1.0 - x * x);
            assert_near(region.area.unwrap(), circle, 0.05 * circle + 4.0 * sagitta);
        }
    }
}

#[test]
fn a_box_pressed_into_a_slab_by_one_side() {
    let slab = shape(Cuboid { size: [4.0, 4.0, 1.0] });
    let unit = shape(Cuboid::default());
    let answer = regions(at(&slab, 0.0, 0.0, 0.0), at(&unit, 0.3, 0.2, 0.9));
    let region = only(&answer);
    assert_near(region.depth.unwrap(), 0.1, 1e-6);
    assert_near(region.area.unwrap(), 1.0, 1e-6);
    assert_along(region.normal, DVec3::Z, 1e-6);
    // Stands on its four corners.
    let corners: Vec<_> = region.points.iter().filter(|c| c.separation < -0.09).collect();
    assert!(corners.len() >= 4, "{:#?}", region.points);
}

#[test]
fn a_peg_through_a_plate_is_one_region_with_two_rims() {
    let plate = shape(Cuboid { size: [4.0, 4.0, 0.5] });
    let peg = shape(Cuboid { size: [0.5, 0.5, 3.0] });
    let answer = regions(at(&plate, 0.0, 0.0, 0.0), at(&peg, 0.3, 0.2, 0.125));
    let region = only(&answer);
    assert_eq!(region.curves.len(), 2);
    assert_near(region.area.unwrap(), 0.0, 1e-9);
    // The pieces: a tube of the peg, 0.5 x 0.5 x 0.5, and two squares that close it. Moved by 0.5
    // along any axis they are apart.
    assert_near(region.depth.unwrap(), 0.5, 1e-9);
    assert_near(region.normal.abs().max_element(), 1.0, 1e-12);
}

#[test]
fn links_that_cross_meet_in_one_region() {
    let torus = shape(Torus { major_segments: 32, minor_segments: 12, ..Torus::default() });
    // B's tube passes at a right angle through A's hole, 0.05 into the inner side of A's tube.
    let turned = DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt());
    let pose = Pose { rotation: turned, translation: DVec3::new(1.65, 0.0, 0.0) };
    let answer =
        regions(Placed { model: &torus, pose: Pose::IDENTITY }, Placed { model: &torus, pose });
    let region = only(&answer);
    assert_eq!(region.curves.len(), 1);
    assert_near(region.depth.unwrap(), 0.05, 0.02);
    assert_along(region.normal, -DVec3::X, 0.05);
}

#[test]
fn a_bar_under_a_channel_meets_both_arms() {
    // Upside down over a bar that is narrower than the channel and enters both arms' ends.
    let channel = model(channel());
    let bar = model(cuboid([-1.1, 1.75, 0.53], [4.2, 2.5, 1.28]));
    let answer = regions(at(&channel, 0.0, 0.0, 0.0), at(&bar, 0.0, 0.0, 0.0));
    assert_eq!(answer.regions.len(), 2, "{}", reported(&answer));
    for region in &answer.regions {
        assert_along(region.normal, DVec3::Y, SPECIAL);
        assert_near(region.depth.unwrap(), 0.25, SPECIAL);
        assert_near(region.area.unwrap(), 0.75, SPECIAL);
        assert_eq!(region.curves.len(), 1);
    }
    let sum: u32 = answer.regions.iter().map(|r| r.triangle_pairs).sum();
    assert_eq!(sum, answer.triangle_pairs);
    let middle = |r: &Region| r.points.iter().map(|c| c.point_a.x).sum::<f64>();
    assert!(answer.regions.iter().any(|r| middle(r) < 1.0 * r.points.len() as f64));
    assert!(answer.regions.iter().any(|r| middle(r) > 2.0 * r.points.len() as f64));
}

#[test]
fn flush_faces_touch_with_the_area_of_their_overlap() {
    let (unit, slab) = (shape(Cuboid::default()), shape(Cuboid { size: [3.0, 3.0, 1.0] }));
    for (a, b, offset, area) in [
        (&unit, &unit, DVec3::new(1.0, 0.0, 0.0), 1.0),
        (&unit, &unit, DVec3::new(1.0, 0.25, 0.5), 0.375),
        (&slab, &unit, DVec3::new(0.25, -0.5, 1.0), 1.0),
        (&slab, &slab, DVec3::new(1.0, 2.0, 1.0), 2.0),
    ] {
        let answer = regions(at(a, 0.0, 0.0, 0.0), at(b, offset.x, offset.y, offset.z));
        assert!(!answer.solid);
        let region = only(&answer);
        assert_eq!(region.depth, Some(0.0));
        assert_near(region.area.unwrap(), area, 1e-14);
        let axis = if offset.z == 1.0 { DVec3::Z } else { DVec3::X };
        assert_eq!(region.normal, axis);
        assert_eq!(region.triangle_pairs, answer.triangle_pairs);
        assert_eq!(answer.distance, Some(0.0));
    }
}

#[test]
fn feet_on_a_floor_are_regions_of_their_own() {
    let floor = model(cuboid([-1.0, 2.0, -1.0], [4.0, 3.0, 3.0]));
    let answer = regions(at(&model(channel()), 0.0, 0.0, 0.0), at(&floor, 0.0, 0.0, 0.0));
    assert_eq!(answer.regions.len(), 2, "{}", reported(&answer));
    for region in &answer.regions {
        assert_near(region.area.unwrap(), 2.0, 1e-14);
        assert_eq!(region.normal, DVec3::Y);
        assert!(region.points.len() >= 4, "{:?}", region.points);
    }
}

#[test]
fn a_corner_or_an_edge_that_touches_has_the_normal_of_what_it_touches() {
    let floor = model(cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0]));
    let spike = model(crate::solids::octahedron());
    let answer = regions(at(&floor, 0.0, 0.0, 0.0), at(&spike, 0.25, -0.5, 1.0));
    let region = only(&answer);
    assert_eq!((region.depth, region.area), (Some(0.0), Some(0.0)));
    assert_eq!(region.normal, DVec3::Z);
    // Crossed edges: two wedges, ridge upon ridge at right angles.
    let ridge = model(crate::solids::prism(
        &[[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]],
        &[[0, 1, 2], [0, 2, 3]],
        2.0,
    ));
    let half = 0.5f64.sqrt();
    let across = DQuat::from_xyzw(0.0, half, 0.0, half);
    let answer = regions(
        at(&ridge, 0.0, 0.0, 0.0),
        Placed {
            model: &ridge,
            pose: Pose { rotation: across, translation: DVec3::new(-1.0, 2.0, 1.0) },
        },
    );
    let region = only(&answer);
    assert_eq!(answer.surface, Meeting::Touch);
    assert_along(region.normal, DVec3::Y, 1e-15);
}

/// Regions of solids that penetrate although no faces cross: read from beside.
#[test]
fn special_positions_that_penetrate_have_depth_and_area() {
    let unit = shape(Cuboid::default());
    // Flush on one side, sunk by half. Which body is shrunk first depends on the models' digests:
    // of several slabs, some come before the unit and some after.
    for width in [3.0, 4.0, 5.0, 6.0, 7.0, 8.0] {
        let slab = shape(Cuboid { size: [width, 4.0, 1.0] });
        let answer = regions(at(&slab, 0.0, 0.0, 0.0), at(&unit, 0.5 * width - 0.5, 0.0, 0.5));
        let region = only(&answer);
        // Contacts are measured at the pair's own position.
        assert_near(region.depth.unwrap(), 0.5, 1e-14);
        assert_near(region.area.unwrap(), 1.0, SPECIAL);
        assert_along(region.normal, DVec3::Z, SPECIAL);
    }
    // Subdivided against coarse: the cells' edges lie in the box's planes.
    let block = model(cells(&[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]));
    let bar = model(cuboid([0.0, 0.0, 0.75], [2.0, 2.0, 2.0]));
    let answer = regions(at(&block, 0.0, 0.0, 0.0), at(&bar, 0.0, 0.0, 0.0));
    let region = only(&answer);
    assert_near(region.depth.unwrap(), 0.25, 1e-14);
    assert_near(region.area.unwrap(), 4.0, SPECIAL);
    assert_along(region.normal, DVec3::Z, SPECIAL);
}

#[test]
fn bodies_that_coincide_or_touch_from_inside_have_a_region() {
    let unit = shape(Cuboid::default());
    let large = shape(Cuboid { size: [4.0, 4.0, 4.0] });
    let answer = regions(at(&unit, 0.0, 0.0, 0.0), at(&unit, 0.0, 0.0, 0.0));
    assert!(answer.solid && !answer.regions.is_empty());
    let answer = regions(at(&large, 0.0, 0.0, 0.0), at(&unit, 1.5, 0.0, 0.0));
    assert!(answer.contained.is_some() && !answer.regions.is_empty());
}

#[test]
fn open_surfaces_have_curves_but_neither_depth_nor_area() {
    let lid = |m: &Model| {
        let mesh = m.mesh();
        let faces = mesh.faces()[2..].to_vec();
        model(cranny_geometry::Mesh::new(mesh.vertices().to_vec(), faces).unwrap())
    };
    let open = lid(&model(cuboid([-0.5; 3], [0.5; 3])));
    assert!(!open.is_closed());
    let unit = shape(Cuboid::default());
    let answer = regions(at(&unit, 0.0, 0.0, 0.0), at(&open, 0.3, 0.4, 0.6));
    assert_eq!(answer.surface, Meeting::Cross);
    for region in &answer.regions {
        assert_eq!((region.depth, region.area), (None, None));
        assert!(!region.curves.is_empty());
    }
    // Touching it, one face flush.
    let answer = regions(at(&unit, 0.0, 0.0, 0.0), at(&open, 1.0, 0.0, 0.0));
    assert_eq!(answer.surface, Meeting::Touch);
    assert_eq!((only(&answer).depth, only(&answer).area), (None, None));
    // A box in the middle of a hollow box meets nothing.
    let hollow = model(cuboid([-2.0; 3], [2.0; 3]).joined(&inverted(&cuboid([-1.0; 3], [1.0; 3]))));
    let answer = regions(at(&hollow, 0.0, 0.0, 0.0), at(&unit, 0.0, 0.0, 0.0));
    assert!(answer.regions.is_empty() && !answer.solid);
}

/// A corner that touches hangs on no curve.
#[test]
fn open_surfaces_cross_in_one_place_and_touch_in_another() {
    let mesh = |corners: &[[f64; 3]]| {
        let faces = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]);
        let vertices = corners.iter().map(|&p| DVec3::from_array(p));
        model(cranny_geometry::Mesh::new(vertices.collect(), faces.collect()).unwrap())
    };
    let floor = mesh(&[[-10.0, -10.0, 0.0], [10.0, -10.0, 0.0], [0.0, 10.0, 0.0]]);
    let crossing = [[0.0, 0.0, -1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
    let touching = [[3.0, 0.0, 0.0], [3.0, 1.0, 1.0], [4.0, 0.0, 1.0]];
    for flaps in [[crossing, touching], [touching, crossing]] {
        let flaps = mesh(&flaps.concat());
        for [a, b] in [[&floor, &flaps], [&flaps, &floor]] {
            let (a, b) = (at(a, 0.0, 0.0, 0.0), at(b, 0.0, 0.0, 0.0));
            let answer = regions(a, b);
            assert_eq!(answer.surface, Meeting::Cross);
            assert_eq!(only(&answer).curves.len(), 1, "{}", reported(&answer));
            let contacts = ask(a, b, Demand::contacts(0.01)).contacts;
            assert!(contacts.iter().any(|c| c.point_a.x < 1.0), "{contacts:?}");
        }
        let alone = mesh(&touching);
        let answer = regions(at(&floor, 0.0, 0.0, 0.0), at(&alone, 0.0, 0.0, 0.0));
        assert_eq!(answer.surface, Meeting::Touch);
        assert_eq!(only(&answer).points.len(), 1, "{}", reported(&answer));
    }
}

/// Of a box that has sunk in a little askew, corners come out of the floor just beside what the
/// curve encloses.
#[test]
fn a_box_that_has_sunk_in_askew_is_held_at_all_corners() {
    let (crate_, floor) =
        (shape(Cuboid { size: [0.2; 3] }), shape(Cuboid { size: [2.0, 2.0, 0.1] }));
    let fan = shape(cranny_shapes::Cup {
        radius: 1.0,
        height: 0.1,
        wall: 0.01,
        floor: 0.05,
        segments: 48,
    });
    for (under, top) in [(&floor, 0.05), (&fan, 0.05)] {
        for k in 0..40 {
            let axis = DVec3::new(f64::from(k).sin(), f64::from(k).cos(), 0.2);
            let lean = DQuat::from_axis_angle(axis.normalize(), 0.0005 * f64::from(k % 5));
            let rotation =
                (lean * DQuat::from_axis_angle(DVec3::Z, 0.1 * f64::from(k))).normalize();
            let translation = DVec3::new(0.103, 0.041, top + 0.1 - 0.02);
            let sunk = Placed { model: &crate_, pose: Pose { rotation, translation } };
            let answer = regions(at(under, 0.0, 0.0, 0.0), sunk);
            let region = only(&answer);
            for corner in [[0.1, 0.1], [0.1, -0.1], [-0.1, 0.1], [-0.1, -0.1]] {
                let at = translation + rotation * DVec3::new(corner[0], corner[1], -0.1);
                let holds = |c: &&Contact| (c.point_b - at).length() < 1e-3;
                let contact = region.points.iter().find(holds);
                assert!(contact.is_some_and(|c| c.separation < -0.019), "{k}: {:?}", region.points);
            }
        }
    }
}

/// Flush sides, a rim that dips in by 2e-9 over a strip 1e-6 wide: its curves enclose next to
/// nothing.
#[test]
fn a_rim_that_dips_in_is_parted_the_way_that_it_came() {
    let plate = shape(Cuboid { size: [1.0, 1.0, 0.1] });
    // A turn about y, and in the other components what a simulation left of it.
    let turn = -0.000_811_274_355_029_043_3;
    let rotation =
        DQuat::from_xyzw(1.156e-19, turn, 8.135e-21, 0.999_999_670_916_906_4).normalize();
    let dips = 2e-9;
    let translation = DVec3::new(8.178_557_326e-5, 2.89e-21, -0.100_811_208_271_444 + dips);
    let lower = Placed { model: &plate, pose: Pose { rotation, translation } };
    let answer = ask(at(&plate, 0.0, 0.0, 0.0), lower, Demand::Regions { margin: 0.01 });
    let deepest = &answer.regions[0];
    assert!(deepest.depth.is_some_and(|depth| depth > 0.3 * dips && depth < 3.0 * dips));
    assert_along(deepest.normal, -DVec3::Z, 2e-3);
    // Both ends of the rim are held, and both of the other side, which hangs.
    for (x, y) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
        let held = |c: &&Contact| (c.point_a - DVec3::new(x, y, -0.05)).length() < 1e-5;
        let contact = answer.contacts.iter().find(held).expect("a contact at each corner");
        assert_along(contact.normal, -DVec3::Z, 2e-3);
    }
}
