//! The patches of one body that a search comes across, in the pair's frame: each patch's nodes when it is first
//! met, each leaf's corners when that is first opened, each triangle's planes when they are first asked for. Kept
//! for one query.

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::{FaceId, PatchId};

use super::facet::Facet;
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

/// The box of three points.
#[inline]
fn around([a, b, c]: &[DVec3; 3]) -> Aabb {
    Aabb { min: a.min(*b).min(*c), max: a.max(*b).max(*c) }
}

/// A node of a patch's tree: a box and a ball around its faces, and a plane over them.
pub(super) struct Node {
    /// In the pair's frame: for the second body the box of its posed box.
    bounds: Aabb,
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

/// A leaf's triangles, and a box around them.
#[derive(Clone, Copy)]
struct Leaf {
    triangles: [u32; 2],
    bounds: Aabb,
}

/// A patch's tree among the nodes that are kept.
#[derive(Clone, Copy)]
pub(super) struct PosedTree {
    /// The tree's root in the arena of all patches' trees.
    pub(super) root: u32,
    start: u32,
}

/// A posed triangle, its box, and which facet it is, once that is made.
struct Triangle {
    face: FaceId,
    corners: [DVec3; 3],
    bounds: Aabb,
    facet: u32,
}

/// How much of a body was posed for a query.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sizes {
    nodes: usize,
    leaves: usize,
    triangles: usize,
    facets: usize,
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
    triangles: Vec<Triangle>,
    facets: Vec<Facet>,
}

impl Posed {
    /// With room for as much as was posed the last time.
    pub(super) fn new(pair: &Pair, side: Side, sizes: Sizes) -> Self {
        let m = pair.first_from_second.linear;
        let Sizes { nodes, leaves, triangles, facets } = sizes;
        Self {
            side,
            absolute: DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs()),
            patches: Numbering::default(),
            trees: Vec::new(),
            nodes: Vec::with_capacity(nodes),
            leaves: Vec::with_capacity(leaves),
            triangles: Vec::with_capacity(triangles),
            facets: Vec::with_capacity(facets),
        }
    }

    /// How much was posed.
    pub(super) fn sizes(&self) -> Sizes {
        Sizes {
            nodes: self.nodes.len(),
            leaves: self.leaves.len(),
            triangles: self.triangles.len(),
            facets: self.facets.len(),
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
        &self.nodes[(tree.start + (node - tree.root)) as usize]
    }

    /// Opens a leaf, whose triangles are posed if they are not there; returns the box around them.
    pub(super) fn open(&mut self, pair: &Pair, (tree, leaf): (&PosedTree, u32)) -> Aabb {
        let at = (tree.start + (leaf - tree.root)) as usize;
        if self.nodes[at].leaf == NONE {
            self.nodes[at].leaf = self.leaves.len() as u32;
            let arena = pair.model(self.side).patches().trees().arena();
            let first = self.triangles.len() as u32;
            let mut all = Aabb::EMPTY;
            for &face in arena.leaf_faces(leaf) {
                let corners = pair.triangle(self.side, face);
                let bounds = around(&corners);
                all = all.union(&bounds);
                self.triangles.push(Triangle { face, corners, bounds, facet: NONE });
            }
            // Tighter than the box of a posed box.
            self.nodes[at].bounds = all;
            self.leaves.push(Leaf { triangles: [first, self.triangles.len() as u32], bounds: all });
        }
        self.leaves[self.nodes[at].leaf as usize].bounds
    }

    /// Lists the triangles of an opened leaf that reach into a box, but those whose corners all lie higher than
    /// `height` along `normal`.
    pub(super) fn within(
        &self,
        (tree, leaf): (&PosedTree, u32),
        (bounds, reach): (&Aabb, f64),
        (normal, height): (DVec3, f64),
        found: &mut Vec<(u32, Aabb)>,
    ) {
        found.clear();
        let Leaf { triangles: [start, end], .. } = self.leaves[self.node(tree, leaf).leaf as usize];
        for (i, triangle) in (start..end).zip(&self.triangles[start as usize..end as usize]) {
            if !are_apart(&triangle.bounds, bounds, reach)
                && triangle.corners.iter().any(|p| normal.dot(*p) <= height)
            {
                found.push((i, triangle.bounds));
            }
        }
    }

    /// The facet of a triangle; its number among facets.
    pub(super) fn make_facet(&mut self, triangle: u32) -> usize {
        let slot = &mut self.triangles[triangle as usize];
        if slot.facet == NONE {
            slot.facet = self.facets.len() as u32;
            self.facets.push(Facet::of(slot.face, slot.corners));
        }
        slot.facet as usize
    }

    pub(super) fn facet(&self, index: usize) -> &Facet {
        &self.facets[index]
    }
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
