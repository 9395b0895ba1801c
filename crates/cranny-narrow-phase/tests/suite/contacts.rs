//! Contacts for a solver: one per pair of patches, judged by brute force over all features.

use std::f64::consts::PI;

use cranny_exact::{DMat3, DQuat, DVec3, Meeting, Pose};
use cranny_geometry::triangle_distance::{Part, closest_on_segments, closest_on_triangle};
use cranny_geometry::{EdgeId, FaceId, Mesh, Model, PatchId, VertexId};
use cranny_narrow_phase::{
    Answer, Contact, Demand, Feature, PairMemory, Placed, Query, brute_force::brute_force, query,
};
use cranny_shapes::{CPrism, Cuboid, Cup, GolfBall, IsoBolt, IsoNut, Torus, UPrism};
use cranny_testkit::{Rng, from_surface, world_triangles};

use crate::solids::{ask, at, model, octahedron, shape};

fn contacts_with(a: Placed, b: Placed, margin: f64, memory: &mut PairMemory) -> Answer {
    query(a, b, &Query::of(Demand::contacts(margin)), memory).unwrap()
}

fn contacts(a: Placed, b: Placed, margin: f64) -> Answer {
    contacts_with(a, b, margin, &mut PairMemory::default())
}

fn turn(rng: &mut Rng) -> DQuat {
    DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit() + 1.5).normalize()
}

fn bodies() -> Vec<Model> {
    vec![
        shape(Cuboid::default()),
        shape(Cup { segments: 12, ..Cup::default() }),
        shape(Torus { major_segments: 16, minor_segments: 8, ..Torus::default() }),
        shape(GolfBall { dimples: 0, triangles: 320, ..GolfBall::default() }),
        model(octahedron()),
    ]
}

/// What holds of every contact, whatever the position.
fn check(a: Placed, b: Placed, margin: f64, answer: &Answer) {
    let (faces_a, faces_b) = (world_triangles(a.model, &a.pose), world_triangles(b.model, &b.pose));
    let tiny = 1e-12 * (a.model.radius() + b.model.radius() + 10.0);
    for c in &answer.contacts {
        assert!(c.separation <= margin + tiny, "{c:?}");
        assert!((c.normal.length() - 1.0).abs() < 1e-12, "{c:?}");
        assert!((c.point_b - c.point_a - c.normal * c.separation).length() < tiny, "{c:?}");
        assert!(from_surface(c.point_a, &faces_a) < tiny, "{c:?}");
        assert!(from_surface(c.point_b, &faces_b) < tiny, "{c:?}");
    }
    assert!(answer.contacts.is_sorted_by(|x, y| x.separation <= y.separation));
}

/// Two points, each nearest to the other in the whole of the other's surface: such contacts cannot
/// be left out.
struct Mutual {
    patches: (PatchId, PatchId),
    separation: f64,
}

/// All of them within a margin, by brute force over vertices, faces and edges.
fn mutual(a: Placed, b: Placed, margin: f64) -> Vec<Mutual> {
    let placed = [a, b];
    let triangles = [world_triangles(a.model, &a.pose), world_triangles(b.model, &b.pose)];
    let maps = placed.map(|p| p.pose.world_from_body());
    let point = |side: usize, v: VertexId| maps[side].apply(placed[side].model.mesh().position(v));
    let nearest = |p: DVec3, side: usize, d: f64| from_surface(p, &triangles[side]) >= d - 1e-12;
    let mut found = Vec::new();
    for side in [0, 1] {
        let (own, its) = (placed[side].model, placed[1 - side].model);
        for v in (0..own.mesh().vertices().len() as u32).map(VertexId) {
            let p = point(side, v);
            for (f, t) in (0..).map(FaceId).zip(&triangles[1 - side]) {
                let (foot, part) = closest_on_triangle(p, t);
                let d = (foot - p).length();
                let above = (t[1] - t[0]).cross(t[2] - t[0]).dot(p - foot) > 0.0;
                if part == Part::Inside
                    && d <= margin
                    && above
                    && nearest(p, 1 - side, d)
                    && nearest(foot, side, d)
                {
                    let own = own.patches().patch_of_vertex(own.topology(), v).unwrap();
                    let its = its.patches().patch_of_face(f);
                    let patches = if side == 0 { (own, its) } else { (its, own) };
                    found.push(Mutual { patches, separation: d });
                }
            }
        }
    }
    let segments = |side: usize| -> Vec<(EdgeId, [DVec3; 2])> {
        let edges = placed[side].model.topology().edges();
        (0..)
            .map(EdgeId)
            .zip(edges.iter().map(|e| [point(side, e.from), point(side, e.to)]))
            .collect()
    };
    let others = segments(1);
    for (e, p) in segments(0) {
        for (g, q) in &others {
            let (s, t) = closest_on_segments(&p, q);
            let (x, y) = (p[0] + (p[1] - p[0]) * s, q[0] + (q[1] - q[0]) * t);
            let (d, inside) = ((y - x).length(), |t: f64| t > 1e-9 && t < 1.0 - 1e-9);
            let (u, v) = ((p[1] - p[0]).normalize(), (q[1] - q[0]).normalize());
            let crossed = u.cross(v).length() > 0.01;
            if crossed
                && inside(s)
                && inside(t)
                && d <= margin
                && nearest(x, 1, d)
                && nearest(y, 0, d)
            {
                let patch = |m: &Model, e| m.patches().patch_of_edge(m.topology(), e);
                let patches = (patch(a.model, e), patch(b.model, *g));
                found.push(Mutual { patches, separation: d });
            }
        }
    }
    found
}

