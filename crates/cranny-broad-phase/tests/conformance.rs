//! What every back end must do, checked against brute force after every update.

use cranny_broad_phase::{
    AdaptiveBroadPhase, BoxTree, BroadPhase, BroadPhaseError, Motion, OverlapEvent, OverlapPair,
    ProxyId, SweepAndPrune,
};
use cranny_exact::{Aabb, DVec3};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// The obvious implementation: every box against every other one.
#[derive(Default)]
struct BruteForce {
    boxes: BTreeMap<ProxyId, (Aabb, Motion)>,
    pairs: BTreeSet<OverlapPair>,
}

impl BruteForce {
    fn update(&mut self) -> Vec<OverlapEvent> {
        let mut now = BTreeSet::new();
        for (&a, (box_a, motion_a)) in &self.boxes {
            for (&b, (box_b, motion_b)) in self.boxes.range(a..).skip(1) {
                let of_interest = *motion_a == Motion::Moving || *motion_b == Motion::Moving;
                if of_interest && box_a.overlaps(box_b) {
                    now.insert((a, b));
                }
            }
        }
        let events = self
            .pairs
            .symmetric_difference(&now)
            .map(|pair| match now.contains(pair) {
                true => OverlapEvent::Began(pair.0, pair.1),
                false => OverlapEvent::Ended(pair.0, pair.1),
            })
            .collect();
        self.pairs = now;
        events
    }
}

/// A back end and its oracle, driven alike.
struct Twins<B> {
    tested: B,
    oracle: BruteForce,
}

impl<B: BroadPhase + Default> Twins<B> {
    fn new() -> Self {
        Self { tested: B::default(), oracle: BruteForce::default() }
    }

    fn insert(&mut self, id: u32, aabb: Aabb, motion: Motion) {
        let id = ProxyId(id);
        if self.oracle.boxes.contains_key(&id) {
            let refused = Err(BroadPhaseError::DuplicateProxy { id });
            assert_eq!(self.tested.insert(id, aabb, motion), refused);
        } else {
            assert_eq!(self.tested.insert(id, aabb, motion), Ok(()));
            self.oracle.boxes.insert(id, (aabb, motion));
        }
    }

    fn remove(&mut self, id: u32) {
        let id = ProxyId(id);
        let known = self.oracle.boxes.remove(&id).ok_or(BroadPhaseError::UnknownProxy { id });
        assert_eq!(self.tested.remove(id), known.map(|_| ()));
    }

    fn set_box(&mut self, id: u32, aabb: Aabb) {
        let id = ProxyId(id);
        let known = self.oracle.boxes.get_mut(&id).ok_or(BroadPhaseError::UnknownProxy { id });
        assert_eq!(self.tested.set_box(id, aabb), known.map(|entry| entry.0 = aabb));
    }

    fn set_moving(&mut self, id: u32, motion: Motion) {
        let id = ProxyId(id);
        let known = self.oracle.boxes.get_mut(&id).ok_or(BroadPhaseError::UnknownProxy { id });
        assert_eq!(self.tested.set_moving(id, motion), known.map(|entry| entry.1 = motion));
    }

    /// Updates both and compares events, pairs and boxes.
    fn update(&mut self) -> Vec<OverlapEvent> {
        self.tested.validate().expect("valid before the update");
        let expected = self.oracle.update();
        assert_eq!(self.tested.update(), expected);
        assert!(self.tested.pairs().iter().eq(&self.oracle.pairs));
        assert_eq!(self.tested.len(), self.oracle.boxes.len());
        for (&id, &(aabb, motion)) in &self.oracle.boxes {
            assert_eq!(self.tested.aabb(id), Some(aabb));
            assert_eq!(self.tested.motion(id), Some(motion));
        }
        self.tested.validate().expect("valid after the update");
        expected
    }
}

#[derive(Clone, Debug)]
enum Step {
    Insert(u32, Aabb, Motion),
    Remove(u32),
    SetBox(u32, Aabb),
    SetMoving(u32, Motion),
    Update,
}

