//! Random walks: memory must not change an answer.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::brute_force::brute_force;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, NestedShells, Shape, Sphere, Torus};

use crate::case::Case;
use crate::family::Family;
use crate::pair::{cold, in_words, peer_case, without_counters, words};
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "memory",
    question: "Bodies drift, turn, rest, turn back and jump; steps are skipped, memory is cleared, copied or handed on to \
            another pair, A and B change places, another query is made.",
    made: "Each answer is compared with one without memory, to the last bit; every fourth with all pairs of faces, which \
           the detector's own predicates and triangle distances judge.",
    fails: "any difference",
    figure: "difference of the distance to brute force's, in sizes of the larger body",
    cases,
};

fn bodies(trial: &mut Trial<'_>) -> Vec<(&'static str, Model)> {
    let shapes: [(&'static str, Shape); 7] = [
        ("cup", Cup { segments: 12, ..Cup::default() }.into()),
        ("torus", Torus { major_segments: 16, minor_segments: 7, ..Torus::default() }.into()),
        ("comb", Comb::default().into()),
        ("shells", NestedShells { segments: 7, ..NestedShells::default() }.into()),
        ("speck", Cuboid { size: [0.06, 0.05, 0.04] }.into()),
        ("sphere", Sphere { segments: 10, rings: 6, ..Sphere::default() }.into()),
        ("golf ball", GolfBall { dimples: 0, triangles: 80, ..GolfBall::default() }.into()),
    ];
    let build = |(name, shape): (&'static str, Shape)| {
        let mesh = shape.build().map_err(|error| trial.failed(name, error.to_string())).ok()?;
        Some((name, trial.model(name, mesh)?))
    };
    shapes.into_iter().filter_map(build).collect()
}

fn cases(trial: &mut Trial<'_>) {
    let bodies = bodies(trial);
    let mut memory = PairMemory::default();
    for round in 0..trial.variants {
        for walk in 0..bodies.len() {
            let (name_a, a) = &bodies[walk];
            let (name_b, b) = &bodies[(walk + round as usize + 3) % bodies.len()];
            // Memory goes from walk to walk, whatever pair it was of.
            stroll(trial, &format!("{name_a} and {name_b}"), [a, b], &mut memory);
        }
    }
}

/// A step and a turn, in sizes and radians: from what hardly moves a bit to what passes features.
/// Other values make other walks.
const PACES: [f64; 4] = [1e-12, 1e-6, 1e-3, 1e-2];

/// Where a body goes: it keeps near the origin.
struct Stroll {
    pose: Pose,
    drift: DVec3,
    spin: DQuat,
}

impl Stroll {
    fn begin(trial: &mut Trial<'_>, reach: f64) -> Self {
        let far = *trial.pick(&[0.05, 0.5, 0.8]) * reach;
        let pose =
            Pose { rotation: trial.rng.rotation(), translation: far * trial.rng.direction() };
        let mut stroll = Self { pose, drift: DVec3::ZERO, spin: DQuat::IDENTITY };
        stroll.turn(trial, reach);
        stroll
    }

    fn turn(&mut self, trial: &mut Trial<'_>, reach: f64) {
        let pace = *trial.pick(&PACES);
        let is_far = self.pose.translation.length() > 0.9 * reach;
        let way = if is_far { -self.pose.translation.normalize() } else { trial.rng.direction() };
        self.drift = pace * reach * way;
        self.spin = trial.tilt(pace);
    }

    fn step(&mut self, trial: &mut Trial<'_>, reach: f64) -> &'static str {
        let what = match trial.rng.below(24) {
            0 => {
                *self = Self::begin(trial, reach);
                "jumps"
            }
            1 => {
                (self.drift, self.spin) = (-self.drift, self.spin.conjugate());
                "turns back"
            }
            2 => {
                (self.drift, self.spin) = (DVec3::ZERO, DQuat::IDENTITY);
                "rests"
            }
            3 | 4 => {
                self.turn(trial, reach);
                "turns"
            }
            _ => "goes on",
        };
        self.pose.translation += self.drift;
        self.pose.rotation = (self.spin * self.pose.rotation).normalize();
        what
    }
}

/// Steps of a walk.
const FRAMES: usize = 16;

fn stroll(trial: &mut Trial<'_>, names: &str, [a, b]: [&Model; 2], memory: &mut PairMemory) {
    let reach = a.radius() + b.radius();
    let at = Pose { rotation: trial.rng.rotation(), translation: trial.quarters(2) };
    let mut stroll = Stroll::begin(trial, reach);
    for frame in 0..FRAMES {
        let what = stroll.step(trial, reach);
        if trial.rng.below(8) == 0 {
            continue;
        }
        match trial.rng.below(16) {
            0 => memory.clear(),
            1 => *memory = memory.clone(),
            _ => {}
        }
        let pose = at.compose(&stroll.pose);
        let mut pair = [Placed { model: a, pose: at }, Placed { model: b, pose }];
        if trial.rng.below(5) == 0 {
            pair.reverse();
        }
        let demand = match trial.rng.below(5) {
            0 => Demand::Intersects,
            1 | 2 => Demand::Distance { below: None },
            3 => Demand::contacts(0.02 * reach),
            _ => Demand::Regions { margin: 0.0 },
        };
        let name = format!("{names}, frame {frame}, {what}, {demand:?}");
        one(trial, name, pair, demand, frame % 4 == 0, memory);
    }
}

fn one(
    trial: &mut Trial<'_>,
    name: String,
    [a, b]: [Placed; 2],
    demand: Demand,
    by_all_pairs: bool,
    memory: &mut PairMemory,
) {
    trial.case(name, |trial, case| {
        case.truth = "the same without memory".to_owned();
        let warm = query(a, b, &Query::of(demand), memory).map(without_counters);
        let cold = cold(a, b, demand);
        let (Ok(warm), Ok(cold)) = (&warm, &cold) else {
            case.faults.push(format!("refused: {warm:?}, {cold:?}"));
            return;
        };
        case.answer = in_words(warm);
        if warm != cold {
            case.faults.push(format!("{warm:?} is not {cold:?}"));
        }
        if by_all_pairs {
            beside_all_pairs(trial, case, warm, [a, b]);
        }
    });
}

/// Held against the product's own brute force.
fn beside_all_pairs(trial: &mut Trial<'_>, case: &mut Case, answer: &Answer, [a, b]: [Placed; 2]) {
    let slow = match brute_force(a, b) {
        Ok(slow) => slow,
        Err(error) => return case.faults.push(format!("all pairs are refused: {error}")),
    };
    case.truth = words(slow.surface, false, None, Some(slow.distance));
    if slow.surface != answer.surface {
        case.faults.push(format!("all pairs say: {}", case.truth));
    }
    let size = a.model.bounds().diagonal().max(b.model.bounds().diagonal());
    if let Some(distance) = answer.distance {
        let off = (distance - slow.distance).abs();
        case.figure = Some(off / size);
        if distance != slow.distance {
            case.faults.push(format!("all pairs say: {:e} apart", slow.distance));
        }
    }
    if let Some(peer) = trial.peer.as_mut() {
        let reply = peer.surfaces([a.model, b.model], [a.pose, b.pose]);
        case.peer = Some(peer_case(reply, Some(slow.surface.meets()), slow.distance, size));
    }
}
