//! Two box trees, sorted and swept level by level, from frame to frame.

use cranny_exact::{Aabb, DVec3, RigidMap};
use cranny_geometry::{Content, FaceTree};

use super::level::{Level, LevelWork, Member, NodePair};

/// A share of the coordinates' size by which a posed box is grown, for each level beneath it, so
/// that rounding does not part it from what its children meet. Smaller: less than rounding moves a
/// coordinate; larger: boxes that matter.
const SLACK: f64 = 1e-12;

/// The boxes of two trees that overlap. Of each level the children of what has a partner on the one
/// above are *active*; leaves go down with them.
#[derive(Clone, Debug)]
pub(super) struct Levels<'t> {
    trees: [&'t FaceTree; 2],
    levels: Vec<Level>,
    /// The second tree's boxes in the first's frame, of nodes that are active.
    posed: Vec<Aabb>,
    size: f64,
}

impl<'t> Levels<'t> {
    pub(super) fn of(trees: [&'t FaceTree; 2]) -> Self {
        let depth = trees.map(|tree| depth(tree, 0)).into_iter().max().unwrap_or(0);
        let size = |tree: &FaceTree| {
            let bounds = tree.nodes().first().map(|root| root.bounds);
            bounds.map_or(0.0, |b| b.min.abs().max(b.max.abs()).max_element())
        };
        Self {
            trees,
            levels: vec![Level::default(); depth + 1],
            posed: trees[1].nodes().iter().map(|node| node.bounds).collect(),
            size: size(trees[0]) + size(trees[1]),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(Level::bytes).sum();
        levels + self.posed.capacity() * size_of::<Aabb>()
    }

    /// Pairs of leaves whose boxes overlap where the second tree is posed by `map` in the first's
    /// frame.
    pub(super) fn update(&mut self, map: &RigidMap) -> (Vec<NodePair>, LevelWork) {
        let (trees, count) = (self.trees, self.levels.len());
        let size = self.size + map.translation.abs().max_element();
        let mut all = LevelWork::default();
        let mut above: Vec<NodePair> = Vec::new();
        for (number, level) in self.levels.iter_mut().enumerate() {
            let active = if number == 0 {
                trees.map(|tree| if tree.nodes().is_empty() { vec![] } else { vec![0] })
            } else {
                [0, 1].map(|i| children_of(trees[i], above.iter().map(|pair| pair[i])))
            };
            let slack = SLACK * size * (count - number) as f64;
            for &node in &active[1] {
                self.posed[node as usize] = posed(&trees[1].node(node).bounds, map, slack);
            }
            let boxes = &self.posed;
            let of = |of: Member| match of.tree {
                0 => trees[0].node(of.node).bounds,
                _ => boxes[of.node as usize],
            };
            let candidates = || match number {
                0 => vec![[0, 0]],
                _ => above.iter().flat_map(|&pair| pairs_beneath(trees, pair)).collect(),
            };
            let work = level.update(active, of, candidates);
            all += work;
            above = level.pairs().collect();
        }
        (above, all)
    }
}

/// Levels beneath a node.
fn depth(tree: &FaceTree, node: u32) -> usize {
    if tree.nodes().is_empty() {
        return 0;
    }
    match tree.content(node) {
        Content::Inner { left, right } => 1 + depth(tree, left).max(depth(tree, right)),
        Content::Leaf { .. } => 0,
    }
}

pub(super) fn children(tree: &FaceTree, node: u32) -> impl Iterator<Item = u32> + Clone {
    let (first, second) = match tree.content(node) {
        Content::Inner { left, right } => (left, Some(right)),
        Content::Leaf { .. } => (node, None),
    };
    std::iter::once(first).chain(second)
}

/// Ascending, each once.
fn children_of(tree: &FaceTree, nodes: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut parents: Vec<u32> = nodes.collect();
    parents.sort_unstable();
    parents.dedup();
    let mut found: Vec<u32> = parents.into_iter().flat_map(|node| children(tree, node)).collect();
    found.sort_unstable();
    found
}

pub(super) fn pairs_beneath(
    trees: [&FaceTree; 2],
    [a, b]: NodePair,
) -> impl Iterator<Item = NodePair> {
    let second = children(trees[1], b);
    children(trees[0], a).flat_map(move |a| second.clone().map(move |b| [a, b]))
}

/// The box around a posed box, grown by a slack.
pub(super) fn posed(bounds: &Aabb, map: &RigidMap, slack: f64) -> Aabb {
    let middle = map.linear * bounds.center() + map.translation;
    let half = bounds.half_extents();
    let [x, y, z] = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis].map(DVec3::abs);
    let reach = x * half.x + y * half.y + z * half.z + DVec3::splat(slack);
    Aabb { min: middle - reach, max: middle + reach }
}