#[test]
fn every_mutually_nearest_pair_has_its_contact() {
    let (bodies, mut rng) = (bodies(), Rng::new(77));
    let mut seen = 0;
    for _ in 0..150 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let a =
            Placed { model: a, pose: Pose { rotation: turn(&mut rng), translation: DVec3::ZERO } };
        let far = turn(&mut rng) * DVec3::new(0.0, 0.0, 1.0 + rng.unit().abs());
        let b = Placed { model: b, pose: Pose { rotation: turn(&mut rng), translation: far } };
        let truth = brute_force(a, b).unwrap();
        if truth.surface != Meeting::None || truth.distance > 1.0 {
            continue;
        }
        let margin = truth.distance + 0.1;
        let answer = contacts(a, b, margin);
        assert_eq!((answer.surface, answer.triangle_pairs), (truth.surface, truth.triangle_pairs));
        check(a, b, margin, &answer);
        assert!((answer.contacts[0].separation - truth.distance).abs() < 1e-9, "{truth:?}");
        assert!(answer.separation.hi >= truth.distance && answer.separation.lo <= truth.distance);
        for expected in mutual(a, b, margin) {
            seen += 1;
            let of_patches = |c: &&Contact| c.patches(a.model, b.model) == expected.patches;
            let nearest = answer.contacts.iter().find(of_patches);
            let nearest = nearest.unwrap_or_else(|| panic!("none of {:?}", expected.patches));
            assert!(nearest.separation <= expected.separation + 1e-9, "{nearest:?}");
        }
    }
    assert!(seen > 30, "{seen}");
}

#[test]
fn warm_is_cold_and_exchanging_the_bodies_exchanges_the_answer() {
    let (bodies, mut rng) = (bodies(), Rng::new(5));
    let (mut met, mut apart) = (0, 0);
    for _ in 0..12 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let (mut memory, mut other) = (PairMemory::default(), PairMemory::default());
        let mut pose = Pose {
            rotation: turn(&mut rng),
            translation: turn(&mut rng) * DVec3::new(0.0, 0.0, 1.2),
        };
        for step in 0..25 {
            let small = if step % 10 == 9 { 0.5 } else { 0.02 };
            let spin =
                DQuat::from_xyzw(small * rng.unit(), small * rng.unit(), small * rng.unit(), 1.0);
            pose.rotation = (spin.normalize() * pose.rotation).normalize();
            pose.translation += small * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let a = Placed { model: a, pose: Pose::IDENTITY };
            let b = Placed { model: b, pose };
            let truth = brute_force(a, b).unwrap();
            let cold = contacts(a, b, 0.1);
            let mut warm = contacts_with(a, b, 0.1, &mut memory);
            let mut swapped = contacts_with(b, a, 0.1, &mut other).swapped();
            (warm.counters, swapped.counters) = (cold.counters, cold.counters);
            assert_eq!(warm, cold);
            assert_eq!(swapped, cold);
            assert_eq!((cold.surface, cold.triangle_pairs), (truth.surface, truth.triangle_pairs));
            check(a, b, 0.1, &cold);
            if cold.solid && cold.contained.is_none() {
                met += 1;
                assert!(cold.contacts[0].separation <= 0.0, "{:?}", cold.contacts);
            } else {
                apart += 1;
            }
        }
    }
    assert!(met > 30 && apart > 30, "{met} {apart}");
}

#[test]
fn memory_of_other_models_means_nothing() {
    let bodies = bodies();
    let mut memory = PairMemory::default();
    for (i, j) in [(1, 2), (0, 4), (2, 2), (4, 1)] {
        let (a, b) = (at(&bodies[i], 0.0, 0.0, 0.0), at(&bodies[j], 0.7, 0.1, 0.9));
        let (mut warm, cold) = (contacts_with(a, b, 0.3, &mut memory), contacts(a, b, 0.3));
        warm.counters = cold.counters;
        assert_eq!(warm, cold);
    }
}

/// A square floor at z = 0, `n` by `n` cells, one thick.
fn floor(n: u32) -> Model {
    let side = n + 1;
    let level = |z: f64| {
        (0..side * side).map(move |i| {
            DVec3::new(f64::from(i % side), f64::from(i / side), z)
                - DVec3::new(0.5, 0.5, 0.0) * f64::from(n)
        })
    };
    let vertices: Vec<DVec3> = level(0.0).chain(level(-1.0)).collect();
    let below = side * side;
    let mut faces = Vec::new();
    for i in (0..n).flat_map(|y| (0..n).map(move |x| y * side + x)) {
        let quad = [i, i + 1, i + side + 1, i + side];
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            faces.push([quad[a], quad[b], quad[c]]);
            faces.push([below + quad[a], below + quad[c], below + quad[b]]);
        }
    }
    for k in 0..n {
        for (p, q) in [
            (k, k + 1),
            (n + k * side, n + (k + 1) * side),
            (n * side + k + 1, n * side + k),
            ((k + 1) * side, k * side),
        ] {
            faces.extend([[q, p, below + p], [q, below + p, below + q]]);
        }
    }
    let floor = model(Mesh::new(vertices, faces).unwrap());
    assert!(floor.is_closed());
    floor
}

#[test]
fn a_floor_of_many_triangles_stops_nothing_sideways() {
    let (floor, unit) = (floor(16), shape(Cuboid { size: [2.5, 2.5, 1.0] }));
    let mut memory = PairMemory::default();
    for step in 0..60 {
        let (x, y) = (-3.0 + 0.1 * f64::from(step), 0.037 * f64::from(step));
        for lift in [0.01, 1e-9, 0.0, -0.001, -0.02] {
            let answer = contacts_with(
                at(&floor, 0.0, 0.0, 0.0),
                at(&unit, x, y, 0.5 + lift),
                0.05,
                &mut memory,
            );
            assert!(answer.contacts.len() >= 4, "{lift}: {:?}", answer.contacts);
            for c in &answer.contacts {
                assert!((c.normal - DVec3::Z).length() < 1e-9, "{lift}: {c:?}");
                assert!((c.separation - lift).abs() < 1e-12, "{lift}: {c:?}");
            }
            for (dx, dy) in [(-1.25, -1.25), (1.25, -1.25), (-1.25, 1.25), (1.25, 1.25)] {
                let corner = DVec3::new(x + dx, y + dy, lift);
                // It stands on as much as lies beneath it, to a cell of the floor.
                let near = |c: &Contact| (c.point_b - corner).length() < 1.1;
                assert!(answer.contacts.iter().any(near), "{lift}: nothing near {corner}");
            }
        }
    }
}

