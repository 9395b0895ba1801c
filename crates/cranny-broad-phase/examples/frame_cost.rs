//! What an update costs, against brute force on the same boxes in the same run.
//!
//! Unit cubes at random, each meeting 2.8 others on average; a moving box shifts by up to 1 % of
//! its size along each axis in a frame. Prints medians in microseconds. Brute force tests every
//! pair in which at least one box moved, which is the least that it can do without an order.
//!
//! `cargo run --release -p cranny-broad-phase --example frame_cost [-- LARGEST_NUMBER_OF_BOXES]`

#![expect(clippy::print_stdout, reason = "printing a table is what it is for")]

use cranny_broad_phase::{BroadPhase, BroadPhaseError, Motion, ProxyId, SweepAndPrune};
use cranny_exact::{Aabb, DVec3};
use std::time::Instant;

const PARTNERS: f64 = 2.8;
const STEP: f64 = 0.01;

fn main() -> Result<(), BroadPhaseError> {
    let largest = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(10_000);
    println!(
        "{:>7} {:>9} | {:>9} {:>9} {:>8} {:>6} | {:>11} {:>7}",
        "boxes", "moving", "update us", "swaps", "tests", "events", "brute us", "ratio"
    );
    for boxes in [1_000, 10_000, 100_000] {
        if boxes <= largest {
            for one_in in [1, 100] {
                measure(boxes, one_in)?;
            }
            bulk(boxes)?;
        }
    }
    Ok(())
}

/// A linear congruential generator (Knuth's MMIX constants).
struct Lcg(u64);

impl Lcg {
    fn unit(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

fn scene(boxes: u32, random: &mut Lcg) -> Vec<Aabb> {
    // Two unit cubes at random in a cube of edge L meet with probability (2 / L)^3.
    let edge = 2.0 * (f64::from(boxes) / PARTNERS).cbrt();
    let cube = |min| Aabb { min, max: min + DVec3::ONE };
    (0..boxes).map(|_| cube(random.point() * edge)).collect()
}

fn filled(scene: &[Aabb]) -> Result<SweepAndPrune, BroadPhaseError> {
    let mut broad = SweepAndPrune::default();
    for (id, &aabb) in (0..).map(ProxyId).zip(scene) {
        broad.insert(id, aabb, Motion::Moving)?;
    }
    Ok(broad)
}

fn measure(boxes: u32, one_in: usize) -> Result<(), BroadPhaseError> {
    let mut random = Lcg(42);
    let mut scene = scene(boxes, &mut random);
    let mut broad = filled(&scene)?;
    broad.update();
    let (mut times, mut swaps, mut tests, mut events) = (vec![], vec![], vec![], vec![]);
    for frame in 0..60 {
        let moved: Vec<usize> = (frame % one_in..scene.len()).step_by(one_in).collect();
        for &i in &moved {
            let by = (random.point() - DVec3::splat(0.5)) * (2.0 * STEP);
            scene[i] = Aabb { min: scene[i].min + by, max: scene[i].max + by };
        }
        let start = Instant::now();
        for &i in &moved {
            broad.set_box(ProxyId(i as u32), scene[i])?;
        }
        events.push(broad.update().len() as f64);
        times.push(start.elapsed().as_secs_f64() * 1e6);
        swaps.push(broad.counters().swaps as f64);
        tests.push(broad.counters().box_tests as f64);
    }
    let (brute, pairs) = brute_force(&scene, one_in);
    if one_in == 1 {
        assert_eq!(pairs, broad.pairs().len(), "both count the same pairs");
    }
    let update = median(&mut times);
    println!(
        "{boxes:>7} {:>9} | {update:>9.1} {:>9} {:>8} {:>6} | {brute:>11.0} {:>7.0}",
        format!("1 in {one_in}"),
        median(&mut swaps),
        median(&mut tests),
        median(&mut events),
        brute / update
    );
    Ok(())
}

/// Microseconds to test every pair of which one moves, and the overlaps found.
fn brute_force(scene: &[Aabb], one_in: usize) -> (f64, usize) {
    let start = Instant::now();
    let mut pairs = 0;
    for i in (0..scene.len()).step_by(one_in) {
        let others = if one_in == 1 { &scene[i + 1..] } else { scene };
        pairs += others.iter().filter(|other| scene[i].overlaps(other)).count();
    }
    (start.elapsed().as_secs_f64() * 1e6, pairs)
}

fn bulk(boxes: u32) -> Result<(), BroadPhaseError> {
    let mut random = Lcg(43);
    let mut broad = filled(&scene(boxes, &mut random))?;
    let timed = |broad: &mut SweepAndPrune| {
        let start = Instant::now();
        broad.update();
        start.elapsed().as_secs_f64() * 1e6
    };
    let insert_all = timed(&mut broad);
    let pairs = broad.pairs().len();
    broad.remove(ProxyId(boxes / 2))?;
    let remove_one = timed(&mut broad);
    broad.insert(ProxyId(boxes / 2), scene(1, &mut random)[0], Motion::Moving)?;
    let insert_one = timed(&mut broad);
    for (id, &aabb) in (0..).map(ProxyId).zip(&scene(boxes, &mut random)) {
        broad.set_box(id, aabb)?;
    }
    let teleport_all = timed(&mut broad);
    println!(
        "        insert all {insert_all:.0} us ({pairs} pairs), insert one {insert_one:.0} us, remove one \
         {remove_one:.0} us, teleport all {teleport_all:.0} us"
    );
    Ok(())
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
