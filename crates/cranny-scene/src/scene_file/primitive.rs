//! Primitives as a scene file writes them: along z, about the body's origin.

use cranny_exact::DVec3;
use cranny_primitives::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive};
use serde::Deserialize;

use super::values::{Axis, NotNegative, Positive};

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Primitive")]
pub(super) enum PrimitiveFile {
    Ball {
        radius: Positive,
    },
    /// All within the radius of a segment of that length along z.
    Capsule {
        radius: Positive,
        length: Positive,
    },
    /// Along z.
    Cylinder {
        radius: Positive,
        height: Positive,
        #[serde(default)]
        border: Border,
    },
    /// Along z, its apex up and its middle height at the origin.
    Cone {
        radius: Positive,
        height: Positive,
        #[serde(default)]
        border: Border,
    },
    /// All beneath the plane through the origin.
    HalfSpace {
        #[serde(default = "up")]
        normal: Axis,
    },
}

/// A border radius around a sharp shape, which grows by it; 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub(super) struct Border(NotNegative);

impl Default for Border {
    fn default() -> Self {
        Self(NotNegative(0.0))
    }
}

fn up() -> Axis {
    Axis(DVec3::Z)
}

impl From<PrimitiveFile> for Primitive {
    fn from(file: PrimitiveFile) -> Self {
        let (center, axis) = (DVec3::ZERO, DVec3::Z);
        match file {
            PrimitiveFile::Ball { radius } => Ball { center, radius: radius.0 }.into(),
            PrimitiveFile::Capsule { radius, length } => {
                let end = 0.5 * length.0 * axis;
                Capsule { ends: [-end, end], radius: radius.0 }.into()
            }
            PrimitiveFile::Cylinder { radius, height, border } => {
                let (half_height, radius, border) = (0.5 * height.0, radius.0, border.0.0);
                Cylinder { center, axis, half_height, radius, border }.into()
            }
            PrimitiveFile::Cone { radius, height, border } => {
                let (half_height, radius, border) = (0.5 * height.0, radius.0, border.0.0);
                Cone { center, axis, half_height, radius, border }.into()
            }
            PrimitiveFile::HalfSpace { normal } => {
                HalfSpace { point: center, normal: normal.0 }.into()
            }
        }
    }
}
