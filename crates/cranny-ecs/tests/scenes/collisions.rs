//! What an app reads of collisions, and what it decides about them.

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::system::{SystemParam, SystemState};
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_world::description::Effect;

use crate::build::{cuboid, empty, height, messages, steps, unit, up, world};

const G: f64 = 10.0;
const STEP: f64 = 1.0 / 64.0;

fn close(a: f64, b: f64, within: f64) -> bool {
    (a - b).abs() <= within * b.abs()
}

/// The first start that is reported within so many steps, and the velocity of a body before it.
fn first_start(app: &mut SceneApp, of: Entity, within: usize) -> (CollisionStart, f64) {
    for _ in 0..within {
        let speed = world(app).get::<LinearVelocity>(of).unwrap().0.z;
        steps(app, 1);
        if let Some(start) = messages::<CollisionStart>(app).first() {
            return (*start, -f64::from(speed));
        }
    }
    panic!("nothing touched within {within} steps");
}

#[test]
fn what_bounces_off_between_two_poses_is_reported_with_place_speed_and_impulse() {
    let mut app = empty(&[Effect::Response, Effect::TRIGGER]);
    let bouncy = Restitution::new(1.0);
    let floor = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0), bouncy)).id();
    let fast = LinearVelocity(Vec3::new(0.0, 0.0, -12.0));
    let ball = world(&mut app).spawn((RigidBody::Dynamic, unit(), up(4.03), bouncy, fast)).id();
    let (start, speed) = first_start(&mut app, ball, 40);
    assert_eq!((start.body, start.other), (floor, ball));
    let contact = start.contact.expect("the solver knows it");
    assert!((contact.deepest.normal - DVec3::Z).length() < 1e-6, "{contact:?}");
    assert!((contact.deepest.point.z - 0.5).abs() < 0.2, "{contact:?}");
    assert!(close(contact.speed, speed, 1e-5), "{contact:?} {speed}");
    // What it had, what gravity added within the step, and as much again.
    let (least, most) = (2.0 * speed - 0.5, 2.0 * (speed + G * STEP) + 0.5);
    assert!((least..most).contains(&contact.impulse), "{contact:?} {speed}");
    assert_eq!(start.flipped().contact.unwrap().deepest.normal, -contact.deepest.normal);
    steps(&mut app, 2); // it leaves from where it touches
    let ends = messages::<CollisionEnd>(&app);
    assert_eq!((ends.len(), ends[0].body, ends[0].other), (1, floor, ball));
    assert!(height(&app, ball) > 1.0);
}

#[test]
fn contacts_are_read_by_entity() {
    let mut app = empty(&[Effect::Response]);
    let floor = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let upper = world(&mut app).spawn((RigidBody::Dynamic, unit(), up(1.001))).id();
    let aside = (RigidBody::Fixed, unit(), Transform::from_xyz(5.0, 0.0, 0.0));
    let aside = world(&mut app).spawn(aside).id();
    steps(&mut app, 30);
    let world = world(&mut app);
    let mut state = SystemState::<Collisions>::new(world);
    let collisions = state.get(world).unwrap();
    let seen = collisions.get(floor, upper).expect("they touch");
    assert_eq!((seen.body, seen.other), (floor, upper));
    let points: Vec<CollisionPoint> = seen.points().collect();
    assert!(points.len() >= 4, "{points:?}");
    assert!(points.iter().all(|p| (p.normal - DVec3::Z).length() < 1e-4), "{points:?}");
    assert!(points.iter().all(|p| p.depth.abs() < 0.01 && (p.point.z - 0.5).abs() < 0.01));
    assert!(close(seen.impulse, G * STEP, 0.05), "{}", seen.impulse); // its weight, for a step
    let from_above = collisions.get(upper, floor).unwrap();
    assert!(from_above.points().all(|p| (p.normal + DVec3::Z).length() < 1e-4));
    assert_eq!(from_above.impulse, seen.impulse);
    assert!(collisions.are_touching(floor, upper) && collisions.are_touching(upper, floor));
    assert!(collisions.get(floor, aside).is_none() && !collisions.are_touching(upper, aside));
    let around: Vec<Entity> = collisions.entities_colliding_with(upper).collect();
    assert_eq!((around, collisions.iter().count()), (vec![floor], 1));
}

#[test]
fn a_trigger_alone_computes_no_contact() {
    let mut app = empty(&[Effect::TRIGGER]);
    world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0)));
    let passing =
        (RigidBody::Kinematic, unit(), up(2.0), LinearVelocity(Vec3::new(0.0, 0.0, -6.0)));
    let passing = world(&mut app).spawn(passing).id();
    let (start, _) = first_start(&mut app, passing, 60);
    assert_eq!(start.contact, None);
}