fn run<B: BroadPhase + Default>(steps: &[Step]) {
    let mut twins = Twins::<B>::new();
    for step in steps {
        match *step {
            Step::Insert(id, aabb, motion) => twins.insert(id, aabb, motion),
            Step::Remove(id) => twins.remove(id),
            Step::SetBox(id, aabb) => twins.set_box(id, aabb),
            Step::SetMoving(id, motion) => twins.set_moving(id, motion),
            Step::Update => {
                twins.update();
            }
        }
    }
    twins.update();
    assert!(twins.update().is_empty(), "nothing changed, so nothing happened");
}

/// Corners on a small integer lattice: faces coincide all the time, flat boxes and points occur.
fn lattice_box() -> impl Strategy<Value = Aabb> {
    let interval = || (-4i32..4, 0i32..4).prop_map(|(low, size)| (low, low + size));
    [interval(), interval(), interval()].prop_map(|faces| {
        let corner = |pick: fn(&(i32, i32)) -> i32| {
            DVec3::from_array(faces.each_ref().map(|face| f64::from(pick(face))))
        };
        Aabb { min: corner(|face| face.0), max: corner(|face| face.1) }
    })
}

/// Faces a few units in the last place around a lattice, with both zeros and infinite faces.
fn nasty_box() -> impl Strategy<Value = Aabb> {
    let face = || {
        prop_oneof![
            4 => (-2i32..3, -1i32..2).prop_map(|(place, ulps)| match ulps {
                0 => f64::from(place),
                1 => f64::from(place).next_up(),
                _ => f64::from(place).next_down(),
            }),
            1 => prop_oneof![Just(-0.0), Just(f64::INFINITY), Just(f64::NEG_INFINITY)],
        ]
    };
    [[face(), face()], [face(), face()], [face(), face()]].prop_map(|faces| Aabb {
        min: DVec3::from_array(faces.map(|[a, b]| a.min(b))),
        max: DVec3::from_array(faces.map(|[a, b]| a.max(b))),
    })
}

fn motion() -> impl Strategy<Value = Motion> {
    prop_oneof![2 => Just(Motion::Moving), 1 => Just(Motion::Stationary)]
}

/// Every kind of call, on few ids so that duplicates, reuse and unknown ids are common.
fn steps(boxes: impl Strategy<Value = Aabb> + Clone) -> impl Strategy<Value = Vec<Step>> {
    let id = || 0u32..24;
    let step = prop_oneof![
        4 => (id(), boxes.clone(), motion()).prop_map(|(id, b, m)| Step::Insert(id, b, m)),
        2 => id().prop_map(Step::Remove),
        6 => (id(), boxes).prop_map(|(id, b)| Step::SetBox(id, b)),
        2 => (id(), motion()).prop_map(|(id, m)| Step::SetMoving(id, m)),
        3 => Just(Step::Update),
    ];
    prop::collection::vec(step, 1..160)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_calls_on_a_lattice_agree_with_brute_force(steps in steps(lattice_box().boxed())) {
        run::<SweepAndPrune>(&steps);
        run::<BoxTree>(&steps);
        run::<AdaptiveBroadPhase>(&steps);
    }

    #[test]
    fn any_calls_with_faces_ulps_apart_agree_with_brute_force(steps in steps(nasty_box().boxed())) {
        run::<SweepAndPrune>(&steps);
        run::<BoxTree>(&steps);
        run::<AdaptiveBroadPhase>(&steps);
    }
}

/// A small linear congruential generator (Knuth's MMIX constants): the same boxes everywhere.
struct Lcg(u64);

impl Lcg {
    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self, extent: f64) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * extent
    }

    fn cube(&mut self, extent: f64) -> Aabb {
        let min = self.point(extent);
        Aabb { min, max: min + DVec3::splat(1.0) }
    }
}

fn shifted(aabb: Aabb, by: DVec3) -> Aabb {
    Aabb { min: aabb.min + by, max: aabb.max + by }
}

/// 300 unit cubes in a space where each meets a few others, a third of them stationary.
fn populated<B: BroadPhase + Default>(random: &mut Lcg) -> Twins<B> {
    let mut twins = Twins::new();
    for id in 0..300 {
        let motion = if id % 3 == 0 { Motion::Stationary } else { Motion::Moving };
        twins.insert(id * 17, random.cube(8.0), motion);
    }
    assert!(twins.update().len() > 100, "a scene in which something happens");
    twins
}

