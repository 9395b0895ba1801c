//! In which facets' slabs a point lies.
//!
//! A facet's *slab* is the layer of the hull beneath its supporting plane, as deep as the facet is
//! thick and at least [`SLAB`] times the hull's flatness. Whoever lies in it is as good as on the
//! facet: nothing that rounding can make of a planar side lies deeper.
//!
//! Whether a point lies in a slab is one comparison of `f64` numbers that depend on the facet and
//! the point alone, never on the order of visits, and scales with powers of two to the bit. The
//! height of a point is rounded, by a bound that is a small part of the slab's depth; so the answer
//! is sharp except within rounding of the slab's floor, where either is right.
//!
//! Source: the tree is packed along Morton's curve (1966), as Kamel and Faloutsos (1993, "On
//! packing R-trees") pack theirs along Hilbert's; what a node bounds are intervals (Moore 1966,
//! "Interval analysis"). Cost: O(n log n) to make the tree. A point costs the nodes that may hold
//! it and their children, O(log n) where few slabs lie near.

use std::ops::Range;

use cranny_exact::{Aabb, DVec3};

use cranny_geometry::hull::{ConvexHull, Facet, FacetChange, FacetId};

/// Least depth of a slab in units of the hull's flatness. Facets are merged up to one flatness;
/// points of the same planar side that are not extreme, rounded on their own, may lie as deep
/// again. Smaller than 2, and the middle of a planar side stored in single precision is a dent
/// (`sides_rounded_to_single_precision_are_flat`); larger, and pockets that much deeper are skin.
const SLAB: f64 = 2.0;

/// Nodes of the level below that a node of the finder spans.
const FANOUT: usize = 8;

/// The slabs of a hull and a tree of boxes over its facets.
#[derive(Clone, Debug)]
pub(crate) struct Slabs {
    slabs: Vec<Slab>,
    /// Facets in the order of the nodes on the lowest level, and their places along a curve.
    order: Vec<u32>,
    places: Vec<u32>,
    /// The box of the hull, which these places are relative to.
    bounds: Aabb,
    /// Level by level from the facets up; each node spans [`FANOUT`] of the level below.
    levels: Vec<Vec<Node>>,
    depth: f64,
}

#[derive(Clone, Copy, Debug)]
struct Slab {
    normal: DVec3,
    floor: f64,
}

impl Slab {
    fn of(facet: &Facet<'_>, depth: f64) -> Self {
        Self { normal: facet.normal, floor: facet.offset - facet.thickness.max(depth) }
    }
}

/// What some facets have in common.
///
/// A box around them is not enough: those of long, slanted facets hold most of the body. So a node
/// also bounds normals and floors. Sums and products round monotonically: the bound of a height,
/// computed as heights are, is no less than any height that it bounds, rounding included.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    normals: Aabb,
    floor: f64,
}

impl Node {
    fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&other.bounds),
            normals: self.normals.union(&other.normals),
            floor: self.floor.min(other.floor),
        }
    }

    /// Whether a point may lie in one of the slabs.
    fn may_hold(&self, p: DVec3) -> bool {
        // All comparisons are made, without a branch: nobody could predict it.
        let within = self.bounds.min.cmple(p) & p.cmple(self.bounds.max);
        let highest = (self.normals.min * p).max(self.normals.max * p);
        (within.bitmask() == 0b111) & (highest.x + highest.y + highest.z >= self.floor)
    }

    /// Whether a point of a box may lie in one of the slabs.
    fn may_reach(&self, within: &Aabb) -> bool {
        let shared = self.bounds.min.cmple(within.max) & within.min.cmple(self.bounds.max);
        let (low, high) = (self.normals.min, self.normals.max);
        let least = (low * within.min).max(high * within.min);
        let highest = (low * within.max).max(high * within.max).max(least);
        (shared.bitmask() == 0b111) & (highest.x + highest.y + highest.z >= self.floor)
    }
}

impl Slabs {
    /// Prepares the facets of a hull: O(n).
    pub(crate) fn of(hull: &ConvexHull) -> Self {
        let depth = SLAB * hull.flatness();
        let slabs = hull.facets().map(|f| Slab::of(&f, depth)).collect();
        let (bounds, order, places) = (hull.bounds(), Vec::new(), Vec::new());
        Self { slabs, order, places, bounds, levels: Vec::new(), depth }
    }

    /// The least depth of a slab.
    pub(crate) fn depth(&self) -> f64 {
        self.depth
    }

    /// Whether a point of the hull lies in the slab of a facet.
    #[inline]
    pub(crate) fn holds(&self, facet: u32, p: DVec3) -> bool {
        let slab = &self.slabs[facet as usize];
        slab.normal.dot(p) >= slab.floor
    }

    pub(crate) fn normal(&self, facet: u32) -> DVec3 {
        self.slabs[facet as usize].normal
    }

