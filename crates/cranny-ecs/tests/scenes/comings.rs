//! Bodies that come and go at random leave nothing behind, and repeat.

use std::f32::consts::FRAC_PI_2;

use bevy_app::App;
use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::message::{Messages, message_update_system};
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_shapes::Torus;
use proptest::prelude::*;

use crate::build::{empty, steps, unit, world};

/// What an app does between two steps. Numbers pick one of those that are there.
#[derive(Clone, Debug)]
enum Act {
    Spawn { kind: usize, shape: usize, at: [i8; 3] },
    Despawn(usize),
    Strip(usize),
    Turn(usize),
    Change(usize, usize),
    Part(usize),
    Unpart(usize),
    Join(usize, usize, usize),
    Pair(usize, usize, usize),
    Unrelate(usize),
    Step,
}

/// How often each act is drawn, spawning first.
const WEIGHTS: [u32; 11] = [8, 5, 1, 2, 6, 2, 1, 2, 2, 2, 4];

/// The act of a number, its picks drawn by `next` below a bound.
fn act_of(number: usize, mut next: impl FnMut(usize) -> usize) -> Act {
    match number {
        0 => {
            let (kind, shape) = (next(4), next(6));
            Act::Spawn { kind, shape, at: [0; 3].map(|_: i8| next(7) as i8 - 3) }
        }
        1 => Act::Despawn(next(100)),
        2 => Act::Strip(next(100)),
        3 => Act::Turn(next(100)),
        4 => Act::Change(next(100), next(16)),
        5 => Act::Part(next(100)),
        6 => Act::Unpart(next(100)),
        7 => Act::Join(next(100), next(100), next(3)),
        8 => Act::Pair(next(100), next(100), next(3)),
        9 => Act::Unrelate(next(100)),
        _ => Act::Step,
    }
}

fn act() -> impl Strategy<Value = Act> {
    let numbers =
        WEIGHTS.iter().enumerate().map(|(number, &weight)| (weight, Just(number).boxed()));
    let number = proptest::strategy::Union::new_weighted(numbers.collect());
    (number, prop::array::uniform5(0usize..10_000)).prop_map(|(number, drawn)| {
        let mut drawn = drawn.into_iter().cycle();
        act_of(number, |below| drawn.next().unwrap() % below)
    })
}

/// What acts have made of an app.
#[derive(Default)]
struct Seen {
    came: usize,
    /// Pairs that began to touch.
    met: usize,
    joined: usize,
    parts: usize,
    /// The most pairs that the solver examined in a step.
    pairs: usize,
    hash: String,
}

/// What is there.
#[derive(Default)]
struct Present {
    bodies: Vec<Entity>,
    parts: Vec<Entity>,
    /// Joints and pairs.
    relations: Vec<Entity>,
}

fn app() -> App {
    let effects = [Effect::TRIGGER, Effect::Response];
    app_with(if cfg!(feature = "rapier") { &effects[..] } else { &effects[..1] })
}

fn app_with(effects: &[Effect]) -> App {
    let kinds = [EffectKind::Proximity, EffectKind::Contacts];
    // As a scene of unit cubes has it.
    let options = PluginOptions { length_unit: Some(1.0 / 3.0), ..PluginOptions::default() };
    let plugins = CrannyPlugins::new(1.0 / 64.0).unwrap().options(&options);
    let mut app = App::empty();
    app.add_plugins(plugins.effects(effects).unwrap().available(&kinds).unwrap());
    app
}

/// A step as in an app with a main schedule, which forgets messages and removals of old.
fn step(world: &mut World) {
    world.run_system_cached(message_update_system).unwrap();
    world.run_schedule(CrannyStep);
    world.clear_trackers();
    if let Some(failure) = world.resource_mut::<Failure>().take() {
        panic!("{failure}");
    }
}

fn picked(i: usize, from: &[Entity]) -> Option<usize> {
    (!from.is_empty()).then(|| i % from.len())
}

