//! Dents: their volume, what follows them, who meets them.

use bevy_app::App;
use bevy_ecs::message::Messages;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Model, Repair, VertexId};
use cranny_shapes::{Floor, Sphere};
use cranny_world::description::Effect;

const STEP: f64 = 1.0 / 240.0;
const SOFT: Deformation = Deformation { hardness: 3000.0, radius: 0.4 };

fn app() -> App {
    let mut app = App::new();
    let options = PluginOptions { length_unit: Some(0.3), ..PluginOptions::default() };
    let plugins = CrannyPlugins::new(STEP).unwrap().effects(&[Effect::Response]).unwrap();
    let plugins = plugins.available(&[EffectKind::Deformation]).unwrap();
    app.add_plugins(plugins.options(&options).keep_failures());
    app
}

fn plate() -> Collider {
    let floor = Floor { size: [4.0, 4.0, 1.0], squares: [60, 60] };
    Collider::from_mesh(floor.build().unwrap()).unwrap()
}

fn ball() -> Collider {
    let sphere = Sphere { radius: 0.25, ..Sphere::default() };
    Collider::from_mesh(sphere.build().unwrap()).unwrap()
}

/// Makes steps; returns the dents.
fn run(app: &mut App, steps: usize) -> Vec<Dented> {
    let mut dents = Vec::new();
    for _ in 0..steps {
        app.world_mut().run_schedule(CrannyStep);
        app.world_mut().flush();
        dents.extend(app.world_mut().resource_mut::<Messages<Dented>>().drain());
    }
    let failed = app.world_mut().resource_mut::<Failure>().take();
    assert!(failed.is_none(), "{failed:?}");
    dents
}

fn model(app: &App, body: Entity) -> Model {
    app.world().get::<Collider>(body).unwrap().model().unwrap().clone()
}

/// By the divergence theorem, from the vertices alone.
fn volume(model: &Model) -> f64 {
    let mesh = model.mesh();
    let tetrahedra = mesh.faces().iter().map(|face| {
        let [a, b, c] = face.map(|v| mesh.position(VertexId(v)));
        a.dot(b.cross(c)) / 6.0
    });
    tetrahedra.sum()
}

fn height(app: &App, body: Entity) -> f64 {
    f64::from(app.world().get::<Transform>(body).unwrap().translation.z)
}

fn falling(from: f32, speed: f32) -> impl Bundle {
    let falls = LinearVelocity(Vec3::new(0.0, 0.0, -speed));
    (RigidBody::Dynamic, ball(), Transform::from_xyz(0.02, 0.03, from), falls, Density(10.0))
}

#[test]
fn a_ball_dents_what_it_falls_on_by_its_energy() {
    let mut app = app();
    let plate = app.world_mut().spawn((RigidBody::Fixed, plate(), SOFT)).id();
    let ball = app.world_mut().spawn(falling(1.0, 6.0)).id();
    let before = [plate, ball].map(|body| model(&app, body));
    let dents = run(&mut app, 240);
    let Dented { body, by, point, inward, depth, volume: first, energy, .. } = dents[0];
    // It may rock where it lies now.
    let lost: f64 = dents.iter().map(|dent| dent.volume).sum();
    assert!(lost < 1.02 * first, "{dents:#?}");
    assert_eq!((body, by), (plate, ball));
    assert!((inward + DVec3::Z).length() < 0.05 && point.length() < 0.1, "{:?}", dents[0]);
    // Half of what it had: a hit without a bounce turns m v into impulse, and m v² / 2 into heat.
    let mass = 10.0 * before[1].mass_properties().unwrap().volume;
    let speed = 36.0_f64 + 2.0 * 9.81 * 0.75;
    assert!(
        (energy / (0.5 * mass * speed) - 1.0).abs() < 0.1,
        "{energy} of {}",
        0.5 * mass * speed
    );
    let after = model(&app, plate);
    let integrated = volume(&before[0]) - volume(&after);
    let of_body =
        before[0].mass_properties().unwrap().volume - after.mass_properties().unwrap().volume;
    for found in [integrated, of_body] {
        assert!((found / lost - 1.0).abs() < 1e-6, "{found} {lost}");
    }
    assert!((energy / SOFT.hardness / first - 1.0).abs() < 1e-9);
    let lowest = after.mesh().vertices().iter().map(|p| p.z).filter(|z| *z > -0.5);
    let lowest = lowest.fold(0.0, f64::min);
    assert!(lowest < -0.8 * depth && lowest >= -1.02 * depth, "{lowest} {depth}");
    assert!(model(&app, ball).is_same(&before[1]), "the ball is hard");
    // What was prepared is as if the dented mesh had been.
    let options = BuildOptions { repair: Repair::None, ..BuildOptions::default() };
    let (rebuilt, _) = Model::build(after.mesh().clone(), &options).unwrap();
    assert_eq!(after.digest(), rebuilt.digest());
    assert_eq!(after.hull().triangle_count(), rebuilt.hull().triangle_count());
}

