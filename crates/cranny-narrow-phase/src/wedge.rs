//! The solid around an edge: is a direction that leaves the edge inside or outside? Exact.

use cranny_exact::{DVec3, Sign, orient3d};
use cranny_geometry::EdgeId;

use crate::inside::Location;
use crate::pair::{Pair, Side};
use crate::projection::Projection;

/// An edge and the faces around it, of any number.
pub(crate) struct Wedge {
    ends: [DVec3; 2],
    spokes: Vec<Spoke>,
}

/// A face as seen along the edge.
#[derive(Clone, Copy)]
struct Spoke {
    apex: DVec3,
    /// The face runs along the edge from its first to its second end. Its back, where the solid is,
    /// then lies clockwise of it.
    forward: bool,
}

impl Wedge {
    /// The wedge of an edge of a closed component.
    pub(crate) fn of(pair: &Pair, side: Side, edge: EdgeId) -> Self {
        let from = pair.topology(side).edges()[edge.index()].from;
        let spoke = |h: &cranny_geometry::HalfEdgeId| Spoke {
            apex: pair.position(side, pair.corner(side, h.face(), (h.corner() + 2) % 3)),
            forward: pair.corner(side, h.face(), h.corner()) == from,
        };
        let spokes = pair.topology(side).half_edges(edge).iter().map(spoke).collect();
        Self { ends: pair.segment(side, edge), spokes }
    }

    /// Where the half-plane from the edge's line through `p` begins: in the solid, out of it or in
    /// a face. `view` is that of the plane through the edge and `p`. `On` also where nothing can be
    /// decided: `p` is on the edge's line, or a face around the edge has no area.
    pub(crate) fn locate(&self, p: DVec3, view: Projection) -> Location {
        let hand = |x: DVec3| view.turn(&[self.ends[0], self.ends[1], x]);
        let hand_of_p = hand(p);
        if hand_of_p.is_zero() {
            return Location::On;
        }
        // The first face that a half-plane meets which turns counter-clockwise from p: less than
        // half a turn away, or beyond. Two that are on the same half compare by the turn between
        // them.
        let mut first: Option<(bool, Spoke)> = None;
        for &spoke in &self.spokes {
            let hand_of_spoke = hand(spoke.apex);
            let turn = self.turn(p, spoke.apex);
            if turn.is_zero() && (hand_of_spoke.is_zero() || hand_of_spoke == hand_of_p) {
                return Location::On;
            }
            let beyond = turn != Sign::Positive;
            let earlier = |&(other_beyond, other): &(bool, Spoke)| {
                (!beyond && other_beyond)
                    || (beyond == other_beyond
                        && self.turn(spoke.apex, other.apex) == Sign::Positive)
            };
            if first.as_ref().is_none_or(earlier) {
                first = Some((beyond, spoke));
            }
        }
        match first {
            Some((_, spoke)) if spoke.forward => Location::Inside,
            Some(_) => Location::Outside,
            None => Location::On,
        }
    }

    /// The sign of the turn about the edge from `x` to `y`, less than half a turn either way.
    fn turn(&self, x: DVec3, y: DVec3) -> Sign {
        orient3d(self.ends[0], self.ends[1], x, y)
    }
}
