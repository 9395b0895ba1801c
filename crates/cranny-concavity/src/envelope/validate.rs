//! The invariants of envelopes, as something to run.

use cranny_exact::{Aabb, DVec3};

use super::{Envelope, EnvelopeFacet, Envelopes, HalfSpace, Pocket};
use crate::ids::{EnvelopeFacetId, LayerId};
use cranny_geometry::Mesh;

impl HalfSpace {
    /// Whether the point certainly lies in it: by interval arithmetic, no rounding of which exceeds
    /// the room that [`holding`](Self::holding) leaves.
    fn certainly_holds(&self, p: DVec3) -> bool {
        let rounding = 1.5 * f64::EPSILON * self.normal.abs().dot(p.abs()) + f64::MIN_POSITIVE;
        self.normal.dot(p) + rounding <= self.offset
    }

    fn is_unit(&self) -> bool {
        (self.normal.length_squared() - 1.0).abs() <= 8.0 * f64::EPSILON
    }
}

impl Envelopes {
    /// Checks the invariants of envelopes over `pockets`; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate<'p>(
        &self,
        mesh: &Mesh,
        pockets: impl IntoIterator<Item = Pocket<'p>>,
    ) -> Result<(), String> {
        let (mut count, mut faces, mut layers) = (0, 0, 0);
        for pocket in pockets {
            if count >= self.len() {
                return Err(format!("more pockets than the {count} envelopes"));
            }
            layers += self.envelope(count).validate(mesh, &pocket, faces)?;
            faces += pocket.faces.len();
            count += 1;
        }
        if count != self.len() || faces != self.faces.len() || layers != self.layers.len() {
            return Err(format!("{count} pockets with {faces} faces do not make up the arrays"));
        }
        Ok(())
    }
}

impl Envelope<'_> {
    /// Checks one envelope, whose faces begin at `offset` of all; returns the number of its layers.
    fn validate(&self, mesh: &Mesh, pocket: &Pocket, offset: usize) -> Result<usize, String> {
        let end = offset + pocket.faces.len();
        let mut held = self.all.faces.get(offset..end).ok_or("faces are missing")?.to_vec();
        let mut wanted = pocket.faces.to_vec();
        let corners = wanted.iter().flat_map(|&f| mesh.triangle(f));
        if Aabb::of_points(corners.clone()) != *self.bounds() {
            return Err("the box of an envelope is not that of its faces".into());
        }
        for lid in self.lids() {
            if !lid.is_unit() || !corners.clone().all(|p| lid.certainly_holds(p)) {
                return Err(format!("the lid {lid:?} does not hold its pocket"));
            }
        }
        held.sort_unstable();
        wanted.sort_unstable();
        if held != wanted {
            return Err("an envelope holds other faces than its pocket".into());
        }
        let Some(first) = self.first_layer() else {
            return if wanted.is_empty() { Ok(0) } else { Err("faces without a layer".into()) };
        };
        let mut waiting = vec![(first, [offset as u32, end as u32])];
        let mut layers = 0;
        while let Some((layer, range)) = waiting.pop() {
            layers += 1;
            if layers > self.all.layers.len() {
                return Err("layers run in circles".into());
            }
            self.validate_layer(mesh, layer, range, &mut waiting)?;
        }
        Ok(layers)
    }

    /// A layer divides the range of faces of the facet above it.
    fn validate_layer(
        &self,
        mesh: &Mesh,
        layer: LayerId,
        range: [u32; 2],
        waiting: &mut Vec<(LayerId, [u32; 2])>,
    ) -> Result<(), String> {
        let options = self.all.options();
        let facets: Vec<EnvelopeFacetId> = self.all.layer(layer).collect();
        if facets.is_empty() || facets.len() > options.width {
            return Err(format!("layer {} has {} facets", layer.0, facets.len()));
        }
        let mut parts: Vec<[u32; 2]> = facets.iter().map(|&f| self.all.facet(f).faces).collect();
        parts.sort_unstable();
        let mut at = range[0];
        for [start, end] in parts {
            if start != at || end <= start {
                return Err(format!("layer {} does not divide the faces above", layer.0));
            }
            at = end;
        }
        if at != range[1] {
            return Err(format!("layer {} leaves faces out", layer.0));
        }
        let reaches = facets.iter().map(|&f| self.all.facet(f).reach);
        if !reaches.is_sorted_by(|a, b| a >= b) {
            return Err(format!("layer {} is not in order from the cap", layer.0));
        }
        for id in facets {
            let facet = self.all.facet(id);
            self.validate_facet(mesh, id, facet)?;
            let few = self.all.faces_beneath(id).len() <= options.leaf_faces;
            match self.all.layer_beneath(id) {
                Some(next) if !few => waiting.push((next, facet.faces)),
                None if few => {}
                _ => return Err(format!("facet {} has a layer too many or too few", id.0)),
            }
        }
        Ok(())
    }

    fn validate_facet(
        &self,
        mesh: &Mesh,
        id: EnvelopeFacetId,
        facet: &EnvelopeFacet,
    ) -> Result<(), String> {
        let corners = self.all.faces_beneath(id).iter().flat_map(|&f| mesh.triangle(f));
        if Aabb::of_points(corners.clone()) != facet.bounds {
            return Err(format!("the box of facet {} is not that of its faces", id.0));
        }
        let towards_cap = HalfSpace { normal: self.axis(), offset: facet.reach };
        for half_space in [facet.beneath, towards_cap] {
            if !half_space.is_unit() {
                return Err(format!("facet {} has a normal that is no unit vector", id.0));
            }
            if let Some(p) = corners.clone().find(|&p| !half_space.certainly_holds(p)) {
                return Err(format!("{p} sticks out of facet {}", id.0));
            }
        }
        Ok(())
    }
}
