//! One descent of two search trees for every question.

use std::ops::ControlFlow;

use super::ground::{At, Ground};
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

/// Two places, and a lower bound of how far they are apart, in lengths of the pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pending {
    gap: f64,
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
    stack.push(Pending { gap: 0.0, at: [At::ROOT; 2] });
    while let Some(Pending { gap, at }) = stack.pop() {
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
        let gaps = ground.gaps(side, node, at[1 - i]);
        let near = within(gaps, f32x8::splat(ground.reach(side, reach))) & node.mask();
        let (gaps, start) = (gaps.to_array(), stack.len());
        for lane in lanes_of(near) {
            let mut next = at;
            next[i] = At::lane(index, lane);
            stack.push(Pending { gap: ground.certain(side, gaps[lane]), at: next });
        }
        // The nearest is popped first.
        let new = &mut stack[start..];
        if new.len() > 1 {
            new.sort_unstable_by(|x, y| y.gap.total_cmp(&x.gap));
        }
    }
    ControlFlow::Continue(())
}
