//! Primitives as meshes, to be drawn.

use cranny_exact::{DQuat, DVec2, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_primitives::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive, Segment};

use crate::builder::{direction, directions};
use crate::error::{Checked, ShapeError};
use crate::lathe::{Profile, lathe};

/// Sides of what is round. Fewer: one sees the corners; more: triangles that nobody sees.
const SIDES: u32 = 48;

/// Rings of a quarter of a circle.
const QUARTER: u32 = 12;

/// Half the side of the square that stands for a half-space, in units of length. Smaller: bodies
/// roll off it in the picture; larger: what it cuts is far away.
const HALF_SIDE: f64 = 100.0;

/// How thick the square of a half-space is drawn, as a share of its side. It is a body of its own
/// in a picture, below the plane.
const SLAB: f64 = 0.005;

/// A radius at which a segment is drawn, as a share of its length.
const WIRE: f64 = 0.005;

/// A mesh that stands for a primitive in pictures and recordings, in the primitive's frame. What is
/// round is inscribed, of 48 sides; a half-space is a square of 200 units about its point; borders
/// are left out of cones, and added to the lengths of cylinders. Nothing is computed of it.
///
/// # Errors
///
/// [`ShapeError`] where a number of the primitive is invalid.
pub fn primitive_mesh(primitive: &Primitive) -> Result<Mesh, ShapeError> {
    let checked = Checked { shape: "Primitive" };
    match *primitive {
        Primitive::Ball(Ball { center, radius }) => {
            checked.length("radius", radius)?;
            placed(&rounded(radius, 0.0), DVec3::Z, center)
        }
        Primitive::Capsule(Capsule { ends: [a, b], radius }) => {
            checked.length("radius", radius)?;
            placed(&rounded(radius, 0.5 * a.distance(b)), b - a, 0.5 * (a + b))
        }
        Primitive::Segment(Segment { ends: [a, b] }) => {
            let half = 0.5 * a.distance(b);
            checked.length("length", half)?;
            placed(&rounded(WIRE * half, half), b - a, 0.5 * (a + b))
        }
        Primitive::Cylinder(Cylinder { center, axis, half_height, radius, border }) => {
            let (h, r) = (half_height + border, radius + border);
            checked.length("half_height", h)?;
            checked.length("radius", r)?;
            placed(&[[0.0, -h], [r, -h], [r, h], [0.0, h]], axis, center)
        }
        Primitive::Cone(Cone { center, axis, half_height: h, radius: r, .. }) => {
            checked.length("half_height", h)?;
            checked.length("radius", r)?;
            placed(&[[0.0, -h], [r, -h], [0.0, h]], axis, center)
        }
        Primitive::HalfSpace(HalfSpace { point, normal }) => square(point, normal),
    }
}

/// The profile of all within a radius of a segment of half a length.
fn rounded(radius: f64, half: f64) -> Vec<[f64; 2]> {
    let around = |k| radius * direction(k, 4 * QUARTER);
    let lower = (0..=QUARTER).map(|k| [around(k).y, -half - around(k).x]);
    let upper = (0..=QUARTER).rev().map(|k| [around(k).y, half + around(k).x]);
    let skipped = usize::from(half == 0.0);
    lower.chain(upper.skip(skipped)).collect()
}

/// Turned about z, then about its axis, and moved.
fn placed(profile: &[[f64; 2]], axis: DVec3, center: DVec3) -> Result<Mesh, ShapeError> {
    let profile: Vec<DVec2> = profile.iter().map(|&p| DVec2::from_array(p)).collect();
    let mesh = lathe("Primitive", &directions(SIDES), &profile, Profile::Open)?;
    moved(&mesh, axis, center)
}

/// A flat slab beneath the plane.
fn square(point: DVec3, normal: DVec3) -> Result<Mesh, ShapeError> {
    let side = 2.0 * HALF_SIDE;
    let slab = crate::Cuboid { size: [side, side, SLAB * side] }.build()?;
    let down = 0.5 * SLAB * side * normal.normalize_or(DVec3::Z);
    moved(&slab, normal, point - down)
}

fn moved(mesh: &Mesh, axis: DVec3, center: DVec3) -> Result<Mesh, ShapeError> {
    let rotation = DQuat::from_rotation_arc(DVec3::Z, axis.normalize_or(DVec3::Z));
    let map = Pose { rotation, translation: center }.world_from_body();
    let vertices = mesh.vertices().iter().map(|&p| map.apply(p)).collect();
    let moved = Mesh::new(vertices, mesh.faces().to_vec());
    moved.map_err(|source| ShapeError::Mesh { shape: "Primitive", source })
}

#[cfg(test)]
mod tests {
    use cranny_geometry::MassProperties;

    use super::*;

    #[test]
    fn meshes_of_primitives_are_nearly_as_large_and_stand_where_they_do() {
        let at = DVec3::new(1.0, 2.0, 3.0);
        let cases: [Primitive; 4] = [
            Ball { center: at, radius: 0.5 }.into(),
            Capsule { ends: [at, at + DVec3::X], radius: 0.25 }.into(),
            Cylinder { center: at, axis: DVec3::Y, half_height: 1.0, radius: 0.5, border: 0.0 }
                .into(),
            Cone { center: at, axis: -DVec3::X, half_height: 1.0, radius: 0.5, border: 0.0 }.into(),
        ];
        for primitive in cases {
            let mesh = primitive_mesh(&primitive).unwrap();
            let (drawn, real) = (mesh.bounds(), primitive.bounds());
            assert!((drawn.min - real.min).abs().max_element() < 2e-2, "{primitive:?}");
            assert!((drawn.max - real.max).abs().max_element() < 2e-2, "{primitive:?}");
            let mass = MassProperties::of(&mesh);
            assert!(mass.volume > 0.0 && (mass.center - primitive.center()).length() < 1e-9);
        }
    }

    #[test]
    fn a_half_space_is_a_slab_beneath_its_plane() {
        let plane = HalfSpace { point: DVec3::Z, normal: DVec3::Z };
        let bounds = primitive_mesh(&plane.into()).unwrap().bounds();
        assert!((bounds.max.z - 1.0).abs() < 1e-12 && bounds.min.z < 1.0);
        assert!(bounds.max.x >= HALF_SIDE);
    }

    #[test]
    fn what_has_no_size_is_refused() {
        for radius in [0.0, -1.0, f64::NAN] {
            let ball = Ball { center: DVec3::ZERO, radius };
            assert!(primitive_mesh(&ball.into()).is_err());
        }
    }
}
