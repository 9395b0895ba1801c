//! Bounds of the wrenches with which contacts of a cluster press.
//!
//! A force of unit length along a normal `n` at a point `p` is the wrench `(n, p × n)`, and the
//! rate at which a motion `(v, ω)` carries the point along the normal is its product with that,
//! `v·n + ω·(p × n)` (Ball, 1900, "A treatise on the theory of screws"). A box of wrenches so
//! bounds how fast anything of a cluster comes nearer to anything else. On a thread that turns
//! along its own helix the product is zero all over a flank, whichever way its normals point: that
//! is what the six coordinates are for, where a cone of normals would say nothing.
//!
//! Normals are those that contacts can have: of a face its own; of a ridge those between its two
//! faces; of a tip those from which all its edges fall away. What is between some directions is a
//! sum of theirs, divided by its length; where each of them makes an angle of cosine `c` or more
//! with their mean, that is between `c` and 1 of a mean of theirs.

use cranny_exact::DVec3;

use super::features::{Share, Tip};
use super::lanes::{LANES, Lanes};
use super::{Cluster, Surface, WideNode};
use crate::ids::{FaceId, HalfEdgeId, VertexId};

/// Number of coordinates of a wrench: those of the force, and of its moment about the tree's
/// origin, in the tree's unit.
pub const WRENCH: usize = 6;

/// What single precision and rounded normals are off by. Smaller: contacts at the bound are lost.
const SPARE: f32 = 1e-5;

/// A box of wrenches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchBox {
    /// The least of each coordinate.
    pub least: [f32; WRENCH],
    /// The greatest of each.
    pub most: [f32; WRENCH],
}

/// Boxes of wrenches side by side.
#[derive(Clone, Copy, Debug)]
pub struct WrenchLanes {
    /// The least of each coordinate.
    pub least: [Lanes; WRENCH],
    /// The greatest of each.
    pub most: [Lanes; WRENCH],
}

impl WrenchBox {
    /// No point is farther from the origin than the unit, so this holds all.
    pub const WHOLE: Self = Self { least: [-1.0 - SPARE; WRENCH], most: [1.0 + SPARE; WRENCH] };

    const NONE: Self = Self { least: [f32::INFINITY; WRENCH], most: [f32::NEG_INFINITY; WRENCH] };

    fn add(&mut self, point: DVec3, normal: DVec3) {
        let moment = point.cross(normal).to_array();
        let wrench = normal.to_array().into_iter().chain(moment);
        for (i, x) in wrench.enumerate() {
            let x = x as f32;
            self.least[i] = self.least[i].min(x - SPARE);
            self.most[i] = self.most[i].max(x + SPARE);
        }
    }

    /// Adds the directions between some, of unit length, at some vertices; whether they are
    /// bounded.
    fn add_between(&mut self, surface: &Surface, borders: &[DVec3], at: &[VertexId]) -> bool {
        let mean = borders.iter().sum::<DVec3>().normalize_or_zero();
        let least = borders.iter().map(|n| n.dot(mean)).fold(1.0, f64::min);
        if least <= f64::from(SPARE) {
            return false;
        }
        for vertex in at {
            let place = surface.places[vertex.index()];
            for &border in borders {
                self.add(place, border);
                self.add(place, border / least);
            }
        }
        true
    }

    fn join(&mut self, other: &Self) {
        for i in 0..WRENCH {
            self.least[i] = self.least[i].min(other.least[i]);
            self.most[i] = self.most[i].max(other.most[i]);
        }
    }

    /// What is beyond all wrenches cannot be; a cluster without normals may press anyhow.
    fn within_all(mut self) -> Self {
        for i in 0..WRENCH {
            self.least[i] = self.least[i].clamp(Self::WHOLE.least[i], Self::WHOLE.most[i]);
            self.most[i] = self.most[i].clamp(Self::WHOLE.least[i], Self::WHOLE.most[i]);
        }
        self
    }
}

impl WrenchLanes {
    pub(super) const NONE: Self =
        Self { least: [Lanes::all(0.0); WRENCH], most: [Lanes::all(0.0); WRENCH] };

    /// One of the boxes.
    #[must_use]
    #[inline]
    pub fn get(&self, lane: usize) -> WrenchBox {
        WrenchBox {
            least: std::array::from_fn(|i| self.least[i].0[lane]),
            most: std::array::from_fn(|i| self.most[i].0[lane]),
        }
    }

    fn set(&mut self, lane: usize, bounds: &WrenchBox) {
        for i in 0..WRENCH {
            self.least[i].0[lane] = bounds.least[i];
            self.most[i].0[lane] = bounds.most[i];
        }
    }
}

/// The box of a cluster's contacts: of its faces, and of the features that are looked at from it.
pub(super) fn of_cluster(
    (surface, tips): (&Surface, &[Tip]),
    faces: &[FaceId],
    share: Share,
) -> WrenchBox {
    let mut found = WrenchBox::NONE;
    for &face in faces {
        let Some(normal) = surface.certain_normal(face) else { return WrenchBox::WHOLE };
        surface.triangle(face).into_iter().for_each(|p| found.add(p, normal));
    }
    for &edge in share.edges {
        let [h, g] = surface.topology.half_edges(edge) else { return WrenchBox::WHOLE };
        // Of faces that contradict each other, the normals say nothing.
        let start = |h: &HalfEdgeId| surface.mesh.corners(h.face())[h.corner()];
        if start(h) == start(g) {
            return WrenchBox::WHOLE;
        }
        let normals: Option<Vec<DVec3>> =
            [h, g].iter().map(|h| surface.certain_normal(h.face())).collect();
        let ends = surface.topology.edges()[edge.index()];
        let is_known =
            normals.is_some_and(|n| found.add_between(surface, &n, &[ends.from, ends.to]));
        if !is_known {
            return WrenchBox::WHOLE;
        }
    }
    for &vertex in share.vertices {
        let is_known = match &tips[vertex.index()] {
            Tip::None => true,
            Tip::Cone(borders) => {
                let borders = outward(surface, vertex, borders);
                found.add_between(surface, &borders, &[vertex])
            }
            Tip::Unknown => false,
        };
        if !is_known {
            return WrenchBox::WHOLE;
        }
    }
    found.within_all()
}

/// Of the borders of a tip's cone those that its faces look along, where the cone is a line: all
/// edges lie in a plane.
fn outward(surface: &Surface, vertex: VertexId, borders: &[DVec3]) -> Vec<DVec3> {
    let line = borders[0];
    if borders.iter().any(|border| border.cross(line).length() > f64::from(SPARE)) {
        return borders.to_vec();
    }
    let around = surface.topology.faces_at(vertex).iter();
    let normal: DVec3 = around.map(|&face| surface.normal(face)).sum();
    borders.iter().copied().filter(|border| border.dot(normal) > 0.0).collect()
}

/// Gives each lane of the nodes, of which each stands before those below it, the box of what it
/// leads to.
pub(super) fn fill_nodes(nodes: &mut [WideNode], clusters: &[Cluster]) {
    for index in (0..nodes.len()).rev() {
        for lane in 0..nodes[index].count as usize {
            let child = nodes[index].children[lane];
            let bounds = match child.is_cluster() {
                true => clusters[child.index()].wrenches,
                false => of_node(&nodes[child.index()]),
            };
            nodes[index].wrenches.set(lane, &bounds);
        }
    }
}

fn of_node(node: &WideNode) -> WrenchBox {
    let mut all = WrenchBox::NONE;
    (0..LANES.min(node.count as usize)).for_each(|lane| all.join(&node.wrenches.get(lane)));
    all
}
