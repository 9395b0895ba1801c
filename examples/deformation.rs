//! A hammer ball falls on a plate, which yields: the dent stays, its volume is the energy of the
//! hit over the plate's hardness, and a marble comes to rest in it. z is up.
//!
//! `cargo run --example deformation --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Floor, Sphere};

fn main() -> Result<(), Box<dyn Error>> {
    // Its triangles are smaller than the dent will be.
    let plate = Floor { size: [3.0, 3.0, 0.5], squares: [60, 60] }.build()?;
    let hammer = Sphere { radius: 0.3, ..Sphere::default() }.build()?;
    let marble = Sphere { radius: 0.1, ..Sphere::default() }.build()?;

    let mut app = App::new();
    let cranny = CrannyPlugins::new(1.0 / 240.0)?.effects(&[Effect::Response])?;
    app.add_plugins(cranny.available(&[EffectKind::Deformation])?);
    let world = app.world_mut();
    let yields = Deformation { hardness: 4000.0, radius: 0.5 };
    let plate = world.spawn((Collider::from_mesh(plate)?, yields)).id();
    let falls = (Transform::from_xyz(0.0, 0.0, 1.0), LinearVelocity(Vec3::new(0.0, 0.0, -8.0)));
    let hammer = (RigidBody::Dynamic, Collider::from_mesh(hammer)?, falls, Density(8.0));
    let hammer = world.spawn(hammer).id();

    let volume = |world: &World| {
        let plate = world.get::<Collider>(plate).ok_or("the plate is there")?;
        let mass = plate.model().and_then(|model| model.mass_properties());
        Ok::<f64, &str>(mass.ok_or("it is a solid")?.volume)
    };
    let before = volume(world)?;
    let mut lost = 0.0;
    for _ in 0..120 {
        world.run_schedule(CrannyStep);
        for dent in world.resource_mut::<Messages<Dented>>().drain() {
            println!("a dent {:.3} deep takes up {:.1} of energy", dent.depth, dent.energy);
            lost += dent.volume;
        }
    }
    let found = before - volume(world)?;
    println!("the plate has lost {found:.6} of volume");
    assert!(lost > 0.0 && (found / lost - 1.0).abs() < 1e-6, "{found} {lost}");

    world.despawn(hammer);
    let marble = (RigidBody::Dynamic, Collider::from_mesh(marble)?);
    let marble = world.spawn((marble, Transform::from_xyz(0.1, 0.0, 0.2))).id();
    for _ in 0..960 {
        world.run_schedule(CrannyStep);
    }
    let rest = world.get::<Transform>(marble).ok_or("the marble is there")?.translation;
    println!("a marble rests {:.3} below where the plate was flat", 0.1 - rest.z);
    assert!(rest.z < 0.095, "{rest}");
    Ok(())
}
