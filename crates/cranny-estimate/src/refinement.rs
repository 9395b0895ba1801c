//! A cut through the pairs of nodes of two trees, refined where it is nearest.
//!
//! Every pair of faces lies beneath exactly one entry of the cut. Each entry holds a lower bound of
//! the distance of its nodes at the time of their test, and motion reduces it by a bounded amount:
//! the bounds of one frame hold for the next, and work goes on where the last budget ended. Entries
//! are opened nearest first: no other order raises the lower bound sooner. (Best first search with
//! bounds: Quinlan, 'Efficient distance computation between non-convex objects', 1994; a queue that
//! outlives the frame: Hubbard, 'Collision detection for interactive graphics applications', 1995.)
//!
//! One odometer serves all entries: the key of an entry is the odometer at its test plus the bound
//! found then, so motion does not change the order of entries.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use cranny_geometry::{Content, FaceId, FaceTree};
use cranny_narrow_phase::operations::Side;

use crate::effort::Meter;
use crate::findings::Findings;
use crate::scope::{Scope, Step};
use crate::trees::{NodePair, PairTrees};

/// The most entries of a cut, 40 bytes each; a larger one is dropped and begun anew. Fewer: large
/// pairs under small budgets are never finished; more: memory.
const MOST_ENTRIES: usize = 1 << 17;

/// Pairs of closed nodes of which a face each is tested, in one estimate. More: the interval is a
/// little narrower, for triangle tests; none: levels without faces have no upper bound.
const FACES_OF_CLOSED: usize = 8;

/// A cut is begun anew when more than one in this many of its entries has lost its slack. A new cut
/// costs two tests an entry; an entry without slack costs several, as it opens. Fewer: entries that
/// are still valid are searched for from the roots; more: fast motion pays for memory that it
/// cannot use.
const SPENT_SHARE: usize = 3;

/// How much more an entry that has lost its slack costs than a test of a new cut: it is taken out,
/// tested, put back, and mostly opened. Less: memory costs more than it saves; more: what could be
/// kept is searched for anew.
const DEARER: u64 = 4;

/// Boxes are tested again, rather than opened, where motion has reduced their bound by more than
/// this share of their size. Less: tests that regain almost nothing; more: cuts finer than needed.
const WORTH_A_TEST: f64 = 0.25;

/// A pair of nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    key: f64,
    /// Square of the doubled distance between the centers; it orders entries that overlap.
    guess: f64,
    /// The odometer when its boxes or its faces were tested.
    at: f64,
    pub(crate) nodes: NodePair,
    depths: [u8; 2],
    /// Which of its faces were tested then; memory holds any that were nearest.
    tested: Tested,
}

/// Faces of a pair of leaves that were tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tested {
    None,
    /// Those on the hulls.
    OnHulls,
    All,
}

impl Entry {
    const ROOT: Self = Self {
        key: f64::NEG_INFINITY,
        guess: 0.0,
        at: f64::NEG_INFINITY,
        nodes: [0, 0],
        depths: [0, 0],
        tested: Tested::None,
    };

    fn depth(&self) -> u16 {
        u16::from(self.depths[0]) + u16::from(self.depths[1])
    }
}

/// The greatest is processed next: the nearest; of equally near ones the deepest, so that faces are
/// reached soon; of these the one whose centers are nearest.
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
pub(crate) struct Refinement {
    open: BinaryHeap<Entry>,
    odometer: f64,
    /// Entries that it had when it was first complete; 0 before that.
    built: usize,
    /// Tests of the estimate that began it, where no budget ended that one: what a new one costs.
    cost: Option<u64>,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { open: BinaryHeap::from([Entry::ROOT]), odometer: 0.0, built: 0, cost: None }
    }
}

impl Refinement {
    /// Counts a motion in which no distance decreased by more than `step`.
    pub(crate) fn advance(&mut self, step: f64) {
        if self.is_new() {
            return; // There is no bound yet that motion could reduce.
        }
        self.odometer = (self.odometer + step).next_up();
        if self.open.len() > MOST_ENTRIES || !self.odometer.is_finite() {
            *self = Self::default();
        }
    }

