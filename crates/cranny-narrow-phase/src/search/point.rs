//! The faces of a body that may be nearest to a point.
//!
//! Points that are looked up one after another mostly lie beside each other. So the clusters about
//! a place are listed once, and points there look at the list.

use cranny_exact::DVec3;
use cranny_geometry::clusters::{Child, Cluster, LANES, Lanes, Lanes3, WideNode};
use cranny_geometry::{ClusterTree, FaceId};
use wide::f32x8;

use super::ground::rounding;
use super::lanes::{Wide3, lanes_of, single, wide, within};
use crate::tally::Tally;

/// A list reaches so many strides from point to point farther than its first point needs, or radii
/// of a cluster where these are less. Fewer: it serves fewer points; more: each of them looks at
/// more boxes.
const SPARE: f64 = 2.0;

/// A list of more boxes than eight times this is made for one point alone, or not at all for points
/// that are to come. Fewer: lists serve fewer points; more: where points jump, each makes a long
/// one.
const MOST: usize = 6;

/// Eight boxes side by side.
struct Boxes {
    center: Lanes3,
    axes: [Lanes3; 3],
    half: Lanes3,
    clusters: [u32; LANES],
    count: u32,
}

/// The clusters of a tree about a place.
#[derive(Default)]
pub(crate) struct Vicinity {
    /// In the body's frame.
    center: DVec3,
    /// All clusters that are as near to the centre as this are listed.
    reach: f64,
    boxes: Vec<Boxes>,
    /// Scratch: nodes to open, and clusters within reach with lower bounds of their distances.
    nodes: Vec<u32>,
    near: Vec<(f32, u32)>,
}

impl Vicinity {
    /// Calls `visit` with every face that may be within `reach` of a point of the body's frame,
    /// mostly the nearest first; `visit` returns the reach from there on. `allowance` is what the
    /// point and its distances may be off by. The tree is the same in all calls.
    pub(crate) fn for_faces_near(
        &mut self,
        tree: &ClusterTree,
        p: DVec3,
        (mut reach, allowance): (f64, f64),
        counters: &mut impl Tally,
        mut visit: impl FnMut(FaceId) -> f64,
    ) {
        let point = Point::of(tree, p, allowance);
        // After the first point, it is unknown how far from it the next will be.
        let stride = if reach < f64::INFINITY { reach } else { 0.0 };
        let from = (p - self.center).length();
        if !self.boxes.is_empty() && from <= self.reach {
            self.look(&point, &mut reach, counters, &mut visit);
            // Nothing else is nearer.
            if from + reach <= self.reach {
                return;
            }
        }
        let radius = point.nearest_cluster(&mut reach, counters, &mut visit);
        self.center = p;
        self.reach = reach + SPARE * stride.min(radius);
        if !self.list(&point, MOST, counters) {
            self.reach = reach;
            self.list(&point, usize::MAX, counters);
        }
        self.look(&point, &mut reach, counters, &mut visit);
    }

    /// Lists the clusters about a ball of the body's frame in which points will be looked up,
    /// unless there are too many. Points no farther from the surface than its centre are served;
    /// the first that is not makes a list of its own in place of this. `visit` returns how far the
    /// centre is from the nearest face visited.
    pub(crate) fn gather(
        &mut self,
        tree: &ClusterTree,
        (center, radius): (DVec3, f64),
        allowance: f64,
        counters: &mut impl Tally,
        mut visit: impl FnMut(FaceId) -> f64,
    ) {
        let point = Point::of(tree, center, allowance);
        let mut nearest = f64::INFINITY;
        point.nearest_cluster(&mut nearest, counters, &mut visit);
        self.center = center;
        self.reach = radius + nearest;
        if !self.list(&point, MOST, counters) {
            self.boxes.clear();
        }
    }

    /// Visits the faces of what is listed that may be within reach of a point.
    fn look(
        &mut self,
        point: &Point,
        reach: &mut f64,
        counters: &mut impl Tally,
        visit: &mut impl FnMut(FaceId) -> f64,
    ) {
        let bound = point.bound(*reach);
        self.near.clear();
        for boxes in &self.boxes {
            counters.counters().node_tests += 1;
            let gaps = box_gaps((&boxes.center, &boxes.axes, &boxes.half), point.at);
            let near = within(gaps, f32x8::splat(bound)) & ((1 << boxes.count) - 1);
            let gaps = gaps.to_array();
            self.near.extend(lanes_of(near).map(|lane| (gaps[lane], boxes.clusters[lane])));
        }
        self.near.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        for &(gap, cluster) in &self.near {
            if gap > point.bound(*reach) {
                break;
            }
            point.look(&point.tree.clusters()[cluster as usize], reach, visit);
        }
    }

    /// Lists what is within reach of the centre, which is the point; whether it is no more than
    /// `most` times eight boxes.
    fn list(&mut self, point: &Point, most: usize, counters: &mut impl Tally) -> bool {
        let tree = point.tree;
        // Points that lie beside the centre are off by as much as it is.
        let bound = f32x8::splat(point.bound(self.reach + point.allowance));
        self.boxes.clear();
        self.nodes.clear();
        self.nodes.push(0);
        while let Some(index) = self.nodes.pop() {
            if self.boxes.len() > most {
                return false;
            }
            counters.counters().node_tests += 1;
            let node = &tree.nodes()[index as usize];
            for lane in lanes_of(within(point.gaps(node), bound) & node.mask()) {
                let child: Child = node.children[lane];
                if child.is_cluster() {
                    self.add(node, lane, child.index() as u32);
                } else {
                    self.nodes.push(child.index() as u32);
                }
            }
        }
        true
    }

