//! A body as the verifier sees it: triangles, and how they hang together.

use std::cmp::Ordering;
use std::collections::HashMap;

use crate::exact::{Grid, Vector, cross, dot, is_zero, minus, normal, sign};
use crate::groups::Groups;

/// Triangles of a mesh as it was filed, each vertex by its number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Positions, finite.
    pub vertices: Vec<[f64; 3]>,
    /// Three numbers of vertices each.
    pub faces: Vec<[u32; 3]>,
}

/// A motion as the pair query applies it: `linear * p + translation`, rounded to `f64` after each
/// product and each sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Three rows of four: the linear part, and the translation last.
    pub(crate) rows: [[f64; 4]; 3],
}

impl Motion {
    pub(crate) fn of(map: &[f64; 12]) -> Self {
        Self { rows: std::array::from_fn(|i| std::array::from_fn(|j| map[4 * i + j])) }
    }

    fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.rows.map(|[a, b, c, t]| ((a * x + b * y) + c * z) + t)
    }
}

impl Triangles {
    pub(crate) fn moved(&self, motion: &Motion) -> Self {
        let vertices = self.vertices.iter().map(|&p| motion.apply(p)).collect();
        Self { vertices, faces: self.faces.clone() }
    }

    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.vertices.iter().flatten().copied()
    }

    pub(crate) fn are_finite(&self) -> bool {
        self.numbers().all(f64::is_finite)
    }
}

/// A body on the grid of its pair.
#[derive(Clone, Debug)]
pub struct Body {
    pub(crate) vertices: Vec<Vector>,
    /// The place of each vertex: vertices in one place have one number.
    places: Vec<u32>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) groups: Groups,
    /// Of each face, the least face that hangs together with it over edges.
    component: Vec<u32>,
    /// Whether every edge of the component of a face is run as often forth as back.
    closed: Vec<bool>,
}

impl Body {
    /// `filed` gives the groups, so that they do not depend on where the body is.
    pub(crate) fn new(filed: &Triangles, placed: &Triangles, grid: Grid) -> Self {
        let vertices: Vec<Vector> = placed.vertices.iter().map(|&p| grid.vector(p)).collect();
        let mut number = HashMap::new();
        let mut place = |p: &[f64; 3]| {
            let count = number.len() as u32;
            // Zeros of both signs are one place.
            *number.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(count)
        };
        let places: Vec<u32> = filed.vertices.iter().map(&mut place).collect();
        let mut body = Self {
            vertices,
            places,
            faces: filed.faces.clone(),
            groups: Groups::of(filed),
            component: Vec::new(),
            closed: Vec::new(),
        };
        body.connect();
        body
    }

    /// Corners of a face.
    pub(crate) fn triangle(&self, face: u32) -> [Vector; 3] {
        self.faces[face as usize].map(|v| self.vertices[v as usize].clone())
    }

    /// Whether a face belongs to a component that bounds a region of space.
    pub(crate) fn bounds_space(&self, face: u32) -> bool {
        self.closed[face as usize]
    }

    /// Whether all components do.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed.iter().all(|&closed| closed)
    }

    /// The ends of the edges of a face, as places, lesser first, and whether it runs them so.
    pub(crate) fn edges(&self, face: u32) -> [([u32; 2], bool); 3] {
        let corners = self.faces[face as usize].map(|v| self.places[v as usize]);
        std::array::from_fn(|i| {
            let [p, q] = [corners[i], corners[(i + 1) % 3]];
            ([p.min(q), p.max(q)], p < q)
        })
    }

    /// One face of each set of those faces, out of some, that hang together over edges.
    pub(crate) fn representatives(&self, of: impl Fn(u32) -> bool) -> Vec<u32> {
        let roots = self.joined(&of);
        (0..self.faces.len() as u32).filter(|&f| of(f) && roots[f as usize] == f).collect()
    }

    /// The least face that each of some faces hangs together with.
    fn joined(&self, of: &impl Fn(u32) -> bool) -> Vec<u32> {
        let mut root: Vec<u32> = (0..self.faces.len() as u32).collect();
        let mut at_edge: HashMap<[u32; 2], u32> = HashMap::new();
        for face in (0..self.faces.len() as u32).filter(|&f| of(f)) {
            for (edge, _) in self.edges(face).into_iter().filter(|([p, q], _)| p != q) {
                let other = *at_edge.entry(edge).or_insert(face);
                let (a, b) = (find(&mut root, face), find(&mut root, other));
                root[a.max(b) as usize] = a.min(b);
            }
        }
        (0..root.len() as u32).map(|face| find(&mut root, face)).collect()
    }

    fn connect(&mut self) {
        self.component = self.joined(&|_| true);
        let mut balance: HashMap<[u32; 2], (i64, u32)> = HashMap::new();
        for face in 0..self.faces.len() as u32 {
            for (edge, forth) in self.edges(face).into_iter().filter(|([p, q], _)| p != q) {
                balance.entry(edge).or_insert((0, face)).0 += if forth { 1 } else { -1 };
            }
        }
        let mut open = vec![false; self.faces.len()];
        for (_, face) in balance.into_values().filter(|&(sum, _)| sum != 0) {
            open[self.component[face as usize] as usize] = true;
        }
        self.closed = self.component.iter().map(|&root| !open[root as usize]).collect();
    }
}

fn find(root: &mut [u32], mut face: u32) -> u32 {
    while root[face as usize] != face {
        root[face as usize] = root[root[face as usize] as usize];
        face = root[face as usize];
    }
    face
}

/// Whether two triangles share a point that is inside both, off their planes' common directions:
/// each has corners strictly on both sides of the other's plane, and what the two cut out of the
/// planes' common line overlaps in more than a point.
pub(crate) fn cross_each_other(a: &[Vector; 3], b: &[Vector; 3]) -> bool {
    let (n, m) = (normal(a), normal(b));
    let line = cross(&n, &m);
    if is_zero(&line) {
        return false;
    }
    let (Some(p), Some(q)) = (cut(a, &b[0], &m, &line), cut(b, &a[0], &n, &line)) else {
        return false;
    };
    p[0] < q[1] && q[0] < p[1]
}

/// Where the sides of a triangle pass a plane, measured along a line in that plane; `None` where
/// the triangle has not corners on both sides.
fn cut(
    triangle: &[Vector; 3],
    origin: &Vector,
    plane: &Vector,
    line: &Vector,
) -> Option<[dashu_ratio::RBig; 2]> {
    let heights = triangle.each_ref().map(|p| dot(plane, &minus(p, origin)));
    let has = |order: Ordering| heights.iter().any(|h| sign(h) == order);
    if !has(Ordering::Less) || !has(Ordering::Greater) {
        return None;
    }
    let along = triangle.each_ref().map(|p| dot(line, p));
    let mut places = Vec::new();
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (from, to) = (&heights[i], &heights[j]);
        if sign(from) == sign(to) {
            continue;
        }
        // (along_i * to - along_j * from) / (to - from), where the side passes the plane.
        let (top, below) = (&along[i] * to - &along[j] * from, to - from);
        places.push(dashu_ratio::RBig::from(top) / dashu_ratio::RBig::from(below));
    }
    let least = places.iter().min()?.clone();
    Some([least, places.into_iter().max()?])
}
