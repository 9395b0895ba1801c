//! Mass properties against rapier's own shapes, which know theirs by formula.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use cranny_rapier::{BodyKind, MassError, MeshShape, Simulation, SimulationError, mass_properties};
use cranny_shapes::{LPrism, Sphere};
use rapier3d::math::{Real, Vector};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::parry::shape::{Ball, Cuboid, Shape};

use crate::world::{built, cuboid, model, sheet, spec};

fn agree(ours: &MassProperties, theirs: &MassProperties, relative: Real) {
    let near = |a: Real, b: Real, scale: Real| (a - b).abs() <= relative * scale;
    assert!(near(ours.mass(), theirs.mass(), theirs.mass()), "{} {}", ours.mass(), theirs.mass());
    let apart = (ours.local_com - theirs.local_com).length();
    assert!(apart <= 1e-5, "centres {} {}", ours.local_com, theirs.local_com);
    let (i, j) = (ours.reconstruct_inertia_matrix(), theirs.reconstruct_inertia_matrix());
    let scale = j.to_cols_array().into_iter().map(Real::abs).fold(0.0, Real::max);
    for (x, y) in i.to_cols_array().into_iter().zip(j.to_cols_array()) {
        assert!(near(x, y, scale), "{i}\n{j}");
    }
}

#[test]
fn a_cuboid_has_those_of_rapiers_cuboid() {
    let ours = MeshShape::new(&cuboid(1.0, 2.0, 0.5), 0).expect("a cuboid").mass_properties(3.0);
    agree(&ours, &Cuboid::new(Vector::new(0.5, 1.0, 0.25)).mass_properties(3.0), 1e-5);
}

#[test]
fn a_fine_sphere_has_nearly_those_of_rapiers_ball() {
    let sphere = Sphere { radius: 0.7, segments: 128, rings: 64 };
    let ours = MeshShape::new(&model(sphere), 0).expect("a sphere").mass_properties(2.0);
    // Inscribed: the volume lacks about (2π/128)²·5/12 of its share.
    agree(&ours, &Ball::new(0.7).mass_properties(2.0), 5e-3);
}

#[test]
fn an_l_has_those_of_its_two_boxes() {
    let l = LPrism { width: 1.0, height: 1.0, thickness: 0.25, depth: 0.5 };
    let ours = mass_properties(&model(l), 1.0).expect("closed");
    // The corner is the origin of the boxes; the centroid is that of the L.
    let part = |w: Real, h: Real, at: Vector| {
        let own = Cuboid::new(0.5 * Vector::new(w, h, 0.5)).mass_properties(1.0);
        own.transform_by(&rapier3d::math::Pose::from_translation(at))
    };
    let corner = -(0.25 * 0.5 + 0.1875 * 0.125) / 0.4375;
    let along = part(1.0, 0.25, Vector::new(corner + 0.5, corner + 0.125, 0.0));
    let upward = part(0.25, 0.75, Vector::new(corner + 0.125, corner + 0.625, 0.0));
    agree(&ours, &(along + upward), 1e-4);
}

#[test]
fn bodies_without_mass_are_refused_unless_they_need_none() {
    let mut simulation = Simulation::new(Default::default());
    let open = sheet(1.0);
    let refused = simulation.insert(&spec(&open, BodyKind::Dynamic, DVec3::ZERO));
    assert!(matches!(refused, Err(SimulationError::Mass(MassError::NotClosed))), "{refused:?}");
    assert!(simulation.is_empty());
    for kind in [BodyKind::Fixed, BodyKind::Kinematic] {
        assert!(simulation.insert(&spec(&open, kind, DVec3::ZERO)).is_ok());
    }
    let cube = cuboid(1.0, 1.0, 1.0);
    for density in [0.0, -1.0, f64::NAN, f64::INFINITY, 2.0 * f64::from(Real::MAX)] {
        let weightless = mass_properties(&cube, density);
        assert!(matches!(weightless, Err(MassError::NotPositive { .. })), "{weightless:?}");
    }
    // Filed inside out, a solid is turned around when it is prepared.
    let faces = cube.mesh().faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let inside_out = Mesh::new(cube.mesh().vertices().to_vec(), faces).expect("in range");
    assert_eq!(mass_properties(&built(inside_out), 1.0).expect("closed").mass(), 1.0);
    let mass = mass_properties(&cube, 2.5).expect("closed").mass();
    assert_eq!(mass, 2.5);
}
