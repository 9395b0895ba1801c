//! Depth judged by motion: moved by it along the normal the bodies part, moved by less they do not.

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Contact, Demand, PairMemory, Penetration, Placed, Query, Region, query};
use cranny_shapes::{Cuboid, Cup, Sphere, Tetrahedron, Torus};
use cranny_testkit::{Rng, world_triangles};

use crate::regions::regions;
use crate::solids::{ask, shape};

/// Special positions are read from 2^-30 of the pair's scale beside.
const BESIDE: f64 = 1e-8;

/// Whether the surfaces meet when B is moved.
fn meet(a: Placed, b: Placed, by: DVec3) -> bool {
    let pose = Pose { translation: b.pose.translation + by, ..b.pose };
    ask(a, Placed { pose, ..b }, Demand::Intersects).surface != Meeting::None
}

fn assert_parts(a: Placed, b: Placed, region: &Region, what: &str) {
    let depth = region.depth.unwrap();
    let size = a.model.radius() + b.model.radius();
    let enough = depth * (1.0 + 1e-9) + BESIDE * size;
    assert!(!meet(a, b, region.normal * enough), "{what}: moved by {enough}");
    let short = depth * (1.0 - 1e-3) - BESIDE * size;
    assert!(short < 0.0 || meet(a, b, region.normal * short), "{what}: moved by {short}");
}

fn random_pose(rng: &mut Rng, offset: f64) -> Pose {
    let q = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
    let turn = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
    Pose { rotation: q, translation: offset * (turn * DVec3::X) }
}

/// The planes of a convex body's faces: outward normal and offset.
fn planes(placed: Placed) -> Vec<(DVec3, f64)> {
    let plane = |[a, b, c]: [DVec3; 3]| {
        let n = (b - a).cross(c - a).normalize();
        (n, n.dot(a))
    };
    world_triangles(placed.model, &placed.pose).into_iter().map(plane).collect()
}

/// How far a point is outside a convex body; below 0 inside.
fn outside(p: DVec3, planes: &[(DVec3, f64)]) -> f64 {
    planes.iter().map(|(n, d)| n.dot(p) - d).fold(f64::NEG_INFINITY, f64::max)
}

/// By how much A leads B along `normal` over points sampled from B's surface: of the line from a
/// point in A to where it leaves A, if that is still in B.
fn sampled_lead(a: Placed, b: Placed, normal: DVec3, rng: &mut Rng) -> f64 {
    let (in_a, in_b, faces) = (planes(a), planes(b), world_triangles(b.model, &b.pose));
    let mut lead = 0.0f64;
    for k in 0..4_000 {
        let [u, v, w] = faces[k % faces.len()];
        let (mut s, mut t) = (rng.unit().abs(), rng.unit().abs());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        let q = u + s * (v - u) + t * (w - u);
        if outside(q, &in_a) < 0.0 {
            let ahead = in_a.iter().filter(|(n, _)| n.dot(normal) > 0.0);
            let exits = ahead.map(|(n, d)| (d - n.dot(q)) / n.dot(normal));
            let exit = exits.fold(f64::INFINITY, f64::min);
            if outside(q + exit * normal, &in_b) <= 0.0 {
                lead = lead.max(exit);
            }
        }
    }
    lead
}

#[test]
fn no_line_along_the_normal_leads_by_more_than_the_depth() {
    let bodies: [(&str, Model); 4] = [
        ("cuboid", shape(Cuboid { size: [1.0, 0.75, 1.25] })),
        ("flat", shape(Cuboid { size: [2.0, 2.0, 0.25] })),
        ("sphere", shape(Sphere { radius: 0.6, segments: 14, rings: 9 })),
        ("tetrahedron", shape(Tetrahedron { edge: 1.5 })),
    ];
    let mut rng = Rng::new(17);
    let mut tried = 0;
    for _ in 0..200 {
        let ((name_a, a), (name_b, b)) = (&bodies[rng.below(4)], &bodies[rng.below(4)]);
        let offset = 0.6 + 0.3 * rng.unit();
        let a = Placed { model: a, pose: random_pose(&mut rng, 0.0) };
        let b = Placed { model: b, pose: random_pose(&mut rng, offset) };
        let what = format!("{name_a} at {:?}, {name_b} at {:?}", a.pose, b.pose);
        let answer = regions(a, b);
        assert!(answer.regions.len() <= 1, "convex: {what}");
        let [region] = &answer.regions[..] else { continue };
        let depth = region.depth.unwrap();
        let lead = sampled_lead(a, b, region.normal, &mut rng);
        assert!(lead <= depth * (1.0 + 1e-9) + 1e-12, "{what}: {lead} > {depth}");
        if region.curves.len() == 1 {
            // The depth is attained: at a point of A in B and a point of B in A.
            let Contact { point_a, point_b, .. } = region.deepest;
            assert!(outside(point_a, &planes(b)) < 1e-9, "{what}");
            assert!(outside(point_b, &planes(a)) < 1e-9, "{what}");
            let short = depth * (1.0 - 1e-3);
            let by = region.normal * short;
            let pose = Pose { translation: b.pose.translation + by, ..b.pose };
            assert!(ask(a, Placed { pose, ..b }, Demand::Intersects).solid, "{what}: {short}");
            tried += 1;
        }
    }
    assert!(tried >= 80, "{tried}");
}

