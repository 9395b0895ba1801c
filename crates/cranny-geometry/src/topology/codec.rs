//! Adjacency as bytes: the order of half-edges, components in runs.

use super::Topology;
use super::components::components_of_runs;
use super::edges::Edges;
use crate::codec::{Flaw, Reader, Writer, check, check_below};
use crate::ids::{FaceId, HalfEdgeId};
use crate::mesh::Mesh;
use crate::on_demand::OnDemand;

impl Topology {
    /// Writes what takes time to find: the order of half-edges, and how many faces in a row are of
    /// one component.
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self {
            around,
            component_of,
            vertices: _,
            faces_at: _,
            edges: _,
            starts: _,
            edge_of: _,
            is_paired: _,
            components,
        } = self;
        out.list(around);
        let runs = component_of.chunk_by(|a, b| a == b);
        let mut runs: Vec<[u32; 2]> = runs.map(|run| [run[0].0, run.len() as u32]).collect();
        if let [one] = components.as_slice() {
            runs = vec![[0, one.faces]];
        }
        out.list(&runs);
    }

    /// Reads the adjacency of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let (around, runs): (Vec<HalfEdgeId>, Vec<[u32; 2]>) = (input.list()?, input.list()?);
        let count = 3 * mesh.faces().len();
        check(around.len() == count, "it is not one of all half-edges")?;
        check_below(around.iter().map(|h| h.0), count, "a half-edge is not there")?;
        let components = components_of_runs(&runs, mesh.faces().len())?;
        let component_of = components.0.as_slice();
        let mut is_one = true;
        // As many half-edges as there are, strictly ascending: each once.
        let edges = if components.1.len() == 1 {
            Edges::of(mesh, &around, |_, _| ())
        } else {
            let join = |g: FaceId, h: FaceId| {
                is_one &= component_of[g.index()] == component_of[h.index()];
            };
            Edges::of(mesh, &around, join)
        };
        check(edges.is_sorted, "half-edges are not sorted")?;
        check(is_one, "an edge joins two components")?;
        Ok(Self::assembled(around, edges, (mesh.vertices().len(), OnDemand::default()), components))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{points, tetrahedron};
    use super::*;

    #[test]
    fn an_edge_does_not_join_two_components() {
        let mesh = Mesh::new(points(4), tetrahedron(0)).unwrap();
        let whole = Topology::of(&mesh);
        let read = |runs: &[[u32; 2]]| {
            let mut out = Writer::default();
            out.list(&whole.around);
            out.list(runs);
            let read = Topology::decode(&mut Reader::new(&out.into_bytes()), &mesh);
            read.map_err(|Flaw(what)| what)
        };
        assert_eq!(read(&[[0, 4]]).unwrap().components(), whole.components());
        assert!(read(&[[0, 3], [1, 1]]).unwrap_err().contains("joins two"));
    }
}
