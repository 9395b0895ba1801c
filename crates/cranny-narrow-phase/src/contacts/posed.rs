//! The patches of one body that searches come across, in the pair's frame: each patch's nodes, and its leaves when
//! they are opened (`leaf`). What does not depend on the pose is kept from query to query; of the body whose frame
//! the pair's is, that is everything.

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::{Content, PatchId};

use super::facet::is_beneath;
use super::leaf::{Leaves, Outline, Parts, shrink};
use super::ownership::Ownership;
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};

/// What is not there.
const NONE: u32 = u32::MAX;

/// Whether two boxes are more than `reach` apart along some axis.
#[inline]
pub(super) fn are_apart(x: &Aabb, y: &Aabb, reach: f64) -> bool {
    let [along, back] = [y.min - x.max, x.min - y.max];
    let beyond = |gap: DVec3| gap.x > reach || gap.y > reach || gap.z > reach;
    beyond(along) || beyond(back)
}

/// The greater of two numbers that are no NaN.
#[inline]
fn more(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// A node of a patch's tree: a box and a ball around its faces, and a plane over them.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// In the pair's frame: for the second body the box of its posed box.
    pub(super) bounds: Aabb,
    center: DVec3,
    radius: f64,
    normal: DVec3,
    height: f64,
    /// Square of the diagonal of its box, in the body's frame.
    pub(super) size: f64,
    /// Where its children stand; of a leaf `NONE` twice.
    children: [u32; 2],
    /// The node of the arena of all patches' trees.
    name: u32,
    /// The number of a leaf that was met.
    leaf: u32,
}

impl Node {
    /// Where its children stand; `None` for a leaf.
    #[inline]
    pub(super) fn children(&self) -> Option<[u32; 2]> {
        (self.children[0] != NONE).then_some(self.children)
    }

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
        let over = more(over_self, over_other);
        let sum = self.normal + other.normal;
        let squared = sum.length_squared();
        // Less than 120 degrees apart, they tell no more together.
        if squared >= 1.0 {
            return Some(over);
        }
        let (length, heights) = (squared.sqrt(), self.height + other.height);
        let along_self = sum.dot(other.center) - length * other.radius - heights;
        let along_other = sum.dot(self.center) - length * self.radius - heights;
        let lower = more(over, more(along_self, along_other));
        (lower <= limit).then_some(lower)
    }
}

impl Node {
    /// Whether all of some points lie higher over the node's plane than `reach`.
    #[inline]
    pub(super) fn is_beneath(&self, points: &[DVec3], reach: f64) -> bool {
        is_beneath(self.normal, self.height, points, reach)
    }
}

/// A patch's tree among the nodes that are kept; `len` is 0 where it holds no faces.
#[derive(Clone, Copy, Debug)]
struct PosedTree {
    start: u32,
    len: u32,
    /// In which query its nodes were posed.
    posed: u32,
}

/// What is known of one body.
#[derive(Clone, Debug)]
pub(super) struct Posed {
    side: Side,
    query: u32,
    /// Absolute values of the rotation from second to first.
    absolute: DMat3,
    patches: Numbering,
    trees: Vec<PosedTree>,
    nodes: Vec<Node>,
    leaves: Leaves,
}

impl Posed {
    pub(super) fn new(side: Side) -> Self {
        Self {
            side,
            query: 0,
            absolute: DMat3::ZERO,
            patches: Numbering::default(),
            trees: Vec::new(),
            nodes: Vec::new(),
            leaves: Leaves::new(side),
        }
    }

    /// Begins a query.
    pub(super) fn begin(&mut self, pair: &Pair) {
        if self.query == u32::MAX {
            *self = Self::new(self.side);
        }
        self.query += 1;
        self.leaves.begin(self.query);
        let m = pair.first_from_second.linear;
        self.absolute = DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
    }

    /// Ends a query: what is kept is little more than what it met.
    pub(super) fn end(&mut self) {
        if self.leaves.are_stale() {
            *self = Self::new(self.side);
        }
        shrink(&mut self.nodes);
        self.leaves.shrink();
    }

    pub(super) fn bytes(&self) -> usize {
        self.patches.bytes()
            + self.trees.capacity() * size_of::<PosedTree>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.leaves.bytes()
    }

