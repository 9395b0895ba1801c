//! Meshes that are open, inside out or cross themselves.

use bevy_ecs::prelude::*;
use cranny_ecs::*;
use cranny_exact::{DMat3, DVec3};
use cranny_geometry::Mesh;
use cranny_shapes::Cuboid;
use cranny_world::description::{Effect, StatedMass};

use crate::build::{empty, height, unit, up, world};

/// Meshes that somebody made by hand: each is right, or an error that says what to do.
#[test]
fn meshes_that_are_open_or_inside_out_are_right_or_refused() {
    let cube = || Cuboid { size: [1.0; 3] }.build().unwrap();
    let mesh = |faces: Vec<[u32; 3]>| Mesh::new(cube().vertices().to_vec(), faces).unwrap();
    let turned = |face: &[u32; 3]| [face[1], face[0], face[2]];
    let falls = |mesh: Mesh, more: fn(&mut EntityWorldMut<'_>)| {
        let mut app = empty(&[Effect::Response]);
        world(&mut app).spawn((unit(), up(0.0)));
        let body = (RigidBody::Dynamic, Collider::from_mesh(mesh).unwrap(), up(1.2));
        let mut body = world(&mut app).spawn(body);
        more(&mut body);
        let body = body.id();
        for _ in 0..64 {
            app.step()?;
        }
        Ok::<f32, SceneAppError>(height(&app, body))
    };
    let rests = |mesh: Mesh| (falls(mesh, |_| {}).unwrap() - 1.0).abs() < 0.02;
    let faces = cube().faces().to_vec();
    assert!(rests(mesh(faces.iter().map(turned).collect())), "inside out");
    let mut one = faces.clone();
    one[3] = turned(&one[3]);
    assert!(rests(mesh(one)), "one face is the wrong way round");
    // Beside a cube, one that is inside out.
    let aside = cube().vertices().iter().map(|&v| v + DVec3::X * 2.0).collect::<Vec<_>>();
    let both = [cube().vertices().to_vec(), aside].concat();
    let inverted = faces.iter().map(|f| turned(f).map(|v| v + 8));
    let two = Mesh::new(both.clone(), faces.iter().copied().chain(inverted).collect()).unwrap();
    let collider = Collider::from_mesh(two).unwrap();
    let volume = collider.model().unwrap().mass_properties().unwrap().volume;
    assert!((volume - 2.0).abs() < 1e-12, "{volume}");
    // Without inside: a mass has to be stated.
    let open = || mesh(faces[1..].to_vec());
    let said = falls(open(), |_| {}).unwrap_err().to_string();
    assert!(said.contains("the mesh is not closed") && said.contains("state the mass"), "{said}");
    let stated = falls(open(), |body| {
        let inertia = DMat3::from_diagonal(DVec3::splat(1.0 / 6.0));
        body.insert(Mass(StatedMass { mass: 1.0, center: DVec3::ZERO, inertia }));
    });
    assert!((stated.unwrap() - 1.0).abs() < 0.02);
    // Two cubes of which one is half in the other: the overlap weighs twice.
    let across = cube().vertices().iter().map(|&v| v + DVec3::X * 0.5).collect::<Vec<_>>();
    let both = [cube().vertices().to_vec(), across].concat();
    let crossing = faces.iter().copied().chain(faces.iter().map(|f| f.map(|v| v + 8)));
    let crossing = Mesh::new(both, crossing.collect()).unwrap();
    let collider = Collider::from_mesh(crossing.clone()).unwrap();
    let volume = collider.model().unwrap().mass_properties().unwrap().volume;
    assert!((volume - 2.0).abs() < 1e-12 && rests(crossing), "{volume}");
}