#[test]
fn what_dips_into_a_plate_is_sent_back_whence_it_came() {
    let plate = shape(Cuboid { size: [4.0, 4.0, 0.1] });
    let spike = model(octahedron());
    for depth in [-0.02, 1e-6, 0.01, 0.04] {
        let answer = contacts(at(&plate, 0.0, 0.0, 0.0), at(&spike, 0.3, 0.2, 1.05 - depth), 0.05);
        let [c] = &answer.contacts[..] else { panic!("{depth}: {:?}", answer.contacts) };
        assert_eq!(c.normal, DVec3::Z);
        assert!((c.separation + depth).abs() < 1e-12, "{c:?}");
        assert_eq!(answer.solid, depth > 0.0);
    }
    // Past the middle the far side is nearer, but no face at the tip looks back: the region
    // decides.
    let answer = contacts(at(&plate, 0.0, 0.0, 0.0), at(&spike, 0.3, 0.2, 1.05 - 0.07), 0.05);
    assert!((answer.contacts[0].normal - DVec3::Z).length() < 1e-9);
    assert!((answer.contacts[0].separation + 0.07).abs() < 1e-9);
}

/// Regions of open surfaces have no depth; a tip of one in a solid has.
#[test]
fn an_open_tip_in_a_small_solid_has_its_depth() {
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let rim = corners.map(|(x, y)| DVec3::new(x, y, 1.0));
    let vertices = [DVec3::ZERO].into_iter().chain(rim).collect();
    let sides = vec![[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4]];
    let tip = model(Mesh::new(vertices, sides).unwrap());
    assert!(!tip.is_closed());
    let cube = shape(Cuboid::default());
    let answer = contacts(at(&cube, 0.0, 0.0, 0.0), at(&tip, 0.1, 0.2, 0.4), 0.05);
    let deepest = answer.contacts[0];
    assert!((deepest.separation + 0.1).abs() < 1e-12, "{:?}", answer.contacts);
    assert_eq!(deepest.normal, DVec3::Z);
}

/// Of small bodies the contacts of an overlap are those of its regions; beyond it, gaps.
#[test]
fn small_bodies_overlap_as_their_regions_say() {
    let (cube, slab) = (shape(Cuboid::default()), shape(Cuboid { size: [4.0, 4.0, 0.5] }));
    let turn = DQuat::from_scaled_axis(DVec3::new(0.2, -0.1, 0.4));
    for (rotation, z) in [(turn, 0.74), (DQuat::IDENTITY, 0.7), (turn, 0.6)] {
        let a = at(&slab, 0.0, 0.0, 0.0);
        let pose = Pose { rotation, translation: DVec3::new(0.3, 0.2, z) };
        let b = Placed { model: &cube, pose };
        let found = contacts(a, b, 0.0).contacts;
        let regions = ask(a, b, Demand::Regions { margin: 0.0 }).contacts;
        let overlaps = |all: &[Contact]| -> Vec<Contact> {
            all.iter().copied().filter(|contact| contact.separation < 0.0).collect()
        };
        assert_eq!(overlaps(&found), overlaps(&regions), "at {z}");
        assert!(!overlaps(&found).is_empty(), "at {z}");
    }
}

/// A piece of `mixed_pile` in the form of a letter: a U of 448 faces, an L of 500.
fn letter(name: &str) -> Model {
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/meshes");
    let text = std::fs::read_to_string(format!("{meshes}/{name}.obj")).unwrap();
    let of = |kind: &'static str| {
        text.lines().filter_map(move |line| line.strip_prefix(kind)).map(str::split_whitespace)
    };
    let number = |word: &str| word.parse::<f64>().unwrap();
    let vertices = of("v ").map(|words| DVec3::from_slice(&words.map(number).collect::<Vec<_>>()));
    let corner = |word: &str| word.parse::<u32>().unwrap() - 1;
    let faces = of("f ").map(|words| words.map(corner).collect::<Vec<_>>().try_into().unwrap());
    model(Mesh::new(vertices.collect(), faces.collect()).unwrap())
}

/// An arm of a U stands across an edge of a C, and no vertex inside says how deep. In a pile the
/// two went through each other.
#[test]
fn an_arm_that_digs_into_another_is_as_deep_as_it_has_dug() {
    let u = letter("u");
    let c = shape(CPrism { segments: 64, ..CPrism::default() });
    let rotation = DQuat::from_xyzw(-0.295401, -0.640055, 0.487699, 0.514993).normalize();
    let translation = DVec3::new(0.346218, -0.64487, -0.212073);
    let a = Placed { model: &u, pose: Pose::IDENTITY };
    let b = Placed { model: &c, pose: Pose { rotation, translation } };
    let found = contacts(a, b, 0.0);
    check(a, b, 0.0, &found);
    let regions = ask(a, b, Demand::Regions { margin: 0.0 });
    assert!(found.depth() > 0.1, "{:?}", found.contacts);
    assert_eq!(found.depth(), regions.depth());
    assert_eq!(found.swapped().contacts, contacts(b, a, 0.0).contacts);
}