/// Inserts or removes a component of a body.
fn change(world: &mut World, body: Entity, which: usize, meshes: &[Collider; 2]) {
    let is_mesh = world.get::<Collider>(body).is_some_and(|c| c.model().is_some());
    let mut body = world.entity_mut(body);
    match which {
        0 => body.insert(Sensor),
        1 => body.remove::<Sensor>(),
        2 => body.insert(CollisionLayers::new(0b10, 0b11)),
        3 => body.remove::<CollisionLayers>(),
        4 => body.insert((Friction::new(0.1), Restitution::new(0.5), Density(2.0))),
        5 => body.remove::<(Friction, Restitution, Density)>(),
        6 => body.insert((GravityScale(0.5), LockedAxes::ROTATION_LOCKED)),
        7 => body.remove::<(GravityScale, LockedAxes, ExternalForce)>(),
        8 => body.insert(ExternalForce { force: Vec3::Z, torque: Vec3::X }),
        9 => body.insert(LinearVelocity(Vec3::new(0.5, -0.5, 0.0))),
        10 => body.insert(Proximity { within: 0.25 }),
        11 => body.remove::<Proximity>(),
        12 => body.insert(Contacts { margin: 0.05 }),
        13 => body.remove::<Contacts>(),
        // A primitive would be one of several where the body has parts.
        14 if is_mesh => body.insert((meshes[0].clone(), SmoothNormals { crease_angle: 0.5 })),
        _ if is_mesh => body.remove::<SmoothNormals>().insert(meshes[1].clone()),
        _ => body.insert(RigidBody::Dynamic),
    };
}

/// A joint as two bodies stand.
fn joint(world: &World, [parent, child]: [Entity; 2], kind: usize) -> Joint {
    let at = |body| pose_of(world.get::<Transform>(body).unwrap());
    let parent_from_world = at(parent).world_from_body().inverse();
    let apart = parent_from_world.apply(at(child).translation);
    let rotation = at(parent).rotation.conjugate() * at(child).rotation;
    let parent_anchor = Pose { rotation, translation: apart };
    let of_kind = [
        Joint::fixed(parent, child),
        Joint::revolute(parent, child, DVec3::Z),
        Joint::prismatic(parent, child, DVec3::X),
    ];
    Joint { parent_anchor, ..of_kind[kind] }
}