    /// Builds the tree that [`around`](Self::around) descends.
    pub(crate) fn prepare_finder(&mut self, hull: &ConvexHull) {
        let nodes: Vec<Node> = (0..self.slabs.len() as u32).map(|f| self.node(hull, f)).collect();
        // A place on the curve and a facet in one number.
        let mut order: Vec<u64> = (0u64..)
            .zip(&nodes)
            .map(|(f, n)| curve_position(n.bounds.center(), &self.bounds) << 32 | f)
            .collect();
        order.sort_unstable();
        self.places = order.iter().map(|place| (place >> 32) as u32).collect();
        self.order = order.into_iter().map(|place| place as u32).collect();
        self.levels = vec![self.order.iter().map(|&f| nodes[f as usize]).collect()];
        self.refit_levels(0..self.order.len());
    }

    /// Follows a hull whose facets have changed. Where slabs differ from those before, reports
    /// in boxes.
    ///
    /// Cost: copying, the levels above the lowest, and O(m log m) for the m facets that are new;
    /// where the box of the hull is another, that of preparing, and the only box is that of all.
    pub(crate) fn follow(&mut self, hull: &ConvexHull, change: &FacetChange) -> Vec<Aabb> {
        let (bounds, depth) = (hull.bounds(), SLAB * hull.flatness());
        if bounds != self.bounds || depth != self.depth {
            let both = self.bounds.union(&bounds).grown(self.depth.max(depth));
            *self = Self::of(hull);
            self.prepare_finder(hull);
            return vec![both];
        }
        self.slabs.resize(hull.facet_count(), Slab { normal: DVec3::ZERO, floor: 0.0 });
        let mut fresh = Vec::with_capacity(change.fresh.len());
        for &f in &change.fresh {
            self.slabs[f as usize] = Slab::of(&hull.facet(FacetId(f)), depth);
            let node = self.node(hull, f);
            fresh.push((curve_position(node.bounds.center(), &bounds) as u32, f, node));
        }
        fresh.sort_unstable_by_key(|&(place, f, _)| (place, f));
        let mut is_gone = vec![false; self.order.len()];
        change.gone.iter().for_each(|&f| is_gone[f as usize] = true);
        let gone = (0..).zip(&self.order).filter(|(_, f)| is_gone[**f as usize]).map(|(at, _)| at);
        // What is cut out, and what comes in before something, in the order of the lowest level.
        let mut cuts: Vec<(usize, Option<usize>)> = gone.map(|at| (at, None)).collect();
        let mut boxes: Vec<Aabb> = cuts.iter().map(|&(at, _)| self.levels[0][at].bounds).collect();
        boxes.extend(fresh.iter().map(|(.., node)| node.bounds));
        let behind = |place: u32| self.places.partition_point(|&p| p <= place);
        cuts.extend(fresh.iter().enumerate().map(|(i, f)| (behind(f.0), Some(i))));
        cuts.sort_by_key(|&(at, new)| (at, new.is_none()));
        let (Some(first), Some(&(last, new))) = (cuts.first(), cuts.last()) else { return boxes };
        let changed = first.0..last + usize::from(new.is_none());
        // What stands between the first and the last cut; all behind these only moves.
        let (mut order, mut places, mut lowest) = (Vec::new(), Vec::new(), Vec::new());
        let mut next = changed.start;
        for (at, new) in cuts {
            order.extend_from_slice(&self.order[next..at]);
            places.extend_from_slice(&self.places[next..at]);
            lowest.extend_from_slice(&self.levels[0][next..at]);
            next = at + usize::from(new.is_none());
            if let Some((place, f, node)) = new.map(|i| fresh[i]) {
                order.push(f);
                places.push(place);
                lowest.push(node);
            }
        }
        let stays = order.len() == changed.len();
        self.slabs.truncate(hull.facet_count());
        self.order.splice(changed.clone(), order);
        self.places.splice(changed.clone(), places);
        self.levels[0].splice(changed.clone(), lowest);
        let end = if stays { changed.end } else { self.order.len() };
        self.refit_levels(changed.start..end);
        boxes
    }

    /// What stands for a facet on the lowest level.
    fn node(&self, hull: &ConvexHull, f: u32) -> Node {
        let triangles = hull.facet(FacetId(f)).triangles;
        let corners = triangles.iter().flat_map(|&t| hull.triangle(t as usize));
        // Corners lie up to a slab's depth beside the facet's polygon.
        let bounds = Aabb::of_points(corners.map(|v| hull.position(v))).grown(self.depth);
        let slab = self.slabs[f as usize];
        let normals = Aabb { min: slab.normal, max: slab.normal };
        Node { bounds, normals, floor: slab.floor }
    }

    /// Makes what stands on the levels above these nodes of the lowest; as many nodes as there are.
    fn refit_levels(&mut self, mut changed: Range<usize>) {
        let unite = |group: &[Node]| group.iter().skip(1).fold(group[0], |all, b| all.union(b));
        let mut level = 0;
        while self.levels[level].len() > 1 {
            if level + 1 == self.levels.len() {
                self.levels.push(Vec::new());
            }
            let (below, above) = self.levels.split_at_mut(level + 1);
            let (below, above) = (&below[level], &mut above[0]);
            changed = changed.start / FANOUT..changed.end.div_ceil(FANOUT);
            changed.start = changed.start.min(above.len());
            above.truncate(below.len().div_ceil(FANOUT));
            for at in changed.start..changed.end.min(below.len().div_ceil(FANOUT)) {
                let node = unite(&below[FANOUT * at..(FANOUT * (at + 1)).min(below.len())]);
                match above.get_mut(at) {
                    Some(place) => *place = node,
                    None => above.push(node),
                }
            }
            level += 1;
        }
        self.levels.truncate(level + 1);
    }

