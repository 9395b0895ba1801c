//! The second method gives the answers of the first, on every motion, with memory and without; and
//! in a pocket it opens nothing as long as the other body keeps off the walls.

use cranny_concavity::Concavities;
use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::brute_force::brute_force;
use cranny_narrow_phase::{Counters, Demand, Method, PairMemory, Placed, Query, query};
use cranny_shapes::{Cuboid, Cup, GolfBall, IsoBolt, IsoNut, Sphere};
use cranny_testkit::{Rng, Walk, small_models};

use crate::coherence::without_history;
use crate::solids::{model, shape};

const DEMANDS: [Demand; 3] =
    [Demand::Intersects, Demand::Distance { below: None }, Demand::Regions { margin: 0.0 }];

/// Asks by both methods, by envelopes with memory and without; returns what the ones with memory
/// did.
fn agreed(a: Placed, b: Placed, demand: Demand, memory: &mut PairMemory, what: &str) -> Counters {
    let question = Query::of(demand);
    let boxes = query(a, b, &question, &mut PairMemory::default()).unwrap();
    let question = question.by(Method::Envelopes);
    let warm = query(a, b, &question, memory).unwrap();
    let cold = query(a, b, &question, &mut PairMemory::default()).unwrap();
    assert_eq!(without_history(&warm), without_history(&boxes), "{what}");
    assert_eq!(without_history(&cold), without_history(&boxes), "{what}");
    // Memory does not decide what is opened, unless a plane between the hulls was found with or
    // without it alone.
    let opened = |c: &Counters| (c.pockets_opened, c.pockets_passed, c.facets_compared);
    if warm.counters.planes_parted == cold.counters.planes_parted {
        assert_eq!(opened(&warm.counters), opened(&cold.counters), "{what}");
    }
    warm.counters
}

#[test]
fn both_methods_tell_the_same_of_any_walk() {
    let bodies = small_models();
    let mut rng = Rng::new(23);
    let (mut met, mut opened, mut contained) = (0, 0, 0);
    for round in 0..40 {
        let (name_a, a) = &bodies[round % bodies.len()];
        let (name_b, b) = &bodies[rng.below(bodies.len())];
        let reach = a.radius() + b.radius();
        let at = Pose {
            rotation: DQuat::from_axis_angle(rng.direction(), 1.0),
            translation: DVec3::ONE,
        };
        let mut walk = Walk::new(&mut rng, reach);
        let mut memory = PairMemory::default();
        for frame in 0..30 {
            walk.step(&mut rng, reach);
            if rng.below(30) == 0 {
                memory.clear();
            }
            let mut pair =
                [Placed { model: a, pose: at }, Placed { model: b, pose: at.compose(&walk.pose) }];
            if rng.below(5) == 0 {
                pair.reverse();
            }
            let demand = DEMANDS[rng.below(3)];
            let what = format!("{name_a} and {name_b}, round {round}, frame {frame}, {demand:?}");
            if rng.below(6) == 0 {
                // The other method in between, with the same memory.
                let warm = query(pair[0], pair[1], &Query::of(demand), &mut memory).unwrap();
                let cold = crate::solids::ask(pair[0], pair[1], demand);
                assert_eq!(without_history(&warm), without_history(&cold), "{what}");
                continue;
            }
            let counters = agreed(pair[0], pair[1], demand, &mut memory, &what);
            if frame % 6 == 0 {
                let question = Query::of(Demand::Intersects).by(Method::Envelopes);
                let found = query(pair[0], pair[1], &question, &mut PairMemory::default()).unwrap();
                let slow = brute_force(pair[0], pair[1]).unwrap();
                assert_eq!(found.surface, slow.surface, "{what}");
                met += u32::from(slow.surface != Meeting::None);
                contained += u32::from(found.contained.is_some());
            }
            opened += counters.pockets_opened;
        }
    }
    assert!(met > 20 && opened > 100 && contained > 0, "{met} {opened} {contained}");
}

