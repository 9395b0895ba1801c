//! Which detector a simulation runs with: ours, or what rapier offers for the same mesh or for a
//! coarser solid around it.

use std::fmt;
use std::panic::catch_unwind;
use std::str::FromStr;

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{Content, Model, check_crease_angle};
use cranny_narrow_phase::Normals;
use cranny_primitives::BodyShape;
use rapier3d::math::Pose;
use rapier3d::parry::shape::{SharedShape, TriMeshFlags};
use thiserror::Error;

use crate::convert::narrow;
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
    /// The box of each mesh, along the axes of its body's frame.
    RapierBoxes,
    /// The convex hull of each mesh.
    RapierHulls,
    /// The boxes of each mesh's tree, opened [`TREE_DEPTH`] times.
    RapierTree,
}

/// A name that no detector has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "unknown detector '{0}': choose cranny, rapier-trimesh, rapier-trimesh-fixed, \
     rapier-decomposition, rapier-boxes, rapier-hulls or rapier-tree"
)]
pub struct UnknownDetector(pub String);

/// How often the trees of [`Detector::RapierTree`] are opened. Deeper: more boxes a body, which
/// meet each other one by one; less deep: hollows fill up.
pub const TREE_DEPTH: u32 = 6;

/// The least thickness of a box of a solid, as a share of its mesh's diagonal. Thinner: single
/// precision knows no inside; thicker: a plate is visibly thicker than its mesh.
const THINNEST: f64 = 1e-4;

impl Detector {
    /// Those that take each mesh as it is, ours first.
    pub const ALL: [Self; 4] =
        [Self::Cranny, Self::RapierTrimesh, Self::RapierTrimeshFixed, Self::RapierDecomposition];

    /// Those that take a coarser solid for each mesh, which holds it: what a level of accuracy
    /// knows of it. The coarsest first.
    pub const LEVELS: [Self; 3] = [Self::RapierBoxes, Self::RapierHulls, Self::RapierTree];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cranny => "cranny",
            Self::RapierTrimesh => "rapier-trimesh",
            Self::RapierTrimeshFixed => "rapier-trimesh-fixed",
            Self::RapierDecomposition => "rapier-decomposition",
            Self::RapierBoxes => "rapier-boxes",
            Self::RapierHulls => "rapier-hulls",
            Self::RapierTree => "rapier-tree",
        }
    }

    /// The shape of a model for this detector; `tag` is its number in the answer log.
    ///
    /// # Errors
    ///
    /// [`ShapeError::TriMesh`] where parry refuses the mesh, [`ShapeError::Decomposition`] where it
    /// fails to decompose it, [`ShapeError::Hull`] where it finds no hull.
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
            Self::RapierBoxes => SharedShape::compound(vec![solid(model, model.bounds())]),
            Self::RapierHulls => SharedShape::convex_hull(&vertices).ok_or(ShapeError::Hull)?,
            Self::RapierTree => SharedShape::compound(boxes_of(model)),
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

/// The boxes of a mesh's tree, opened so often.
fn boxes_of(model: &Model) -> Vec<(Pose, SharedShape)> {
    let tree = model.tree();
    let mut nodes = vec![0];
    for _ in 0..TREE_DEPTH {
        let open = |node: u32| match tree.content(node) {
            Content::Inner { left, right } => vec![left, right],
            Content::Leaf { .. } => vec![node],
        };
        nodes = nodes.into_iter().flat_map(open).collect();
    }
    nodes.into_iter().map(|node| solid(model, tree.node(node).bounds)).collect()
}

/// A box of a mesh that is thin nowhere, and where it stands.
fn solid(model: &Model, bounds: Aabb) -> (Pose, SharedShape) {
    let least = DVec3::splat(0.5 * THINNEST * model.bounds().diagonal());
    let half = narrow(bounds.half_extents().max(least));
    let place = Pose::from_translation(narrow(bounds.center()));
    (place, SharedShape::cuboid(half.x, half.y, half.z))
}

impl fmt::Display for Detector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Detector {
    type Err = UnknownDetector;

    fn from_str(name: &str) -> Result<Self, UnknownDetector> {
        let all = Self::ALL.into_iter().chain(Self::LEVELS);
        all.into_iter().find(|d| d.name() == name).ok_or_else(|| UnknownDetector(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::BuildOptions;
    use cranny_shapes::{Cuboid, Cup, Shape, Torus};
    use rapier3d::math::Real;

    /// What a level knows of a body holds the body, also of a plate that is thinner than a box is
    /// made.
    #[test]
    fn a_coarser_solid_holds_the_mesh() {
        let plate = Cuboid { size: [2.0, 3.0, 1e-6] };
        for shape in [Shape::from(Torus::default()), Cup::default().into(), plate.into()] {
            let (model, _) =
                Model::build(shape.build().unwrap(), &BuildOptions::default()).unwrap();
            let slack = 1e-5 * model.bounds().diagonal() as Real;
            for level in Detector::LEVELS {
                let solid = level.shape(&model, 0).unwrap();
                for &vertex in model.mesh().vertices() {
                    let away = solid.distance_to_local_point(narrow(vertex), true);
                    assert!(away <= slack, "{level}: {away}");
                }
                let around = solid.compute_local_aabb();
                let grown =
                    (around.extents() - narrow(2.0 * model.bounds().half_extents())).max_element();
                assert!(grown <= 1e-3 * model.bounds().diagonal() as Real, "{level}: {grown}");
            }
        }
    }

    /// The hole of a ring is open to its tree's boxes and closed to its hull.
    #[test]
    fn a_hull_closes_what_a_tree_leaves_open() {
        let ring = Torus::default().build().unwrap();
        let (ring, _) = Model::build(ring, &BuildOptions::default()).unwrap();
        let holds = |level: Detector| {
            level.shape(&ring, 0).unwrap().contains_local_point(narrow(DVec3::ZERO))
        };
        assert_eq!(Detector::LEVELS.map(holds), [true, true, false]);
    }

    #[test]
    fn names_are_read_back() {
        for detector in Detector::ALL.into_iter().chain(Detector::LEVELS) {
            assert_eq!(detector.to_string().parse(), Ok(detector));
        }
        assert!("bullet".parse::<Detector>().unwrap_err().to_string().contains("rapier-trimesh"));
    }
}