/// A leg of a U stands on the rim of a cup and has dug in. Some of its sides graze the cup's: these
/// are not all that holds it. In a pile, without a contact here, the two jammed for good.
#[test]
fn a_leg_that_has_dug_into_a_rim_has_a_contact_that_says_so() {
    let (cup, u) = (shape(Cup { segments: 64, ..Cup::default() }), letter("u"));
    let a = Placed { model: &cup, pose: Pose::IDENTITY };
    for (turn, translation) in [
        (
            [0.08153297580770874, -0.9129322039728762, 0.045378968056403554, 0.3973007853796699],
            DVec3::new(0.5537906598879809, -0.1815841167436807, 0.9238089432800085),
        ),
        (
            [0.06573160405230916, -0.9241106515491981, 0.04693285459863905, 0.37349185678037217],
            DVec3::new(0.5323347100107056, -0.2007791462548808, 0.9099905784475705),
        ),
    ] {
        let rotation = DQuat::from_array(turn).normalize();
        let b = Placed { model: &u, pose: Pose { rotation, translation } };
        let found = contacts(a, b, 0.0);
        check(a, b, 0.0, &found);
        assert!(ask(a, b, Demand::Regions { margin: 0.0 }).depth() > 0.07);
        assert!(found.depth() > 0.07, "{:?}", found.contacts);
        assert_eq!(found.swapped().contacts, contacts(b, a, 0.0).contacts);
    }
}

/// An L lies flush on another, and its end digs into that one's side by a hair: one region, as deep
/// along the flush sides as the other side is high. What parts it is far less, wherever it slides
/// to; a contact as deep as the side is high would throw the two apart.
#[test]
fn places_that_have_grown_together_are_as_deep_as_it_takes_to_part_them() {
    let l = letter("l");
    let turn = [-0.5467912379747685, 0.44719535946374706, -0.5471333633137405, 0.44908878331250346];
    let rotation = DQuat::from_array(turn).normalize();
    let middle = DVec3::new(0.19256339762440186, 0.564017530954042, -0.25814201325344766);
    let a = Placed { model: &l, pose: Pose::IDENTITY };
    let at = |translation| Placed { model: &l, pose: Pose { rotation, translation } };
    let mut tried = 0;
    for step in -100..=100 {
        let translation = middle + 2e-5 * f64::from(step) * DVec3::new(0.48, 0.88, 0.0);
        let answer = ask(a, at(translation), Demand::Regions { margin: 0.0 });
        let found = contacts(a, at(translation), 0.0);
        for region in answer.regions.iter().filter(|region| region.depth > Some(0.002)) {
            let depth = region.depth.unwrap();
            assert!(depth < 0.012, "step {step}: {depth}");
            let moved = |by: f64| {
                let to = at(translation + by * region.normal);
                ask(a, to, Demand::Intersects).surface
            };
            assert_eq!(moved(2.0 * depth), Meeting::None, "step {step}: {depth}");
            assert_eq!(moved(0.3 * depth), Meeting::Cross, "step {step}: {depth}");
            tried += 1;
        }
        assert!((5e-4..0.012).contains(&found.depth()), "step {step}: {:?}", found.contacts[0]);
    }
    assert!(tried > 150, "{tried}");
}

/// The same in a corner: an L lies flush in the corner of another, and an edge of it stands in that
/// one's side. No vertex has its way out off the side, so neither the flush faces nor the side
/// alone lead out.
#[test]
fn what_lies_flush_in_a_corner_is_as_deep_as_it_takes_to_lead_it_out() {
    let l = letter("l");
    let turn =
        [-0.0008940324836140268, -0.5264021293278756, 9.29107263975687e-05, 0.8502352558631019];
    let rotation = DQuat::from_array(turn).normalize();
    let middle = DVec3::new(0.3266766185200275, 0.300023247895139, 0.09234431017343794);
    let a = Placed { model: &l, pose: Pose::IDENTITY };
    let at = |translation| Placed { model: &l, pose: Pose { rotation, translation } };
    for step in -50..=50 {
        let translation = middle + 2e-6 * f64::from(step) * DVec3::X;
        let answer = ask(a, at(translation), Demand::Regions { margin: 0.0 });
        let found = contacts(a, at(translation), 0.0);
        check(a, at(translation), 0.0, &found);
        assert!((5e-4..1e-3).contains(&answer.depth()), "step {step}: {}", answer.depth());
        assert!((5e-4..1e-3).contains(&found.depth()), "step {step}: {:?}", found.contacts[0]);
        let out = at(translation + 1.5e-3 * DVec3::new(1.0, 1.0, 0.0).normalize());
        assert_eq!(ask(a, out, Demand::Intersects).surface, Meeting::None, "step {step}");
    }
}

/// A U stands across another, slot in slot: the bottoms and both sides overlap by a hair, and a
/// corner of the piece has its nearest way out past the piece's edge. Along some direction the
/// piece parts by far less than its sides are high. (The bodies do not: others meet then.)
#[test]
fn what_is_squeezed_in_a_slot_is_as_deep_as_it_takes_to_part_it() {
    let u = letter("u");
    let turn = |rows: [[f64; 3]; 3]| {
        DQuat::from_mat3(&DMat3::from_cols_array_2d(&rows).transpose()).normalize()
    };
    let rotation = turn([
        [0.999998389367245, 2.7742959182976623e-6, 0.0017947855635152227],
        [0.0017947856402228757, -2.7898735134535002e-5, -0.9999983889817853],
        [-2.7242192017964267e-6, 0.9999999996069818, -2.790366946636702e-5],
    ]);
    let translation = DVec3::new(-1.9997859001159668, -0.0003878757997881621, 0.4249993860721588);
    let a = Placed { model: &u, pose: Pose { rotation, translation } };
    let rotation = turn([
        [-0.001889707382560335, -3.4311923699514857e-6, 0.9999982144955237],
        [-0.9999924355636025, 0.0033996921834629212, -0.00188968479703161],
        [-0.0033996796294253895, -0.9999942210239441, -9.855589832463707e-6],
    ]);
    let middle = DVec3::new(-1.9988584518200256, 0.003456467395100388, 0.8258374785703536);
    let b = |translation| Placed { model: &u, pose: Pose { rotation, translation } };
    let mut squeezed = 0;
    for step in -50..=50 {
        let at = middle + 1e-6 * f64::from(step) * DVec3::new(0.3, 0.2, 1.0);
        let answer = ask(a, b(at), Demand::Regions { margin: 0.0 });
        let found = contacts(a, b(at), 0.0);
        check(a, b(at), 0.0, &found);
        assert!(answer.depth() > 1e-6 && answer.depth() < 0.006, "{step}: {}", answer.depth());
        assert!(found.depth() < 1e-4, "{step}: {:?}", found.contacts[0]);
        squeezed += usize::from(answer.regions.len() == 1);
    }
    assert!(squeezed > 40, "{squeezed}");
}

