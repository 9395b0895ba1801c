//! What a simulation reports of its pairs.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_narrow_phase::{Demand, Fields, PairMemory, Placed, Query, query};
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, JointSpec, Simulation, SimulationOptions};
use cranny_shapes::{Cup, LPrism, Torus};

use crate::world::{Apart, cuboid, model, spec};

/// A floor and five bodies that fall on it and on each other.
fn heap(options: SimulationOptions) -> (Simulation, Vec<cranny_geometry::Model>) {
    let models = vec![
        model(Torus { major_radius: 0.5, minor_radius: 0.15, ..Torus::default() }),
        model(LPrism::default()),
        cuboid(8.0, 8.0, 1.0),
        model(Cup { segments: 24, ..Cup::default() }),
        cuboid(0.6, 0.5, 0.4),
        model(LPrism::default()),
    ];
    let mut simulation = Simulation::new(options);
    for (k, body) in models.iter().enumerate() {
        let up = k as f64;
        let kind = if k == 2 { BodyKind::Fixed } else { BodyKind::Dynamic };
        let at = DVec3::new(0.05 * up, -0.03 * up, if k == 2 { -0.5 } else { 0.4 + 0.5 * up });
        let turn = if k == 2 { 0.0 } else { 0.7 * up + 0.2 };
        let pose = Pose { rotation: DQuat::from_rotation_y(turn), translation: at };
        let index = simulation.insert(&BodySpec { pose, ..spec(body, kind, at) });
        assert_eq!(index.expect("a body"), BodyIndex(k as u32));
    }
    (simulation, models)
}

#[test]
fn answers_are_those_of_a_direct_query_at_the_told_poses() {
    compare_with_direct_queries(false);
}

#[test]
fn a_reader_is_told_regions_in_the_same_step() {
    compare_with_direct_queries(true);
}

fn compare_with_direct_queries(read: bool) {
    for most_parts in [1, 4] {
        compare_with_direct_queries_in_parts(read, most_parts);
    }
}

