//! One descent of two search trees for every question.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use super::closing::Closing;
use super::ground::{At, Ground, gaps_and_overlaps};
use super::lanes::{lanes_of, within};
use crate::pair::Side;
use crate::tally::Tally;
use cranny_geometry::clusters::LANES;
use wide::f32x8;

/// What a descent looks at first.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// Anything: all within reach is visited.
    Any,
    /// Of what is beside each other, the nearest; of boxes that overlap, the one that does so most
    /// centrally.
    Nearest,
    /// Of all that waits, what overlaps most centrally: likeliest to cross. After [`CHOSEN`] times,
    /// of what is beside each other.
    Crossing,
}

/// A search for a crossing chooses so many times among all that waits. 16: crossings of few faces
/// are found later; 1,000: a search that finds none compares what waits as long as it compares
/// boxes.
const CHOSEN: u32 = 64;

/// What one level deeper is worth beside shares by which boxes overlap. None: nodes that share
/// their centres keep a search from going deeper; 4: it goes down where it went first.
const DEEPER: f32 = 1.0;

/// What a descent is for.
pub(crate) trait Visitor {
    /// What is looked at first.
    const ORDER: Order;

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
    /// The least is looked at first.
    order: f32,
    depth: f32,
    at: [At; 2],
    /// How far contacts of what is at each count, by its own motion: lengths of the pair.
    closing: [f32; 2],
}

/// What is to be looked at first is taken from the end.
fn last_first(x: &Pending, y: &Pending) -> Ordering {
    y.order.total_cmp(&x.order)
}

/// Which of those that wait is likeliest to cross; of several, the last.
fn most_promising(stack: &[Pending]) -> usize {
    (0..stack.len()).max_by(|&i, &j| last_first(&stack[i], &stack[j])).unwrap_or(0)
}

/// Descends from the top, in the visitor's order.
pub(crate) fn descend<V: Visitor>(
    ground: &Ground,
    visitor: &mut V,
    counters: &mut impl Tally,
) -> ControlFlow<()> {
    // Mostly no more than so many wait at once.
    let mut stack = Vec::with_capacity(64);
    let (at, closing) = ([At::ROOT; 2], [f32::INFINITY; 2]);
    stack.push(Pending { gap: 0.0, order: 0.0, depth: 0.0, at, closing });
    let mut chosen = if V::ORDER == Order::Crossing { CHOSEN } else { 0 };
    while let Some(last) = stack.len().checked_sub(1) {
        let next = if chosen > 0 { most_promising(&stack) } else { last };
        let Pending { gap, depth, at, closing, .. } = stack.swap_remove(next);
        if chosen == 1 {
            stack.sort_by(last_first);
        }
        chosen = chosen.saturating_sub(1);
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
        // What overflows is no number, and its sign another on each machine.
        let is_certain = ground.reach(side, 0.0).is_finite();
        let overlaps = if is_certain { overlaps.to_array() } else { [0.0; LANES] };
        let (gaps, start) = (gaps.to_array(), stack.len());
        for lane in lanes_of(near) {
            let mut next = at;
            next[i] = At::lane(index, lane);
            let gap = ground.certain(side, gaps[lane]);
            let mut next_closing = closing;
            next_closing[i] = own[lane];
            let order = match V::ORDER {
                Order::Any => 0.0,
                Order::Nearest if gaps[lane] > 0.0 => gaps[lane],
                Order::Nearest => -overlaps[lane],
                Order::Crossing => -overlaps[lane] - DEEPER * depth,
            };
            stack.push(Pending { gap, order, depth: depth + 1.0, at: next, closing: next_closing });
        }
        if V::ORDER != Order::Any && chosen == 0 {
            stack[start..].sort_by(last_first);
        }
    }
    ControlFlow::Continue(())
}
