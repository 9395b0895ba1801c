//! What an app asks about the bodies around a place.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use bevy_math::{Dir3, Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_shapes::{Cup, Torus};

use crate::build::{cuboid, empty, steps, unit, up, world};

/// A ring in the plane of x and y, and a floor one below it.
struct Room {
    app: SceneApp,
    ring: Entity,
    floor: Entity,
}

fn ring() -> Collider {
    let torus = Torus { major_radius: 1.0, minor_radius: 0.25, ..Torus::default() };
    Collider::from_mesh(torus.build().unwrap()).unwrap()
}

fn room() -> Room {
    let mut app = empty(&[]);
    let in_second_layer = CollisionLayers::new(2, u32::MAX);
    let ring = world(&mut app).spawn((ring(), up(0.0), in_second_layer)).id();
    let floor = world(&mut app).spawn((cuboid([9.0, 9.0, 1.0]), up(-1.5))).id();
    steps(&mut app, 1);
    Room { app, ring, floor }
}

impl Room {
    fn ask<T>(&mut self, question: impl FnOnce(&SpatialQuery) -> T) -> T {
        let world = world(&mut self.app);
        let mut state = SystemState::<SpatialQuery>::new(world);
        question(&state.get(world).unwrap())
    }
}

fn all() -> SpatialQueryFilter {
    SpatialQueryFilter::default()
}

#[test]
fn a_ray_passes_through_the_hole_and_meets_the_wire() {
    let mut room = room();
    let [ring, floor] = [room.ring, room.floor];
    let down = |x: f32, filter: SpatialQueryFilter| {
        move |spatial: &SpatialQuery| {
            spatial.cast_ray(Vec3::new(x, 0.0, 5.0), Dir3::NEG_Z, 100.0, &filter).unwrap()
        }
    };
    let through = room.ask(down(0.0, all())).unwrap();
    assert_eq!((through.entity, through.distance, through.normal), (floor, 6.0, DVec3::Z));
    let on_wire = room.ask(down(1.0, all())).unwrap();
    assert_eq!((on_wire.entity, on_wire.from_inside), (ring, false));
    assert!((on_wire.distance - 4.75).abs() < 1e-6, "{on_wire:?}");
    let without = SpatialQueryFilter::from_excluded_entities([ring]);
    assert_eq!(room.ask(down(1.0, without)).unwrap().entity, floor);
    assert_eq!(room.ask(down(1.0, SpatialQueryFilter::from_mask(1))).unwrap().entity, floor);
    assert_eq!(room.ask(down(0.0, SpatialQueryFilter::from_mask(2))), None);
    let hits = room.ask(|spatial| {
        spatial.ray_hits(Vec3::new(1.0, 0.0, 5.0), Dir3::NEG_Z, 100.0, &all()).unwrap()
    });
    assert_eq!(hits.iter().map(|hit| hit.entity).collect::<Vec<_>>(), [ring, floor]);
}

#[test]
fn answers_are_of_the_transforms_as_they_are_now() {
    let mut room = room();
    let ring = room.ring;
    world(&mut room.app).get_mut::<Transform>(ring).unwrap().translation.x = 1.0;
    let down = |spatial: &SpatialQuery| {
        spatial.cast_ray(Vec3::new(0.0, 0.0, 5.0), Dir3::NEG_Z, 100.0, &all()).unwrap()
    };
    assert_eq!(room.ask(down).unwrap().entity, ring);
}

#[test]
fn a_shape_falls_through_the_hole_and_a_wider_one_stays() {
    let mut room = room();
    let [ring, floor] = [room.ring, room.floor];
    let fall = |shape: Collider, filter: SpatialQueryFilter| {
        move |spatial: &SpatialQuery| {
            let down = Vec3::new(0.0, 0.0, -1_000.0); // in one go
            spatial.cast_shape(&shape, &up(5.0), down, &filter).unwrap()
        }
    };
    let small = room.ask(fall(unit(), all())).unwrap();
    assert_eq!((small.entity, small.normal), (floor, Some(DVec3::Z)));
    assert!((small.distance - 5.5).abs() < 1e-5, "{small:?}");
    let wide = room.ask(fall(cuboid([1.2, 1.2, 1.0]), all())).unwrap();
    assert_eq!(wide.entity, ring);
    assert!(wide.point.unwrap().z.abs() < 0.26 && wide.distance < 4.5, "{wide:?}");
    let without = SpatialQueryFilter::from_excluded_entities([ring, floor]);
    assert_eq!(room.ask(fall(unit(), without)), None);
    // What it meets already it does not pass.
    let met = room.ask(|spatial| {
        spatial.cast_shape(&unit(), &up(-1.4), Vec3::new(0.0, 0.0, 3.0), &all()).unwrap()
    });
    assert_eq!(met.map(|hit| (hit.entity, hit.distance)), Some((floor, 0.0)));
}

