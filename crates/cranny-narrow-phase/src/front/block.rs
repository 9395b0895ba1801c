//! A block of the front: some of its entries, which rest together.
//!
//! A block counts on an *odometer* how far its bodies can have come nearer to each other within it. An
//! entry whose separation was found to be at least `s` when the odometer stood at `o` has the key
//! `o + s`: what is left of the slack is the key less what the odometer shows. A block whose least key
//! is beyond reach is not opened.

use cranny_exact::Aabb;
use cranny_geometry::FaceTree;

use super::Quest;
use super::motion::{Ball, Motion};
use crate::answer::Counters;
use crate::descent::{BoxTest, Opened, opened};

/// Entries a block at most, when it is built. Fewer: more odometers to read; more: more entries to pass over
/// for one that is spent.
pub(super) const CAPACITY: usize = 64;

/// A pair of nodes: one of the first tree, one of the second.
pub(crate) type Nodes = [u32; 2];

/// A pair of nodes that is not opened further.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) nodes: Nodes,
    pub(super) key: f64,
}

/// Some entries, in the order of the descent, and what is known of them together.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) entries: Vec<Entry>,
    /// What the entries are the leaves of: a descent from here finds them anew.
    roots: Vec<Nodes>,
    pub(super) balls: [Ball; 2],
    pub(super) odometer: f64,
    last_step: f64,
    /// The longest way of the last step on the one screw motion that all blocks share; infinite if unknown.
    last_way: f64,
    pub(super) least: f64,
    /// Entries when it was built.
    built: usize,
    /// Entries looked at again since.
    worn: usize,
}

/// What came of opening a block.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Opening {
    pub(super) tested: usize,
    pub(super) split: usize,
    /// From the last pose to this one, the bodies can be moved without the faces of any entry meeting.
    pub(super) unbroken: bool,
}

/// The trees of a pair and the test of their boxes.
pub(crate) struct Ground<'a> {
    pub(crate) trees: [&'a FaceTree; 2],
    pub(crate) boxes: BoxTest,
    /// What posing may have eaten of any slack.
    pub(crate) error: f64,
}

impl Ground<'_> {
    fn separation(&self, [a, b]: Nodes) -> f64 {
        let [first, second] = self.trees;
        self.boxes.distance_lower(&first.node(a).bounds, &second.node(b).bounds)
    }

    /// The pairs that a pair opens into, or `None` for two leaves.
    fn children(&self, [a, b]: Nodes) -> Option<[Nodes; 2]> {
        let [first, second] = self.trees;
        let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
        match opened(first.content(a), second.content(b), box_a, box_b) {
            Opened::First(left, right) => Some([[left, b], [right, b]]),
            Opened::Second(left, right) => Some([[a, left], [a, right]]),
            Opened::Neither => None,
        }
    }

    /// What is known of a pair: a separation beyond the quest's limit, or that of two leaves; `Err`
    /// with what it opens into.
    fn judged(
        &self,
        nodes: Nodes,
        quest: &mut impl Quest,
        counters: &mut Counters,
    ) -> Result<f64, [Nodes; 2]> {
        counters.node_tests += 1;
        let separation = self.separation(nodes);
        if separation > quest.limit() {
            return Ok(separation);
        }
        match self.children(nodes) {
            Some(children) => Err(children),
            None => {
                let [first, second] = self.trees;
                let (f, g) = (first.leaf_faces(nodes[0]), second.leaf_faces(nodes[1]));
                Ok(quest.leaves(f, g, counters).max(separation))
            }
        }
    }
}

/// A stretch of entries that are all those beneath one pair of nodes.
struct Group {
    root: Nodes,
    start: usize,
}

/// Descends from some pairs, and packs what is found into blocks whose odometers stand at 0.
pub(super) fn build(
    ground: &Ground,
    roots: impl Iterator<Item = Nodes>,
    quest: &mut impl Quest,
    counters: &mut Counters,
) -> Vec<Block> {
    enum Visit {
        Enter(Nodes),
        /// All beneath has been seen, the first of it being this entry.
        Leave(Nodes, usize),
    }
    let mut entries: Vec<Entry> = Vec::new();
    let mut groups: Vec<Group> = Vec::new();
    let mut stack: Vec<Visit> = Vec::new();
    for root in roots {
        stack.push(Visit::Enter(root));
        while let Some(visit) = stack.pop() {
            match visit {
                Visit::Enter(nodes) => match ground.judged(nodes, quest, counters) {
                    Ok(key) => {
                        groups.push(Group { root: nodes, start: entries.len() });
                        entries.push(Entry { nodes, key });
                        if quest.is_done() {
                            return Vec::new();
                        }
                    }
                    Err([left, right]) => {
                        stack.push(Visit::Leave(nodes, entries.len()));
                        stack.extend([Visit::Enter(right), Visit::Enter(left)]);
                    }
                },
                Visit::Leave(root, start) => {
                    if entries.len() - start <= CAPACITY {
                        while groups.last().is_some_and(|g| g.start >= start) {
                            groups.pop();
                        }
                        groups.push(Group { root, start });
                    }
                }
            }
        }
    }
    pack(ground, &entries, &groups)
}

