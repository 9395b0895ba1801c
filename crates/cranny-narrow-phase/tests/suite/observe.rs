//! What an observer is shown is what queries use: all faces, with bounds that hold, that motion
//! spends and splits renew; and of a walk every state that is counted.

use std::collections::BTreeSet;

use cranny_concavity::ConcavityId;
use cranny_concavity::pockets::{MetParts, PartsCase};
use cranny_concavity::walk::{
    HullFeature, Relation, WalkCounters, WalkObserver, WalkState, walk_hulls, walk_hulls_observed,
};
use cranny_exact::{DQuat, DVec3, Meeting, Pose, RigidMap};
use cranny_geometry::hull::HullVertexId;
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::{Demand, Method, PairMemory, PairObserver, Placed, Query, query};
use cranny_shapes::{Comb, Cuboid, Cup, Sphere, Torus};
use cranny_testkit::{Rng, Walk, from_surface, world_triangles};

use crate::solids::shape;
use cranny_stability::hull_judge::{at, cuboid, disk, random_map, sphere};

/// All that is shown.
#[derive(Clone, Debug, Default, PartialEq)]
struct Seen {
    crossing: Vec<[FaceId; 2]>,
    nearest: Option<[FaceId; 2]>,
}

impl PairObserver for Seen {
    fn crossing(&mut self, faces: [FaceId; 2]) {
        self.crossing.push(faces);
    }

    fn nearest(&mut self, faces: [FaceId; 2]) {
        self.nearest = Some(faces);
    }
}

fn seen(memory: &PairMemory, a: Placed, b: Placed) -> Seen {
    let mut seen = Seen::default();
    memory.observe(a, b, &mut seen).unwrap();
    seen
}

fn bodies() -> [Model; 4] {
    [
        shape(Torus { major_segments: 9, minor_segments: 5, ..Torus::default() }),
        shape(Cup { segments: 7, ..Cup::default() }),
        shape(Comb { teeth: 3, ..Comb::default() }),
        shape(Cuboid::default()),
    ]
}

#[test]
fn faces_that_are_shown_as_crossing_do() {
    let bodies = bodies();
    let mut rng = Rng::new(41);
    let mut crossings = 0;
    for round in 0..40 {
        let (a, b) = (&bodies[round % 4], &bodies[rng.below(4)]);
        let reach = a.radius() + b.radius();
        let mut walk = Walk::new(&mut rng, reach);
        let mut memory = PairMemory::default();
        for frame in 0..30 {
            walk.step(&mut rng, reach);
            let a = Placed { model: a, pose: Pose::IDENTITY };
            let b = Placed { model: b, pose: walk.pose };
            let answer = query(a, b, &Query::of(Demand::Intersects), &mut memory).unwrap();
            let now = seen(&memory, a, b);
            if !now.crossing.is_empty() {
                assert_eq!(answer.surface, Meeting::Cross, "round {round}, frame {frame}");
            }
            crossings += now.crossing.len();
        }
    }
    assert!(crossings > 100, "{crossings}");
}

#[test]
fn faces_that_are_shown_as_nearest_are_those_of_the_answer() {
    let [torus, cup, ..] = bodies();
    let mut memory = PairMemory::default();
    for frame in 0..20 {
        let turn = DQuat::from_axis_angle(DVec3::Y, 0.01 * f64::from(frame));
        let b = Placed {
            model: &cup,
            pose: Pose { rotation: turn, translation: DVec3::new(1.9, 1.3, 0.4) },
        };
        let a = Placed { model: &torus, pose: Pose::IDENTITY };
        let question = Query::of(Demand::Distance { below: None });
        let answer = query(a, b, &question, &mut memory).unwrap();
        let [f, g] = seen(&memory, a, b).nearest.unwrap();
        let [p, q] = answer.witnesses.unwrap().map(|witness| witness.point);
        assert!(from_surface(p, &world_triangles(a.model, &a.pose)[f.index()..=f.index()]) < 1e-12);
        assert!(from_surface(q, &world_triangles(b.model, &b.pose)[g.index()..=g.index()]) < 1e-12);
    }
}

