//! Regions keep their names while they last.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, RegionId, query};
use cranny_shapes::{Comb, Cuboid, Sphere, Torus};
use cranny_testkit::Rng;

use crate::solids::{at, channel, model, shape};

fn ask(a: Placed, b: Placed, margin: f64, memory: &mut PairMemory) -> Answer {
    query(a, b, &Query::of(Demand::Regions { margin }), memory).unwrap()
}

/// The ids, ascending.
fn names(answer: &Answer) -> Vec<u32> {
    let mut names: Vec<u32> = answer.regions.iter().map(|region| region.id.0).collect();
    names.sort_unstable();
    names
}

/// The name of the region whose deepest point has the least x, and of the one whose has the most.
fn ends(answer: &Answer) -> [RegionId; 2] {
    let x = |k: usize| answer.regions[k].deepest.point_a.x;
    let order = if x(0) < x(1) { [0, 1] } else { [1, 0] };
    assert_eq!(answer.regions.len(), 2);
    order.map(|k| answer.regions[k].id)
}

/// Two legs, one unit wide and high, of which the plate is `y` above the bar's underside; they end
/// at 2.
struct Legs {
    legs: Model,
    plate: Model,
}

impl Legs {
    fn new() -> Self {
        Self { legs: model(channel()), plate: shape(Cuboid { size: [6.0, 1.0, 6.0] }) }
    }

    fn ask(&self, y: f64, lean: f64, memory: &mut PairMemory) -> Answer {
        let rotation = DQuat::from_axis_angle(DVec3::Z, lean);
        let translation = DVec3::new(1.3, y + 0.5, 1.1);
        let plate = Placed { model: &self.plate, pose: Pose { rotation, translation } };
        ask(at(&self.legs, 0.0, 0.0, 0.0), plate, 0.0, memory)
    }
}

#[test]
fn a_foot_that_lifts_loses_its_name_and_the_other_keeps_its() {
    let (legs, mut memory) = (Legs::new(), PairMemory::default());
    let both = legs.ask(1.9, 0.0, &mut memory);
    let [left, right] = ends(&both);
    assert_ne!(left, right);
    assert!(both.regions.iter().all(|region| region.from.is_empty()));
    for step in 0..20 {
        let answer =
            legs.ask(1.9 + 0.002 * f64::from(step % 7), 0.002 * f64::from(step % 5), &mut memory);
        assert_eq!(ends(&answer), [left, right], "step {step}");
        assert!(answer.regions.iter().all(|region| region.from == [region.id]), "step {step}");
    }
    // Leaning, it leaves the right leg.
    let one = legs.ask(1.98, 0.08, &mut memory);
    assert_eq!(one.regions.len(), 1);
    let stays = one.regions[0].id;
    assert!(stays == left || stays == right);
    let again = legs.ask(1.9, 0.0, &mut memory);
    assert!(ends(&again).contains(&stays), "{:?}", ends(&again));
    let newer = ends(&again).into_iter().find(|&id| id != stays).unwrap();
    assert_eq!(newer, RegionId(2));
}

#[test]
fn regions_merge_and_split() {
    let (legs, mut memory) = (Legs::new(), PairMemory::default());
    assert_eq!(names(&legs.ask(1.5, 0.0, &mut memory)), [0, 1]);
    let one = legs.ask(0.9, 0.0, &mut memory);
    assert_eq!(one.regions.len(), 1);
    assert_eq!(one.regions[0].from, [RegionId(0), RegionId(1)]);
    let kept = one.regions[0].id;
    assert!(kept.0 < 2);
    let two = legs.ask(1.5, 0.0, &mut memory);
    assert_eq!(names(&two), [kept.0, 2]);
    assert!(two.regions.iter().all(|region| region.from == [kept]));
}

