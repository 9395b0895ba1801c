//! Ls let go above a slab, stuck in it, and wholly inside: all end on top of it, in no haste.

use cranny_ecs::RunOptions;
use cranny_exact::{DVec3, Pose};

use crate::overlap::Judge;
use crate::run::{asset, body, lowest, tilt, watch};

/// Where they end: on the slab's top, z = 0. The solver lets bodies overlap by 0.001 of what it
/// takes for a metre (0.17 here) and holds them within 0.02 of that.
const REST: f64 = 4e-3;

/// Degrees from the start's pose, ever. The way out is straight up for all of them: upright Ls are
/// nearest to the top by 0.3 of 1 and by 0.8 of 1.2 (down, they would have to go by 1 + 1 − 0.8),
/// the one inside by 0.65 of 0.85. So nothing has a reason to turn.
const TILT: f64 = 2.0;

/// Metres a second, of any corner: what nobody calls an explosion.
const SPEED: f64 = 2.0;

/// The end of a free fall of 0.3: √(2 · 9.81 · 0.3) = 2.426, and one step's more.
const FALL: f64 = 2.426 + 9.81 / 240.0;

/// What became of an L.
struct Came {
    reported: String,
    height: f64,
    drift: f64,
    overlap: f64,
    /// Degrees, at the end and ever.
    tilts: [f64; 2],
    /// Of any corner.
    fastest: f64,
    /// What that may be.
    limit: f64,
}

/// Runs the scene and returns what became of the Ls of these names, which start so deep in the
/// slab.
fn run(bodies: &[(&str, f64)], slab: &str) -> Vec<Came> {
    let mut scene = asset("l_on_slab.ron").description;
    scene
        .bodies
        .retain(|body| body.name == slab || bodies.iter().any(|(name, _)| body.name == *name));
    let judge = Judge::of(&scene);
    let slab = body(&scene, slab);
    // How deep they start, by the exact query: else the test would show nothing.
    let start: Vec<_> = scene.bodies.iter().map(|body| body.pose).collect();
    for &(name, depth) in bodies {
        let found = judge.overlap(&start, body(&scene, name), slab);
        assert!(found == depth || (found - depth).abs() < 1e-6, "{name}: {found}, not {depth}");
    }
    let bodies: Vec<usize> = bodies.iter().map(|(name, _)| body(&scene, name)).collect();

    let tilt_of = |k: usize, pose: &Pose| {
        let tilts = [DVec3::X, DVec3::Z].map(|axis| tilt(axis, &scene.bodies[k].pose, pose));
        tilts[0].max(tilts[1])
    };
    let mut before: Vec<Vec<DVec3>> = Vec::new();
    let mut fastest = vec![0.0f64; scene.bodies.len()];
    let mut tilted = vec![0.0f64; scene.bodies.len()];
    let ended = watch(&scene, &RunOptions::default(), |now| {
        let corners = |k: usize| {
            let map = now.poses[k].world_from_body();
            scene.bodies[k].collision.vertices().iter().map(|&p| map.apply(p)).collect()
        };
        let after: Vec<Vec<DVec3>> = (0..scene.bodies.len()).map(corners).collect();
        for &k in &bodies {
            if let Some(before) = before.get(k) {
                let moved = before.iter().zip(&after[k]).map(|(p, q)| p.distance(*q));
                fastest[k] = fastest[k].max(moved.fold(0.0, f64::max) / scene.step);
            }
            tilted[k] = tilted[k].max(tilt_of(k, &now.poses[k]));
        }
        before = after;
    });
    let came = bodies.iter().map(|&k| {
        let pose = &ended.poses[k];
        let height = lowest(&scene, k, pose, DVec3::Z);
        let drift = (pose.translation - scene.bodies[k].pose.translation).truncate().length();
        let overlap = judge.overlap(&ended.poses, k, slab);
        let (tilts, fastest) = ([tilt_of(k, pose), tilted[k]], fastest[k]);
        let name = &scene.bodies[k].name;
        let reported = format!(
            "{name}: lowest point {height:.5}, drifted {drift:.5}, overlap {overlap:.2e}, tilts {tilts:.3?}, fastest {fastest:.3}"
        );
        eprintln!("{reported}");
        let limit = if name.starts_with("above") { FALL } else { SPEED };
        Came { reported, height, drift, overlap, tilts, fastest, limit }
    });
    came.collect()
}

#[test]
fn whatever_the_depth_they_end_on_top() {
    let bodies = [("above", 0.0), ("shallow", 0.3), ("deep", 0.8), ("inside", f64::INFINITY)];
    for came in run(&bodies, "slab") {
        assert!(came.height.abs() < REST && came.overlap < REST, "{}", came.reported);
        assert!(came.drift < 0.02, "{}", came.reported);
        assert!(came.tilts[1] < TILT, "{}", came.reported);
        assert!(came.fastest < came.limit, "{}", came.reported);
    }
}

/// The same way out of bodies of many faces, for which the solver asks other contacts.
#[test]
fn bodies_of_many_faces_come_out_too() {
    let bodies = [("shallow_fine", 0.3), ("deep_fine", 0.8), ("inside_fine", f64::INFINITY)];
    for came in run(&bodies, "slab_fine") {
        assert!(came.height.abs() < REST && came.overlap < REST, "{}", came.reported);
        assert!(came.tilts[0] < 1.0, "{}", came.reported);
        assert!(came.fastest < came.limit, "{}", came.reported);
    }
}
