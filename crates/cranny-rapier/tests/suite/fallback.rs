//! Partners that parry has about y.

use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::shape::SharedShape;
use rapier3d::parry::utils::Array2;

use crate::world::{World, cuboid, ours, up};

/// y becomes z: parry's cylinders, cones and height fields are about y.
fn upright() -> Rotation {
    Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2 as Real)
}

#[test]
fn they_rest_on_ours() {
    for (name, shape, half) in [
        ("cylinder", SharedShape::cylinder(0.25, 0.4), 0.25),
        ("cone", SharedShape::cone(0.25, 0.4), 0.25),
        ("round cylinder", SharedShape::round_cylinder(0.2, 0.4, 0.05), 0.25),
    ] {
        let mut world = World::new();
        world.fixed(&ours(&cuboid(4.0, 4.0, 1.0)), Pose::IDENTITY);
        let start = Vector::new(0.0, 0.0, 0.5 + half + 0.05);
        let body = world.dynamic(&shape, Pose::from_parts(start, upright()));
        world.run(180);
        let at = world.at(body);
        assert!((at.z - (0.5 + half)).abs() < 2e-2, "{name}: {at}");
    }
}

#[test]
fn ours_rests_on_them() {
    let field = SharedShape::heightfield(Array2::repeat(9, 9, 0.5), Vector::new(4.0, 1.0, 4.0));
    for (name, shape, top) in
        [("height field", field, 0.5), ("cylinder", SharedShape::cylinder(0.5, 1.5), 0.5)]
    {
        let mut world = World::new();
        world.fixed(&shape, Pose::from_parts(Vector::ZERO, upright()));
        let body = world.dynamic(&ours(&cuboid(1.0, 1.0, 1.0)), up(top + 0.5 + 0.05));
        world.run(180);
        let at = world.at(body);
        assert!((at.z - (top + 0.5)).abs() < 2e-2, "{name}: {at}");
    }
}