#[test]
fn small_random_motion_over_many_frames() {
    let mut random = Lcg(1);
    let mut twins = populated::<SweepAndPrune>(&mut random);
    let mut events = 0;
    for frame in 0..150 {
        let everyone = frame % 2 == 0;
        let ids: Vec<_> = twins.oracle.boxes.iter().map(|(&id, &(aabb, _))| (id, aabb)).collect();
        for (id, aabb) in ids {
            if everyone || random.unit() < 0.05 {
                let by = random.point(0.04) - DVec3::splat(0.02);
                twins.set_box(id.0, shifted(aabb, by));
            }
        }
        events += twins.update().len();
        assert_eq!(twins.tested.counters().rebuilds, 0);
    }
    assert!(events > 300, "{events} events");
}

#[test]
fn moving_together_swaps_nothing_and_tests_nothing() {
    let mut twins = populated::<SweepAndPrune>(&mut Lcg(2));
    let ids: Vec<_> = twins.oracle.boxes.iter().map(|(&id, &(aabb, _))| (id, aabb)).collect();
    // A power of two above every coordinate, so that the sums keep order, ties included.
    for (id, aabb) in ids {
        twins.set_box(id.0, shifted(aabb, DVec3::splat(16.0)));
    }
    twins.tested.update();
    assert_eq!(twins.tested.counters().box_tests, 0);
    assert_eq!(twins.tested.counters().swaps, 0);
    assert_eq!(twins.tested.counters().changed, 300);
}

#[test]
fn a_world_that_teleports_is_sorted_anew() {
    let mut random = Lcg(3);
    let mut twins = populated::<SweepAndPrune>(&mut random);
    let ids: Vec<_> = twins.oracle.boxes.keys().copied().collect();
    // One that crosses the world is insertion-sorted ...
    twins.set_box(ids[7].0, shifted(random.cube(8.0), DVec3::splat(100.0)));
    twins.update();
    assert_eq!(twins.tested.counters().rebuilds, 0);
    assert!(twins.tested.counters().swaps > 300);
    // ... all of them at once are not.
    for id in ids {
        twins.set_box(id.0, random.cube(8.0));
    }
    assert!(!twins.update().is_empty());
    assert_eq!(twins.tested.counters().rebuilds, 1);
}

/// Far-apart boxes that trade places have as few neighbours as before, also in the update after.
#[test]
fn boxes_that_trade_places_are_not_near_everything() {
    trade_places::<BoxTree>();
    trade_places::<AdaptiveBroadPhase>();
}

fn trade_places<B: BroadPhase + Default>() {
    let cube = |i: u32| {
        let min = 3.0 * DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100));
        Aabb { min, max: min + DVec3::ONE }
    };
    let mut twins = Twins::<B>::new();
    (0..1_000).for_each(|i| twins.insert(i, cube(i), Motion::Moving));
    twins.update();
    for push in [0.0, 0.01, 0.02] {
        (0..1_000).for_each(|i| twins.set_box(i, shifted(cube(999 - i), DVec3::splat(push))));
        twins.update();
        let tests = twins.tested.counters().box_tests;
        // Of 499,500 pairs.
        assert!(tests < 60_000, "{tests} tests after a push of {push}");
    }
}

#[test]
fn bulk_insertion_removal_and_waking() {
    come_go_and_wake::<SweepAndPrune>();
    come_go_and_wake::<BoxTree>();
    come_go_and_wake::<AdaptiveBroadPhase>();
}

fn come_go_and_wake<B: BroadPhase + Default>() {
    let mut random = Lcg(4);
    let mut twins = populated::<B>(&mut random);
    for id in 0..300 {
        match id % 5 {
            0 => twins.remove(id * 17),
            1 => twins.set_moving(id * 17, Motion::Stationary),
            2 => twins.set_moving(id * 17, Motion::Moving),
            _ => twins.insert(id * 17 + 1, random.cube(8.0), Motion::Moving),
        }
    }
    assert!(twins.update().len() > 50);
    for id in 0..6000 {
        if twins.oracle.boxes.contains_key(&ProxyId(id)) {
            twins.remove(id);
        }
    }
    twins.update();
    assert!(twins.tested.is_empty() && twins.tested.pairs().is_empty());
}