fn compare_with_direct_queries_in_parts(read: bool, most_parts: usize) {
    // A reader gets the answer of each step; nobody, what a search left.
    let recycling = Some(read);
    let options = SimulationOptions { most_parts, recycling, ..SimulationOptions::default() };
    let (mut simulation, models) = heap(options);
    let mut divided = 0;
    if read {
        simulation.read_by(|_, _| Fields::regions(0.0));
    }
    let (mut checked, mut overlapping, mut contacts) = (0, 0, 0);
    for step in 0..150 {
        let before: Vec<Pose> =
            (0..models.len()).map(|k| simulation.pose(BodyIndex(k as u32))).collect();
        // Bodies that sleep when a step begins are not looked at, though they may wake in it.
        let asleep: Vec<bool> = (0..models.len())
            .map(|k| simulation.velocity(BodyIndex(k as u32)) == (DVec3::ZERO, DVec3::ZERO))
            .collect();
        simulation.step();
        let is_whole = simulation.parts() == 1;
        divided += usize::from(!is_whole);
        let pairs = simulation.contact_pairs();
        let order: Vec<_> = pairs.iter().map(|p| (p.a, p.b)).collect();
        assert!(order.windows(2).all(|w| w[0] < w[1]), "step {step}: {order:?}");
        for pair in &pairs {
            assert!(pair.a < pair.b);
            let both_asleep = [pair.a, pair.b].iter().all(|b| asleep[b.0 as usize]);
            assert!(pair.fresh || both_asleep, "step {step}: recycled though nobody wants it");
            for (body, pose) in [(pair.a, pair.poses[0]), (pair.b, pair.poses[1])] {
                // Of a step in parts nobody but the simulation knows where its last part began.
                if !is_whole {
                    continue;
                }
                let was = before[body.0 as usize];
                assert!((pose.translation - was.translation).length() < 1e-5, "step {step}");
                assert!(pose.rotation.dot(was.rotation).abs() > 1.0 - 1e-9, "step {step}");
            }
            if step % 5 != 0 {
                continue;
            }
            let placed = |k: usize, index: BodyIndex| Placed {
                model: &models[index.0 as usize],
                pose: pair.poses[k],
            };
            let (a, b) = (placed(0, pair.a), placed(1, pair.b));
            let ask = |demand| {
                query(a, b, &Query::of(demand), &mut PairMemory::default()).expect("valid poses")
            };
            let direct = ask(Demand::Regions { margin: 0.0 });
            let found = &pair.answer;
            assert_eq!(found.surface, direct.surface, "step {step}");
            assert_eq!((found.solid, found.contained), (direct.solid, direct.contained));
            if read {
                // Everything that a reader reads.
                let meeting: Vec<_> = found.regions.iter().filter(|r| r.depth.is_some()).collect();
                let expected: Vec<_> =
                    direct.regions.iter().filter(|r| r.depth.is_some()).collect();
                assert_eq!(meeting.len(), expected.len(), "step {step}");
                for (r, s) in meeting.iter().zip(&expected) {
                    let (r, s) = (r.depth.unwrap_or(0.0), s.depth.unwrap_or(0.0));
                    assert!((r - s).abs() < 1e-9, "step {step}: depth {r} is not {s}");
                    overlapping += 1;
                }
            }
            // No solver's contact is nearer than the distance, and of surfaces that are apart the
            // nearest is among them.
            let distance = direct.distance.expect("demanded");
            let least = found.contacts.iter().map(|c| c.separation).fold(f64::INFINITY, f64::min);
            if distance > 0.0 && !found.contacts.is_empty() {
                assert!((least - distance).abs() < 1e-9, "step {step}: {least}, not {distance}");
            }
            // No way out is longer than the one that parts a whole region.
            let parting = direct.regions.iter().filter_map(|r| r.depth).fold(0.0, f64::max);
            if found.solid {
                assert!(least <= 0.0 && -least <= parting + 1e-9, "{step}: {least}, {parting}");
                overlapping += 1;
            }
            for c in &found.contacts {
                assert!((c.normal.dot(c.point_b - c.point_a) - c.separation).abs() < 1e-9);
                contacts += 1;
            }
            checked += 1;
        }
    }
    assert!(checked > 50 && contacts > 100, "{checked} pairs, {contacts} contacts");
    assert!(overlapping > 0, "nothing ever overlapped");
    assert_eq!(divided > 0, most_parts > 1, "{divided} steps were made in parts");
    assert!(simulation.solver_contacts() > 0 && simulation.pair_count() > 0);
    assert!(simulation.narrow_phase_seconds() > 0.0);
    assert_eq!(simulation.narrow_phase_seconds(), 0.0, "read once");
    assert!(simulation.timings_ms().step > 0.0);
}

#[test]
fn bodies_move_the_same_whoever_reads() {
    // What is carried on is searched for whoever reads it, and only for that.
    moves_the_same(true);
    moves_the_same(false);
}

fn moves_the_same(recycling: bool) {
    let poses = |fields: Fields, costs: bool| {
        let options =
            SimulationOptions { recycling: Some(recycling), ..SimulationOptions::default() };
        let (mut simulation, models) = heap(options);
        simulation.read_by(move |_, _| fields);
        let mut cost = 0.0;
        for _ in 0..90 {
            simulation.step();
            cost += simulation.timings_ms().reading;
        }
        assert_eq!(cost > 0.0, costs, "{fields:?}");
        (0..models.len()).map(|k| simulation.pose(BodyIndex(k as u32))).collect::<Vec<_>>()
    };
    let unread = poses(Fields::NONE, false);
    // The solver's own answers tell how deep bodies overlap, and whether they meet.
    let found = Fields { depth: Some(0.0), verdict: true, ..Fields::contacts(0.0) };
    assert_eq!(unread, poses(found, recycling));
    assert_eq!(unread, poses(Fields::contacts(0.5), true));
    assert_eq!(unread, poses(Fields::regions(0.05), true));
}

/// Cups that fall onto each other, the lowest fixed, and a ring that falls onto the rim of the
/// highest.
fn cups(options: SimulationOptions) -> (Simulation, Vec<cranny_geometry::Model>) {
    let cup = model(Cup { segments: 24, ..Cup::default() });
    let ring = model(Torus { major_radius: 0.45, minor_radius: 0.1, ..Torus::default() });
    let models = vec![cup.clone(), cup.clone(), cup.clone(), cup, ring];
    let mut simulation = Simulation::new(options);
    for (k, body) in models.iter().enumerate() {
        let up = k as f64;
        let kind = if k == 0 { BodyKind::Fixed } else { BodyKind::Dynamic };
        let at = DVec3::new(0.01 * up, -0.005 * up, 1.01 * up);
        let at = if k == 4 { at + DVec3::Z * 0.15 } else { at };
        simulation.insert(&spec(body, kind, at)).expect("a body");
    }
    (simulation, models)
}

