//! Envelopes of concavities of which some have changed.
//!
//! No source: an envelope depends on its own pocket alone, so the others are copied. Cost: with the
//! function.

use super::build::Workshop;
use super::{EnvelopeFacet, Envelopes, Head, Pocket};
use cranny_geometry::{FaceForest, Mesh, OptionalIndex};

/// Where an envelope's parts stand in the flat arrays.
struct Place {
    head: Head,
    layers: [u32; 2],
    facets: [u32; 2],
    faces: [u32; 2],
}

impl Envelopes {
    /// The same envelopes but for those of some pockets: that of pocket `i` is envelope `kept(i)`
    /// of these, where there is one; the others are built, given trees over the faces of each
    /// pocket.
    ///
    /// Cost: copying, and O(n log n) for the faces of the pockets that are built.
    pub(crate) fn updated<'p>(
        &self,
        mesh: &Mesh,
        pockets: impl IntoIterator<Item = Pocket<'p>>,
        trees: &FaceForest,
        kept: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let places = self.places();
        let mut all = Self::empty(self.options);
        let mut workshop = Workshop::default();
        for (i, pocket) in pockets.into_iter().enumerate() {
            match kept(i) {
                Some(old) => all.copy(self, &places[old]),
                None => all.add(mesh, &pocket, (trees.arena(), trees.root(i)), &mut workshop),
            }
        }
        all
    }

    /// Envelopes stand one behind the other in every array; found from the last to the first.
    fn places(&self) -> Vec<Place> {
        let mut ends = [self.layers.len(), self.facets.len(), self.faces.len()].map(|n| n as u32);
        let mut places = Vec::with_capacity(self.heads.len());
        for &head in self.heads.iter().rev() {
            let mut starts = ends;
            if let Some(layer) = head.layer.get() {
                let [facet, end] = self.layers[layer as usize];
                let first_layer = &self.facets[facet as usize..end as usize];
                let face = first_layer.iter().map(|f| f.faces[0]).min();
                starts = [layer, facet, face.unwrap_or(ends[2])];
            }
            let [layers, facets, faces] = [0, 1, 2].map(|i| [starts[i], ends[i]]);
            places.push(Place { head, layers, facets, faces });
            ends = starts;
        }
        places.reverse();
        places
    }

    fn copy(&mut self, other: &Self, place: &Place) {
        let row = |of: [u32; 2]| of[0] as usize..of[1] as usize;
        let [layer, facet, face] =
            [self.layers.len(), self.facets.len(), self.faces.len()].map(|n| n as u32);
        let lid = self.lids.len() as u32;
        let move_layer = |own: OptionalIndex| match own.get() {
            Some(own) => OptionalIndex::some(own - place.layers[0] + layer),
            None => own,
        };
        self.lids.extend_from_slice(&other.lids[row(place.head.lids)]);
        self.heads.push(Head {
            lids: [lid, self.lids.len() as u32],
            layer: move_layer(place.head.layer),
            ..place.head
        });
        let layers = &other.layers[row(place.layers)];
        self.layers.extend(layers.iter().map(|l| l.map(|f| f - place.facets[0] + facet)));
        self.facets.extend(other.facets[row(place.facets)].iter().map(|&f| {
            let faces = f.faces.map(|i| i - place.faces[0] + face);
            EnvelopeFacet { faces, layer: move_layer(f.layer), ..f }
        }));
        self.faces.extend_from_slice(&other.faces[row(place.faces)]);
    }
}
