//! In an app with bevy's own main schedule and time.

use std::time::Duration;

use bevy_app::App;
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use cranny_ecs::*;
use cranny_world::description::Effect;

use crate::build::gate;

#[test]
fn steps_follow_the_fixed_time_step() {
    let scene = gate(&[Effect::Trigger]);
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