    fn is_new(&self) -> bool {
        self.open.len() == 1 && self.open.peek() == Some(&Entry::ROOT)
    }

    /// A lower bound of the distance of the faces beneath an entry.
    pub(crate) fn lower(&self, entry: &Entry, trees: &PairTrees) -> f64 {
        (entry.key - self.odometer).next_down() - trees.error
    }

    /// A lower bound of the distance of the surfaces.
    pub(crate) fn least(&self, trees: &PairTrees) -> f64 {
        self.open.peek().map_or(f64::NEG_INFINITY, |entry| self.lower(entry, trees))
    }

    pub(crate) fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.open.iter()
    }

    /// Opens the nearest entries until no entry can change the result, the level is exhausted or
    /// the budget is spent. Returns whether every entry within the findings' limit was settled by
    /// tests of faces. `outrun`: the last motion was longer than the interval of the distance.
    pub(crate) fn refine(
        &mut self,
        trees: &PairTrees,
        scope: &Scope,
        findings: &mut Findings,
        meter: &mut Meter,
        outrun: bool,
    ) -> bool {
        if !findings.is_done() && self.should_restart(trees, findings.limit(), meter, outrun) {
            *self = Self::default();
        }
        let (is_new, tests_before) = (self.is_new(), findings.tests());
        let mut settled: Vec<Entry> = Vec::new();
        let mut complete = true;
        let mut peeks = FACES_OF_CLOSED;
        let mut dive: Option<Entry> = None;
        while let Some(entry) = self.next(dive.take(), trees, findings.limit()) {
            let step = self.step(&entry, trees, scope);
            if findings.is_done() || !meter.take(step.tests()) {
                self.open.push(entry);
                complete = false;
                break;
            }
            match step {
                Step::Test => {
                    let tested = self.tested(trees, entry.nodes, entry.depths, findings);
                    self.open.push(Entry { key: tested.key.max(entry.key), ..tested });
                }
                Step::Open(children) => {
                    let (nearer, farther) = self.opened(&entry, children, trees, findings);
                    self.open.push(farther);
                    // Straight down until faces are known: before, no entry can be left out.
                    match findings.knows_no_faces() {
                        true if meter.affords(2 + Findings::TESTS_A_PAIR) => dive = Some(nearer),
                        true if meter.take(Findings::TESTS_A_PAIR) => {
                            // The last tests go to an upper bound.
                            self.peek(nearer.nodes, trees, findings);
                            self.open.push(nearer);
                        }
                        _ => self.open.push(nearer),
                    }
                }
                Step::TestFaces { all, pairs } => {
                    let before = findings.counters.triangle_tests;
                    let lower = test_faces(trees, scope, entry.nodes, findings);
                    let made = findings.counters.triangle_tests - before;
                    meter.give_back((Findings::TESTS_A_PAIR * pairs).saturating_sub(made));
                    let key = if all { (self.odometer + lower).next_down() } else { entry.key };
                    complete &= all;
                    let key = key.max(entry.key);
                    let tested = if all { Tested::All } else { Tested::OnHulls };
                    settled.push(Entry { key, at: self.odometer, tested, ..entry });
                }
                Step::Close => {
                    complete = false;
                    let peek = peeks > 0 && findings.wants_near_faces();
                    if peek && meter.take(Findings::TESTS_A_PAIR) {
                        peeks -= 1;
                        meter.repeats(Findings::TESTS_A_PAIR);
                        self.peek(entry.nodes, trees, findings);
                    }
                    settled.push(entry);
                }
                Step::Rest { all } => {
                    complete &= all;
                    settled.push(entry);
                }
            }
        }
        self.open.extend(settled);
        if is_new {
            self.cost = (!meter.refused).then(|| findings.tests() - tests_before);
        }
        if complete && self.built == 0 {
            self.built = self.open.len();
        }
        complete
    }

    /// The next entry within the limit: the one given, or the nearest.
    fn next(&mut self, dive: Option<Entry>, trees: &PairTrees, limit: f64) -> Option<Entry> {
        match dive {
            Some(entry) if self.lower(&entry, trees) <= limit => return Some(entry),
            other => self.open.extend(other),
        }
        let nearest = self.open.peek()?;
        (self.lower(nearest, trees) <= limit).then(|| self.open.pop()).flatten()
    }

    /// The two entries that take another's place, the nearer one first.
    fn opened(
        &self,
        entry: &Entry,
        children: [(NodePair, [u8; 2]); 2],
        trees: &PairTrees,
        findings: &mut Findings,
    ) -> (Entry, Entry) {
        let [one, other] = children.map(|(nodes, depths)| {
            let tested = self.tested(trees, nodes, depths, findings);
            Entry { key: tested.key.max(entry.key), ..tested }
        });
        if one > other { (one, other) } else { (other, one) }
    }

    /// Whether a new cut is likely to bound more for the budget: many entries of this one have lost
    /// their slack, or it has grown too fine, or more have lost their slack than the budget can
    /// test.
    fn should_restart(&self, trees: &PairTrees, limit: f64, meter: &Meter, outrun: bool) -> bool {
        let has_lost =
            |entry: &&Entry| entry.at < self.odometer && self.lower(entry, trees) <= limit;
        let lost = || self.open.iter().filter(has_lost).count();
        if self.cost.is_some_and(|cost| DEARER * lost() as u64 > cost) {
            return true;
        }
        if self.built > 0 && meter.affords(3 * self.built as u64) {
            return self.open.len() > 2 * self.built || lost() > self.built / SPENT_SHARE;
        }
        outrun && !meter.affords(lost() as u64)
    }

    /// Tests a face of each of two nodes that stay closed.
    fn peek(&self, nodes: NodePair, trees: &PairTrees, findings: &mut Findings) {
        let [f, g] = [0, 1].map(|i| first_face(trees.sides[i], nodes[i]));
        findings.test(f, g);
    }

    /// The next step at an entry.
    fn step(&self, entry: &Entry, trees: &PairTrees, scope: &Scope) -> Step {
        let lost = self.odometer - entry.at;
        match (entry.tested, scope) {
            (Tested::All, _) if lost <= 0.0 => return Step::Rest { all: true },
            (Tested::OnHulls, Scope::HullFaces(_)) if lost <= 0.0 => {
                return Step::Rest { all: false };
            }
            _ => {}
        }
        let step = scope.step(trees, entry.nodes, entry.depths);
        match step {
            Step::Open(_) if lost > 0.0 && self.regains(lost, entry, trees) => Step::Test,
            Step::Close if lost > 0.0 => Step::Test,
            _ => step,
        }
    }

    /// Whether a test of the boxes regains enough of what motion has reduced, or the entry should
    /// be opened at once.
    fn regains(&self, lost: f64, entry: &Entry, trees: &PairTrees) -> bool {
        let size = |i: usize| trees.sides[i].node(entry.nodes[i]).bounds.diagonal();
        lost > WORTH_A_TEST * size(0).max(size(1))
    }

    fn tested(
        &self,
        trees: &PairTrees,
        nodes: NodePair,
        depths: [u8; 2],
        findings: &mut Findings,
    ) -> Entry {
        findings.counters.node_tests += 1;
        let [first, second] = trees.sides;
        let boxes = [first.node(nodes[0]).bounds, second.node(nodes[1]).bounds];
        let (separation, guess) = trees.boxes.bound_and_guess(&boxes[0], &boxes[1]);
        let key = (self.odometer + separation).next_down();
        Entry { key, guess, at: self.odometer, nodes, depths, tested: Tested::None }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.open.capacity() * size_of::<Entry>()
    }
}

/// Tests the faces of two leaves that the level admits; returns a lower bound of their distance.
fn test_faces(trees: &PairTrees, scope: &Scope, [a, b]: NodePair, findings: &mut Findings) -> f64 {
    let [first, second] = trees.sides;
    let mut least = f64::INFINITY;
    for &f in first.leaf_faces(a).iter().filter(|&&f| scope.admits(Side::First, f)) {
        for &g in second.leaf_faces(b).iter().filter(|&&g| scope.admits(Side::Second, g)) {
            least = least.min(findings.test(f, g));
        }
    }
    least
}

/// A face beneath a node. Cost: the levels beneath the node.
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
