//! What is heard: one event an onset.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_shapes::Sphere;
use cranny_world::description::Effect;

use crate::build::{cuboid, empty, messages, steps, up, world};

const HEARD: [Effect; 2] = [Effect::Response, Effect::Sound { above: 0.3 }];

fn ball() -> Collider {
    let sphere = Sphere { radius: 0.5, ..Sphere::default() };
    Collider::from_mesh(sphere.build().unwrap()).unwrap()
}

fn floor(app: &mut SceneApp) -> Entity {
    let slab = cuboid([60.0, 8.0, 1.0]);
    world(app).spawn((RigidBody::Fixed, slab, up(-0.5), Friction::new(0.6))).id()
}

/// All that is heard in so many steps, and after each what goes on.
fn listen(app: &mut SceneApp, count: usize) -> (Vec<SoundEvent>, Vec<Option<SoundKind>>) {
    let (mut events, mut going) = (Vec::new(), Vec::new());
    for _ in 0..count {
        steps(app, 1);
        events.extend(messages::<SoundEvent>(app));
        let sounds = &app.app().world().resource::<OngoingSounds>().sounds;
        going.push(sounds.first().map(|sound| sound.kind));
    }
    (events, going)
}

/// It lands without spin at 4 along the floor: it slides until friction has made it roll, at 5/7 of
/// that.
#[test]
fn a_ball_that_lands_slides_and_rolls_is_heard_three_times() {
    let mut app = empty(&HEARD);
    let floor = floor(&mut app);
    let thrown = LinearVelocity(Vec3::new(4.0, 0.0, 0.0));
    let smooth = SmoothNormals { crease_angle: 1.0 };
    let at = Transform::from_xyz(-20.0, 0.0, 0.7);
    let spawned = (RigidBody::Dynamic, ball(), at, thrown, Friction::new(0.6), smooth);
    let ball = world(&mut app).spawn(spawned).id();
    let (events, going) = listen(&mut app, 200);
    let kinds: Vec<SoundKind> = events.iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [SoundKind::Impact, SoundKind::Slide, SoundKind::Roll], "{events:#?}");
    let [impact, slide, roll] = events[..] else { panic!() };
    assert_eq!((impact.body, impact.other), (floor, ball));
    // It falls by 0.2 at 10 a second².
    assert!((impact.speed - 2.0).abs() < 0.2, "{impact:?}");
    let mass = std::f64::consts::PI / 6.0;
    assert!((impact.impulse / (mass * impact.speed) - 1.0).abs() < 0.2, "{impact:?}");
    assert!((impact.at.normal - DVec3::Z).length() < 0.1 && impact.at.point.z.abs() < 0.1);
    assert!((slide.speed - 4.0).abs() < 0.1 && slide.area < 0.05, "{slide:?}");
    assert!((roll.speed - 4.0 * 5.0 / 7.0).abs() < 0.4, "{roll:?}");
    assert_eq!(going.last(), Some(&Some(SoundKind::Roll)), "it rolls on");
}

#[test]
fn a_box_that_slides_is_heard_once_with_its_area_and_falls_silent() {
    let mut app = empty(&HEARD);
    floor(&mut app);
    let pushed = LinearVelocity(Vec3::new(3.0, 0.0, 0.0));
    let slab = (RigidBody::Dynamic, cuboid([2.0, 1.0, 0.5]), up(0.25), pushed);
    world(&mut app).spawn((slab, Friction::new(0.6)));
    let (events, going) = listen(&mut app, 120);
    let kinds: Vec<SoundKind> = events.iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [SoundKind::Slide], "{events:#?}");
    assert!((events[0].area - 2.0).abs() < 0.05 && events[0].speed > 2.5, "{:?}", events[0]);
    assert_eq!(going.last(), Some(&None), "it has come to rest");
}

#[test]
fn what_is_laid_down_or_slower_than_is_heard_makes_no_sound() {
    let mut app = empty(&HEARD);
    floor(&mut app);
    let slow = LinearVelocity(Vec3::new(0.2, 0.0, 0.0));
    world(&mut app).spawn((RigidBody::Dynamic, cuboid([1.0; 3]), up(0.5), slow));
    let (events, _) = listen(&mut app, 60);
    assert_eq!(events, []);
    // A pair that asks for it itself is heard from then on.
    let turned = Transform { rotation: Quat::from_rotation_y(0.6), ..up(3.0) };
    world(&mut app).spawn((RigidBody::Dynamic, cuboid([1.0; 3]), turned));
    let (events, _) = listen(&mut app, 60);
    assert!(events.iter().any(|event| event.kind == SoundKind::Impact), "{events:?}");
}

/// Bounces are impacts, one each.
#[test]
fn each_bounce_is_one_impact() {
    let mut app = empty(&HEARD);
    let bouncy = Restitution::new(0.8);
    let slab = cuboid([20.0, 8.0, 1.0]);
    world(&mut app).spawn((RigidBody::Fixed, slab, up(-0.5), bouncy));
    let ball = world(&mut app).spawn((RigidBody::Dynamic, ball(), up(3.0), bouncy)).id();
    let (mut bounces, mut impacts, mut falls) = (0, 0, false);
    for _ in 0..200 {
        let before = world(&mut app).get::<LinearVelocity>(ball).map_or(0.0, |v| v.0.z);
        steps(&mut app, 1);
        let after = world(&mut app).get::<LinearVelocity>(ball).unwrap().0.z;
        falls |= before < -1.0;
        bounces += usize::from(falls && before < -1.0 && after > 0.0);
        let heard = messages::<SoundEvent>(&app);
        impacts += heard.iter().filter(|e| e.kind == SoundKind::Impact && e.speed > 1.0).count();
    }
    assert!(bounces >= 2);
    assert_eq!(impacts, bounces);
}
