//! Questions about places are led by a tree of boxes: a walk over all bodies says the same.

use bevy_ecs::entity_disabling::Disabled;
use bevy_ecs::prelude::*;
use bevy_ecs::system::{RunSystemOnce, SystemState};
use bevy_math::{Dir3, Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_primitives::{Separation, cast_ray_at_shape, separation_of_point};
use cranny_shapes::{Cup, Torus};
use cranny_testkit::Rng;

use crate::build::{cuboid, empty, steps, unit, up, world};

fn all() -> SpatialQueryFilter {
    SpatialQueryFilter::default()
}

fn ask<T>(app: &mut SceneApp, question: impl FnOnce(&SpatialQuery) -> T) -> T {
    let world = world(app);
    let mut state = SystemState::<SpatialQuery>::new(world);
    question(&state.get(world).unwrap())
}

/// Rings, cups, boxes and balls at random, and a half-space below them.
fn crowd(rng: &mut Rng) -> (SceneApp, Vec<(Entity, Collider, Transform)>) {
    let mut app = empty(&[]);
    let ring = Torus { major_radius: 1.0, minor_radius: 0.25, ..Torus::default() };
    let [ring, cup] = [ring.build(), Cup::default().build()]
        .map(|mesh| Collider::from_mesh(mesh.unwrap()).unwrap());
    let shapes = [ring, cup, cuboid([0.5, 1.0, 2.0]), Collider::ball(0.7)];
    let mut bodies = Vec::new();
    for i in 0..160 {
        let at = Vec3::from_array([(); 3].map(|()| 12.0 * rng.unit() as f32));
        let turn = Quat::from_array(rng.rotation().to_array().map(|x| x as f32)).normalize();
        let place = Transform::from_translation(at).with_rotation(turn);
        bodies.push((shapes[i % shapes.len()].clone(), place));
    }
    bodies.push((Collider::half_space(DVec3::Z), up(-14.0)));
    let spawned = bodies.into_iter().map(|(collider, place)| {
        let entity = world(&mut app).spawn((collider.clone(), place)).id();
        (entity, collider, place)
    });
    let spawned: Vec<_> = spawned.collect();
    steps(&mut app, 1);
    (app, spawned)
}

#[test]
fn a_walk_over_all_bodies_says_the_same() {
    let mut rng = Rng::new(3);
    let (mut app, bodies) = crowd(&mut rng);
    let wide = |v: Vec3| DVec3::new(v.x.into(), v.y.into(), v.z.into());
    let mut met = [0; 3];
    for _ in 0..300 {
        let from = Vec3::from_array([(); 3].map(|()| 15.0 * rng.unit() as f32));
        let along = Dir3::new(Vec3::from_array([(); 3].map(|()| rng.unit() as f32))).unwrap();
        let within = 20.0 * rng.unit().abs();
        let rays = bodies.iter().filter_map(|(entity, collider, place)| {
            let back = pose_of(place).world_from_body().inverse();
            let (origin, along) = (back.apply(wide(from)), back.apply_vector(wide(*along)));
            let hit = cast_ray_at_shape(collider.shape(), origin, along, within).unwrap()?;
            Some((hit.distance, *entity))
        });
        let mut rays: Vec<_> = rays.collect();
        rays.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = bodies.iter().filter_map(|(entity, collider, place)| {
            let here = pose_of(place).world_from_body().inverse().apply(wide(from));
            match separation_of_point(collider.shape(), here, within).unwrap() {
                Separation::Farther => None,
                Separation::Meeting => Some((0.0, *entity)),
                Separation::Apart { distance, .. } => Some((distance, *entity)),
            }
        });
        let near: Vec<_> = near.collect();
        let nearest = near.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
        let holding: Vec<Entity> = near
            .iter()
            .filter(|(distance, _)| *distance == 0.0)
            .map(|&(_, entity)| entity)
            .collect();
        let (first, hits, projected, inside) = ask(&mut app, |spatial| {
            let first = spatial.cast_ray(from, along, within, &all()).unwrap();
            let hits = spatial.ray_hits(from, along, within, &all()).unwrap();
            let projected = spatial.project_point(from, within, &all()).unwrap();
            (first, hits, projected, spatial.point_intersections(from, &all()))
        });
        assert_eq!(first.map(|hit| (hit.distance, hit.entity)), rays.first().copied());
        let hits: Vec<_> = hits.iter().map(|hit| (hit.distance, hit.entity)).collect();
        assert_eq!(hits, rays);
        assert_eq!(projected.map(|found| (found.distance, found.entity)), nearest);
        assert_eq!(inside, holding);
        met[0] += usize::from(first.is_some());
        met[1] += usize::from(projected.is_some_and(|found| !found.is_inside));
        met[2] += usize::from(!holding.is_empty());
    }
    assert!(met.iter().all(|&count| count > 10), "{met:?}");
}

#[test]
fn shapes_meet_what_they_meet_among_many() {
    let mut rng = Rng::new(4);
    let (mut app, bodies) = crowd(&mut rng);
    let mut met = 0;
    for _ in 0..60 {
        let at = Vec3::from_array([(); 3].map(|()| 12.0 * rng.unit() as f32));
        let place = Transform::from_translation(at);
        let alone = |entity: Entity| {
            let others = bodies.iter().map(|(other, ..)| *other).filter(|&other| other != entity);
            SpatialQueryFilter::from_excluded_entities(others)
        };
        let travel = Vec3::new(6.0, 2.0, -3.0);
        let (overlaps, first, each) = ask(&mut app, |spatial| {
            let each = bodies.iter().filter_map(|&(entity, ..)| {
                spatial.cast_shape(&unit(), &place, travel, &alone(entity)).unwrap()
            });
            let each: Vec<ShapeHitData> = each.collect();
            let overlaps = spatial.shape_intersections(&unit(), &place, &all()).unwrap();
            (overlaps, spatial.cast_shape(&unit(), &place, travel, &all()).unwrap(), each)
        });
        let initially = each.iter().filter(|hit| hit.distance == 0.0).map(|hit| hit.entity);
        assert_eq!(overlaps, initially.collect::<Vec<_>>());
        let nearest = each.iter().map(|hit| hit.distance).fold(f64::INFINITY, f64::min);
        let distance = first.map_or(f64::INFINITY, |hit| hit.distance);
        assert!((distance - nearest).abs() < 1e-5 || distance == nearest, "{distance} {nearest}");
        met += usize::from(first.is_some());
    }
    assert!(met > 20, "{met}");
}

#[test]
fn a_system_sees_what_has_moved_come_and_gone_since() {
    let mut app = empty(&[]);
    let beside = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let [near, far] = [beside(7.0), up(-5.0)].map(|at| world(&mut app).spawn((unit(), at)).id());
    steps(&mut app, 1);
    let down = |spatial: &SpatialQuery| {
        let hit = spatial.cast_ray(Vec3::new(0.0, 0.0, 50.0), Dir3::NEG_Z, 100.0, &all()).unwrap();
        hit.map(|hit| (hit.entity, (1e6 * hit.distance).round() / 1e6))
    };
    let mut state = SystemState::<SpatialQuery>::new(world(&mut app));
    let mut first = |app: &mut SceneApp| down(&state.get(world(app)).unwrap());
    assert_eq!(first(&mut app), Some((far, 54.5)));
    assert_eq!(first(&mut app), Some((far, 54.5)));
    *world(&mut app).get_mut::<Transform>(near).unwrap() = beside(0.0);
    assert_eq!(first(&mut app), Some((near, 49.5)));
    *world(&mut app).get_mut::<Transform>(near).unwrap() = beside(7.0);
    assert_eq!(first(&mut app), Some((far, 54.5)));
    let third = world(&mut app).spawn((unit(), up(3.0))).id();
    steps(&mut app, 1);
    assert_eq!(first(&mut app), Some((third, 46.5)));
    world(&mut app).entity_mut(near).insert(cuboid([20.0, 1.0, 9.0]));
    steps(&mut app, 1);
    assert_eq!(first(&mut app), Some((near, 45.5)));
    for body in [near, third] {
        world(&mut app).despawn(body);
    }
    assert_eq!(first(&mut app), Some((far, 54.5)));
    world(&mut app).despawn(far);
    assert_eq!(first(&mut app), None);
}

/// A body that is asked about no longer for a while moves none of the others, and comes back.
#[test]
fn a_system_sees_what_is_disabled_and_comes_back() {
    type Change = fn(&mut EntityWorldMut);
    let changes: [(Change, Change); 2] = [
        (|body| _ = body.insert(Disabled), |body| _ = body.remove::<Disabled>()),
        (
            |body| _ = body.remove::<LinearVelocity>(),
            |body| _ = body.insert(LinearVelocity::default()),
        ),
    ];
    for (away, back) in changes {
        let mut app = empty(&[]);
        let [upper, lower] = [0.0, -5.0].map(|z| world(&mut app).spawn((unit(), up(z))).id());
        steps(&mut app, 1);
        let mut state = SystemState::<SpatialQuery>::new(world(&mut app));
        let mut first = |app: &mut SceneApp| {
            let spatial = state.get(world(app)).unwrap();
            let from = Vec3::new(0.0, 0.0, 50.0);
            spatial.cast_ray(from, Dir3::NEG_Z, 100.0, &all()).unwrap().map(|hit| hit.entity)
        };
        assert_eq!(first(&mut app), Some(upper));
        away(&mut world(&mut app).entity_mut(upper));
        assert_eq!([first(&mut app), first(&mut app)], [Some(lower); 2]);
        back(&mut world(&mut app).entity_mut(upper));
        assert_eq!(first(&mut app), Some(upper));
    }
}

/// A tree is made again where a body moves, comes or leaves; a step alone is no reason.
#[test]
fn a_step_in_which_nobody_comes_or_leaves_changes_no_body() {
    #[derive(Resource, Default)]
    struct Changes(Vec<bool>);
    let mut app = empty(&[]);
    let note = |bodies: Res<Bodies>, mut changes: ResMut<Changes>| {
        changes.0.push(bodies.is_changed());
    };
    world(&mut app).init_resource::<Changes>();
    app.app_mut().add_systems(CrannyStep, note.in_set(StepSystems::Draw));
    let body = world(&mut app).spawn((unit(), up(0.0))).id();
    steps(&mut app, 3);
    world(&mut app).despawn(body);
    steps(&mut app, 4);
    let changes = &world(&mut app).resource::<Changes>().0;
    assert_eq!(*changes, [true, false, false, true, true, false, false]);
}

/// Boxes whose upper sides lie in one plane are met at one distance: the lowest id is the first.
#[test]
fn of_bodies_that_are_met_at_once_the_lowest_id_is_the_first() {
    let mut rng = Rng::new(4);
    for _ in 0..20 {
        let mut app = empty(&[]);
        let height = 10.0 * rng.unit() as f32;
        let mut place = || Transform::from_xyz(0.4 * rng.unit() as f32, 0.0, height);
        let bodies: Vec<Entity> =
            (0..20).map(|_| world(&mut app).spawn((unit(), place())).id()).collect();
        steps(&mut app, 1);
        let from = Vec3::new(0.0, 0.0, 31.7);
        let first = ask(&mut app, |spatial| spatial.cast_ray(from, Dir3::NEG_Z, 100.0, &all()));
        assert_eq!(first.unwrap().map(|hit| hit.entity), Some(bodies[0]));
    }
}

#[test]
fn rays_from_afar_meet_what_is_near_and_what_is_far() {
    for far in [1e3_f32, 1e9, 1e14, 1e16, 1e20] {
        let mut app = empty(&[]);
        let near = world(&mut app).spawn((cuboid([8.0; 3]), up(0.0))).id();
        let large = Collider::ball(f64::from(far) / 4.0);
        let away = world(&mut app).spawn((large, up(far))).id();
        steps(&mut app, 1);
        let first = |app: &mut SceneApp, z: f32, but: Entity| {
            let filter = SpatialQueryFilter::from_excluded_entities([but]);
            let from = Vec3::new(0.0, 0.0, z);
            let hit = ask(app, |spatial| {
                spatial.cast_ray(from, Dir3::Z, f64::INFINITY, &filter).unwrap()
            });
            hit.map(|hit| (hit.entity, hit.distance / f64::from(far)))
        };
        let (met, share) = first(&mut app, -10.0, near).unwrap();
        assert!(met == away && (share - 0.75).abs() < 0.02, "{far}: {share}");
        let (met, share) = first(&mut app, -far, away).unwrap();
        assert!(met == near && (share - 1.0).abs() < 0.02, "{far}: {share}");
    }
}

/// Between two questions of one run, bodies may move as well.
#[test]
fn what_moves_between_two_questions_of_a_run_is_seen() {
    type Both<'w, 's> = ParamSet<
        'w,
        's,
        (SpatialQuery<'static, 'static>, Query<'static, 'static, &'static mut Transform>),
    >;
    let mut app = empty(&[]);
    let body = world(&mut app).spawn((unit(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    steps(&mut app, 1);
    let moved = move |mut both: Both| {
        let first = |spatial: SpatialQuery| {
            let hit = spatial.cast_ray(Vec3::new(0.0, 0.0, 9.0), Dir3::NEG_Z, 100.0, &all());
            hit.unwrap().map(|hit| hit.distance)
        };
        let before = first(both.p0());
        both.p1().get_mut(body).unwrap().translation.x = 0.0;
        let below = first(both.p0());
        both.p1().get_mut(body).unwrap().translation.y = 7.0;
        (before, below, first(both.p0()))
    };
    let found = world(&mut app).run_system_once(moved).unwrap();
    assert_eq!(found, (None, Some(8.5), None));
}

#[test]
fn what_lies_wholly_in_another_is_contained() {
    let mut app = empty(&[]);
    let mut spawn = |collider: Collider, z: f32| world(&mut app).spawn((collider, up(z))).id();
    let hall = spawn(cuboid([9.0, 9.0, 9.0]), 0.0);
    let globe = spawn(Collider::ball(3.0), 0.0);
    let [inner, across] = [spawn(unit(), 0.5), spawn(unit(), 4.5)];
    let pearl = spawn(Collider::ball(0.1), -1.0);
    steps(&mut app, 1);
    let contains = |spatial: &SpatialQuery, outer, inner| spatial.contains(outer, inner);
    let held = ask(&mut app, |spatial| {
        [
            (hall, inner),
            (hall, across),
            (inner, hall),
            (hall, globe),
            (globe, inner),
            (globe, across),
        ]
        .map(|(outer, inner)| contains(spatial, outer, inner).unwrap())
    });
    assert_eq!(held, [true, false, false, true, true, false]);
    // From inside it may touch the surface.
    for (z, is_contained) in [(4.0, true), (4.01, false)] {
        *world(&mut app).get_mut::<Transform>(inner).unwrap() = up(z);
        assert_eq!(ask(&mut app, |spatial| contains(spatial, hall, inner)), Ok(is_contained));
    }
    let refused = ask(&mut app, |spatial| contains(spatial, globe, pearl).unwrap_err());
    assert!(refused.to_string().contains("must be a mesh"), "{refused}");
}
