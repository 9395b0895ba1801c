//! A platform that lets pass from below and holds from above, by a hook that leaves contacts out. A
//! ball is shot through it and comes to rest on it. z is up.
//!
//! `cargo run --example one_way_platform --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Sphere};

#[derive(Component)]
struct OneWay;

#[derive(SystemParam)]
struct Platforms<'w, 's> {
    platforms: Query<'w, 's, (), With<OneWay>>,
    moving: Query<'w, 's, &'static LinearVelocity>,
}

impl CollisionHooks for Platforms<'_, '_> {
    fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
        contacts.one_of(&self.platforms).is_none_or(|(platform, other)| {
            let rises = self.moving.get(other).is_ok_and(|velocity| velocity.0.z > 0.1);
            let on_top = contacts.normal_out_of(platform).z > 0.7;
            on_top && !rises && contacts.separation() > -0.05
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let platform = Collider::from_mesh(Cuboid { size: [4.0, 4.0, 0.2] }.build()?)?;
    let ball = Collider::from_mesh(Sphere { radius: 0.3, ..Sphere::default() }.build()?)?;

    let mut app = App::new();
    let cranny = CrannyPlugins::new(1.0 / 120.0)?.effects(&[Effect::Response, Effect::TRIGGER])?;
    app.add_plugins(cranny.hooks::<Platforms>());
    let world = app.world_mut();
    world.spawn((OneWay, platform));
    let start = (Transform::from_xyz(0.0, 0.0, -2.0), LinearVelocity(Vec3::new(0.0, 0.0, 8.0)));
    let ball = world.spawn((RigidBody::Dynamic, ball, Friction::new(0.8), start)).id();

    let mut highest = f32::MIN;
    for step in 0..=300 {
        let z = world.get::<Transform>(ball).ok_or("the ball is there")?.translation.z;
        highest = highest.max(z);
        if step % 50 == 0 {
            println!("{:.2} s: the ball is at z = {z:.2}", f64::from(step) / 120.0);
        }
        world.run_schedule(CrannyStep);
    }
    let z = world.get::<Transform>(ball).ok_or("the ball is there")?.translation.z;
    assert!(highest > 0.7 && (z - 0.4).abs() < 0.01, "it rests on the platform: {z}");
    Ok(())
}
