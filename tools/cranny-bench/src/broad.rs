//! Overlapping boxes from frame to frame: our back ends against parry's `Bvh`, exact and with a
//! skin.
//!
//! Unit cubes at random, 2.8 partners each. All see the same boxes in every frame, and keep the
//! list of pairs: ours the exact ones, sorted, with what began and ended; parry's tree the pairs of
//! its own boxes, unsorted where it keeps none (exact), the difference merged in where it does
//! (skin).

use cpu_time::ThreadTime;
use cranny_broad_phase::{
    AdaptiveBroadPhase, BoxTree, BroadPhase, BroadPhaseCounters, BroadPhaseError, Motion, ProxyId,
    SweepAndPrune,
};
use cranny_exact::{Aabb, DVec3};
use parry3d::bounding_volume::{Aabb as Single, BoundingVolume};
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use crate::cloud::Random;
use crate::count::Work;
use crate::report::{Cell, Report, Table};
use crate::stopwatch::{keep, median};

/// Partners of a box, on average.
const PARTNERS: f64 = 2.8;

/// The skin of parry's boxes, as a share of their size.
const SKIN: f32 = 0.05;

/// How the boxes of a scene move.
#[derive(Clone, Copy)]
enum Gait {
    /// Along each axis by up to this share of their size, anew in each frame.
    Random(f64),
    /// By up to this along each axis, always the same way, back at the walls.
    Straight(f64),
}

struct BroadCase {
    boxes: usize,
    /// One in so many moves in a frame.
    one_in: usize,
    gait: Gait,
}

impl BroadCase {
    fn name(&self) -> String {
        let who = if self.one_in == 1 { "all".into() } else { format!("1 in {}", self.one_in) };
        let how = match self.gait {
            Gait::Random(size) => format!("random {} %", 100.0 * size),
            Gait::Straight(size) => format!("straight {} %", 100.0 * size),
        };
        format!("{}, {who} {how}", self.boxes)
    }
}

/// Measures the scenes whose name contains `only`.
pub(crate) fn measure(quick: bool, only: &str) -> Report {
    let sizes: &[usize] = if quick { &[1_000, 10_000] } else { &[1_000, 10_000, 100_000] };
    let frames = if quick { 60 } else { 200 };
    let gaits = [
        (1, Gait::Random(0.01)),
        (100, Gait::Random(0.01)),
        (1, Gait::Straight(0.01)),
        (1, Gait::Random(0.1)),
    ];
    let cases = sizes.iter().flat_map(|&boxes| {
        gaits.into_iter().map(move |(one_in, gait)| BroadCase { boxes, one_in, gait })
    });
    let rows = cases
        .filter(|case| case.name().contains(only))
        .map(|case| row(&case, if case.boxes > 50_000 { frames / 5 } else { frames }));
    Report {
        title: "Broad phase",
        notes: vec![
            "cranny: f64, exact, sorted pairs and events; parry: `Bvh`, f32; a skin is 5 % of a box's size".into(),
            "same run, same boxes, in turns of 20 frames; medians of thread CPU time a frame, setting the boxes included; p99: of the adaptive one".into(),
            "ratios: parry's time / the adaptive one's".into(),
        ],
        tables: vec![Table {
            title: "Unit cubes, 2.8 partners each",
            columns: vec![
                "boxes, motion", "swaps", "tests", "sweep", "tree", "adaptive", "p99", "is", "parry exact",
                "parry skin", "exact / ad.", "skin / ad.",
            ],
            rows: rows.collect(),
        }, bulk(sizes, only)],
    }
}

/// Measures an index over so many boxes.
type BulkRow = fn(String, usize) -> Vec<Cell>;