#[test]
fn a_proxy_replaced_under_its_id_is_compared_by_id() {
    replace_one::<SweepAndPrune>();
    replace_one::<BoxTree>();
}

fn replace_one<B: BroadPhase + Default>() {
    let cube = |x: f64| Aabb { min: DVec3::splat(x), max: DVec3::splat(x + 1.0) };
    let mut twins = Twins::<B>::new();
    for id in 0..3 {
        twins.insert(id, cube(f64::from(id)), Motion::Moving);
    }
    assert_eq!(twins.update().len(), 2); // corners touch: (0, 1) and (1, 2)
    twins.remove(1);
    twins.insert(1, cube(0.5), Motion::Moving);
    assert_eq!(twins.update(), [OverlapEvent::Ended(ProxyId(1), ProxyId(2))]);
}

/// A box of which a face moved by less than single precision shows leaves its fat box all the
/// same.
#[test]
fn the_smallest_of_steps_loses_no_pair() {
    the_smallest_of_steps::<SweepAndPrune>();
    the_smallest_of_steps::<BoxTree>();
    the_smallest_of_steps::<AdaptiveBroadPhase>();
}

fn the_smallest_of_steps<B: BroadPhase + Default>() {
    let infinity = f64::INFINITY;
    let slab = |y: (f64, f64), z: (f64, f64)| Aabb {
        min: DVec3::new(-infinity, y.0, z.0),
        max: DVec3::new(0.0, y.1, z.1),
    };
    let mut twins = Twins::<B>::new();
    for id in 0..3 {
        twins.insert(id, Aabb { min: DVec3::ZERO, max: DVec3::ZERO }, Motion::Moving);
    }
    twins.insert(3, slab((-infinity, 0.0), (0.0, 0.0)), Motion::Moving);
    assert_eq!(twins.update().len(), 6);
    // Of infinite steps no room is made, so that the last box is out of the fat one by the smallest
    // number there is.
    let least = f64::from_bits(1);
    for slab in [slab((-2.0, infinity), (-1.0, 0.0)), slab((0.0, 0.0), (0.0, least))] {
        twins.set_box(3, slab);
        assert!(twins.update().is_empty());
    }
}

#[test]
fn boxes_that_stand_still_are_not_touched() {
    let mut twins = populated::<SweepAndPrune>(&mut Lcg(5));
    let ids: Vec<_> = twins.oracle.boxes.iter().map(|(&id, &(aabb, _))| (id, aabb)).collect();
    for (id, aabb) in ids {
        twins.set_box(id.0, aabb);
    }
    assert!(twins.update().is_empty());
    assert_eq!(twins.tested.counters(), Default::default());
}

#[test]
fn bad_boxes_are_refused_and_the_old_box_stays() {
    let mut broad = SweepAndPrune::default();
    let id = ProxyId(u32::MAX);
    let good = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
    let nan = Aabb { min: DVec3::new(f64::NAN, 0.0, 0.0), max: DVec3::ONE };
    assert!(matches!(
        broad.insert(id, nan, Motion::Moving),
        Err(BroadPhaseError::NotANumber { axis: 'x', face: "lower", .. })
    ));
    assert!(broad.is_empty());
    broad.insert(id, good, Motion::Moving).expect("a box");
    assert!(matches!(broad.set_box(id, Aabb::EMPTY), Err(BroadPhaseError::EmptyBox { .. })));
    assert_eq!(broad.aabb(id), Some(good));
}

/// Everybody shifts by up to `step` along each axis, at random.
fn shift_all<B: BroadPhase + Default>(twins: &mut Twins<B>, random: &mut Lcg, step: f64) {
    let boxes: Vec<_> = twins.oracle.boxes.iter().map(|(&id, &(aabb, _))| (id, aabb)).collect();
    for (id, aabb) in boxes {
        let by = random.point(2.0 * step) - DVec3::splat(step);
        twins.set_box(id.0, shifted(aabb, by));
    }
}

