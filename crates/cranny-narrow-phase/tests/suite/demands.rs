//! Each demand does its own work, and bad questions are refused.

use cranny_exact::{DQuat, DVec3, DomainError, Interval, Meeting, Pose, PoseError};
use cranny_geometry::triangle_distance::triangle_distance;
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::operations::{Pair, common_point};
use cranny_narrow_phase::{
    Answer, Containment, Counters, Demand, Feature, PairMemory, Placed, Query, QueryError, Witness,
    query,
};
use cranny_shapes::{Cuboid, Cup, Torus};
use cranny_testkit::Rng;

use crate::solids::{ask, at, cuboid, dyadic_solids, model, shape};

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

        let contacts = ask(a, b, Demand::contacts(0.1));
        assert_eq!(verdict(&contacts), verdict(&full));
        assert_eq!(contacts.triangle_pairs, full.triangle_pairs);
        assert_eq!((contacts.distance, contacts.witnesses), (None, None));
        assert_eq!(contacts.contacts.is_empty(), full.contacts.is_empty());
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
fn outcomes_of_triangle_tests_tell_close_calls_from_clear_ones() {
    let torus = shape(Torus { major_segments: 24, minor_segments: 12, ..Torus::default() });
    let unit = shape(Cuboid::default());
    let counted = |model: &Model, offset: DVec3, demand| {
        let [a, b] = [DVec3::ZERO, offset].map(|o| Placed { model, pose: Pose::at(o) });
        ask(a, b, demand).counters
    };
    // In general position: of a hundred signs hardly one is near zero, and none is only measured.
    let askew = DVec3::new(0.913, 0.377, 0.131);
    let clear = counted(&torus, askew, Demand::Intersects);
    assert!(clear.triangles_filtered > 0, "{clear:?}");
    assert_eq!(clear.triangles_adaptive, 0, "{clear:?}");
    assert_eq!(clear.triangle_tests, clear.triangles_filtered);
    // Side against side: all that touches lies in planes of the other.
    let flush = counted(&unit, DVec3::X, Demand::Regions { margin: 0.0 });
    assert!(flush.triangles_adaptive > 0, "{flush:?}");
    assert_eq!(flush.triangle_tests, flush.triangles_filtered + flush.triangles_adaptive);
    // Far apart along the axis of both, where hulls decide nothing: pairs are measured, not judged.
    let apart = counted(&torus, DVec3::new(0.0, 0.0, 0.7), Demand::Distance { below: None });
    assert!(apart.triangle_tests > 0, "{apart:?}");
    assert_eq!(apart.triangles_filtered + apart.triangles_adaptive, 0, "{apart:?}");
}

#[test]
fn crossing_surfaces_have_no_witnesses_and_one_common_point_whatever_is_remembered() {
    // Solids that touch in many pairs of faces and cross in some: where the search for a verdict
    // ends depends on the trees.
    let solids = dyadic_solids();
    let mut crossing = 0;
    for (i, (name_a, a)) in solids.iter().enumerate() {
        for (name_b, b) in &solids[i + 1..] {
            for offset in [[1.0, 0.5, 0.0], [0.5, 0.0, 0.25], [0.0, 1.0, 0.5]] {
                let what = format!("{name_a}, {name_b}, {offset:?}");
                let (a, b) = (at(a, 0.0, 0.0, 0.0), at(b, offset[0], offset[1], offset[2]));
                let all = ask(a, b, Demand::Regions { margin: 0.0 });
                let crosses = all.surface == Meeting::Cross;
                assert_eq!(all.witnesses.is_none(), crosses, "{what}");
                let mut memory = PairMemory::default();
                for demand in [Demand::Intersects, Demand::Distance { below: None }] {
                    let again = query(b, a, &Query::of(demand), &mut memory).unwrap().swapped();
                    let expected = all.witnesses.filter(|_| demand != Demand::Intersects);
                    for answer in [ask(a, b, demand), again] {
                        assert_eq!(answer.witnesses, expected, "{what}, {demand:?}");
                    }
                }
                let [common, swapped] = [(a, b), (b, a)].map(|(a, b)| {
                    common_point(&Pair::new(a, b).unwrap(), &mut Counters::default())
                });
                assert_eq!(common.is_some(), crosses, "{what}");
                assert_eq!(common, swapped.map(|[q, p]| [p, q]), "{what}");
                if let Some([p, q]) = common {
                    assert_eq!(p.point, q.point, "{what}");
                    for (placed, witness) in [(a, p), (b, q)] {
                        assert!(lies_on(placed, witness), "{what}: {witness:?}");
                    }
                }
                crossing += u32::from(crosses && all.triangle_pairs > 8);
            }
        }
    }
    assert!(crossing >= 100, "{crossing}");
}