    fn add(&mut self, node: &WideNode, lane: usize, cluster: u32) {
        if self.boxes.last().is_none_or(|boxes| boxes.count as usize == LANES) {
            let zero = Lanes3 { x: Lanes::all(0.0), y: Lanes::all(0.0), z: Lanes::all(0.0) };
            let (center, axes, half) = (zero, [zero; 3], zero);
            self.boxes.push(Boxes { center, axes, half, clusters: [0; LANES], count: 0 });
        }
        if let Some(boxes) = self.boxes.last_mut() {
            let at = boxes.count as usize;
            boxes.count += 1;
            boxes.clusters[at] = cluster;
            boxes.center.set(at, node.center.get(lane));
            boxes.half.set(at, node.half.get(lane));
            for (axes, all) in boxes.axes.iter_mut().zip(&node.axes) {
                axes.set(at, all.get(lane));
            }
        }
    }
}

/// A point before a tree.
struct Point<'a> {
    tree: &'a ClusterTree,
    p: DVec3,
    /// In the coordinates of the tree.
    at: [f32; 3],
    allowance: f64,
    /// What distances of boxes may be off by.
    error: f64,
}

impl<'a> Point<'a> {
    fn of(tree: &'a ClusterTree, p: DVec3, allowance: f64) -> Self {
        let unit = tree.unit();
        let at = single((p - tree.origin()) / unit);
        let scale = 1.0 + at.iter().map(|x| x.abs()).sum::<f32>();
        let error = f64::from(rounding(scale)) * unit + allowance;
        Self { tree, p, at, allowance, error }
    }

    /// A reach as a bound for distances of boxes.
    #[inline(always)]
    fn bound(&self, reach: f64) -> f32 {
        (((reach + self.error) / self.tree.unit()) as f32).next_up()
    }

    #[inline(always)]
    fn gaps(&self, node: &WideNode) -> f32x8 {
        box_gaps((&node.center, &node.axes, &node.half), self.at)
    }

    /// Looks at a cluster whose box is about the nearest; returns the radius of that.
    fn nearest_cluster(
        &self,
        reach: &mut f64,
        counters: &mut impl Tally,
        visit: &mut impl FnMut(FaceId) -> f64,
    ) -> f64 {
        let tree = self.tree;
        let mut node = &tree.nodes()[0];
        loop {
            counters.counters().node_tests += 1;
            let gaps = self.gaps(node).to_array();
            let nearer = |&i: &usize, &k: &usize| gaps[i].total_cmp(&gaps[k]);
            let lane = (0..node.count as usize).min_by(nearer).unwrap_or(0);
            let child: Child = node.children[lane];
            if child.is_cluster() {
                let cluster = &tree.clusters()[child.index()];
                self.look(cluster, reach, visit);
                return f64::from(cluster.bounds.radius) * tree.unit();
            }
            node = &tree.nodes()[child.index()];
        }
    }

    /// Visits the faces of a cluster that may be within reach, the nearest first.
    fn look(&self, cluster: &Cluster, reach: &mut f64, visit: &mut impl FnMut(FaceId) -> f64) {
        let unit = self.tree.unit();
        // Coordinates about its centre are as large as the point is far from it.
        let from = single((self.p - cluster.center) / unit);
        let scale = cluster.bounds.radius + from.iter().map(|x| x.abs()).sum::<f32>();
        let error = f64::from(rounding(scale)) * unit + self.allowance;
        let bound = |reach: f64| (((reach + error) / unit) as f32).next_up();
        let gaps = face_gaps(cluster, from);
        let mut left = within(gaps, f32x8::splat(bound(*reach))) & cluster.faces.mask();
        let gaps = gaps.to_array();
        while let Some(lane) = lanes_of(left).min_by(|&i, &k| gaps[i].total_cmp(&gaps[k])) {
            if gaps[lane] > bound(*reach) {
                break;
            }
            left &= !(1 << lane);
            *reach = visit(cluster.faces.ids[lane]);
        }
    }
}

/// How far a point lies outside each of eight boxes.
#[inline]
fn box_gaps((center, axes, half): (&Lanes3, &[Lanes3; 3], &Lanes3), at: [f32; 3]) -> f32x8 {
    let from = Wide3::all(at).minus(&Wide3::of(center));
    let half = [wide(&half.x), wide(&half.y), wide(&half.z)];
    let zero = f32x8::splat(0.0);
    let mut squares = zero;
    for (axis, half) in axes.iter().zip(half) {
        let gap = (from.dot(&Wide3::of(axis)).abs() - half).fast_max(zero);
        squares += gap * gap;
    }
    squares.sqrt()
}

/// How far a point, about a cluster's centre, lies from each of its faces at least.
#[inline]
fn face_gaps(cluster: &Cluster, from: [f32; 3]) -> f32x8 {
    let faces = &cluster.faces;
    let p = Wide3::all(from);
    let zero = f32x8::splat(0.0);
    let height = p.dot(&Wide3::of(&faces.normal));
    let above = (height - wide(&faces.top)).fast_max(wide(&faces.bottom) - height).fast_max(zero);
    let out = |i: usize| p.dot(&Wide3::of(&faces.sides[i])) - wide(&faces.ends[i]);
    let [x, y, z] = [out(0), out(1), out(2)];
    let beside = x.fast_max(y).fast_max(z).fast_max(zero);
    (above * above + beside * beside).sqrt()
}
