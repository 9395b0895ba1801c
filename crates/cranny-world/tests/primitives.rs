//! Bodies that are primitives: events, distances, depths and boxes beside meshes and each other.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Model};
use cranny_primitives::{Ball, BodyShape, Capsule, HalfSpace, Primitive};
use cranny_shapes::Torus;
use cranny_world::description::{Accuracy, BodyKind, Effect};
use cranny_world::{BodyId, BodySpec, PairEventKind, StepReport, World, WorldError};

fn ball(radius: f64) -> BodyShape {
    Primitive::from(Ball { center: DVec3::ZERO, radius }).into()
}

fn ground() -> BodyShape {
    Primitive::from(HalfSpace { point: DVec3::ZERO, normal: DVec3::Z }).into()
}

fn ring() -> Model {
    let mesh =
        Torus { major_radius: 2.0, minor_radius: 0.5, major_segments: 48, minor_segments: 24 };
    Model::build(mesh.build().unwrap(), &BuildOptions::default()).unwrap().0
}

fn put(world: &mut World, name: &str, shape: impl Into<BodyShape>, at: DVec3) -> BodyId {
    let kind = if name == "ground" { BodyKind::Fixed } else { BodyKind::Dynamic };
    let spec = BodySpec { kind, pose: Pose::at(at), ..BodySpec::new(name, shape) };
    world.insert(spec).unwrap()
}

fn world(effects: &[Effect]) -> World {
    let mut world = World::new();
    world.set_scene_effects(effects).unwrap();
    world
}

fn distance(report: &StepReport) -> Option<f64> {
    report.answers.first().and_then(|pair| pair.answer.distance).filter(|d| d.is_finite())
}

#[test]
fn a_ball_goes_through_the_hole_of_a_ring_and_meets_it_beside() {
    let mut world = world(&[Effect::TRIGGER]);
    put(&mut world, "ring", ring(), DVec3::ZERO);
    let moving = put(&mut world, "ball", ball(0.25), DVec3::ZERO);
    let mut events = |x: f64| {
        // Down the axis at x = 0, across the ring's body at x = 2.
        let heights = (0..20).map(|step| 2.0 - 0.2 * f64::from(step));
        let met: Vec<(i32, PairEventKind)> = heights
            .enumerate()
            .flat_map(|(step, z)| {
                world.set_pose(moving, Pose::at(DVec3::new(x, 0.0, z))).unwrap();
                let report = world.step().unwrap();
                world.validate().unwrap();
                report.events.into_iter().map(move |event| (step as i32, event.kind))
            })
            .collect();
        met
    };
    assert_eq!(events(0.0), []);
    // 0.75 above and below the middle: steps 7 (z = 0.6) to 13 (z = -0.6).
    let expected = [(7, PairEventKind::Began), (14, PairEventKind::Ended)];
    assert_eq!(events(2.0), expected);
}

#[test]
fn a_half_space_meets_what_is_anywhere_and_two_balls_are_as_far_as_their_centres() {
    let mut world = world(&[Effect::proximity(10.0)]);
    put(&mut world, "ground", ground(), DVec3::ZERO);
    let one = put(&mut world, "one", ball(0.5), DVec3::new(1e6, -1e6, 3.0));
    assert_eq!(distance(&world.step().unwrap()), Some(2.5));
    world.set_pose(one, Pose::at(DVec3::Z * 100.0)).unwrap();
    let two = put(&mut world, "two", ball(1.0), DVec3::new(3.0, 4.0, 100.0));
    let report = world.step().unwrap();
    assert_eq!(report.answers.iter().filter(|pair| pair.a == one && pair.b == two).count(), 1);
    let of_balls = report.answers.iter().find(|pair| pair.b == two && pair.a == one).unwrap();
    assert_eq!(of_balls.answer.distance, Some(3.5));
    world.validate().unwrap();
}

#[test]
fn contacts_tell_how_deep_and_have_no_regions() {
    let mut world = world(&[Effect::Contacts { margin: 0.1 }]);
    put(&mut world, "ground", ground(), DVec3::ZERO);
    let capsule = Capsule { ends: [-DVec3::X, DVec3::X], radius: 0.5 };
    put(&mut world, "capsule", Primitive::from(capsule), DVec3::Z * 0.4);
    put(&mut world, "ring", ring(), DVec3::new(20.0, 0.0, 0.45));
    let report = world.step().unwrap();
    let depths: Vec<f64> = report.answers.iter().map(|pair| pair.answer.depth()).collect();
    assert_eq!(depths.len(), 2);
    assert!((depths[0] - 0.1).abs() < 1e-12 && (depths[1] - 0.05).abs() < 1e-12, "{depths:?}");
    assert!(report.answers.iter().all(|pair| pair.answer.regions.is_empty()));
    assert!(report.answers.iter().all(|pair| pair.answer.contacts.len() >= 2));
    let deepest = report.stats.deepest.unwrap();
    assert_eq!(world.name(deepest.b), Some("capsule"));
}

#[test]
fn a_pair_with_a_primitive_is_answered_at_once_whatever_the_level_and_the_budget() {
    let mut world = world(&[Effect::TRIGGER]);
    world.set_accuracy(Accuracy::Hulls);
    world.set_budget(Some(0));
    put(&mut world, "ring", ring(), DVec3::ZERO);
    let in_the_hole = put(&mut world, "ball", ball(0.25), DVec3::ZERO);
    let report = world.step().unwrap();
    assert!(report.estimates.is_empty() && report.touching.is_empty());
    world.set_shape(in_the_hole, ball(1.75)).unwrap();
    assert_eq!(world.step().unwrap().touching.len(), 1);
    world.set_shape(in_the_hole, ring()).unwrap();
    assert_eq!(world.step().unwrap().estimates.len(), 1, "now it is a mesh");
}

#[test]
fn verification_and_the_order_of_bodies_change_nothing() {
    let answers = |first_ball: bool| {
        let mut world = world(&[Effect::Contacts { margin: 0.5 }]);
        world.set_verification(true);
        let at = DVec3::new(2.0, 0.0, 0.9);
        if first_ball {
            put(&mut world, "ball", ball(0.5), at);
            put(&mut world, "ring", ring(), DVec3::ZERO);
        } else {
            put(&mut world, "ring", ring(), DVec3::ZERO);
            put(&mut world, "ball", ball(0.5), at);
        }
        let report = world.step().unwrap();
        // There is no memory to verify.
        assert_eq!((report.stats.verified_pairs, report.mismatches.len()), (0, 0));
        report.answers.into_iter().next().unwrap().answer
    };
    assert_eq!(answers(true).swapped(), answers(false));
}

#[test]
fn a_primitive_with_a_number_that_is_none_is_refused_by_name() {
    let mut world = World::new();
    let refused = world.insert(BodySpec::new("marble", ball(f64::NAN)));
    let error = refused.unwrap_err();
    assert!(matches!(error, WorldError::Primitive { .. }));
    assert_eq!(
        error.to_string(),
        "the ball of body 'marble' is refused: radius is NaN: it must be a finite number, 0 or more"
    );
    assert_eq!(world.bodies().len(), 0);
    let kept = put(&mut world, "marble", ball(1.0), DVec3::ZERO);
    assert!(world.set_shape(kept, ball(-1.0)).is_err());
    assert!(world.body(kept).unwrap().shape().is_same(&ball(1.0)));
}
