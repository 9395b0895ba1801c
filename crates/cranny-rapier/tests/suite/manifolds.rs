//! The form of what rapier's solver is given: few points, true distances, ids that persist.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{FaceId, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query, reduce_level_contacts};
use cranny_rapier::{MeshShape, dispatcher, pose_from_rapier, pose_to_rapier};
use cranny_shapes::{Cup, Gear, GolfBall, IsoBolt, IsoNut, LPrism, Torus};
use rapier3d::geometry::ContactManifold;
use rapier3d::math::{Pose as RapierPose, Real, Vector};
use rapier3d::parry::query::{PersistentQueryDispatcher, PointQuery, QueryDispatcher};
use rapier3d::parry::shape::{FeatureId, Shape, SharedShape};

use crate::world::{World, cuboid, model, ours, up};

/// A small congruential generator: the same poses in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Within −1 to 1.
    pub(crate) fn number(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub(crate) fn pose(&mut self, reach: f64) -> Pose {
        let q = DQuat::from_xyzw(self.number(), self.number(), self.number(), self.number());
        Pose { rotation: q.normalize(), translation: self.vector() * reach }
    }
}

fn manifolds(
    pose: &RapierPose,
    first: &dyn Shape,
    second: &dyn Shape,
    prediction: Real,
) -> Vec<ContactManifold> {
    let mut manifolds = Vec::new();
    dispatcher()
        .contact_manifolds(pose, first, second, prediction, &mut manifolds, &mut None)
        .expect("a partner that is known");
    manifolds
}

/// What every manifold must be, whoever made it. `size` is the largest coordinate.
fn check(manifolds: &[ContactManifold], pose: &RapierPose, prediction: Real, size: Real) {
    let rounding = 1e-5 * size;
    for manifold in manifolds {
        assert!((1..=4).contains(&manifold.points.len()), "{} points", manifold.points.len());
        let (n1, n2) = (manifold.local_n1, manifold.local_n2);
        assert!((n1.length() - 1.0).abs() < 1e-5, "normal {n1}");
        assert!((n1 + pose.rotation * n2).length() < 1e-5, "normals {n1} and {n2}");
        for point in &manifold.points {
            let way = pose.transform_point(point.local_p2) - point.local_p1;
            let along = way.dot(n1);
            // Members of a manifold have normals up to 0.8 degrees apart.
            let allowed = rounding + 2e-2 * way.length();
            assert!((along - point.dist).abs() <= allowed, "{along} is not {}", point.dist);
            assert!(point.dist <= prediction + rounding, "{} is out of reach", point.dist);
        }
    }
}

/// How many contacts the exact query makes. `None` where the
/// bodies overlap by half of what the thinner one is thick (2·V/A), or one is inside the other:
/// then a way out takes their place.
fn query_contacts([a, b]: [&Model; 2], pose: &RapierPose, margin: f64) -> Option<usize> {
    let margin = f64::from(margin as Real);
    let (a, b) = (
        Placed { model: a, pose: Pose::IDENTITY },
        Placed { model: b, pose: pose_from_rapier(pose) },
    );
    let ask = Query::of(Demand::contacts(margin));
    let answer = query(a, b, &ask, &mut PairMemory::default()).expect("valid poses");
    let thickness = [a.model, b.model].map(|m| {
        let faces = (0..m.mesh().faces().len() as u32).map(FaceId);
        let area: f64 = faces.map(|face| m.mesh().area_vector(face).length()).sum();
        2.0 * m.mass_properties().expect("closed").volume / area
    });
    let deep = 0.5 * thickness[0].min(thickness[1]);
    let deepest = answer.contacts.first().map_or(0.0, |c| -c.separation);
    let way_out = answer.solid && (answer.contained.is_some() || deepest >= deep);
    (!way_out).then(|| reduce_level_contacts(answer.contacts).len())
}

/// Whether a feature id is one of the model's.
fn exists(id: FeatureId, model: &Model) -> bool {
    match id {
        FeatureId::Vertex(v) => (v as usize) < model.mesh().vertices().len(),
        FeatureId::Edge(e) => (e as usize) < model.topology().edges().len(),
        FeatureId::Face(f) => (f as usize) < model.mesh().faces().len(),
        FeatureId::Unknown => false,
    }
}

fn bodies() -> Vec<(&'static str, Model)> {
    vec![
        ("torus", model(Torus { major_segments: 32, minor_segments: 8, ..Torus::default() })),
        ("cup", model(Cup { segments: 24, ..Cup::default() })),
        ("L", model(LPrism::default())),
        (
            "golf ball",
            model(GolfBall { radius: 0.5, dimples: 48, triangles: 2_000, ..GolfBall::default() }),
        ),
    ]
}

