//! In an app with bevy's own main schedule and time.

use std::sync::Mutex;
use std::time::Duration;

use bevy_app::{App, Update};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_world::description::Effect;

use crate::build::{gate, unit};

#[test]
fn steps_follow_the_fixed_time_step() {
    let scene = gate(&[Effect::TRIGGER]);
    let mut app = App::new();
    app.add_plugins(TimePlugin);
    app.add_plugins(CrannyPlugins::from_scene(&scene, &PluginOptions::default()).unwrap());
    app.add_plugins(FixedUpdatePlugin);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(250)));
    // bevy's first update lets no time pass.
    for _ in 0..4 {
        app.update();
    }
    let time = app.world().resource::<SimulatedTime>();
    assert_eq!((time.steps(), time.seconds()), (3, 0.75));
}

#[test]
fn a_paused_app_makes_no_step_but_those_that_it_makes_by_hand() {
    let mut app = App::new();
    app.add_plugins(TimePlugin);
    app.add_plugins(CrannyPlugins::new(0.25).unwrap()).add_plugins(FixedUpdatePlugin);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(250)));
    let steps = |app: &App| app.world().resource::<SimulatedTime>().steps();
    app.update();
    app.update();
    assert_eq!(steps(&app), 1);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    (0..5).for_each(|_| app.update());
    assert_eq!(steps(&app), 1);
    app.world_mut().run_schedule(CrannyStep);
    assert_eq!(steps(&app), 2);
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    app.update();
    assert_eq!(steps(&app), 3);
}

/// A body that cannot be, in an app that looks at no `Failure`: the next update fails with it. One
/// that a system has taken is nobody else's.
#[test]
fn a_failure_that_nobody_takes_is_an_error_of_the_next_update() {
    let update_fails = |takes: bool| {
        let mut app = App::new();
        app.add_plugins(TimePlugin);
        app.add_plugins(CrannyPlugins::new(0.25).unwrap()).add_plugins(FixedUpdatePlugin);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(250)));
        app.set_error_handler(|error, _| HANDED.lock().unwrap().push(error.to_string()));
        if takes {
            app.add_systems(Update, |mut failure: ResMut<Failure>| drop(failure.take()));
        }
        let large = Transform::from_scale(Vec3::splat(2.0));
        app.world_mut().spawn((RigidBody::Fixed, unit(), large, Name::new("giant")));
        (0..4).for_each(|_| app.update());
        std::mem::take(&mut *HANDED.lock().unwrap())
    };
    let handed = update_fails(false);
    assert!(handed.iter().any(|error| error.contains("'giant': its Transform")), "{handed:?}");
    assert_eq!(update_fails(true), Vec::<String>::new());
}

static HANDED: Mutex<Vec<String>> = Mutex::new(Vec::new());