#[test]
fn contacts_without_a_solver_tell_the_speed_and_no_impulse() {
    let mut app = empty(&[Effect::TRIGGER, Effect::Contacts { margin: 0.0 }]);
    world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0)));
    let passing =
        (RigidBody::Kinematic, unit(), up(2.0), LinearVelocity(Vec3::new(0.0, 0.0, -6.0)));
    let passing = world(&mut app).spawn(passing).id();
    let contact = first_start(&mut app, passing, 60).0.contact.unwrap();
    assert!(close(contact.speed, 6.0, 1e-6) && contact.impulse == 0.0, "{contact:?}");
}

/// Contacts that are read within a margin hold none where a body comes from beyond it.
#[test]
fn a_start_has_its_contact_whoever_reads_contacts() {
    for margin in [0.0, 0.5] {
        let mut app = empty(&[Effect::Response, Effect::TRIGGER, Effect::Contacts { margin }]);
        let bouncy = Restitution::new(1.0);
        world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0), bouncy));
        let fast = LinearVelocity(Vec3::new(0.0, 0.0, -12.0));
        let ball = (RigidBody::Dynamic, unit(), up(4.03), bouncy, fast);
        let ball = world(&mut app).spawn(ball).id();
        let (start, speed) = first_start(&mut app, ball, 40);
        let contact = start.contact.expect("the solver knows it");
        assert!((contact.deepest.normal - DVec3::Z).length() < 1e-6, "{margin}: {contact:?}");
        assert!(close(contact.speed, speed, 1e-5) && contact.impulse > 0.0, "{contact:?}");
    }
}

/// An app with hooks.
fn hooked<H>(effects: &[Effect]) -> App
where
    H: SystemParam + 'static,
    for<'w, 's> bevy_ecs::system::SystemParamItem<'w, 's, H>: CollisionHooks,
{
    let mut app = App::new();
    let options = PluginOptions { length_unit: Some(1.0 / 3.0), ..PluginOptions::default() };
    let plugins = CrannyPlugins::new(STEP).unwrap().effects(effects).unwrap();
    app.add_plugins(plugins.options(&options).hooks::<H>());
    app
}

fn run_step(world: &mut World) {
    world.run_schedule(CrannyStep);
}

fn run(app: &mut App, steps: usize) {
    (0..steps).for_each(|_| run_step(app.world_mut()));
    assert!(!app.world().resource::<Failure>().is_set());
}

fn place(app: &App, body: Entity) -> Vec3 {
    app.world().get::<Transform>(body).unwrap().translation
}

#[derive(Component)]
struct Ghost;

#[derive(SystemParam)]
struct Ghosts<'w, 's>(Query<'w, 's, (), With<Ghost>>);

impl CollisionHooks for Ghosts<'_, '_> {
    fn filter_pairs(&self, body: Entity, other: Entity) -> bool {
        !self.0.contains(body) && !self.0.contains(other)
    }
}

#[test]
fn a_pair_that_is_filtered_passes_and_is_still_reported() {
    let mut app = hooked::<Ghosts>(&[Effect::Response, Effect::TRIGGER]);
    let world = app.world_mut();
    let floor = world.spawn((RigidBody::Fixed, cuboid([9.0, 9.0, 1.0]), up(0.0))).id();
    let ghost = world.spawn((RigidBody::Dynamic, unit(), up(1.1), Ghost)).id();
    let aside = Transform::from_xyz(3.0, 0.0, 1.1);
    let solid = world.spawn((RigidBody::Dynamic, unit(), aside)).id();
    run(&mut app, 30);
    assert!(place(&app, ghost).z < 0.5 && (place(&app, solid).z - 1.0).abs() < 0.01);
    let touching = app.world().get::<TouchingBodies>(ghost).unwrap();
    let id = app.world().get::<Body>(floor).unwrap().id;
    assert!(touching.ids().any(|known| known == id));
}

#[derive(Component)]
struct Belt(Vec3);

#[derive(SystemParam)]
struct Belts<'w, 's>(Query<'w, 's, &'static Belt>);

impl CollisionHooks for Belts<'_, '_> {
    fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
        if let Some((belt, _)) = contacts.one_of(&self.0) {
            contacts.drive(belt, self.0.get(belt).unwrap().0);
        }
        true
    }
}

/// Spawns two bodies. In even orders the first has the lower id, in orders 0 and 3 the lower number
/// in the solver.
fn in_order(app: &mut App, order: usize, first: impl Bundle, second: impl Bundle) -> [Entity; 2] {
    // Of numbers that bodies left, the lowest is given again first.
    let gone = [0, 1].map(|_| app.world_mut().spawn((RigidBody::Fixed, unit(), up(50.0))).id());
    run(app, 1);
    let world = app.world_mut();
    world.despawn(gone[usize::from(order > 1)]);
    let second_comes = |world: &mut World| {
        run_step(world);
        world.despawn(gone[usize::from(order < 2)]);
    };
    let pair = if order.is_multiple_of(2) {
        let first = world.spawn(first).id();
        second_comes(world);
        [first, world.spawn(second).id()]
    } else {
        let second = world.spawn(second).id();
        second_comes(world);
        [world.spawn(first).id(), second]
    };
    run_step(world);
    let ids = pair.map(|entity| world.get::<Body>(entity).unwrap().id);
    let numbers = ids.map(|id| world.resource::<RigidBodies>().index(id).unwrap());
    assert_eq!(ids[0] < ids[1], order.is_multiple_of(2), "{ids:?}");
    assert_eq!(numbers[0] < numbers[1], order == 0 || order == 3, "{numbers:?}");
    pair
}

