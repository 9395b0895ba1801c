//! A cut through the pairs of nodes of two trees, refined where it is nearest.
//!
//! The cut holds every pair of faces beneath exactly one of its entries. Each entry knows how far its
//! nodes were apart when they were tested, and motion takes only so much of that: so what was found in one
//! frame bounds the next, and work goes on where the last budget ended. Entries are opened nearest first:
//! no other order raises the lower bound sooner. (Best first search with bounds, as Quinlan, 'Efficient
//! distance computation between non-convex objects', 1994; a queue that outlives the frame, as Hubbard,
//! 'Collision detection for interactive graphics applications', 1995.)
//!
//! One odometer serves all entries: key = what it showed at the test + separation found, so motion does
//! not change the order of those that rest.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use cranny_geometry::{Content, FaceId, FaceTree};

use super::effort::Meter;
use super::findings::Findings;
use super::ground::{Ground, Nodes};
use super::scope::{Scope, Step};
use crate::pair::Side;

/// A cut of more entries, 40 bytes each, is dropped and begun anew. Fewer: large pairs under small
/// budgets never come to their end; more: memory.
const MOST_ENTRIES: usize = 1 << 17;

/// Faces that are looked at for closed nodes, a query. More: a little less between the bounds, for triangle
/// tests; none: levels without faces know no upper bound.
const FACES_OF_CLOSED: usize = 8;

/// A cut is begun anew when more than one in so many of its entries has lost its slack. That costs two
/// tests an entry; one that has lost its slack costs several, as it opens. Fewer: what could have rested is
/// looked for from the top; more: fast motion pays for memory that it cannot use.
const SPENT_SHARE: usize = 3;

/// Boxes are tested again, rather than opened, where motion has taken more than this share of their size.
/// Less: tests that regain next to nothing; more: cuts finer than they need be.
const WORTH_A_TEST: f64 = 0.25;

/// A pair of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    key: f64,
    /// How far apart the middles are, doubled and squared: which of two that overlap to open first.
    guess: f64,
    /// What the odometer showed when its boxes were tested or its faces looked at.
    at: f64,
    pub(super) nodes: Nodes,
    depths: [u8; 2],
    /// All its faces were looked at, then: it was no nearer than the faces that memory names.
    looked: bool,
}

impl Entry {
    const ROOT: Self = Self {
        key: f64::NEG_INFINITY,
        guess: 0.0,
        at: f64::NEG_INFINITY,
        nodes: [0, 0],
        depths: [0, 0],
        looked: false,
    };

    fn depth(&self) -> u16 {
        u16::from(self.depths[0]) + u16::from(self.depths[1])
    }
}

/// The greatest is what is looked at next: the nearest; of these the deepest, so that faces are soon
/// reached; of these the one whose middles are nearest.
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .key
            .total_cmp(&self.key)
            .then_with(|| self.depth().cmp(&other.depth()))
            .then_with(|| other.guess.total_cmp(&self.guess))
            .then_with(|| other.nodes.cmp(&self.nodes))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Entry {}

/// The cut, and how far the bodies have moved since it was begun.
#[derive(Clone, Debug)]
pub(super) struct Refinement {
    open: BinaryHeap<Entry>,
    odometer: f64,
    /// Entries that it had when first nothing more was to be done; 0 before that.
    built: usize,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { open: BinaryHeap::from([Entry::ROOT]), odometer: 0.0, built: 0 }
    }
}

impl Refinement {
    /// Counts a motion in which nothing came nearer by more than `step`.
    pub(super) fn advance(&mut self, step: f64) {
        if self.open.len() == 1 && self.open.peek() == Some(&Entry::ROOT) {
            return; // nothing was found yet that motion could take
        }
        self.odometer = (self.odometer + step).next_up();
        if self.open.len() > MOST_ENTRIES || !self.odometer.is_finite() {
            *self = Self::default();
        }
    }

    /// What lies beneath an entry is no nearer than this.
    pub(super) fn lower(&self, entry: &Entry, ground: &Ground) -> f64 {
        (entry.key - self.odometer).next_down() - ground.error
    }

    /// The surfaces are no nearer than this.
    pub(super) fn least(&self, ground: &Ground) -> f64 {
        self.open.peek().map_or(f64::NEG_INFINITY, |entry| self.lower(entry, ground))
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.open.iter()
    }

