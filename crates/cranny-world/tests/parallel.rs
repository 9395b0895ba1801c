//! The same world under one thread and under several: every answer, event and count is equal.

use std::num::NonZeroUsize;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Model};
use cranny_shapes::Torus;
use cranny_world::description::Effect;
use cranny_world::{BodySpec, World};

/// 27 rings so close that each meets several others, in all demands at once.
fn rings() -> World {
    let mesh = Torus { major_segments: 16, minor_segments: 8, ..Torus::default() }.build().unwrap();
    let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
    let mut world = World::new();
    world.set_scene_effects(&[Effect::TRIGGER, Effect::Contacts { margin: 0.05 }]).unwrap();
    for i in 0..27 {
        world
            .insert(BodySpec { pose: pose(i, 0), ..BodySpec::new(i.to_string(), model.clone()) })
            .unwrap();
    }
    world
}

/// Every ring turns about an axis of its own; none twice as fast as another.
fn pose(ring: u32, step: u32) -> Pose {
    let place = DVec3::new((ring % 3).into(), (ring / 3 % 3).into(), (ring / 9).into());
    let angle = f64::from(step) * 0.02 * (1.0 + f64::from(ring % 5) / 8.0);
    let axis = DVec3::new(1.0, f64::from(ring % 4), f64::from(ring % 7)).normalize();
    Pose {
        translation: 1.7 * place,
        rotation: DQuat::from_axis_angle(axis, angle + f64::from(ring)),
    }
}

#[test]
fn any_number_of_threads_tells_the_same() {
    let mut alone = rings();
    let mut crews: Vec<World> = [2, 3, 8]
        .into_iter()
        .map(|threads| {
            let mut world = rings();
            world.set_threads(NonZeroUsize::new(threads).unwrap()).unwrap();
            world
        })
        .collect();
    let (mut answers, mut events) = (0, 0);
    for step in 1..=6 {
        for world in crews.iter_mut().chain([&mut alone]) {
            let ids: Vec<_> = world.bodies().map(|(id, _)| id).collect();
            ids.iter().for_each(|&id| world.set_pose(id, pose(id.0, step)).unwrap());
        }
        // Half-way through, the threads change.
        if step == 4 {
            crews[0].set_threads(NonZeroUsize::MIN).unwrap();
            crews[1].set_threads(NonZeroUsize::new(2).unwrap()).unwrap();
        }
        let expected = alone.step().unwrap();
        (answers, events) = (answers + expected.answers.len(), events + expected.events.len());
        for world in &mut crews {
            assert_eq!(format!("{:?}", world.step().unwrap()), format!("{expected:?}"));
            world.validate().unwrap();
        }
    }
    assert!(answers > 200 && events > 10, "{answers} answers, {events} events");
}

/// The budget is shared before it is spent, so it does not matter who spends it.
#[test]
fn a_budget_is_shared_alike_with_any_number_of_threads() {
    let start = || {
        let mut world = rings();
        world.set_scene_effects(&[Effect::TRIGGER, Effect::proximity(0.3)]).unwrap();
        world.set_budget(Some(700));
        world
    };
    let mut alone = start();
    let mut crews = [2, 5].map(|threads| {
        let mut world = start();
        world.set_threads(NonZeroUsize::new(threads).unwrap()).unwrap();
        world
    });
    let (mut open, mut settled) = (0, 0);
    for step in 1..=8 {
        for world in crews.iter_mut().chain([&mut alone]) {
            let ids: Vec<_> = world.bodies().map(|(id, _)| id).collect();
            ids.iter().for_each(|&id| world.set_pose(id, pose(id.0, step)).unwrap());
        }
        let expected = alone.step().unwrap();
        open += expected.stats.estimates.open;
        settled += expected.stats.estimates.pairs - expected.stats.estimates.unsettled;
        for world in &mut crews {
            assert_eq!(format!("{:?}", world.step().unwrap()), format!("{expected:?}"));
        }
    }
    assert!(open > 0 && settled > 0, "{open} open, {settled} settled");
}

#[test]
fn verification_asks_every_pair_twice_and_changes_nothing() {
    let (mut plain, mut verified) = (rings(), rings());
    verified.set_verification(true);
    verified.set_threads(NonZeroUsize::new(2).unwrap()).unwrap();
    for step in 1..=5 {
        for world in [&mut plain, &mut verified] {
            let ids: Vec<_> = world.bodies().map(|(id, _)| id).collect();
            ids.iter().for_each(|&id| world.set_pose(id, pose(id.0, step)).unwrap());
        }
        if step == 5 {
            verified.set_verification(false);
        }
        let (expected, found) = (plain.step().unwrap(), verified.step().unwrap());
        let twice = if step < 5 { found.stats.queried_pairs } else { 0 };
        assert_eq!((expected.stats.verified_pairs, found.stats.verified_pairs), (0, twice));
        assert!(found.stats.queried_pairs > 20);
        assert_eq!((found.answers, found.events), (expected.answers, expected.events));
        assert_eq!((found.mismatches.len(), expected.mismatches.len()), (0, 0));
    }
}
