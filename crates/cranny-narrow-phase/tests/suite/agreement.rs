//! Fast = brute force; A and B swapped; warm = cold; scaled and moved.

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::brute_force::brute_force;
use cranny_narrow_phase::operations::{Pair, common_point};
use cranny_narrow_phase::{
    Answer, Containment, Counters, Demand, PairMemory, Placed, Query, query,
};
use cranny_shapes::{
    CPrism, Comb, Cuboid, Cup, GolfBall, LPrism, NestedShells, PyramidInCavity, Sphere, Torus,
    UPrism,
};
use cranny_testkit::{Rng, from_surface, world_triangles};

use crate::coherence::without_history;
use crate::solids::{ask, dyadic_solids, model, quarter_turns, shape};

/// Small enough for brute force, large enough for trees with some levels.
fn generated() -> Vec<(&'static str, Model)> {
    vec![
        ("cuboid", shape(Cuboid::default())),
        ("sphere", shape(Sphere { segments: 10, rings: 6, ..Sphere::default() })),
        ("torus", shape(Torus { major_segments: 14, minor_segments: 7, ..Torus::default() })),
        ("cup", shape(Cup { segments: 12, ..Cup::default() })),
        ("shells", shape(NestedShells { segments: 7, ..NestedShells::default() })),
        ("comb", shape(Comb::default())),
        ("L", shape(LPrism::default())),
        ("U", shape(UPrism::default())),
        ("C", shape(CPrism { segments: 9, ..CPrism::default() })),
        ("pyramid in a well", shape(PyramidInCavity::default())),
        ("golf ball", shape(GolfBall { dimples: 0, triangles: 180, ..GolfBall::default() })),
    ]
}

fn rotation(rng: &mut Rng) -> DQuat {
    loop {
        let q = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit());
        if (0.1..=1.0).contains(&q.length_squared()) {
            return q.normalize();
        }
    }
}

fn direction(rng: &mut Rng) -> DVec3 {
    rotation(rng) * DVec3::Z
}

/// Random, near by a gap between 1e-9 and 1e-1, overlapping, or one in the other's middle.
fn poses(rng: &mut Rng, a: &Model, b: &Model) -> Vec<[Pose; 2]> {
    let reach = a.radius() + b.radius();
    let pose_a = Pose { rotation: rotation(rng), translation: direction(rng) };
    let mut turned = |offset: f64| Pose {
        rotation: rotation(rng),
        translation: pose_a.translation + offset * reach * direction(rng),
    };
    let (apart, overlapping, middle) = (turned(1.1), turned(0.4), turned(0.05));
    let mut poses = vec![[pose_a, apart], [pose_a, overlapping], [pose_a, middle]];
    let found = ask(
        Placed { model: a, pose: pose_a },
        Placed { model: b, pose: apart },
        Demand::Distance { below: None },
    );
    let [p, q] = found.witnesses.unwrap().map(|w| w.point);
    for gap in [1e-9, 1e-6, 1e-3, 1e-1] {
        let step = (p - q) * (1.0 - gap / (q - p).length());
        poses.push([pose_a, Pose { translation: apart.translation + step, ..apart }]);
    }
    poses
}

#[test]
fn fast_is_brute_force_and_order_does_not_matter() {
    let solids = generated();
    let mut rng = Rng::new(3);
    let mut found = [0; 3];
    let mut contained = 0;
    for i in 0..40 {
        let (name_a, a) = &solids[i % solids.len()];
        let (name_b, b) = &solids[rng.below(solids.len())];
        for [pose_a, pose_b] in poses(&mut rng, a, b) {
            let (a, b) = (Placed { model: a, pose: pose_a }, Placed { model: b, pose: pose_b });
            let what = format!("{name_a} at {pose_a:?}, {name_b} at {pose_b:?}");
            let fast = ask(a, b, Demand::Regions { margin: 0.05 });
            let slow = brute_force(a, b).unwrap();
            assert_eq!(fast.surface, slow.surface, "{what}");
            assert_eq!(fast.triangle_pairs, slow.triangle_pairs, "{what}");
            assert_eq!(fast.distance, Some(slow.distance), "{what}");
            assert_eq!(
                ask(b, a, Demand::Regions { margin: 0.05 }),
                fast.clone().swapped(),
                "{what}"
            );
            witnesses_are_on_the_surfaces(a, b, &fast, &what);
            found[fast.surface as usize] += 1;
            contained += u32::from(fast.contained.is_some());
        }
    }
    assert!(found[Meeting::None as usize] >= 100, "{found:?}");
    assert!(found[Meeting::Cross as usize] >= 50, "{found:?}");
    assert!(contained >= 1, "{contained}");
}