    /// Opens what is nearest until that changes nothing more, the level is exhausted, or the budget.
    /// Returns whether everything within the findings' limit was looked at. `shaken`: the last motion took
    /// more than had been known.
    pub(super) fn refine(
        &mut self,
        ground: &Ground,
        scope: &Scope,
        findings: &mut Findings,
        meter: &mut Meter,
        shaken: bool,
    ) -> bool {
        if self.is_outrun(ground, findings.limit(), meter, shaken) {
            *self = Self::default();
        }
        let mut settled: Vec<Entry> = Vec::new();
        let mut complete = true;
        let mut peeks = FACES_OF_CLOSED;
        let mut dive: Option<Entry> = None;
        while let Some(entry) = self.next(dive.take(), ground, findings.limit()) {
            let step = self.step(&entry, ground, scope);
            if findings.is_done() || !meter.take(step.tests()) {
                self.open.push(entry);
                complete = false;
                break;
            }
            match step {
                Step::Test => {
                    let tested = self.tested(ground, entry.nodes, entry.depths, findings);
                    self.open.push(Entry { key: tested.key.max(entry.key), ..tested });
                }
                Step::Open(children) => {
                    let (nearer, farther) = self.opened(&entry, children, ground, findings);
                    self.open.push(farther);
                    // Straight down as long as no faces are known: till then nothing can be left out.
                    match findings.knows_no_faces() {
                        true if meter.affords(2 + Findings::TESTS_A_LOOK) => dive = Some(nearer),
                        true if meter.take(Findings::TESTS_A_LOOK) => {
                            // The last tests: some upper bound there must be.
                            self.peek(nearer.nodes, ground, findings);
                            self.open.push(nearer);
                        }
                        _ => self.open.push(nearer),
                    }
                }
                Step::Look { all, pairs } => {
                    let before = findings.counters.triangle_tests;
                    let lower = look(ground, scope, entry.nodes, findings);
                    let made = findings.counters.triangle_tests - before;
                    meter.give_back((Findings::TESTS_A_LOOK * pairs).saturating_sub(made));
                    let key = if all { (self.odometer + lower).next_down() } else { entry.key };
                    complete &= all;
                    let key = key.max(entry.key);
                    settled.push(Entry { key, at: self.odometer, looked: all, ..entry });
                }
                Step::Close => {
                    complete = false;
                    let peek = peeks > 0 && findings.wants_near_faces();
                    if peek && meter.take(Findings::TESTS_A_LOOK) {
                        peeks -= 1;
                        self.peek(entry.nodes, ground, findings);
                    }
                    settled.push(entry);
                }
                Step::Rest => settled.push(entry),
            }
        }
        self.open.extend(settled);
        if complete && self.built == 0 {
            self.built = self.open.len();
        }
        complete
    }

    /// The next entry within the limit: that of a dive, or the nearest.
    fn next(&mut self, dive: Option<Entry>, ground: &Ground, limit: f64) -> Option<Entry> {
        match dive {
            Some(entry) if self.lower(&entry, ground) <= limit => return Some(entry),
            other => self.open.extend(other),
        }
        let nearest = self.open.peek()?;
        (self.lower(nearest, ground) <= limit).then(|| self.open.pop()).flatten()
    }

    /// The two entries that take another's place, the nearer one first.
    fn opened(
        &self,
        entry: &Entry,
        children: [(Nodes, [u8; 2]); 2],
        ground: &Ground,
        findings: &mut Findings,
    ) -> (Entry, Entry) {
        let [one, other] = children.map(|(nodes, depths)| {
            let tested = self.tested(ground, nodes, depths, findings);
            Entry { key: tested.key.max(entry.key), ..tested }
        });
        if one > other { (one, other) } else { (other, one) }
    }

    /// Whether a cut begun anew is likely to tell more for the budget: much of this one has lost its slack,
    /// or it has grown too fine; or what has lost its slack is more than can be looked at.
    fn is_outrun(&self, ground: &Ground, limit: f64, meter: &Meter, shaken: bool) -> bool {
        let has_lost =
            |entry: &&Entry| entry.at < self.odometer && self.lower(entry, ground) <= limit;
        let lost = || self.open.iter().filter(has_lost).count();
        if self.built > 0 && meter.affords(3 * self.built as u64) {
            return self.open.len() > 2 * self.built || lost() > self.built / SPENT_SHARE;
        }
        shaken && !meter.affords(lost() as u64)
    }

