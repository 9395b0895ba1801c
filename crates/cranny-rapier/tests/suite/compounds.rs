//! Compounds, of rapier's shapes and of ours: each part meets what it meets alone.

use cranny_exact::DVec3;
use cranny_rapier::dispatcher;
use cranny_shapes::Cup;
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::query::{PersistentQueryDispatcher, QueryDispatcher, ShapeCastOptions};
use rapier3d::parry::shape::{Ball, SharedShape};
use rapier3d::prelude::{ContactData, ContactManifold, ContactManifoldData};

use crate::world::{World, cuboid, model, ours, up};

fn balls() -> SharedShape {
    let ball = |x: Real, y: Real| (Pose::translation(x, y, 0.0), SharedShape::ball(0.2));
    SharedShape::compound(vec![ball(-0.3, -0.2), ball(0.3, -0.2), ball(0.0, 0.3)])
}

/// A bar of rapier's with a cube of ours at either end, of which the cubes reach lower.
fn dumbbell() -> SharedShape {
    let cube = |x: Real| (Pose::translation(x, 0.0, 0.0), ours(&cuboid(0.4, 0.4, 0.4)));
    let bar = (Pose::IDENTITY, SharedShape::cuboid(0.5, 0.1, 0.1));
    SharedShape::compound(vec![cube(-0.6), bar, cube(0.6)])
}

/// A row of boxes with their tops at z = 0, which share edges.
fn boxes() -> SharedShape {
    let part = |x: Real| (Pose::translation(x, 0.0, -0.25), SharedShape::cuboid(0.5, 2.0, 0.25));
    SharedShape::compound([-1.5, -0.5, 0.5, 1.5].map(part).to_vec())
}

fn alone(shape: SharedShape) -> SharedShape {
    SharedShape::compound(vec![(Pose::IDENTITY, shape)])
}

#[test]
fn they_rest_on_each_other() {
    let slab = ours(&cuboid(4.0, 4.0, 1.0));
    let cube = ours(&cuboid(1.0, 1.0, 1.0));
    for (name, lower, upper, rest) in [
        ("balls on ours", &slab, &balls(), 0.7),
        ("ours on balls", &balls(), &cube, 0.7),
        ("dumbbell on ours", &slab, &dumbbell(), 0.7),
        ("dumbbell on a cuboid", &SharedShape::cuboid(2.0, 2.0, 0.5), &dumbbell(), 0.7),
        ("dumbbell on boxes", &boxes(), &dumbbell(), 0.2),
        ("ours on boxes", &boxes(), &cube, 0.5),
        ("ours in a compound on boxes", &boxes(), &alone(cube.clone()), 0.5),
        ("dumbbell on a half-space", &SharedShape::halfspace(Vector::Z), &dumbbell(), 0.2),
    ] {
        for upper_first in [false, true] {
            let mut world = World::new();
            let insert_lower = |world: &mut World| world.fixed(lower, Pose::IDENTITY);
            if !upper_first {
                insert_lower(&mut world);
            }
            let body = world.dynamic(upper, up(rest + 0.05));
            if upper_first {
                insert_lower(&mut world);
            }
            world.run(180);
            let at = world.at(body);
            let what = format!("{name}, upper first: {upper_first}: {at}, not {rest} high");
            assert!((at.z - rest).abs() < 1e-2 && at.truncate().length() < 2e-2, "{what}");
            assert!(world.0.bodies[body].linvel().length() < 1e-2, "{what}: it moves");
        }
    }
}

/// Two cups back to back: what falls into the upper one's well must stay there, which no hull would
/// let in.
#[test]
fn a_ball_falls_into_the_cup_of_a_compound() {
    let cup = ours(&model(Cup { radius: 0.5, segments: 32, ..Cup::default() }));
    let turned = Rotation::from_rotation_x(std::f64::consts::PI as Real);
    let cups = SharedShape::compound(vec![
        (Pose::IDENTITY, cup.clone()),
        (Pose::from_parts(Vector::new(0.0, 0.0, -2.0), turned), cup),
    ]);
    let mut world = World::new();
    world.fixed(&cups, Pose::IDENTITY);
    let body = world.dynamic(&SharedShape::ball(0.2), Pose::translation(0.1, 0.0, 2.0));
    world.run(300);
    let at = world.at(body);
    assert!(at.truncate().length() < 0.3, "{at}");
    // Just above the well's floor: the rim is far higher.
    let alone = {
        let mut world = World::new();
        world.fixed(
            &ours(&model(Cup { radius: 0.5, segments: 32, ..Cup::default() })),
            Pose::IDENTITY,
        );
        let body = world.dynamic(&SharedShape::ball(0.2), Pose::translation(0.1, 0.0, 2.0));
        world.run(300);
        world.at(body)
    };
    assert!((at.z - alone.z).abs() < 1e-3, "{at}, alone {alone}");
}

