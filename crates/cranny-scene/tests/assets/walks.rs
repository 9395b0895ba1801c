//! The worlds of many bodies: how large they are, that they start apart, and that those who walk
//! through them on paths pass through nothing that stands still.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::{Aabb, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_impact::{Impact, ImpactOptions, Motion, Moving, time_of_impact};
use cranny_world::description::{BodyDescription, BodyKind, SceneDescription};

use crate::{meeting, scene};

fn model(mesh: &Mesh) -> Model {
    Model::build(mesh.clone(), &BuildOptions::default()).unwrap().0
}

fn bounds(body: &BodyDescription) -> Aabb {
    let world = body.pose.world_from_body();
    Aabb::of_points(body.collision.vertices().iter().map(|&p| world.apply(p)))
}

/// Every leg of every path, held against every body that stands still.
fn assert_meets_nothing_fixed(scene: &SceneDescription) {
    let mut models: BTreeMap<*const Mesh, Model> = BTreeMap::new();
    let still: Vec<&BodyDescription> =
        scene.bodies.iter().filter(|b| b.kind == BodyKind::Fixed && !b.sensor).collect();
    for body in &still {
        let key = Arc::as_ptr(&body.collision);
        models.entry(key).or_insert_with(|| model(&body.collision));
    }
    let walkers = scene.bodies.iter().filter_map(|body| Some((body, body.path.as_ref()?)));
    let mut legs = 0;
    for (walker, path) in walkers {
        let moving = model(&walker.collision);
        for pair in path.keyframes().windows(2) {
            let motion = Motion::between(pair[0].pose, pair[1].pose, DVec3::ZERO);
            // What is tested is what is followed.
            let half = path.pose_at(0.5 * (pair[0].time + pair[1].time));
            assert!(near(&motion.pose_at(0.5), &half), "{}: {half:?}", walker.name);
            legs += 1;
            for body in &still {
                let other = &models[&Arc::as_ptr(&body.collision)];
                let impact = time_of_impact(
                    Moving { model: &moving, motion },
                    Moving { model: other, motion: Motion::at_rest(body.pose) },
                    &ImpactOptions::within(1e-4),
                );
                let (impact, _) = impact.unwrap();
                assert!(
                    impact == Impact::None,
                    "{} meets {} from {} s on: {impact:?}",
                    walker.name,
                    body.name,
                    pair[0].time
                );
            }
        }
    }
    assert!(legs >= 4, "{legs}");
}

fn near(a: &Pose, b: &Pose) -> bool {
    let turned = (a.rotation.conjugate() * b.rotation).xyz().length();
    a.translation.distance(b.translation) + turned < 1e-9
}

/// No two bodies that may meet do so at the start.
fn assert_starts_apart(scene: &SceneDescription) {
    let boxes: Vec<Aabb> = scene.bodies.iter().map(bounds).collect();
    for (b, q) in scene.bodies.iter().enumerate() {
        for (a, p) in scene.bodies[..b].iter().enumerate() {
            let moves = p.kind == BodyKind::Dynamic || q.kind == BodyKind::Dynamic;
            let excluded = scene.excluded_pairs.contains(&(a, b));
            if moves && !excluded && boxes[a].overlaps(&boxes[b]) {
                let meets =
                    meeting::surfaces_meet((&p.collision, &p.pose), (&q.collision, &q.pose));
                assert!(!meets, "{} meets {}", p.name, q.name);
            }
        }
    }
}

fn triangles(scene: &SceneDescription) -> usize {
    scene.bodies.iter().map(|body| body.collision.faces().len()).sum()
}

#[test]
fn the_house_is_large_and_its_visitor_passes_through_no_wall() {
    let house = scene("house.ron").description;
    assert!(house.bodies.len() >= 300, "{} bodies", house.bodies.len());
    assert!(triangles(&house) >= 60_000, "{} triangles", triangles(&house));
    assert_starts_apart(&house);
    assert_meets_nothing_fixed(&house);
}

#[test]
fn an_arm_reaches_into_the_automobile_and_touches_the_steering_wheel_alone() {
    let car = scene("automobile.ron").description;
    assert_starts_apart(&car);
    assert_meets_nothing_fixed(&car);
}

#[test]
fn a_drone_dives_through_the_hatches_of_the_submarine() {
    let boat = scene("submarine.ron").description;
    assert_starts_apart(&boat);
    assert_meets_nothing_fixed(&boat);
}

#[test]
fn crowds_start_apart() {
    for name in ["golf_balls.ron", "dented_cans.ron", "moving_among_stationary.ron"] {
        assert_starts_apart(&scene(name).description);
    }
    let crowd = scene("moving_among_stationary.ron").description;
    let still = crowd.bodies.iter().filter(|body| body.kind == BodyKind::Fixed).count();
    assert_eq!((still, crowd.bodies.len() - still), (295, 100));
    assert_meets_nothing_fixed(&scene("triggers_only.ron").description);
}