    /// Looks at some faces of two nodes that stay closed.
    fn peek(&self, nodes: Nodes, ground: &Ground, findings: &mut Findings) {
        let [f, g] = [0, 1].map(|i| first_face(ground.trees[i], nodes[i]));
        findings.look(f, g);
    }

    /// What there is to do about an entry.
    fn step(&self, entry: &Entry, ground: &Ground, scope: &Scope) -> Step {
        let lost = self.odometer - entry.at;
        if lost <= 0.0 && entry.looked {
            return Step::Rest;
        }
        let step = scope.step(ground, entry.nodes, entry.depths);
        match step {
            Step::Open(_) if lost > 0.0 && self.regains(lost, entry, ground) => Step::Test,
            Step::Close if lost > 0.0 => Step::Test,
            _ => step,
        }
    }

    /// Whether what motion has taken from an entry is worth a test of its boxes, or should be opened at once.
    fn regains(&self, lost: f64, entry: &Entry, ground: &Ground) -> bool {
        let size = |i: usize| ground.trees[i].node(entry.nodes[i]).bounds.diagonal();
        lost > WORTH_A_TEST * size(0).max(size(1))
    }

    fn tested(
        &self,
        ground: &Ground,
        nodes: Nodes,
        depths: [u8; 2],
        findings: &mut Findings,
    ) -> Entry {
        findings.counters.node_tests += 1;
        let [first, second] = ground.trees;
        let boxes = [first.node(nodes[0]).bounds, second.node(nodes[1]).bounds];
        let (separation, guess) = ground.boxes.bound_and_guess(&boxes[0], &boxes[1]);
        let key = (self.odometer + separation).next_down();
        Entry { key, guess, at: self.odometer, nodes, depths, looked: false }
    }

    pub(super) fn bytes(&self) -> usize {
        self.open.capacity() * size_of::<Entry>()
    }
}

/// Looks at the faces of two leaves, as far as the level admits them; returns how near they are at least.
fn look(ground: &Ground, scope: &Scope, [a, b]: Nodes, findings: &mut Findings) -> f64 {
    let [first, second] = ground.trees;
    let mut least = f64::INFINITY;
    for &f in first.leaf_faces(a).iter().filter(|&&f| scope.admits(Side::First, f)) {
        for &g in second.leaf_faces(b).iter().filter(|&&g| scope.admits(Side::Second, g)) {
            least = least.min(findings.look(f, g));
        }
    }
    least
}

/// Some face beneath a node. As many steps as the node has levels beneath it.
fn first_face(tree: &FaceTree, mut node: u32) -> FaceId {
    loop {
        match tree.content(node) {
            Content::Inner { left, .. } => node = left,
            Content::Leaf { .. } => return tree.leaf_faces(node)[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(key: f64, depths: [u8; 2], guess: f64) -> Entry {
        Entry { key, guess, depths, ..Entry::ROOT }
    }

    #[test]
    fn the_nearest_comes_first_then_the_deepest_then_that_of_nearer_middles() {
        let entries = [
            entry(2.0, [9, 9], 0.0),
            entry(1.0, [1, 1], 0.0),
            entry(1.0, [3, 2], 5.0),
            entry(1.0, [2, 3], 4.0),
        ];
        let mut heap = BinaryHeap::from(entries);
        let order: Vec<_> = std::iter::from_fn(|| heap.pop()).collect();
        assert_eq!(order, [3, 2, 1, 0].map(|i: usize| entries[i]));
    }

    #[test]
    fn motion_takes_slack_from_all_alike_and_too_large_a_cut_is_begun_anew() {
        let mut cut = Refinement::default();
        cut.advance(0.25);
        assert_eq!(cut.odometer, 0.0, "nothing is there to take from");
        cut.open.push(entry(1.0, [1, 1], 0.0));
        cut.advance(0.25);
        cut.advance(0.5);
        assert!(cut.odometer >= 0.75 && cut.odometer < 0.75 + 1e-12);
        cut.open =
            (0..=MOST_ENTRIES as u32).map(|i| Entry { nodes: [i, i], ..Entry::ROOT }).collect();
        cut.advance(0.5);
        assert_eq!(cut.open.len(), 1);
        cut.open.push(entry(1.0, [1, 1], 0.0));
        cut.advance(f64::INFINITY);
        assert_eq!((cut.open.len(), cut.odometer), (1, 0.0));
    }
}
