//! Masses of links: from their shape, in another frame, together.

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_shapes::Cuboid;
use cranny_world::description::StatedMass;

/// Edge of the cube that a frame without geometry weighs like, metres.
pub(super) const FRAME_SIZE: f64 = 0.05;

pub(super) fn box_of(mass: f64, edges: DVec3, center: DVec3) -> StatedMass {
    let s = edges * edges;
    let moments = DVec3::new(s.y + s.z, s.z + s.x, s.x + s.y) * (mass / 12.0);
    StatedMass { mass, center, inertia: DMat3::from_diagonal(moments) }
}

pub(super) fn cube_of(mass: f64, edge: f64, center: DVec3) -> StatedMass {
    box_of(mass, DVec3::splat(edge), center)
}

/// A cube about a link's centre of mass, which a link without geometry is drawn as.
pub(super) fn inertia_box(inertial: Option<&StatedMass>) -> Result<Mesh, String> {
    let size = inertial.map_or(FRAME_SIZE, |stated| {
        let mean =
            (stated.inertia.x_axis.x + stated.inertia.y_axis.y + stated.inertia.z_axis.z) / 3.0;
        (6.0 * mean / stated.mass).sqrt().clamp(0.1 * FRAME_SIZE, 20.0 * FRAME_SIZE)
    });
    let center = inertial.map_or(DVec3::ZERO, |stated| stated.center);
    let cube = Cuboid { size: [size; 3] }.build().map_err(|error| error.to_string())?;
    let vertices = cube.vertices().iter().map(|&p| p + center).collect();
    Mesh::new(vertices, cube.faces().to_vec()).map_err(|error| error.to_string())
}

/// The same mass in the frame of what carries it.
pub(super) fn moved(stated: &StatedMass, body_from_link: &Pose) -> StatedMass {
    let turn = DMat3::from_quat(body_from_link.rotation);
    StatedMass {
        mass: stated.mass,
        center: body_from_link.rotation * stated.center + body_from_link.translation,
        inertia: turn * stated.inertia * turn.transpose(),
    }
}

/// Several masses as one (Steiner).
pub(super) fn summed(parts: &[StatedMass]) -> Option<StatedMass> {
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    if let [part] = parts {
        return Some(*part);
    }
    let weighted: DVec3 = parts.iter().map(|part| part.center * part.mass).sum();
    let center = weighted / mass;
    let mut inertia = DMat3::ZERO;
    for part in parts {
        let arm = part.center - center;
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        let steiner = DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer;
        inertia += part.inertia + steiner * part.mass;
    }
    (mass > 0.0).then_some(StatedMass { mass, center, inertia })
}
