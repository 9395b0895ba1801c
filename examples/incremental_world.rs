//! Three balls fly past a ring: one through its hole without touching it, one against it, and one
//! so far beside it that the pair is never queried. The world reports what began and what ended.
//!
//! `cargo run --example incremental_world`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use cranny::prelude::*;
use cranny::shapes::{Sphere, Torus};
use cranny::world::description::{BodyKind, Effect};
use cranny::world::{BodyId, BodySpec, PairEventKind};
use std::error::Error;

const STEP: f64 = 1.0 / 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    let model = |mesh| Ok::<_, Box<dyn Error>>(Model::build(mesh, &BuildOptions::default())?.0);
    let ring = model(Torus::default().build()?)?;
    let ball = model(Sphere { radius: 0.4, ..Sphere::default() }.build()?)?;

    let mut world = World::new();
    // All pairs report whether they touch; only one of them also where and how deep.
    world.set_scene_effects(&[Effect::TRIGGER])?;
    let ring =
        world.insert(BodySpec { kind: BodyKind::Fixed, ..BodySpec::new("ring", ring.clone()) })?;
    let mut throw = |name: &str, start: DVec3, velocity: DVec3| -> Result<_, Box<dyn Error>> {
        let pose = Pose::at(start);
        let body = world.insert(BodySpec { pose, ..BodySpec::new(name, ball.clone()) })?;
        Ok((body, start, velocity))
    };
    let down = DVec3::new(0.0, 0.0, -3.0);
    let flights: [(BodyId, DVec3, DVec3); 3] = [
        throw("through", DVec3::new(0.0, 0.0, 2.0), down)?,
        throw("against", DVec3::new(1.4, 0.0, 2.0), down)?,
        throw("beside", DVec3::new(0.0, 2.3, 2.0), down)?,
    ];
    world.set_pair_effects(ring, flights[1].0, &[Effect::Contacts { margin: 0.05 }])?;

    let (mut asked, mut triangle_tests) = (0, 0);
    for step in 0..80 {
        let time = f64::from(step) * STEP;
        for &(body, start, velocity) in &flights {
            world.set_pose(body, Pose::at(start + time * velocity))?;
        }
        let report = world.step()?;
        let name = |body| world.name(body).unwrap_or("unknown body");
        for event in &report.events {
            let verb = match event.kind {
                PairEventKind::Began => "touches",
                PairEventKind::Ended => "has left",
                _ => continue,
            };
            println!("{time:.3} s: '{}' {verb} the {}", name(event.b), name(event.a));
        }
        if let Some(deepest) = report.stats.deepest.filter(|_| step % 5 == 0) {
            println!("{time:.3} s: '{}' is {:.3} deep in the ring", name(deepest.b), deepest.depth);
        }
        asked += report.stats.queried_pairs;
        triangle_tests += report.stats.counters.triangle_tests;
    }
    println!("80 steps of 6 pairs: {asked} queries, {triangle_tests} tests of triangles");
    Ok(())
}
