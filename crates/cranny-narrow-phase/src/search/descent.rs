//! One descent of two search trees for every question.

use std::ops::ControlFlow;

use super::closing::Closing;
use super::ground::{At, Ground, gaps_and_overlaps};
use super::lanes::{lanes_of, within};
use crate::pair::Side;
use crate::tally::Tally;
use cranny_geometry::clusters::LANES;
use wide::f32x8;

/// What a descent is for.
pub(crate) trait Visitor {
    /// Whether it matters what is looked at first: not where all within reach is visited.
    const IN_ORDER: bool = true;

    /// What is farther apart than this, in lengths of the pair, does not matter. It may shrink.
    fn reach(&self) -> f64;

    /// How much less far what is at two places may matter; `None` where that is not known.
    #[inline(always)]
    fn closing(&self) -> Option<&Closing> {
        None
    }

    /// Looks at two clusters whose boxes are within reach, no nearer than `gap`; may end the
    /// descent.
    fn clusters(&mut self, pair: [u32; 2], gap: f64, counters: &mut impl Tally) -> ControlFlow<()>;
}

/// Two places, and a lower bound of how far they are apart, in lengths of the pair.
#[derive(Clone, Copy, Debug)]
struct Pending {
    gap: f64,
    /// Of places beside each other the least is looked at first.
    order: f32,
    at: [At; 2],
    /// How far contacts of what is at each count, by its own motion: lengths of the pair.
    closing: [f32; 2],
}

/// Descends from the top, the nearest first.
pub(crate) fn descend<V: Visitor>(
    ground: &Ground,
    visitor: &mut V,
    counters: &mut impl Tally,
) -> ControlFlow<()> {
    // Mostly no more than so many wait at once.
    let mut stack = Vec::with_capacity(64);
    stack.push(Pending { gap: 0.0, order: 0.0, at: [At::ROOT; 2], closing: [f32::INFINITY; 2] });
    while let Some(Pending { gap, at, closing, .. }) = stack.pop() {
        let reach = visitor.reach();
        if gap > reach {
            continue;
        }
        let Some(side) = ground.opened(at) else {
            let pair = [Side::First, Side::Second]
                .map(|side| ground.child(side, at[side.index()]).index() as u32);
            visitor.clusters(pair, gap, counters)?;
            continue;
        };
        let i = side.index();
        let index = ground.child(side, at[i]).index();
        let node = &ground.tree(side).nodes()[index];
        counters.counters().node_tests += u64::from(node.count);
        counters.boxes(|| ground.compared(at, side, node.mask()));
        let placed = ground.placed(side, at[1 - i]);
        let (gaps, overlaps) = gaps_and_overlaps(node, &placed);
        let (far, own) = match visitor.closing() {
            Some(by_motion) => {
                let own = by_motion.of_lanes(side, node);
                let far = by_motion.reaches(own, closing[1 - i]);
                (ground.reaches(side, far), own.to_array())
            }
            None => (f32x8::splat(ground.reach(side, reach)), [0.0; LANES]),
        };
        let near = within(gaps, far) & node.mask();
        // The nearest is popped first: of boxes that overlap, the one that does so most, since
        // what is in it is likeliest to cross.
        let order = (gaps + overlaps).to_array();
        let (gaps, start) = (gaps.to_array(), stack.len());
        for lane in lanes_of(near) {
            let mut next = at;
            next[i] = At::lane(index, lane);
            let gap = ground.certain(side, gaps[lane]);
            let mut next_closing = closing;
            next_closing[i] = own[lane];
            stack.push(Pending { gap, order: order[lane], at: next, closing: next_closing });
        }
        let new = &mut stack[start..];
        if V::IN_ORDER && new.len() > 1 {
            new.sort_unstable_by(|x, y| y.order.total_cmp(&x.order));
        }
    }
    ControlFlow::Continue(())
}
