//! Deformation: vertices of a prepared model are moved, and what depends on them follows.
//!
//! What follows, in the order of [`Model::build`]: boxes of trees are fitted again, patches with a
//! moved face are measured, and divided where they have become too bent. If no vertex of the hull has
//! moved and none has left it, by exact signs, the hull stays, and only moved faces are classified
//! again; caps are made again on the facets that these lie on and on those beside them; trees
//! and envelopes of untouched concavities are kept.
//!
//! The adjacency of faces knows no positions and never changes.

mod change;
mod follow;

use cranny_exact::{DVec3, check_point};

pub use self::change::{ChangeSet, DeformError, Work};
use self::follow::Deformation;
use crate::features::{Assignment, Features, RidgeOnFacet};
use crate::ids::{FaceId, PatchId, VertexId};
use crate::mesh::Mesh;
use crate::model::{Model, Parts};
use crate::near::on_line;
use crate::scan::faces::has_no_area;
use crate::tree::GrownAreas;

/// What deformations need and preparation throws away. Made at the first one: as much work as
/// classifying the whole mesh.
#[derive(Clone, Debug)]
pub(crate) struct Workshop {
    assignment: Assignment,
    ridges: Vec<RidgeOnFacet>,
    tree: GrownAreas,
    concavity_trees: GrownAreas,
    patch_trees: GrownAreas,
}

impl Workshop {
    fn of(parts: &Parts) -> Self {
        let assignment = Assignment::of(&parts.mesh, &parts.topology, &parts.hull);
        let (_, ridges) = Features::of(&parts.mesh, &parts.topology, &assignment);
        Self {
            assignment,
            ridges,
            tree: GrownAreas::of(&parts.tree),
            concavity_trees: GrownAreas::of(parts.concavity_trees.arena()),
            patch_trees: GrownAreas::of(parts.patches.trees().arena()),
        }
    }
}

impl Model {
    /// Moves vertices of [`mesh`](Self::mesh) to new places, in the body's frame, all at once, and brings
    /// everything that was prepared up to date. In place where this model is not shared; otherwise
    /// this one becomes a copy and the others stay.
    ///
    /// # What equals a rebuild
    ///
    /// Compared with [`build`](Self::build) of the moved mesh, with [`Repair::None`](crate::Repair::None)
    /// and this model's flatness, and as long as no two vertices coincide (a rebuild would weld them; a
    /// deformation keeps vertices, faces and edges as they are):
    ///
    /// - the hull has the same vertices and the same exact shape. Where four or more of them lie in a
    ///   plane, it may be triangulated otherwise; triangles and facets may be numbered otherwise;
    /// - vertices, edges and faces are classified the same; convex sets, concavities, their faces and
    ///   boundary loops are the same and have the same ids, and lids cover the same;
    /// - all sizes and the mass properties agree to rounding, box, radius and digest to the bit;
    /// - trees hold the same faces in exact boxes, but may divide them otherwise; envelopes likewise;
    /// - patches keep their promises, but may be others: see [`ChangeSet::patches`].
    ///
    /// # Cost
    ///
    /// The first deformation also classifies the mesh once more. Each looks at the moved faces, the
    /// facets, concavities and patches that these belong to, and what these border on; see [`Work`].
    /// Where a face comes onto the hull or leaves it, concavities are numbered anew; where the hull
    /// changes, it is built anew and everything classified. Mass, radius and digest, and copying flat
    /// arrays, take a pass of a few nanoseconds a face.
    ///
    /// # Errors
    ///
    /// [`DeformError`], and then nothing has changed: a vertex that does not exist or is named twice, a
    /// place outside the [`domain`](cranny_exact::domain), no face left with an area, or a closed body
    /// turned inside out.
    pub fn deform(&mut self, moves: &[(VertexId, DVec3)]) -> Result<ChangeSet, DeformError> {
        let moves = checked(self.mesh(), moves)?;
        let faces = faces_of(self, &moves);
        accept_faces(self.parts(), &moves, &faces)?;
        if moves.is_empty() {
            return Ok(unchanged(self));
        }
        let parts = self.parts_mut();
        let mut workshop = match parts.workshop.take() {
            Some(workshop) => workshop,
            None => Box::new(Workshop::of(parts)),
        };
        let change = Deformation::begin(parts, &mut workshop, &moves, faces).run();
        parts.workshop = Some(workshop);
        Ok(change)
    }
}

/// The moves that lead anywhere, by vertex.
fn checked(
    mesh: &Mesh,
    moves: &[(VertexId, DVec3)],
) -> Result<Vec<(VertexId, DVec3)>, DeformError> {
    let vertices = mesh.vertices().len();
    for (at, &(vertex, place)) in moves.iter().enumerate() {
        if vertex.index() >= vertices {
            return Err(DeformError::UnknownVertex { at, vertex, vertices });
        }
        check_point(place).map_err(|source| DeformError::Coordinate { vertex, source })?;
    }
    let mut sorted = moves.to_vec();
    sorted.sort_by_key(|m| m.0);
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(DeformError::MovedTwice { vertex: pair[0].0 });
    }
    sorted.retain(|&(vertex, place)| mesh.position(vertex) != place);
    Ok(sorted)
}

/// The faces of moved vertices, ascending.
fn faces_of(model: &Model, moves: &[(VertexId, DVec3)]) -> Vec<FaceId> {
    let around = moves.iter().flat_map(|m| model.topology().faces_at(m.0));
    let mut faces: Vec<FaceId> = around.copied().collect();
    faces.sort_unstable();
    faces.dedup();
    faces
}

/// Refuses what [`Model::build`] would refuse or turn around.
fn accept_faces(
    parts: &Parts,
    moves: &[(VertexId, DVec3)],
    faces: &[FaceId],
) -> Result<(), DeformError> {
    let mesh = &parts.mesh;
    let place = |v: VertexId| match moves.binary_search_by_key(&v, |m| m.0) {
        Ok(i) => moves[i].1,
        Err(_) => mesh.position(v),
    };
    let count = mesh.faces().len();
    let others = (0..count as u32).map(FaceId).filter(|f| faces.binary_search(f).is_err());
    let moved = faces.iter().map(|&f| mesh.corners(f).map(place));
    let has_area = others.into_iter().any(|f| !has_no_area(mesh, f))
        || moved.clone().any(|[a, b, c]| !on_line(c, a, b));
    if !has_area {
        return Err(DeformError::OnlyDegenerateFaces { faces: count });
    }
    if let Some(mass) = &parts.mass {
        let center = parts.tree.node(0).bounds.center();
        let below = |[a, b, c]: [DVec3; 3]| {
            let [a, b, c] = [a - center, b - center, c - center];
            a.dot(b.cross(c)) / 6.0
        };
        let before: f64 = faces.iter().map(|&f| below(mesh.triangle(f))).sum();
        let volume = mass.volume - before + moved.map(below).sum::<f64>();
        if volume < 0.0 {
            return Err(DeformError::InsideOut { volume });
        }
    }
    Ok(())
}

fn unchanged(model: &Model) -> ChangeSet {
    ChangeSet {
        concavities: model.concavities().iter().map(|c| Some(c.id())).collect(),
        patches: (0..model.patches().len() as u32).map(|p| Some(PatchId(p))).collect(),
        ..ChangeSet::default()
    }
}