/// Contacts that somebody reads within a margin hold less than the solver had, where a body comes
/// from beyond it.
#[test]
fn readers_change_no_dent() {
    let run = |effects: &[Effect]| {
        let mut app = App::new();
        let plugins = CrannyPlugins::new(STEP).unwrap().effects(effects).unwrap();
        app.add_plugins(plugins.available(&[EffectKind::Deformation]).unwrap());
        app.world_mut().spawn((RigidBody::Fixed, plate(), SOFT));
        app.world_mut().spawn(falling(1.0, 8.0));
        let dents = run(&mut app, 60).into_iter();
        dents.map(|dent| (dent.point, dent.inward, dent.volume)).collect::<Vec<_>>()
    };
    let alone = run(&[Effect::Response]);
    assert!(!alone.is_empty());
    let read = [Effect::Response, Effect::TRIGGER, Effect::Contacts { margin: 0.0 }];
    assert_eq!(run(&read), alone);
}

#[test]
fn what_comes_later_lies_in_the_dent() {
    let mut app = app();
    let plate = app.world_mut().spawn((RigidBody::Fixed, plate(), SOFT)).id();
    let first = app.world_mut().spawn(falling(1.0, 8.0)).id();
    let dents = run(&mut app, 120);
    assert!(dents[1..].iter().all(|dent| dent.depth < 0.02 * dents[0].depth), "{dents:?}");
    app.world_mut().despawn(first);
    let inside = app.world_mut().spawn(falling(0.3, 0.0)).id();
    let beside = (RigidBody::Dynamic, ball(), Transform::from_xyz(1.2, 1.2, 0.3));
    let beside = app.world_mut().spawn(beside).id();
    let soft = run(&mut app, 600);
    assert!(soft.len() < 8 && soft.iter().all(|d| d.depth < 0.1 * dents[0].depth), "{soft:?}");
    let lower = height(&app, beside) - height(&app, inside);
    assert!(
        lower > 0.5 * dents[0].depth && lower < 1.1 * dents[0].depth,
        "{lower} {}",
        dents[0].depth
    );
    assert!((height(&app, beside) - 0.25).abs() < 0.01);
    assert!(app.world().get::<Collider>(plate).is_some());
}

