//! What a world promises, seen from outside: lifetime, demands, events, order.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{
    Answer, Counters, Demand, PairMemory, Placed, Query, RegionId, Surface, query,
};
use cranny_shapes::{Cuboid, Torus};
use cranny_world::description::{BodyKind, Effect};
use cranny_world::{
    BodyId, BodySpec, ContactFields, Layers, PairEvent, PairEventKind, StepReport, World,
    WorldError,
};
use proptest::prelude::*;

fn model(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

fn unit_cube() -> Model {
    model(Cuboid::default().build().unwrap())
}

fn at(x: f64) -> Pose {
    Pose::at(DVec3::new(x, 0.0, 0.0))
}

fn cube(name: &str, x: f64) -> BodySpec {
    BodySpec { pose: at(x), ..BodySpec::new(name, unit_cube()) }
}

/// A world of unit cubes named "0", "1", ... along x, under the scene's effects.
fn row(effects: &[Effect], places: &[f64]) -> (World, Vec<BodyId>) {
    let mut world = World::new();
    world.set_scene_effects(effects).unwrap();
    let ids = places
        .iter()
        .enumerate()
        .map(|(i, &x)| world.insert(cube(&i.to_string(), x)).unwrap())
        .collect();
    (world, ids)
}

fn step(world: &mut World) -> StepReport {
    let report = world.step().unwrap();
    world.validate().unwrap();
    report
}

fn began(a: BodyId, b: BodyId) -> PairEvent {
    PairEvent { a, b, kind: PairEventKind::Began }
}

fn ended(a: BodyId, b: BodyId) -> PairEvent {
    PairEvent { a, b, kind: PairEventKind::Ended }
}

/// What a solver kept apart by an impulse touches, although the surfaces are apart; it says so
/// before each step anew.
#[test]
fn pairs_that_press_touch_for_a_step() {
    let (mut world, ids) = row(&[Effect::TRIGGER], &[0.0, 1.25, 4.0]);
    assert_eq!((step(&mut world).events, world.remembered_pairs()), (vec![], 0));
    world.press(ids[1], ids[0]).unwrap();
    let report = step(&mut world);
    assert_eq!(report.events, [began(ids[0], ids[1])]);
    assert_eq!(report.touching, [(ids[0], ids[1])]);
    world.press(ids[0], ids[1]).unwrap();
    assert!(step(&mut world).events.is_empty(), "it goes on");
    let report = step(&mut world);
    assert_eq!(report.events, [ended(ids[0], ids[1])]);
    assert!(report.touching.is_empty());
    // Nobody asks about the pair, or one of both is gone.
    world.exclude_pair(ids[0], ids[1]).unwrap();
    world.press(ids[0], ids[1]).unwrap();
    world.press(ids[1], ids[2]).unwrap();
    world.remove(ids[2]).unwrap();
    assert!(step(&mut world).events.is_empty());
    assert!(world.press(ids[0], ids[0]).is_err() && world.press(ids[0], ids[2]).is_err());
}

/// A bar with two legs under a plate that comes down on them, until the bar is reached, and goes up
/// again.
#[test]
fn regions_that_merge_and_split_are_events() {
    let plate = model(Cuboid { size: [6.0, 1.0, 6.0] }.build().unwrap());
    let legs = model(cranny_testkit::bodies::channel());
    let mut world = World::new();
    world.set_scene_effects(&[Effect::Contacts { margin: 0.0 }]).unwrap();
    let lower = world.insert(BodySpec::new("legs", legs)).unwrap();
    // Its underside is half a unit beneath its middle.
    let over = |y: f64| Pose::at(DVec3::new(1.3, y + 0.5, 1.1));
    let upper = BodySpec { pose: over(2.5), ..BodySpec::new("plate", plate) };
    let upper = world.insert(upper).unwrap();
    let mut kinds = Vec::new();
    for y in [2.5, 1.9, 1.5, 1.5, 0.9, 0.8, 1.4, 1.45, 2.5] {
        world.set_pose(upper, over(y)).unwrap();
        let report = step(&mut world);
        assert!(report.events.iter().all(|event| (event.a, event.b) == (lower, upper)));
        kinds.push(report.events.iter().map(|event| event.kind).collect::<Vec<_>>());
    }
    // The one that shares most pairs of faces with the whole goes on.
    let [PairEventKind::RegionMerged { region, gone }] = kinds[4][..] else {
        panic!("{kinds:?}");
    };
    assert!([[RegionId(0), RegionId(1)], [RegionId(1), RegionId(0)]].contains(&[region, gone]));
    let merged = PairEventKind::RegionMerged { region, gone };
    let split = PairEventKind::RegionSplit { region, part: RegionId(2) };
    let (began, ended) = (PairEventKind::Began, PairEventKind::Ended);
    let expected = [
        vec![],
        vec![began],
        vec![],
        vec![],
        vec![merged],
        vec![],
        vec![split],
        vec![],
        vec![ended],
    ];
    assert_eq!(kinds, expected);
}

fn answered(report: &StepReport) -> Vec<(u32, u32)> {
    report.answers.iter().map(|p| (p.a.0, p.b.0)).collect()
}

#[test]
fn a_pair_begins_rests_and_ends() {
    let (mut world, ids) = row(&[Effect::TRIGGER], &[0.0, 5.0]);
    let first = step(&mut world);
    assert_eq!((first.step, first.events.len(), first.stats.candidate_pairs), (0, 0, 0));

    world.set_pose(ids[1], at(1.0)).unwrap(); // face on face
    let touch = step(&mut world);
    assert_eq!(touch.events, [began(ids[0], ids[1])]);
    assert_eq!(touch.answers[0].answer.surface, Surface::Touch);
    assert!(!touch.answers[0].answer.solid);
    assert_eq!(touch.stats.touching_pairs, 1);
    assert_eq!(world.remembered_pairs(), 1);

    world.set_pose(ids[1], at(0.5)).unwrap();
    let rest = step(&mut world);
    assert!(rest.events.is_empty() && rest.answers[0].answer.solid);

    world.set_pose(ids[1], at(5.0)).unwrap();
    let gone = step(&mut world);
    assert_eq!(gone.events, [ended(ids[0], ids[1])]);
    assert_eq!((gone.step, world.remembered_pairs(), gone.answers.len()), (3, 0, 0));
}

#[test]
fn boxes_that_overlap_are_not_yet_bodies_that_touch() {
    // Two tori side by side, one turned so that it stands in the other's hole without touching.
    let ring = model(Torus::default().build().unwrap());
    let small = model(Torus::default().build().unwrap().scaled(DVec3::splat(0.25)).unwrap());
    let mut world = World::new();
    world.set_scene_effects(&[Effect::TRIGGER]).unwrap();
    world.insert(BodySpec::new("ring", ring)).unwrap();
    world.insert(BodySpec::new("small", small)).unwrap();
    let report = step(&mut world);
    assert_eq!((report.stats.candidate_pairs, report.stats.queried_pairs), (1, 1));
    assert!(report.events.is_empty());
    assert_eq!(report.answers[0].answer.surface, Surface::None);
    assert!(report.stats.counters.node_tests > 0);
}

#[test]
fn removing_a_body_ends_what_it_touched_and_frees_its_name_only() {
    let (mut world, ids) = row(&[Effect::TRIGGER], &[0.0, 0.75, 1.5]);
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1]), began(ids[1], ids[2])]);
    world.set_pair_effects(ids[1], ids[2], &[Effect::Contacts { margin: 1.0 }]).unwrap();
    world.exclude_pair(ids[0], ids[1]).unwrap();
    let removed = world.remove(ids[1]).unwrap();
    assert_eq!(removed.name(), "1");
    assert_eq!(world.name(ids[1]), Some("1"), "named until its end is reported");
    let again = world.insert(cube("1", 0.75)).unwrap();
    assert!(again > ids[2], "ids are never used again");
    let report = step(&mut world);
    let (first, last) = (ids[0], ids[2]);
    assert_eq!(
        report.events,
        [ended(first, ids[1]), began(first, again), ended(ids[1], last), began(last, again)]
    );
    assert_eq!(world.name(ids[1]), Some("1"));
    step(&mut world);
    assert_eq!(world.name(ids[1]), None);
    assert!(matches!(world.remove(ids[1]), Err(WorldError::UnknownBody { .. })));
}