fn witnesses_are_on_the_surfaces(a: Placed, b: Placed, answer: &Answer, what: &str) {
    let tiny = 1e-13 * (a.model.radius() + b.model.radius() + 4.0);
    let common = || common_point(&Pair::new(a, b).unwrap(), &mut Counters::default());
    let [p, q] = answer.witnesses.or_else(common).unwrap().map(|w| w.point);
    assert!(from_surface(p, &world_triangles(a.model, &a.pose)) <= tiny, "{what}: {p}");
    assert!(from_surface(q, &world_triangles(b.model, &b.pose)) <= tiny, "{what}: {q}");
    let distance = answer.distance.unwrap();
    assert!(((q - p).length() - distance).abs() <= tiny, "{what}: {distance}");
    if distance > 0.0 {
        assert!(answer.separation.contains(distance), "{what}");
        assert!(answer.separation.lo >= 0.0 && answer.separation.width() < tiny, "{what}");
    }
}

/// A quaternion as an engine with f32 keeps it: of unit length to its rounding only.
fn widened(q: DQuat) -> DQuat {
    DQuat::from_xyzw(
        (q.x as f32).into(),
        (q.y as f32).into(),
        (q.z as f32).into(),
        (q.w as f32).into(),
    )
}

#[test]
fn quaternions_a_little_off_unit_length_are_normalised() {
    let solids = generated();
    let mut rng = Rng::new(12);
    let mut unlike = 0;
    for i in 0..15 {
        let (a, b) = (&solids[i % solids.len()].1, &solids[rng.below(solids.len())].1);
        for [pose_a, pose_b] in poses(&mut rng, a, b) {
            for stretch in [1.0, (1.0 + 9e-6f64).sqrt(), (1.0 - 9e-6f64).sqrt()] {
                let off = |pose: Pose| Pose { rotation: widened(pose.rotation) * stretch, ..pose };
                let [pose_a, pose_b] = [off(pose_a), off(pose_b)];
                let placed = [Placed { model: a, pose: pose_a }, Placed { model: b, pose: pose_b }];
                let fast = ask(placed[0], placed[1], Demand::Regions { margin: 0.0 });
                let slow = brute_force(placed[0], placed[1]).unwrap();
                assert_eq!(
                    (fast.surface, fast.triangle_pairs, fast.distance),
                    (slow.surface, slow.triangle_pairs, Some(slow.distance)),
                    "{pose_a:?}, {pose_b:?}"
                );
                let unit = placed.map(|p| Placed { pose: p.pose.accepted().unwrap(), ..p });
                assert_eq!(ask(unit[0], unit[1], Demand::Regions { margin: 0.0 }), fast);
                unlike += u32::from(unit[0].pose != placed[0].pose);
            }
        }
    }
    assert!(unlike >= 200, "{unlike}");
}

#[test]
fn boxes_within_the_stretch_of_a_quaternion_that_is_not_unit_are_answered_alike() {
    // Unnormalised, the matrix would stretch by the squared length: the boxes would meet, and a
    // cull that takes the transpose for the inverse would not see it.
    let cube = model(crate::solids::cuboid([-1.0; 3], [1.0; 3]));
    for (excess, gap, meets) in [(9e-6, 1e-5, false), (3e-8, 4e-8, false), (9e-6, -1e-12, true)] {
        let rotation = DQuat::from_xyzw(0.0, 0.0, (1.0f64 + excess).sqrt(), 0.0);
        let pose = Pose { rotation, translation: DVec3::new(2.0 + gap, 0.1, 0.2) };
        let (a, b) = (Placed { model: &cube, pose: Pose::IDENTITY }, Placed { model: &cube, pose });
        for (a, b) in [(a, b), (b, a)] {
            let fast = ask(a, b, Demand::Regions { margin: 0.0 });
            let slow = brute_force(a, b).unwrap();
            assert_eq!((fast.surface, fast.distance), (slow.surface, Some(slow.distance)));
            assert_eq!(fast.surface != Meeting::None, meets, "{excess:e}");
            assert!((fast.distance.unwrap() - gap.max(0.0)).abs() < 1e-14);
        }
    }
}

#[test]
fn the_distance_of_two_triangles_does_not_depend_on_which_corner_comes_first() {
    let mut rng = Rng::new(8);
    let turned = |[a, b, c]: [DVec3; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    let single = |t: [DVec3; 3]| model(Mesh::new(t.to_vec(), vec![[0, 1, 2]]).unwrap());
    for _ in 0..100 {
        let mut point = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let (a, b) = ([point(), point(), point()], [point(), point(), point()]);
        let pose = Pose::at(DVec3::new(2.0, 0.25, -0.125));
        let distances: Vec<f64> = turned(a)
            .iter()
            .flat_map(|&a| turned(b).map(|b| (single(a), single(b))))
            .map(|(a, b)| {
                let (a, b) =
                    (Placed { model: &a, pose }, Placed { model: &b, pose: Pose::IDENTITY });
                ask(a, b, Demand::Distance { below: None }).distance.unwrap()
            })
            .collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(distances.iter().all(|d| d - least < 1e-14), "{distances:?}");
    }
}

#[test]
fn warm_is_cold_along_random_walks() {
    let solids = generated();
    let mut rng = Rng::new(11);
    // One memory for every pair, handed from pair to pair: it must not change an answer.
    let mut memory = PairMemory::default();
    for _ in 0..12 {
        let a = &solids[rng.below(solids.len())].1;
        let b = &solids[rng.below(solids.len())].1;
        let mut pose = Pose { rotation: rotation(&mut rng), translation: direction(&mut rng) };
        for _ in 0..12 {
            let step = 0.2 * direction(&mut rng) - 0.1 * pose.translation;
            pose = Pose {
                rotation: (pose.rotation + rotation(&mut rng) * 0.1).normalize(),
                translation: pose.translation + step,
            };
            let placed = [Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose }];
            for demand in [Demand::Regions { margin: 0.1 }, Demand::Distance { below: None }] {
                let warm = query(placed[0], placed[1], &Query::of(demand), &mut memory).unwrap();
                assert_eq!(
                    without_history(&warm),
                    without_history(&ask(placed[0], placed[1], demand))
                );
            }
        }
    }
    assert!(memory.bytes() > 0);
    memory.clear();
    assert_eq!(memory.bytes(), 0);
}