/// No pair overlaps deeper than its bound says, searched or carried on.
#[test]
fn depths_stay_within_their_bounds() {
    bounds_of_depths(1);
    bounds_of_depths(4);
}

fn bounds_of_depths(most_parts: usize) {
    let options = SimulationOptions { most_parts, ..SimulationOptions::default() };
    let (mut simulation, mut models) = cups(options);
    if most_parts > 1 {
        // Far away a plate flies at a wall, which divides the steps in which it arrives.
        let far = DVec3::new(0.0, 50.0, 10.0);
        let [wall, plate] = [cuboid(1.0, 4.0, 4.0), cuboid(0.1, 1.0, 1.0)];
        models.extend([wall.clone(), plate.clone()]);
        let wall = spec(&wall, BodyKind::Fixed, far + 8.0 * DVec3::X);
        let plate = spec(&plate, BodyKind::Dynamic, far);
        simulation.insert(&wall).expect("a body");
        simulation.insert(&BodySpec { linear_velocity: 40.0 * DVec3::X, ..plate }).expect("a body");
    }
    let mut divided = 0;
    let (mut carried, mut gaps, mut deepest, mut loosest) = (0, 0, 0.0f64, 0.0f64);
    for step in 0..360 {
        let before: Vec<Pose> =
            (0..models.len()).map(|k| simulation.pose(BodyIndex(k as u32))).collect();
        simulation.step();
        divided += usize::from(simulation.parts() > 1);
        let unsearched = simulation.contact_pairs().into_iter().filter(|pair| !pair.fresh);
        let unsearched: Vec<_> = unsearched.map(|pair| (pair.a, pair.b)).collect();
        for ((a, b), bound) in simulation.depth_bounds() {
            let [of_a, of_b] = [a, b].map(|index| {
                let at = index.0 as usize;
                Placed { model: &models[at], pose: before[at] }
            });
            let ask = Query::of(Demand::contacts(0.0));
            let found = query(of_a, of_b, &ask, &mut PairMemory::default()).expect("valid poses");
            let depth = found.depth();
            assert!(depth <= bound.max(0.0) + 1e-9, "step {step}, {a:?} {b:?}: {depth} > {bound}");
            assert!(bound >= 0.0 || !found.touches(), "step {step}, {a:?} {b:?}: no gap");
            gaps += u32::from(bound < 0.0);
            if unsearched.contains(&(a, b)) {
                carried += 1;
                (deepest, loosest) = (deepest.max(depth), loosest.max(bound - depth));
            }
        }
    }
    assert!(carried > 300 && deepest > 1e-4, "{carried} carried on, at most {deepest} deep");
    assert!(loosest < 0.01 && gaps > 5, "{loosest}, {gaps} with a gap");
    assert_eq!(divided > 0, most_parts > 1);
}

/// Who reads depths beyond a length alone has no pair searched that cannot be so deep.
#[test]
fn a_pair_is_searched_for_its_depth_where_it_may_be_deeper() {
    let unsearched = |fields: Fields| {
        let (mut simulation, _) = cups(SimulationOptions::default());
        simulation.read_by(move |_, _| fields);
        let mut count = 0;
        for _ in 0..240 {
            simulation.step();
            count += simulation.contact_pairs().iter().filter(|pair| !pair.fresh).count();
        }
        count
    };
    let deeper_than = |depth| Fields { depth: Some(depth), ..Fields::NONE };
    let [unread, deep, any] = [Fields::NONE, deeper_than(0.1), deeper_than(0.0)].map(unsearched);
    assert_eq!(deep, unread);
    assert!(any < unread, "{any} of {unread}");
}