/// Acts, and takes all away at the end.
fn acted(world: &mut World, acts: &[Act]) -> Seen {
    let ring = Torus { major_segments: 12, minor_segments: 6, ..Torus::default() };
    let meshes = [unit(), Collider::from_mesh(ring.build().unwrap()).unwrap()];
    let colliders = [
        meshes[0].clone(),
        meshes[1].clone(),
        Collider::ball(0.5),
        Collider::capsule(0.3, 0.6),
        Collider::cylinder(0.4, 0.8),
        Collider::cone(0.5, 0.8),
    ];
    let kinds = [RigidBody::Dynamic, RigidBody::Dynamic, RigidBody::Kinematic, RigidBody::Fixed];
    let mut seen = Seen::default();
    let mut there = Present::default();
    for act in acts {
        match *act {
            Act::Spawn { kind, shape, at } => {
                let collider = colliders[shape].clone();
                let [x, y, z] = at.map(|c| 0.6 * f32::from(c));
                let body = (kinds[kind], collider, Transform::from_xyz(x, y, z));
                there.bodies.push(world.spawn(body).id());
                seen.came += 1;
            }
            Act::Despawn(i) => {
                if let Some(i) = picked(i, &there.bodies) {
                    assert!(world.despawn(there.bodies.remove(i)));
                }
            }
            Act::Strip(i) => {
                if let Some(i) = picked(i, &there.bodies) {
                    world.entity_mut(there.bodies[i]).remove::<Collider>();
                    step(world);
                    world.despawn(there.bodies.remove(i));
                }
            }
            Act::Turn(i) => {
                if let Some(i) = picked(i, &there.bodies) {
                    let rotation = Quat::from_rotation_x(FRAC_PI_2);
                    world.get_mut::<Transform>(there.bodies[i]).unwrap().rotation = rotation;
                }
            }
            Act::Change(i, which) => {
                if let Some(i) = picked(i, &there.bodies) {
                    change(world, there.bodies[i], which, &meshes);
                }
            }
            Act::Part(i) => {
                let Some(body) = picked(i, &there.bodies).map(|i| there.bodies[i]) else {
                    continue;
                };
                let is_mesh = world.get::<Collider>(body).is_some_and(|c| c.model().is_some());
                // Another part would lie in the first.
                if is_mesh && world.get::<Children>(body).is_none_or(|c| c.is_empty()) {
                    let place = Transform::from_xyz(2.0, 0.0, 0.0);
                    let part = (meshes[0].clone(), place, ChildOf(body));
                    there.parts.push(world.spawn(part).id());
                    seen.parts += 1;
                }
            }
            Act::Unpart(i) => {
                if let Some(i) = picked(i, &there.parts) {
                    // It may have left with its body.
                    let _ = world.try_despawn(there.parts.remove(i));
                }
            }
            Act::Join(i, j, kind) => {
                let ends = picked(i, &there.bodies).zip(picked(j, &there.bodies));
                if let Some((i, j)) = ends.filter(|(i, j)| i != j) {
                    let joint = joint(world, [i, j].map(|i| there.bodies[i]), kind);
                    there.relations.push(world.spawn(joint).id());
                    seen.joined += 1;
                }
            }
            Act::Pair(i, j, kind) => {
                let ends = picked(i, &there.bodies).zip(picked(j, &there.bodies));
                if let Some((i, j)) = ends.filter(|(i, j)| i != j) {
                    let pair = BodyPair { a: there.bodies[i], b: there.bodies[j] };
                    let mut pair = world.spawn(pair);
                    match kind {
                        0 => pair.insert(NeverMeet),
                        1 => pair.insert(Contacts { margin: 0.1 }),
                        _ => pair.insert(Proximity { within: 0.5 }),
                    };
                    there.relations.push(pair.id());
                }
            }
            Act::Unrelate(i) => {
                if let Some(i) = picked(i, &there.relations) {
                    world.despawn(there.relations.remove(i));
                }
            }
            Act::Step => {
                step(world);
                let messages = world.resource::<Messages<CollisionStart>>();
                seen.met += messages.iter_current_update_messages().count();
                #[cfg(feature = "rapier")]
                {
                    let rigid = world.get_resource::<RigidBodies>();
                    let pairs = rigid.map_or(0, |rigid| rigid.simulation().pair_count());
                    seen.pairs = seen.pairs.max(pairs);
                }
            }
        }
    }
    step(world);
    seen.hash = state_hash(world);
    for entity in there.bodies.into_iter().chain(there.relations) {
        world.despawn(entity);
    }
    (0..3).for_each(|_| step(world));
    seen
}

/// How many entities an app has that has seen a body come and go: systems are entities too.
fn settled(world: &mut World) -> u32 {
    let body = world.spawn((RigidBody::Dynamic, unit())).id();
    (0..2).for_each(|_| step(world));
    world.despawn(body);
    (0..2).for_each(|_| step(world));
    world.entities().count_spawned()
}

