//! The patches of one body that a search comes across, in the pair's frame: each patch's nodes when it is first
//! met, each leaf's points when that is first opened, what it has when they do not tell. Kept
//! for one query.

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::{FaceId, PatchId, VertexId};

use super::facet::{Facet, ones};
use super::leaf::{Corner, Leaf, LeafParts, Outline, Parts, Range, Segment};
use super::ownership::Owned;
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};

/// What is not there yet.
const NONE: u32 = u32::MAX;

/// Whether two boxes are more than `reach` apart along some axis.
#[inline]
pub(super) fn are_apart(x: &Aabb, y: &Aabb, reach: f64) -> bool {
    let [along, back] = [y.min - x.max, x.min - y.max];
    let beyond = |gap: DVec3| gap.x > reach || gap.y > reach || gap.z > reach;
    beyond(along) || beyond(back)
}

/// A node of a patch's tree: a box and a ball around its faces, and a plane over them.
pub(super) struct Node {
    /// In the pair's frame: for the second body the box of its posed box.
    pub(super) bounds: Aabb,
    center: DVec3,
    radius: f64,
    pub(super) normal: DVec3,
    pub(super) height: f64,
    /// The number of an opened leaf.
    leaf: u32,
}

impl Node {
    /// A lower bound of the distance between what two nodes hold, but for rounding; `None` where that is beyond
    /// `limit`.
    ///
    /// Boxes and balls tell, and each plane about the other's ball. Planes that face each other tell more: along
    /// the normal n of one, points y below the other's plane, m · y <= g, are as high as
    /// n · y = (n + m) · y − m · y >= (n + m) · y − g, and n + m nearly vanishes.
    #[inline]
    pub(super) fn separation_lower(&self, other: &Self, limit: f64) -> Option<f64> {
        if are_apart(&self.bounds, &other.bounds, limit) {
            return None;
        }
        let touching = self.radius + other.radius + limit;
        if (other.center - self.center).length_squared() > touching * touching {
            return None;
        }
        let over_self = self.normal.dot(other.center) - other.radius - self.height;
        let over_other = other.normal.dot(self.center) - self.radius - other.height;
        if over_self > limit || over_other > limit {
            return None;
        }
        let sum = self.normal + other.normal;
        let (length, heights) = (sum.length(), self.height + other.height);
        let along_self = sum.dot(other.center) - length * other.radius - heights;
        let along_other = sum.dot(self.center) - length * self.radius - heights;
        let most = |x: f64, y: f64| if x > y { x } else { y };
        let lower = most(most(over_self, over_other), most(along_self, along_other));
        (lower <= limit).then_some(lower)
    }
}

impl Node {
    /// Whether all of some points lie higher over the node's plane than `reach`.
    #[inline]
    pub(super) fn is_beneath(&self, points: &[DVec3], reach: f64) -> bool {
        let over = self.height + reach;
        points.iter().all(|p| self.normal.dot(*p) > over)
    }
}

/// A patch's tree among the nodes that are kept.
#[derive(Clone, Copy)]
pub(super) struct PosedTree {
    /// The tree's root in the arena of all patches' trees.
    pub(super) root: u32,
    start: u32,
}

/// How much of a body was posed for a query.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sizes {
    nodes: usize,
    leaves: usize,
    points: usize,
    places: usize,
    parts: usize,
    facets: usize,
    corners: usize,
    edges: usize,
}

/// What of one body was posed.
pub(super) struct Posed {
    side: Side,
    /// Absolute values of the rotation from second to first.
    absolute: DMat3,
    patches: Numbering,
    trees: Vec<Option<PosedTree>>,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    points: Vec<DVec3>,
    parts: Vec<LeafParts>,
    facets: Vec<Facet>,
    corners: Vec<Corner>,
    edges: Vec<Segment>,
    /// Of each face of each opened leaf: where its corners are among the leaf's points.
    places: Vec<[u16; 3]>,
    /// Scratch: the names of a leaf's points.
    names: Vec<VertexId>,
}

