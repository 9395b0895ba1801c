//! Shapes of which either may be a primitive: verdict, distance, contacts and ways out, by closed
//! formulas and from both sides.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_narrow_phase::{Answer, Containment, Demand, PairMemory, Query};
use cranny_primitives::{
    Ball, BodyShape, Capsule, Cone, Cylinder, HalfSpace, PlacedShape, Primitive, Separation,
    ShapeQueryError, cast_ray_at_shape, query_shapes, separation_of_point, way_apart_of_shapes,
};

use crate::cuboid;

const NEAR: f64 = 1e-12;

fn ball(radius: f64) -> BodyShape {
    Primitive::from(Ball { center: DVec3::ZERO, radius }).into()
}

fn capsule(half: f64, radius: f64) -> BodyShape {
    Primitive::from(Capsule { ends: [-half * DVec3::Z, half * DVec3::Z], radius }).into()
}

fn cylinder(half_height: f64, radius: f64) -> BodyShape {
    let (center, axis) = (DVec3::ZERO, DVec3::Z);
    Primitive::from(Cylinder { center, axis, half_height, radius, border: 0.0 }).into()
}

fn cone(half_height: f64, radius: f64) -> BodyShape {
    let (center, axis) = (DVec3::ZERO, DVec3::Z);
    Primitive::from(Cone { center, axis, half_height, radius, border: 0.0 }).into()
}

fn ground() -> BodyShape {
    Primitive::from(HalfSpace { point: DVec3::ZERO, normal: DVec3::Z }).into()
}

fn at(shape: &BodyShape, pose: Pose) -> PlacedShape<'_> {
    PlacedShape { shape, pose }
}

