//! Which detector a simulation runs with: ours, or what rapier offers for the same mesh.

use std::fmt;
use std::panic::catch_unwind;
use std::str::FromStr;

use cranny_geometry::{Model, check_crease_angle};
use cranny_narrow_phase::Normals;
use cranny_primitives::BodyShape;
use rapier3d::math::Pose;
use rapier3d::parry::shape::{SharedShape, TriMeshFlags};
use thiserror::Error;

use crate::partners::placed;
use crate::shape::{MeshShape, ShapeError, buffers};

/// A way of detecting contacts in rapier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Detector {
    /// Cranny's exact pair query.
    #[default]
    Cranny,
    /// `TriMesh` with default flags.
    RapierTrimesh,
    /// `TriMesh` with `FIX_INTERNAL_EDGES | ORIENTED`.
    RapierTrimeshFixed,
    /// Convex decomposition at its defaults.
    RapierDecomposition,
}

/// A name that no detector has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "unknown detector '{0}': choose cranny, rapier-trimesh, rapier-trimesh-fixed or rapier-decomposition"
)]
pub struct UnknownDetector(pub String);

impl Detector {
    /// All of them, ours first.
    pub const ALL: [Self; 4] =
        [Self::Cranny, Self::RapierTrimesh, Self::RapierTrimeshFixed, Self::RapierDecomposition];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cranny => "cranny",
            Self::RapierTrimesh => "rapier-trimesh",
            Self::RapierTrimeshFixed => "rapier-trimesh-fixed",
            Self::RapierDecomposition => "rapier-decomposition",
        }
    }

    /// The shape of a model for this detector; `tag` is its number in the answer log.
    ///
    /// # Errors
    ///
    /// [`ShapeError::TriMesh`] where parry refuses the mesh, [`ShapeError::Decomposition`] where it
    /// fails to decompose it.
    pub fn shape(self, model: &Model, tag: u32) -> Result<SharedShape, ShapeError> {
        self.shape_with(model, Normals::Flat, tag)
    }

    /// The same with normals as they are wanted; only ours has other ones than flat.
    ///
    /// # Errors
    ///
    /// As [`shape`](Self::shape), and [`ShapeError::Crease`] where a crease angle is none.
    pub fn shape_with(
        self,
        model: &Model,
        normals: Normals,
        tag: u32,
    ) -> Result<SharedShape, ShapeError> {
        if let Normals::Smooth { crease_angle } = normals {
            check_crease_angle(crease_angle)?;
        }
        let (vertices, faces) = buffers(model);
        Ok(match self {
            Self::Cranny => SharedShape::new(MeshShape::new(model, tag)?.with_normals(normals)?),
            Self::RapierTrimesh => SharedShape::trimesh(vertices, faces)?,
            Self::RapierTrimeshFixed => SharedShape::trimesh_with_flags(
                vertices,
                faces,
                TriMeshFlags::FIX_INTERNAL_EDGES | TriMeshFlags::ORIENTED,
            )?,
            // Where a hull of its pieces fails, it panics; it holds nothing that could be left half
            // done.
            Self::RapierDecomposition => {
                catch_unwind(|| SharedShape::convex_decomposition(&vertices, &faces))
                    .map_err(|_| ShapeError::Decomposition)?
            }
        })
    }
}

impl Detector {
    /// The collider of a body: its shape, and where that stands in the body's frame. A primitive is
    /// rapier's own with any detector.
    pub(crate) fn collider(
        self,
        shape: &BodyShape,
        normals: Normals,
        tag: u32,
    ) -> Result<(SharedShape, Pose), ShapeError> {
        match (shape, normals) {
            (BodyShape::Model(model), _) => {
                Ok((self.shape_with(model, normals, tag)?, Pose::IDENTITY))
            }
            (BodyShape::Primitive(primitive), Normals::Flat) => {
                primitive.check()?;
                let (place, shape) = placed(primitive);
                Ok((shape, place))
            }
            (BodyShape::Primitive(primitive), Normals::Smooth { .. }) => {
                Err(ShapeError::SmoothPrimitive { what: primitive.name() })
            }
        }
    }
}

impl fmt::Display for Detector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Detector {
    type Err = UnknownDetector;

    fn from_str(name: &str) -> Result<Self, UnknownDetector> {
        Self::ALL
            .into_iter()
            .find(|d| d.name() == name)
            .ok_or_else(|| UnknownDetector(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for detector in Detector::ALL {
            assert_eq!(detector.to_string().parse(), Ok(detector));
        }
        assert!("bullet".parse::<Detector>().unwrap_err().to_string().contains("rapier-trimesh"));
    }
}
