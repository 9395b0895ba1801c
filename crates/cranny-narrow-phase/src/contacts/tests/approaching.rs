//! Contacts that motion has to close are all found, by the trees' bounds of wrenches: all pairs are
//! tried. And no others are handed on.

use crate::answer::Counters;
use cranny_exact::{DMat3, DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_shapes::{Comb, Cup, IsoBolt, IsoNut, LPrism, Shape, Torus};
use cranny_testkit::Rng;

use super::super::*;
use super::every_pair::{made, of_all_pairs};
use crate::approach::Approach;
use crate::query::{Demand, Placed, Query};

fn model(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

fn shaped(shape: impl Into<Shape>) -> Model {
    model(shape.into().build().unwrap())
}

/// A rough patch of ground: tips, hollows, and vertices between them.
fn rough(rng: &mut Rng) -> Model {
    let n = 6u32;
    let places = (0..=n).flat_map(|i| (0..=n).map(move |j| [i, j]));
    let vertices = places.map(|[i, j]| {
        let [x, y] = [i, j].map(|k| f64::from(k) / 3.0 - 1.0);
        DVec3::new(x, y, 0.15 * rng.unit())
    });
    let vertices: Vec<DVec3> = vertices.collect();
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
    let faces = cells.flat_map(|a| [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]);
    model(Mesh::new(vertices, faces.collect()).unwrap())
}

/// Some motion of about a length: a shift, a turn about some point, and leeway now and then.
fn motion(rng: &mut Rng, length: f64) -> Approach {
    let mut vector = |size: f64| size * DVec3::new(rng.unit(), rng.unit(), rng.unit());
    let (linear, turn, center) = (vector(length), vector(length), vector(1.0));
    let spread = DMat3::from_diagonal(vector(length));
    Approach {
        within: 6.0 * length,
        linear: if rng.below(4) == 0 { DVec3::ZERO } else { linear },
        spread: if rng.below(2) == 0 { DMat3::ZERO } else { spread },
        turn: if rng.below(4) == 0 { DVec3::ZERO } else { turn },
        swing: center.cross(turn),
    }
}

/// Kept and dropped contacts beyond the margin.
#[derive(Debug, Default)]
struct Tally {
    kept: usize,
    dropped: usize,
}

/// The list of what counts, by memory that may be of another pose, is that of all pairs.
fn check(
    [a, b]: [Placed; 2],
    (margin, approach): (f64, &Approach),
    kept: &mut (Coherent, ContactMemory),
    tally: &mut Tally,
) {
    let pair = Pair::new(a, b).unwrap();
    let wanted = Wanted::of(&pair, margin, Some(approach));
    let within = of_all_pairs(&pair, approach.within);
    let truth: Vec<Contact> = within.iter().filter(|c| wanted.holds(c)).copied().collect();
    tally.dropped += within.len() - truth.len();
    tally.kept += truth.iter().filter(|c| c.separation > margin).count();
    let (coherent, memory) = kept;
    coherent.begin(&pair);
    let (found, nearest) = listed(&pair, &wanted, coherent, memory);
    coherent.end(&pair);
    assert_eq!(made(&found), made(&truth), "{approach:?}");
    let mut fresh = (Coherent::default(), ContactMemory::default());
    fresh.0.begin(&pair);
    let (_, cold) = listed(&pair, &wanted, &mut fresh.0, &mut fresh.1);
    assert_eq!(made(&nearest), made(&cold), "{approach:?}");
}

/// All contacts that count, and those that are the nearest of their patches.
fn listed(
    pair: &Pair,
    wanted: &Wanted,
    coherent: &mut Coherent,
    memory: &mut ContactMemory,
) -> (Vec<Contact>, Vec<Contact>) {
    let (mut all, mut nearest) = (Vec::new(), Vec::new());
    let counters = &mut Counters::default();
    memory.search(pair, wanted, Meets::None, coherent, counters);
    memory.each_group(pair, wanted, counters, |group| {
        let before = all.len();
        group.all(&mut all);
        let of_group = group.nearest();
        // If the nearest of all counts, it is the nearest of those that count.
        if let Some(of_group) = of_group {
            assert_eq!(all[before..].iter().copied().min_by(nearer), Some(of_group));
        }
        nearest.extend(of_group);
    });
    memory.end();
    (all, nearest)
}

/// A pose of `b` on `a` that leaves a small gap.
fn beside(a: &Model, b: &Model, rng: &mut Rng) -> Pose {
    let (rotation, way, gap) = (rng.rotation(), rng.direction(), 0.01 + 0.06 * rng.unit().abs());
    let middle = a.bounds().center() - rotation * b.bounds().center();
    let at = |t: f64| Pose { rotation, translation: middle + t * way }.accepted().unwrap();
    let apart = |t: f64| {
        let [a, b] = [(a, Pose::IDENTITY), (b, at(t))].map(|(model, pose)| Placed { model, pose });
        let question = Query::of(Demand::Distance { below: None });
        let answer = crate::query(a, b, &question, &mut crate::PairMemory::default()).unwrap();
        if answer.solid { 0.0 } else { answer.distance.unwrap() }
    };
    let (mut inside, mut outside) = (0.0, 4.0);
    for _ in 0..12 {
        let middle = 0.5 * (inside + outside);
        *(if apart(middle) < gap { &mut inside } else { &mut outside }) = middle;
    }
    at(outside)
}

#[test]
fn what_motion_closes_is_listed_and_nothing_else() {
    let mut rng = Rng::new(41);
    let mut bodies: Vec<Model> = vec![
        shaped(LPrism::default()),
        shaped(Cup { segments: 20, ..Cup::default() }),
        shaped(Comb { teeth: 4, ..Comb::default() }),
        shaped(Torus { major_segments: 28, minor_segments: 12, ..Torus::default() }),
        shaped(Torus { major_segments: 16, minor_segments: 30, ..Torus::default() }),
    ];
    bodies.push(rough(&mut rng));
    // Their trees have their origins away from the bodies'.
    let away = |body: &Model| {
        let vertices = body.mesh().vertices().iter().map(|p| *p + DVec3::new(1.5, -2.0, 1.0));
        model(Mesh::new(vertices.collect(), body.mesh().faces().to_vec()).unwrap())
    };
    bodies = bodies.iter().map(away).collect();
    let mut tally = Tally::default();
    for round in 0..100 {
        let [a, b] = [0, 1].map(|_| &bodies[rng.below(bodies.len())]);
        let mut kept = (Coherent::default(), ContactMemory::default());
        let (axis, pose) = (rng.direction(), beside(a, b, &mut rng));
        let home = Pose { rotation: rng.rotation(), translation: 3.0 * rng.direction() };
        for frame in 0..3 {
            let turn = DQuat::from_axis_angle(axis, 0.002 * f64::from(frame));
            let pose = Pose { rotation: (turn * pose.rotation).normalize(), ..pose };
            let placed = [(a, home), (b, home.compose(&pose))]
                .map(|(model, pose)| Placed { model, pose: pose.accepted().unwrap() });
            let approach = motion(&mut rng, 0.06);
            let margin = if round % 3 == 0 { 0.0 } else { 0.01 };
            check(placed, (margin, &approach), &mut kept, &mut tally);
        }
    }
    assert!(tally.kept > 200 && tally.dropped > 1_000, "{tally:?}");
}

/// A nut that turns along its thread comes to nothing, though it moves farther than it is wide of
/// the bolt.
#[test]
fn a_nut_on_its_helix_leaves_out_what_it_slides_along() {
    let (segments, flank_segments) = (16, 1);
    let bolt = IsoBolt { length: Some(8.0), segments, flank_segments, ..IsoBolt::default() };
    let bolt = shaped(bolt);
    let nut = IsoNut { height: Some(4.0), segments, flank_segments, ..IsoNut::default() };
    let pitch = nut.pitch;
    let nut = shaped(nut);
    let mut rng = Rng::new(43);
    let [mut along, mut against, mut tilted] = [0; 3].map(|_| Tally::default());
    for round in 0..3 {
        let angle = 0.4 * f64::from(round);
        let height = pitch * (2.0 + angle / std::f64::consts::TAU);
        let pose = Pose {
            rotation: DQuat::from_rotation_z(angle),
            translation: DVec3::new(0.01 * rng.unit(), 0.01 * rng.unit(), height),
        };
        let home = Pose { rotation: rng.rotation(), translation: rng.direction() };
        let frame = home.world_from_body();
        let placed = [(&bolt, home), (&nut, home.compose(&pose))]
            .map(|(model, pose)| Placed { model, pose: pose.accepted().unwrap() });
        for (way, turn, tally) in [(1.0, 0.04, &mut along), (-1.0, 0.12, &mut against)] {
            // The bolt's motion, as the nut sees it.
            let approach = Approach {
                within: 0.3,
                linear: -way * turn * pitch / std::f64::consts::TAU * DVec3::Z,
                spread: DMat3::ZERO,
                turn: -turn * DVec3::Z,
                swing: DVec3::ZERO,
            };
            let mut kept = (Coherent::default(), ContactMemory::default());
            check(placed, (0.02, &approach.moved(&frame)), &mut kept, tally);
        }
        for _ in 0..4 {
            // About any axis, far from where the trees have their origins.
            let approach = motion(&mut rng, 0.02);
            let mut kept = (Coherent::default(), ContactMemory::default());
            check(placed, (0.0, &approach.moved(&frame)), &mut kept, &mut tilted);
        }
    }
    assert!(along.dropped > 20 * along.kept, "{along:?}");
    assert!(against.kept > 10 * along.kept, "{against:?} against {along:?}");
    assert!(tilted.kept > 100 && tilted.dropped > 100, "{tilted:?}");
}

/// Which body is called A changes nothing, nor does memory.
#[test]
fn exchanged_bodies_approach_as_much() {
    let mut rng = Rng::new(47);
    let bodies = [shaped(Cup::default()), shaped(LPrism::default()), rough(&mut rng)];
    let mut found = 0;
    for _ in 0..60 {
        let [a, b] = [0, 1].map(|_| &bodies[rng.below(3)]);
        let mut pose = || Pose { rotation: rng.rotation(), translation: 0.6 * rng.direction() };
        let [a, b] = [(a, pose()), (b, pose())].map(|(model, pose)| Placed { model, pose });
        let approach = motion(&mut rng, 0.1);
        let forth = Query::of(Demand::contacts(0.01)).approaching(approach);
        let back = Query::of(Demand::contacts(0.01)).approaching(approach.swapped());
        let ask = |a, b, question| {
            let mut memory = crate::PairMemory::default();
            crate::query(a, b, question, &mut memory).unwrap().contacts
        };
        let (forth, back) = (ask(a, b, &forth), ask(b, a, &back));
        let swapped: Vec<Contact> = back.into_iter().map(Contact::swapped).collect();
        assert_eq!(made(&forth), made(&swapped));
        found += forth.len();
    }
    assert!(found > 100, "{found}");
}

#[test]
fn an_approach_in_numbers() {
    let approach = Approach {
        within: 1.0,
        linear: DVec3::new(0.1, 0.0, -0.2),
        spread: DMat3::from_diagonal(DVec3::new(0.0, 0.01, 0.02)),
        turn: 0.5 * DVec3::Z,
        // About (1, 0, 0).
        swing: DVec3::X.cross(0.5 * DVec3::Z),
    };
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-15, "{x} {y}");
    near(approach.closing(DVec3::X, DVec3::X), 0.1);
    near(approach.closing(DVec3::X, -DVec3::Z), 0.22);
    near(approach.closing(DVec3::new(1.0, 2.0, 0.0), -DVec3::X), -0.1 + 1.0);
    // Turning that leads away is not relied on.
    near(approach.closing(DVec3::new(1.0, 2.0, 0.0), DVec3::X), 0.1);
    near(approach.closing(DVec3::new(3.0, 0.0, 0.0), DVec3::Y), 0.01 + 1.0);
    let pose = Pose { rotation: DQuat::from_rotation_y(0.7), translation: DVec3::splat(0.3) };
    let map = pose.world_from_body();
    let (p, n) = (DVec3::new(0.3, -0.2, 0.9), DVec3::new(0.6, 0.0, 0.8));
    let moved = approach.moved(&map).closing(map.apply(p), map.apply_vector(n));
    assert!((moved - approach.closing(p, n)).abs() < 1e-12);
    assert_eq!(approach.swapped().closing(p, -n), approach.closing(p, n));
}