/// Points of all manifolds in the first shape's frame: place, normal, distance.
fn points(
    pose: &Pose,
    g1: &SharedShape,
    g2: &SharedShape,
    reach: Real,
) -> Vec<(Vector, Vector, Real)> {
    let mut manifolds: Vec<ContactManifold> = Vec::new();
    let dispatcher = dispatcher();
    let dispatcher: &dyn PersistentQueryDispatcher<ContactManifoldData, ContactData> = &dispatcher;
    dispatcher
        .contact_manifolds(pose, &*g1.0, &*g2.0, reach, &mut manifolds, &mut None)
        .expect("known");
    let mut points: Vec<_> = manifolds
        .iter()
        .flat_map(|m| m.points.iter().map(|p| (p.local_p1, m.local_n1, p.dist)))
        .collect();
    points.sort_by(|x, y| {
        let key = |p: &(Vector, Vector, Real)| [p.0.x, p.0.y, p.0.z, p.2];
        key(x).partial_cmp(&key(y)).expect("finite")
    });
    points
}

/// A part of a compound meets what it would meet alone, at the same places, to rounding.
#[test]
fn a_part_has_the_contacts_that_it_has_alone() {
    let (part, partner) = (ours(&cuboid(1.0, 1.0, 1.0)), ours(&cuboid(0.5, 0.5, 0.5)));
    // Not turned: which points stand for a face that is a rounding deeper at one end is chance.
    let at = Pose::translation(0.25, -0.5, 1.0);
    let pair = Pose::translation(0.5, -0.25, 1.73);
    let far = (Pose::translation(9.0, 0.0, 0.0), SharedShape::ball(0.5));
    let compound = SharedShape::compound(vec![far, (at, part.clone())]);
    let found = points(&pair, &compound, &partner, 0.05);
    let alone = points(&(at.inverse() * pair), &part, &partner, 0.05);
    let back: Vec<Vector> = alone.iter().map(|(p, ..)| at.transform_point(*p)).collect();
    assert!(found.len() >= 4, "{found:?}");
    assert_eq!(found.len(), alone.len());
    for (p, normal, dist) in &found {
        assert!(back.iter().any(|q| (*q - *p).length() < 1e-5), "{p} is not of {back:?}");
        assert!((*normal - Vector::Z).length() < 1e-5 && (dist + 0.02).abs() < 1e-5);
    }
}

#[test]
fn single_questions_see_the_parts() {
    let dispatcher = dispatcher();
    let compound = dumbbell();
    let probe = Ball::new(0.05);
    let at = |x: Real, y: Real, z: Real| Pose::translation(x, y, z);
    let meets = |pose: &Pose| {
        dispatcher.intersection_test(pose, &*compound.0, &probe).expect("known").intersecting
    };
    // Inside a cube of ours, which is solid; between cube and bar; beside the bar.
    assert!(meets(&at(0.6, 0.0, 0.0)) && meets(&at(0.0, 0.12, 0.0)));
    assert!(!meets(&at(0.0, 0.16, 0.0)) && !meets(&at(0.6, 0.26, 0.0)));
    let swapped = dispatcher.intersection_test(&at(-0.6, 0.0, 0.0), &probe, &*compound.0);
    assert!(swapped.expect("known").intersecting);

    let cube = ours(&cuboid(0.2, 0.2, 0.2));
    let apart = dispatcher.distance(&at(0.6, 0.0, 0.5), &*compound.0, &*cube.0).expect("known");
    assert!((apart.distance - 0.2).abs() < 1e-6, "{}", apart.distance);
    let contact = dispatcher.contact(&at(0.6, 0.0, 0.29), &*compound.0, &*cube.0, 0.1);
    let contact = contact.expect("known").expect("they overlap");
    assert!((contact.dist + 0.01).abs() < 1e-6, "{}", contact.dist);
    assert!((contact.normal1 - Vector::Z).length() < 1e-6, "{}", contact.normal1);
    let cast = dispatcher.cast_shapes(
        &at(0.6, 0.0, 1.3),
        Vector::new(0.0, 0.0, -1.0),
        &*compound.0,
        &*cube.0,
        ShapeCastOptions::with_max_time_of_impact(5.0),
    );
    let hit = cast.expect("known").expect("it falls onto the cube");
    assert!((hit.time_of_impact - 1.0).abs() < 1e-3, "{}", hit.time_of_impact);
}

/// Mass and inertia of ours within a compound are those of the solids.
#[test]
fn a_compound_weighs_what_its_parts_weigh() {
    let mass = dumbbell().mass_properties(2.0);
    let volume = 2.0 * Real::powi(0.4, 3) + 1.0 * 0.2 * 0.2;
    assert!((mass.mass() - 2.0 * volume).abs() < 1e-5, "{}", mass.mass());
    assert!(cranny_rapier::wide(mass.local_com).abs_diff_eq(DVec3::ZERO, 1e-6));
}
