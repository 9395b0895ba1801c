//! Each demand does its own work, and bad questions are refused.

use cranny_exact::{DQuat, DVec3, DomainError, Interval, Meeting, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Answer, Demand, PairMemory, Placed, Query, QueryError, query, world_bounds,
};
use cranny_shapes::{Cuboid, Cup, Torus};

use crate::measure::world_triangles;
use crate::solids::{ask, shape};

/// Apart, touching, crossing, one in the other.
fn situations(unit: &Model, cup: &Model) -> Vec<[Pose; 2]> {
    assert!(unit.is_closed() && cup.is_closed());
    let turn = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
    let pose = |rotation, x, y, z| Pose { rotation, translation: DVec3::new(x, y, z) };
    let straight = DQuat::IDENTITY;
    vec![
        [pose(turn, 0.0, 0.0, 0.0), pose(straight, 2.0, 0.3, 0.1)],
        [pose(straight, 0.0, 0.0, 0.0), pose(straight, 0.25, 0.25, 0.5)],
        [pose(turn, 0.0, 0.0, 0.0), pose(straight, 0.6, 0.3, 0.1)],
        [pose(straight, 0.0, 0.0, 0.0), pose(turn, 0.0, 0.0, -0.2)],
    ]
}

#[test]
fn lesser_demands_agree_with_greater_ones_and_leave_the_rest_blank() {
    let unit = shape(Cuboid::default());
    let cup = shape(Cup { radius: 0.25, height: 0.5, wall: 0.05, floor: 0.05, segments: 12 });
    let mut seen = Vec::new();
    for [pose_a, pose_b] in situations(&unit, &cup) {
        let (a, b) = (Placed { model: &unit, pose: pose_a }, Placed { model: &cup, pose: pose_b });
        let full = ask(a, b, Demand::Regions { margin: 0.1 });
        seen.push((full.surface, full.contained.is_some()));

        let none = ask(a, b, Demand::None);
        assert_eq!(none.counters, Default::default());
        assert_eq!((none.distance, none.witnesses, none.contained), (None, None, None));

        let meets = ask(a, b, Demand::Intersects);
        let verdict = |x: &Answer| (x.surface, x.solid, x.contained);
        assert_eq!(verdict(&meets), verdict(&full));
        assert_eq!((meets.distance, meets.witnesses), (None, None));
        assert!(meets.contacts.is_empty() && meets.regions.is_empty());
        assert_eq!((meets.separation, meets.triangle_pairs), (Interval::WHOLE, 0));

        let apart = ask(a, b, Demand::Distance { below: None });
        assert_eq!(verdict(&apart), verdict(&full));
        assert_eq!((apart.distance, apart.witnesses), (full.distance, full.witnesses));
        assert!(apart.contacts.is_empty() && apart.regions.is_empty());

        let contacts = ask(a, b, Demand::Contacts { margin: 0.1 });
        assert_eq!(contacts.contacts, full.contacts);
        assert_eq!(contacts.regions, full.regions);
        assert_eq!((contacts.distance, contacts.witnesses), (None, None));
        let width = contacts.separation.width();
        assert!(full.surface == Meeting::None || width <= full.separation.width(), "{width}");
        assert!(contacts.separation.lo <= full.separation.hi);
        assert!(full.separation.lo <= contacts.separation.hi);

        assert!(meets.counters.triangle_tests <= apart.counters.triangle_tests);
        assert!(apart.counters.triangle_tests <= full.counters.triangle_tests);
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 4, "{seen:?}");
}

#[test]
fn a_distance_that_does_not_matter_is_not_measured() {
    let torus = shape(Torus::default());
    let a = Placed { model: &torus, pose: Pose::IDENTITY };
    let b = Placed { model: &torus, pose: Pose::at(DVec3::new(4.0, 0.5, 0.3)) };
    let full = ask(a, b, Demand::Distance { below: None });
    let distance = full.distance.unwrap();
    let within = ask(a, b, Demand::Distance { below: Some(distance * 1.001) });
    assert_eq!((within.distance, within.witnesses), (full.distance, full.witnesses));
    for below in [0.0, 0.1, distance * 0.999, distance] {
        let beyond = ask(a, b, Demand::Distance { below: Some(below) });
        assert_eq!(beyond.distance, Some(f64::INFINITY));
        assert_eq!(beyond.witnesses, None);
        assert!(beyond.separation.contains(distance), "{:?}", beyond.separation);
        assert!(beyond.separation.lo <= below);
        assert!(beyond.counters.triangle_tests <= full.counters.triangle_tests);
    }
    let early = ask(a, b, Demand::Distance { below: Some(0.1) });
    assert!(early.counters.node_tests < 10, "{:?}", early.counters);
}

fn refused(a: Pose, b: Pose, demand: Demand) -> QueryError {
    let unit = shape(Cuboid::default());
    let (a, b) = (Placed { model: &unit, pose: a }, Placed { model: &unit, pose: b });
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap_err()
}

#[test]
fn bad_questions_are_refused_by_name() {
    let here = Pose::IDENTITY;
    let lost = Pose::at(DVec3::new(0.0, f64::NAN, 0.0));
    assert!(matches!(
        refused(lost, here, Demand::Intersects),
        QueryError::Pose { body: 'A', source: DomainError::NotFinite { axis: 'y', .. } }
    ));
    let far = Pose::at(DVec3::new(0.0, 0.0, 1e37));
    assert!(matches!(
        refused(here, far, Demand::None),
        QueryError::Pose { body: 'B', source: DomainError::TooLarge { axis: 'z', .. } }
    ));
    let turned = |x, y, z, w| Pose { rotation: DQuat::from_xyzw(x, y, z, w), ..here };
    for q in
        [turned(0.0, 0.0, 0.0, 0.0), turned(0.0, 0.0, 0.0, 1.01), turned(0.0, f64::NAN, 0.0, 1.0)]
    {
        let error = refused(here, q, Demand::Intersects);
        assert!(matches!(error, QueryError::Rotation { body: 'B', .. }), "{error}");
    }
    for margin in [-1e-9, f64::NAN, f64::INFINITY] {
        for demand in [Demand::Regions { margin }, Demand::Contacts { margin }] {
            let error = refused(here, here, demand);
            assert!(matches!(error, QueryError::Length { what: "margin", .. }), "{error}");
        }
        let error = refused(here, here, Demand::Distance { below: Some(margin) });
        assert!(matches!(error, QueryError::Length { what: "below", .. }), "{error}");
    }
    let message = refused(here, here, Demand::Regions { margin: -0.5 }).to_string();
    assert!(message.contains("margin") && message.contains("-0.5"), "{message}");
}

#[test]
fn world_bounds_hold_every_posed_vertex() {
    let cup = shape(Cup::default());
    for k in 0..50 {
        let t = f64::from(k);
        let rotation = DQuat::from_xyzw(0.1 * t, 1.0, -0.3, 0.2 * t - 4.0).normalize();
        let pose = Pose { rotation, translation: DVec3::new(t, -1e3 * t, 0.1) };
        let placed = Placed { model: &cup, pose };
        let bounds = world_bounds(placed);
        assert!(world_triangles(placed).iter().flatten().all(|&p| bounds.contains_point(p)));
        assert!((bounds.max - bounds.min).max_element() < 4.0 * cup.radius());
    }
}