/// Everything of an answer that has no unit.
fn verdict(answer: &Answer) -> (Meeting, bool, Option<Containment>, u32) {
    (answer.surface, answer.solid, answer.contained, answer.triangle_pairs)
}

#[test]
fn scaling_by_powers_of_two_changes_lengths_only() {
    let solids = dyadic_solids();
    let turns = quarter_turns();
    let mut rng = Rng::new(5);
    for (name, b) in &solids {
        for power in [-190, -30, -3, 2, 40] {
            let factor = 2f64.powi(power);
            let a = &solids[rng.below(solids.len())].1;
            let mut pose = || {
                let mut half = || 0.5 * f64::from(rng.between(-5, 5));
                let translation = DVec3::new(half(), half(), half());
                Pose { rotation: turns[rng.below(24)], translation }
            };
            let (pose_a, pose_b) = (pose(), pose());
            let scaled = |m: &Model| model(m.mesh().scaled(DVec3::splat(factor)).unwrap());
            let moved = |p: Pose| Pose { translation: p.translation * factor, ..p };
            let (large_a, large_b) = (scaled(a), scaled(b));
            let demand = |scale: f64| Demand::Regions { margin: 0.25 * scale };
            let here = ask(
                Placed { model: a, pose: pose_a },
                Placed { model: b, pose: pose_b },
                demand(1.0),
            );
            let there = ask(
                Placed { model: &large_a, pose: moved(pose_a) },
                Placed { model: &large_b, pose: moved(pose_b) },
                demand(factor),
            );
            assert_eq!(verdict(&here), verdict(&there), "{name} times {factor}");
            let (d, e) = (here.distance.unwrap() * factor, there.distance.unwrap());
            assert!((d - e).abs() <= 1e-15 * d, "{name} times {factor}: {d} {e}");
        }
        // Of two equal bodies the pose decides which is first, and scaling keeps that: to the bit.
        let large = model(b.mesh().scaled(DVec3::splat(1024.0)).unwrap());
        let at = |m, s: f64| {
            let rotation = DQuat::from_xyzw(0.1, 0.2, -0.3, 0.9).normalize();
            let first = Placed { model: m, pose: Pose::IDENTITY };
            let translation = s * DVec3::new(2.5, 1.75, 3.0);
            (first, Placed { model: m, pose: Pose { rotation, translation } })
        };
        let (small, large) = (at(b, 1.0), at(&large, 1024.0));
        let here = ask(small.0, small.1, Demand::Distance { below: None });
        let there = ask(large.0, large.1, Demand::Distance { below: None });
        assert_eq!(there.distance.unwrap(), 1024.0 * here.distance.unwrap(), "{name}");
    }
}

#[test]
fn moving_both_bodies_by_a_dyadic_vector_changes_no_figure() {
    let solids = dyadic_solids();
    let turns = quarter_turns();
    let mut rng = Rng::new(6);
    for (i, (name, b)) in solids.iter().enumerate() {
        // Different models: which of them is first depends on neither pose.
        let a = &solids[(i + 1 + rng.below(solids.len() - 1)) % solids.len()].1;
        let (turn_a, turn_b) = (turns[rng.below(24)], rotation(&mut rng));
        for (turn, offset) in [(turn_b, 3.0), (turns[rng.below(24)], 1.5), (turn_b, 0.5)] {
            let pose = |rotation, x: f64, by: DVec3| Pose {
                rotation,
                translation: DVec3::new(x, 0.25, -0.5) + by,
            };
            let by = DVec3::new(512.0, -64.5, 1024.25);
            let answer = |by| {
                ask(
                    Placed { model: a, pose: pose(turn_a, 0.0, by) },
                    Placed { model: b, pose: pose(turn, offset, by) },
                    Demand::Regions { margin: 0.25 },
                )
            };
            let (here, there) = (answer(DVec3::ZERO), answer(by));
            assert_eq!(verdict(&here), verdict(&there), "{name}");
            assert_eq!(here.distance, there.distance, "{name}");
            assert_eq!(here.regions.len(), there.regions.len(), "{name}");
            for (r, s) in here.regions.iter().zip(&there.regions) {
                assert_eq!((r.depth, r.area, r.normal), (s.depth, s.area, s.normal), "{name}");
                assert_eq!(r.deepest.id, s.deepest.id, "{name}");
            }
        }
    }
}