/// The same where the sides are squeezed from both ends: no direction parts the pieces by less than
/// their sides are high, and what lies between is a slot.
#[test]
fn what_is_squeezed_from_both_ends_is_as_deep_as_its_vertices_are() {
    let turn =
        [0.7070673562493874, -0.00040030432063056255, -0.000404775862156183, 0.7071459747742712];
    let middle = DVec3::new(-2.0000569820404053, -0.0008357163169421256, 0.4248265326023102);
    let first = Pose { rotation: DQuat::from_array(turn), translation: middle };
    let turn = [-0.42737814358027437, 0.5633362171611881, -0.42801403072126704, 0.5628536384621987];
    let middle = DVec3::new(-2.000240564404761, -0.1642607768719026, 0.7360167137788975);
    // The same solid, cut into other triangles.
    for u in [shape(UPrism::default()), letter("u")] {
        let a = Placed { model: &u, pose: first };
        for step in -50..=50 {
            let translation = middle + 1e-9 * f64::from(step) * DVec3::new(1.0, 0.3, 0.2);
            let pose = Pose { rotation: DQuat::from_array(turn), translation };
            let b = Placed { model: &u, pose };
            let answer = ask(a, b, Demand::Regions { margin: 0.0 });
            let found = contacts(a, b, 0.0);
            check(a, b, 0.0, &found);
            assert!((5e-4..3e-3).contains(&answer.depth()), "{step}: {}", answer.depth());
            assert!((5e-4..1e-3).contains(&found.depth()), "{step}: {:?}", found.contacts[0]);
        }
    }
}

/// A cuboid that fits its slot, or is too wide by a hair on each side, has sunk into the floor. The
/// region is neither as deep as the sides are high, nor as the hair is.
#[test]
fn what_has_sunk_into_the_floor_of_a_tight_slot_is_as_deep_as_it_has_sunk() {
    let slot = shape(UPrism::default());
    for (hair, floors) in [(0.0, [0.002, 0.01, 0.1]), (0.001, [0.002, 0.01, 0.1])] {
        for (length, height) in [(0.3, 0.4), (0.5, 0.4)] {
            let cuboid = shape(Cuboid { size: [0.5 + 2.0 * hair, height, length] });
            for floor in floors {
                let b = at(&cuboid, 0.0, -0.175 + 0.5 * height - floor, 0.0);
                let depth =
                    ask(at(&slot, 0.0, 0.0, 0.0), b, Demand::Regions { margin: 0.0 }).depth();
                let is_right = (0.99 * floor..1.5 * floor).contains(&depth);
                assert!(is_right, "{hair} {length} {floor}: {depth}");
            }
        }
    }
}

/// A nut stands half a turn out of phase: thread in thread, squeezed by both flanks. It is as deep
/// as the threads are in each other, and not as the bolt is wide.
#[test]
fn threads_out_of_phase_are_no_deeper_than_they_are_high() {
    let bolt = shape(IsoBolt { diameter: 16.0, pitch: 2.0, segments: 36, ..IsoBolt::default() });
    let nut = IsoNut { diameter: 16.0, pitch: 2.0, clearance: 0.1, ..IsoNut::default() };
    let nut = shape(IsoNut { segments: 36, ..nut });
    for (off, depths) in [(0.3, 0.2..0.3), (0.5, 0.4..0.5), (0.7, 0.5..0.7), (1.0, 0.5..0.9)] {
        let nut = at(&nut, 0.0, 0.0, 20.0 + off);
        let depth = ask(at(&bolt, 0.0, 0.0, 0.0), nut, Demand::Regions { margin: 0.0 }).depth();
        assert!(depths.contains(&depth), "{off}: {depth}");
    }
}

/// Flanks of a coarse thread overlap by less than 0.1, over several turns in one region. Along the
/// axis, that begins in one turn and ends in another.
#[test]
fn flanks_that_overlap_are_no_deeper_than_their_turn() {
    let bolt = shape(IsoBolt { diameter: 16.0, pitch: 2.0, segments: 36, ..IsoBolt::default() });
    let nut = IsoNut { diameter: 16.0, pitch: 2.0, clearance: 0.1, ..IsoNut::default() };
    let nut = shape(IsoNut { segments: 36, ..nut });
    let (mut memory, mut parted) = (PairMemory::default(), 0);
    for degrees in [0.5, 1.0, 4.0, 6.5, 7.5, 8.5, 9.5f64] {
        for below in [0.063, 0.075, 0.087] {
            let rotation = DQuat::from_rotation_z(degrees.to_radians());
            let translation = DVec3::Z * (34.0 + degrees / 180.0 - below);
            let nut = Placed { model: &nut, pose: Pose { rotation, translation } };
            let answer = contacts_with(at(&bolt, 0.0, 0.0, 0.0), nut, 0.0, &mut memory);
            let depth = -answer.contacts[0].separation;
            assert!(depth > 0.005 && depth < 0.1, "{degrees} degrees, {below}: {depth}");
            let (bolt, regions) = (at(&bolt, 0.0, 0.0, 0.0), Demand::Regions { margin: 0.0 });
            let deepest = |a: Placed, b: Placed| {
                let depths = ask(a, b, regions).regions.into_iter();
                depths.filter_map(|r| Some((r.depth?, r.normal))).max_by(|x, y| x.0.total_cmp(&y.0))
            };
            let (depth, normal) = deepest(bolt, nut).unwrap();
            assert!(depth > 0.005 && depth < 0.1, "{degrees} degrees, {below}: {depth}");
            assert_eq!(deepest(nut, bolt).unwrap(), (depth, -normal));
            if normal.z < 0.99 {
                // Where flanks overlap facet by facet, no one of the ways out is that of all.
                continue;
            }
            for (share, meets) in [(1.001, Meeting::None), (0.999, Meeting::Cross)] {
                let translation = nut.pose.translation + share * depth * normal;
                let moved = Placed { pose: Pose { translation, ..nut.pose }, ..nut };
                assert_eq!(ask(bolt, moved, Demand::Intersects).surface, meets, "{depth} {share}");
            }
            parted += 1;
        }
    }
    assert!(parted > 8, "{parted}");
}

