//! Masses of bodies that do not follow from a solid and its density.

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::{BuildOptions, MassProperties, Mesh, MeshError, Model, SurfaceProperties};
use cranny_primitives::{BodyShape, Primitive};
use cranny_world::description::StatedMass;

use super::body_syntax::MassFile;
use super::geometry::CollisionGeometry;
use super::values::HELD;

/// The mass of a dynamic body: as the file says, or, where it says nothing and the mesh bounds no
/// solid, that of its convex hull, with the reason. `None`: of the solid, at its density.
///
/// # Errors
///
/// A body that has no such mass, in words.
pub(super) fn of(
    geometry: &CollisionGeometry,
    said: Option<MassFile>,
    density: f64,
) -> Result<Option<(StatedMass, Option<String>)>, String> {
    if let Some(primitive) = geometry.primitive() {
        let of_surface = matches!(said, Some(MassFile::Shell { .. } | MassFile::Hull {}));
        if of_surface {
            return Err(format!(
                "a {} has a solid: say `mass: Total(…)` or `Stated(…)`, or leave `mass` out for its density",
                primitive.name()
            ));
        }
        let is_stated = matches!(said, Some(MassFile::Stated { .. }));
        let unbounded = matches!(primitive, Primitive::HalfSpace(_));
        if unbounded || !is_stated && solid(geometry)?.is_none() {
            return Err(format!("a {} has no mass. Make it Fixed or Kinematic", primitive.name()));
        }
    }
    let found = choose(geometry, said, density)?;
    let mass = match &found {
        Some((mass, _)) => mass.mass,
        None => solid(geometry)?.map_or(1.0, |solid| density * solid.volume),
    };
    match HELD.contains(&mass) {
        true => Ok(found),
        false => Err(format!(
            "its mass is {mass:.3e}, and solvers hold masses from {:e} to {:e}. Correct its size, `density` or `mass`",
            HELD.start(),
            HELD.end()
        )),
    }
}

/// As the file says, else of the hull where there is no solid.
fn choose(
    geometry: &CollisionGeometry,
    said: Option<MassFile>,
    density: f64,
) -> Result<Option<(StatedMass, Option<String>)>, String> {
    let known = |mass: StatedMass| Ok(Some((mass, None)));
    match said {
        Some(MassFile::Stated { mass, center, inertia, products }) => {
            known(stated(mass.0, center.map(|c| c.0), inertia.map(|m| m.0), products.map(|p| p.0))?)
        }
        Some(MassFile::Total(mass)) => known(total(geometry, mass.0)?),
        Some(MassFile::Shell { thickness }) => known(shell(geometry, thickness.0 * density)?),
        Some(MassFile::Hull {}) => known(hull(geometry, density)?),
        None if solid(geometry)?.is_some() => Ok(None),
        None => {
            let mass = hull(geometry, density)?;
            let lacks = match geometry.model() {
                Some(model) if model.is_closed() => "its mesh bounds no volume",
                _ => "its mesh is not closed",
            };
            let why = format!(
                "{lacks}, so it has no solid: its mass ({:.4}) is that of its convex hull. Say `mass: Total(…)`, `Shell(thickness: …)` or `Hull()`, or close the mesh",
                mass.mass
            );
            Ok(Some((mass, Some(why))))
        }
    }
}

fn model(geometry: &CollisionGeometry) -> Result<Model, String> {
    if let Some(model) = geometry.model() {
        return Ok(model.clone());
    }
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let built = Model::build(Mesh::clone(&geometry.mesh), &options);
    built.map(|(model, _)| model).map_err(|error| error.to_string())
}

/// The solid that the mesh bounds, if it bounds one. Generators make nothing else.
fn solid(geometry: &CollisionGeometry) -> Result<Option<MassProperties>, String> {
    Ok(match &geometry.shape {
        Some(BodyShape::Model(model)) => {
            model.mass_properties().filter(|solid| solid.volume > 0.0).copied()
        }
        Some(BodyShape::Primitive(primitive)) => primitive.mass_properties(),
        None => Some(MassProperties::of(&geometry.mesh)),
    })
}