/// Changes that are not motion, in the sorted axes and the tree.
fn bulk(sizes: &[usize], only: &str) -> Table {
    let indices: [(_, BulkRow); 2] =
        [("sweep", bulk_row::<SweepAndPrune>), ("tree", bulk_row::<BoxTree>)];
    let cases = sizes.iter().flat_map(|&boxes| {
        indices.map(|(index, row)| (format!("{boxes} in bulk, {index}"), boxes, row))
    });
    let wanted = cases.filter(|(name, ..)| name.contains(only));
    let rows = wanted.map(|(name, boxes, row)| row(name, boxes)).collect();
    Table {
        title: "Changes in bulk, each once",
        columns: vec!["boxes, index", "insert all", "remove one", "insert one", "teleport all"],
        rows,
    }
}

fn bulk_row<B: BroadPhase + Default>(name: String, boxes: usize) -> Vec<Cell> {
    let mut broad = B::default();
    let first = CubeScene::new(boxes).cubes;
    // Every box where another one was.
    let elsewhere = first.iter().rev();
    let ids = || (0..).map(ProxyId);
    let mut times = vec![Cell::Text(name)];
    let mut timed = |broad: &mut B| {
        let start = ThreadTime::now();
        keep(broad.update().len());
        times.push(Cell::Micros(start.elapsed().as_secs_f64() * 1e6));
    };
    for (id, &cube) in ids().zip(&first) {
        keep(broad.insert(id, cube, Motion::Moving));
    }
    timed(&mut broad);
    let middle = boxes / 2;
    keep(broad.remove(ProxyId(middle as u32)));
    timed(&mut broad);
    keep(broad.insert(ProxyId(middle as u32), first[middle], Motion::Moving));
    timed(&mut broad);
    for (id, &cube) in ids().zip(elsewhere) {
        keep(broad.set_box(id, cube));
    }
    timed(&mut broad);
    times
}

/// Cubes and how they go.
struct CubeScene {
    cubes: Vec<Aabb>,
    ways: Vec<DVec3>,
    edge: f64,
    random: Random,
}

impl CubeScene {
    fn new(boxes: usize) -> Self {
        // Two unit cubes at random in a cube of edge L meet with probability (2 / L)^3.
        let edge = 2.0 * (boxes as f64 / PARTNERS).cbrt();
        let mut random = Random::new();
        let mut cube = || {
            let min = 0.5 * edge * (random.in_cube() + DVec3::ONE);
            Aabb { min, max: min + DVec3::ONE }
        };
        let cubes: Vec<Aabb> = (0..boxes).map(|_| cube()).collect();
        let ways = (0..boxes).map(|_| random.in_cube()).collect();
        Self { cubes, ways, edge, random }
    }

    /// Moves the cubes whose turn it is; their numbers, and where they are now.
    fn step(&mut self, frame: usize, case: &BroadCase) -> Step {
        let moved: Vec<usize> = (frame % case.one_in..case.boxes).step_by(case.one_in).collect();
        for &i in &moved {
            let by = match case.gait {
                Gait::Random(size) => self.random.in_cube() * size,
                Gait::Straight(size) => {
                    for axis in 0..3 {
                        let place = self.cubes[i].min[axis];
                        if (place < 0.0) != (self.ways[i][axis] > 0.0)
                            && !(0.0..self.edge).contains(&place)
                        {
                            self.ways[i][axis] *= -1.0;
                        }
                    }
                    self.ways[i] * size
                }
            };
            let Aabb { min, max } = self.cubes[i];
            self.cubes[i] = Aabb { min: min + by, max: max + by };
        }
        moved.into_iter().map(|i| (i as u32, self.cubes[i])).collect()
    }
}

/// The boxes that are elsewhere in a frame.
type Step = Vec<(u32, Aabb)>;

/// Frames that a contestant runs before the next one has its turn on the same frames: what it keeps
/// is in the caches, as in a program that has one.
const BLOCK: usize = 20;

/// What is timed: one frame's boxes in, pairs up to date.
trait BroadContestant {
    fn frame(&mut self, step: &Step);
    fn pair_count(&self) -> usize;