#[test]
fn demands_are_joined_over_scene_bodies_and_pair() {
    let (mut world, ids) = row(&[], &[0.0, 1.0, 2.0]);
    let demand = |w: &World, a: usize, b: usize| w.demand_of(ids[a], ids[b]).unwrap();
    assert_eq!(demand(&world, 0, 1), Demand::None);
    world.set_scene_effects(&[Effect::TRIGGER, Effect::Response]).unwrap();
    assert_eq!(demand(&world, 0, 1), Demand::Intersects);
    world.set_effects(ids[0], &[Effect::Contacts { margin: 0.1 }]).unwrap();
    world.set_pair_effects(ids[2], ids[0], &[Effect::Contacts { margin: 0.3 }]).unwrap();
    assert_eq!(demand(&world, 1, 0), Demand::Regions { margin: 0.1 });
    assert_eq!(demand(&world, 0, 2), Demand::Regions { margin: 0.3 });
    assert_eq!(demand(&world, 1, 2), Demand::Intersects);
    world.exclude_pair(ids[2], ids[0]).unwrap();
    assert_eq!(demand(&world, 0, 2), Demand::None);
    world.set_effects(ids[0], &[]).unwrap();
    world.set_scene_effects(&[Effect::Response]).unwrap();
    assert_eq!(demand(&world, 0, 1), Demand::None, "the solver's step detects these");
}

