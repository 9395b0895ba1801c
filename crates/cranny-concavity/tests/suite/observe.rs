//! What is shown of a walk and of pockets is what was done: every state of a walk that is counted,
//! and which parts of two bodies meet.

use cranny_concavity::Concavities;
use cranny_concavity::pockets::{
    MetParts, PartsCase, PocketBody, PocketCounters, Pockets, PosedModels,
};
use cranny_concavity::walk::{
    HullFeature, Relation, WalkCounters, WalkObserver, WalkState, walk_hulls, walk_hulls_observed,
};
use cranny_exact::{DQuat, DVec3, Pose, RigidMap};
use cranny_geometry::hull::HullVertexId;
use cranny_geometry::{BuildOptions, Model};
use cranny_shapes::{Cup, Shape, Sphere, Torus};
use cranny_stability::hull_judge::{at, cuboid, disk, random_map, sphere};
use cranny_testkit::Rng;

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

fn shape(shape: impl Into<Shape>) -> Model {
    Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
}

fn pocket_body(model: &Model) -> PocketBody {
    PocketBody::of(model, std::sync::Arc::new(Concavities::of(model)))
}

/// Which parts meet, ascending, and how many of each body are opened and closed for that.
fn met(
    models: [&Model; 2],
    bodies: [&PocketBody; 2],
    second: Pose,
    pockets: &mut Pockets,
) -> (Vec<PartsCase>, [usize; 2], [usize; 2]) {
    let first_from_second = second.world_from_body();
    let pair = PosedModels { models, first_from_second, error: 1e-12 };
    pockets.open(&pair, bodies, None, &mut PocketCounters::default());
    let mut cases: Vec<PartsCase> =
        pockets.parts(bodies).map(|[a, b]| MetParts { a, b }.case()).collect();
    cases.sort_unstable();
    cases.dedup();
    let changed = [0, 1].map(|body| pockets.changed(body).map(|ids| ids.len()));
    (cases, changed.map(|[opened, _]| opened), changed.map(|[_, closed]| closed))
}

#[test]
fn which_parts_meet_and_what_is_opened_for_that_is_shown() {
    use PartsCase::{CapCap, CapConvex, ConvexConvex};
    let cup = shape(Cup { segments: 24, ..Cup::default() });
    let ball = shape(Sphere { radius: 0.2, segments: 12, rings: 8 });
    let [of_cup, of_ball] = [&cup, &ball].map(pocket_body);
    let middle = cup.bounds().center();
    // From beside the cup's wall to the middle of its inside, and into the wall from there.
    let outside = cup.bounds().max.x - middle.x + 0.19;
    for exchanged in [false, true] {
        let mut pockets = Pockets::default();
        let mut at = |x: f64| {
            let ball_in_cup = middle + DVec3::X * x;
            match exchanged {
                false => {
                    let (models, bodies) = ([&cup, &ball], [&of_cup, &of_ball]);
                    met(models, bodies, Pose::at(ball_in_cup), &mut pockets)
                }
                true => {
                    let (models, bodies) = ([&ball, &cup], [&of_ball, &of_cup]);
                    met(models, bodies, Pose::at(-ball_in_cup), &mut pockets)
                }
            }
        };
        let of_cup = if exchanged { [0, 1] } else { [1, 0] };
        assert_eq!(at(outside), (vec![ConvexConvex], [0, 0], [0, 0]));
        // The inside's faces are reached through the wall; no lid is crossed.
        let both = vec![ConvexConvex, CapConvex];
        assert_eq!(at(outside - 0.25), (both.clone(), of_cup, [0, 0]));
        assert_eq!(at(outside - 0.26), (both, [0, 0], [0, 0]));
        // In the middle it keeps off all of them.
        assert_eq!(at(0.0), (vec![ConvexConvex], [0, 0], of_cup));
    }
    // Each ring goes through the hole of the other.
    let ring = shape(Torus { major_segments: 24, minor_segments: 12, ..Torus::default() });
    let body = pocket_body(&ring);
    let turned = DQuat::from_axis_angle(DVec3::X, 1.5);
    let pose = Pose { rotation: turned, translation: DVec3::X };
    let (cases, opened, _) = met([&ring, &ring], [&body, &body], pose, &mut Pockets::default());
    assert!(cases.contains(&CapCap), "{cases:?}");
    assert_eq!(opened, [1, 1]);
}