/// Neighbouring groups share a block as long as they fit.
fn pack(ground: &Ground, entries: &[Entry], groups: &[Group]) -> Vec<Block> {
    let end_of = |i: usize| groups.get(i + 1).map_or(entries.len(), |g| g.start);
    let mut blocks = Vec::new();
    let mut first = 0;
    while first < groups.len() {
        let start = groups[first].start;
        let mut last = first;
        while last + 1 < groups.len() && end_of(last + 1) - start <= CAPACITY {
            last += 1;
        }
        let roots = groups[first..=last].iter().map(|g| g.root).collect();
        blocks.push(Block::new(ground, &entries[start..end_of(last)], roots));
        first = last + 1;
    }
    blocks
}

impl Block {
    fn new(ground: &Ground, entries: &[Entry], roots: Vec<Nodes>) -> Self {
        let ball = |side: usize| {
            let boxes = roots.iter().map(|nodes| ground.trees[side].node(nodes[side]).bounds);
            Ball::around(&boxes.fold(Aabb::EMPTY, |all, b| all.union(&b)))
        };
        let mut block = Self {
            balls: [ball(0), ball(1)],
            entries: entries.to_vec(),
            roots,
            odometer: 0.0,
            last_step: 0.0,
            last_way: 0.0,
            least: 0.0,
            built: entries.len(),
            worn: 0,
        };
        block.find_least();
        block
    }

    fn find_least(&mut self) {
        self.least = self.entries.iter().map(|e| e.key).fold(f64::INFINITY, f64::min);
    }

    /// Counts a motion; without one, nothing has moved since the last.
    pub(super) fn advance(&mut self, motion: Option<&Motion>) {
        self.last_step = match motion {
            Some(motion) => motion.step(&self.balls),
            None => 0.0,
        };
        self.last_way = match motion.map(Motion::way_factor) {
            Some(Some(factor)) => factor * self.last_step,
            Some(None) => f64::INFINITY,
            None => 0.0,
        };
        if self.last_step > 0.0 {
            self.odometer = (self.odometer + self.last_step).next_up();
        }
    }

    /// The key up to which entries must be looked at if gaps up to `limit` matter.
    fn spent_below(&self, limit: f64, error: f64) -> f64 {
        (self.odometer + (limit + error)).next_up()
    }

    pub(super) fn is_spent(&self, limit: f64, error: f64) -> bool {
        self.least <= self.spent_below(limit, error)
    }

    pub(super) fn spent_entries(&self, limit: f64, error: f64) -> usize {
        let below = self.spent_below(limit, error);
        if self.least > below {
            return 0;
        }
        self.entries.iter().filter(|e| e.key <= below).count()
    }

    /// Whether a descent from its roots would leave less to look at, by all experience.
    pub(super) fn is_worn(&self) -> bool {
        self.entries.len() > self.built + self.built / 4 + 2 || self.worn > 8 * self.entries.len()
    }

    pub(super) fn roots(&self) -> impl Iterator<Item = Nodes> + '_ {
        self.roots.iter().copied()
    }

    /// Looks at spent entries again and opens those that are too near; `kept` is scratch memory.
    pub(super) fn refresh(
        &mut self,
        ground: &Ground,
        quest: &mut impl Quest,
        kept: &mut Vec<Entry>,
        counters: &mut Counters,
    ) -> Opening {
        kept.clear();
        let mut opening = Opening { tested: 0, split: 0, unbroken: true };
        let mut stack: Vec<Nodes> = Vec::new();
        for entry in &self.entries {
            if entry.key > self.spent_below(quest.limit(), ground.error) || quest.is_done() {
                kept.push(*entry);
                continue;
            }
            opening.tested += 1;
            let before = kept.len();
            let mut nearest = f64::INFINITY;
            stack.push(entry.nodes);
            while let Some(nodes) = stack.pop() {
                match ground.judged(nodes, quest, counters) {
                    Ok(separation) => {
                        nearest = nearest.min(separation);
                        let key = (self.odometer + separation).next_down();
                        kept.push(Entry { nodes, key });
                    }
                    Err([left, right]) => stack.extend([right, left]),
                }
            }
            opening.split += kept.len() - before - 1;
            // Somewhere on the way, what was left before and what was found now may both be spent.
            let left_before = entry.key - (self.odometer - self.last_step);
            opening.unbroken &= left_before.max(0.0) + nearest > self.last_way + 4.0 * ground.error;
        }
        std::mem::swap(&mut self.entries, kept);
        self.worn += opening.tested;
        self.find_least();
        opening
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.entries.capacity() * size_of::<Entry>()
            + self.roots.capacity() * size_of::<Nodes>()
    }
}
