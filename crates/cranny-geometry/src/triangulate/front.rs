//! Fronts: how far the plane between two edges is triangulated.
//!
//! A front is a list of sites, from the left end of the edge below to the left end of the edge
//! above, joined by edges of triangles; what lies to its right is open. **Invariant:** seen from
//! the open side, the angle at every inner site is at least a straight one. So the front has a
//! single rightmost site, its *tip*, which every site to come in this gap sees; and the sites that
//! a new one sees follow one another from the tip, or from the end of an edge on which it lies.
//!
//! Source: Hertel and Mehlhorn (1983). Cost: O(1) for each site and each triangle made.

use cranny_exact::{DVec2, Sign, orient2d};

use super::sweep::Layer;

const NONE: u32 = u32::MAX;

/// A front by its ends and tip, as nodes, and the winding number of the open region beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Front {
    bottom: u32,
    top: u32,
    tip: u32,
    pub(super) winding: i64,
}

impl Front {
    /// The front before the first site.
    pub(super) const EMPTY: Self = Self { bottom: NONE, top: NONE, tip: NONE, winding: 0 };
}

#[derive(Clone, Copy)]
struct FrontNode {
    site: u32,
    below: u32,
    above: u32,
}

/// The nodes of all fronts, and the triangles that fronts have passed over.
pub(super) struct Fronts<'a> {
    sites: &'a [DVec2],
    nodes: Vec<FrontNode>,
    triangles: Vec<Layer>,
}

impl<'a> Fronts<'a> {
    pub(super) fn new(sites: &'a [DVec2]) -> Self {
        Self {
            sites,
            nodes: Vec::with_capacity(2 * sites.len()),
            triangles: Vec::with_capacity(2 * sites.len()),
        }
    }

    pub(super) fn into_triangles(self) -> Vec<Layer> {
        self.triangles
    }

    /// Cuts a front at its tip: what lies below it and what lies above, both with the tip.
    pub(super) fn cut(&mut self, front: Front) -> (Front, Front) {
        if front.tip == NONE {
            return (front, front);
        }
        let FrontNode { site, above, .. } = self.nodes[front.tip as usize];
        let double = self.node(site, NONE, above);
        self.nodes[front.tip as usize].above = NONE;
        let top = if front.top == front.tip { double } else { front.top };
        (Front { top: front.tip, ..front }, Front { bottom: double, top, tip: double, ..front })
    }

    /// Joins site `v` to all sites of a front between two edges that end there.
    pub(super) fn close(&mut self, front: Front, v: u32) {
        let mut n = front.bottom;
        while n != NONE {
            let above = self.nodes[n as usize].above;
            if above != NONE {
                self.emit([n, above], v, front.winding);
            }
            n = above;
        }
    }

    /// Joins `v` to the sites that it sees from the top of a front downwards, and ends the front in
    /// it.
    pub(super) fn end_in(&mut self, front: Front, v: u32) -> Front {
        let seen = self.sweep_down(front, v);
        let tip = self.node(v, seen, NONE);
        Front { bottom: if seen == NONE { tip } else { front.bottom }, top: tip, tip, ..front }
    }

    /// Joins `v` to the sites that it sees from the bottom of a front upwards, and starts the front
    /// in it.
    pub(super) fn start_in(&mut self, front: Front, v: u32, winding: i64) -> Front {
        let seen = self.sweep_up(front, v);
        let tip = self.node(v, NONE, seen);
        Front { bottom: tip, top: if seen == NONE { tip } else { front.top }, tip, winding }
    }

    /// The front of `v` alone.
    pub(super) fn fresh(&mut self, v: u32, winding: i64) -> Front {
        let tip = self.node(v, NONE, NONE);
        Front { bottom: tip, top: tip, tip, winding }
    }

    /// Makes one front of two that `v` joins.
    pub(super) fn merge(&mut self, lower: Front, v: u32, upper: Front) -> Front {
        let below = self.sweep_down(lower, v);
        let above = self.sweep_up(upper, v);
        let tip = self.node(v, below, above);
        Front {
            bottom: if below == NONE { tip } else { lower.bottom },
            top: if above == NONE { tip } else { upper.top },
            tip,
            winding: lower.winding,
        }
    }

    /// Makes one front of two whose common edge is given up; both contain its left end.
    ///
    /// The angle there may be less than a straight one: triangles fill it until the invariant
    /// holds.
    pub(super) fn unite(&mut self, lower: Front, upper: Front) -> Front {
        let (kept, double) = (lower.top, upper.bottom);
        let above = self.nodes[double as usize].above;
        self.link(kept, above);
        let same = |n: u32| if n == double { kept } else { n };
        let rightmost = if self.site(lower.tip) < self.site(upper.tip) { upper } else { lower };
        let united = Front { top: same(upper.top), tip: same(rightmost.tip), ..lower };

        let mut pending = vec![kept];
        while let Some(n) = pending.pop() {
            let FrontNode { below, above, .. } = self.nodes[n as usize];
            if below != NONE && above != NONE && self.turns_left(n, above, self.site(below)) {
                self.emit([n, above], self.site(below), united.winding);
                self.link(below, above);
                self.nodes[n as usize].below = NONE; // no longer in the front
                pending.extend([above, below]);
            }
        }
        united
    }

    fn sweep_down(&mut self, front: Front, v: u32) -> u32 {
        let mut n = front.top;
        while n != NONE {
            let below = self.nodes[n as usize].below;
            if below == NONE || !self.turns_left(below, n, v) {
                break;
            }
            self.emit([below, n], v, front.winding);
            n = below;
        }
        n
    }

    fn sweep_up(&mut self, front: Front, v: u32) -> u32 {
        let mut n = front.bottom;
        while n != NONE {
            let above = self.nodes[n as usize].above;
            if above == NONE || !self.turns_left(n, above, v) {
                break;
            }
            self.emit([n, above], v, front.winding);
            n = above;
        }
        n
    }

    /// Whether a site lies to the right of the front between two of its nodes, the lower one first.
    fn turns_left(&self, lower: u32, upper: u32, v: u32) -> bool {
        let [l, u, v] = [self.site(lower), self.site(upper), v].map(|s| self.sites[s as usize]);
        orient2d(l, v, u) == Sign::Positive
    }

    fn emit(&mut self, [lower, upper]: [u32; 2], v: u32, winding: i64) {
        let corners = [self.site(lower), v, self.site(upper)];
        self.triangles.push(Layer { corners, winding });
    }

    fn site(&self, node: u32) -> u32 {
        self.nodes[node as usize].site
    }

    fn node(&mut self, site: u32, below: u32, above: u32) -> u32 {
        let node = self.nodes.len() as u32;
        self.nodes.push(FrontNode { site, below: NONE, above: NONE });
        self.link(below, node);
        self.link(node, above);
        node
    }

    fn link(&mut self, below: u32, above: u32) {
        if let Some(node) = self.nodes.get_mut(below as usize) {
            node.above = above;
        }
        if let Some(node) = self.nodes.get_mut(above as usize) {
            node.below = below;
        }
    }
}