#[test]
fn a_pair_without_demand_is_never_looked_at() {
    let (mut world, ids) = row(&[Effect::Response], &[0.0, 0.5]);
    let report = step(&mut world);
    assert_eq!((report.stats.candidate_pairs, report.stats.queried_pairs), (1, 0));
    assert!(report.answers.is_empty() && report.events.is_empty());
    assert_eq!(world.remembered_pairs(), 0);

    world.set_effects(ids[0], &[Effect::TRIGGER]).unwrap();
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1])]);
    world.set_effects(ids[0], &[]).unwrap();
    let report = step(&mut world);
    assert_eq!(report.events, [ended(ids[0], ids[1])], "began and ended alternate");
    assert_eq!(world.remembered_pairs(), 0);
}

#[test]
fn layers_kinds_and_exclusions_keep_bodies_apart() {
    let mut world = World::new();
    world.set_scene_effects(&[Effect::TRIGGER]).unwrap();
    let mut put = |name: &str, kind, layers: u32| {
        let layers = Layers::shared(layers);
        world.insert(BodySpec { kind, layers, ..cube(name, 0.0) }).unwrap()
    };
    let [all, ground, ghosts] = [1, 2, 4];
    let floor = put("floor", BodyKind::Fixed, all | ground);
    let wall = put("wall", BodyKind::Fixed, all);
    let ghost = put("ghost", BodyKind::Dynamic, ghosts | ground);
    let spirit = put("spirit", BodyKind::Kinematic, ghosts);
    let nothing = put("nothing", BodyKind::Dynamic, 0);
    let ball = put("ball", BodyKind::Dynamic, all);
    world.exclude_pair(ball, wall).unwrap();
    assert!(!world.may_meet(floor, wall).unwrap() && !world.may_meet(nothing, ball).unwrap());
    assert_eq!(
        answered(&step(&mut world)),
        [(floor.0, ghost.0), (floor.0, ball.0), (ghost.0, spirit.0)]
    );
}

#[test]
fn margins_reach_across_gaps_whoever_asks() {
    let margin = 0.5;
    let near = [Effect::Contacts { margin }];
    type Ask<'a> = &'a dyn Fn(&mut World, &[BodyId]);
    let ask: [Ask; 4] = [
        &|w, _| w.set_scene_effects(&near).unwrap(),
        &|w, ids| w.set_effects(ids[0], &near).unwrap(),
        &|w, ids| w.set_effects(ids[1], &near).unwrap(),
        &|w, ids| w.set_pair_effects(ids[1], ids[0], &near).unwrap(),
    ];
    for asking in ask {
        // The gap is the margin, exactly: 1.5 - 1 = 0.5.
        let (mut world, ids) = row(&[], &[0.0, 1.5]);
        asking(&mut world, &ids);
        let report = step(&mut world);
        assert_eq!(report.stats.queried_pairs, 1);
        assert!(report.events.is_empty(), "near is not touching");
        world.set_pose(ids[1], at(1.25)).unwrap();
        let report = step(&mut world);
        let region = &report.answers[0].answer.regions[0];
        assert!((region.deepest.separation - 0.25).abs() < 1e-12);
        assert!(report.stats.contacts > 0 && report.stats.deepest.is_none());
        world.set_pose(ids[1], at(2.5)).unwrap();
        assert_eq!(step(&mut world).stats.candidate_pairs, 0);
    }
}

