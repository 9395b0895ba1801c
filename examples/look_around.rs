//! A rover that looks around a room: rays, a shape that is pushed ahead, points and distances, of
//! meshes as they are. It finds the way through an arch, whose hull is closed. z is up.
//!
//! `cargo run --example look_around --features ecs`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_ecs::system::RunSystemOnce;
use bevy_math::{Dir3, Quat, Vec3};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Torus};

fn main() -> Result<(), Box<dyn Error>> {
    let wall = Collider::from_mesh(Cuboid { size: [1.0, 12.0, 3.0] }.build()?)?;
    let arch = Torus { major_radius: 2.0, minor_radius: 0.4, ..Torus::default() };
    let arch = Collider::from_mesh(arch.build()?)?;

    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(1.0 / 60.0)?); // no effect: nothing runs but queries
    let world = app.world_mut();
    world.spawn((Name::new("wall"), wall, Transform::from_xyz(10.0, 0.0, 1.5)));
    let upright = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let upright = Transform::from_xyz(4.0, 0.0, 0.0).with_rotation(upright);
    world.spawn((Name::new("arch"), arch, upright));
    world.run_schedule(CrannyStep); // takes the bodies in
    let looked: Result = world.run_system_once(look).map_err(|error| error.to_string())?;
    Ok(looked.map_err(|error| error.to_string())?)
}

fn look(spatial: SpatialQuery, names: Query<&Name>) -> Result {
    let all = SpatialQueryFilter::default();
    let eye = Vec3::new(0.0, 0.0, 0.8);
    for degrees in [0.0_f32, 29.0, 80.0] {
        let ahead = Dir3::new(Quat::from_rotation_z(degrees.to_radians()) * Vec3::X)?;
        match spatial.cast_ray(eye, ahead, 100.0, &all)? {
            Some(hit) => println!(
                "at {degrees} degrees: the {}, {:.2} away",
                names.get(hit.entity)?,
                hit.distance
            ),
            None => println!("at {degrees} degrees: nothing"),
        }
    }
    // May it drive straight on? A narrow rover passes below the arch, a wide one does not.
    let mut stops = Vec::new();
    for width in [1.0, 4.2] {
        let rover = Collider::from_mesh(Cuboid { size: [1.0, width, 0.6] }.build()?)?;
        let start = Transform::from_xyz(0.0, 0.0, 0.4);
        let hit = spatial.cast_shape(&rover, &start, Vec3::new(20.0, 0.0, 0.0), &all)?;
        let hit = hit.ok_or("the wall is there")?;
        println!(
            "a rover {width} wide drives {:.2} to the {}",
            hit.distance,
            names.get(hit.entity)?
        );
        stops.push(names.get(hit.entity)?.to_string());
    }
    assert_eq!(stops, ["wall", "arch"]);

    let nearest = spatial.project_point(eye, 100.0, &all)?.ok_or("the arch is near")?;
    println!(
        "nearest is the {}, {:.2} away at {:.2}",
        names.get(nearest.entity)?,
        nearest.distance,
        nearest.point
    );
    assert!(
        spatial.point_intersections(Vec3::new(4.0, 0.0, 0.8), &all).is_empty(),
        "below the arch"
    );
    Ok(())
}
