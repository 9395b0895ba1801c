//! The patches of one body that searches come across, in the pair's frame: each patch's nodes, and its leaves when
//! they are opened (`leaf`). What does not depend on the pose is kept from query to query; of the body whose frame
//! the pair's is, that is everything.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{Content, PatchId};

use super::leaf::{Leaves, Outline, Parts, shrink};
use super::oriented::{Oriented, boxes_of};
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

/// A node of a patch's tree.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// A box around its faces, one axis along their mean normal: in the pair's frame, and in the body's.
    oriented: Oriented,
    local: Oriented,
    /// Square of the box's diagonal.
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
    pub(super) fn children(&self) -> Option<&[u32; 2]> {
        (self.children[0] != NONE).then_some(&self.children)
    }

    #[inline]
    pub(super) fn oriented(&self) -> &Oriented {
        &self.oriented
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
            patches: Numbering::default(),
            trees: Vec::new(),
            nodes: Vec::new(),
            leaves: Leaves::new(side),
        }
    }

    /// Begins a query.
    pub(super) fn begin(&mut self) {
        if self.query == u32::MAX {
            *self = Self::new(self.side);
        }
        self.query += 1;
        self.leaves.begin(self.query);
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
                let map = &pair.first_from_second;
                for node in &mut self.nodes[nodes] {
                    node.oriented = node.local.posed(map);
                }
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
        let boxes = boxes_of(pair, self.side, patch);
        for (oriented, name) in boxes.into_iter().zip(root..) {
            let children = match forest.arena().content(name) {
                Content::Inner { left, right } => [left, right].map(|name| start + (name - root)),
                Content::Leaf { .. } => [NONE; 2],
            };
            self.nodes.push(Node {
                oriented,
                local: oriented,
                size: 4.0 * oriented.half.length_squared(),
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
        self.leaves.open(pair, node.leaf);
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
            self.leaves.fill(pair, number, &self.nodes[at as usize].local, ownership);
        }
    }

    /// What a leaf has, which was made.
    #[inline]
    pub(super) fn parts(&self, at: u32) -> Parts<'_> {
        let node = self.node(at);
        self.leaves.parts(node, node.leaf)
    }
}