#[test]
fn of_contacts_only_what_is_read_is_answered() {
    let depth = ContactFields { depth: Some(0.0), ..ContactFields::NONE };
    let points = ContactFields { points: true, ..depth };
    // The gap is within the margin; then a corner of one cube is in the other.
    let (mut world, ids) = row(&[Effect::Contacts { margin: 0.5 }], &[0.0, 1.25]);
    let found = |world: &mut World| {
        let report = step(world);
        let answers = report.answers.iter().map(|pair| &pair.answer);
        let counts = answers.map(|a| (!a.contacts.is_empty(), !a.regions.is_empty()));
        (counts.collect::<Vec<_>>(), report.stats.deepest.is_some(), report.events)
    };
    for (read, near) in
        [(ContactFields::ALL, (true, true)), (points, (true, false)), (depth, (false, false))]
    {
        world.set_contact_fields(read);
        assert_eq!(found(&mut world), (vec![near], false, vec![]), "{read:?}");
    }
    world.set_pose(ids[1], Pose::at(DVec3::new(0.9, 0.7, 0.8))).unwrap();
    let overlapping = vec![(true, false)];
    assert_eq!(found(&mut world), (overlapping, true, vec![began(ids[0], ids[1])]));
    // Nothing is read, so nothing is asked about the pair any more.
    world.set_contact_fields(ContactFields::NONE);
    assert_eq!(world.demand_of(ids[0], ids[1]).unwrap(), Demand::None);
    assert_eq!(found(&mut world), (vec![], false, vec![ended(ids[0], ids[1])]));
}

#[test]
fn what_one_pair_is_read_for_is_not_computed_of_others() {
    let (mut world, ids) = row(&[Effect::Contacts { margin: 0.5 }], &[0.0, 1.25, 2.5]);
    let regions = ContactFields { regions: true, ..ContactFields::NONE };
    let mut with_regions = |read: ContactFields, of_pairs: &[(BodyId, BodyId)]| {
        world.set_contact_fields(read);
        let of_pairs = of_pairs.iter().map(|&pair| (pair, regions));
        world.set_contact_fields_of_pairs(of_pairs.collect());
        let report = step(&mut world);
        let found = report.answers.iter().filter(|pair| !pair.answer.regions.is_empty());
        (found.map(|pair| (pair.a, pair.b)).collect::<Vec<_>>(), report.answers.len())
    };
    let [first, second] = [(ids[0], ids[1]), (ids[1], ids[2])];
    let depth = ContactFields { depth: Some(0.0), ..ContactFields::NONE };
    assert_eq!(with_regions(ContactFields::NONE, &[second]), (vec![second], 1));
    assert_eq!(with_regions(depth, &[first]), (vec![first], 2));
    assert_eq!(with_regions(depth, &[]), (vec![], 2));
    assert_eq!(with_regions(regions, &[]), (vec![first, second], 2));
    with_regions(depth, &[first, second]);
    world.remove(ids[1]).unwrap();
    world.validate().unwrap();
}

#[test]
fn a_pair_is_not_queried_for_a_depth_that_is_known_to_be_no_deeper() {
    let deeper_than = |depth| ContactFields { depth: Some(depth), ..ContactFields::NONE };
    let (mut world, ids) = row(&[Effect::Contacts { margin: 0.5 }], &[0.0, 10.0]);
    world.set_contact_fields(deeper_than(0.25));
    // A corner of one cube is in the other by an eighth.
    world.set_pose(ids[1], Pose::at(DVec3::new(0.875, 0.5, 0.5))).unwrap();
    let mut found = |bound: Option<f64>, read: ContactFields| {
        world.set_contact_fields(read);
        if let Some(at_most) = bound {
            world.bound_depth(ids[1], ids[0], at_most).unwrap();
        }
        let report = step(&mut world);
        (report.stats.queried_pairs, report.stats.deepest.is_some(), report.events)
    };
    let (begun, over) = (vec![began(ids[0], ids[1])], vec![ended(ids[0], ids[1])]);
    // A verdict is computed in any case: what begins to touch is seen.
    assert_eq!(found(Some(0.2), deeper_than(0.25)), (1, false, begun.clone()));
    // The bound is of one step.
    assert_eq!(found(None, deeper_than(0.25)), (1, true, vec![]));
    assert_eq!(found(Some(0.3), deeper_than(0.25)), (1, true, vec![]));
    assert_eq!(found(Some(f64::NAN), deeper_than(0.25)), (1, true, vec![]));
    // Who reads more than that is answered.
    assert_eq!(found(Some(0.2), deeper_than(0.0)), (1, true, vec![]));
    assert_eq!(found(Some(0.2), ContactFields::ALL), (1, true, vec![]));
    // A gap that is known ends a contact.
    assert_eq!(found(Some(-0.1), deeper_than(0.25)), (0, false, over));
    assert_eq!(found(None, deeper_than(0.25)), (1, true, begun));
    assert!(matches!(world.bound_depth(ids[0], ids[0], 0.0), Err(WorldError::SameBody { .. })));
}