    /// The highest level of the tree over facets; none where there are no facets.
    pub(super) fn top(&self) -> Option<usize> {
        self.levels.iter().rposition(|level| !level.is_empty())
    }

    /// The nodes of a level.
    pub(super) fn nodes(&self, level: usize) -> Range<usize> {
        0..self.levels[level].len()
    }

    /// The nodes of a level beneath one of the next level.
    pub(super) fn beneath(&self, level: usize, above: usize) -> Range<usize> {
        FANOUT * above..(FANOUT * (above + 1)).min(self.levels[level].len())
    }

    /// Whether a slab beneath a node may hold a point of a box.
    pub(super) fn may_reach(&self, level: usize, node: usize, within: &Aabb) -> bool {
        self.levels[level][node].may_reach(within)
    }

    /// The facet of a node on the lowest level, if a point lies in its slab and box.
    pub(super) fn facet_around(&self, node: usize, p: DVec3) -> Option<u32> {
        self.levels[0][node].may_hold(p).then(|| self.order[node])
    }

    /// The facets in whose slabs and boxes a point lies, ascending, appended to `found`.
    pub(crate) fn around(&self, p: DVec3, found: &mut Vec<u32>) {
        let first = found.len();
        if let Some(top) = self.top() {
            self.look(top, self.nodes(top), p, found);
        }
        found[first..].sort_unstable();
    }

    /// Appends the facets beneath some nodes of a level whose slabs hold the point.
    fn look(&self, level: usize, nodes: Range<usize>, p: DVec3, found: &mut Vec<u32>) {
        for at in nodes {
            if !self.levels[level][at].may_hold(p) {
                continue;
            }
            if level == 0 {
                found.push(self.order[at]);
            } else {
                self.look(level - 1, self.beneath(level - 1, at), p, found);
            }
        }
    }
}

/// The place along a Z-order curve (Morton 1966) of 2^10 cells an axis over the box: 30 bits.
fn curve_position(p: DVec3, bounds: &Aabb) -> u64 {
    let cells = f64::from(1u32 << 10) - 1.0;
    let extent = bounds.max - bounds.min;
    let cell = |axis: usize| {
        let share = (p[axis] - bounds.min[axis]) / extent[axis];
        // A flat box gives NaN: the cast makes it cell 0.
        (share * cells) as u64
    };
    spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2
}

/// The lowest 16 bits, two zeros after each.
fn spread(mut bits: u64) -> u64 {
    bits = bits.min(0xffff);
    bits = (bits | bits << 16) & 0x0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x0c30_c30c_30c3;
    (bits | bits << 2) & 0x2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: i32) -> Vec<DVec3> {
        let range = move || (0..=n).map(f64::from);
        range()
            .flat_map(|x| range().flat_map(move |y| range().map(move |z| DVec3::new(x, y, z))))
            .collect()
    }

    #[test]
    fn bits_are_spread_by_three() {
        assert_eq!(spread(0b1011), 0b1_000_001_001);
        assert_eq!(spread(0xffff).count_ones(), 16);
        assert_eq!(spread(1 << 15), 1 << 45);
    }

    #[test]
    fn points_of_a_cube_lie_in_as_many_slabs_as_they_have_sides() {
        let points = grid(4);
        let hull = ConvexHull::of_points(&points);
        let mut slabs = Slabs::of(&hull);
        slabs.prepare_finder(&hull);
        for p in points {
            let mut found = Vec::new();
            slabs.around(p, &mut found);
            let sides = p.to_array().iter().filter(|&&c| c == 0.0 || c == 4.0).count();
            assert_eq!(found.len(), sides, "{p}");
            assert!(found.iter().all(|&f| slabs.holds(f, p)));
        }
    }

    #[test]
    fn the_finder_agrees_with_looking_at_every_facet() {
        // A prism over a 40-gon has facets of very different sizes.
        let ring = (0..40).map(|k| {
            let t = f64::from(k) - 19.5;
            DVec3::new(t, 25.0 - t * t / 20.0, 0.0)
        });
        let points: Vec<DVec3> = ring.flat_map(|p| [p, p + 30.0 * DVec3::Z]).collect();
        let hull = ConvexHull::of_points(&points);
        let mut slabs = Slabs::of(&hull);
        slabs.prepare_finder(&hull);
        let midpoints = points.windows(3).map(|w| 0.5 * (w[0] + w[2]));
        for p in midpoints.chain(points.iter().copied()) {
            let mut found = Vec::new();
            slabs.around(p, &mut found);
            let all: Vec<u32> =
                (0..hull.facet_count() as u32).filter(|&f| slabs.holds(f, p)).collect();
            assert_eq!(found, all, "{p}");
        }
    }
}
