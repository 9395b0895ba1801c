//! A binary tree of axis-aligned boxes over the faces, in the body's frame.
//!
//! Built top-down by the surface-area heuristic on binned centroids (Wald 2007). Boxes hold their
//! faces exactly: the ends are vertex coordinates, no arithmetic is done on them. Nodes lie in
//! depth-first order, the left child right behind its parent.

use cranny_exact::{Aabb, DVec3};

use crate::ids::FaceId;
use crate::mesh::Mesh;

/// A node: a box, and what it holds.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Holds every face beneath.
    pub bounds: Aabb,
    content: u32,
    count: u32,
}

/// What a node holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Two children, as node indices.
    Inner {
        /// First child.
        left: u32,
        /// Second child.
        right: u32,
    },
    /// Faces: a range of [`FaceTree::faces`].
    Leaf {
        /// First.
        start: u32,
        /// One past the last.
        end: u32,
    },
}

/// A tree over all faces of a mesh.
#[derive(Clone, Debug)]
pub struct FaceTree {
    nodes: Vec<Node>,
    faces: Vec<FaceId>,
}

/// Bins per split. Fewer: worse trees; more: slower building for less than 1 % fewer tests.
const BINS: usize = 16;

impl FaceTree {
    /// Builds a tree whose leaves hold at most `leaf_size >= 1` faces, in O(n log n).
    #[must_use]
    pub fn of(mesh: &Mesh, leaf_size: usize) -> Self {
        let boxes: Vec<Aabb> = (0..mesh.faces().len() as u32)
            .map(|f| Aabb::of_points(mesh.triangle(FaceId(f))))
            .collect();
        let mut faces: Vec<FaceId> = (0..boxes.len() as u32).map(FaceId).collect();
        let mut tree = Self { nodes: Vec::with_capacity(2 * boxes.len()), faces: Vec::new() };
        let leaf_size = leaf_size.max(1);
        let mut stack = vec![(0usize, faces.len(), None::<usize>)];
        while let Some((start, end, parent)) = stack.pop() {
            let id = tree.nodes.len();
            if let Some(parent) = parent {
                // The right child: the left one stands right behind its parent.
                tree.nodes[parent].content = id as u32;
            }
            let slice = &mut faces[start..end];
            let bounds = slice.iter().fold(Aabb::EMPTY, |b, f| b.union(&boxes[f.index()]));
            if slice.len() <= leaf_size {
                tree.nodes.push(Node { bounds, content: start as u32, count: slice.len() as u32 });
                continue;
            }
            tree.nodes.push(Node { bounds, content: 0, count: 0 });
            let middle = start + split(slice, &boxes);
            stack.push((middle, end, Some(id)));
            stack.push((start, middle, None));
        }
        tree.faces = faces;
        tree
    }

    /// All nodes; the root is node 0.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Faces in leaf order.
    #[must_use]
    pub fn faces(&self) -> &[FaceId] {
        &self.faces
    }

    /// A node by index.
    #[must_use]
    pub fn node(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    /// What a node holds.
    #[must_use]
    pub fn content(&self, index: u32) -> Content {
        let node = self.node(index);
        if node.count == 0 {
            Content::Inner { left: index + 1, right: node.content }
        } else {
            Content::Leaf { start: node.content, end: node.content + node.count }
        }
    }

    /// The faces of a leaf; none for an inner node.
    #[must_use]
    pub fn leaf_faces(&self, index: u32) -> &[FaceId] {
        match self.content(index) {
            Content::Inner { .. } => &[],
            Content::Leaf { start, end } => &self.faces[start as usize..end as usize],
        }
    }

    /// Calls `visit` with every face whose leaf passes `keep`; a box that fails is not opened.
    pub fn visit(&self, mut keep: impl FnMut(&Aabb) -> bool, mut visit: impl FnMut(FaceId)) {
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            if !keep(&self.node(index).bounds) {
                continue;
            }
            match self.content(index) {
                Content::Inner { left, right } => stack.extend([right, left]),
                Content::Leaf { start, end } => {
                    self.faces[start as usize..end as usize].iter().copied().for_each(&mut visit);
                }
            }
        }
    }

    /// Checks the invariants; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(&self, mesh: &Mesh) -> Result<(), String> {
        let mut seen = vec![0u32; mesh.faces().len()];
        let mut stack = vec![0u32];
        let mut visited = 0;
        while let Some(index) = stack.pop() {
            visited += 1;
            let bounds = self.node(index).bounds;
            match self.content(index) {
                Content::Inner { left, right } => {
                    for child in [left, right] {
                        if bounds.union(&self.node(child).bounds) != bounds {
                            return Err(format!("node {child} sticks out of node {index}"));
                        }
                        stack.push(child);
                    }
                }
                Content::Leaf { .. } => {
                    for &face in self.leaf_faces(index) {
                        seen[face.index()] += 1;
                        if !mesh.triangle(face).iter().all(|&p| bounds.contains_point(p)) {
                            return Err(format!("face {} sticks out of node {index}", face.0));
                        }
                    }
                }
            }
        }
        if visited != self.nodes.len() {
            return Err(format!("{visited} of {} nodes can be reached", self.nodes.len()));
        }
        match seen.iter().position(|&n| n != 1) {
            Some(face) => Err(format!("face {face} stands in {} leaves", seen[face])),
            None => Ok(()),
        }
    }
}