#[test]
fn recycled_answers_say_so() {
    let options = SimulationOptions::default();
    let (mut simulation, models) = heap(options);
    let (mut fresh, mut recycled) = (0, 0);
    for _ in 0..240 {
        simulation.step();
        for pair in simulation.contact_pairs() {
            if pair.fresh {
                fresh += 1;
                continue;
            }
            // Told relative to the pose of the first; the relative pose is the one it came from.
            recycled += 1;
            if recycled % 50 == 1 {
                let [a, b] = [(pair.a, 0), (pair.b, 1)].map(|(index, k): (BodyIndex, usize)| {
                    Placed { model: &models[index.0 as usize], pose: pair.poses[k] }
                });
                let ask = Query::of(Demand::Intersects);
                let direct = query(a, b, &ask, &mut PairMemory::default()).expect("valid poses");
                assert_eq!(direct.surface, pair.answer.surface);
            }
        }
    }
    assert!(fresh > 0 && recycled > 0, "{fresh} fresh, {recycled} recycled");
}

/// What was found within a short reach says nothing of what a body about to move far may meet.
#[test]
fn contacts_are_kept_at_rest_and_not_of_what_is_about_to_move() {
    let options = SimulationOptions::default();
    let (slab, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    let mut simulation = Simulation::new(options);
    simulation.insert(&spec(&slab, BodyKind::Fixed, DVec3::ZERO)).expect("a body");
    let at = DVec3::new(0.0, 0.0, 1.001);
    let body = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
    let mut kept = 0;
    for _ in 0..20 {
        simulation.step();
        kept += simulation.contact_pairs().iter().filter(|pair| !pair.fresh).count();
    }
    assert!(kept > 3, "{kept}");
    simulation.set_velocity(body, DVec3::new(3.0, 0.0, 0.0), DVec3::ZERO);
    simulation.step();
    let pairs = simulation.contact_pairs();
    assert!(pairs.len() == 1 && pairs[0].fresh, "{} pairs", pairs.len());
}

#[test]
fn bodies_that_do_not_respond_pass_and_are_reported_no_more() {
    let (slab, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    for late in [false, true] {
        let mut simulation = Simulation::new(SimulationOptions::default());
        let floor = simulation.insert(&spec(&slab, BodyKind::Fixed, DVec3::ZERO)).expect("a body");
        let at = DVec3::new(0.0, 0.0, 1.01);
        let body = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
        if late {
            for _ in 0..30 {
                simulation.step();
            }
            assert!((simulation.pose(body).translation.z - 1.0).abs() < 1e-2);
            assert_eq!(simulation.contact_pairs().len(), 1);
        }
        simulation.set_hooked(body, true, false);
        simulation.reconsider(body, floor);
        for _ in 0..20 {
            simulation.step_with(&Apart(floor, body));
            assert!(simulation.contact_pairs().is_empty(), "late: {late}");
        }
        let z = simulation.pose(body).translation.z;
        assert!(z < 0.9, "late: {late}: still at {z}");
    }
}

#[test]
fn bodies_meet_where_their_layers_overlap() {
    let (slab, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    for (floor, body, meets) in
        [(1, 1, true), (1, 2, false), (3, 2, true), (u32::MAX, 4, true), (1, 0, false)]
    {
        let mut simulation = Simulation::new(SimulationOptions::default());
        let fixed = spec(&slab, BodyKind::Fixed, DVec3::ZERO);
        simulation.insert(&BodySpec { groups: floor, ..fixed }).expect("a body");
        let falling = spec(&cube, BodyKind::Dynamic, DVec3::new(0.0, 0.0, 1.01));
        let falling = simulation.insert(&BodySpec { groups: body, ..falling }).expect("a body");
        for _ in 0..60 {
            simulation.step();
        }
        let z = simulation.pose(falling).translation.z;
        assert_eq!(z > 0.9, meets, "layers {floor:b} and {body:b}: at {z}");
    }
}

#[test]
fn joined_bodies_may_be_told_not_to_meet() {
    let cube = cuboid(1.0, 1.0, 1.0);
    for contacts in [false, true] {
        let mut simulation = Simulation::new(SimulationOptions::default());
        let a = simulation.insert(&spec(&cube, BodyKind::Fixed, DVec3::ZERO)).expect("a body");
        let at = DVec3::new(0.6, 0.0, 0.0); // they overlap
        let b = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
        simulation.join(a, b, Pose::at(at), Pose::IDENTITY, &JointSpec::Fixed, contacts);
        simulation.step();
        assert_eq!(simulation.contact_pairs().len(), usize::from(contacts));
    }
}
