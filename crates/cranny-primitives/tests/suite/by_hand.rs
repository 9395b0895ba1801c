//! Contacts and distances that are known by hand, the same for all who ask about a model.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_primitives::{
    Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive, PrimitiveError, Segment, Separation,
    contacts, contains_point, meets, separation,
};
use cranny_shapes::Cup;

use crate::{built, cuboid};

const RADIUS: f64 = 0.25;

/// One of each, lying on the plane z = 0 where they are round, all about z else.
fn all() -> [(&'static str, Primitive); 6] {
    let up = DVec3::Z;
    let at = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    [
        ("ball", Ball { center: at(0.0, RADIUS), radius: RADIUS }.into()),
        ("capsule", Capsule { ends: [at(-0.2, RADIUS), at(0.2, RADIUS)], radius: RADIUS }.into()),
        ("segment", Segment { ends: [at(-0.2, 0.0), at(0.2, 0.0)] }.into()),
        (
            "cylinder",
            Cylinder {
                center: at(0.0, 0.5),
                axis: 3.0 * up,
                half_height: 0.375,
                radius: RADIUS,
                border: 0.125,
            }
            .into(),
        ),
        (
            "cone",
            Cone { center: at(0.0, 0.5), axis: up, half_height: 0.5, radius: RADIUS, border: 0.0 }
                .into(),
        ),
        ("half-space", HalfSpace { point: at(7.0, 0.0), normal: -2.0 * up }.into()),
    ]
}

fn lifted(primitive: &Primitive, by: f64) -> Primitive {
    primitive.moved(&Pose::at(DVec3::Z * by).world_from_body())
}

/// Over a floor by a gap, or in it: contacts, distance, witnesses and verdict agree.
#[test]
fn each_is_as_far_from_a_floor_as_it_is_above_it() {
    let floor = cuboid([4.0, 4.0, 1.0]);
    for (name, primitive) in all() {
        for gap in [0.125, 0.0, -0.0625] {
            let what = format!("{name}, {gap} above");
            let here = lifted(&primitive, 0.5 + gap);
            let found = contacts(&floor, &here, 0.25).expect("a shape");
            assert!(!found.is_empty(), "{what}");
            for contact in &found {
                let between = contact.point_b - contact.point_a;
                assert!((contact.normal - DVec3::Z).length() < 1e-12, "{what}: {contact:?}");
                assert!((contact.normal.dot(between) - contact.separation).abs() < 1e-12, "{what}");
            }
            let least = found.iter().map(|c| c.separation).fold(f64::INFINITY, f64::min);
            assert!((least - gap).abs() < 1e-12, "{what}: {least}");
            assert_eq!(meets(&floor, &here), Ok(gap <= 0.0), "{what}");
            match separation(&floor, &here, f64::INFINITY).expect("a shape") {
                Separation::Apart { distance, witnesses: [a, b] } => {
                    assert!(gap > 0.0 && (distance - gap).abs() < 1e-12, "{what}: {distance}");
                    assert!((a.distance(b) - gap).abs() < 1e-12 && a.z == 0.5, "{what}: {a}, {b}");
                }
                other => assert_eq!((other, gap <= 0.0), (Separation::Meeting, true), "{what}"),
            }
        }
        let far = lifted(&primitive, 0.75);
        assert_eq!(separation(&floor, &far, 0.125), Ok(Separation::Farther), "{name}");
        assert_eq!(contacts(&floor, &far, 0.125), Ok(Vec::new()), "{name}");
    }
}

/// The same in a turned frame: what is moved together has the same separations.
#[test]
fn another_frame_changes_nothing() {
    let cup = built(Cup::default().build().expect("defaults"));
    let rotation = DQuat::from_xyzw(0.1, -0.7, 0.3, 0.64).normalize();
    let turn = Pose { rotation, translation: DVec3::new(1.0, 2.0, -3.0) }.world_from_body();
    for (name, primitive) in all() {
        let here = lifted(&primitive, 0.2);
        let there = here.moved(&turn).moved(&turn.inverse());
        let [before, after] = [here, there].map(|p| separation(&cup, &p, f64::INFINITY));
        let distance = |found| match found {
            Ok(Separation::Apart { distance, .. }) => distance,
            Ok(Separation::Meeting) => 0.0,
            other => panic!("{name}: {other:?}"),
        };
        assert!((distance(before) - distance(after)).abs() < 1e-12, "{name}");
    }
}

/// A ball in a cup's well is above the floor of the well, within the hull and not in the material.
#[test]
fn a_ball_in_a_cup_touches_its_floor() {
    let cup = built(Cup::default().build().expect("defaults"));
    let ball = |z: f64| Primitive::from(Ball { center: DVec3::new(0.0, 0.0, z), radius: RADIUS });
    // The well's floor is at z = 0.1, its wall 0.4 from the axis.
    let found = contacts(&cup, &ball(0.36), 0.02).expect("a ball");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0].separation - 0.01).abs() < 1e-12, "{found:?}");
    assert_eq!(meets(&cup, &ball(0.36)), Ok(false));
    assert_eq!(meets(&cup, &ball(0.34)), Ok(true));
    assert!(!contains_point(&cup, DVec3::new(0.0, 0.0, 0.36)));
    assert!(contains_point(&cup, DVec3::new(0.0, 0.0, 0.05)));
    assert!(contains_point(&cup, DVec3::ZERO), "of the surface");
}