fn asked(a: PlacedShape<'_>, b: PlacedShape<'_>, demand: Demand) -> Answer {
    query_shapes(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

/// The distance, which is the same from the other side, and is that of the witness points.
fn distance(a: PlacedShape<'_>, b: PlacedShape<'_>) -> f64 {
    let nearest = Demand::Distance { below: None };
    let (found, other) = (asked(a, b, nearest), asked(b, a, nearest));
    let distance = found.distance.unwrap();
    assert!((distance - other.distance.unwrap()).abs() <= 1e-6 * distance);
    assert!(found.separation.contains(distance));
    if let Some([p, q]) = found.witnesses {
        assert!((p.point.distance(q.point) - distance).abs() < 1e-9, "{p:?} {q:?} {distance}");
        let [q_too, _] = other.witnesses.unwrap();
        assert!(q.point.distance(q_too.point) < 1e-4);
    } else {
        assert_eq!(distance, 0.0);
    }
    distance
}

#[test]
fn distances_of_two_primitives_are_those_of_closed_formulas() {
    let place = |x: f64, y: f64, z: f64| Pose::at(DVec3::new(x, y, z));
    let origin = Pose::IDENTITY;
    let lying = Pose {
        rotation: DQuat::from_rotation_arc(DVec3::Z, DVec3::X),
        translation: DVec3::new(0.0, 4.0, 0.0),
    };
    let cases: [(BodyShape, Pose, BodyShape, Pose, f64); 9] = [
        (ball(1.0), origin, ball(2.0), place(3.0, 4.0, 12.0), 10.0),
        (ball(1.0), origin, capsule(2.0, 0.5), place(3.0, 0.0, 1.5), 1.5),
        (ball(1.0), origin, cylinder(1.0, 2.0), place(5.0, 0.0, 5.0), 5.0 - 1.0),
        (capsule(1.0, 0.5), origin, capsule(1.0, 0.25), lying, 4.0 - 0.75),
        (capsule(1.0, 0.5), place(0.0, 0.0, 5.0), cylinder(1.0, 2.0), origin, 2.5),
        (ball(0.5), place(0.0, 0.0, 3.0), cone(1.0, 1.0), origin, 1.5),
        (ground(), origin, ball(0.5), place(7.0, -3.0, 2.0), 1.5),
        (cylinder(1.0, 0.5), lying, ground(), place(0.0, 0.0, -2.0), 1.5),
        (cylinder(1.0, 0.5), origin, cylinder(1.0, 0.25), place(4.0, 0.0, 0.25), 3.25),
    ];
    for (a, pose_a, b, pose_b, expected) in cases {
        let found = distance(at(&a, pose_a), at(&b, pose_b));
        assert!((found - expected).abs() < 1e-6, "{a:?} {b:?}: {found}, not {expected}");
        // But for two cylinders, to rounding.
        let searched = matches!(
            (a.primitive(), b.primitive()),
            (Some(Primitive::Cylinder(_)), Some(Primitive::Cylinder(_)))
        );
        assert!(searched || (found - expected).abs() < NEAR);
    }
}

#[test]
fn a_ball_beside_a_corner_of_a_cube_is_as_far_as_the_corner() {
    let cube = BodyShape::from(cuboid([2.0; 3]));
    let turn = DQuat::from_xyzw(0.3, -0.5, 0.2, 0.78).normalize();
    let pose = Pose { rotation: turn, translation: DVec3::new(1.0, 2.0, 3.0) };
    let out = pose.world_from_body().apply(DVec3::new(3.0, 3.0, 2.0));
    let found = distance(at(&cube, pose), at(&ball(0.5), Pose::at(out)));
    assert!((found - 2.5).abs() < NEAR, "{found}");
}

#[test]
fn verdicts_and_containment_of_a_primitive_and_a_model() {
    let cube = BodyShape::from(cuboid([2.0; 3]));
    let verdict = |x: f64, radius: f64| {
        let there = Pose::at(DVec3::X * x);
        let answer = asked(at(&ball(radius), there), at(&cube, Pose::IDENTITY), Demand::Intersects);
        (answer.touches(), answer.contained)
    };
    assert_eq!(verdict(2.0, 0.5), (false, None));
    assert_eq!(verdict(1.25, 0.5), (true, None));
    assert_eq!(verdict(0.0, 0.5), (true, Some(Containment::AInB)));
    assert_eq!(verdict(0.0, 5.0), (true, None), "the cube is in the ball");
}

#[test]
fn a_bound_ends_the_search_for_a_distance() {
    let (a, b) = (ball(1.0), ball(1.0));
    let far = |below| {
        let there = at(&b, Pose::at(5.0 * DVec3::X));
        asked(at(&a, Pose::IDENTITY), there, Demand::Distance { below: Some(below) })
    };
    assert_eq!((far(4.0).distance, far(3.0).distance), (Some(3.0), Some(f64::INFINITY)));
    assert!(far(2.0).witnesses.is_none() && far(2.0).separation.lo > 1.9);
}

#[test]
fn contacts_point_from_a_to_b_and_are_as_deep_from_both_sides() {
    let shapes = [ball(1.0), capsule(0.5, 0.5), cylinder(1.0, 0.5), cone(1.0, 0.5), ground()];
    for (i, a) in shapes.iter().enumerate() {
        for b in &shapes[..i] {
            // In the way of a half-space beneath: at most a radius deep.
            let poses = [Pose::IDENTITY, Pose::at(DVec3::new(0.3, 0.0, 0.45))];
            let answer = asked(at(a, poses[0]), at(b, poses[1]), Demand::contacts(0.1));
            let other = asked(at(b, poses[1]), at(a, poses[0]), Demand::contacts(0.1));
            assert!(answer.solid && answer.depth() > 0.0, "{a:?} {b:?}");
            assert!((answer.depth() - other.depth()).abs() < 1e-6);
            for contact in &answer.contacts {
                assert!((contact.normal.length() - 1.0).abs() < 1e-9);
                let along = (contact.point_b - contact.point_a).dot(contact.normal);
                assert!((along - contact.separation).abs() < 1e-6, "{contact:?}");
            }
        }
    }
}

#[test]
fn a_way_out_leads_out() {
    let cube = BodyShape::from(cuboid([2.0; 3]));
    let shapes = [ball(1.0), capsule(0.5, 0.5), cylinder(1.0, 0.5), cone(1.0, 0.5), ground(), cube];
    let mut tried = 0;
    for a in &shapes {
        for b in &shapes {
            let half_spaces = [a, b].into_iter().filter(|s| s.radius().is_infinite()).count();
            let models = a.model().is_some() && b.model().is_some();
            if half_spaces == 2 || models {
                continue;
            }
            for offset in [DVec3::new(0.3, 0.1, 0.4), DVec3::ZERO, DVec3::new(0.9, 0.9, -0.2)] {
                let (a, mut b) = (at(a, Pose::IDENTITY), at(b, Pose::at(offset)));
                let answer = asked(a, b, Demand::Regions { margin: 0.0 });
                if !answer.solid {
                    continue;
                }
                let way = way_apart_of_shapes(a, b, &answer).unwrap();
                let way = way.unwrap_or_else(|| panic!("{a:?} {b:?} {answer:?} overlap"));
                b.pose.translation += way;
                let now = asked(a, b, Demand::Intersects);
                assert!(!now.touches(), "{a:?} {b:?} by {way}");
                assert!(way.length() < 4.5, "{way}");
                tried += 1;
            }
        }
    }
    assert!(tried > 60, "{tried}");
}

#[test]
fn half_spaces_meet_unless_they_look_away_from_each_other() {
    let (below, above) =
        (ground(), Primitive::from(HalfSpace { point: DVec3::ZERO, normal: -DVec3::Z }));
    let above = BodyShape::from(above);
    let apart = distance(at(&below, Pose::IDENTITY), at(&above, Pose::at(3.0 * DVec3::Z)));
    assert_eq!(apart, 3.0);
    let meets = |a: &BodyShape, b: &BodyShape, z: f64| {
        let there = at(b, Pose::at(z * DVec3::Z));
        let answer = asked(at(a, Pose::IDENTITY), there, Demand::contacts(0.0));
        assert!(answer.contacts.is_empty());
        answer.touches()
    };
    assert!(meets(&below, &above, -1.0) && !meets(&below, &above, 1.0));
    assert!(meets(&below, &below, 100.0));
}

#[test]
fn bounds_hold_the_shape_and_that_of_a_half_space_is_valid() {
    let map =
        Pose { rotation: DQuat::from_rotation_arc(DVec3::Z, DVec3::X), translation: DVec3::Y }
            .world_from_body();
    let of_cone = cone(1.0, 0.5).bounds(&map);
    assert!((of_cone.max - DVec3::new(1.0, 1.5, 0.5)).abs().max_element() < 1e-9);
    let flat = ground().bounds(&Pose::at(2.0 * DVec3::Z).world_from_body());
    assert!(flat.max.z >= 2.0 && flat.max.z < 2.0 + 1e-9 && flat.max.x > 1e30);
    let tilted = DQuat::from_rotation_arc(DVec3::Z, DVec3::new(0.6, 0.0, 0.8));
    let steep = Pose { rotation: tilted, translation: DVec3::ZERO }.world_from_body();
    assert!(ground().bounds(&steep).max.is_finite());
}

#[test]
fn a_number_that_is_none_is_refused_by_the_bodys_letter() {
    let (good, bad) = (ball(1.0), ball(-1.0));
    let found = query_shapes(
        at(&good, Pose::IDENTITY),
        at(&bad, Pose::IDENTITY),
        &Query::of(Demand::Intersects),
        &mut PairMemory::default(),
    );
    let error = found.unwrap_err();
    assert!(matches!(error, ShapeQueryError::Primitive { body: 'B', what: "ball", .. }));
    assert!(error.to_string().contains("radius is -1"), "{error}");
    assert!(bad.check().is_err() && good.check().is_ok());
}

#[test]
fn rays_enter_and_leave_primitives_along_their_normals() {
    let shapes = [ball(1.0), capsule(0.5, 1.0), cylinder(2.0, 1.0), ground()];
    for shape in &shapes {
        let from = DVec3::new(-3.0, 0.0, 0.0);
        let hit = cast_ray_at_shape(shape, from, DVec3::X, 100.0).unwrap();
        if shape.radius().is_infinite() {
            let down = cast_ray_at_shape(shape, 2.0 * DVec3::Z, -DVec3::Z, 100.0).unwrap().unwrap();
            assert!((down.distance - 2.0).abs() < 1e-9 && !down.from_behind);
            assert!((down.normal - DVec3::Z).length() < 1e-9);
            let up = cast_ray_at_shape(shape, -2.0 * DVec3::Z, DVec3::Z, 100.0).unwrap().unwrap();
            assert!((up.distance - 2.0).abs() < 1e-9 && up.from_behind);
            assert!((up.normal - DVec3::Z).length() < 1e-9, "{up:?}");
            continue;
        }
        let hit = hit.unwrap();
        assert!((hit.distance - 2.0).abs() < 1e-6 && !hit.from_behind && hit.face.is_none());
        assert!((hit.normal + DVec3::X).length() < 1e-6, "{hit:?}");
        let out = cast_ray_at_shape(shape, DVec3::ZERO, DVec3::X, 100.0).unwrap().unwrap();
        assert!((out.distance - 1.0).abs() < 1e-6 && out.from_behind, "{out:?}");
        assert!((out.normal - DVec3::X).length() < 1e-6, "{out:?}");
        assert_eq!(cast_ray_at_shape(shape, from, DVec3::X, 1.0).unwrap(), None);
        assert_eq!(cast_ray_at_shape(shape, from, DVec3::Y, 100.0).unwrap(), None);
        assert_eq!(separation_of_point(shape, DVec3::ZERO, 0.0).unwrap(), Separation::Meeting);
        let aside = separation_of_point(shape, 4.0 * DVec3::X, f64::INFINITY).unwrap();
        let witnesses = [DVec3::X, 4.0 * DVec3::X];
        assert_eq!(aside, Separation::Apart { distance: 3.0, witnesses });
    }
    assert!(cast_ray_at_shape(&shapes[0], DVec3::ZERO, DVec3::ZERO, 1.0).is_err());
}