#[test]
fn meshes_in_all_positions() {
    let mut random = Random(1);
    let (mut met, mut apart, mut most, mut deep) = (0, 0, 0, 0);
    let bodies = bodies();
    for (i, (first, a)) in bodies.iter().enumerate() {
        for (second, b) in &bodies[i..] {
            let shapes = [a, b].map(|m| MeshShape::new(m, 0).expect("parry takes it"));
            for _ in 0..32 {
                let pose = random.pose(0.9);
                let found = manifolds(&pose_to_rapier(&pose), &shapes[0], &shapes[1], 0.05);
                check(&found, &pose_to_rapier(&pose), 0.05, 2.0);
                let points: usize = found.iter().map(|m| m.points.len()).sum();
                most = most.max(found.len());
                let Some(direct) = query_contacts([a, b], &pose_to_rapier(&pose), 0.05) else {
                    // One way out: nothing that overlaps is pushed against another.
                    let into = found.iter().filter(|m| m.points.iter().any(|p| p.dist < 0.0));
                    let into: Vec<Vector> = into.map(|m| m.local_n1).collect();
                    assert!(!into.is_empty(), "{first} and {second}: no way out");
                    let free = |way: &Vector| into.iter().all(|n| n.dot(*way) > -0.26);
                    assert!(into.iter().any(free), "{first} and {second}: {into:?}");
                    deep += 1;
                    continue;
                };
                assert_eq!(points, direct, "{first} and {second}: each contact once");
                for point in found.iter().flat_map(|m| &m.points) {
                    if point.dist <= 0.0 {
                        met += 1;
                    } else {
                        apart += 1;
                    }
                    assert!(exists(point.fid1.unpack(), a), "{first}: {:?}", point.fid1.unpack());
                    assert!(exists(point.fid2.unpack(), b), "{second}: {:?}", point.fid2.unpack());
                    for (shape, p) in [(&shapes[0], point.local_p1), (&shapes[1], point.local_p2)] {
                        let off = (shape.mesh().project_local_point(p, false).point - p).length();
                        let allowed = 1e-4 + (-point.dist).max(0.0);
                        assert!(off < allowed, "{first}, {second}: {p} is {off} off the surface");
                    }
                }
            }
        }
    }
    assert!(
        met > 100 && apart > 100 && most > 3 && deep > 10,
        "{met} {apart} {most} {deep}: the test tests nothing"
    );
}

#[test]
fn primitives_in_all_positions() {
    let mut random = Random(2);
    let partners = [
        ("ball", SharedShape::ball(0.3)),
        ("capsule", SharedShape::capsule_y(0.3, 0.15)),
        ("cylinder", SharedShape::cylinder(0.3, 0.2)),
        ("coin", SharedShape::cylinder(0.04, 0.3)),
        ("cone", SharedShape::cone(0.3, 0.2)),
        ("segment", SharedShape::segment(Vector::new(-0.8, 0.0, 0.1), Vector::new(0.7, 0.1, 0.0))),
        ("round cylinder", SharedShape::round_cylinder(0.2, 0.15, 0.05)),
        ("round cone", SharedShape::round_cone(0.2, 0.15, 0.05)),
        ("cuboid", SharedShape::cuboid(0.3, 0.2, 0.1)),
        ("half-space", SharedShape::halfspace(Vector::new(0.6, 0.0, 0.8))),
    ];
    let brick = cuboid(0.6, 0.4, 0.2); // the same as a model
    let mut told_alike = 0;
    for (body, a) in &bodies() {
        let shape = MeshShape::new(a, 0).expect("parry takes it");
        for (name, partner) in &partners {
            let mut points = 0;
            for _ in 0..40 {
                let pose = pose_to_rapier(&random.pose(1.0));
                let found = manifolds(&pose, &shape, &*partner.0, 0.05);
                check(&found, &pose, 0.05, 2.0);
                assert!(found.len() < 64, "{body} and {name}: {} manifolds", found.len());
                points += found.iter().map(|m| m.points.len()).sum::<usize>();
                // Where they are apart, the nearest contact is as far as they are.
                if *name != "half-space" {
                    let apart = dispatcher().distance(&pose, &shape, &*partner.0).expect("known");
                    let reported = found.iter().flat_map(|m| &m.points).map(|p| p.dist);
                    let nearest = reported.fold(Real::INFINITY, Real::min);
                    let what = format!("{body} and {name}: {nearest} at {}", apart.distance);
                    match apart.distance {
                        0.0 => assert!(nearest < 1e-4, "{what}"),
                        d if d < 0.05 => assert!((nearest - d).abs() < 1e-5, "{what}"),
                        _ => assert_eq!(nearest, Real::INFINITY, "{what}"),
                    }
                }
                // The other way round: the same, seen from the other side.
                let back = pose.inverse();
                let swapped = manifolds(&back, &*partner.0, &shape, 0.05);
                check(&swapped, &back, 0.05, 2.0);
                let depth = |all: &[ContactManifold]| {
                    all.iter()
                        .flat_map(|m| &m.points)
                        .map(|p| p.dist)
                        .fold(Real::INFINITY, Real::min)
                };
                let (there, here) = (depth(&found), depth(&swapped));
                // Of two ways out that are equally long, rounding may choose another.
                let led = *name == "cuboid" && query_contacts([a, &brick], &pose, 0.05).is_none();
                let same = there == here || (there - here).abs() < 1e-4;
                assert!(led || same, "{body} and {name}: {there} but {here}");
                told_alike += usize::from(same);
            }
            // A segment has but its ends and what it crosses.
            let enough = if *name == "segment" { 5 } else { 10 };
            assert!(points > enough, "{body} and {name}: {points} points");
        }
    }
    assert!(told_alike > 1560, "{told_alike} of 1600");
}

