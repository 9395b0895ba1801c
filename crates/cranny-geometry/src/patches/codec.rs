//! Patches as bytes: what was measured of them, the cones of the tree over them, and the shape of
//! all trees. Boxes are made again, when somebody asks for patches.

use cranny_exact::{Aabb, DVec3};

use super::{NormalCone, Patch, PatchTree, Patches, Slab};
use crate::codec::{
    Flaw, Reader, Writer, check, check_below, check_each_once, is_size, is_unit, plain_struct,
};
use crate::ids::PatchId;
use crate::mesh::Mesh;
use crate::tree::{Node, NodesFromCounts, StoredForest, check_shape};

plain_struct!(Slab { normal: DVec3, height: f64 });
plain_struct!(NormalCone { axis: DVec3, cosine: f64 });

/// What is written of a patch.
#[derive(Clone, Copy, Debug)]
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
}

/// Patches without boxes, of which all else was checked.
#[derive(Clone, Debug, Default)]
pub(crate) struct StoredPatches {
    records: Vec<Record>,
    patch_of_face: Vec<PatchId>,
    trees: StoredForest,
    slabs: Vec<Slab>,
    top: FoldedTop,
}

impl StoredPatches {
    /// Reads the patches of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let records: Vec<Record> = input.list()?;
        let (trees, patch_of_face) = StoredForest::decode(input, mesh)?;
        let slabs: Vec<Slab> = input.list()?;
        check(!records.is_empty(), "there is no patch")?;
        check(trees.len() == records.len(), "a tree for each patch is needed")?;
        check(slabs.len() == trees.node_count(), "a slab for each node is needed")?;
        check(slabs.iter().all(Slab::is_sound), "a slab has no plane")?;
        let held = (0..trees.len()).map(|tree| trees.face_count(tree));
        check(held.clone().sum::<usize>() == patch_of_face.len(), "a face is in no patch")?;
        for (faces, &Record { cone, radius, area, needles }) in held.zip(&records) {
            check(faces > 0, "a patch has no face")?;
            check(cone.is_sound(), "a cone has no axis")?;
            check(is_size(radius) && is_size(area), "a patch has no size")?;
            check(needles as usize <= faces, "a patch has more needles than faces")?;
        }
        let top = FoldedTop::decode(input, records.len())?;
        let patch_of_face = patch_of_face.into_iter().map(PatchId).collect();
        Ok(Self { records, patch_of_face, trees, slabs, top })
    }

    /// The patches. What they keep is taken out.
    pub(crate) fn rebuild(&mut self, mesh: &Mesh) -> Patches {
        let trees = self.trees.rebuild(mesh);
        let rebuilt = |(tree, &Record { cone, radius, area, needles }): (usize, &Record)| {
            // Each has one: it holds a face.
            let bounds =
                trees.root(tree).map_or(Aabb::EMPTY, |root| trees.arena().node(root).bounds);
            Patch { cone, bounds, center: bounds.center(), radius, area, needles }
        };
        let patches: Vec<Patch> = self.records.iter().enumerate().map(rebuilt).collect();
        let top = self.top.rebuild(&patches);
        let (patch_of_face, slabs) = (&mut self.patch_of_face, &mut self.slabs);
        Patches {
            patches,
            patch_of_face: std::mem::take(patch_of_face),
            trees,
            slabs: std::mem::take(slabs),
            top,
        }
    }
}

impl PatchTree {
    fn encode(&self, out: &mut Writer) {
        let Self { nodes, cones, order } = self;
        out.list(order);
        out.items(nodes.len(), nodes.iter().map(Node::count));
        out.list(cones);
    }
}

/// The tree over all patches without its boxes.
#[derive(Clone, Debug, Default)]
struct FoldedTop {
    order: Vec<PatchId>,
    counts: Vec<u32>,
    cones: Vec<NormalCone>,
}

impl FoldedTop {
    fn decode(input: &mut Reader, patches: usize) -> Result<Self, Flaw> {
        let (order, counts): (Vec<PatchId>, Vec<u32>) = (input.list()?, input.list()?);
        check(order.len() == patches, "a leaf for each patch is needed")?;
        check_each_once(order.iter().map(|patch| patch.0), patches)?;
        check_below(counts.iter().copied(), 2, "a leaf has two patches")?;
        check_shape(&counts, patches)?;
        let cones: Vec<NormalCone> = input.list()?;
        check(cones.len() == counts.len(), "a cone for each node is needed")?;
        check(cones.iter().all(NormalCone::is_sound), "the cone of a node has no axis")?;
        Ok(Self { order, counts, cones })
    }

    fn rebuild(&mut self, patches: &[Patch]) -> PatchTree {
        let Self { order, counts, cones } = self;
        let mut nodes = NodesFromCounts::of(counts);
        nodes.tree(0..counts.len(), 0..order.len(), |leaf| {
            patches[order[leaf.start].index()].bounds
        });
        let nodes = nodes.into_nodes();
        PatchTree { nodes, cones: std::mem::take(cones), order: std::mem::take(order) }
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
