//! Patches as bytes: what was measured of them, and the shape of their trees and of the tree over them. Who
//! owns which vertex and edge, and boxes and cones of nodes, are made again.

use cranny_exact::DVec3;

use super::{NormalCone, Patch, PatchTree, Patches, Slab};
use crate::codec::{Flaw, Reader, Writer, check, check_below, is_size, is_unit, plain_struct};
use crate::ids::PatchId;
use crate::mesh::Mesh;
use crate::topology::Topology;
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
        let Self {
            patches,
            patch_of_face: _,
            patch_of_vertex: _,
            patch_of_edge: _,
            vertices: _,
            edges: _,
            trees,
            slabs,
            top,
        } = self;
        let record = |&Patch { cone, bounds: _, center: _, radius, area, needles }: &Patch| {
            Record { cone, radius, area, needles }
        };
        out.items(patches.len(), patches.iter().map(record));
        trees.encode(out);
        out.list(slabs);
        top.encode(out);
    }

    /// Reads the patches of a mesh.
    pub(crate) fn decode(
        input: &mut Reader,
        mesh: &Mesh,
        topology: &Topology,
    ) -> Result<Self, Flaw> {
        let records: Vec<Record> = input.list()?;
        let trees = FaceForest::decode(input, mesh)?;
        let slabs: Vec<Slab> = input.list()?;
        check(!records.is_empty(), "there is no patch")?;
        check(trees.len() == records.len(), "a tree for each patch is needed")?;
        check(slabs.len() == trees.arena().nodes().len(), "a slab for each node is needed")?;
        check(slabs.iter().all(Slab::is_sound), "a slab has no plane")?;
        check(trees.arena().faces().len() == mesh.faces().len(), "a face is in no patch")?;
        let mut patch_of_face = vec![PatchId(0); mesh.faces().len()];
        let mut patches = Vec::with_capacity(records.len());
        for (id, &record) in (0..).map(PatchId).zip(&records) {
            let Record { cone, radius, area, needles } = record;
            let root = trees.root(id.index()).ok_or("a patch has no face")?;
            let faces = trees.faces(id.index());
            faces.iter().for_each(|f| patch_of_face[f.index()] = id);
            check(is_unit(cone.axis) && cone.cosine.abs() <= 1.0, "a cone has no axis")?;
            check(is_size(radius) && is_size(area), "a patch has no size")?;
            check(needles as usize <= faces.len(), "a patch has more needles than faces")?;
            let bounds = trees.arena().node(root).bounds;
            patches.push(Patch { cone, bounds, center: bounds.center(), radius, area, needles });
        }
        let top = PatchTree::decode(input, &patches)?;
        Ok(Self::assembled(mesh, topology, patches, patch_of_face, trees, slabs, top))
    }
}

impl PatchTree {
    fn encode(&self, out: &mut Writer) {
        let Self { nodes, cones: _, order } = self;
        out.list(order);
        out.items(nodes.len(), nodes.iter().map(Node::count));
    }

    /// Reads the shape of the tree over all patches.
    fn decode(input: &mut Reader, patches: &[Patch]) -> Result<Self, Flaw> {
        let (order, counts): (Vec<PatchId>, Vec<u32>) = (input.list()?, input.list()?);
        check(order.len() == patches.len(), "a leaf for each patch is needed")?;
        let mut is_named = vec![false; patches.len()];
        for patch in &order {
            let is_named = is_named.get_mut(patch.index()).ok_or("a patch is not there")?;
            check(!std::mem::replace(is_named, true), "a patch is named twice")?;
        }
        check_below(counts.iter().copied(), 2, "a leaf has two patches")?;
        let mut shape = Shape::new(&counts);
        shape.tree(0..counts.len(), 0..order.len(), |leaf| {
            patches[order[leaf.start].index()].bounds
        })?;
        Ok(Self::with_cones(shape.into_nodes(), order, patches))
    }
}

impl Slab {
    fn is_sound(&self) -> bool {
        self.height.is_finite() && (is_unit(self.normal) || self.normal == DVec3::ZERO)
    }
}