/// Faces that lie in any direction, cross each other, and close nothing.
#[test]
fn both_methods_tell_the_same_of_soups() {
    let mut rng = Rng::new(5);
    let mut opened = 0;
    for round in 0..60 {
        let mut soup = |faces: u32| -> Model {
            let vertices = (0..3 * faces)
                .map(|_| 0.1 * f64::from(rng.between(1, 10)) * rng.direction())
                .collect();
            let faces = (0..faces).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            model(Mesh::new(vertices, faces).unwrap())
        };
        let (a, b) = (soup(3 + round % 20), soup(1 + round % 7));
        let pose = Pose {
            rotation: DQuat::from_axis_angle(DVec3::Z, f64::from(round)),
            translation: DVec3::splat(0.03 * f64::from(round)),
        };
        let (a, b) = (Placed { model: &a, pose: Pose::IDENTITY }, Placed { model: &b, pose });
        for demand in DEMANDS {
            let what = format!("round {round}, {demand:?}");
            opened += agreed(a, b, demand, &mut PairMemory::default(), &what).pockets_opened;
        }
    }
    assert!(opened > 30, "{opened}");
}

/// A ball in a cup, kept off its walls: no facet is looked at but one of the first layer, and
/// nothing is opened. Where it goes through the wall the pocket is opened, and where it is lifted
/// out it is passed.
#[test]
fn a_ball_that_keeps_off_the_walls_of_a_cup_opens_nothing() {
    let cup = Cup { radius: 1.0, height: 2.0, wall: 0.1, floor: 0.1, segments: 48 };
    let (cup, ball) = (shape(cup), shape(Sphere { radius: 0.4, segments: 24, rings: 12 }));
    let mut memory = PairMemory::default();
    let mut at = |place: DVec3, turn: f64| {
        let rotation = DQuat::from_axis_angle(DVec3::ONE.normalize(), turn);
        let (a, b) = (
            Placed { model: &cup, pose: Pose::IDENTITY },
            Placed { model: &ball, pose: Pose { rotation, translation: place } },
        );
        agreed(a, b, Demand::Intersects, &mut memory, &format!("{place} {turn}"))
    };
    let middle = cup_middle(&cup);
    for step in 0..200 {
        let t = f64::from(step) * 0.05;
        let swing = DVec3::new(0.3 * t.sin(), 0.3 * (1.3 * t).cos(), 0.2 * (0.7 * t).sin());
        let done = at(middle + swing, t);
        assert_eq!((done.pockets_passed, done.pockets_opened), (1, 0), "step {step}");
        assert_eq!((done.facets_compared, done.triangle_tests), (0, 0), "step {step}");
    }
    let crossing = at(middle + 0.5 * DVec3::X, 0.0);
    assert!(
        crossing.pockets_opened == 1 && crossing.facets_compared > 0 && crossing.triangle_tests > 0
    );
}

/// A ball that sinks along the wall of a cup, always as near to it: the plane of the wall, kept
/// from query to query, says nothing of the floor that comes nearer meanwhile. Straight down, and
/// on a circle about the origin of the cup's frame far beside it: of points that turn about the
/// origin of one body, only those of the other go anywhere.
#[test]
fn a_ball_that_sinks_along_a_wall_meets_the_floor() {
    let cup = Cup { radius: 1.0, height: 2.0, wall: 0.1, floor: 0.1, segments: 48 };
    let mesh = cup.build().unwrap();
    let beside = mesh.vertices().iter().map(|&p| p + 500.0 * DVec3::X).collect();
    let cup = model(Mesh::new(beside, mesh.faces().to_vec()).unwrap());
    let ball = shape(Sphere { radius: 0.4, segments: 24, rings: 12 });
    let middle = cup_middle(&cup);
    for is_straight in [true, false] {
        let mut memory = PairMemory::default();
        let mut seen = [0; 2];
        for step in 0..100 {
            let sunk = 0.01 * f64::from(step) - 0.2;
            let place = middle + DVec3::new(-0.35, 0.07, 0.0);
            let turn = DQuat::from_axis_angle(DVec3::Y, sunk / place.x);
            let pose = match is_straight {
                true => Pose::at(place - sunk * DVec3::Z),
                false => Pose { rotation: turn, translation: turn * place },
            };
            let (a, b) =
                (Placed { model: &cup, pose: Pose::IDENTITY }, Placed { model: &ball, pose });
            let what = format!("step {step}, straight: {is_straight}");
            let done = agreed(a, b, Demand::Intersects, &mut memory, &what);
            seen[usize::from(done.pockets_opened > 0)] += 1;
        }
        assert!(seen[0] > 30 && seen[1] > 10, "{seen:?}");
    }
}

