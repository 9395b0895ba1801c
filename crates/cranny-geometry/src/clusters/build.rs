//! The tree over clusters: eight boxes a node, divided from the top.
//!
//! A set is cut in two until there are eight parts, the largest first; where it is cut is what
//! leaves the least area of boxes, each weighed by the clusters in it (the surface area heuristic
//! of MacDonald and Booth, 1990): by places, or by normals, which part the flanks of a thread.
//! Which way points spread is added up over clusters; only the box along it looks at the points.
//! Cost: O(n log n) sorting, and for each level up to twelve boxes over the points of sets of up to
//! 256 clusters, 36 where there are no more than 24.

use cranny_exact::{Aabb, DVec3};

use super::lanes::{LANES, Lanes, Lanes3};
use super::oriented::{
    Frame, OrientedBox, PointPair, Spread, best_frame, frame_across, frame_along, half_area_along,
    is_less,
};
use super::wrenches::WrenchLanes;
use super::{Child, Surface, WideNode, grow};
use crate::ids::{FaceId, VertexId};

/// Sets of more clusters than this are cut in the middle of their longest extent: there, boxes
/// along normals say nothing. Larger: building takes longer; smaller: flanks are parted later.
const MOST_BY_NORMALS: usize = 256;

/// Sets of more than this are cut in the middle, along whatever cuts best; smaller ones also at a
/// third. Larger: building takes longer, for nodes that are hardly better.
const MOST_BY_THIRDS: usize = 24;

/// A cut replaces another if its weight is below this share of the best so far. Larger: rounding
/// chooses; smaller: worse cuts stay because they came first.
const BETTER: f64 = 0.999;

/// Normals of a set whose sum is shorter than this share of their number cancel: those of a cube in
/// single precision leave 3e-8. Smaller: what rounding left of them is taken for a direction;
/// larger: boxes of nearly closed sets lie along the body's axes.
const CANCELLED: f64 = 1e-6;

/// What the tree is made of.
pub(super) struct Built {
    pub(super) root: OrientedBox,
    pub(super) nodes: Vec<WideNode>,
    /// The group of each cluster, in the order of the tree.
    pub(super) order: Vec<usize>,
    /// The box of each cluster, in that order.
    pub(super) bounds: Vec<OrientedBox>,
}

/// A cluster to be put into the tree.
struct Item {
    group: usize,
    /// Where its corners are among the builder's pairs of points.
    points: [usize; 2],
    spread: Spread,
    /// Its box along the body's axes.
    aligned: Aabb,
    center: DVec3,
    normal: DVec3,
    bounds: OrientedBox,
}

#[derive(Default)]
struct Builder {
    points: Vec<PointPair>,
    items: Vec<Item>,
    nodes: Vec<WideNode>,
    order: Vec<usize>,
    bounds: Vec<OrientedBox>,
    /// Scratch.
    keyed: Vec<(i64, u32)>,
}

pub(super) fn build(surface: &Surface, groups: &[Vec<FaceId>]) -> Built {
    let mut builder = Builder::default();
    for (group, faces) in groups.iter().enumerate() {
        builder.take(surface, group, faces);
    }
    let mut all: Vec<u32> = (0..groups.len() as u32).collect();
    let root = builder.bounds_of(&all);
    builder.grow(&mut all);
    let Builder { nodes, order, bounds, .. } = builder;
    Built { root, nodes, order, bounds }
}

impl Builder {
    fn take(&mut self, surface: &Surface, group: usize, faces: &[FaceId]) {
        let start = self.points.len();
        let vertices = surface.vertices_of(faces);
        self.points.extend(surface.points_at(&vertices));
        let points = &self.points[start..];
        let places = || vertices.iter().map(|v| surface.places[v.index()]);
        let spread = Spread::of(places());
        let normal = grow::mean(surface, faces);
        let frame = if normal == DVec3::ZERO {
            DVec3::AXES
        } else {
            let across = edge_vectors(surface, faces).filter_map(|side| frame_across(normal, side));
            let along = frame_along(&spread, normal);
            best_frame(points, std::iter::once(along).chain(across))
        };
        let bounds = OrientedBox::around(points.iter(), &frame);
        let center = DVec3::from_array(bounds.center.map(f64::from));
        let aligned = Aabb::of_points(places());
        let points = [start, self.points.len()];
        self.items.push(Item { group, points, spread, aligned, center, normal, bounds });
    }

    /// Makes the node over some clusters, and all below it; returns its index.
    fn grow(&mut self, set: &mut [u32]) -> usize {
        let mut parts = vec![[0, set.len()]];
        while parts.len() < LANES {
            let size = |part: &[usize; 2]| part[1] - part[0];
            let Some(at) = (0..parts.len())
                .filter(|&at| size(&parts[at]) > 1)
                .max_by_key(|&at| (size(&parts[at]), std::cmp::Reverse(at)))
            else {
                break;
            };
            let [start, end] = parts[at];
            let middle = start + self.cut(&mut set[start..end]);
            parts[at] = [start, middle];
            parts.insert(at + 1, [middle, end]);
        }
        let index = self.nodes.len();
        self.nodes.push(blank());
        for (lane, &[start, end]) in parts.iter().enumerate() {
            let part = &mut set[start..end];
            let (bounds, child) = if let [item] = *part {
                let Item { group, bounds, .. } = self.items[item as usize];
                self.order.push(group);
                self.bounds.push(bounds);
                (bounds, Child::of_cluster(self.order.len() - 1))
            } else {
                (self.bounds_of(part), Child::node(self.grow(part)))
            };
            self.nodes[index].put(lane, &bounds, child);
        }
        index
    }