#[test]
fn boxes_that_part_end_a_contact_whatever_depth_is_known() {
    let (mut world, ids) = row(&[Effect::Contacts { margin: 0.0 }], &[0.0, 0.875]);
    world.set_contact_fields(ContactFields { depth: Some(0.5), ..ContactFields::NONE });
    assert_eq!(step(&mut world).touching.len(), 1);
    world.set_pose(ids[1], Pose::at(DVec3::X * 5.0)).unwrap();
    world.bound_depth(ids[0], ids[1], 0.25).unwrap();
    assert_eq!(step(&mut world).events, vec![ended(ids[0], ids[1])]);
}

#[test]
fn the_deepest_overlap_is_told_with_its_pair() {
    // Pegs of half the size, stuck into the +x face of a cube by 1/8 and by 1/4.
    let peg = model(Cuboid { size: [0.5; 3] }.build().unwrap());
    let (mut world, ids) = row(&[Effect::Contacts { margin: 0.0 }], &[0.0, 10.0]);
    for (name, x) in [("shallow", 0.625), ("deep", 10.5)] {
        world.insert(BodySpec { pose: at(x), ..BodySpec::new(name, peg.clone()) }).unwrap();
    }
    let report = step(&mut world);
    let deepest = report.stats.deepest.unwrap();
    assert_eq!((deepest.a, world.name(deepest.b)), (ids[1], Some("deep")));
    // How exact a depth is belongs to the narrow phase; here only one of two must be picked.
    assert!((deepest.depth - 0.25).abs() < 1e-6, "depth {}", deepest.depth);
    assert_eq!((report.stats.touching_pairs, report.stats.boxes), (2, 4));
}