    fn counters(&self) -> BroadPhaseCounters {
        BroadPhaseCounters::default()
    }
}

impl<B: BroadPhase> BroadContestant for B {
    fn frame(&mut self, step: &Step) {
        for &(id, cube) in step {
            // Known ids and sound boxes: nothing is refused, and pairs are compared afterwards.
            keep(self.set_box(ProxyId(id), cube));
        }
        keep(self.update().len());
    }

    fn pair_count(&self) -> usize {
        self.pairs().len()
    }

    fn counters(&self) -> BroadPhaseCounters {
        BroadPhase::counters(self)
    }
}

/// So many frames of so many cubes, of which one in `one_in` moves by up to 1 % of its size, after
/// a block of frames to choose a back end in.
pub(crate) fn work(boxes: usize, one_in: usize, frames: usize) -> Option<Work<'static>> {
    let case = BroadCase { boxes, one_in, gait: Gait::Random(0.01) };
    let mut scene = CubeScene::new(boxes);
    let mut broad: AdaptiveBroadPhase = filled(&scene.cubes).ok()?;
    for frame in 0..BLOCK {
        broad.frame(&scene.step(frame, &case));
    }
    let steps: Vec<Step> = (BLOCK..BLOCK + frames).map(|frame| scene.step(frame, &case)).collect();
    Some(Box::new(move || steps.iter().for_each(|step| broad.frame(step))))
}

fn filled<B: BroadPhase + Default>(cubes: &[Aabb]) -> Result<B, BroadPhaseError> {
    let mut broad = B::default();
    for (i, &cube) in cubes.iter().enumerate() {
        broad.insert(ProxyId(i as u32), cube, Motion::Moving)?;
    }
    broad.update();
    Ok(broad)
}

fn single(cube: &Aabb) -> Single {
    let vector = |p: DVec3| Vector::new(p.x as f32, p.y as f32, p.z as f32);
    Single { mins: vector(cube.min), maxs: vector(cube.max) }
}

/// parry's tree: leaves set, refitted, walked against itself as a whole.
struct ExactTree {
    tree: Bvh,
    workspace: BvhWorkspace,
    pairs: Vec<(u32, u32)>,
}

/// The same with a skin: only what changed is walked; pairs are kept, and dropped when the fat
/// boxes part.
struct SkinTree {
    tree: Bvh,
    workspace: BvhWorkspace,
    pairs: Vec<u64>,
    new: Vec<u64>,
}

fn tree_of(cubes: &[Aabb], skin: f32) -> Bvh {
    let leaves = cubes.iter().enumerate().map(|(i, cube)| (i, single(cube).loosened(skin)));
    Bvh::from_iter(BvhBuildStrategy::Binned, leaves)
}

impl BroadContestant for ExactTree {
    fn frame(&mut self, step: &Step) {
        let Self { tree, workspace, pairs } = self;
        for (id, cube) in step {
            tree.insert_or_update_partially(single(cube), *id, 0.0);
        }
        tree.refit(workspace);
        pairs.clear();
        tree.traverse_bvtt_single_tree::<false>(workspace, &mut |a, b| pairs.push((a, b)));
    }

    fn pair_count(&self) -> usize {
        self.pairs.len()
    }
}

impl BroadContestant for SkinTree {
    fn frame(&mut self, step: &Step) {
        let Self { tree, workspace, pairs, new } = self;
        for (id, cube) in step {
            tree.insert_or_update_partially(single(cube), *id, SKIN);
        }
        tree.refit(workspace);
        new.clear();
        tree.traverse_bvtt_single_tree::<true>(workspace, &mut |a, b| {
            new.push(u64::from(a.min(b)) << 32 | u64::from(a.max(b)));
        });
        pairs.retain(|&pair| {
            let node = |leaf| tree.leaf_node(leaf);
            let both = node((pair >> 32) as u32).zip(node(pair as u32));
            both.is_some_and(|(a, b)| !(a.is_changed() || b.is_changed()) || a.intersects(b))
        });
        new.sort_unstable();
        pairs.extend_from_slice(new);
        pairs.sort();
        pairs.dedup();
    }