impl Posed {
    /// With room for as much as was posed the last time.
    pub(super) fn new(pair: &Pair, side: Side, sizes: Sizes) -> Self {
        let m = pair.first_from_second.linear;
        let Sizes { nodes, leaves, points, places, parts, facets, corners, edges } = sizes;
        Self {
            side,
            absolute: DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs()),
            patches: Numbering::default(),
            trees: Vec::new(),
            nodes: Vec::with_capacity(nodes),
            leaves: Vec::with_capacity(leaves),
            points: Vec::with_capacity(points),
            parts: Vec::with_capacity(parts),
            facets: Vec::with_capacity(facets),
            corners: Vec::with_capacity(corners),
            edges: Vec::with_capacity(edges),
            places: Vec::with_capacity(places),
            names: Vec::new(),
        }
    }

    pub(super) fn side(&self) -> Side {
        self.side
    }

    /// How much was posed.
    pub(super) fn sizes(&self) -> Sizes {
        Sizes {
            nodes: self.nodes.len(),
            leaves: self.leaves.len(),
            points: self.points.len(),
            places: self.places.len(),
            parts: self.parts.len(),
            facets: self.facets.len(),
            corners: self.corners.len(),
            edges: self.edges.len(),
        }
    }

    /// The tree of a patch; `None` where it holds no faces.
    pub(super) fn tree(&mut self, pair: &Pair, patch: PatchId) -> Option<PosedTree> {
        let (number, is_new) = self.patches.number(u64::from(patch.0));
        if !is_new {
            return self.trees[number as usize];
        }
        let patches = pair.model(self.side).patches();
        let forest = patches.trees();
        let start = self.nodes.len() as u32;
        let tree = forest.root(patch.index()).map(|root| PosedTree { root, start });
        self.trees.push(tree);
        let map = &pair.first_from_second;
        for (node, index) in forest.nodes(patch.index()).iter().zip(tree?.root..) {
            let (slab, bounds) = (patches.slab(index), node.bounds);
            let (center, extents) = (bounds.center(), bounds.half_extents());
            let radius = extents.length();
            let posed = match self.side {
                Side::First => Node {
                    bounds,
                    center,
                    radius,
                    normal: slab.normal,
                    height: slab.height,
                    leaf: NONE,
                },
                Side::Second => {
                    let (center, normal) = (map.apply(center), map.apply_vector(slab.normal));
                    let reach = self.absolute * extents;
                    let bounds = Aabb { min: center - reach, max: center + reach };
                    let height = slab.height + normal.dot(map.translation);
                    Node { bounds, center, radius, normal, height, leaf: NONE }
                }
            };
            self.nodes.push(posed);
        }
        tree
    }

    pub(super) fn node(&self, tree: &PosedTree, node: u32) -> &Node {
        &self.nodes[slot((tree, node))]
    }

    /// Opens a leaf: its points are posed if they are not there.
    pub(super) fn open(&mut self, pair: &Pair, at: (&PosedTree, u32)) {
        let (slot, leaf) = (slot(at), at.1);
        if self.nodes[slot].leaf != NONE {
            return;
        }
        self.nodes[slot].leaf = self.leaves.len() as u32;
        let (start, faces) = (self.points.len(), self.places.len() as u32);
        let mut bounds = Aabb::EMPTY;
        self.names.clear();
        for &face in pair.model(self.side).patches().trees().arena().leaf_faces(leaf) {
            self.places.push(pair.mesh(self.side).corners(face).map(|vertex| {
                // Few: to look for it costs less than to pose it again.
                let known = self.names.iter().position(|&known| known == vertex);
                let place = known.unwrap_or_else(|| {
                    let p = pair.position(self.side, vertex);
                    bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
                    self.names.push(vertex);
                    self.points.push(p);
                    self.names.len() - 1
                });
                place as u16
            }));
        }
        // Tighter than the box of a posed box.
        self.nodes[slot].bounds = bounds;
        let points = Range::since(start, self.points.len());
        self.leaves.push(Leaf { points, faces, bounds, parts: NONE });
    }

    /// A leaf that was opened.
    #[inline]
    pub(super) fn outline(&self, at: (&PosedTree, u32)) -> Outline<'_> {
        let node = &self.nodes[slot(at)];
        let leaf = &self.leaves[node.leaf as usize];
        Outline { node, points: leaf.points.of(&self.points), bounds: &leaf.bounds }
    }

    /// Makes what an opened leaf has, if it is not there. `owned` tells what is looked at from its faces.
    pub(super) fn fill(
        &mut self,
        pair: &Pair,
        at: (&PosedTree, u32),
        owned: impl Fn(FaceId) -> Owned,
    ) {
        let side = self.side;
        let leaf = self.nodes[slot(at)].leaf as usize;
        if self.leaves[leaf].parts != NONE {
            return;
        }
        self.leaves[leaf].parts = self.parts.len() as u32;
        let starts = self.sizes();
        let [mut corner_bounds, mut edge_bounds] = [Aabb::EMPTY; 2];
        let Leaf { points, faces: first, .. } = self.leaves[leaf];
        let points = points.of(&self.points);
        let faces = pair.model(side).patches().trees().arena().leaf_faces(at.1);
        for (&face, corners_at) in faces.iter().zip(&self.places[first as usize..]) {
            let places = corners_at.map(|i| points[usize::from(i)]);
            self.facets.push(Facet::of(face, places));
            let Owned { corners, ridges, .. } = owned(face);
            let vertices = pair.mesh(side).corners(face);
            for i in ones(corners) {
                let at = places[i];
                corner_bounds = corner_bounds.union(&Aabb { min: at, max: at });
                self.corners.push(Corner { vertex: vertices[i], at });
            }
            for i in ones(ridges) {
                let ends = [places[i], places[(i + 1) % 3]];
                let bounds = Aabb { min: ends[0].min(ends[1]), max: ends[0].max(ends[1]) };
                edge_bounds = edge_bounds.union(&bounds);
                self.edges.push(Segment { edge: pair.edge(side, face, i), ends, bounds });
            }
        }
        self.parts.push(LeafParts {
            facets: Range::since(starts.facets, self.facets.len()),
            corners: Range::since(starts.corners, self.corners.len()),
            edges: Range::since(starts.edges, self.edges.len()),
            corner_bounds,
            edge_bounds,
        });
    }

    /// What a leaf has, which was made.
    pub(super) fn parts(&self, at: (&PosedTree, u32)) -> Parts<'_> {
        let node = &self.nodes[slot(at)];
        let leaf = &self.leaves[node.leaf as usize];
        let parts = &self.parts[leaf.parts as usize];
        Parts {
            node,
            bounds: &leaf.bounds,
            points: leaf.points.of(&self.points),
            facets: parts.facets.of(&self.facets),
            corners: parts.corners.of(&self.corners),
            corner_bounds: &parts.corner_bounds,
            edges: parts.edges.of(&self.edges),
            edge_bounds: &parts.edge_bounds,
        }
    }
}

