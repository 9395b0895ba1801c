//! Bodies that come and go at random leave nothing behind, and repeat.

use std::f32::consts::FRAC_PI_2;

use bevy_ecs::prelude::*;
use bevy_math::Quat;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_shapes::Torus;
use cranny_world::description::Effect;
use proptest::prelude::*;

use crate::build::{empty, steps, unit, world};

/// What an app does between two steps.
#[derive(Clone, Debug)]
enum Act {
    Spawn { dynamic: bool, shape: usize, at: [i8; 3] },
    Despawn(usize),
    Strip(usize),
    Turn(usize),
    Step,
}

fn act() -> impl Strategy<Value = Act> {
    let place = prop::array::uniform3(-3i8..=3);
    prop_oneof![
        4 => (any::<bool>(), 0usize..6, place)
            .prop_map(|(dynamic, shape, at)| Act::Spawn { dynamic, shape, at }),
        3 => (0usize..100).prop_map(Act::Despawn),
        1 => (0usize..100).prop_map(Act::Strip),
        1 => (0usize..100).prop_map(Act::Turn),
        2 => Just(Act::Step),
    ]
}

/// Acts, and returns how many bodies came and the hash of the state.
fn acted(app: &mut SceneApp, acts: &[Act]) -> (usize, String) {
    let ring = Collider::from_mesh(Torus::default().build().unwrap()).unwrap();
    let colliders = [
        unit(),
        ring,
        Collider::ball(0.5),
        Collider::capsule(0.3, 0.6),
        Collider::cylinder(0.4, 0.8),
        Collider::cone(0.5, 0.8),
    ];
    let mut live: Vec<Entity> = Vec::new();
    let mut came = 0;
    for act in acts {
        let pick = |i: &usize, live: &[Entity]| (!live.is_empty()).then(|| i % live.len());
        match act {
            Act::Spawn { dynamic, shape, at } => {
                let collider = colliders[*shape].clone();
                let kind = if *dynamic { RigidBody::Dynamic } else { RigidBody::Fixed };
                let [x, y, z] = at.map(|c| 0.6 * f32::from(c));
                live.push(world(app).spawn((kind, collider, Transform::from_xyz(x, y, z))).id());
                came += 1;
            }
            Act::Despawn(i) => {
                if let Some(i) = pick(i, &live) {
                    assert!(world(app).despawn(live.remove(i)));
                }
            }
            Act::Strip(i) => {
                if let Some(i) = pick(i, &live) {
                    world(app).entity_mut(live[i]).remove::<Collider>();
                    steps(app, 1);
                    world(app).despawn(live.remove(i));
                }
            }
            Act::Turn(i) => {
                if let Some(i) = pick(i, &live) {
                    let rotation = Quat::from_rotation_x(FRAC_PI_2);
                    world(app).get_mut::<Transform>(live[i]).unwrap().rotation = rotation;
                }
            }
            Act::Step => steps(app, 1),
        }
    }
    steps(app, 1);
    let hash = state_hash(app.app().world());
    for entity in live {
        world(app).despawn(entity);
    }
    steps(app, 2);
    (came, hash)
}

/// How many entities an app has that has seen a body come and go: systems are entities too.
fn settled(app: &mut SceneApp) -> u32 {
    let body = world(app).spawn((RigidBody::Dynamic, unit())).id();
    steps(app, 2);
    world(app).despawn(body);
    steps(app, 2);
    world(app).entities().count_spawned()
}

fn nothing_is_left(app: &mut SceneApp, entities: u32) {
    let world = world(app);
    assert_eq!(world.entities().count_spawned(), entities);
    assert_eq!(world.resource::<Bodies>().iter().len(), 0);
    assert_eq!(world.resource::<EffectTable>().bodies().len(), 0);
    let mut detector = world.resource_mut::<Detector>();
    let pairs = detector.world();
    pairs.validate().unwrap();
    assert_eq!((pairs.bodies().len(), pairs.remembered_pairs()), (0, 0));
    #[cfg(feature = "rapier")]
    if let Some(rigid) = world.get_resource::<RigidBodies>() {
        let simulation = rigid.simulation();
        assert_eq!((simulation.len(), simulation.pair_count()), (0, 0));
        assert_eq!(rigid.answers().count(), 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn whatever_comes_and_goes_leaves_nothing_and_repeats_to_the_bit(
        acts in prop::collection::vec(act(), 60),
    ) {
        let effects = [Effect::TRIGGER, Effect::Response];
        let effects = if cfg!(feature = "rapier") { &effects[..] } else { &effects[..1] };
        let run = || {
            let mut app = empty(effects);
            let before = settled(&mut app);
            let (_, hash) = acted(&mut app, &acts);
            nothing_is_left(&mut app, before);
            hash
        };
        prop_assert_eq!(run(), run());
    }
}

#[test]
fn ten_thousand_bodies_that_come_and_go_leave_nothing() {
    let effects = [Effect::TRIGGER, Effect::Response];
    let effects = if cfg!(feature = "rapier") { &effects[..] } else { &effects[..1] };
    let run = || {
        let mut app = empty(effects);
        let before = settled(&mut app);
        // A small generator of its own: the same acts in every run.
        let mut seed = 0x2545_f491_4f6c_dd1du64;
        let mut next = move |below: u64| {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            seed % below
        };
        let mut acts = Vec::new();
        let (mut spawned, mut present) = (0, 0i64);
        while spawned < 10_000 {
            let place = [next(200) as i8, next(200) as i8, next(100) as i8];
            if next(2) == 0 && present < 40 {
                // Cubes and balls: the others cost more a pair.
                let (dynamic, shape) = (next(2) == 0, 2 * (next(2) as usize));
                acts.push(Act::Spawn { dynamic, shape, at: place });
                (spawned, present) = (spawned + 1, present + 1);
            } else if present > 0 {
                acts.push(Act::Despawn(next(100) as usize));
                present -= 1;
            }
            if next(16) == 0 {
                acts.push(Act::Step);
            }
        }
        let (came, hash) = acted(&mut app, &acts);
        assert_eq!(came, 10_000);
        nothing_is_left(&mut app, before);
        hash
    };
    assert_eq!(run(), run());
}

#[test]
fn a_summary_names_what_triggered_and_is_gone() {
    let mut app = empty(&[Effect::TRIGGER]);
    let body = |app: &mut SceneApp, kind, x: f32, name: &'static str| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        world(app).spawn((kind, unit(), place, Name::new(name))).id()
    };
    body(&mut app, RigidBody::Fixed, 0.0, "gate");
    let guest = body(&mut app, RigidBody::Kinematic, 0.5, "guest");
    steps(&mut app, 2);
    assert!(world(&mut app).despawn(guest));
    steps(&mut app, 4);
    let summary = app.finish().unwrap();
    let [trigger] = summary.triggers.as_slice() else { panic!("{:?}", summary.triggers) };
    let (a, b) = (trigger.a.as_str(), trigger.b.as_str());
    assert_eq!((a, b, trigger.times), ("gate", "guest", 1));
}