#[test]
fn names_outlast_rest_exchange_and_skipped_queries_but_not_the_memory() {
    let ring = shape(Torus { major_segments: 48, minor_segments: 12, ..Torus::default() });
    let plate = shape(Cuboid { size: [4.0, 4.0, 0.5] });
    let mut memory = PairMemory::default();
    // A ring of the same model beside the other, which it crosses twice, and a plate that stands in
    // it.
    for (other, turn, aside) in [(&ring, 0.3, 1.3), (&plate, 1.5, 0.2)] {
        memory.clear();
        let rotation = DQuat::from_axis_angle(DVec3::X, turn);
        let posed = |x: f64| Pose { rotation, translation: DVec3::new(aside + x, 0.05, 0.02) };
        let a = at(&ring, 0.0, 0.0, 0.0);
        let first = ask(a, Placed { model: other, pose: posed(0.0) }, 0.0, &mut memory);
        let all = names(&first);
        assert_eq!(all, [0, 1]);
        for step in 0..24 {
            let b = Placed { model: other, pose: posed(1e-3 * f64::from(step / 3)) };
            if step % 5 == 4 {
                continue;
            }
            let answer = match step % 2 {
                0 => ask(a, b, 0.0, &mut memory),
                _ => ask(b, a, 0.0, &mut memory).swapped(),
            };
            // What else is queried in between takes no names away.
            query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
            assert_eq!(ends(&answer), ends(&first), "step {step}");
            let cold = ask(a, b, 0.0, &mut PairMemory::default());
            assert_eq!(cold.regions, answer.regions, "step {step}");
            assert_eq!(names(&cold), (0..all.len() as u32).collect::<Vec<_>>());
        }
    }
}

/// A ball that slides over a fine floor by several faces a query, and one that rolls so.
#[test]
fn what_slides_past_whole_faces_keeps_its_name() {
    let ball = shape(Sphere { segments: 24, rings: 12, ..Sphere::default() });
    let ring = shape(Torus { major_segments: 96, minor_segments: 24, ..Torus::default() });
    let radius = ball.radius();
    for rolls in [false, true] {
        let mut memory = PairMemory::default();
        for step in 0..40 {
            let turn = 0.15 * f64::from(step);
            let around = DQuat::from_axis_angle(DVec3::Z, turn);
            let top = ring.bounds().max.z + 0.98 * radius;
            let rotation = match rolls {
                true => DQuat::from_axis_angle(around * DVec3::X, 3.0 * turn),
                false => around,
            };
            let translation = around * DVec3::new(1.0, 0.0, 0.0) + DVec3::new(0.0, 0.0, top);
            let b = Placed { model: &ball, pose: Pose { rotation, translation } };
            let answer = ask(at(&ring, 0.0, 0.0, 0.0), b, 0.0, &mut memory);
            assert_eq!(names(&answer), [0], "step {step}");
        }
    }
}

/// Ids are never used twice, are each other's neither, and a region's `from` names what was there.
#[test]
fn names_of_a_random_walk_are_unique_and_known() {
    let bodies = [
        shape(Torus { major_segments: 24, minor_segments: 12, ..Torus::default() }),
        shape(Comb { teeth: 3, ..Comb::default() }),
        model(channel()),
    ];
    let mut rng = Rng::new(4);
    let (mut changes, mut steps) = (0, 0);
    for round in 0..30 {
        let (a, b) = (&bodies[round % 3], &bodies[rng.below(3)]);
        let mut memory = PairMemory::default();
        let (mut last, mut highest): (Vec<u32>, Option<u32>) = (Vec::new(), None);
        let mut pose = Pose::at(0.4 * DVec3::new(rng.unit(), rng.unit(), rng.unit()));
        for _ in 0..30 {
            pose.translation += 0.05 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let turn = 0.05 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let turn = DQuat::from_xyzw(turn.x, turn.y, turn.z, 1.0);
            pose.rotation = (turn * pose.rotation).normalize();
            let placed = Placed { model: b, pose };
            let answer = ask(at(a, 0.0, 0.0, 0.0), placed, 0.02, &mut memory);
            let all = names(&answer);
            assert!(all.windows(2).all(|two| two[0] < two[1]), "{all:?}");
            for region in &answer.regions {
                let is_old = last.contains(&region.id.0);
                assert!(is_old || highest.is_none_or(|highest| region.id.0 > highest));
                assert!(region.from.iter().all(|id| last.contains(&id.0)));
                assert_eq!(is_old, region.from.contains(&region.id));
                assert!(region.faces.windows(2).all(|two| two[0] < two[1]));
                assert!(!region.faces.is_empty());
            }
            changes += u32::from(all != last);
            steps += 1;
            highest = all.last().copied().max(highest);
            last = all;
        }
    }
    assert!(changes > 50 && changes < steps, "{changes} of {steps}");
}