/// Where a node of a patch's tree stands among those that are kept.
fn slot((tree, node): (&PosedTree, u32)) -> usize {
    (tree.start + (node - tree.root)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(center: [f64; 3], normal: DVec3, height: f64) -> Node {
        let center = DVec3::from_array(center);
        // As if it held whatever fits into the ball.
        let bounds = Aabb { min: center - DVec3::ONE, max: center + DVec3::ONE };
        Node { bounds, center, radius: 1.0, normal, height, leaf: NONE }
    }

    #[test]
    fn boxes_balls_and_planes_bound_the_gap_between_nodes() {
        let nothing = |x, y| node([x, y, 0.0], DVec3::ZERO, 0.0);
        let beyond = |a: &Node, b: &Node, limit| a.separation_lower(b, limit).is_none();
        // Boxes tell, and across corners balls do.
        let middle = nothing(0.0, 0.0);
        assert!(
            beyond(&middle, &nothing(5.0, 0.0), 2.9) && !beyond(&middle, &nothing(5.0, 0.0), 3.0)
        );
        assert!(
            beyond(&middle, &nothing(3.0, 4.0), 2.9) && !beyond(&middle, &nothing(3.0, 4.0), 3.0)
        );
        // Faces that lie along z = 0 and z = 0.25, looking at each other; their balls overlap.
        let floor = node([0.0; 3], DVec3::Z, 0.0);
        let ceiling = |tilt: DVec3| node([0.5, 0.0, 0.25], (tilt - DVec3::Z).normalize(), -0.25);
        assert_eq!(floor.separation_lower(&ceiling(DVec3::ZERO), 1.0), Some(0.25));
        assert_eq!(ceiling(DVec3::ZERO).separation_lower(&floor, 1.0), Some(0.25));
        assert!(beyond(&floor, &ceiling(DVec3::ZERO), 0.2));
        // A little tilted: what is lost is what the tilt takes within a ball.
        let tilted = floor.separation_lower(&ceiling(0.01 * DVec3::X), 1.0).unwrap();
        assert!((0.23..0.25).contains(&tilted), "{tilted}");
        // Whatever looks the other way is bounded by the plane about its ball.
        let above = node([0.0, 0.0, 1.5], DVec3::Z, 1.5);
        assert_eq!(floor.separation_lower(&above, 1.0), Some(0.5));
        assert!(beyond(&floor, &above, 0.4));
    }
}