    fn points_of<'s>(&'s self, set: &'s [u32]) -> impl Iterator<Item = &'s PointPair> + Clone {
        set.iter().flat_map(|&item| {
            let [start, end] = self.items[item as usize].points;
            &self.points[start..end]
        })
    }

    /// The better of two frames for the box over a set, and half the surface of that box.
    fn frame_of(&self, set: &[u32]) -> (Frame, f64) {
        let mut spread = Spread::default();
        let (mut normal, mut aligned) = (DVec3::ZERO, Aabb::EMPTY);
        for &item in set {
            let item = &self.items[item as usize];
            spread = spread.with(&item.spread);
            normal += item.normal;
            aligned = aligned.union(&item.aligned);
        }
        let along_axes = aligned.half_area();
        if normal.length() <= CANCELLED * set.len() as f64 {
            return (DVec3::AXES, along_axes);
        }
        let normal = normal.normalize();
        let frame = frame_along(&spread, normal);
        let area = half_area_along(self.points_of(set), &frame);
        if is_less(area, along_axes) { (frame, area) } else { (DVec3::AXES, along_axes) }
    }

    fn bounds_of(&self, set: &[u32]) -> OrientedBox {
        OrientedBox::around(self.points_of(set), &self.frame_of(set).0)
    }

    /// Half the surface of the box over a set, times its number.
    fn weight(&self, set: &[u32]) -> f64 {
        self.frame_of(set).1 * set.len() as f64
    }

    /// Orders a set of at least two and returns where it is cut.
    fn cut(&mut self, set: &mut [u32]) -> usize {
        let count = set.len();
        if count == 2 {
            return 1;
        }
        if count > MOST_BY_NORMALS {
            let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for &item in set.iter() {
                let center = self.items[item as usize].center;
                (least, most) = (least.min(center), most.max(center));
            }
            let size = (most - least).to_array();
            let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
            let key = |&item: &u32| (self.items[item as usize].key(axis), item);
            set.select_nth_unstable_by_key(count / 2, key);
            // What the selection leaves in either half is in an order of the library's own.
            let (low, high) = set.split_at_mut(count / 2);
            low.sort_unstable();
            high.sort_unstable();
            return count / 2;
        }
        let mut best = (f64::INFINITY, 0, count / 2);
        for coordinate in 0..6 {
            self.sort(set, coordinate);
            let tries = [count / 2, count / 3, 2 * count / 3];
            let tries = &tries[..if count > MOST_BY_THIRDS { 1 } else { 3 }];
            for (i, &middle) in tries.iter().enumerate() {
                if tries[..i].contains(&middle) {
                    continue;
                }
                let bar = BETTER * best.0;
                let mut weight = self.weight(&set[..middle]);
                if weight < bar {
                    weight += self.weight(&set[middle..]);
                }
                if weight < bar {
                    best = (weight, coordinate, middle);
                }
            }
        }
        self.sort(set, best.1);
        best.2
    }

    /// By a coordinate of the centre (0 to 2), or of the normal (3 to 5).
    fn sort(&mut self, set: &mut [u32], coordinate: usize) {
        self.keyed.clear();
        self.keyed
            .extend(set.iter().map(|&item| (self.items[item as usize].key(coordinate), item)));
        self.keyed.sort_unstable();
        for (item, keyed) in set.iter_mut().zip(&self.keyed) {
            *item = keyed.1;
        }
    }
}

impl Item {
    /// A coordinate of the centre, or of the normal, as a number of the same order.
    fn key(&self, coordinate: usize) -> i64 {
        let x = match coordinate {
            0..3 => self.center[coordinate],
            _ => self.normal[coordinate - 3],
        };
        // As `f64::total_cmp` has it.
        let bits = x.to_bits().cast_signed();
        bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
    }
}

/// The vectors along the edges of some faces; an edge of two of them comes once.
fn edge_vectors<'a>(surface: &'a Surface, faces: &'a [FaceId]) -> impl Iterator<Item = DVec3> + 'a {
    faces.iter().enumerate().flat_map(move |(i, &face)| {
        let ends = surface.mesh.corners(face);
        let sides = [[ends[0], ends[1]], [ends[1], ends[2]], [ends[2], ends[0]]];
        let has = |other: &FaceId, [from, to]: [VertexId; 2]| {
            let [a, b, c] = surface.mesh.corners(*other);
            [[b, a], [c, b], [a, c]].contains(&[from, to])
        };
        let is_new = move |side: &[VertexId; 2]| !faces[..i].iter().any(|f| has(f, *side));
        let between =
            |[from, to]: [VertexId; 2]| surface.places[to.index()] - surface.places[from.index()];
        sides.into_iter().filter(is_new).map(between)
    })
}

fn blank() -> WideNode {
    let (zero, none) =
        (Lanes::all(0.0), Lanes3 { x: Lanes::all(0.0), y: Lanes::all(0.0), z: Lanes::all(0.0) });
    WideNode {
        center: none,
        axes: [none; 3],
        half: none,
        radius: zero,
        wrenches: WrenchLanes::NONE,
        children: [Child::ROOT; LANES],
        count: 0,
    }
}

impl WideNode {
    fn put(&mut self, lane: usize, bounds: &OrientedBox, child: Child) {
        self.center.set(lane, bounds.center);
        for (axes, axis) in self.axes.iter_mut().zip(bounds.axes) {
            axes.set(lane, axis);
        }
        self.half.set(lane, bounds.half);
        self.radius.0[lane] = bounds.radius;
        self.children[lane] = child;
        self.count = lane as u32 + 1;
    }
}
