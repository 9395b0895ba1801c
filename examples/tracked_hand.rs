//! A hand that a camera tracks: poses come sixty times a second, shake by 2 mm, and some are
//! missing. It waits just above a cup's rim, and then lays itself on it. Metres; z is up.
//!
//! `cargo run --example tracked_hand --features ecs`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::exact::{DVec3, Pose};
use cranny::shapes::{Cuboid, Cup};
use cranny::world::Random;
use cranny::world::description::{OneEuro, TrackerSettings};

const STEP: f64 = 1.0 / 60.0;
const JITTER: f64 = 0.002;

/// How high the hand's middle really is: its lower face is 0.5 mm above the rim, then 4 mm below.
fn height(seconds: f64) -> f64 {
    0.1105 - 0.0045 * (seconds - 3.0).clamp(0.0, 1.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let cup = Cup { radius: 0.045, height: 0.1, wall: 0.006, floor: 0.006, ..Cup::default() };
    let hand = Cuboid { size: [0.08, 0.18, 0.02] };
    // What it shakes by is smoothed to less than a millimetre.
    let smoothing = Some(OneEuro { min_cutoff: 0.5, per_speed: 1.0 });
    let settings = TrackerSettings { smoothing, ..TrackerSettings::default() };

    let mut app = App::new();
    let available = [EffectKind::Trigger, EffectKind::Tracking];
    app.add_plugins(CrannyPlugins::new(STEP)?.available(&available)?);
    let world = app.world_mut();
    let cup = world.spawn(Collider::from_mesh(cup.build()?)?).id();
    let body = (RigidBody::Kinematic, Collider::from_mesh(hand.build()?)?);
    let effects = (Trigger, Tracking { tolerance: 0.001 }, Tracker::new(settings)?);
    let hand = world.spawn((body, effects, Transform::from_xyz(0.0, 0.0, 0.2))).id();
    let mut starts = Vec::new();
    let mut random = Random::new(3);
    let (mut below, mut worst) = (0, 0.0_f64);
    for step in 0..300 {
        let seconds = f64::from(step) * STEP;
        let shaken = JITTER * random.in_ball();
        let place = DVec3::Z * height(seconds) + shaken;
        below += usize::from(step < 180 && place.z < 0.11);
        if random.below(10) > 0 {
            let mut tracker = world.get_mut::<Tracker>(hand).ok_or("it is there")?;
            tracker.report(TrackedPose { time: seconds, pose: Pose::at(place) })?;
        }
        world.run_schedule(CrannyStep);
        let shown = world.get::<Transform>(hand).ok_or("it is there")?.translation.as_dvec3();
        if (60..180).contains(&step) {
            worst = worst.max(shown.distance(DVec3::Z * height(seconds)));
        }
        let mut messages = world.resource_mut::<Messages<CollisionStart>>();
        starts.extend(messages.drain().map(|start| (seconds, [start.body, start.other])));
    }
    println!("{below} poses were in the rim while the hand was above it");
    println!("smoothed they are off by {:.2} mm at most", 1e3 * worst);
    for (seconds, _) in &starts {
        println!("the hand touches the cup after {seconds:.2} s");
    }
    assert!(below > 20 && worst < 0.001);
    assert!(matches!(starts[..], [(at, [a, b])] if at > 3.0 && a == cup && b == hand));
    Ok(())
}
