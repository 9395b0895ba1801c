//! A belt that carries what lies on it, by a hook that changes contacts before they are solved: the
//! belt itself stands still. A crate rides off its end onto the floor. z is up.
//!
//! `cargo run --example conveyor --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::Cuboid;

/// How the surface of a body moves, world axes.
#[derive(Component)]
struct Belt(Vec3);

/// Reads components as a system does.
#[derive(SystemParam)]
struct Belts<'w, 's> {
    belts: Query<'w, 's, &'static Belt>,
}

impl CollisionHooks for Belts<'_, '_> {
    fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
        if let Some((belt, _)) = contacts.one_of(&self.belts)
            && let Ok(Belt(surface)) = self.belts.get(belt)
        {
            contacts.drive(belt, *surface);
        }
        true // the contacts are kept
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let cuboid = |size| Ok::<_, Box<dyn Error>>(Collider::from_mesh(Cuboid { size }.build()?)?);

    let mut app = App::new();
    let cranny = CrannyPlugins::new(1.0 / 120.0)?.effects(&[Effect::Response])?;
    app.add_plugins(cranny.hooks::<Belts>());
    let world = app.world_mut();
    world.spawn((cuboid([20.0, 20.0, 1.0])?, Transform::from_xyz(0.0, 0.0, -0.5)));
    let belt = (cuboid([4.0, 1.0, 0.2])?, Transform::from_xyz(0.0, 0.0, 1.0));
    world.spawn((belt, Belt(Vec3::new(1.5, 0.0, 0.0))));
    let start = Transform::from_xyz(-1.5, 0.0, 1.36);
    let load = world.spawn((RigidBody::Dynamic, cuboid([0.5; 3])?, start)).id();

    for step in 0..=480 {
        let at = world.get::<Transform>(load).ok_or("the crate is there")?.translation;
        if step % 80 == 0 {
            println!(
                "{:.1} s: the crate is at x = {:.2}, z = {:.2}",
                f64::from(step) / 120.0,
                at.x,
                at.z
            );
        }
        world.run_schedule(CrannyStep); // an app without a clock makes its steps itself
    }
    let at = world.get::<Transform>(load).ok_or("the crate is there")?.translation;
    assert!(at.x > 2.0 && (at.z - 0.25).abs() < 0.02, "it lies beyond the belt: {at}");
    Ok(())
}
