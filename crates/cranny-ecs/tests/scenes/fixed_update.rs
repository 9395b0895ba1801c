//! In an app with bevy's own main schedule and time.

use std::time::Duration;

use bevy_app::App;
use bevy_time::{Time, TimePlugin, TimeUpdateStrategy, Virtual};
use cranny_ecs::*;
use cranny_world::description::Effect;

use crate::build::gate;

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