fn fresh(a: Pose, b: Pose, demand: Demand) -> Answer {
    let cube = unit_cube();
    let (a, b) = (Placed { model: &cube, pose: a }, Placed { model: &cube, pose: b });
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

#[test]
fn a_supplied_answer_is_reported_once_and_not_queried() {
    let (mut world, ids) = row(&[Effect::Response, Effect::TRIGGER], &[0.0, 0.75]);
    let demand = Demand::Regions { margin: 0.0 };
    // Told by the solver in its own order: the second body as A.
    let answer = fresh(at(0.75), at(0.0), demand);
    world.supply(ids[1], ids[0], answer.clone()).unwrap();
    let report = step(&mut world);
    assert_eq!((report.stats.supplied_pairs, report.stats.queried_pairs), (1, 0));
    assert_eq!(report.events, [began(ids[0], ids[1])]);
    let supplied = &report.answers[0];
    assert_eq!((supplied.a, supplied.b), (ids[0], ids[1]));
    let (own, theirs) = (&supplied.answer.regions[0], &answer.regions[0]);
    assert_eq!(own.normal, -theirs.normal);
    assert_eq!(own.deepest.point_a, theirs.deepest.point_b);
    assert_eq!(own.deepest.id, (theirs.deepest.id.1, theirs.deepest.id.0));

    // Not supplied this time: the demand is answered afresh.
    let report = step(&mut world);
    assert_eq!((report.stats.supplied_pairs, report.stats.queried_pairs), (0, 1));
    assert!(report.events.is_empty());
}

#[test]
fn a_response_alone_reports_answers_but_no_events() {
    let (mut world, ids) = row(&[Effect::Response], &[0.0, 0.75]);
    world
        .supply(ids[0], ids[1], fresh(at(0.0), at(0.75), Demand::Regions { margin: 0.0 }))
        .unwrap();
    let report = step(&mut world);
    assert_eq!(answered(&report), [(0, 1)]);
    assert!(report.events.is_empty() && report.stats.contacts > 0);
}

#[test]
fn bad_calls_are_named_and_change_nothing() {
    let (mut world, ids) = row(&[Effect::TRIGGER], &[0.0, 0.5]);
    let before = step(&mut world);
    assert!(matches!(world.insert(cube("1", 9.0)), Err(WorldError::DuplicateName { .. })));
    let bad_pose = BodySpec { pose: at(f64::NAN), ..cube("bad", 0.0) };
    let message = world.insert(bad_pose).unwrap_err().to_string();
    assert!(message.contains("'bad'") && message.contains("NaN"), "{message}");
    assert!(matches!(world.set_pose(ids[0], at(f64::INFINITY)), Err(WorldError::Pose { .. })));
    let zero = Pose { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), translation: DVec3::ZERO };
    assert!(matches!(world.set_pose(ids[0], zero), Err(WorldError::Pose { .. })));
    let negative = [Effect::Contacts { margin: -1.0 }];
    assert!(matches!(world.set_effects(ids[0], &negative), Err(WorldError::Margin { .. })));
    assert!(matches!(world.set_scene_effects(&negative), Err(WorldError::Margin { .. })));
    assert!(matches!(
        world.set_pair_effects(ids[0], ids[1], &negative),
        Err(WorldError::Margin { .. })
    ));
    assert!(matches!(world.exclude_pair(ids[0], ids[0]), Err(WorldError::SameBody { .. })));
    let stranger = BodyId(77);
    assert!(matches!(world.demand_of(ids[0], stranger), Err(WorldError::UnknownBody { .. })));
    assert!(matches!(world.set_pose(stranger, at(0.0)), Err(WorldError::UnknownBody { .. })));
    let after = step(&mut world);
    // What memory saves is history, not the answer.
    let without_counters = |report: &StepReport| {
        let mut answers = report.answers.clone();
        answers.iter_mut().for_each(|pair| pair.answer.counters = Counters::default());
        answers
    };
    assert_eq!(without_counters(&after), without_counters(&before));
    assert!(after.events.is_empty());
}

/// A cube on edge whose corner meets another cube's face, give or take a few ulps: what the narrow
/// phase calls touching after its roundings must not be kept apart by boxes rounded otherwise.
#[test]
fn corners_that_touch_by_a_rounding_are_found() {
    let (mut met, mut parted) = (0, 0);
    for i in 1..50 {
        let half_angle = std::f64::consts::FRAC_PI_4 * f64::from(i) / 50.0;
        // Unit to rounding only: worlds keep such quaternions to the bit.
        let stretch = 1.0 + f64::from(i % 7 - 3) * f64::EPSILON;
        let turn = DQuat::from_xyzw(0.0, 0.0, half_angle.sin(), half_angle.cos()) * stretch;
        let reach = 0.5 * ((2.0 * half_angle).sin() + (2.0 * half_angle).cos()) + 0.5;
        let far = f64::from(i % 5) * 0.3;
        let mut offset = reach - 16.0 * f64::EPSILON;
        for _ in 0..80 {
            offset = offset.next_up();
            let a = Pose { rotation: turn, translation: DVec3::new(far, far, 0.0) };
            let b = at(far + offset);
            let b = Pose { translation: b.translation + far * DVec3::Y, ..b };
            let alone = fresh(a, b, Demand::Intersects).surface.meets();
            let mut world = World::new();
            world.set_scene_effects(&[Effect::TRIGGER]).unwrap();
            for (name, pose) in [("a", a), ("b", b)] {
                world.insert(BodySpec { pose, ..cube(name, 0.0) }).unwrap();
            }
            assert_eq!(step(&mut world).events.len(), usize::from(alone), "{offset}, case {i}");
            met += usize::from(alone);
            parted += usize::from(!alone);
        }
    }
    assert!(met > 0 && parted > 0, "both sides were seen: {met}, {parted}");
}

