//! Patches as bytes: their faces and the axes of their cones. All else is measured again.

use cranny_exact::DVec3;

use super::{Lists, NormalCone, Patch, Patches};
use crate::codec::{Flaw, Reader, Writer, check, is_unit, owners_of_rows};
use crate::ids::{FaceId, PatchId};
use crate::mesh::Mesh;

impl Patches {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { patches, patch_of_face: _, faces: Lists { starts, faces } } = self;
        out.items(patches.len(), patches.iter().map(|patch| patch.cone.axis));
        out.list(starts);
        out.list(faces);
    }

    /// Reads the patches of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let axes: Vec<DVec3> = input.list()?;
        let (starts, faces): (Vec<u32>, Vec<u32>) = (input.list()?, input.list()?);
        check(!axes.is_empty(), "there is no patch")?;
        let count = mesh.faces().len();
        let patch_of_face = owners_of_rows(&starts, axes.len(), &faces, count)?;
        check(faces.len() == count, "a face is in no patch")?;
        check(starts.is_sorted_by(|a, b| a < b), "a patch has no face")?;
        check(axes.iter().all(|&axis| is_unit(axis)), "a cone has no axis")?;
        let patch_of_face = patch_of_face.into_iter().map(PatchId).collect();
        let faces = Lists { starts, faces: faces.into_iter().map(FaceId).collect() };
        let measured = |(patch, &axis): (usize, &DVec3)| {
            Patch::of(mesh, faces.get(patch), Some(NormalCone { axis, ..NormalCone::WHOLE }))
        };
        let patches: Vec<Patch> = axes.iter().enumerate().map(measured).collect();
        let bits = |axis: DVec3| axis.to_array().map(f64::to_bits);
        let is_kept = |(patch, &axis): (&Patch, &DVec3)| bits(patch.cone.axis) == bits(axis);
        check(patches.iter().zip(&axes).all(is_kept), "a cone is not about its faces' normals")?;
        Ok(Self { patches, patch_of_face, faces })
    }
}