/// What overlaps the two sides of a notch by a hair has dug in nowhere, however high they are.
#[test]
fn what_grazes_two_sides_is_not_as_deep_as_they_are_high() {
    let cells: Vec<[i32; 3]> =
        (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]).filter(|[x, y, _]| *x < 2 || *y < 2).collect();
    let step = model(cranny_testkit::bodies::cells(&cells));
    let block: Vec<[i32; 3]> = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]).collect();
    let block = model(cranny_testkit::bodies::cells(&block));
    let (mut rng, mut overlapping) = (Rng::new(17), 0);
    for round in 0..200 {
        let mut hair = || 1e-5 * rng.unit();
        let rotation = DQuat::from_scaled_axis(DVec3::new(hair(), hair(), hair())).normalize();
        let translation = DVec3::new(2.0 + hair(), 2.0 + hair(), 0.05);
        let a = Placed { model: &step, pose: Pose::IDENTITY };
        let b = Placed { model: &block, pose: Pose { rotation, translation } };
        let found = contacts(a, b, 0.0);
        assert!(found.depth() < 1e-3, "round {round}: {:?}", found.contacts.first());
        overlapping += u32::from(found.depth() > 0.0);
    }
    assert!(overlapping > 100, "{overlapping}");
}

#[test]
fn crossed_edges_that_overlap_are_parted_along_their_common_normal() {
    // As in `gaps`: square bars on edge, at right angles.
    let bar = shape(Cuboid { size: [0.5, 0.5, 4.0] });
    let lying = DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt());
    let on_edge = DQuat::from_axis_angle(DVec3::Y, PI / 4.0) * lying;
    let across = DQuat::from_axis_angle(DVec3::Z, PI / 2.0) * on_edge;
    let reach = 0.5 * 0.5 * 2f64.sqrt();
    let lower = Placed { model: &bar, pose: Pose { rotation: on_edge, translation: DVec3::ZERO } };
    for depth in [-0.01, 1e-6, 0.01, 0.1] {
        let translation = DVec3::new(0.1, 0.2, 2.0 * reach - depth);
        let upper = Placed { model: &bar, pose: Pose { rotation: across, translation } };
        let answer = contacts(lower, upper, 0.02);
        assert_eq!(answer.contacts.len(), 1, "{depth}: {:#?}", answer.contacts);
        let c = &answer.contacts[0];
        assert!(matches!(c.id, (Feature::Edge(_), Feature::Edge(_))), "{c:?}");
        assert!((c.normal - DVec3::Z).length() < 1e-9, "{c:?}");
        assert!((c.separation + depth).abs() < 1e-12, "{c:?}");
    }
}

/// What turned-in faces make of each other needs no vertex inside: the regions tell then.
#[test]
fn solids_that_share_their_faces_still_have_a_contact() {
    let unit = shape(Cuboid::default());
    for offset in [DVec3::ZERO, DVec3::new(0.25, 0.0, 0.0)] {
        let answer =
            contacts(at(&unit, 0.0, 0.0, 0.0), at(&unit, offset.x, offset.y, offset.z), 0.01);
        assert!(answer.solid);
        assert!(answer.contacts[0].separation <= 0.0, "{:?}", answer.contacts);
    }
}

#[test]
fn a_nut_along_its_helix_has_contacts_all_around_and_none_is_off() {
    let bolt = shape(IsoBolt { segments: 48, ..IsoBolt::default() });
    let nut = shape(IsoNut { segments: 48, ..IsoNut::default() });
    let mut memory = PairMemory::default();
    for step in 0..6 {
        let angle = 0.026 * f64::from(step);
        let rise = 20.0 + angle / PI;
        let pose = Pose {
            rotation: DQuat::from_rotation_z(angle),
            translation: DVec3::new(0.01, 0.02, rise),
        };
        let (a, b) = (at(&bolt, 0.0, 0.0, 0.0), Placed { model: &nut, pose });
        let answer = contacts_with(a, b, 0.08, &mut memory);
        assert_eq!(answer.surface, Meeting::None);
        let distance = query(a, b, &Query::of(Demand::Distance { below: None }), &mut memory);
        let distance = distance.unwrap().distance.unwrap();
        assert!((answer.contacts[0].separation - distance).abs() < 1e-9);
        assert!((60..600).contains(&answer.contacts.len()), "{}", answer.contacts.len());
        // Both flanks stand at 60 degrees to the axis.
        let on_flank = |c: &&Contact| {
            let z = c.normal.z.abs();
            (z - 0.75f64.sqrt()).abs() < 0.03
        };
        let flanks = answer.contacts.iter().filter(on_flank).count();
        assert!(2 * flanks > answer.contacts.len(), "{flanks} of {}", answer.contacts.len());
        let mut cold = contacts(a, b, 0.08);
        cold.counters = answer.counters;
        assert_eq!(cold, answer);
    }
}