/// Poses on a coarse grid: bodies touch, overlap and part often.
fn scenes() -> impl Strategy<Value = Vec<Vec<(i32, i32)>>> {
    prop::collection::vec(prop::collection::vec((-6..6i32, -6..6i32), 6), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The order of calls between steps is irrelevant, every pair is found, and events are the
    /// difference of what touches.
    #[test]
    fn reports_are_a_function_of_poses(frames in scenes()) {
        let effects = [Effect::Contacts { margin: 0.25 }];
        let (mut forward, ids) = row(&effects, &[0.0; 6]);
        let (mut backward, _) = row(&effects, &[0.0; 6]);
        let mut touching = std::collections::BTreeSet::new();
        for frame in frames {
            let pose = |i: usize| {
                let (x, y) = frame[i];
                Pose::at(0.5 * DVec3::new(f64::from(x), f64::from(y), 0.0))
            };
            for &id in &ids {
                forward.set_pose(id, pose(id.0 as usize)).unwrap();
            }
            for &id in ids.iter().rev() {
                backward.set_pose(id, at(100.0)).unwrap();
                backward.set_pose(id, pose(id.0 as usize)).unwrap();
            }
            let report = step(&mut forward);
            let mut other = step(&mut backward);
            other.stats.counters = report.stats.counters;
            other.stats.broad_phase = report.stats.broad_phase;
            for (x, y) in other.answers.iter_mut().zip(&report.answers) {
                x.answer.counters = y.answer.counters;
            }
            prop_assert_eq!(&report, &other);

            let mut now = std::collections::BTreeSet::new();
            for (i, &a) in ids.iter().enumerate() {
                for &b in &ids[i + 1..] {
                    let alone = fresh(pose(a.0 as usize), pose(b.0 as usize), Demand::Intersects);
                    if alone.solid || alone.surface.meets() {
                        now.insert((a, b));
                    }
                }
            }
            let expected: Vec<PairEvent> = touching
                .symmetric_difference(&now)
                .map(|&(a, b)| if now.contains(&(a, b)) { began(a, b) } else { ended(a, b) })
                .collect();
            prop_assert_eq!(report.events, expected);
            touching = now;
        }
    }
}

#[test]
fn what_a_body_is_may_change_between_steps() {
    let (mut world, ids) = row(&[Effect::TRIGGER], &[0.0, 1.5]);
    assert!(step(&mut world).events.is_empty());

    let wide = Cuboid { size: [2.5, 1.0, 1.0] }.build().unwrap();
    let (wide, _) = Model::build(wide, &BuildOptions::default()).unwrap();
    let narrow = world.body(ids[1]).unwrap().shape().clone();
    world.set_shape(ids[1], wide).unwrap();
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1])]);
    world.set_shape(ids[1], narrow).unwrap();
    assert_eq!(step(&mut world).events, [ended(ids[0], ids[1])]);

    world.set_pose(ids[1], at(0.5)).unwrap();
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1])]);
    let none = Layers { memberships: 0, filters: 0 };
    world.set_layers(ids[0], none).unwrap();
    assert_eq!(step(&mut world).events, [ended(ids[0], ids[1])]);
    world.set_layers(ids[0], Layers::default()).unwrap();
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1])]);
    ids.iter().for_each(|&id| world.set_kind(id, BodyKind::Fixed).unwrap());
    assert_eq!(step(&mut world).events, [ended(ids[0], ids[1])], "two fixed bodies never meet");
    world.set_kind(ids[0], BodyKind::Kinematic).unwrap();
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1])]);

    world.exclude_pair(ids[0], ids[1]).unwrap();
    assert_eq!(step(&mut world).events, [ended(ids[0], ids[1])]);
    world.include_pair(ids[1], ids[0]).unwrap();
    assert_eq!(step(&mut world).events, [began(ids[0], ids[1])]);
    world.validate().unwrap();
}

#[test]
fn ids_of_the_callers_own_must_ascend() {
    let mut world = World::new();
    world.insert_as(BodyId(3), cube("a", 0.0)).unwrap();
    let refused = world.insert_as(BodyId(3), cube("b", 0.0));
    assert_eq!(refused, Err(WorldError::IdUsed { name: "b".into(), body: BodyId(3) }));
    assert_eq!(world.insert(cube("b", 0.0)), Ok(BodyId(4)));
    world.validate().unwrap();
}