#[test]
fn a_belt_carries_what_lies_on_it() {
    for order in 0..4 {
        let mut app = hooked::<Belts>(&[Effect::Response]);
        let belt = (RigidBody::Fixed, cuboid([40.0, 4.0, 1.0]), up(0.0));
        let belt = (belt, Belt(Vec3::new(2.0, 0.0, 0.0)));
        let load = (RigidBody::Dynamic, unit(), up(1.0), Friction::new(0.9));
        let [_, load] = in_order(&mut app, order, belt, load);
        run(&mut app, 90);
        let velocity = app.world().get::<LinearVelocity>(load).unwrap().0;
        assert!((velocity.x - 2.0).abs() < 0.05, "order {order}: {velocity}");
        assert!(velocity.y.abs() < 0.05 && place(&app, load).x > 1.5, "order {order}");
    }
}

#[derive(Component)]
struct OneWay;

#[derive(SystemParam)]
struct Platforms<'w, 's>(Query<'w, 's, (), With<OneWay>>);

impl CollisionHooks for Platforms<'_, '_> {
    fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
        contacts.one_of(&self.0).is_none_or(|(platform, _)| {
            contacts.normal_out_of(platform).z > 0.7 && contacts.separation() > -0.05
        })
    }
}

#[test]
fn a_platform_lets_pass_from_below_and_holds_from_above() {
    for order in 0..4 {
        let mut app = hooked::<Platforms>(&[Effect::Response]);
        let platform = (RigidBody::Fixed, cuboid([9.0, 9.0, 0.25]), up(0.0), OneWay);
        let jump = LinearVelocity(Vec3::new(0.0, 0.0, 9.0));
        let jumper = (RigidBody::Dynamic, unit(), up(-1.5), jump);
        let [_, jumper] = in_order(&mut app, order, platform, jumper);
        run(&mut app, 40);
        assert!(place(&app, jumper).z > 1.0, "order {order}: {}", place(&app, jumper));
        run(&mut app, 120);
        let height = place(&app, jumper).z;
        assert!((height - 0.625).abs() < 0.01, "order {order}: {height}");
    }
}

/// A bar turns about its middle, and meets a ball by its end.
#[test]
fn the_speed_of_a_contact_counts_turning() {
    let mut app = empty(&[Effect::TRIGGER, Effect::Contacts { margin: 0.0 }]);
    let turning = AngularVelocity(Vec3::new(0.0, 0.0, 2.0));
    let turning = (LinearVelocity(Vec3::ZERO), turning);
    let bar = (RigidBody::Kinematic, cuboid([4.0, 0.25, 0.25]), up(0.0), turning);
    let bar = world(&mut app).spawn(bar).id();
    let fixed = (RigidBody::Fixed, cuboid([0.25; 3]), Transform::from_xyz(1.5, 1.0, 0.0));
    world(&mut app).spawn(fixed);
    let contact = first_start(&mut app, bar, 60).0.contact.unwrap();
    let arm = contact.deepest.point; // from the bar's middle
    let by_hand = (2.0 * DVec3::Z).cross(arm).dot(contact.deepest.normal);
    assert!(by_hand > 2.0 && close(contact.speed, by_hand, 1e-6), "{contact:?} {by_hand}");
}

/// It comes so slowly that its contacts were searched before it touched, and carried on since.
#[test]
fn a_slow_landing_tells_its_contact() {
    let mut app = empty(&[Effect::Response, Effect::TRIGGER]);
    world(&mut app).insert_resource(Gravity(DVec3::ZERO));
    let floor = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let slow = LinearVelocity(Vec3::new(0.0, 0.0, -0.01));
    let body = world(&mut app).spawn((RigidBody::Dynamic, unit(), up(1.0003), slow)).id();
    let (start, speed) = first_start(&mut app, body, 30);
    let contact = start.contact.expect("the solver carries it on");
    assert!((contact.deepest.point.z - 0.5).abs() < 1e-3, "{contact:?}");
    assert!((contact.deepest.normal - DVec3::Z).length() < 1e-6 && start.body == floor);
    assert!(close(contact.speed, speed, 1e-5) && contact.impulse > 0.0, "{contact:?}");
}