    fn pair_count(&self) -> usize {
        self.pairs.len()
    }
}

fn row(case: &BroadCase, frames: usize) -> Vec<Cell> {
    try_row(case, frames).unwrap_or_else(|error| {
        let mut cells = vec![Cell::Absent; 12];
        cells[0] = Cell::Text(error.to_string());
        cells
    })
}

fn try_row(case: &BroadCase, frames: usize) -> Result<Vec<Cell>, BroadPhaseError> {
    let mut scene = CubeScene::new(case.boxes);
    let mut sweep: SweepAndPrune = filled(&scene.cubes)?;
    let mut tree: BoxTree = filled(&scene.cubes)?;
    let mut adaptive: AdaptiveBroadPhase = filled(&scene.cubes)?;
    let mut exact = ExactTree {
        tree: tree_of(&scene.cubes, 0.0),
        workspace: BvhWorkspace::default(),
        pairs: Vec::new(),
    };
    let mut skin = SkinTree {
        tree: tree_of(&scene.cubes, SKIN),
        workspace: BvhWorkspace::default(),
        pairs: Vec::new(),
        new: Vec::new(),
    };
    skin.tree.traverse_bvtt_single_tree::<false>(&mut skin.workspace, &mut |a, b| {
        skin.pairs.push(u64::from(a.min(b)) << 32 | u64::from(a.max(b)));
    });
    skin.pairs.sort_unstable();
    let mut times: [Vec<f64>; 5] = Default::default();
    let (mut swaps, mut tests) = (Vec::new(), Vec::new());
    // The adaptive one is given a block to choose in: what is timed is motion that goes on.
    for block in 0..=frames / BLOCK {
        let steps: Vec<Step> = (0..BLOCK).map(|n| scene.step(block * BLOCK + n, case)).collect();
        let mut run = |contestant: &mut dyn BroadContestant, turn: usize| {
            for step in &steps {
                let start = ThreadTime::now();
                contestant.frame(step);
                if block > 0 {
                    times[turn].push(start.elapsed().as_secs_f64() * 1e6);
                }
                let counters = contestant.counters();
                match turn {
                    0 => swaps.push(counters.swaps as f64),
                    1 => tests.push(counters.box_tests as f64),
                    _ => {}
                }
            }
        };
        run(&mut sweep, 0);
        run(&mut tree, 1);
        run(&mut adaptive, 2);
        run(&mut exact, 3);
        run(&mut skin, 4);
    }
    assert_eq!(sweep.pairs(), tree.pairs(), "all tell the same pairs");
    assert_eq!(sweep.pairs(), adaptive.pairs(), "all tell the same pairs");
    // In single precision a pair or two may be others.
    let (ours, theirs) = (sweep.pair_count(), exact.pair_count());
    assert!(ours.abs_diff(theirs) <= 1 + ours / 1000, "{ours} pairs, parry {theirs}");
    assert!(skin.pair_count() >= theirs, "a skin loses no pair");
    let is = if BroadPhase::counters(&adaptive).tree == 1 { "tree" } else { "sweep" };
    let p99 = percentile(&times[2], 0.99);
    let [sweep, tree, adaptive, exact, skin] = times.map(median);
    Ok(vec![
        Cell::Text(case.name()),
        Cell::Count(median(swaps) as usize),
        Cell::Count(median(tests) as usize),
        Cell::Micros(sweep),
        Cell::Micros(tree),
        Cell::Micros(adaptive),
        Cell::Micros(p99),
        Cell::Text(is.into()),
        Cell::Micros(exact),
        Cell::Micros(skin),
        Cell::Ratio(exact / adaptive),
        Cell::Ratio(skin / adaptive),
    ])
}

fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = (share * sorted.len() as f64) as usize;
    sorted.get(place.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
}
