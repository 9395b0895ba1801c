//! The patches of one body that a search comes across, in the pair's frame: each patch's nodes when it is first
//! met, each leaf's corners when that is first opened, each triangle's planes when they are first asked for. Kept
//! for one query.

use cranny_exact::DVec3;
use cranny_geometry::{FaceId, PatchId, Slab};

use super::facet::Facet;
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};

/// A node of a patch's tree: a ball around its box, and the plane over its faces.
pub(super) struct Node {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) normal: DVec3,
    pub(super) height: f64,
    /// Where a leaf's triangles are, once they are posed.
    triangles: Option<[u32; 2]>,
}

impl Node {
    /// A lower bound of the distance between what two nodes hold, but for rounding.
    ///
    /// Balls tell, and each plane about the other's ball. Planes that face each other tell more: along the
    /// normal n of one, points y below the other's plane, m · y <= g, are as high as
    /// n · y = (n + m) · y − m · y >= (n + m) · y − g, and n + m nearly vanishes.
    #[inline]
    pub(super) fn separation_lower(&self, other: &Self) -> f64 {
        let balls = (other.center - self.center).length() - self.radius - other.radius;
        let over_self = self.normal.dot(other.center) - other.radius - self.height;
        let over_other = other.normal.dot(self.center) - self.radius - other.height;
        let sum = self.normal + other.normal;
        let (length, heights) = (sum.length(), self.height + other.height);
        let along_self = sum.dot(other.center) - length * other.radius - heights;
        let along_other = sum.dot(self.center) - length * self.radius - heights;
        balls.max(over_self).max(over_other).max(along_self).max(along_other)
    }
}

/// A patch's tree among the nodes that are kept.
#[derive(Clone, Copy)]
pub(super) struct PosedTree {
    /// The tree's root in the arena of all patches' trees.
    pub(super) root: u32,
    start: u32,
}

/// A posed triangle, and which facet it is, once that is made.
struct Triangle {
    face: FaceId,
    corners: [DVec3; 3],
    facet: Option<u32>,
}

/// What of one body was posed.
pub(super) struct Posed {
    side: Side,
    patches: Numbering,
    trees: Vec<Option<PosedTree>>,
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    facets: Vec<Facet>,
}

impl Posed {
    pub(super) fn new(side: Side) -> Self {
        Self {
            side,
            patches: Numbering::default(),
            trees: Vec::new(),
            nodes: Vec::new(),
            triangles: Vec::new(),
            facets: Vec::new(),
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
        for (node, index) in forest.nodes(patch.index()).iter().zip(tree?.root..) {
            let (slab, center) = (patches.slab(index), node.bounds.center());
            let radius = node.bounds.half_extents().length();
            self.nodes.push(self.posed(pair, slab, center, radius));
        }
        tree
    }

    fn posed(&self, pair: &Pair, slab: &Slab, center: DVec3, radius: f64) -> Node {
        let Slab { normal, height } = *slab;
        let (center, normal, height) = match self.side {
            Side::First => (center, normal, height),
            Side::Second => {
                let map = &pair.first_from_second;
                let normal = map.apply_vector(normal);
                (map.apply(center), normal, height + normal.dot(map.translation))
            }
        };
        Node { center, radius, normal, height, triangles: None }
    }

    pub(super) fn node(&self, tree: &PosedTree, node: u32) -> &Node {
        &self.nodes[(tree.start + (node - tree.root)) as usize]
    }

    /// Lists the facets of a leaf but those whose corners all lie higher than `height` along `normal`.
    pub(super) fn facets_beneath(
        &mut self,
        pair: &Pair,
        (tree, leaf): (&PosedTree, u32),
        (normal, height): (DVec3, f64),
        found: &mut Vec<u32>,
    ) {
        found.clear();
        let [start, end] = self.opened(pair, tree, leaf);
        for triangle in &mut self.triangles[start as usize..end as usize] {
            if triangle.corners.iter().all(|p| normal.dot(*p) > height) {
                continue;
            }
            let facets = &mut self.facets;
            found.push(*triangle.facet.get_or_insert_with(|| {
                let Triangle { face, corners, .. } = *triangle;
                facets.push(Facet::of(face, corners));
                facets.len() as u32 - 1
            }));
        }
    }

    /// Where a leaf's triangles are; poses them, if they are not there.
    fn opened(&mut self, pair: &Pair, tree: &PosedTree, leaf: u32) -> [u32; 2] {
        let slot = &mut self.nodes[(tree.start + (leaf - tree.root)) as usize].triangles;
        *slot.get_or_insert_with(|| {
            let arena = pair.model(self.side).patches().trees().arena();
            let first = self.triangles.len() as u32;
            self.triangles.extend(arena.leaf_faces(leaf).iter().map(|&face| {
                let corners = pair.triangle(self.side, face);
                Triangle { face, corners, facet: None }
            }));
            [first, self.triangles.len() as u32]
        })
    }

    pub(super) fn facet(&self, index: u32) -> &Facet {
        &self.facets[index as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(center: [f64; 3], normal: DVec3, height: f64) -> Node {
        let center = DVec3::from_array(center);
        Node { center, radius: 1.0, normal, height, triangles: None }
    }

    #[test]
    fn balls_and_planes_bound_the_gap_between_nodes() {
        let nothing = |x| node([x, 0.0, 0.0], DVec3::ZERO, 0.0);
        assert_eq!(nothing(0.0).separation_lower(&nothing(5.0)), 3.0);
        // Faces that lie along z = 0 and z = 0.25, looking at each other; their balls overlap.
        let floor = node([0.0; 3], DVec3::Z, 0.0);
        let ceiling = |tilt: DVec3| node([0.5, 0.0, 0.25], (tilt - DVec3::Z).normalize(), -0.25);
        assert_eq!(floor.separation_lower(&ceiling(DVec3::ZERO)), 0.25);
        assert_eq!(ceiling(DVec3::ZERO).separation_lower(&floor), 0.25);
        // A little tilted: what is lost is what the tilt takes within a ball.
        let tilted = floor.separation_lower(&ceiling(0.01 * DVec3::X));
        assert!((0.23..0.25).contains(&tilted), "{tilted}");
        // Whatever looks the other way is bounded by the plane about its ball.
        let above = node([0.0, 0.0, 1.5], DVec3::Z, 1.5);
        assert_eq!(floor.separation_lower(&above), 0.5);
    }
}