#[test]
fn shapes_and_points_overlap_solids_and_not_hulls() {
    let mut room = room();
    let [ring, floor] = [room.ring, room.floor];
    let at = |shape: Collider, place: Transform| {
        move |spatial: &SpatialQuery| spatial.shape_intersections(&shape, &place, &all()).unwrap()
    };
    assert_eq!(room.ask(at(unit(), up(0.0))), []); // in the hole
    assert_eq!(room.ask(at(unit(), up(-0.75))), [floor]);
    assert_eq!(room.ask(at(cuboid([1.0, 3.0, 2.5]), up(0.0))), [ring, floor]);
    let inside = |p: Vec3| move |spatial: &SpatialQuery| spatial.point_intersections(p, &all());
    assert_eq!(room.ask(inside(Vec3::ZERO)), []);
    assert_eq!(room.ask(inside(Vec3::new(1.0, 0.0, 0.0))), [ring]);
    assert_eq!(room.ask(inside(Vec3::new(1.0, 0.0, -1.5))), [floor]);
}

#[test]
fn the_nearest_point_and_the_distance_are_those_of_the_surfaces() {
    let mut room = room();
    let [ring, floor] = [room.ring, room.floor];
    let nearest = |p: Vec3, within: f64| {
        move |spatial: &SpatialQuery| spatial.project_point(p, within, &all()).unwrap()
    };
    let centre = room.ask(nearest(Vec3::ZERO, 10.0)).unwrap();
    assert!((centre.distance - 0.75).abs() < 0.01 && !centre.is_inside, "{centre:?}");
    assert_eq!(room.ask(nearest(Vec3::ZERO, 0.5)), None);
    let within = room.ask(nearest(Vec3::new(1.0, 0.0, 0.0), 10.0)).unwrap();
    assert_eq!((within.entity, within.distance, within.is_inside), (ring, 0.0, true));

    let apart = room.ask(|spatial| spatial.closest_points(ring, floor).unwrap());
    assert!((apart.distance - 0.75).abs() < 1e-6 && !apart.overlap, "{apart:?}");
    let [p, q] = apart.points.unwrap();
    assert!((p - q - 0.75 * DVec3::Z).length() < 1e-6, "{apart:?}");
    assert!(!room.ask(|spatial| spatial.intersects(ring, floor).unwrap()));

    *world(&mut room.app).get_mut::<Transform>(ring).unwrap() = up(-0.8);
    let crossing = room.ask(|spatial| spatial.closest_points(ring, floor).unwrap());
    assert_eq!((crossing.distance, crossing.points, crossing.overlap), (0.0, None, true));
}

#[test]
fn bodies_that_fly_meet_when_they_do() {
    let mut room = room();
    let [ring, floor] = [room.ring, room.floor];
    let falls = LinearVelocity(Vec3::new(0.0, 0.0, -3.0));
    world(&mut room.app).entity_mut(ring).insert(falls);
    let meet = |a, b, seconds| {
        move |spatial: &SpatialQuery| spatial.time_of_impact(a, b, seconds).unwrap()
    };
    let TimeOfImpact::At(time) = room.ask(meet(ring, floor, 1.0)) else { panic!("they meet") };
    assert!((time - 0.25).abs() < 1e-5, "{time}");
    assert_eq!(room.ask(meet(floor, ring, 0.2)), TimeOfImpact::None);
    let a_box = (unit(), Transform::from_xyz(20.0, 0.0, 0.0));
    let stranger = world(&mut room.app).spawn(a_box).id();
    let refused = room.ask(|spatial| spatial.intersects(ring, stranger)).unwrap_err();
    assert!(refused.to_string().contains("is no body"), "{refused}");
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut room = room();
    let nan = Vec3::new(f32::NAN, 0.0, 0.0);
    let ray = room.ask(|spatial| spatial.cast_ray(nan, Dir3::X, 1.0, &all()).unwrap_err());
    assert!(ray.to_string().contains("origin"), "{ray}");
    let cast = |spatial: &SpatialQuery| spatial.cast_shape(&unit(), &up(0.0), nan, &all());
    assert!(room.ask(cast).unwrap_err().to_string().contains("travel"));
    let away = Transform::from_translation(nan);
    let cast = |spatial: &SpatialQuery| spatial.cast_shape(&unit(), &away, Vec3::X, &all());
    assert!(room.ask(cast).unwrap_err().to_string().contains("pose"));
    let overlaps = |spatial: &SpatialQuery| spatial.shape_intersections(&unit(), &away, &all());
    assert!(room.ask(overlaps).unwrap_err().to_string().contains("pose"));
    let point = room.ask(|spatial| spatial.project_point(nan, 1.0, &all()).unwrap_err());
    assert!(point.to_string().contains("point"), "{point}");
}

/// From outside a cup to its axis, in one go.
#[test]
fn no_cast_passes_a_thin_wall() {
    let mut app = empty(&[]);
    let cup = Collider::from_mesh(Cup::default().build().unwrap()).unwrap();
    let cup = world(&mut app).spawn((cup, up(0.0))).id();
    steps(&mut app, 1);
    let mut room = Room { app, ring: cup, floor: cup };
    let pin = cuboid([0.02, 0.02, 0.02]);
    let mut hits = 0;
    for i in 0..64 {
        let turn = Quat::from_rotation_z(i as f32 * 0.1);
        let from = Transform::from_translation(turn * Vec3::new(4.0, 0.0, 0.6));
        let travel = turn * Vec3::new(-4.0, 0.0, 0.0); // to the axis, through the wall
        let hit = room.ask(|spatial| spatial.cast_shape(&pin, &from, travel, &all()).unwrap());
        hits += usize::from(hit.is_some_and(|hit| hit.distance < 3.9));
    }
    assert_eq!(hits, 64);
}
