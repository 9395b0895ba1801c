//! Warm = cold = brute force on every frame, whatever the motion and whatever is done to the
//! memory.

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::brute_force::brute_force;
use cranny_narrow_phase::{Answer, Counters, Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{Cuboid, Cup, GolfBall, IsoBolt, IsoNut, Sphere, Torus};
use cranny_testkit::{Rng, Walk, small_models};

use crate::solids::{ask, model, shape};

/// What does not depend on history: all but counters.
pub(crate) fn without_history(answer: &Answer) -> Answer {
    Answer { counters: Default::default(), ..answer.clone() }
}

fn demand(rng: &mut Rng, distance: f64) -> Demand {
    match rng.below(6) {
        0 | 1 => Demand::Intersects,
        2 | 3 => Demand::Distance { below: None },
        4 => Demand::Distance { below: Some(distance * [0.5, 1.0, 1.5][rng.below(3)]) },
        _ => Demand::Regions { margin: 0.0 },
    }
}

#[test]
fn memory_never_changes_an_answer() {
    let bodies = small_models();
    let mut rng = Rng::new(11);
    let mut seen = [0; 3];
    let (mut contained, mut rested, mut bypassed) = (0, 0, 0);
    for round in 0..42 {
        let (name_a, a) = &bodies[round % bodies.len()];
        let (name_b, b) = &bodies[rng.below(bodies.len())];
        let reach = a.radius() + b.radius();
        let at = Pose {
            rotation: DQuat::from_axis_angle(rng.direction(), 1.0),
            translation: DVec3::ONE,
        };
        let mut walk = Walk::new(&mut rng, reach);
        let mut memory = PairMemory::default();
        let mut distance = reach;
        // Some walks ask one thing throughout, others anything.
        let habit = (round % 3 != 0).then(|| demand(&mut rng, distance));
        for frame in 0..60 {
            walk.step(&mut rng, reach);
            if rng.below(8) == 0 {
                continue; // a call is skipped
            }
            match rng.below(30) {
                0 => memory.clear(),
                1 => memory = memory.clone(),
                _ => {}
            }
            let placed_a = Placed { model: a, pose: at };
            let placed_b = Placed { model: b, pose: at.compose(&walk.pose) };
            let demand = habit.unwrap_or_else(|| demand(&mut rng, distance));
            let swapped = rng.below(5) == 0;
            let pair = if swapped { [placed_b, placed_a] } else { [placed_a, placed_b] };
            let warm = query(pair[0], pair[1], &Query::of(demand), &mut memory).unwrap();
            let cold = ask(pair[0], pair[1], demand);
            let what = format!("{name_a} and {name_b}, round {round}, frame {frame}, {demand:?}");
            assert_eq!(without_history(&warm), without_history(&cold), "{what}");
            if frame % 8 == 0 {
                let slow = brute_force(placed_a, placed_b).unwrap();
                assert_eq!(warm.surface, slow.surface, "{what}");
                if matches!(demand, Demand::Distance { below: None } | Demand::Regions { .. }) {
                    assert_eq!(warm.distance, Some(slow.distance), "{what}");
                }
                if matches!(demand, Demand::Regions { .. }) {
                    assert_eq!(warm.triangle_pairs, slow.triangle_pairs, "{what}");
                }
            }
            distance = cold.distance.filter(|d| d.is_finite()).unwrap_or(distance);
            seen[warm.surface as usize] += 1;
            contained += u32::from(warm.contained.is_some());
            rested += u32::from(warm.counters.node_tests * 4 < cold.counters.node_tests);
            bypassed += warm.counters.bypassed;
        }
    }
    assert!(seen[Meeting::None as usize] > 400 && seen[Meeting::Cross as usize] > 250, "{seen:?}");
    assert!(contained > 10 && rested > 250 && bypassed > 4, "{contained} {rested} {bypassed}");
}

#[test]
fn a_pair_of_equal_models_may_change_its_order() {
    // Canonical order then is that of pose bits: rotations are the same, so that of x, whose signs
    // change places half-way.
    let torus = shape(Torus { major_segments: 18, minor_segments: 8, ..Torus::default() });
    let mut memory = PairMemory::default();
    let slant = DQuat::from_axis_angle(DVec3::X, 1.2);
    for frame in 0..120 {
        let x = 0.001 * (f64::from(frame) - 60.0);
        let (a, b) = (
            Placed {
                model: &torus,
                pose: Pose { rotation: slant, translation: DVec3::new(x, 0.9, 0.0) },
            },
            Placed {
                model: &torus,
                pose: Pose { rotation: slant, translation: DVec3::new(-x, -0.9, 0.0) },
            },
        );
        for demand in [Demand::Intersects, Demand::Distance { below: None }] {
            let warm = query(a, b, &Query::of(demand), &mut memory).unwrap();
            assert_eq!(
                without_history(&warm),
                without_history(&ask(a, b, demand)),
                "frame {frame}"
            );
        }
    }
}

/// Work of 90 calm frames with memory and without, about a pose; what memory holds in the end.
fn calm_frames(model: &Model, slant: DQuat, middle: DVec3, demand: Demand) -> [u64; 3] {
    let mut memory = PairMemory::default();
    let a = Placed { model, pose: Pose::IDENTITY };
    let (mut warm, mut cold) = (0, 0);
    for frame in 0..100 {
        let turn = DQuat::from_axis_angle(DVec3::Y, 0.0005 * f64::from(frame));
        let b = Placed { model, pose: Pose { rotation: turn * slant, translation: middle } };
        let answer = query(a, b, &Query::of(demand), &mut memory).unwrap();
        assert_eq!(answer.surface, Meeting::None);
        if frame >= 10 {
            let work = |x: &Answer| x.counters.node_tests + x.counters.triangle_tests;
            warm += work(&answer);
            cold += work(&ask(a, b, demand));
        }
    }
    let held = memory.bytes() as u64;
    memory.clear();
    assert_eq!(memory.bytes(), 0);
    [warm, cold, held]
}

const CALM: [Demand; 2] = [Demand::Intersects, Demand::Distance { below: None }];

#[test]
fn a_calm_pair_is_hardly_looked_at() {
    // Linked, so that no plane parts the hulls.
    let ring = shape(Torus { major_segments: 64, minor_segments: 16, ..Torus::default() });
    let across = DQuat::from_axis_angle(DVec3::X, 1.5);
    for demand in CALM {
        let [warm, cold, held] = calm_frames(&ring, across, DVec3::new(1.0, 0.1, 0.05), demand);
        assert!(cold > 1_000 && warm * 8 < cold, "{demand:?}: {warm} of {cold}");
        assert!(held > 0);
    }
}

#[test]
fn what_a_plane_parts_is_not_looked_at_but_for_its_distance() {
    let ball = shape(GolfBall { dimples: 36, triangles: 2_000, ..GolfBall::default() });
    let middle = DVec3::new(1.2, 1.3, 1.1);
    let [warm, cold, held] = calm_frames(&ball, DQuat::IDENTITY, middle, CALM[0]);
    assert_eq!([warm, cold, held], [0; 3]);
    let [warm, cold, held] = calm_frames(&ball, DQuat::IDENTITY, middle, CALM[1]);
    // Of 4,000 faces those are measured that lie foremost, with memory and without.
    assert!(0 < warm && warm <= cold && cold < 90 * 100, "{warm} of {cold}");
    assert!((1..50_000).contains(&held), "{held}");
}

/// What distances of rings in each other's holes take, with memory and without, over some frames
/// in which the second moves along; and how often a cut was given up.
fn distance_frames(along: impl Fn(f64) -> f64) -> [u64; 3] {
    let ring = shape(Torus { major_segments: 96, minor_segments: 24, ..Torus::default() });
    let (mut memory, mut warm, mut cold, mut rebuilt) = (PairMemory::default(), 0, 0, 0);
    let demand = Demand::Distance { below: None };
    for frame in 0..60 {
        let time = f64::from(frame);
        let rotation = DQuat::from_axis_angle(DVec3::X, 1.5 + 0.002 * time);
        let a = Placed { model: &ring, pose: Pose::IDENTITY };
        let pose = Pose { rotation, translation: along(time) * DVec3::X };
        let b = Placed { model: &ring, pose };
        let answer = query(a, b, &Query::of(demand), &mut memory).unwrap();
        let alone = ask(a, b, demand);
        assert_eq!(without_history(&answer), without_history(&alone), "frame {frame}");
        assert_eq!(answer.surface, Meeting::None, "frame {frame}");
        let work = |c: &Counters| c.node_tests + c.front_tested + c.cluster_tests;
        warm += work(&answer.counters);
        cold += work(&alone.counters);
        rebuilt += answer.counters.front_rebuilt;
    }
    [warm, cold, rebuilt]
}

/// The cut that a verdict has built reaches less than the distance; one that reached twice that
/// would list most of both bodies.
#[test]
fn a_wide_gap_is_followed_for_less_than_a_search() {
    let [warm, cold, _] = distance_frames(|time| 0.9 - 0.004 * time);
    assert!(2 * warm < cold, "closing: {warm} of {cold}");
    let [warm, cold, _] = distance_frames(|time| 0.66 + 0.004 * time);
    assert!(2 * warm < cold, "opening: {warm} of {cold}");
}

/// A step of the motion is longer than the gap: the cut that reaches two steps is kept.
#[test]
fn a_gap_smaller_than_a_step_is_followed() {
    let [warm, cold, rebuilt] = distance_frames(|time| 0.4005 + 0.0002 * (time % 2.0));
    assert!(2 * warm < cold && rebuilt < 20, "{warm} of {cold}, {rebuilt}");
}

/// A search for a crossing goes where boxes overlap most centrally, and goes back from a choice in
/// vain: first come what crosses, not all that is near it.
#[test]
fn a_crossing_is_come_across_early() {
    let bolt = IsoBolt { segments: 36, length: Some(16.0), ..IsoBolt::default() };
    let nut = IsoNut { segments: 36, height: Some(6.0), ..IsoNut::default() };
    let (bolt, nut) = (shape(bolt), shape(nut));
    let (mut found, mut nodes, mut clusters) = (0, 0, 0);
    for k in 0..60 {
        let rotation = DQuat::from_axis_angle(DVec3::Z, 0.1 * f64::from(k));
        let translation = DVec3::new(0.1, 0.05, 8.0 + 0.03 * f64::from(k));
        let b = Placed { model: &nut, pose: Pose { rotation, translation } };
        let a = Placed { model: &bolt, pose: Pose::IDENTITY };
        let answer = ask(a, b, Demand::Intersects);
        if answer.surface == Meeting::Cross {
            found += 1;
            nodes += answer.counters.node_tests;
            clusters += answer.counters.cluster_tests;
        }
    }
    assert!(found > 40, "{found}");
    // The other way round it takes 57,000 and 6,400.
    assert!(nodes < 200 * found && clusters < 25 * found, "{nodes} and {clusters} of {found}");
}

/// Linked rings that come to cross for some frames: where they come apart again, the cut from
/// before is followed, and nothing is searched from the top.
#[test]
fn a_cut_from_before_a_crossing_is_followed_after_it() {
    let ring = shape(Torus { major_segments: 64, minor_segments: 16, ..Torus::default() });
    let (size, tube) = (ring.bounds().max, ring.bounds().max.z);
    let linked = DQuat::from_axis_angle(DVec3::X, std::f64::consts::FRAC_PI_2);
    let mut memory = PairMemory::default();
    let mut came_apart = 0;
    let mut crossed = false;
    for frame in 0..60 {
        let nearer = if frame / 10 % 2 == 1 { 4e-3 } else { 0.0 };
        let x = 2.0 * size.x - 4.0 * tube - 2e-3 + nearer;
        let turn = DQuat::from_axis_angle(DVec3::Y, 1e-4 * f64::from(frame));
        let pose = Pose { rotation: turn * linked, translation: DVec3::new(x, 0.0, 0.0) };
        let (a, b) = (Placed { model: &ring, pose: Pose::IDENTITY }, Placed { model: &ring, pose });
        let warm = query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
        let cold = ask(a, b, Demand::Intersects);
        assert_eq!(without_history(&warm), without_history(&cold), "frame {frame}");
        if crossed && warm.surface == Meeting::None {
            came_apart += 1;
            assert_eq!(warm.counters.node_tests, 0, "frame {frame}");
            assert!(2 * warm.counters.front_tested < cold.counters.node_tests, "frame {frame}");
        }
        crossed = warm.surface == Meeting::Cross;
    }
    assert_eq!(came_apart, 2);
}

/// Linked rings that cross while the second spins: what was nearest before is far apart when they
/// come apart, and a cut that reaches so far would list much of both rings.
#[test]
fn the_first_distance_after_a_crossing_is_measured_without_a_cut() {
    let ring = shape(Torus { major_segments: 64, minor_segments: 16, ..Torus::default() });
    let (size, tube) = (ring.bounds().max, ring.bounds().max.z);
    let linked = DQuat::from_axis_angle(DVec3::X, std::f64::consts::FRAC_PI_2);
    let mut memory = PairMemory::default();
    let mut spun = 0.0;
    for frame in 0..9 {
        let crosses = (4..7).contains(&frame);
        spun += if crosses { 0.2 } else { 1e-3 };
        let x = 2.0 * size.x - 4.0 * tube + if crosses { 2e-3 } else { -2e-3 };
        let rotation = (linked * DQuat::from_axis_angle(DVec3::Z, spun)).normalize();
        let pose = Pose { rotation, translation: DVec3::new(x, 0.0, 0.0) };
        let (a, b) = (Placed { model: &ring, pose: Pose::IDENTITY }, Placed { model: &ring, pose });
        let demand = Demand::Distance { below: None };
        let (warm, cold) =
            (query(a, b, &Query::of(demand), &mut memory).unwrap(), ask(a, b, demand));
        assert_eq!(without_history(&warm), without_history(&cold), "frame {frame}");
        assert_eq!(warm.surface == Meeting::Cross, crosses, "frame {frame}");
        if !crosses {
            let is_followed = ![0, 7].contains(&frame);
            assert_eq!(warm.counters.front_held > 0, is_followed, "frame {frame}");
        }
    }
}

/// Verdict and distance of one pair by turns: the cut that serves distances outlasts the verdicts.
#[test]
fn distances_keep_their_cut_where_verdicts_come_between() {
    let ring = shape(Torus { major_segments: 64, minor_segments: 16, ..Torus::default() });
    let linked = DQuat::from_axis_angle(DVec3::X, std::f64::consts::FRAC_PI_2);
    let mut memory = PairMemory::default();
    let (mut warm, mut cold, mut rebuilt) = (0, 0, 0);
    for frame in 0..60 {
        let turn = DQuat::from_axis_angle(DVec3::Y, 1e-4 * f64::from(frame));
        let translation = DVec3::X * ring.bounds().max.x;
        let pose = Pose { rotation: (turn * linked).normalize(), translation };
        let (a, b) = (Placed { model: &ring, pose: Pose::IDENTITY }, Placed { model: &ring, pose });
        for demand in [Demand::Intersects, Demand::Distance { below: None }] {
            let answer = query(a, b, &Query::of(demand), &mut memory).unwrap();
            let alone = ask(a, b, demand);
            assert_eq!(without_history(&answer), without_history(&alone), "frame {frame}");
            let work = |counters: &Counters| counters.node_tests + counters.front_tested;
            warm += work(&answer.counters);
            cold += work(&alone.counters);
            rebuilt += answer.counters.front_rebuilt;
        }
    }
    assert!(4 * warm < cold && rebuilt < 10, "{warm} of {cold}, {rebuilt}");
}

/// A planner's samples: what was nearest is far apart now, and a cut that reaches so far would list
/// most of the two rings.
#[test]
fn random_poses_are_measured_without_a_cut() {
    let ring = shape(Torus { major_segments: 64, minor_segments: 16, ..Torus::default() });
    let mut rng = Rng::new(5);
    for demand in [Demand::Distance { below: None }, Demand::Intersects] {
        let (mut memory, mut warm, mut cold) = (PairMemory::default(), 0, 0);
        for frame in 0..200 {
            let rotation = DQuat::from_axis_angle(rng.direction(), 3.0 * rng.unit());
            let pose = Pose { rotation, translation: DVec3::X + 0.2 * rng.direction() };
            let a = Placed { model: &ring, pose: Pose::IDENTITY };
            let b = Placed { model: &ring, pose };
            let answer = query(a, b, &Query::of(demand), &mut memory).unwrap();
            let alone = ask(a, b, demand);
            assert_eq!(without_history(&answer), without_history(&alone), "frame {frame}");
            let work = |counters: &Counters| counters.triangle_tests + counters.node_tests;
            warm += work(&answer.counters);
            cold += work(&alone.counters);
        }
        assert!(10 * warm < 11 * cold, "{demand:?}: {warm} of {cold}");
    }
}

/// Side by side with a little overlap, the second turning about its own axis: fast, no faces cross
/// twice; slowly, the same ones do for long.
#[test]
fn faces_that_crossed_are_asked_again_only_where_that_pays() {
    let shape = shape(Torus {
        major_radius: 0.4,
        minor_radius: 0.1,
        major_segments: 60,
        minor_segments: 15,
    });
    let beside = DVec3::new(0.8, 0.6, 0.0);
    let slant = DQuat::from_axis_angle(beside, std::f64::consts::PI / 6.0);
    let work = |degrees: f64| {
        let mut memory = PairMemory::default();
        let (mut warm, mut cold) = (0, 0);
        for frame in 0..200 {
            let turn = DQuat::from_axis_angle(DVec3::Z, (degrees * f64::from(frame)).to_radians());
            let pose = Pose { rotation: (slant * turn).normalize(), translation: 0.98 * beside };
            let (a, b) =
                (Placed { model: &shape, pose: Pose::IDENTITY }, Placed { model: &shape, pose });
            let answer = query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
            assert_eq!(answer.surface, Meeting::Cross, "frame {frame}");
            let work = |counters: &Counters| counters.triangle_tests + counters.node_tests;
            warm += work(&answer.counters);
            cold += work(&ask(a, b, Demand::Intersects).counters);
        }
        (warm, cold)
    };
    let (warm, cold) = work(37.0);
    // One trial in 64 is in vain: it costs what a few searches do, and no more.
    assert!(warm < cold + 60, "fast: {warm} of {cold}");
    let (warm, cold) = work(0.01);
    assert!(7 * warm < 4 * cold, "slow: {warm} of {cold}");
}

#[test]
fn a_nut_on_its_bolt_meets_nothing_along_the_helix() {
    let bolt = IsoBolt { segments: 36, length: Some(16.0), ..IsoBolt::default() };
    let nut = IsoNut { segments: 36, height: Some(6.0), clearance: 0.4, ..IsoNut::default() };
    let (bolt, nut) = (shape(bolt), shape(nut));
    let a = Placed { model: &bolt, pose: Pose::IDENTITY };
    let mut memory = PairMemory::default();
    let posed = |turn: f64, lift: f64| Pose {
        rotation: DQuat::from_axis_angle(DVec3::Z, turn * std::f64::consts::TAU),
        translation: DVec3::new(0.0, 0.0, 8.0 + 2.0 * turn + lift),
    };
    for frame in 0..40 {
        let turn = f64::from(frame) * [0.0003, 0.004][usize::from(frame >= 20)];
        let b = Placed { model: &nut, pose: posed(turn, 0.0) };
        let answer = query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
        assert_eq!((answer.surface, answer.solid), (Meeting::None, false), "frame {frame}");
    }
    let b = Placed { model: &nut, pose: posed(0.1, 0.5) };
    let answer = query(a, b, &Query::of(Demand::Regions { margin: 0.0 }), &mut memory).unwrap();
    assert!(answer.triangle_pairs > 100, "{}", answer.triangle_pairs);
    // With the clearance of 0.1 that it has unless stated, a tenth of the pitch of 2 is
    // enough.
    let (bolt, nut) = (
        shape(IsoBolt { length: Some(16.0), ..IsoBolt::default() }),
        shape(IsoNut { height: Some(6.0), ..IsoNut::default() }),
    );
    for (turn, lift) in [(0.0, 0.2), (0.3, -0.2)] {
        let a = Placed { model: &bolt, pose: Pose::IDENTITY };
        let b = Placed { model: &nut, pose: posed(turn, lift) };
        let answer = query(a, b, &Query::of(Demand::Regions { margin: 0.0 }), &mut memory).unwrap();
        assert!(answer.triangle_pairs > 2000, "{}", answer.triangle_pairs);
    }
}

/// Boxes do not part a thread's flanks: the verdict is then sought among patches. Regions, whose
/// pairs of faces come from boxes, know nothing of that.
#[test]
fn a_verdict_among_patches_is_that_of_boxes() {
    let bolt = shape(IsoBolt { length: Some(16.0), ..IsoBolt::default() });
    let nut = shape(IsoNut { height: Some(6.0), ..IsoNut::default() });
    let a = Placed { model: &bolt, pose: Pose::IDENTITY };
    let mut memory = PairMemory::default();
    let mut seen = [0; 3];
    for frame in 0..12 {
        // Along the helix, and now and then off it: against a flank, and back.
        let turn = 0.006 * f64::from(frame);
        let lift = [0.0, 0.0, 0.1, 0.0, -0.06, -0.06][frame as usize % 6];
        let pose = Pose {
            rotation: DQuat::from_axis_angle(DVec3::Z, turn * std::f64::consts::TAU),
            translation: DVec3::new(0.0, 0.0, 8.0 + 2.0 * turn + lift),
        };
        let b = Placed { model: &nut, pose };
        let warm = query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
        let cold = ask(a, b, Demand::Intersects);
        assert_eq!(without_history(&warm), without_history(&cold), "frame {frame}");
        let by_boxes = ask(a, b, Demand::Regions { margin: 0.0 });
        assert_eq!((warm.surface, warm.solid), (by_boxes.surface, by_boxes.solid), "frame {frame}");
        seen[warm.surface as usize] += 1;
        if warm.surface == Meeting::None {
            assert!(4 * cold.counters.triangle_tests < by_boxes.counters.triangle_tests);
            assert!(2 * cold.counters.node_tests < by_boxes.counters.node_tests);
        }
    }
    assert!(seen[Meeting::None as usize] > 4 && seen[Meeting::Cross as usize] > 2, "{seen:?}");
}

#[test]
fn what_is_inside_stays_inside_until_it_crosses() {
    let cup = shape(Cup { segments: 24, ..Cup::default() });
    let sphere = shape(Sphere { segments: 10, rings: 6, ..Sphere::default() });
    let speck = shape(Cuboid { size: [0.1, 0.1, 0.1] });
    let mut memory = PairMemory::default();
    let mut inside = 0;
    for frame in 0..400 {
        // From the middle of the sphere through its surface and back.
        let out = 1.5 * (f64::from(frame % 200) / 100.0 - 1.0).abs();
        let (a, b) = (
            Placed { model: &sphere, pose: Pose::IDENTITY },
            Placed { model: &speck, pose: Pose::at(DVec3::new(out, 0.1, 0.05)) },
        );
        let warm = query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
        assert_eq!(
            without_history(&warm),
            without_history(&ask(a, b, Demand::Intersects)),
            "frame {frame}"
        );
        inside += u32::from(warm.contained.is_some());
    }
    assert!((60..350).contains(&inside), "{inside}");
    // Models change: numbers of the old ones mean nothing.
    for model in [&cup, &speck, &sphere, &cup] {
        let (a, b) = (
            Placed { model: &sphere, pose: Pose::IDENTITY },
            Placed { model, pose: Pose::at(DVec3::new(0.4, 0.2, 0.1)) },
        );
        for _ in 0..3 {
            let warm = query(a, b, &Query::of(Demand::Distance { below: None }), &mut memory);
            assert_eq!(
                without_history(&warm.unwrap()),
                without_history(&ask(a, b, Demand::Distance { below: None }))
            );
        }
    }
}

/// A box without a lid, and a block within it that it does not touch: of these only the block holds
/// anything.
fn block_in_an_open_box() -> Model {
    let part = |size: [f64; 3]| Cuboid { size }.build().unwrap();
    let (shell, block) = (part([2.0, 2.0, 2.0]), part([0.8, 0.8, 0.8]));
    let is_lid = |f: &[u32; 3]| f.iter().all(|&v| shell.vertices()[v as usize].z > 0.9);
    let count = shell.vertices().len() as u32;
    let faces = shell.faces().iter().filter(|f| !is_lid(f)).copied();
    let inner = block.faces().iter().map(|f| f.map(|v| v + count));
    let mesh = Mesh::new(
        shell.vertices().iter().chain(block.vertices()).copied().collect(),
        faces.chain(inner).collect(),
    );
    model(mesh.unwrap())
}

/// What lies inside what is carried from pose to pose: not into a block by a jump, nor out of it;
/// and not into an open box, which a body enters without crossing any face.
#[test]
fn what_jumps_into_a_body_is_inside_and_what_enters_an_open_one_is_not() {
    let (open, speck) = (block_in_an_open_box(), shape(Cuboid { size: [0.06, 0.05, 0.04] }));
    // Through the opening, to and fro between wall and block, into the block and there to and fro.
    let mut way: Vec<DVec3> =
        (0..60).map(|i| DVec3::new(0.7, 0.1, 1.5 - 0.025 * f64::from(i))).collect();
    let wander = |i: i32, x: f64| DVec3::new(x, 0.01 * f64::from(i % 10 - 5), 0.0);
    for visit in 0..4 {
        way.extend((0..20).map(|i| wander(i, 0.7)));
        way.extend((0..20).map(|i| wander(i, 0.3 + 0.01 * f64::from(visit))));
    }
    let turned = DQuat::from_axis_angle(DVec3::new(0.2, 1.0, 0.3).normalize(), 0.4);
    for demand in [Demand::Intersects, Demand::Distance { below: None }, Demand::contacts(0.05)] {
        let mut memory = PairMemory::default();
        let (mut inside, mut carried) = (0, 0);
        for (frame, &translation) in way.iter().enumerate() {
            let what = format!("frame {frame}, {demand:?}");
            let a = Placed { model: &open, pose: Pose::IDENTITY };
            let b = Placed { model: &speck, pose: Pose { rotation: turned, translation } };
            let warm = query(a, b, &Query::of(demand), &mut memory).unwrap();
            assert_eq!(without_history(&warm), without_history(&ask(a, b, demand)), "{what}");
            assert_eq!((warm.surface, warm.solid), (Meeting::None, translation.x < 0.4), "{what}");
            inside += u32::from(warm.solid);
            carried += u32::from(warm.counters.inside_tests == 0);
        }
        assert!(inside == 80 && carried > 60, "{inside} {carried}, {demand:?}");
    }
}

/// A speck in the tube of a ring; then above the ring's hole, parted from its hull; then a little
/// lower, in the hole. That it was inside in the tube means nothing there, however short the last
/// step was.
#[test]
fn what_was_inside_is_forgotten_where_a_plane_parts_the_hulls() {
    let ring =
        Torus { major_radius: 1.0, minor_radius: 0.3, major_segments: 12, minor_segments: 6 };
    let (ring, speck) = (shape(ring), shape(Cuboid { size: [0.02, 0.02, 0.02] }));
    let top = ring.bounds().max.z;
    let mut rng = Rng::new(4);
    let (mut inside, mut parted) = (0, 0);
    for _ in 0..600 {
        let mut memory = PairMemory::default();
        let mut tell = |x: f64, z: f64, demand: Demand| {
            let rotation = DQuat::from_axis_angle(DVec3::new(0.3, 0.5, 0.8).normalize(), 0.7);
            let pose = Pose { rotation, translation: DVec3::new(x, 0.0, z) };
            let placed =
                [Placed { model: &ring, pose: Pose::IDENTITY }, Placed { model: &speck, pose }];
            let warm = query(placed[0], placed[1], &Query::of(demand), &mut memory).unwrap();
            assert_eq!(
                without_history(&warm),
                without_history(&ask(placed[0], placed[1], demand)),
                "{x} {z}"
            );
            warm
        };
        let distance = Demand::Distance { below: None };
        for demand in [distance, distance, Demand::Intersects] {
            let found = tell(0.9 + 0.001 * rng.unit(), 0.001 * rng.unit(), demand);
            inside += u32::from(found.contained.is_some());
        }
        let (x, z) = (0.8 * rng.unit(), top + 0.02 + 0.1 * rng.unit().abs());
        parted += u32::from(tell(x, z, distance).counters.planes_parted > 0);
        tell(x, z - 0.2 * rng.unit().abs(), Demand::Intersects);
    }
    assert!(inside > 100 && parted > 50, "{inside} {parted}");
}

/// What is 2^64 units of a body away has a square beyond single precision.
#[test]
fn sizes_may_differ_beyond_single_precision() {
    let large = shape(Cup { segments: 7, ..Cup::default() });
    let cube = shape(Cuboid::default());
    let small = [-70, -130].map(|power| {
        let vertices = cube.mesh().vertices().iter().map(|p| *p * 2f64.powi(power)).collect();
        model(Mesh::new(vertices, cube.mesh().faces().to_vec()).unwrap())
    });
    let mut rng = Rng::new(8);
    for round in 0..40 {
        let mut memory = PairMemory::default();
        let mut pose = Pose {
            rotation: DQuat::from_axis_angle(rng.direction(), 1.0),
            translation: 0.3 * large.radius() * rng.direction(),
        };
        for frame in 0..6 {
            pose.translation += 0.01 * large.radius() * rng.direction();
            let a = Placed { model: &large, pose: Pose::IDENTITY };
            let b = Placed { model: &small[round % 2], pose };
            let (what, slow) =
                (format!("round {round}, frame {frame}"), brute_force(a, b).unwrap());
            for demand in [Demand::contacts(0.5), Demand::Regions { margin: 0.5 }] {
                let cold = ask(a, b, demand);
                let warm = query(a, b, &Query::of(demand), &mut memory).unwrap();
                assert_eq!(without_history(&warm), without_history(&cold), "{what}");
                assert_eq!(
                    without_history(&ask(b, a, demand).swapped()),
                    without_history(&cold),
                    "{what}"
                );
                assert_eq!(cold.surface, slow.surface, "{what}");
                assert!(cold.distance.is_none_or(|d| d == slow.distance), "{what}");
            }
        }
    }
}

/// What is remembered of a crossing gives a distance of 0 as it gives a verdict.
#[test]
fn a_distance_of_surfaces_that_cross_takes_what_a_verdict_takes() {
    let ring = shape(Torus { major_segments: 24, minor_segments: 12, ..Torus::default() });
    let demands = [Demand::Intersects, Demand::Distance { below: None }];
    let mut memories = [PairMemory::default(), PairMemory::default()];
    let mut searched = 0;
    for frame in 0..20 {
        let translation = DVec3::new(1.0 + 0.002 * f64::from(frame), 0.1, 0.2);
        let a = Placed { model: &ring, pose: Pose::IDENTITY };
        let b = Placed { model: &ring, pose: Pose::at(translation) };
        let [verdict, distance] = [0, 1].map(|i| {
            let warm = query(a, b, &Query::of(demands[i]), &mut memories[i]).unwrap();
            assert_eq!(without_history(&warm), without_history(&ask(a, b, demands[i])));
            warm
        });
        assert_eq!((distance.surface, distance.distance), (Meeting::Cross, Some(0.0)));
        assert_eq!(distance.counters, verdict.counters);
        searched += u32::from(distance.counters.node_tests > 0);
    }
    assert!(searched < 4, "{searched}");
}

/// Linked rings a hair apart that turn: no faces are far enough from each other to be parted by one
/// plane for long, but what they are apart at both ends of a step proves that they have not met.
#[test]
fn what_lies_inside_what_is_carried_where_surfaces_are_close() {
    let ring = shape(Torus { major_segments: 24, minor_segments: 12, ..Torus::default() });
    let (size, demand) = (ring.bounds().max, Demand::Distance { below: None });
    let tube = size.z;
    let linked = DQuat::from_axis_angle(DVec3::X, std::f64::consts::FRAC_PI_2);
    let mut memory = PairMemory::default();
    let mut carried = 0;
    for frame in 0..60 {
        let turn = DQuat::from_axis_angle(DVec3::Y, 1e-5 * f64::from(frame));
        let translation = DVec3::new(2.0 * size.x - 4.0 * tube - 2e-4, 0.0, 0.0);
        let a = Placed { model: &ring, pose: Pose::IDENTITY };
        let b = Placed { model: &ring, pose: Pose { rotation: turn * linked, translation } };
        let warm = query(a, b, &Query::of(demand), &mut memory).unwrap();
        assert_eq!(without_history(&warm), without_history(&ask(a, b, demand)), "frame {frame}");
        assert_eq!(warm.surface, Meeting::None, "frame {frame}");
        carried += u32::from(warm.counters.inside_tests == 0);
    }
    assert!(carried > 40, "{carried}");
}
