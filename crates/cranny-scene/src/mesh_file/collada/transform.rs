//! Transform elements of COLLADA nodes.

use cranny_exact::{DMat3, DVec3};
use roxmltree::Node;

use super::{NUMBER, malformed, numbers};
use crate::mesh_file::affine::Affine;
use crate::mesh_file::problem::{DecodeError, excerpt};

/// The map of a transform element; `None` for other elements.
pub(super) fn read(node: Node<'_, '_>) -> Result<Option<Affine>, DecodeError> {
    Ok(Some(match node.tag_name().name() {
        "matrix" => matrix(node)?,
        "translate" => {
            let [x, y, z] = exactly(node)?;
            Affine { linear: DMat3::IDENTITY, translation: DVec3::new(x, y, z) }
        }
        "scale" => {
            let [x, y, z] = exactly(node)?;
            Affine::scale(DVec3::new(x, y, z))
        }
        "rotate" => {
            let [x, y, z, degrees] = exactly(node)?;
            let axis = DVec3::new(x, y, z);
            let Some(axis) = axis.try_normalize() else {
                return Err(malformed(
                    node,
                    format!("the axis ({x}, {y}, {z})"),
                    "an axis with a length",
                ));
            };
            let linear = DMat3::from_axis_angle(axis, degrees.to_radians());
            Affine { linear, translation: DVec3::ZERO }
        }
        name @ ("lookat" | "skew") => {
            return Err(malformed(
                node,
                excerpt(name),
                "'matrix', 'translate', 'rotate' or 'scale'",
            ));
        }
        _ => return Ok(None),
    }))
}

/// Sixteen numbers, row-major, of an affine map.
pub(super) fn matrix(node: Node<'_, '_>) -> Result<Affine, DecodeError> {
    let m: [f64; 16] = exactly(node)?;
    Ok(Affine {
        linear: DMat3::from_cols(
            DVec3::new(m[0], m[4], m[8]),
            DVec3::new(m[1], m[5], m[9]),
            DVec3::new(m[2], m[6], m[10]),
        ),
        translation: DVec3::new(m[3], m[7], m[11]),
    })
}

fn exactly<const N: usize>(node: Node<'_, '_>) -> Result<[f64; N], DecodeError> {
    let found = numbers(node, NUMBER)?;
    let count = found.len();
    found
        .try_into()
        .map_err(|_| malformed(node, format!("{count} numbers"), &format!("{N} numbers")))
}