#[test]
fn a_body_in_its_own_place_touches_itself_and_contains_nothing() {
    let mut rng = Rng::new(11);
    let cup = shape(Cup { radius: 0.25, height: 0.5, wall: 0.05, floor: 0.05, segments: 12 });
    for model in [shape(Cuboid::default()), cup] {
        for _ in 0..100 {
            let rotation = DQuat::from_axis_angle(rng.direction(), 3.0 * rng.unit());
            let pose = Pose { rotation, translation: rng.direction() };
            let placed = Placed { model: &model, pose };
            let answer = ask(placed, placed, Demand::Intersects);
            let found = (answer.surface, answer.solid, answer.contained);
            assert_eq!(found, (Meeting::Touch, true, None), "{pose:?}");
        }
    }
}

/// Whether a point lies on the feature that holds it.
fn lies_on(placed: Placed, witness: Witness) -> bool {
    let model = placed.model;
    let corners = match witness.feature {
        Feature::Vertex(v) => vec![v],
        Feature::Edge(e) => {
            let side = model.topology().half_edges(e)[0];
            let corners = model.mesh().corners(side.face());
            vec![corners[side.corner()], corners[side.next().corner()]]
        }
        Feature::Face(f) => model.mesh().corners(f).to_vec(),
    };
    let at = |i: usize| {
        let vertex = corners[i.min(corners.len() - 1)];
        placed.pose.world_from_body().apply(model.mesh().position(vertex))
    };
    let nearest = triangle_distance(&[at(0), at(1), at(2)], &[witness.point; 3]);
    nearest.squared <= 1e-24
}

#[test]
fn a_sheet_in_a_closed_body_is_contained_and_holds_nothing() {
    let cube = model(cuboid([-1.0; 3], [1.0; 3]));
    let corners = vec![DVec3::ZERO, 0.5 * DVec3::X, 0.5 * DVec3::Y];
    let sheet = model(Mesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap());
    let both_sides = model(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 1]]).unwrap());
    assert!(!sheet.is_closed() && both_sides.is_closed());
    let speck = model(cuboid([0.125, 0.125, 0.0], [0.25, 0.25, 0.0625]));
    let here = |model| at(model, 0.0, 0.0, 0.0);
    for flat in [&sheet, &both_sides] {
        let answer = ask(here(flat), here(&cube), Demand::Intersects);
        assert_eq!((answer.solid, answer.contained), (true, Some(Containment::AInB)));
        // What lies on a face of both sides lies on one that looks the same way.
        let on_it = ask(here(&speck), here(flat), Demand::Intersects);
        let found = (on_it.surface, on_it.solid, on_it.contained);
        assert_eq!(found, (Meeting::Touch, flat.is_closed(), None));
    }
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
        QueryError::Pose {
            body: 'A',
            source: PoseError::Domain(DomainError::NotFinite { axis: 'y', .. })
        }
    ));
    let far = Pose::at(DVec3::new(0.0, 0.0, 1e37));
    assert!(matches!(
        refused(here, far, Demand::None),
        QueryError::Pose {
            body: 'B',
            source: PoseError::Domain(DomainError::TooLarge { axis: 'z', .. })
        }
    ));
    let turned = |x, y, z, w| Pose { rotation: DQuat::from_xyzw(x, y, z, w), ..here };
    for q in
        [turned(0.0, 0.0, 0.0, 0.0), turned(0.0, 0.0, 0.0, 1.01), turned(0.0, f64::NAN, 0.0, 1.0)]
    {
        let error = refused(here, q, Demand::Intersects);
        let not_unit = |source| matches!(source, PoseError::NotUnit { .. });
        assert!(
            matches!(error, QueryError::Pose { body: 'B', source } if not_unit(source)),
            "{error}"
        );
    }
    for margin in [-1e-9, f64::NAN, f64::INFINITY] {
        for demand in [Demand::Regions { margin }, Demand::contacts(margin)] {
            let error = refused(here, here, demand);
            assert!(matches!(error, QueryError::Length { what: "margin", .. }), "{error}");
        }
        let error = refused(here, here, Demand::Distance { below: Some(margin) });
        assert!(matches!(error, QueryError::Length { what: "below", .. }), "{error}");
    }
    let message = refused(here, here, Demand::Regions { margin: -0.5 }).to_string();
    assert!(message.contains("margin") && message.contains("-0.5"), "{message}");
}
