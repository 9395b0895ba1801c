//! The surface divided into patches: connected faces of nearly one normal and bounded size.
//!
//! A solver wants few contacts, well chosen, each with the normal of its own point. So the narrow
//! phase does not report all faces that are near each other, but the nearest points for each pair
//! of patches: its search tree ([`ClusterTree`](crate::ClusterTree)) names the patch of each face,
//! vertex and edge.
//!
//! Every face belongs to one patch. An edge or a vertex belongs to the patch with the lowest number
//! among those of its faces, so that a contact on a border is found once; nothing of that is kept,
//! for a mesh's adjacency says it in a few steps. Bounds: all normals of a patch lie within its
//! cone (certified, see [`NormalCone`]), whose half-angle is at most 25 degrees; its box's diagonal
//! is at most a quarter of the body's, or √2 times its largest face's. Needles, thinner than 2^-30
//! of their length, have no normal that rounding leaves alone: they go with a neighbour, are
//! counted in [`Patch::needles`], and the cone does not speak for them.
//!
//! How faces are chosen stands in `grow`. Cost: near-linear.
//!
//! Sources stand with the parts: patches in `grow`, cones in `cone`.

mod codec;
mod cone;
mod grow;
mod update;

use std::collections::BTreeSet;

use cranny_exact::{Aabb, DVec3};

pub use self::cone::NormalCone;
use self::cone::{Measured, Normal, Normals};
use crate::ids::{EdgeId, FaceId, PatchId, VertexId};
use crate::mesh::Mesh;
use crate::rows::{row, rows};
use crate::topology::Topology;
use crate::tree::Mates;

/// What is known of a patch, in the body's frame. [`Patches`] has its faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Holds the normal of every face but [`needles`](Self::needles).
    pub cone: NormalCone,
    /// Box of the faces, exact.
    pub bounds: Aabb,
    /// Middle of the box.
    pub center: DVec3,
    /// No point of the patch is farther than this from [`center`](Self::center); rounded up.
    pub radius: f64,
    /// Sum of the faces' areas, to rounding.
    pub area: f64,
    /// Number of faces that the cone does not speak for.
    pub needles: u32,
}

/// All patches of a mesh. Patches are numbered in the order of their lowest faces.
#[derive(Clone, Debug)]
pub struct Patches {
    patches: Vec<Patch>,
    patch_of_face: Vec<PatchId>,
    faces: Lists,
}

/// Faces of each patch, one patch behind the other, ascending within each.
#[derive(Clone, Debug, PartialEq)]
struct Lists {
    starts: Vec<u32>,
    faces: Vec<FaceId>,
}

impl Lists {
    /// From the patch of each face.
    fn of(patches: usize, owners: &[u32]) -> Self {
        let (starts, faces) = rows(owners, patches);
        Self { starts, faces: faces.into_iter().map(FaceId).collect() }
    }

    fn get(&self, patch: usize) -> &[FaceId] {
        &self.faces[row(&self.starts, patch)]
    }
}

impl Patches {
    /// Divides the faces of a mesh whose adjacency is `topology`.
    #[must_use]
    pub fn of(mesh: &Mesh, topology: &Topology) -> Self {
        Self::with_mates(mesh, topology, &Mates::of(mesh, topology))
    }

    /// The same, given which faces hang together.
    pub(crate) fn with_mates(mesh: &Mesh, topology: &Topology, mates: &Mates) -> Self {
        let normals = Normals::of(mesh);
        let partition = grow::partition_by(mesh, topology, &normals, mates);
        Self::assemble(mesh, partition, |face| normals.get(face))
    }

    /// From a partition; `normal_of` returns the normal of a face.
    fn assemble(
        mesh: &Mesh,
        partition: grow::Partition,
        normal_of: impl Fn(FaceId) -> Option<Normal>,
    ) -> Self {
        let grow::Partition { patch_of, patches: grown } = partition;
        let faces = Lists::of(grown.len(), &patch_of);
        let measured = |(p, grown): (usize, &grow::Growing)| {
            Patch::by(&normal_of, mesh, faces.get(p), grown.cone)
        };
        let patches = grown.iter().enumerate().map(measured).collect();
        let patch_of_face = patch_of.into_iter().map(PatchId).collect();
        Self { patches, patch_of_face, faces }
    }