#[test]
fn a_tree_is_looked_at_only_where_boxes_leave_their_room() {
    let mut random = Lcg(6);
    let mut twins = populated::<BoxTree>(&mut random);
    assert_eq!(twins.tested.counters().rebuilds, 1);
    let (mut tests, mut events) = (0, 0);
    for _ in 0..100 {
        shift_all(&mut twins, &mut random, 0.005);
        events += twins.update().len();
        tests += twins.tested.counters().box_tests;
        assert_eq!(twins.tested.counters().rebuilds, 0);
    }
    // Brute force would test 44,850 pairs of boxes in each update.
    assert!(events > 100 && tests < 100 * 200, "{events} events, {tests} tests");
}

#[test]
fn a_tree_in_which_a_few_dash_sleep_and_wake_agrees_with_brute_force() {
    let mut random = Lcg(10);
    let mut twins = populated::<BoxTree>(&mut random);
    let mut rebuilds = 0;
    for frame in 0..120 {
        shift_all(&mut twins, &mut random, 0.002);
        let ids: Vec<_> = twins.oracle.boxes.iter().map(|(&id, &(aabb, _))| (id, aabb)).collect();
        // From a handful, each searched for, to a fifth, for which the tree is walked.
        let share = f64::from(frame % 5) * 0.05;
        for (id, aabb) in ids {
            if random.unit() < share {
                twins.set_box(id.0, shifted(aabb, random.point(1.0) - DVec3::splat(0.5)));
            }
            match random.unit() {
                x if x < 0.02 => twins.set_moving(id.0, Motion::Moving),
                x if x < 0.04 => twins.set_moving(id.0, Motion::Stationary),
                x if x < 0.05 => twins.remove(id.0),
                x if x < 0.06 => twins.insert(id.0 + 1, random.cube(8.0), Motion::Moving),
                _ => {}
            }
        }
        twins.update();
        rebuilds += twins.tested.counters().rebuilds;
    }
    assert!((1..60).contains(&rebuilds), "{rebuilds} rebuilds");
}

#[test]
fn a_tree_follows_teleports_infinite_boxes_and_coincident_ones() {
    let mut random = Lcg(7);
    let mut twins = populated::<BoxTree>(&mut random);
    let half_space = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::new(9.0, 4.0, 9.0) };
    twins.insert(1, half_space, Motion::Stationary);
    let far = Aabb { min: DVec3::splat(1e300), max: DVec3::splat(2e300) };
    twins.insert(2, far, Motion::Moving);
    twins.insert(3, shifted(far, DVec3::splat(1.5e300)), Motion::Moving);
    assert!(twins.update().len() > 50);
    for _ in 0..5 {
        shift_all(&mut twins, &mut random, 20.0);
        twins.update();
    }
    for id in 0..300 {
        twins.set_box(id * 17, shifted(Aabb { min: DVec3::ZERO, max: DVec3::ONE }, DVec3::ONE));
    }
    assert!(twins.update().len() > 10_000, "all meet all");
    for _ in 0..3 {
        shift_all(&mut twins, &mut random, 0.001);
        twins.update();
    }
}

#[test]
fn the_adaptive_one_takes_the_tree_while_much_moves_far_and_gives_it_back() {
    let mut random = Lcg(8);
    let mut twins = populated::<AdaptiveBroadPhase>(&mut random);
    let mut changes = Vec::new();
    for frame in 0..120 {
        // 40 updates each of small steps, large ones, and small ones again.
        let step = if frame / 40 == 1 { 0.1 } else { 0.001 };
        shift_all(&mut twins, &mut random, step);
        twins.update();
        let tree = twins.tested.counters().tree == 1;
        if changes.last().map_or(tree, |&(_, last)| last != tree) {
            changes.push((frame, tree));
        }
    }
    let [(up, true), (down, false)] = changes[..] else { panic!("{changes:?}") };
    assert!((41..60).contains(&up) && (81..100).contains(&down), "{changes:?}");
}

#[test]
fn one_jolt_does_not_change_the_index() {
    let mut random = Lcg(9);
    let mut twins = populated::<AdaptiveBroadPhase>(&mut random);
    for frame in 0..60 {
        shift_all(&mut twins, &mut random, if frame % 6 == 0 { 1.0 } else { 0.001 });
        twins.update();
        assert_eq!(twins.tested.counters().tree, 0);
    }
}