/// Whatever crossed before, a plane is looked for where the hulls have come apart.
#[test]
fn bodies_that_have_parted_are_told_by_a_plane_again() {
    let (cup, cube) = (shape(Cup::default()), shape(Cuboid::default()));
    let mut memory = PairMemory::default();
    let mut at = |x: f64, method: Method| {
        let (a, b) = (
            Placed { model: &cup, pose: Pose::IDENTITY },
            Placed { model: &cube, pose: Pose::at(x * DVec3::X) },
        );
        let question = Query::of(Demand::Distance { below: Some(1.0) }).by(method);
        query(a, b, &question, &mut memory).unwrap()
    };
    for method in [Method::Boxes, Method::Envelopes] {
        assert_eq!(at(0.4, method).surface, Meeting::Cross);
    }
    // Hulls that overlapped are queried again after a wait.
    let parted = (0..100).filter(|_| at(10.0, Method::Envelopes).counters.planes_parted == 1);
    assert!(parted.count() > 90);
}

/// The middle of the space in a cup.
fn cup_middle(cup: &Model) -> DVec3 {
    let pockets = Concavities::of(cup);
    assert_eq!(pockets.len(), 1);
    pockets.envelopes().envelope(0).bounds().center()
}

/// A tube of 32 sides along z: walls from 1 to 2, from -1 to 1.
fn tube() -> Model {
    const SIDES: u32 = 32;
    let ring = |radius: f64, z: f64| {
        (0..SIDES).map(move |side| {
            let angle = -std::f64::consts::TAU * f64::from(side) / f64::from(SIDES);
            DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
    };
    let rings = [ring(2.0, -1.0), ring(2.0, 1.0), ring(1.0, 1.0), ring(1.0, -1.0)];
    let mut faces = Vec::new();
    // Around a section of the wall, from ring to ring.
    for from in 0..4_u32 {
        let to = (from + 1) % 4;
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let [a, b] = [SIDES * from + side, SIDES * from + next];
            let [c, d] = [SIDES * to + next, SIDES * to + side];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    model(Mesh::new(rings.into_iter().flatten().collect(), faces).unwrap())
}

/// A peg in its hole, longer than the hole: through both lids, and off the walls.
#[test]
fn a_peg_that_keeps_off_its_hole_opens_nothing() {
    let (hole, peg) = (tube(), shape(Cuboid { size: [0.8, 0.8, 5.0] }));
    assert_eq!(Concavities::of(&hole).len(), 1);
    let mut memory = PairMemory::default();
    for step in 0..120 {
        let along = 0.01 * f64::from(step);
        let rotation = DQuat::from_axis_angle(DVec3::Z, along);
        let pose = Pose { rotation, translation: DVec3::new(0.02, 0.01, along) };
        let (a, b) = (Placed { model: &hole, pose: Pose::IDENTITY }, Placed { model: &peg, pose });
        let done = agreed(a, b, Demand::Intersects, &mut memory, &format!("step {step}"));
        assert_eq!((done.pockets_passed, done.pockets_opened), (1, 0), "step {step}");
    }
    let pose = Pose::at(0.8 * DVec3::X);
    let (a, b) = (Placed { model: &hole, pose: Pose::IDENTITY }, Placed { model: &peg, pose });
    let done = agreed(a, b, Demand::Intersects, &mut memory, "through a wall");
    assert!(done.pockets_opened == 1 && done.triangle_tests > 0);
}

/// Pocket in pocket, both open all the time; along the helix nothing meets, off it the flanks
/// cross.
#[test]
fn both_methods_tell_the_same_of_a_nut_on_its_bolt() {
    let bolt = IsoBolt { segments: 36, length: Some(16.0), ..IsoBolt::default() };
    let nut = IsoNut { segments: 36, height: Some(6.0), clearance: 0.4, ..IsoNut::default() };
    let (bolt, nut) = (shape(bolt), shape(nut));
    let mut memory = PairMemory::default();
    let mut crossed = 0;
    for step in 0..16 {
        let turn = 0.01 * f64::from(step);
        let lift = if step % 4 == 3 { 0.5 } else { 0.0 };
        let pose = Pose {
            rotation: DQuat::from_axis_angle(DVec3::Z, turn * std::f64::consts::TAU),
            translation: DVec3::new(0.0, 0.0, 8.0 + 2.0 * turn + lift),
        };
        let (a, b) = (Placed { model: &bolt, pose: Pose::IDENTITY }, Placed { model: &nut, pose });
        let what = format!("step {step}");
        for demand in [Demand::Regions { margin: 0.0 }, Demand::Intersects] {
            let done = agreed(a, b, demand, &mut memory, &what);
            assert!(done.pockets_opened >= 2, "{what}");
        }
        crossed +=
            u32::from(crate::solids::ask(a, b, Demand::Intersects).surface == Meeting::Cross);
    }
    assert_eq!(crossed, 4);
}

/// Many pockets: only those that the other ball may reach are opened.
#[test]
fn of_many_pockets_few_are_opened() {
    let ball = shape(GolfBall { triangles: 3_000, dimples: 36, ..GolfBall::default() });
    let count = Concavities::of(&ball).len() as u64;
    assert_eq!(count, 36);
    let mut memory = PairMemory::default();
    for step in 0..30 {
        let rotation = DQuat::from_axis_angle(DVec3::new(0.0, 0.6, 0.8), 0.05 * f64::from(step));
        let pose = Pose { rotation, translation: 1.93 * ball.radius() * DVec3::X };
        let (a, b) = (Placed { model: &ball, pose: Pose::IDENTITY }, Placed { model: &ball, pose });
        for demand in DEMANDS {
            let done = agreed(a, b, demand, &mut memory, &format!("step {step}, {demand:?}"));
            assert!(done.pockets_opened < count / 3, "{}", done.pockets_opened);
        }
    }
}

/// Nobody pays for concavities that no query needs, nor twice for those that one does.
#[test]
fn concavities_are_made_by_the_first_query_that_needs_them() {
    let (cup, ball) =
        (shape(Cup::default()), shape(Sphere { radius: 0.2, segments: 16, rings: 8 }));
    let pose = Pose::at(Concavities::of(&cup).envelopes().envelope(0).bounds().center());
    let made = |memory: &mut PairMemory, [a, b]: [&Model; 2], method| {
        let (a, b) = (Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose });
        let question = Query::of(Demand::Intersects).by(method);
        query(a, b, &question, memory).unwrap().counters.concavities_made
    };
    let mut memory = PairMemory::default();
    for _ in 0..2 {
        assert_eq!(made(&mut memory, [&cup, &ball], Method::Boxes), 0);
    }
    assert_eq!(made(&mut memory, [&cup, &ball], Method::Envelopes), 2);
    assert_eq!(made(&mut memory, [&ball, &cup], Method::Envelopes), 0, "the same pair");
    assert_eq!(made(&mut memory, [&cup, &cup], Method::Envelopes), 1, "another pair of one model");
}