/// Leaves of patches are kept from query to query, and posed anew: whatever happens in between must
/// not show.
#[test]
fn what_is_kept_of_patches_changes_no_answer() {
    let bolt = shape(IsoBolt { segments: 24, length: Some(20.0), ..IsoBolt::default() });
    let nut = shape(IsoNut { segments: 24, clearance: 0.3, ..IsoNut::default() });
    let ball = shape(GolfBall::default());
    let mut rng = Rng::new(2024);
    let (mut memory, mut other, mut balls) = Default::default();
    let mut angle = 0.0;
    let mut found = 0;
    for step in 0..48 {
        // Along the helix, mostly; at times a freeze, a reversal, a jump, or off the helix into the
        // thread.
        angle += match step % 12 {
            5 => 0.0,
            7 => -0.3,
            9 => 2.0 + rng.unit(),
            _ => 0.026,
        };
        let off = if step % 12 == 11 { 0.2 } else { 0.01 * rng.unit() };
        let pose = Pose {
            rotation: DQuat::from_rotation_z(angle),
            translation: DVec3::new(0.01, 0.02, 4.0 + angle / PI + off),
        };
        if step % 16 == 13 {
            memory = PairMemory::default();
        }
        let margin = [0.2, 0.05, 0.3][step % 3];
        let (a, b) = (at(&bolt, 0.0, 0.0, 0.0), Placed { model: &nut, pose });
        let cold = contacts(a, b, margin);
        let mut warm = contacts_with(a, b, margin, &mut memory);
        let mut swapped = contacts_with(b, a, margin, &mut other).swapped();
        (warm.counters, swapped.counters) = (cold.counters, cold.counters);
        assert_eq!(warm, cold, "step {step}");
        assert_eq!(swapped, cold, "step {step}");
        // One model twice, queried in either order.
        let places = [0.0, 0.99 + 0.02 * rng.unit()].map(|x| Pose {
            rotation: DQuat::from_rotation_y(x * angle),
            translation: (1.0 - 2.0 * x) * ball.radius() * DVec3::new(1.0, 0.1, 0.0),
        });
        let [a, b] = places.map(|pose| Placed { model: &ball, pose });
        let (a, b) = if step % 2 == 0 { (a, b) } else { (b, a) };
        let (cold, mut warm) = (contacts(a, b, 0.05), contacts_with(a, b, 0.05, &mut balls));
        warm.counters = cold.counters;
        assert_eq!(warm, cold, "step {step}");
        found += cold.contacts.len();
    }
    assert!(found > 48, "{found}");
    let before = memory.bytes();
    let far = at(&nut, 500.0, 0.0, 0.0);
    assert!(contacts_with(at(&bolt, 0.0, 0.0, 0.0), far, 0.2, &mut memory).contacts.is_empty());
    assert!(4 * memory.bytes() < before, "{} of {before} bytes", memory.bytes());
}

/// A model whose vertices were moved and moved back has the same mesh, and other patches: memory of
/// the one must not speak for the other.
#[test]
fn memory_of_a_model_says_nothing_of_one_with_other_patches() {
    let original = shape(GolfBall::default());
    let mut deformed = original.clone();
    for k in 0..60 {
        let vertex = VertexId(k * (original.mesh().vertices().len() as u32 / 61));
        let place = original.mesh().position(vertex);
        if deformed.deform(&[(vertex, 1.3 * place)]).is_ok() {
            deformed.deform(&[(vertex, place)]).unwrap();
        }
    }
    assert_eq!(original.digest(), deformed.digest());
    assert_ne!(original.patches().len(), deformed.patches().len());
    let reach = original.radius();
    for turn in 0..24 {
        let axis = DVec3::new(0.3, 0.5, 0.8).normalize();
        let rotation = DQuat::from_axis_angle(axis, 0.37 * f64::from(turn));
        let away = rotation * DVec3::X;
        let ask = |model: &Model, pose: Pose, demand, memory: &mut PairMemory| {
            let a = Placed { model, pose: Pose::IDENTITY };
            let answer = query(a, Placed { model: &original, pose }, &Query::of(demand), memory);
            Answer { counters: Default::default(), ..answer.unwrap() }
        };
        let far = Pose { rotation, translation: 3.0 * reach * away };
        let distance = Demand::Distance { below: None };
        let gap = ask(&original, far, distance, &mut PairMemory::default()).distance.unwrap();
        let pose = Pose { translation: (3.0 * reach - gap) * away, ..far };
        let demand = Demand::contacts(0.2 * reach);
        let mut memory = PairMemory::default();
        ask(&original, pose, demand, &mut memory);
        let warm = ask(&deformed, pose, demand, &mut memory);
        assert_eq!(warm, ask(&deformed, pose, demand, &mut PairMemory::default()), "turn {turn}");
    }
}

/// A small body travels around a large one: what was left behind is let go of.
#[test]
fn memory_of_contacts_follows_what_is_near() {
    let ring = shape(Torus {
        major_radius: 1.0,
        minor_radius: 0.2,
        major_segments: 160,
        minor_segments: 24,
    });
    let cube = shape(Cuboid { size: [0.06; 3] });
    let query_of = Query::of(Demand::contacts(0.03));
    let placed = |frame: u32| {
        let angle = 0.02 * f64::from(frame);
        let at = DVec3::new(1.25 * angle.cos(), 1.25 * angle.sin(), 0.0);
        let a = Placed { model: &ring, pose: Pose::IDENTITY };
        [a, Placed { model: &cube, pose: Pose::at(at) }]
    };
    let mut memory = PairMemory::default();
    let mut found = 0;
    for frame in 0..310 {
        let [a, b] = placed(frame);
        found += query(a, b, &query_of, &mut memory).unwrap().contacts.len();
    }
    assert!(found > 300, "{found}");
    let mut fresh = PairMemory::default();
    for frame in [308, 309] {
        let [a, b] = placed(frame);
        query(a, b, &query_of, &mut fresh).unwrap();
    }
    let [kept, fresh] = [memory, fresh].map(|memory| memory.bytes());
    assert!(kept < 3 * fresh, "{kept} bytes after a turn, {fresh} here");
}