    /// Number of patches; at least 1.
    #[must_use]
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there are no patches: never, since a mesh has faces.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// A patch by number.
    #[must_use]
    pub fn patch(&self, patch: PatchId) -> &Patch {
        &self.patches[patch.index()]
    }

    /// All patches, by number.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// The patch of a face.
    #[must_use]
    #[inline]
    pub fn patch_of_face(&self, face: FaceId) -> PatchId {
        self.patch_of_face[face.index()]
    }

    /// The patch of a vertex: the lowest among its faces'; `None` where no face names it.
    /// `topology` is the mesh's. Cost: its faces.
    #[must_use]
    #[inline]
    pub fn patch_of_vertex(&self, topology: &Topology, vertex: VertexId) -> Option<PatchId> {
        topology.faces_at(vertex).iter().map(|&face| self.patch_of_face(face)).min()
    }

    /// The patch of an edge: the lowest among its faces'. `topology` is the mesh's. Cost: its
    /// faces.
    #[must_use]
    #[inline]
    pub fn patch_of_edge(&self, topology: &Topology, edge: EdgeId) -> PatchId {
        let around = topology.half_edges(edge).iter().map(|h| self.patch_of_face(h.face()));
        around.fold(PatchId(u32::MAX), PatchId::min)
    }

    /// The faces of a patch, ascending.
    #[must_use]
    pub fn faces(&self, patch: PatchId) -> &[FaceId] {
        self.faces.get(patch.index())
    }

    /// The patch with exactly these faces, if there is one.
    pub(crate) fn with_faces(&self, faces: &[FaceId]) -> Option<PatchId> {
        let patch = self.patch_of_face(*faces.first()?);
        let is_same = self.faces(patch).len() == faces.len()
            && faces.iter().all(|&f| self.patch_of_face(f) == patch);
        is_same.then_some(patch)
    }

    /// Checks the invariants; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(&self, mesh: &Mesh, topology: &Topology) -> Result<(), String> {
        let owners: Vec<u32> = self.patch_of_face.iter().map(|p| p.0).collect();
        if owners.len() != mesh.faces().len() {
            return Err("a patch for each face is needed".into());
        }
        if self.faces != Lists::of(self.len(), &owners) {
            return Err("faces are listed with other patches than theirs".into());
        }
        for (id, patch) in (0..).map(PatchId).zip(&self.patches) {
            self.validate_patch(id, patch, mesh, topology)?;
        }
        Ok(())
    }

    fn validate_patch(
        &self,
        id: PatchId,
        patch: &Patch,
        mesh: &Mesh,
        topology: &Topology,
    ) -> Result<(), String> {
        let faces = self.faces(id);
        if *patch != Patch::of(mesh, faces, Some(patch.cone)) {
            return Err(format!("patch {} is not what its faces make", id.0));
        }
        let (limits, mut largest) = (grow::Limits::of(&mesh.bounds()), 0.0f64);
        for &face in faces {
            let bounds = Aabb::of_points(mesh.triangle(face));
            largest = largest.max((bounds.max - bounds.min).length_squared());
        }
        let extent = (patch.bounds.max - patch.bounds.min).length_squared();
        if extent > limits.diagonal_squared(largest) {
            return Err(format!("patch {} is too large", id.0));
        }
        if faces.len() > patch.needles as usize
            && patch.cone.cosine < grow::LEAST_COSINE - cone::ROUNDING
        {
            return Err(format!("the cone of patch {} is too wide", id.0));
        }
        let mut reached = BTreeSet::from([faces[0]]);
        let mut front = vec![faces[0]];
        while let Some(face) = front.pop() {
            grow::for_each_neighbor(topology, face, |_, other| {
                if self.patch_of_face(other) == id && reached.insert(other) {
                    front.push(other);
                }
            });
        }
        if reached.len() != faces.len() {
            return Err(format!("patch {} does not hang together", id.0));
        }
        Ok(())
    }
}

