//! An effect of an app's own: whatever is hit too hard breaks. It is a plugin that reads what
//! `Trigger` reports, in a set of its own; bodies get it by a component. z is up.
//!
//! `cargo run --example custom_effect --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::{App, Plugin};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Cup};

/// The effect, for all pairs of a body: it breaks where a collision gives it a greater impulse.
#[derive(Component)]
#[require(Trigger)] // so that only collisions of such bodies are reported
struct Fragile {
    impulse: f64,
}

#[derive(Message)]
struct Broke(String, CollisionContact);
struct FragilePlugin;
impl Plugin for FragilePlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<Broke>();
        let reports = StepSystems::Report;
        app.add_systems(CrannyStep, break_up.in_set(reports).after(TriggerSystems::Report));
    }
}

fn break_up(
    mut starts: MessageReader<CollisionStart>,
    fragile: Query<(&Fragile, &Name)>,
    mut broke: MessageWriter<Broke>,
    mut commands: Commands,
) {
    for start in starts.read() {
        let Some(contact) = start.contact else { continue };
        for body in [start.body, start.other] {
            let of_body = fragile.get(body).ok();
            if let Some((_, name)) = of_body.filter(|(f, _)| contact.impulse > f.impulse) {
                broke.write(Broke(name.to_string(), contact));
                commands.entity(body).despawn();
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let cup = Collider::from_mesh(Cup::default().build()?)?;
    let floor = Collider::from_mesh(Cuboid { size: [20.0, 20.0, 1.0] }.build()?)?;
    let mut app = App::new();
    let cranny = CrannyPlugins::new(1.0 / 120.0)?.effects(&[Effect::Response])?;
    app.add_plugins((cranny.available(&[EffectKind::Trigger])?, FragilePlugin));
    let world = app.world_mut();
    world.spawn((floor, Transform::from_xyz(0.0, 0.0, -0.5)));
    for (name, x, z) in [("the cup set down", -2.0, 0.05), ("the cup that fell", 2.0, 4.0)] {
        let place = (Name::new(name), Transform::from_xyz(x, 0.0, z));
        world.spawn((place, RigidBody::Dynamic, Fragile { impulse: 2.0 }, cup.clone()));
    }
    let mut broken = vec![];
    for _ in 0..240 {
        world.run_schedule(CrannyStep);
        for Broke(name, hit) in world.resource_mut::<Messages<Broke>>().drain() {
            println!("{name} broke: impulse {:.1} at {:.1} of speed", hit.impulse, hit.speed);
            broken.push(name);
        }
    }
    assert_eq!(broken, ["the cup that fell"]);
    Ok(())
}