/// A list that cannot last is let go of, but for who won: the next query begins there.
#[test]
fn of_a_list_that_does_not_last_the_winners_are_kept() {
    let ball = shape(GolfBall::default());
    let query_of = Query::of(Demand::contacts(0.1 * ball.radius()));
    let placed = |turn: f64| {
        let rotation = DQuat::from_axis_angle(DVec3::new(0.3, 0.5, 0.8).normalize(), turn);
        let pose = Pose { rotation, translation: 2.02 * ball.radius() * DVec3::Y };
        [Placed { model: &ball, pose: Pose::IDENTITY }, Placed { model: &ball, pose }]
    };
    let (mut resting, mut turning) = (PairMemory::default(), PairMemory::default());
    let [mut warm, mut cold] = [0; 2];
    for frame in 0..40 {
        let [a, b] = placed(0.03 * f64::from(frame));
        let answer = query(a, b, &query_of, &mut turning).unwrap();
        let alone = query(a, b, &query_of, &mut PairMemory::default()).unwrap();
        assert!(!answer.contacts.is_empty());
        warm += answer.counters.triangle_tests;
        cold += alone.counters.triangle_tests;
        let [a, b] = placed(0.0);
        query(a, b, &query_of, &mut resting).unwrap();
    }
    assert!(warm < cold, "{warm} of {cold} features compared");
    let [kept, listed] = [turning, resting].map(|memory| memory.bytes());
    assert!(0 < kept && 100 * kept < listed, "{kept} bytes while turning, {listed} at rest");
}

/// Bodies that wander slowly, rest, jump and are queried with other margins: what is kept of
/// features near each other changes no answer, and while they move little it is all that is looked
/// at.
#[test]
fn what_is_near_is_kept_and_changes_no_answer() {
    let bodies = [
        shape(Cuboid::default()),
        shape(Cup { segments: 9, ..Cup::default() }),
        shape(Torus { major_segments: 12, minor_segments: 7, ..Torus::default() }),
        shape(GolfBall { triangles: 1_000, dimples: 12, ..GolfBall::default() }),
    ];
    let mut rng = Rng::new(4_711);
    let (mut found, mut met, mut looked, mut kept) = (0, 0, 0, 0);
    for round in 0..24 {
        let (a, b) = (&bodies[rng.below(4)], &bodies[rng.below(4)]);
        let turn = |rng: &mut Rng, size: f64| {
            let axis = size * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0).normalize()
        };
        let direction = turn(&mut rng, 9.0) * DVec3::X;
        let translation = (a.radius() + b.radius()) * direction;
        let mut pose = Pose { rotation: turn(&mut rng, 9.0), translation };
        let first = Placed { model: a, pose: Pose::IDENTITY };
        // Nearer by no more than they are apart; in the end they touch, more or less.
        for reach in [0.03, 0.03, 0.03, 0.03, 0.01, 0.0, -0.005] {
            let distance = Query::of(Demand::Distance { below: None });
            let second = Placed { model: b, pose };
            let answer = query(first, second, &distance, &mut PairMemory::default()).unwrap();
            pose.translation -= (answer.distance.unwrap() - reach) * direction;
        }
        let mut memory = PairMemory::default();
        let pace = [0.0, 1e-5, 1e-3, 0.02][round % 4];
        for step in 0..40 {
            // Often by less than patches may come nearer.
            let margin = 0.01 + 0.004 * (step % 8) as f64;
            let demand = match step % 10 {
                9 => Demand::Regions { margin },
                _ => Demand::contacts(margin),
            };
            let second = Placed { model: b, pose };
            let ask =
                |memory: &mut PairMemory| query(first, second, &Query::of(demand), memory).unwrap();
            let (cold, warm) = (ask(&mut PairMemory::default()), ask(&mut memory));
            found += cold.contacts.len();
            met += cold.triangle_pairs;
            // Where bodies overlap, it is depths that are searched.
            if pace < 1e-4 && step > 2 && cold.triangle_pairs == 0 {
                looked += cold.counters.node_tests;
                kept += warm.counters.node_tests;
            }
            let warm = Answer { counters: cold.counters, ..warm };
            assert_eq!(warm, cold, "round {round}, step {step}: {demand:?} at {pose:?}");
            let jump = if step == 30 { 0.1 } else { pace };
            pose.translation += jump * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            pose.rotation = (turn(&mut rng, jump) * pose.rotation).normalize();
        }
    }
    assert!(found > 1000 && met > 500, "{found} contacts, {met} pairs of faces that meet");
    assert!(4 * kept < 3 * looked, "{kept} nodes compared, {looked} without memory");
}

/// A tall box is pushed against the side of a low one: the overlap is a sliver. That edges of the
/// two cross, seen from above, makes nothing as deep as the side is high.
#[test]
fn a_sliver_beside_is_no_deep_overlap() {
    let (tall, low) =
        (shape(Cuboid { size: [0.1, 1.0, 0.4] }), shape(Cuboid { size: [0.1, 0.1, 0.1] }));
    let mut rng = Rng::new(11);
    let mut overlapping = 0;
    for round in 0..200 {
        let yaw = DQuat::from_rotation_z(0.08 * rng.unit());
        let tilt = DQuat::from_scaled_axis(1e-3 * DVec3::new(rng.unit(), rng.unit(), 0.0));
        let into = 2e-3 * rng.unit().abs();
        let place = DVec3::new(0.1 - into, 0.3 * rng.unit(), 0.03 * rng.unit() - 0.16);
        let a = Placed { model: &tall, pose: Pose::IDENTITY };
        let b = Placed { model: &low, pose: Pose { rotation: tilt * yaw, translation: place } };
        let question = Query::of(Demand::contacts(0.0)).penetrations_from(0.0);
        let overlaps = query(a, b, &question, &mut PairMemory::default()).unwrap().penetrations;
        let truth = overlaps.iter().map(|overlap| overlap.depth()).fold(0.0, f64::max);
        let found = contacts(a, b, 0.0);
        assert!(
            found.depth() <= 3.0 * truth + 1e-12,
            "round {round}: {} of {truth}: {:?}",
            found.depth(),
            found.contacts.first()
        );
        overlapping += usize::from(truth > 0.0);
    }
    assert!(overlapping > 150, "{overlapping}");
}
