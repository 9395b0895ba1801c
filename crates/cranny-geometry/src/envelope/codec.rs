//! Envelopes as bytes. Boxes are made again.

use cranny_exact::{Aabb, DVec3};

use super::{EnvelopeFacet, EnvelopeOptions, Envelopes, HalfSpace, Head};
use crate::codec::{Flaw, Plain, Reader, Writer, check, is_unit, owners, plain_struct};
use crate::concavity::Concavities;
use crate::ids::FaceId;
use crate::mesh::Mesh;
use crate::tree::box_around;

plain_struct!(HalfSpace { normal: DVec3, offset: f64 });

/// What is written of a facet.
#[derive(Clone, Copy)]
struct FacetRecord {
    beneath: HalfSpace,
    reach: f64,
    faces: [u32; 2],
    layer: u32,
}
plain_struct!(FacetRecord { beneath: HalfSpace, reach: f64, faces: [u32; 2], layer: u32 });

/// Comes back without a box.
impl Plain for EnvelopeFacet {
    const SIZE: usize = FacetRecord::SIZE;

    fn put(self, out: &mut Vec<u8>) {
        let Self { beneath, bounds: _, reach, faces, layer } = self;
        FacetRecord { beneath, reach, faces, layer }.put(out);
    }

    fn get(bytes: &[u8]) -> Self {
        let FacetRecord { beneath, reach, faces, layer } = FacetRecord::get(bytes);
        Self { beneath, bounds: Aabb::EMPTY, reach, faces, layer }
    }
}

/// What is written of an envelope as a whole.
#[derive(Clone, Copy)]
struct HeadRecord {
    axis: DVec3,
    lids: [u32; 2],
    layer: u32,
}
plain_struct!(HeadRecord { axis: DVec3, lids: [u32; 2], layer: u32 });

/// Comes back without a box.
impl Plain for Head {
    const SIZE: usize = HeadRecord::SIZE;

    fn put(self, out: &mut Vec<u8>) {
        let Self { axis, bounds: _, lids, layer } = self;
        HeadRecord { axis, lids, layer }.put(out);
    }

    fn get(bytes: &[u8]) -> Self {
        let HeadRecord { axis, lids, layer } = HeadRecord::get(bytes);
        Self { axis, bounds: Aabb::EMPTY, lids, layer }
    }
}

