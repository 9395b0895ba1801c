//! In an app with bevy's own main schedule and time.

use std::time::Duration;

use bevy_app::App;
use bevy_ecs::error::ErrorContext;
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
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

/// An app with a body that is refused.
fn with_a_scaled_body(plugins: CrannyPlugins) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins(TimePlugin).add_plugins(plugins).add_plugins(FixedUpdatePlugin);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(250)));
    let wide = Transform::from_scale(bevy_math::Vec3::splat(2.0));
    let wide = app.world_mut().spawn((Name::new("wide"), unit(), wide)).id();
    (app, wide)
}

#[test]
#[should_panic(expected = "body 'wide': its Transform has the scale")]
fn an_app_that_handles_no_failure_panics_with_its_message() {
    let (mut app, _) = with_a_scaled_body(CrannyPlugins::new(0.25).unwrap());
    (0..3).for_each(|_| app.update());
}

#[test]
#[should_panic(expected = "body 'wide': its Transform has the scale")]
fn so_does_one_that_makes_its_steps_by_hand() {
    let (mut app, _) = with_a_scaled_body(CrannyPlugins::new(0.25).unwrap());
    app.world_mut().run_schedule(CrannyStep);
}

fn tell(error: BevyError, context: ErrorContext) {
    let (mut told, name) = (TOLD.lock().unwrap(), context.name().to_string());
    told.push(format!("{name}: {error}"));
}

static TOLD: std::sync::Mutex<Vec<String>> = std::sync::Mutex::new(Vec::new());

/// bevy's error handler hears of a failure once; without a panic the steps wait for the app.
#[test]
fn a_failure_goes_to_the_error_handler_of_the_app_once() {
    let (mut app, wide) = with_a_scaled_body(CrannyPlugins::new(0.25).unwrap());
    app.set_error_handler(tell);
    let steps = |app: &App| app.world().resource::<SimulatedTime>().steps();
    (0..5).for_each(|_| app.update());
    assert_eq!(steps(&app), 1, "and waits");
    let told = std::mem::take(&mut *TOLD.lock().unwrap());
    assert!(told.len() == 1 && told[0].contains("'wide'"), "{told:?}");
    app.world_mut().entity_mut(wide).insert((Transform::IDENTITY, unit()));
    let taken = app.world_mut().resource_mut::<Failure>().take();
    assert!(matches!(taken, Some(SceneAppError::Scaled { .. })));
    (0..2).for_each(|_| app.update());
    assert_eq!(steps(&app), 3);
    assert!(TOLD.lock().unwrap().is_empty() && app.world().get::<Body>(wide).is_some());
}

#[test]
fn an_app_that_keeps_failures_finds_them_itself() {
    let (mut app, _) = with_a_scaled_body(CrannyPlugins::new(0.25).unwrap().keep_failures());
    (0..3).for_each(|_| app.update());
    let kept = app.world_mut().resource_mut::<Failure>().take().unwrap().to_string();
    assert!(kept.contains("'wide'"), "{kept}");
}
