//! Patches as bytes: what was measured of them, the cones of the tree over them, and the shape of all trees. Boxes
//! are made again.

use cranny_exact::DVec3;

use super::{NormalCone, Patch, PatchTree, Patches, Slab};
use crate::codec::{
    Flaw, Reader, Writer, check, check_below, check_each_once, is_size, is_unit, plain_struct,
};
use crate::ids::PatchId;
use crate::mesh::Mesh;
use crate::tree::{FaceForest, Node, Shape};

plain_struct!(Slab { normal: DVec3, height: f64 });
plain_struct!(NormalCone { axis: DVec3, cosine: f64 });

/// What is written of a patch.
#[derive(Clone, Copy)]
struct Record {
    cone: NormalCone,
    radius: f64,
    area: f64,
    needles: u32,
}
plain_struct!(Record { cone: NormalCone, radius: f64, area: f64, needles: u32 });

impl Patches {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { patches, patch_of_face: _, trees, slabs, top } = self;
        let record = |&Patch { cone, bounds: _, center: _, radius, area, needles }: &Patch| {
            Record { cone, radius, area, needles }
        };
        out.items(patches.len(), patches.iter().map(record));
        trees.encode(out);
        out.list(slabs);
        top.encode(out);
    }

    /// Reads the patches of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let records: Vec<Record> = input.list()?;
        let (trees, patch_of_face) = FaceForest::decode(input, mesh)?;
        let slabs: Vec<Slab> = input.list()?;
        check(!records.is_empty(), "there is no patch")?;
        check(trees.len() == records.len(), "a tree for each patch is needed")?;
        check(slabs.len() == trees.arena().nodes().len(), "a slab for each node is needed")?;
        check(slabs.iter().all(Slab::is_sound), "a slab has no plane")?;
        check(trees.arena().faces().len() == patch_of_face.len(), "a face is in no patch")?;
        let mut patches = Vec::with_capacity(records.len());
        for (tree, &Record { cone, radius, area, needles }) in records.iter().enumerate() {
            let root = trees.root(tree).ok_or("a patch has no face")?;
            check(cone.is_sound(), "a cone has no axis")?;
            check(is_size(radius) && is_size(area), "a patch has no size")?;
            check(
                needles as usize <= trees.faces(tree).len(),
                "a patch has more needles than faces",
            )?;
            let bounds = trees.arena().node(root).bounds;
            patches.push(Patch { cone, bounds, center: bounds.center(), radius, area, needles });
        }
        let top = PatchTree::decode(input, &patches)?;
        let patch_of_face = patch_of_face.into_iter().map(PatchId).collect();
        Ok(Self { patches, patch_of_face, trees, slabs, top })
    }
}

impl PatchTree {
    fn encode(&self, out: &mut Writer) {
        let Self { nodes, cones, order } = self;
        out.list(order);
        out.items(nodes.len(), nodes.iter().map(Node::count));
        out.list(cones);
    }

    /// Reads the tree over all patches.
    fn decode(input: &mut Reader, patches: &[Patch]) -> Result<Self, Flaw> {
        let order: Vec<PatchId> = input.list()?;
        let counts = input.words()?;
        check(order.len() == patches.len(), "a leaf for each patch is needed")?;
        check_each_once(order.iter().map(|patch| patch.0), patches.len())?;
        let counted = counts.iter().map(|&count| u32::from_le_bytes(count));
        check_below(counted, 2, "a leaf has two patches")?;
        let mut shape = Shape::new(counts, order.len(), counts.len())?;
        shape.tree(0..counts.len(), 0..order.len(), |leaf| {
            patches[order[leaf.start].index()].bounds
        })?;
        let cones: Vec<NormalCone> = input.list()?;
        check(cones.len() == counts.len(), "a cone for each node is needed")?;
        check(cones.iter().all(NormalCone::is_sound), "the cone of a node has no axis")?;
        Ok(Self { nodes: shape.into_nodes(), cones, order })
    }
}

impl NormalCone {
    fn is_sound(&self) -> bool {
        is_unit(self.axis) && self.cosine.abs() <= 1.0
    }
}

impl Slab {
    fn is_sound(&self) -> bool {
        self.height.is_finite() && (is_unit(self.normal) || self.normal == DVec3::ZERO)
    }
}