/// Bodies that overlap a little: the pieces are small and blunt enough that what holds the bodies
/// back is the pieces. (Moved along the area's direction, a sharp tip meets faces beside its
/// piece.)
#[test]
fn bodies_that_overlap_a_little_part_when_moved_by_the_depth_and_not_before() {
    let bodies: [(&str, Model); 4] = [
        ("cup", shape(Cup { segments: 16, ..Cup::default() })),
        ("torus", shape(Torus { major_segments: 20, minor_segments: 9, ..Torus::default() })),
        ("cuboid", shape(Cuboid::default())),
        ("sphere", shape(Sphere { radius: 0.6, segments: 14, rings: 9 })),
    ];
    let mut rng = Rng::new(23);
    let mut tried = 0;
    for _ in 0..120 {
        let ((name_a, a), (name_b, b)) = (&bodies[rng.below(4)], &bodies[rng.below(4)]);
        let a = Placed { model: a, pose: random_pose(&mut rng, 0.0) };
        let apart = Placed { model: b, pose: random_pose(&mut rng, 3.5) };
        let found = ask(a, apart, Demand::Distance { below: None });
        let [p, q] = found.witnesses.unwrap().map(|w| w.point);
        let gap = p - q;
        let step = gap * (1.0 + 0.004 / gap.length());
        let pose = Pose { translation: apart.pose.translation + step, ..apart.pose };
        let b = Placed { pose, ..apart };
        let answer = regions(a, b);
        let what = format!("{name_a} at {:?}, {name_b} at {:?}", a.pose, b.pose);
        assert_eq!(answer.surface, Meeting::Cross, "{what}");
        let [region] = &answer.regions[..] else { continue };
        // The bodies approached by 0.004 beyond contact, so no direction needs more than this.
        assert!(region.depth.unwrap() > 0.0, "{what}: {region:?}");
        assert_parts(a, b, region, &what);
        tried += 1;
    }
    assert!(tried >= 90, "{tried}");
}

/// How deep regions are along their normals, by a query that makes no regions.
fn penetrations(a: Placed, b: Placed) -> Vec<Penetration> {
    let question = Query::of(Demand::contacts(0.0)).penetrations_from(0.0);
    query(a, b, &question, &mut PairMemory::default()).unwrap().penetrations
}

/// Overlaps alone, and those of regions: as many, along the same normals, as deep.
fn assert_overlaps_are_those_of_regions(a: Placed, b: Placed, what: &str) -> usize {
    let regions = ask(a, b, Demand::Regions { margin: 0.0 }).regions;
    let mut of_regions: Vec<_> = regions.iter().filter_map(Penetration::of).collect();
    of_regions.retain(|overlap| overlap.depth() > 0.0);
    let mut alone = penetrations(a, b);
    alone.retain(|overlap| overlap.depth() > 0.0);
    assert_eq!(alone.len(), of_regions.len(), "{what}");
    let error = 1e-12 * (a.model.radius() + b.model.radius());
    for known in &of_regions {
        let same = |x: &Penetration| {
            (x.depth() - known.depth()).abs() <= error && (x.normal - known.normal).length() < 1e-9
        };
        assert!(alone.iter().any(same), "{what}: {known:?} of {alone:?}");
    }
    let swapped = penetrations(b, a);
    let swapped = swapped.iter().filter(|overlap| overlap.depth() > 0.0);
    for (one, other) in alone.iter().zip(swapped) {
        assert_eq!(*one, other.swapped(), "{what}: exchanged");
    }
    alone.len()
}