    /// Where the root of a patch's tree stands; `None` where it holds no faces.
    pub(super) fn root(&mut self, pair: &Pair, patch: PatchId) -> Option<u32> {
        let (number, is_new) = self.patches.number(u64::from(patch.0));
        if is_new {
            self.add(pair, patch);
        }
        let tree = &mut self.trees[number as usize];
        if tree.posed != self.query {
            tree.posed = self.query;
            if self.side == Side::Second {
                let nodes = tree.start as usize..(tree.start + tree.len) as usize;
                pose(pair, &self.absolute, &mut self.nodes[nodes]);
            }
        }
        (tree.len > 0).then_some(tree.start)
    }

    /// Takes in the nodes of a patch, in the body's frame.
    fn add(&mut self, pair: &Pair, patch: PatchId) {
        let patches = pair.model(self.side).patches();
        let forest = patches.trees();
        let start = self.nodes.len() as u32;
        let nodes = forest.nodes(patch.index());
        self.trees.push(PosedTree { start, len: nodes.len() as u32, posed: 0 });
        let Some(root) = forest.root(patch.index()) else { return };
        for (node, name) in nodes.iter().zip(root..) {
            let (bounds, slab) = (node.bounds, patches.slab(name));
            let children = match forest.arena().content(name) {
                Content::Inner { left, right } => [left, right].map(|name| start + (name - root)),
                Content::Leaf { .. } => [NONE; 2],
            };
            self.nodes.push(Node {
                bounds,
                center: bounds.center(),
                radius: bounds.half_extents().length(),
                normal: slab.normal,
                height: slab.height,
                size: (bounds.max - bounds.min).length_squared(),
                children,
                name,
                leaf: NONE,
            });
        }
    }

    #[inline]
    pub(super) fn node(&self, at: u32) -> &Node {
        &self.nodes[at as usize]
    }

    /// Opens a leaf: its points are posed if they are not there.
    #[inline]
    pub(super) fn open(&mut self, pair: &Pair, at: u32) {
        let number = self.node(at).leaf;
        if number == NONE || !self.leaves.is_open(number) {
            self.open_anew(pair, at);
        }
    }

    fn open_anew(&mut self, pair: &Pair, at: u32) {
        let node = &mut self.nodes[at as usize];
        if node.leaf == NONE {
            node.leaf = self.leaves.add(pair, node.name);
        }
        // Tighter than the box of a posed box.
        node.bounds = *self.leaves.open(pair, node.leaf);
    }

    /// A leaf that was opened.
    #[inline]
    pub(super) fn outline(&self, at: u32) -> Outline<'_> {
        let node = self.node(at);
        self.leaves.outline(node, node.leaf)
    }

    /// Makes what an opened leaf has, if it is not there. `ownership` tells what is looked at from its faces; without
    /// it nothing is.
    #[inline]
    pub(super) fn fill(&mut self, pair: &Pair, at: u32, ownership: Option<&Ownership>) {
        let number = self.node(at).leaf;
        if !self.leaves.is_filled(number, ownership.is_some()) {
            self.leaves.fill(pair, number, ownership);
        }
    }

    /// What a leaf has, which was made.
    #[inline]
    pub(super) fn parts(&self, at: u32) -> Parts<'_> {
        let node = self.node(at);
        self.leaves.parts(node, node.leaf)
    }
}

/// Poses nodes of the second body.
fn pose(pair: &Pair, absolute: &DMat3, nodes: &mut [Node]) {
    let patches = pair.model(Side::Second).patches();
    let (map, arena) = (&pair.first_from_second, patches.trees().arena());
    for node in nodes {
        let (slab, bounds) = (patches.slab(node.name), &arena.node(node.name).bounds);
        node.center = map.apply(bounds.center());
        let reach = *absolute * bounds.half_extents();
        node.bounds = Aabb { min: node.center - reach, max: node.center + reach };
        node.normal = map.apply_vector(slab.normal);
        node.height = slab.height + node.normal.dot(map.translation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(center: [f64; 3], normal: DVec3, height: f64) -> Node {
        let center = DVec3::from_array(center);
        // As if it held whatever fits into the ball.
        let bounds = Aabb { min: center - DVec3::ONE, max: center + DVec3::ONE };
        Node {
            bounds,
            center,
            radius: 1.0,
            normal,
            height,
            size: 12.0,
            children: [NONE; 2],
            name: 0,
            leaf: NONE,
        }
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