#[test]
fn what_stems_from_elsewhere_is_not_shown() {
    let [torus, cup, ..] = bodies();
    let a = Placed { model: &torus, pose: Pose::IDENTITY };
    let at = |x: f64| Placed { model: &cup, pose: Pose::at(DVec3::new(0.7 + x, 0.1, 0.2)) };
    let mut memory = PairMemory::default();
    let nothing = Seen::default();
    assert_eq!(seen(&memory, a, at(0.0)), nothing);
    let question = Query::of(Demand::Regions { margin: 0.0 });
    for x in [1e-4, 2e-4, 3e-4] {
        query(a, at(x), &question, &mut memory).unwrap();
    }
    // Another body at the same place.
    let other = shape(Cuboid::default());
    let other = Placed { model: &other, pose: at(3e-4).pose };
    assert_eq!(seen(&memory, a, other), nothing);
    let nowhere = Placed { model: &cup, pose: Pose::at(DVec3::splat(f64::NAN)) };
    assert!(memory.observe(a, nowhere, &mut Seen::default()).is_err());
}

/// A pair that a walk looked at, and how far the second hull was moved for that.
type Step = ([HullFeature; 2], DVec3);

/// What a walk shows.
#[derive(Clone, Debug, Default)]
struct Steps {
    kept: Option<[HullFeature; 2]>,
    proved: Option<f64>,
    pairs: Vec<Step>,
    portals: u64,
    exhausted: u64,
}

impl WalkObserver for Steps {
    fn kept_pair(&mut self, pair: [HullFeature; 2]) {
        self.kept = Some(pair);
    }

    fn kept_portal(&mut self, _: [[HullVertexId; 2]; 3], depth: f64) {
        self.proved = Some(depth);
    }

    fn pair(&mut self, pair: [HullFeature; 2], shift: DVec3) {
        self.pairs.push((pair, shift));
    }

    fn portal(&mut self, _: [[HullVertexId; 2]; 3]) {
        self.portals += 1;
    }

    fn exhausted(&mut self, _: DVec3) {
        self.exhausted += 1;
    }
}

#[test]
fn every_state_of_a_walk_is_shown_and_none_changes() {
    let hulls = [cuboid(DVec3::ONE), sphere(40, 7), disk(12, 1.0), cuboid(DVec3::splat(0.2))];
    let mut rng = Rng::new(47);
    let mut kinds = [0u32; 4];
    for round in 0..60 {
        let (a, b) = (&hulls[round % 4], &hulls[rng.below(4)]);
        let mut map = match round % 6 {
            // Faces flush: what only the exact predicates decide.
            0 => at(2.0, 0.0, 0.0),
            _ => random_map(&mut rng, 2.5),
        };
        let (mut state, mut unseen) = (WalkState::default(), WalkState::default());
        for _ in 0..12 {
            let (mut counters, mut steps) = (WalkCounters::default(), Steps::default());
            let last = state.features();
            let found = walk_hulls_observed(
                a.walkable(),
                b.walkable(),
                &map,
                &mut state,
                &mut counters,
                &mut steps,
            )
            .unwrap();
            let mut plain = WalkCounters::default();
            let same = walk_hulls(a.walkable(), b.walkable(), &map, &mut unseen, &mut plain);
            assert_eq!((same.unwrap(), plain, unseen), (found, counters, state));
            assert_eq!(steps.pairs.len() as u64, counters.steps);
            assert_eq!((steps.portals, steps.exhausted), (counters.portals, counters.exhausted));
            let (walked, parting): (Vec<&Step>, Vec<&Step>) =
                steps.pairs.iter().partition(|(_, shift)| *shift == DVec3::ZERO);
            if let (Some(last), Some(kept)) = (last, steps.kept) {
                assert_eq!(kept, last, "a walk starts where the last one ended");
            }
            if found.relation == Relation::Separated && counters.exhausted == 0 {
                assert!(parting.is_empty() && steps.proved.is_none());
                let end = walked.last().map(|step| step.0).or(steps.kept);
                assert_eq!(end, Some(found.features));
            }
            if let Some(depth) = steps.proved {
                assert_eq!(found.separation.hi, -depth);
                assert_eq!((counters.proved_at_once, walked.len()), (1, 0));
            }
            kinds[0] += u32::from(walked.len() > 1);
            kinds[1] += u32::from(!parting.is_empty());
            kinds[2] += u32::from(steps.proved.is_some());
            kinds[3] += u32::from(steps.portals > 0);
            assert_eq!(state.features(), Some(found.features));
            map = RigidMap { translation: 0.93 * map.translation, ..map };
        }
    }
    assert!(kinds.iter().all(|&times| times > 10), "{kinds:?}");
}

