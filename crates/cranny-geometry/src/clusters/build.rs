//! The tree over clusters: eight boxes a node, divided from the top.
//!
//! A set is cut in two until there are eight parts, the largest first; where it is cut is what
//! leaves the least area of boxes, each weighed by the clusters in it (the surface area heuristic
//! of MacDonald and Booth, 1990): by places, or by normals, which part the flanks of a thread.
//! Cost: O(n log n) sorting, and a few boxes over all points for each level.

use cranny_exact::DVec3;

use super::lanes::{LANES, Lanes, Lanes3};
use super::oriented::{Frame, OrientedBox, best_frame, frame_across, frame_along, half_area};
use super::wrenches::WrenchLanes;
use super::{Child, Surface, WideNode, grow};
use crate::ids::FaceId;

/// Sets of more clusters than this are cut in the middle of their longest extent: there, boxes
/// along normals say nothing. Larger: building takes longer; smaller: flanks are parted later.
const FEW: usize = 256;

/// Sets of more than this are cut in the middle, along whatever cuts best. Larger: building takes
/// longer, for nodes that are hardly better.
const FEWER: usize = 24;

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
    /// Where its corners are among all points.
    points: [usize; 2],
    center: DVec3,
    normal: DVec3,
    bounds: OrientedBox,
}

struct Builder {
    points: Vec<DVec3>,
    items: Vec<Item>,
    nodes: Vec<WideNode>,
    order: Vec<usize>,
    bounds: Vec<OrientedBox>,
    /// Scratch.
    gathered: Vec<DVec3>,
}

pub(super) fn build(surface: &Surface, groups: &[Vec<FaceId>]) -> Built {
    let mut builder = Builder {
        points: Vec::new(),
        items: Vec::with_capacity(groups.len()),
        nodes: Vec::new(),
        order: Vec::with_capacity(groups.len()),
        bounds: Vec::with_capacity(groups.len()),
        gathered: Vec::new(),
    };
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
        self.points.extend(vertices.iter().map(|v| surface.places[v.index()]));
        let points = &self.points[start..];
        let normal = grow::mean(surface, faces);
        let frame = if normal == DVec3::ZERO {
            DVec3::AXES
        } else {
            let sides = faces.iter().flat_map(|&face| {
                let [a, b, c] = surface.triangle(face);
                [b - a, c - b, a - c]
            });
            let across = sides.filter_map(|side| frame_across(normal, side));
            let along = frame_along(points, normal);
            best_frame(points, std::iter::once(along).chain(across))
        };
        let bounds = OrientedBox::around(points, &frame);
        let center = DVec3::from_array(bounds.center.map(f64::from));
        let points = [start, self.points.len()];
        self.items.push(Item { group, points, center, normal, bounds });
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

    fn gather(&mut self, set: &[u32]) {
        self.gathered.clear();
        for &item in set {
            let [start, end] = self.items[item as usize].points;
            self.gathered.extend_from_slice(&self.points[start..end]);
        }
    }

    fn frames(&self, set: &[u32]) -> [Frame; 2] {
        let normal = set.iter().map(|&item| self.items[item as usize].normal).sum::<DVec3>();
        let normal = normal.try_normalize().unwrap_or(DVec3::ZERO);
        [DVec3::AXES, frame_along(&self.gathered, normal)]
    }

    fn bounds_of(&mut self, set: &[u32]) -> OrientedBox {
        self.gather(set);
        let frame = best_frame(&self.gathered, self.frames(set).into_iter());
        OrientedBox::around(&self.gathered, &frame)
    }

    /// Half the surface of the box over a set, times its number.
    fn weight(&mut self, set: &[u32]) -> f64 {
        self.gather(set);
        let frames = self.frames(set);
        let areas = frames.map(|frame| half_area(&self.gathered, &frame));
        areas[0].min(areas[1]) * set.len() as f64
    }

    /// Orders a set of at least two and returns where it is cut.
    fn cut(&mut self, set: &mut [u32]) -> usize {
        let count = set.len();
        if count > FEW {
            let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for &item in set.iter() {
                let center = self.items[item as usize].center;
                (least, most) = (least.min(center), most.max(center));
            }
            let size = (most - least).to_array();
            let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
            self.sort(set, axis);
            return count / 2;
        }
        let mut best = (f64::INFINITY, 0, count / 2);
        for key in 0..6 {
            self.sort(set, key);
            let tries: &[usize] = match count > FEWER {
                true => &[count / 2],
                false => &[count / 2, count / 3, 2 * count / 3],
            };
            for &middle in tries {
                if middle == 0 || middle == count {
                    continue;
                }
                let weight = self.weight(&set[..middle]) + self.weight(&set[middle..]);
                // By more than rounding.
                if weight < best.0 * 0.999 {
                    best = (weight, key, middle);
                }
            }
        }
        self.sort(set, best.1);
        best.2
    }

    /// By a coordinate of the centre, or of the normal.
    fn sort(&self, set: &mut [u32], key: usize) {
        let of = |item: u32| {
            let Item { center, normal, .. } = &self.items[item as usize];
            if key < 3 { center[key] } else { normal[key - 3] }
        };
        set.sort_unstable_by(|&x, &y| of(x).total_cmp(&of(y)).then(x.cmp(&y)));
    }
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