fn total(geometry: &CollisionGeometry, mass: f64) -> Result<StatedMass, String> {
    match solid(geometry)? {
        Some(MassProperties { volume, center, inertia }) => {
            Ok(StatedMass { mass, center, inertia: inertia * (mass / volume) })
        }
        None => {
            let area = SurfaceProperties::of(&geometry.mesh).area;
            shell(geometry, mass / area)
        }
    }
}

/// Of a surface that weighs so much per area.
fn shell(geometry: &CollisionGeometry, weight: f64) -> Result<StatedMass, String> {
    let SurfaceProperties { area, center, inertia } = SurfaceProperties::of(&geometry.mesh);
    match area > 0.0 {
        true => Ok(StatedMass { mass: weight * area, center, inertia: inertia * weight }),
        false => Err("its mesh has no area, so no shell".to_owned()),
    }
}

fn hull(geometry: &CollisionGeometry, density: f64) -> Result<StatedMass, String> {
    let MassProperties { volume, center, inertia } =
        hull_solid(&model(geometry)?).map_err(|error| error.to_string())?;
    match volume > 0.0 {
        true => Ok(StatedMass { mass: density * volume, center, inertia: inertia * density }),
        false => Err(
            "its mesh is flat, so its convex hull has no volume. Say `mass: Shell(thickness: …)` or `Total(…)`"
                .to_owned(),
        ),
    }
}

fn hull_solid(model: &Model) -> Result<MassProperties, MeshError> {
    let hull = model.hull();
    let corners = |triangle| hull.triangle(triangle).map(|vertex| vertex.0);
    let faces = (0..hull.triangle_count()).map(corners).collect();
    Ok(MassProperties::of(&Mesh::new(hull.positions().to_vec(), faces)?))
}

fn stated(
    mass: f64,
    center: Option<DVec3>,
    moments: [f64; 3],
    products: Option<DVec3>,
) -> Result<StatedMass, String> {
    let [xx, yy, zz] = moments;
    let DVec3 { x: xy, y: yz, z: zx } = products.unwrap_or(DVec3::ZERO);
    let inertia =
        DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
    // The integral of x xᵀ over the body: no principal moment exceeds the sum of the others.
    let second = DMat3::from_diagonal(DVec3::splat(0.5 * (xx + yy + zz))) - inertia;
    // Sylvester: all leading minors above 0.
    let is_positive = xx * yy - xy * xy > 0.0 && inertia.determinant() > 0.0;
    if !(is_positive && is_semidefinite(&second)) {
        return Err(format!(
            "no body has the inertia {moments:?} with the products {:?}: its principal moments must be above 0, and none greater than the sum of the other two",
            [xy, yz, zx]
        ));
    }
    Ok(StatedMass { mass, center: center.unwrap_or(DVec3::ZERO), inertia })
}

/// Rounding of a minor, relative to the matrix. Smaller: flat bodies, whose greatest moment is the
/// sum of the others, are refused; larger: bodies that cannot be pass.
const MINOR_ROUNDING: f64 = 1e-9;

/// Whether a symmetric matrix has no eigenvalue below 0: all principal minors are at least 0.
fn is_semidefinite(m: &DMat3) -> bool {
    let [[a, d, e], [_, b, f], [_, _, c]] = m.to_cols_array_2d();
    let size = [a, b, c].map(f64::abs).into_iter().fold(0.0, f64::max);
    let at_least = |minor: f64, power: i32| minor >= -MINOR_ROUNDING * size.powi(power);
    [a, b, c].into_iter().all(|minor| at_least(minor, 1))
        && [a * b - d * d, a * c - e * e, b * c - f * f].into_iter().all(|minor| at_least(minor, 2))
        && at_least(m.determinant(), 3)
}