/// Orders the slice so that its two parts are cheap to keep apart; returns where the second begins.
fn split(faces: &mut [FaceId], boxes: &[Aabb]) -> usize {
    let center = |f: FaceId| boxes[f.index()].center();
    let centers = Aabb::of_points(faces.iter().map(|&f| center(f)));
    let extent = centers.max - centers.min;
    let axis = extent.max_position();
    if extent[axis] > 0.0 {
        let scale = BINS as f64 / extent[axis];
        let bin =
            |f: FaceId| (((center(f)[axis] - centers.min[axis]) * scale) as usize).min(BINS - 1);
        if let Some(cut) = cheapest_cut(faces, boxes, bin) {
            let middle = partition(faces, |f| bin(f) < cut);
            if middle > 0 && middle < faces.len() {
                return middle;
            }
        }
        let middle = faces.len() / 2;
        faces.select_nth_unstable_by(middle, |&f, &g| {
            center(f)[axis].total_cmp(&center(g)[axis]).then(f.cmp(&g))
        });
        return middle;
    }
    faces.len() / 2
}

/// The bin before which to cut so that the sum of area times count is least.
fn cheapest_cut(faces: &[FaceId], boxes: &[Aabb], bin: impl Fn(FaceId) -> usize) -> Option<usize> {
    let mut bins = [(Aabb::EMPTY, 0usize); BINS];
    for &f in faces {
        let (bounds, count) = &mut bins[bin(f)];
        *bounds = bounds.union(&boxes[f.index()]);
        *count += 1;
    }
    let mut right = [0.0; BINS];
    let (mut bounds, mut count) = (Aabb::EMPTY, 0);
    for i in (1..BINS).rev() {
        bounds = bounds.union(&bins[i].0);
        count += bins[i].1;
        right[i] = half_area(&bounds) * count as f64;
    }
    let (mut bounds, mut count) = (Aabb::EMPTY, 0);
    let mut best = None;
    for cut in 1..BINS {
        bounds = bounds.union(&bins[cut - 1].0);
        count += bins[cut - 1].1;
        let cost = half_area(&bounds) * count as f64 + right[cut];
        if count > 0 && count < faces.len() && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, cut));
        }
    }
    best.map(|(_, cut)| cut)
}

fn half_area(b: &Aabb) -> f64 {
    if b.is_empty() {
        return 0.0;
    }
    let e: DVec3 = b.max - b.min;
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// Moves what satisfies `first` to the front, both parts in their old order; returns their border.
fn partition(faces: &mut [FaceId], first: impl Fn(FaceId) -> bool) -> usize {
    let (front, back): (Vec<FaceId>, Vec<FaceId>) = faces.iter().partition(|&&f| first(f));
    faces[..front.len()].copy_from_slice(&front);
    faces[front.len()..].copy_from_slice(&back);
    front.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(count: u32) -> Mesh {
        let vertices =
            (0..count + 2).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        Mesh::new(vertices, (0..count).map(|i| [i, i + 1, i + 2]).collect()).unwrap()
    }

    #[test]
    fn every_face_stands_in_one_leaf() {
        for (count, leaf) in [(1, 1), (2, 1), (7, 2), (1000, 1), (1000, 4)] {
            let mesh = strip(count);
            let tree = FaceTree::of(&mesh, leaf);
            tree.validate(&mesh).unwrap();
            assert!((0..tree.nodes().len() as u32).all(|n| tree.leaf_faces(n).len() <= leaf));
        }
    }

    #[test]
    fn coincident_faces_are_split_by_number() {
        let mesh = Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]; 9]).unwrap();
        let tree = FaceTree::of(&mesh, 2);
        tree.validate(&mesh).unwrap();
        assert!(tree.nodes().len() > 1);
    }

    #[test]
    fn a_visit_opens_only_what_is_kept() {
        let tree = FaceTree::of(&strip(1000), 1);
        let mut found = Vec::new();
        let window = Aabb { min: DVec3::new(10.5, -1.0, -1.0), max: DVec3::new(10.6, 2.0, 1.0) };
        tree.visit(|b| b.overlaps(&window), |f| found.push(f.0));
        found.sort_unstable();
        assert_eq!(found, [9, 10]);
    }
}