impl Patch {
    /// Of some faces, at least one. `axis`: of the cone; `None` where all faces are needles.
    fn of(mesh: &Mesh, faces: &[FaceId], axis: Option<NormalCone>) -> Self {
        Self::by(|face| Normal::of(mesh, face), mesh, faces, axis)
    }

    /// The same, given the normals of faces.
    fn by(
        normal_of: impl Fn(FaceId) -> Option<Normal>,
        mesh: &Mesh,
        faces: &[FaceId],
        axis: Option<NormalCone>,
    ) -> Self {
        let corners = || faces.iter().flat_map(|&f| mesh.triangle(f));
        let bounds = Aabb::of_points(corners());
        let center = bounds.center();
        // Not by `f64::max`, which would look for NaN among them.
        let farther = |most, p: DVec3| {
            let squared = (p - center).length_squared();
            if squared > most { squared } else { most }
        };
        let farthest = corners().fold(0.0, farther);
        let axis = axis.map_or(DVec3::ZERO, |cone| cone.axis);
        let Measured { cone, needles, area } = Measured::of(normal_of, mesh, faces, axis);
        Self {
            cone,
            bounds,
            center,
            // Differences, squares, sums and the root: five roundings, eight leave room.
            radius: (farthest.sqrt() * (1.0 + 8.0 * f64::EPSILON)).next_up(),
            area,
            needles,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares in the plane z = 0, bent up along x = `fold`.
    fn strip(squares: u32, fold: u32) -> (Mesh, Topology) {
        let point = |x: u32, y: f64| {
            let up = x.saturating_sub(fold);
            DVec3::new(f64::from(x - up), y, f64::from(up))
        };
        let vertices = (0..=squares).flat_map(|x| [point(x, 0.0), point(x, 1.0)]).collect();
        let faces = (0..squares)
            .flat_map(|x| [[2 * x, 2 * x + 2, 2 * x + 3], [2 * x, 2 * x + 3, 2 * x + 1]]);
        let mesh = Mesh::new(vertices, faces.collect()).unwrap();
        let topology = Topology::of(&mesh);
        (mesh, topology)
    }

    #[test]
    fn a_fold_divides_patches_and_features_go_to_the_lowest() {
        let (mesh, topology) = strip(2, 1);
        let patches = Patches::of(&mesh, &topology);
        patches.validate(&mesh, &topology).unwrap();
        let ids: Vec<u32> = (0..4).map(|f| patches.patch_of_face(FaceId(f)).0).collect();
        assert_eq!(ids, [0, 0, 1, 1]);
        assert_eq!(patches.patch_of_vertex(&topology, VertexId(3)), Some(PatchId(0)));
        assert_eq!(patches.patch_of_vertex(&topology, VertexId(5)), Some(PatchId(1)));
        assert_eq!(patches.patch(PatchId(1)).cone.axis, -DVec3::X);
    }

    #[test]
    fn a_long_strip_is_cut_by_size_and_at_the_fold() {
        let (mesh, topology) = strip(100, 50);
        let patches = Patches::of(&mesh, &topology);
        patches.validate(&mesh, &topology).unwrap();
        // Body: 50 x 1 x 50, diagonal 70.7, a quarter is 17.7: 3 patches a side.
        assert_eq!(patches.len(), 6);
        for patch in patches.patches() {
            assert!(patch.cone.cosine > 1.0 - 1e-12 && patch.needles == 0);
            let flat = patch.cone.axis == DVec3::Z || patch.cone.axis == -DVec3::X;
            assert!(flat, "{:?}", patch.cone);
        }
        assert_eq!(patches.patches().iter().map(|p| p.area).sum::<f64>(), 100.0);
    }

    #[test]
    fn a_mesh_of_needles_has_patches_without_a_cone() {
        let point = |i: u32| DVec3::new(f64::from(i), f64::from(i % 2) * 1e-12, 0.0);
        let mesh =
            Mesh::new((0..9).map(point).collect(), (0..7).map(|i| [i, i + 1, i + 2]).collect());
        let mesh = mesh.unwrap();
        let topology = Topology::of(&mesh);
        let patches = Patches::of(&mesh, &topology);
        patches.validate(&mesh, &topology).unwrap();
        assert!(patches.patches().iter().all(|p| !p.cone.is_bounded() && p.needles > 0));
    }
}