#[test]
fn overlaps_alone_are_those_of_regions() {
    let bodies: Vec<Model> = [
        shape(Cuboid { size: [1.0, 0.8, 0.6] }),
        shape(Torus { major_segments: 16, minor_segments: 9, ..Torus::default() }),
        shape(Cup { segments: 9, ..Cup::default() }),
        shape(Sphere { segments: 12, ..Sphere::default() }),
    ]
    .into();
    let mut rng = Rng::new(77);
    let (mut found, mut several) = (0, 0);
    for round in 0..120 {
        let [a, b] = [0; 2].map(|_| &bodies[rng.below(bodies.len())]);
        let offset = 0.9 * rng.unit().abs() * (a.radius() + b.radius());
        let a = Placed { model: a, pose: random_pose(&mut rng, 0.1) };
        let b = Placed { model: b, pose: random_pose(&mut rng, offset) };
        let count = assert_overlaps_are_those_of_regions(a, b, &format!("round {round}"));
        found += usize::from(count > 0);
        several += usize::from(count > 1);
    }
    assert!(found > 40 && several > 4, "{found}, {several}");
    // Special positions: faces flush.
    for x in [0.125, 0.25, 0.5, 1.0, 1.5] {
        let cube = |x| Placed { model: &bodies[0], pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
        assert_overlaps_are_those_of_regions(cube(0.0), cube(x), &format!("cubes {x} apart"));
    }
}

#[test]
fn what_has_no_depth_has_no_overlaps() {
    let cube = shape(Cuboid { size: [1.0; 3] });
    let small = shape(Cuboid { size: [0.25; 3] });
    let place = |model, x| Placed { model, pose: Pose::at(DVec3::new(x, 0.0, 0.0)) };
    for (b, what) in [
        (place(&small, 0.1), "wholly inside"),
        (place(&small, 0.625), "beside"),
        (place(&small, 3.0), "far away"),
    ] {
        let found = penetrations(place(&cube, 0.0), b);
        assert!(found.is_empty(), "{what}: {found:?}");
    }
}

/// Only where a contact is so deep, only with contacts, and of no depth that is none.
#[test]
fn penetrations_are_measured_from_a_depth_on() {
    let (cube, ball) =
        (shape(Cuboid { size: [1.0; 3] }), shape(Sphere { radius: 0.5, segments: 24, rings: 12 }));
    for (model, what) in [(&cube, "of few faces"), (&ball, "of many")] {
        let a = Placed { model: &cube, pose: Pose::IDENTITY };
        let b = Placed { model, pose: Pose::at(DVec3::new(0.01, 0.02, 0.9)) };
        let ask = |demand, from| {
            query(a, b, &Query::of(demand).penetrations_from(from), &mut PairMemory::default())
        };
        let contacts = Demand::contacts(0.01);
        let found = |from| ask(contacts, from).unwrap().penetrations;
        assert_eq!(found(0.05).len(), 1, "{what}");
        assert!((found(0.05)[0].depth() - 0.1).abs() < 0.01, "{what}: {:?}", found(0.05));
        assert!(found(0.2).is_empty(), "{what}: nothing is so deep");
        let question = Query::of(contacts).penetrations_from(0.05);
        let exchanged = query(b, a, &question, &mut PairMemory::default()).unwrap().swapped();
        assert_eq!(exchanged.penetrations, found(0.05), "{what}: exchanged");
        let map = Pose::at(DVec3::new(3.0, 0.0, 0.0)).world_from_body();
        let moved = ask(contacts, 0.05).unwrap().moved(&map).penetrations;
        let by = moved[0].deepest.point_a - found(0.05)[0].deepest.point_a;
        assert!((by - DVec3::X * 3.0).length() < 1e-12, "{what}: moved by {by}");
        let of_regions = ask(Demand::Regions { margin: 0.0 }, 0.05).unwrap();
        assert!(of_regions.penetrations.is_empty() && !of_regions.regions.is_empty(), "{what}");
        for from in [-1.0, f64::NAN, f64::INFINITY] {
            let why = ask(contacts, from).unwrap_err().to_string();
            assert!(why.starts_with("penetrations_from is"), "{why}");
        }
    }
}