/// What is wholly inside meets, and has one contact, which leads out through the nearest side.
#[test]
fn what_is_wholly_inside_is_led_out() {
    let cube = cuboid([4.0, 4.0, 4.0]);
    for (name, primitive) in all().into_iter().filter(|(name, _)| *name != "half-space") {
        let inside = lifted(&primitive, 0.75);
        assert_eq!(meets(&cube, &inside), Ok(true), "{name}");
        let found = contacts(&cube, &inside, 2.0).expect("a shape");
        assert!(!found.is_empty(), "{name}");
        assert!(found.iter().all(|c| c.separation < 0.0), "{name}: {found:?}");
        assert!(found.iter().all(|c| c.normal.z > 0.99), "{name}: {found:?}");
    }
}

/// A centre exactly at a corner leads out along the mean of the sides, whatever their triangles.
#[test]
fn a_ball_centred_at_a_corner_is_led_out_along_the_diagonal() {
    let cube = cuboid([1.0; 3]);
    for x in [-0.5, 0.5] {
        let corner = DVec3::new(x, 0.5, -0.5);
        let ball = Ball { center: corner, radius: RADIUS };
        let found = contacts(&cube, &ball.into(), 0.0).expect("a ball");
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].normal - corner.normalize()).length() < 1e-12, "{found:?}");
        assert_eq!(found[0].separation, -RADIUS);
    }
}

#[test]
fn numbers_that_make_no_shape_are_refused() {
    let cube = cuboid([1.0; 3]);
    let nowhere = DVec3::new(0.0, f64::NAN, 0.0);
    let post = Cylinder {
        center: DVec3::ZERO,
        axis: DVec3::Z,
        half_height: 1.0,
        radius: 1.0,
        border: 0.0,
    };
    let cone =
        Cone { center: DVec3::ZERO, axis: DVec3::Z, half_height: 1.0, radius: 1.0, border: 0.0 };
    let of = |primitive: Primitive| {
        let error = contacts(&cube, &primitive, 0.1).expect_err("no shape");
        let same = separation(&cube, &primitive, 0.1).expect_err("no shape");
        assert_eq!(error.to_string(), same.to_string());
        error
    };
    for primitive in [
        Ball { center: nowhere, radius: 1.0 }.into(),
        Capsule { ends: [DVec3::ZERO, nowhere], radius: 1.0 }.into(),
        Segment { ends: [nowhere, DVec3::ZERO] }.into(),
        HalfSpace { point: nowhere, normal: DVec3::Z }.into(),
        Cylinder { center: nowhere, ..post }.into(),
        Cone { center: nowhere, ..cone }.into(),
    ] {
        assert!(matches!(of(primitive), PrimitiveError::Place { .. }), "{primitive:?}");
    }
    for primitive in [
        HalfSpace { point: DVec3::ZERO, normal: DVec3::ZERO }.into(),
        Cylinder { axis: nowhere, ..post }.into(),
        Cone { axis: DVec3::ZERO, ..cone }.into(),
    ] {
        assert!(matches!(of(primitive), PrimitiveError::Direction { .. }), "{primitive:?}");
    }
    for primitive in [
        Ball { center: DVec3::ZERO, radius: -1.0 }.into(),
        Capsule { ends: [DVec3::ZERO; 2], radius: f64::INFINITY }.into(),
        Cylinder { border: -0.1, ..post }.into(),
        Cylinder { half_height: f64::NAN, ..post }.into(),
        Cone { radius: -1.0, ..cone }.into(),
    ] {
        assert!(matches!(of(primitive), PrimitiveError::Length { .. }), "{primitive:?}");
    }
    let error = of(Cylinder { border: -0.1, ..post }.into());
    assert_eq!(error.to_string(), "border is -0.1: it must be a finite number, 0 or more");
}
