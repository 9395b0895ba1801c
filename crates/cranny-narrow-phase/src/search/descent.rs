//! One descent of two search trees for every question.

use std::ops::ControlFlow;

use super::ground::{At, Ground, distances, gaps};
use super::lanes::{lanes_of, within};
use crate::answer::Counters;
use crate::pair::Side;
use wide::f32x8;

/// What a descent is for.
pub(crate) trait Visitor {
    /// What is farther apart than this, in lengths of the pair, does not matter. It may shrink.
    fn reach(&self) -> f64;

    /// Looks at two clusters whose boxes are within reach, no nearer than `gap`; may end the
    /// descent.
    fn clusters(&mut self, pair: [u32; 2], gap: f64, counters: &mut Counters) -> ControlFlow<()>;
}

/// How much the distance of centres counts beside that of boxes, for what is looked at first. None:
/// where all boxes overlap, crossings are come across late.
const CENTERS: f32 = 0.25;

/// Two places, and a lower bound of how far they are apart, in lengths of the pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pending {
    gap: f64,
    /// Of places beside each other the least is looked at first.
    order: f32,
    at: [At; 2],
}

/// Descends from the top, the nearest first; `stack` is scratch.
pub(crate) fn descend(
    ground: &Ground,
    stack: &mut Vec<Pending>,
    visitor: &mut impl Visitor,
    counters: &mut Counters,
) -> ControlFlow<()> {
    stack.clear();
    stack.push(Pending { gap: 0.0, order: 0.0, at: [At::ROOT; 2] });
    while let Some(Pending { gap, at, .. }) = stack.pop() {
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
        counters.node_tests += u64::from(node.count);
        let placed = ground.placed(side, at[1 - i]);
        let gaps = gaps(node, &placed);
        let near = within(gaps, f32x8::splat(ground.reach(side, reach))) & node.mask();
        // The nearest is popped first: of boxes that overlap, the one whose centre is nearest.
        let order = match near.count_ones() {
            0 | 1 => gaps.to_array(),
            _ => (gaps + distances(node, &placed) * f32x8::splat(CENTERS)).to_array(),
        };
        let (gaps, start) = (gaps.to_array(), stack.len());
        for lane in lanes_of(near) {
            let mut next = at;
            next[i] = At::lane(index, lane);
            let gap = ground.certain(side, gaps[lane]);
            stack.push(Pending { gap, order: order[lane], at: next });
        }
        let new = &mut stack[start..];
        if new.len() > 1 {
            new.sort_unstable_by(|x, y| y.order.total_cmp(&x.order));
        }
    }
    ControlFlow::Continue(())
}