#[test]
fn a_body_that_is_dented_weighs_what_it_weighed() {
    let mut app = app();
    let hard = Floor { size: [4.0, 4.0, 1.0], squares: [2, 2] };
    let hard = Collider::from_mesh(hard.build().unwrap()).unwrap();
    app.world_mut().spawn((RigidBody::Fixed, hard));
    let sphere = Sphere { radius: 0.25, segments: 96, rings: 48 };
    let soft = Collider::from_mesh(sphere.build().unwrap()).unwrap();
    let falls = (LinearVelocity(Vec3::new(0.0, 0.0, -8.0)), Density(10.0));
    let yields = Deformation { hardness: 3000.0, radius: 0.2 };
    let soft = (RigidBody::Dynamic, soft, Transform::from_xyz(0.4, 0.3, 1.0), falls, yields);
    let body = app.world_mut().spawn(soft).id();
    let mass = |app: &App| {
        let bodies = app.world().resource::<RigidBodies>();
        let index = bodies.index(app.world().get::<Body>(body).unwrap().id).unwrap();
        bodies.simulation().mass(index)
    };
    run(&mut app, 1);
    let before = (mass(&app), volume(&model(&app, body)));
    let dents = run(&mut app, 120);
    assert!(!dents.is_empty() && dents.iter().all(|dent| dent.body == body), "{dents:?}");
    let lost: f64 = dents.iter().map(|dent| dent.volume).sum();
    let after = (mass(&app), volume(&model(&app, body)));
    assert!(((before.1 - after.1) / lost - 1.0).abs() < 1e-6, "{before:?} {after:?} {lost}");
    assert!(lost > 1e-3 * before.1 && (after.0 / before.0 - 1.0).abs() < 1e-5, "{after:?}");
}

#[test]
fn two_that_yield_share_by_their_hardness() {
    let mut app = app();
    let soft = Deformation { hardness: 3000.0, radius: 0.2 };
    let harder = Deformation { hardness: 9000.0, ..soft };
    let cube = Floor { size: [1.0; 3], squares: [24, 24] };
    let cube = Collider::from_mesh(cube.build().unwrap()).unwrap();
    app.world_mut().insert_resource(Gravity(DVec3::ZERO));
    let lower = (RigidBody::Dynamic, cube, Transform::IDENTITY, Density(10.0), soft);
    let lower = app.world_mut().spawn(lower).id();
    let sphere = Sphere { radius: 0.25, segments: 96, rings: 48 };
    let sphere = Collider::from_mesh(sphere.build().unwrap()).unwrap();
    let comes = (Transform::from_xyz(0.0, 0.0, 0.5), LinearVelocity(Vec3::new(0.0, 0.0, -6.0)));
    let upper = (RigidBody::Dynamic, sphere, comes, Density(10.0), harder);
    let upper = app.world_mut().spawn(upper).id();
    let dents = run(&mut app, 60);
    let of = |body| dents.iter().find(|dent| dent.body == body).expect("both yield");
    let (soft, hard) = (of(lower), of(upper));
    assert!((soft.energy / hard.energy - 3.0).abs() < 1e-6, "{dents:?}");
    assert!((soft.inward + hard.inward).length() < 1e-9 && soft.inward.z < -0.9);
}

#[test]
fn a_thin_sheet_yields_by_less_than_its_thickness() {
    let mut app = app();
    let sheet = Floor { size: [4.0, 4.0, 0.05], squares: [60, 60] };
    let sheet = Collider::from_mesh(sheet.build().unwrap()).unwrap();
    app.world_mut().spawn((RigidBody::Fixed, sheet, SOFT));
    app.world_mut().spawn(falling(1.0, 30.0));
    let dents = run(&mut app, 20);
    assert!((dents[0].depth - 0.02).abs() < 1e-6, "{dents:?}");
}

#[test]
fn a_body_of_several_colliders_is_not_dented_silently() {
    let mut app = app();
    let body = app.world_mut().spawn((RigidBody::Fixed, SOFT, Name::new("tray"))).id();
    app.world_mut().spawn((plate(), Transform::IDENTITY, ChildOf(body)));
    app.world_mut().spawn(falling(0.5, 6.0));
    for _ in 0..40 {
        app.world_mut().run_schedule(CrannyStep);
    }
    let failed = app.world_mut().resource_mut::<Failure>().take().expect("it was hit");
    assert!(failed.to_string().contains("body 'tray'"), "{failed}");
    assert!(failed.to_string().contains("several colliders"), "{failed}");
}