fn nothing_is_left(world: &mut World, entities: u32) {
    assert_eq!(world.entities().count_spawned(), entities);
    assert_eq!(world.resource::<Bodies>().iter().len(), 0);
    assert_eq!(world.resource::<EffectTable>().bodies().len(), 0);
    assert_eq!(world.resource::<EffectTable>().of_pairs().count(), 0);
    let mut detector = world.resource_mut::<Detector>();
    let pairs = detector.world();
    pairs.validate().unwrap();
    assert_eq!((pairs.bodies().len(), pairs.remembered_pairs()), (0, 0));
    #[cfg(feature = "rapier")]
    {
        let rigid = world.resource::<RigidBodies>();
        let simulation = rigid.simulation();
        assert_eq!((simulation.len(), simulation.pair_count()), (0, 0));
        assert_eq!(rigid.answers().count(), 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn whatever_comes_and_goes_leaves_nothing_and_repeats_to_the_bit(
        acts in prop::collection::vec(act(), 90),
    ) {
        let run = || {
            let mut app = app();
            let before = settled(app.world_mut());
            let seen = acted(app.world_mut(), &acts);
            nothing_is_left(app.world_mut(), before);
            seen.hash
        };
        prop_assert_eq!(run(), run());
    }
}

/// Acts with so many bodies that come, of which 24 are there at once at most.
fn drawn(spawned: usize) -> Vec<Act> {
    // A small generator of its own: the same acts in every run.
    let mut seed = 0x2545_f491_4f6c_dd1du64;
    let mut next = move |below: usize| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed % below as u64) as usize
    };
    let total = WEIGHTS.iter().sum::<u32>() as usize;
    let (mut acts, mut came, mut present) = (Vec::new(), 0, 0);
    while came < spawned {
        let mut at = next(total) as u32;
        let number = WEIGHTS.iter().position(|&weight| {
            let here = at < weight;
            at = at.saturating_sub(weight);
            here
        });
        let act = act_of(number.unwrap(), &mut next);
        match act {
            Act::Spawn { .. } if present < 24 => (came, present) = (came + 1, present + 1),
            Act::Spawn { .. } => continue,
            Act::Despawn(_) | Act::Strip(_) if present > 0 => present -= 1,
            // One step for some four acts that change pairs.
            Act::Step if next(4) != 0 => continue,
            _ => {}
        }
        acts.push(act);
    }
    acts
}

#[test]
fn ten_thousand_bodies_that_come_and_go_leave_nothing() {
    let acts = drawn(10_000);
    let run = || {
        let mut app = app();
        let before = settled(app.world_mut());
        let seen = acted(app.world_mut(), &acts);
        nothing_is_left(app.world_mut(), before);
        // They are close enough to each other that there is something to leave behind.
        assert_eq!(seen.came, 10_000);
        let counts = [seen.met, seen.joined, seen.parts];
        assert!(counts[0] > 1_000 && counts[1] > 500 && counts[2] > 200, "{counts:?}");
        assert!(seen.pairs > 20 || cfg!(not(feature = "rapier")), "{}", seen.pairs);
        seen.hash
    };
    assert_eq!(run(), run());
}

/// How many bytes an app holds after 2,000 bodies more than before.
fn bytes_left(effects: &[Effect]) -> i64 {
    let acts = drawn(2_000);
    let mut app = app_with(effects);
    settled(app.world_mut());
    // What grows with the most that are there at once has grown after a round.
    acted(app.world_mut(), &acts);
    let info = allocation_counter::measure(|| {
        acted(app.world_mut(), &acts);
    });
    assert!(info.bytes_total > 1_000_000, "{info:?}");
    info.bytes_current
}

/// Whatever is kept for each body or pair, shapes among it, would show 2,000 times and more.
#[test]
fn no_byte_is_left_of_two_thousand_bodies() {
    let left = bytes_left(&[Effect::TRIGGER]);
    assert!(left.abs() < 4 * 2_000, "less than an id a body: {left}");
}

/// rapier 0.36 keeps, in its broad phase, pairs of a collider of which another takes the place
/// before the next step: 21 bytes each, in a table that doubles.
#[cfg(feature = "rapier")]
#[test]
fn of_bodies_in_the_solver_only_pairs_of_its_broad_phase_are_left() {
    let left = bytes_left(&[Effect::TRIGGER, Effect::Response]);
    assert!(left < 100 * 2_000, "{left}");
}

/// A summary names what touched and left: here nothing does.
#[test]
fn a_scene_app_forgets_what_left_too() {
    let mut app = empty(&[Effect::Penetration]);
    let unit = unit();
    let mut round = |count: usize| {
        for _ in 0..count {
            let body = world(&mut app).spawn((RigidBody::Kinematic, unit.clone())).id();
            steps(&mut app, 1);
            world(&mut app).despawn(body);
        }
        steps(&mut app, 2);
    };
    round(500);
    let info = allocation_counter::measure(|| round(2_000));
    assert!(info.bytes_current.abs() < 2_000, "less than a byte a body: {info:?}");
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
