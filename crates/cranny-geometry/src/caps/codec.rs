//! The cap surface as bytes.

use super::CapSurface;
use crate::codec::{Flaw, Reader, Writer, check, check_below, check_rows};
use crate::hull::FacetId;
use crate::ids::CapId;

impl CapSurface {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { triangles, facet_starts, negative, crossed, shared } = self;
        out.list(triangles);
        out.list(facet_starts);
        out.list(negative);
        out.list(crossed);
        out.list(shared);
    }

    /// Reads the caps of `facets` facets over `vertices` vertices.
    pub(crate) fn decode(input: &mut Reader, vertices: usize, facets: usize) -> Result<Self, Flaw> {
        let (triangles, facet_starts): (Vec<[u32; 3]>, Vec<u32>) = (input.list()?, input.list()?);
        let (negative, crossed): (Vec<CapId>, Vec<FacetId>) = (input.list()?, input.list()?);
        let corners = triangles.as_flattened().iter().copied();
        check_below(corners, vertices, "a cap's corner is not there")?;
        check_rows(&facet_starts, facets, triangles.len())?;
        check_below(negative.iter().map(|c| c.0), triangles.len(), "a cap is not there")?;
        check(negative.is_sorted_by(|a, b| a < b), "negative caps are not ascending")?;
        check_below(crossed.iter().map(|f| f.0), facets, "a crossed facet is not there")?;
        check(crossed.is_sorted_by(|a, b| a < b), "crossed facets are not ascending")?;
        let shared: Vec<[u32; 2]> = input.list()?;
        check_below(shared.iter().flatten().copied(), facets, "a shared facet is not there")?;
        check(shared.is_sorted_by(|a, b| a[0] < b[0]), "shared facets are not ascending")?;
        Ok(Self { triangles, facet_starts, negative, crossed, shared })
    }
}