/// What a query by envelopes reports of parts.
#[derive(Debug, Default, PartialEq, Eq)]
struct Parts {
    cases: BTreeSet<PartsCase>,
    opened: Vec<usize>,
    closed: Vec<usize>,
}

impl PairObserver for Parts {
    fn parts(&mut self, met: MetParts) {
        self.cases.insert(met.case());
    }

    fn opened(&mut self, body: usize, _: ConcavityId) {
        self.opened.push(body);
    }

    fn closed(&mut self, body: usize, _: ConcavityId) {
        self.closed.push(body);
    }
}

fn parts(a: Placed, b: Placed, memory: &mut PairMemory) -> Parts {
    let question = Query::of(Demand::Intersects).by(Method::Envelopes);
    query(a, b, &question, memory).unwrap();
    let mut parts = Parts::default();
    memory.observe(a, b, &mut parts).unwrap();
    parts
}

#[test]
fn which_parts_meet_and_what_is_opened_for_that_is_shown() {
    use PartsCase::{CapCap, CapConvex, ConvexConvex};
    let cup = shape(Cup { segments: 24, ..Cup::default() });
    let ball = shape(Sphere { radius: 0.2, segments: 12, rings: 8 });
    let middle = cup.bounds().center();
    // From beside the cup's wall to the middle of its inside, and into the wall from there.
    let wall = cup.bounds().max.x;
    let placed = |x: f64| Placed { model: &ball, pose: Pose::at(middle + DVec3::X * x) };
    let host = Placed { model: &cup, pose: Pose::IDENTITY };
    let reported = |cases: &[PartsCase], opened: &[usize], closed: &[usize]| Parts {
        cases: cases.iter().copied().collect(),
        opened: opened.to_vec(),
        closed: closed.to_vec(),
    };
    for exchanged in [false, true] {
        let mut memory = PairMemory::default();
        let mut ask = |x: f64| match exchanged {
            false => parts(host, placed(x), &mut memory),
            true => parts(placed(x), host, &mut memory),
        };
        let cup_is = usize::from(exchanged);
        let outside = wall - middle.x + 0.19;
        assert_eq!(ask(outside), reported(&[ConvexConvex], &[], &[]));
        // The inside's faces are reached through the wall; no lid is crossed.
        assert_eq!(ask(outside - 0.25), reported(&[ConvexConvex, CapConvex], &[cup_is], &[]));
        assert_eq!(ask(outside - 0.26), reported(&[ConvexConvex, CapConvex], &[], &[]));
        // In the middle it keeps off all of them.
        assert_eq!(ask(0.0), reported(&[ConvexConvex], &[], &[cup_is]));
        // Far away there is nothing to tell: a plane parts them.
        assert_eq!(ask(9.0), Parts::default());
    }
    // Each ring goes through the hole of the other.
    let ring = shape(Torus { major_segments: 24, minor_segments: 12, ..Torus::default() });
    let turned = DQuat::from_axis_angle(DVec3::X, 1.5);
    let pose = Pose { rotation: turned, translation: DVec3::X };
    let link = Placed { model: &ring, pose };
    let links =
        parts(Placed { model: &ring, pose: Pose::IDENTITY }, link, &mut PairMemory::default());
    assert!(links.cases.contains(&CapCap), "{links:?}");
    assert_eq!(links.opened, [0, 1]);
}
