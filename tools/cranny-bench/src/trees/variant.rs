//! Trees of several kinds over the same faces, for comparison only; the product builds one kind.

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::{FaceId, Mesh};

/// How a set of faces is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// Into octants of its box, by centroids.
    Octree,
    /// Into halves of equal number, along the longest side.
    Median,
    /// Where the sum of surface times number is least, over 16 bins along the longest side.
    SurfaceArea,
}

/// A kind of tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    pub(crate) rule: Rule,
    /// Children of a node at most; octrees have 8.
    pub(crate) arity: usize,
    /// Boxes along the axes of the body, or of their own faces.
    pub(crate) oriented: bool,
    pub(crate) leaf_size: usize,
}

/// A box: `center + axes · [-half, half]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Volume {
    pub(crate) center: DVec3,
    pub(crate) half: DVec3,
    pub(crate) axes: DMat3,
}

#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) volume: Volume,
    pub(crate) children: Vec<u32>,
    /// Range of faces, where there are no children.
    pub(crate) faces: [usize; 2],
}

#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) faces: Vec<FaceId>,
    pub(crate) kind: Kind,
}

impl Tree {
    pub(crate) fn build(mesh: &Mesh, kind: Kind) -> Self {
        let faces: Vec<FaceId> = (0..mesh.faces().len() as u32).map(FaceId).collect();
        let mut tree = Self { nodes: Vec::new(), faces, kind };
        let boxes: Vec<Aabb> =
            tree.faces.iter().map(|&f| Aabb::of_points(mesh.triangle(f))).collect();
        let count = boxes.len();
        tree.add(mesh, &boxes, 0, count);
        tree
    }

    /// What it would take with a box of `f64` and the places of the children a node.
    pub(crate) fn bytes(&self) -> usize {
        let volume = if self.kind.oriented { 15 * 8 } else { 6 * 8 };
        self.nodes.len() * (volume + 8) + self.faces.len() * 4
    }

    fn add(&mut self, mesh: &Mesh, boxes: &[Aabb], start: usize, end: usize) -> u32 {
        let id = self.nodes.len();
        let volume = self.volume(mesh, boxes, start, end);
        self.nodes.push(Node { volume, children: Vec::new(), faces: [start, end] });
        if end - start > self.kind.leaf_size {
            let parts = self.parts(boxes, start, end);
            let children = parts.into_iter().map(|[a, b]| self.add(mesh, boxes, a, b)).collect();
            self.nodes[id].children = children;
        }
        id as u32
    }

    /// The ranges of the children: the largest part is divided until there are enough.
    fn parts(&mut self, boxes: &[Aabb], start: usize, end: usize) -> Vec<[usize; 2]> {
        if self.kind.rule == Rule::Octree {
            return self.octants(boxes, start, end);
        }
        let mut parts = vec![[start, end]];
        while parts.len() < self.kind.arity {
            let size = |part: &[usize; 2]| {
                let divisible = part[1] - part[0] > self.kind.leaf_size;
                if divisible { surface(&self.bounds(boxes, *part)) } else { -1.0 }
            };
            let largest =
                (0..parts.len()).max_by(|&i, &j| size(&parts[i]).total_cmp(&size(&parts[j])));
            let Some(i) = largest.filter(|&i| size(&parts[i]) >= 0.0) else { break };
            let [a, b] = parts[i];
            let middle = self.divide(boxes, a, b);
            parts.splice(i..=i, [[a, middle], [middle, b]]);
        }
        parts
    }

    fn bounds(&self, boxes: &[Aabb], [a, b]: [usize; 2]) -> Aabb {
        self.faces[a..b].iter().fold(Aabb::EMPTY, |u, f| u.union(&boxes[f.index()]))
    }

    fn octants(&mut self, boxes: &[Aabb], start: usize, end: usize) -> Vec<[usize; 2]> {
        let middle = |f: FaceId| boxes[f.index()].center();
        let all = Aabb::of_points(self.faces[start..end].iter().map(|&f| middle(f)));
        let center = all.center();
        let octant = |f: FaceId| {
            let above = middle(f).cmpgt(center);
            above.bitmask()
        };
        self.faces[start..end].sort_by_key(|&f| octant(f));
        let mut parts: Vec<[usize; 2]> = Vec::new();
        for i in start..end {
            if i == start || octant(self.faces[i]) != octant(self.faces[i - 1]) {
                parts.push([i, i]);
            }
            if let Some(part) = parts.last_mut() {
                part[1] = i + 1;
            }
        }
        if parts.len() == 1 {
            let middle = (start + end) / 2;
            return vec![[start, middle], [middle, end]];
        }
        parts
    }

    fn divide(&mut self, boxes: &[Aabb], a: usize, b: usize) -> usize {
        let middle = |f: FaceId| boxes[f.index()].center();
        let all = Aabb::of_points(self.faces[a..b].iter().map(|&f| middle(f)));
        let axis = (all.max - all.min).max_position();
        self.faces[a..b].sort_by(|&f, &g| middle(f)[axis].total_cmp(&middle(g)[axis]));
        let half = (a + b) / 2;
        if self.kind.rule == Rule::Median || b - a < 3 {
            return half;
        }
        let cut = |k: usize| {
            let at = all.min[axis] + (all.max - all.min)[axis] * k as f64 / 16.0;
            a + self.faces[a..b].partition_point(|&f| middle(f)[axis] < at)
        };
        let cost = |m: usize| {
            let side =
                |part: [usize; 2]| surface(&self.bounds(boxes, part)) * (part[1] - part[0]) as f64;
            side([a, m]) + side([m, b])
        };
        (1..16)
            .map(cut)
            .filter(|&m| m > a && m < b)
            .map(|m| (cost(m), m))
            .min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)))
            .map_or(half, |best| best.1)
    }

    fn volume(&self, mesh: &Mesh, boxes: &[Aabb], a: usize, b: usize) -> Volume {
        if !self.kind.oriented {
            let bounds = self.bounds(boxes, [a, b]);
            let (center, half) = (bounds.center(), bounds.half_extents());
            return Volume { center, half, axes: DMat3::IDENTITY };
        }
        let corners: Vec<DVec3> = self.faces[a..b].iter().flat_map(|&f| mesh.triangle(f)).collect();
        let axes = principal_axes(&corners);
        let bounds = Aabb::of_points(corners.iter().map(|&p| axes.transpose() * p));
        let slack = DVec3::splat(BOX_SLACK * mesh.bounds().diagonal());
        Volume { center: axes * bounds.center(), half: bounds.half_extents() + slack, axes }
    }
}

/// What turning into a box's frame and back rounds at most, as a share of the mesh's diagonal,
/// amply. Smaller, and a box misses its faces by an ulp; larger, and it is wider than need be.
const BOX_SLACK: f64 = 1e-12;

fn surface(b: &Aabb) -> f64 {
    let e = b.max - b.min;
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// Eigenvectors of the covariance, by Jacobi's rotations.
fn principal_axes(points: &[DVec3]) -> DMat3 {
    let mean = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut m = DMat3::ZERO;
    for d in points.iter().map(|&p| p - mean) {
        m += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let mut axes = DMat3::IDENTITY;
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.col(q)[p];
            if off.abs() <= f64::EPSILON * (m.col(p)[p].abs() + m.col(q)[q].abs()) {
                continue;
            }
            let theta = (m.col(q)[q] - m.col(p)[p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = c;
            turn.col_mut(q)[q] = c;
            turn.col_mut(q)[p] = c * t;
            turn.col_mut(p)[q] = -c * t;
            m = turn.transpose() * m * turn;
            axes *= turn;
        }
    }
    axes
}
