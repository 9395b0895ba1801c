//! Marbles and capsules that roll about in a bowl, a mesh, and stay in it; one marble rolls away on
//! the ground, a half-space. They are what they are: nothing is tessellated. z is up.
//!
//! `cargo run --example primitives --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::{App, Startup};
use bevy_ecs::message::Messages;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::exact::DVec3;
use cranny::shapes::Lathe;

const STEP: f64 = 1.0 / 240.0;

#[derive(Component)]
struct InBowl;

#[derive(Resource)]
struct Bowl(Collider);

fn main() -> Result<(), Box<dyn Error>> {
    let bowl = Collider::from_mesh(Lathe { segments: 96, ..Lathe::default() }.build()?)?;
    let options = PluginOptions { length_unit: Some(0.05), ..PluginOptions::default() };
    let effects = [Effect::Response, Effect::TRIGGER];
    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(STEP)?.options(&options).effects(&effects)?);
    app.insert_resource(Bowl(bowl)).add_systems(Startup, furnish);
    app.update();

    let mut touched = 0;
    let world = app.world_mut();
    for _ in 0..1200 {
        world.run_schedule(CrannyStep);
        touched += world.resource_mut::<Messages<CollisionStart>>().drain().count();
    }
    let mut inside = world.query_filtered::<&Transform, With<InBowl>>();
    let places: Vec<Vec3> = inside.iter(world).map(|place| place.translation).collect();
    let farthest = places.iter().map(|p| p.truncate().length()).fold(0.0, f32::max);
    println!("{} roll in the bowl, at most {farthest:.2} from its middle", places.len());
    println!("{touched} times two bodies came together");
    assert!(farthest < 0.46 && places.iter().all(|p| p.z > 0.06));
    Ok(())
}

fn furnish(bowl: Res<Bowl>, mut commands: Commands) {
    commands.spawn((RigidBody::Fixed, Collider::half_space(DVec3::Z)));
    commands.spawn((RigidBody::Fixed, bowl.0.clone()));
    let dropped = |x: f32, y: f32| (RigidBody::Dynamic, Transform::from_xyz(x, y, 0.5));
    for (x, y) in [(0.3, 0.0), (-0.2, 0.2), (0.0, -0.3)] {
        commands.spawn((dropped(x, y), Collider::ball(0.06), InBowl));
    }
    commands.spawn((dropped(-0.25, -0.1), Collider::capsule(0.04, 0.1), InBowl));
    commands.spawn((dropped(0.1, 0.25), Collider::cylinder(0.05, 0.06), InBowl));
    let rolls = LinearVelocity(Vec3::X);
    commands.spawn((dropped(1.0, 0.0), Collider::ball(0.06), rolls));
}