impl Envelopes {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { heads, layers, facets, faces, lids, options } = self;
        let &EnvelopeOptions { width, leaf_faces } = options;
        out.list(heads);
        out.list(layers);
        out.list(facets);
        out.list(faces);
        out.list(lids);
        out.one([width, leaf_faces].map(|n| n as u64));
    }

    /// Reads an envelope for each concavity.
    pub(crate) fn decode(
        input: &mut Reader,
        mesh: &Mesh,
        concavities: &Concavities,
    ) -> Result<Self, Flaw> {
        let (heads, layers): (Vec<Head>, Vec<[u32; 2]>) = (input.list()?, input.list()?);
        let (facets, faces): (Vec<EnvelopeFacet>, Vec<u32>) = (input.list()?, input.list()?);
        let lids: Vec<HalfSpace> = input.list()?;
        let [width, leaf_faces]: [u64; 2] = input.one()?;

        check(heads.len() == concavities.len(), "an envelope for each concavity is needed")?;
        check(heads.iter().fold(true, |all, h| all & is_unit(h.axis)), "an axis has no direction")?;
        let has_lids =
            |&Head { lids: [from, to], .. }: &Head| (from <= to) & (to as usize <= lids.len());
        check(heads.iter().fold(true, |all, head| all & has_lids(head)), "a lid is not there")?;
        check(lids.iter().fold(true, |all, lid| all & lid.is_sound()), "a lid has no plane")?;
        let is_sound = |f: &EnvelopeFacet| f.beneath.is_sound() & f.reach.is_finite();
        check(facets.iter().fold(true, |all, f| all & is_sound(f)), "a facet has no plane")?;
        check_faces(&faces, concavities)?;
        let options = EnvelopeOptions {
            width: usize::try_from(width)?,
            leaf_faces: usize::try_from(leaf_faces)?,
        };
        let faces = faces.into_iter().map(FaceId).collect();
        let mut read = Self { heads, layers, facets, faces, lids, options };
        read.check_layers(concavities)?;
        read.enclose(mesh);
        Ok(read)
    }

    /// Layers nest: each hangs beneath one envelope or facet, that facet in an earlier layer, and divides
    /// its faces.
    fn check_layers(&self, concavities: &Concavities) -> Result<(), Flaw> {
        let mut next_facet = 0;
        for &[from, to] in &self.layers {
            check(from == next_facet && from < to, "layers are not in order, or empty")?;
            next_facet = to;
        }
        check(next_facet as usize == self.facets.len(), "a facet is in no layer")?;

        /// In place of a range: nobody has named the layer yet.
        const NOBODY: [u32; 2] = [u32::MAX; 2];
        let mut above = vec![NOBODY; self.layers.len()];
        let mut hang = |layer: u32, faces: [u32; 2]| {
            let place = above.get_mut(layer as usize).ok_or("a layer is not there")?;
            check(*place == NOBODY, "a layer hangs twice")?;
            *place = faces;
            Ok::<(), Flaw>(())
        };
        let mut start = 0;
        let mut first_layers = Vec::new();
        for (head, concavity) in self.heads.iter().zip(concavities.iter()) {
            let end = start + concavity.faces.len() as u32;
            match (start == end, head.layer) {
                (true, u32::MAX) => {}
                (false, layer) if layer != u32::MAX => {
                    hang(layer, [start, end])?;
                    first_layers.push(layer);
                }
                _ => return Err("an envelope has faces or a layer, not both".into()),
            }
            start = end;
        }
        check(first_layers.is_sorted(), "envelopes are not in order")?;
        first_layers.push(self.layers.len() as u32);
        for (index, &[from, to]) in (0..).zip(&self.layers) {
            let next = first_layers.partition_point(|&first| first <= index);
            let end = *first_layers.get(next).ok_or("a layer is of no envelope")?;
            for facet in &self.facets[from as usize..to as usize] {
                if facet.layer != u32::MAX {
                    let is_beneath = (index + 1..end).contains(&facet.layer);
                    check(is_beneath, "a layer hangs beneath a later one, or another envelope's")?;
                    hang(facet.layer, facet.faces)?;
                }
            }
        }
        // Of the part of a layer that begins at a face: the layer, and where the part ends.
        let mut parts = vec![NOBODY; self.faces.len()];
        for ((index, &[from, to]), &[start, end]) in (0..).zip(&self.layers).zip(&above) {
            check([start, end] != NOBODY, "a layer hangs nowhere")?;
            let layer = &self.facets[from as usize..to as usize];
            check(layer.is_sorted_by(|a, b| a.reach >= b.reach), "facets are not in order")?;
            for &EnvelopeFacet { faces: [start, end], .. } in layer {
                let part = parts.get_mut(start as usize).ok_or("a face is not there")?;
                *part = [index, end];
            }
            // As many steps as there are parts, each from another one: all of them.
            let step = |at: u32, _| {
                let &[of, end] = parts.get(at as usize)?;
                (of == index && end > at).then_some(end)
            };
            let reached = layer.iter().try_fold(start, step);
            check(reached == Some(end), "a layer does not divide the faces above it")?;
        }
        Ok(())
    }

    /// Puts boxes around what is beneath; each layer is behind the facet that it hangs from.
    fn enclose(&mut self, mesh: &Mesh) {
        let Self { heads, layers, facets, faces, .. } = self;
        let around = |facets: &[EnvelopeFacet], [from, to]: [u32; 2]| {
            let layer = &facets[from as usize..to as usize];
            layer.iter().fold(Aabb::EMPTY, |all, facet| all.union(&facet.bounds))
        };
        for index in (0..facets.len()).rev() {
            let EnvelopeFacet { faces: [from, to], layer, .. } = facets[index];
            facets[index].bounds = match layers.get(layer as usize) {
                Some(&beneath) => around(facets, beneath),
                None => box_around(mesh, &faces[from as usize..to as usize]),
            };
        }
        for head in heads {
            if let Some(&first) = layers.get(head.layer as usize) {
                head.bounds = around(facets, first);
            }
        }
    }
}

/// Each envelope holds the faces of its concavity, one envelope behind the other.
fn check_faces(faces: &[u32], concavities: &Concavities) -> Result<(), Flaw> {
    let mut rest = faces;
    let mut rows = Vec::with_capacity(concavities.len());
    for concavity in concavities.iter() {
        let (own, others) =
            rest.split_at_checked(concavity.faces.len()).ok_or("faces are missing")?;
        rows.push(own);
        rest = others;
    }
    check(rest.is_empty(), "faces are of no concavity")?;
    let owners = owners(concavities.owners().len(), rows)?;
    check(owners == concavities.owners(), "a face is of another concavity")
}

impl HalfSpace {
    fn is_sound(&self) -> bool {
        is_unit(self.normal) & self.offset.is_finite()
    }
}