#[test]
fn a_nut_on_its_bolt_makes_few_contacts() {
    let bolt = MeshShape::new(&model(IsoBolt::default()), 0).expect("parry takes it");
    let nut = MeshShape::new(&model(IsoNut::default()), 1).expect("parry takes it");
    for turn in [0.0, 0.4, 2.0] {
        // Along the helix of pitch 2, as the thread leads it.
        let height = 20.0 + turn / std::f64::consts::PI;
        let pose = Pose {
            rotation: DQuat::from_rotation_z(turn),
            translation: DVec3::new(0.02, 0.01, height + 0.08),
        };
        let found = manifolds(&pose_to_rapier(&pose), &bolt, &nut, 0.02);
        check(&found, &pose_to_rapier(&pose), 0.02, 20.0);
        // The lower flank bears on the upper one: a bounded handful all around.
        let points: usize = found.iter().map(|m| m.points.len()).sum();
        assert!((1..256).contains(&points), "{points} points in {} manifolds", found.len());
    }
}

/// Impulses outlive the step: at rest every bearing pair remembers what it carries.
#[test]
fn impulses_are_carried_over() {
    let cube = ours(&cuboid(1.0, 1.0, 1.0));
    let gear = ours(&model(Gear::default()));
    let thick = model(Gear::default()).bounds();
    for (name, lower, upper, start) in [
        ("cube on slab", ours(&cuboid(4.0, 4.0, 1.0)), cube.clone(), 1.001),
        ("cube on cuboid", SharedShape::cuboid(2.0, 2.0, 0.5), cube.clone(), 1.001),
        ("cube on half-space", SharedShape::halfspace(Vector::Z), cube, 0.501),
        (
            "gear on half-space",
            SharedShape::halfspace(Vector::Z),
            gear,
            0.001 - thick.min.z as Real,
        ),
        ("ball on slab", ours(&cuboid(4.0, 4.0, 1.0)), SharedShape::ball(0.5), 1.001),
    ] {
        let mut world = World::new();
        world.0.integration_parameters.contact_recycling = false;
        world.0.integration_parameters.contact_clustering = false;
        world.fixed(&lower, RapierPose::IDENTITY);
        let body = world.dynamic(&upper, up(start));
        world.run(20); // long enough to rest, too short to fall asleep
        let weight = world.0.bodies[body].mass() * 9.81 * world.0.integration_parameters.dt;
        let impulses = |world: &World| -> Real {
            world.manifolds().flat_map(|m| &m.points).map(|p| p.data.warmstart_impulse).sum()
        };
        let before = impulses(&world);
        assert!(before > 0.0, "{name} remembers nothing");
        let applied: Real = world.manifolds().flat_map(|m| &m.points).map(|p| p.data.impulse).sum();
        assert!((applied - weight).abs() < 0.2 * weight, "{name}: {applied}, weight {weight}");
        world.run(1);
        let after = impulses(&world);
        assert!((after - before).abs() < 0.2 * before, "{name}: {before} became {after}");
    }
}

/// A second question about the same pair hands each point's impulse on, by id, and invents none.
#[test]
fn impulses_follow_their_features_and_are_not_multiplied() {
    let slab = MeshShape::new(&crate::world::tessellated_slab(20, 2.0), 0).expect("parry takes it");
    let cube = MeshShape::new(&cuboid(0.5, 0.5, 0.5), 1).expect("parry takes it");
    let (mut found, mut workspace) = (Vec::new(), None);
    let ours = dispatcher();
    let mut ask = |x: Real, found: &mut Vec<ContactManifold>| {
        let pose = RapierPose::translation(x, 0.07, 0.2505);
        ours.contact_manifolds(&pose, &slab, &cube, 0.2, found, &mut workspace).expect("ours");
    };
    ask(0.03, &mut found);
    let stamp = |found: &mut Vec<ContactManifold>| {
        for (k, point) in found.iter_mut().flat_map(|m| &mut m.points).enumerate() {
            point.data.warmstart_impulse = (k + 1) as Real;
        }
    };
    let all = |found: &[ContactManifold]| -> Vec<Real> {
        let points = found.iter().flat_map(|m| &m.points);
        points.map(|p| p.data.warmstart_impulse).filter(|&i| i > 0.0).collect()
    };
    stamp(&mut found);
    let before = all(&found);
    assert!(before.len() >= 4);
    ask(0.03, &mut found);
    assert_eq!(all(&found), before, "nothing moved");
    // Over the edges of the tessellation: ids change, impulses are handed on by place, once each.
    for step in 1..40 {
        let before = all(&found);
        ask(0.03 + 0.02 * step as Real, &mut found);
        let after = all(&found);
        let total = |all: &[Real]| all.iter().sum::<Real>();
        assert!(total(&after) <= total(&before), "step {step}: {before:?} became {after:?}");
        stamp(&mut found);
    }
}
