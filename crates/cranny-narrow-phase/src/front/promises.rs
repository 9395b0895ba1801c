//! What a front promises, held against brute force after every step of walks that are hard on it: turns
//! about pivots within its blocks, steps along a gap, hops through walls.

use std::f64::consts::TAU;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Content, FaceId, FaceTree, Model};
use cranny_shapes::{Comb, Cuboid, Cup, Shape, Sphere, Torus};
use cranny_testkit::Rng;

use super::quests::Meetings;
use super::{Front, Quest};
use crate::answer::Counters;
use crate::closest::NearestFaces;
use crate::containment::{Solidity, solidity};
use crate::pair::{Pair, PosedVertices, Side};
use crate::query::Placed;
use crate::surface::{FacePair, meeting_pairs, surface_verdict};
use crate::triangle_distance::triangle_distance;

fn shape(shape: impl Into<Shape>) -> Model {
    Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
}

fn direction(rng: &mut Rng) -> DVec3 {
    loop {
        let v = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        if (0.01..=1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// All faces beneath a node.
fn beneath(tree: &FaceTree, node: u32) -> Vec<FaceId> {
    match tree.content(node) {
        Content::Leaf { .. } => tree.leaf_faces(node).to_vec(),
        Content::Inner { left, right } => [beneath(tree, left), beneath(tree, right)].concat(),
    }
}

/// Distances of all faces of the first from all of the second; 0 where they meet.
fn distances(pair: &Pair, meetings: &[FacePair]) -> Vec<Vec<f64>> {
    let triangles = |side: Side| -> Vec<_> {
        let faces = 0..pair.mesh(side).faces().len() as u32;
        faces.map(|f| pair.triangle(side, FaceId(f))).collect()
    };
    let second = triangles(Side::Second);
    let mut all: Vec<Vec<f64>> = triangles(Side::First)
        .iter()
        .map(|f| second.iter().map(|g| triangle_distance(f, g).squared.sqrt()).collect())
        .collect();
    for meeting in meetings {
        all[meeting.first.index()][meeting.second.index()] = 0.0;
    }
    all
}

impl Front {
    /// Every pair of faces stands in one entry, and no entry, nor what a block says of its entries,
    /// promises more room than there is. Returns the largest share of its room that an entry promises.
    fn keeps_its_promises(&self, pair: &Pair, meetings: &[FacePair], what: &str) -> f64 {
        let trees = Side::BOTH.map(|side| pair.model(side).tree());
        let truth = distances(pair, meetings);
        let mut stands = truth.iter().map(|row| vec![0; row.len()]).collect::<Vec<_>>();
        let error = pair.culling_error();
        let (mut entries, mut boldest) = (0, 0.0f64);
        for block in &self.blocks {
            for entry in &block.entries {
                let mut room = f64::INFINITY;
                for f in beneath(trees[0], entry.nodes[0]) {
                    for g in beneath(trees[1], entry.nodes[1]) {
                        room = room.min(truth[f.index()][g.index()]);
                        stands[f.index()][g.index()] += 1;
                    }
                }
                for side in [0, 1] {
                    let (ball, bounds) =
                        (&block.balls[side], trees[side].node(entry.nodes[side]).bounds);
                    let farthest =
                        (bounds.center() - ball.center).abs() + 0.5 * (bounds.max - bounds.min);
                    assert!(
                        farthest.length() <= ball.radius + error,
                        "{what}: {ball:?} leaves out {bounds:?}"
                    );
                }
                let promised = entry.key - block.odometer;
                assert!(promised <= room + error, "{what}: {promised:e} of {room:e}");
                assert!(block.least <= entry.key, "{what}");
                boldest = boldest.max(promised / room);
                entries += 1;
            }
        }
        assert!(stands.iter().flatten().all(|&times| times == 1), "{what}");
        assert_eq!(entries, self.entries, "{what}");
        boldest
    }
}

/// What a walk had the front do.
#[derive(Debug, Default)]
struct Seen {
    tested: u64,
    held: u64,
    unbroken: usize,
    /// Steps after which something else lies inside something else, and no faces met before or after.
    hops: usize,
    boldest: f64,
}

/// Follows a walk of the second body, asking for meetings, or for what is nearest.
fn follow(a: &Model, b: &Model, nearest: bool, walk: impl IntoIterator<Item = Pose>) -> Seen {
    let mut seen = Seen::default();
    let mut front: Option<Front> = None;
    let (mut before, mut last): (Option<Solidity>, Option<[FaceId; 2]>) = (None, None);
    for (frame, pose) in walk.into_iter().enumerate() {
        let what = format!("frame {frame}, nearest: {nearest}");
        let mut posed = PosedVertices::default();
        let at = |model, pose| Placed { model, pose };
        let pair = Pair::new(at(a, Pose::IDENTITY), at(b, pose), &mut posed);
        let counters = &mut Counters::default();
        let truth = meeting_pairs(&pair, counters);
        let (surface, _) = surface_verdict(&pair, u64::MAX, counters).unwrap();
        // What is nearest is asked of surfaces that do not meet.
        let nearest = nearest && truth.is_empty();
        let now = truth.is_empty().then(|| solidity(&pair, surface, &truth, counters));
        let counters = &mut Counters::default();
        let mut meetings = Meetings::new(&pair, false);
        let mut closest = NearestFaces::less_than(&pair, f64::INFINITY);
        if let Some([f, g]) = last {
            closest.offer(f, g, counters);
        }
        let unbroken = match front.as_mut() {
            Some(front) if nearest => renewed(front, &pair, &mut closest, counters),
            Some(front) => renewed(front, &pair, &mut meetings, counters),
            None if nearest => {
                front = Front::of(&pair, &mut closest, counters);
                false
            }
            None => {
                front = Front::of(&pair, &mut meetings, counters);
                false
            }
        };
        let front = front.as_mut().unwrap();
        if nearest {
            last = closest.found().map(|found| found.faces);
        } else {
            meetings.found.sort_unstable();
            assert_eq!(meetings.found, truth, "{what}");
        }
        seen.boldest = seen.boldest.max(front.keeps_its_promises(&pair, &truth, &what));
        let hop = frame > 0 && before.is_some() && now.is_some() && before != now;
        assert!(!(unbroken && (hop || before.is_none() || now.is_none())), "{what}");
        seen.hops += usize::from(hop);
        seen.unbroken += usize::from(unbroken);
        seen.tested += if frame > 0 { counters.front_tested } else { 0 };
        seen.held += front.entries as u64;
        before = now;
    }
    seen
}

fn renewed(
    front: &mut Front,
    pair: &Pair,
    quest: &mut impl Quest,
    counters: &mut Counters,
) -> bool {
    front.advance(pair);
    front.refresh(pair, quest, counters)
}

/// Turns by `angle` a frame about a point of the second body that stays at `pivot`.
fn turning(axis: DVec3, angle: f64, pivot: DVec3, arm: DVec3) -> impl Iterator<Item = Pose> {
    (0..40).map(move |frame| {
        let rotation = DQuat::from_axis_angle(axis, angle * f64::from(frame));
        Pose { rotation, translation: pivot + rotation * arm }
    })
}

#[test]
fn slow_turns_about_any_pivot_spend_what_they_should() {
    let bodies = [
        shape(Cuboid::default()),
        shape(Torus { major_segments: 9, minor_segments: 5, ..Torus::default() }),
        shape(Cup { segments: 7, ..Cup::default() }),
        shape(Comb { teeth: 3, ..Comb::default() }),
        // Small beside what turns, of which either may come first in canonical order.
        shape(Cuboid { size: [0.05, 0.04, 0.03] }),
        shape(Cuboid { size: [0.03, 0.06, 0.04] }),
        shape(Cuboid { size: [0.04, 0.05, 0.03] }),
    ];
    let mut rng = Rng::new(29);
    let (mut tested, mut held, mut boldest) = (0, 0, 0.0f64);
    for round in 0..42 {
        let (a, b) = (&bodies[round % 7], &bodies[rng.below(4)]);
        let reach = a.radius() + b.radius();
        let corner = |model: &Model, i: usize| {
            let vertices = model.mesh().vertices();
            vertices[i % vertices.len()]
        };
        // Within the second body, at one of its corners, and as far away as the first.
        let arm = match round % 3 {
            0 => DVec3::ZERO,
            1 => -corner(b, rng.below(1_000)),
            _ => reach * direction(&mut rng),
        };
        let pivot = match round % 2 {
            0 => 0.2 * reach * direction(&mut rng),
            _ => 1.05 * corner(a, rng.below(1_000)),
        };
        let angle = [1e-4, 0.003, 0.03][rng.below(3)];
        let walk = turning(direction(&mut rng), angle, pivot, arm);
        let seen = follow(a, b, round % 5 == 0, walk);
        (tested, held) = (tested + seen.tested, held + seen.held);
        boldest = boldest.max(seen.boldest);
    }
    assert!(2 * tested < held && boldest > 0.9, "{tested} of {held}, {boldest}");
}

#[test]
fn steps_along_a_gap_spend_all_of_it() {
    // Straight at each other and away again: what is left is just what there is.
    let cube = shape(Cuboid::default());
    let away = |frame: u32| 1.6 - 0.02 * f64::from(frame.min(60 - frame));
    let walk = (0..60).map(|frame| Pose::at(DVec3::new(0.1, away(frame), 0.2)));
    let seen = follow(&cube, &cube, false, walk);
    assert!(seen.boldest > 0.999 && seen.tested < seen.held, "{seen:?}");
}

#[test]
fn a_hop_through_a_wall_breaks_what_was_inside() {
    let bodies = [
        shape(Sphere { segments: 24, rings: 12, ..Sphere::default() }),
        shape(Torus { major_segments: 18, minor_segments: 8, ..Torus::default() }),
        // A plate whose faces are large beside the hops.
        shape(Cuboid { size: [1.5, 1.2, 0.02] }),
    ];
    let speck = shape(Cuboid { size: [0.003, 0.002, 0.002] });
    let mut rng = Rng::new(31);
    let (mut hops, mut calm) = (0, 0);
    for (i, body) in bodies.iter().enumerate() {
        for pace in [0.004, 0.01, 0.05] {
            // A point of the surface, and hops of about `pace` around it, with turns.
            let foot = [DVec3::X, DVec3::new(1.2, 0.1, 0.0), DVec3::new(0.3, 0.2, 0.0)][i]
                .clamp(body.bounds().min, body.bounds().max);
            let walk: Vec<Pose> = (0..60)
                .map(|frame| Pose {
                    rotation: DQuat::from_axis_angle(DVec3::Y, 0.4 * rng.unit() * TAU),
                    translation: foot
                        + [pace, 0.1 * pace][usize::from(frame % 3 == 2)] * direction(&mut rng),
                })
                .collect();
            let seen = follow(body, &speck, false, walk);
            (hops, calm) = (hops + seen.hops, calm + seen.unbroken);
        }
    }
    assert!(hops > 50 && calm > 30, "{hops} {calm}");
}
