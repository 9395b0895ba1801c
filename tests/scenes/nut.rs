//! A nut on its bolt: it runs, and says how far it turned and how far it left the helix.

use std::f64::consts::TAU;

use cranny_ecs::{PluginOptions, RunOptions, helices};
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};

use crate::run::{asset, body, lowest, run, tilt, watch};

#[test]
fn the_nut_reports_turns_and_deviation() {
    let scene = asset("nut_on_bolt.ron");
    let names: Vec<&str> = scene.description.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["bolt", "nut"]);
    let options = RunOptions {
        plugins: PluginOptions { helices: helices(&scene), ..PluginOptions::default() },
        duration: Some(0.1),
        ..RunOptions::default()
    };
    let summary = run(&scene, &options).summary;
    let [helix] = &summary.helices[..] else { panic!("{:?}", summary.helices) };
    eprintln!("nut: {helix:?}, deepest {:?}, wall {:.1} s", summary.deepest, summary.wall_s);
    assert_eq!((helix.bolt.as_str(), helix.nut.as_str(), helix.pitch), ("bolt", "nut", 2.0));
    assert!(helix.turns > 0.0 && helix.deviation_max.is_finite());
    // The thread holds it: it neither falls through nor tunnels into the next turn.
    assert!(helix.deviation_max < 1.0, "{helix:?}");
}

/// Play between the flanks along the axis, with what the solver leaves: 0.058 and a fifth of that.
const OFF_HELIX: f64 = 0.07;

/// Earth's gravity in millimetres.
const GRAVITY: f64 = 9810.0;

/// Height gained in a turn by a radian.
const LEAD: f64 = 2.0 / TAU;

/// The closed form of a nut on a smooth thread that goes down at so many radians a second at first:
/// turns after some seconds. Flanks are inclined by 30 degrees; they bear between the radii 7.02
/// and 8, on the mean at 7.5, where the helix is inclined by the lead over that. `gyration`: moment
/// of inertia about the axis over mass.
fn closed_form(gyration: f64, friction: f64, [rate, seconds]: [f64; 2]) -> f64 {
    let radius = 7.5;
    let incline = (LEAD / radius).atan();
    let slant = (1.0 + (30f64.to_radians()).tan().powi(2) + incline.tan().powi(2)).sqrt();
    // Per unit of force along the normal: what lifts the nut, and what turns it.
    let lifts = 1.0 / slant + friction * incline.sin();
    let turns = radius * (incline.tan() / slant - friction * incline.cos());
    let acceleration = if turns > 0.0 { GRAVITY / (LEAD + gyration * lifts / turns) } else { 0.0 };
    (rate * seconds + 0.5 * acceleration * seconds * seconds) / TAU
}

/// How a nut came down its bolt.
struct Descent {
    /// Down.
    turns: f64,
    /// By the closed form.
    closed: f64,
    deviation: f64,
    /// Degrees, at any step.
    tilt: f64,
    /// Of features that cross, at every tenth of a second.
    deepest: f64,
    gained: f64,
}

fn descend(name: &str, duration: Option<f64>) -> Descent {
    let scene = asset(name);
    let options = RunOptions {
        plugins: PluginOptions { helices: helices(&scene), ..PluginOptions::default() },
        duration,
        ..RunOptions::default()
    };
    let scene = scene.description;
    let seconds = duration.unwrap_or(scene.duration);
    let (bolt, nut) = (body(&scene, "bolt"), body(&scene, "nut"));
    let models = [bolt, nut].map(|k| {
        let mesh: &Mesh = &scene.bodies[k].collision;
        Model::build(mesh.clone(), &BuildOptions::default()).unwrap().0
    });
    let solid = models[1].mass_properties().expect("a nut is closed");
    let gyration = solid.inertia.z_axis.z / solid.volume;
    let of_nut = &scene.bodies[nut];
    let motion = [-of_nut.angular_velocity.z, seconds];
    let closed = closed_form(gyration, of_nut.material.friction, motion);
    let (mut leans, mut deepest) = (0.0f64, 0.0f64);
    let ended = watch(&scene, &options, |now| {
        leans = leans.max(tilt(DVec3::Z, &Pose::IDENTITY, &now.poses[nut]));
        if now.step.is_multiple_of(24) {
            let placed = |k: usize, pose| Placed { model: &models[k], pose };
            let (a, b) = (placed(0, now.poses[bolt]), placed(1, now.poses[nut]));
            let ask = Query::of(Demand::contacts(0.0));
            let found = query(a, b, &ask, &mut PairMemory::default()).unwrap().contacts;
            deepest = found.iter().map(|c| -c.separation).fold(deepest, f64::max);
        }
    });
    let [helix] = &ended.summary.helices[..] else { panic!("{:?}", ended.summary.helices) };
    let (turns, deviation) = (-helix.turns, helix.deviation_max);
    let gained = ended.summary.energy_drift.expect("bodies move");
    eprintln!(
        "{name}: {turns:.5} turns of {closed:.5}, off the helix by {deviation:.4}, tilt {leans:.3}, deepest {deepest:.5}, gained {gained:.2e}, wall {:.1} s",
        ended.summary.wall_s
    );
    Descent { turns, closed, deviation, tilt: leans, deepest, gained }
}

impl Descent {
    /// What every nut keeps, whatever it does.
    fn stays_in_its_thread(&self) {
        assert!(self.deviation <= OFF_HELIX, "{}", self.deviation);
        assert!(self.tilt <= 0.4, "{}", self.tilt);
        assert!(self.deepest <= 0.06, "{}", self.deepest);
        assert!(self.gained <= 0.01, "{}", self.gained);
    }
}

/// A smooth thread would let it make 11.1 turns in the 2 s; facets of 2.5 degrees may cost a
/// quarter.
#[test]
fn under_gravity_it_runs_down() {
    let came = descend("nut_under_gravity.ron", None);
    came.stays_in_its_thread();
    assert!((came.closed - 11.1).abs() < 0.1, "{}", came.closed);
    assert!(came.turns >= 9.0 && came.turns <= 1.01 * came.closed, "{}", came.turns);
}

/// With friction of 0.02 it slips: 1.04 turns in the first second on a smooth thread, never more
/// than a tenth beyond. How much facets cost is printed, and stands in the README of
/// `cranny-rapier`.
#[test]
fn with_little_friction_it_slips() {
    let came = descend("nut_slips.ron", None);
    came.stays_in_its_thread();
    assert!((came.closed - 1.04).abs() < 0.02, "{}", came.closed);
    assert!(came.turns >= 0.5 * came.closed && came.turns <= 1.1 * came.closed, "{}", came.turns);
}

/// With the normals of the curved thread: 11.5 turns of 11.9, as a share of what is to be had.
#[test]
fn with_smooth_normals_it_runs_down_as_on_a_smooth_thread() {
    let came = descend("nut_under_gravity_smooth.ron", None);
    came.stays_in_its_thread();
    let least = 11.5 / 11.9 * came.closed;
    assert!(came.turns >= least && came.turns <= 1.01 * came.closed, "{}", came.turns);
}

/// Of 48 facets a turn, too: 0.95 of the closed form.
#[test]
fn with_smooth_normals_coarse_facets_cost_little() {
    let came = descend("nut_of_48_facets.ron", None);
    came.stays_in_its_thread();
    assert!((came.closed - 11.1).abs() < 0.1, "{}", came.closed);
    let least = 0.95 * came.closed;
    assert!(came.turns >= least && came.turns <= 1.01 * came.closed, "{}", came.turns);
}

/// With the normals of the curved thread it slips at the closed form's rate, within a tenth.
#[test]
fn with_smooth_normals_it_slips_at_its_rate() {
    let came = descend("nut_slips_smooth.ron", None);
    came.stays_in_its_thread();
    assert!((came.closed - 1.04).abs() < 0.02, "{}", came.closed);
    assert!((came.turns / came.closed - 1.0).abs() <= 0.1, "{}", came.turns);
}

/// With friction of 0.1 it stays: by less than 0.01 turn in 10 s, which `tools/soak` runs; here by
/// a tenth of that in one.
#[test]
fn with_more_friction_it_stays() {
    let came = descend("nut_holds.ron", Some(1.0));
    came.stays_in_its_thread();
    assert_eq!(came.closed, 0.0);
    assert!(came.turns.abs() < 1e-3, "{}", came.turns);
}

/// Started by hand, above the tip and askew: it engages, or it cross-threads and jams; which of the
/// two is printed. It engages if in the end it stands in its thread: 2 mm lower for each turn,
/// upright, with one turn of thread or more over the bolt's. It jams if it leans, and has come to
/// rest. It never goes through the thread.
#[test]
fn a_screw_started_by_hand_engages_or_jams() {
    let scene = asset("screw_by_hand.ron").description;
    let (bolt, nut) = (body(&scene, "bolt"), body(&scene, "nut"));
    let tip = lowest(&scene, bolt, &scene.bodies[bolt].pose, -DVec3::Z).abs();
    let half = lowest(&scene, nut, &Pose::IDENTITY, DVec3::Z).abs();
    assert!((tip - 48.0).abs() < 1e-9 && (half - 7.2).abs() < 1e-9, "{tip} {half}");
    let mut turned = vec![0.0f64];
    let mut heights = Vec::new();
    let ended = watch(&scene, &RunOptions::default(), |now| {
        let pose = &now.poses[nut];
        let x = pose.rotation * DVec3::X;
        let last = turned[turned.len() - 1];
        let angle = x.y.atan2(x.x);
        turned.push(angle + TAU * ((last - angle) / TAU).round());
        heights.push(pose.translation.z);
    });
    let pose = &ended.poses[nut];
    let (leans, sunk) = (tilt(DVec3::Z, &Pose::IDENTITY, pose), tip + half - pose.translation.z);
    // Over the last quarter of the time.
    let late = heights.len() * 3 / 4;
    let went = (turned[turned.len() - 1] - turned[late + 1]) / TAU;
    let fell = heights[heights.len() - 1] - heights[late];
    let engaged = sunk >= 2.0 && leans <= 0.4 && (fell - 2.0 * went).abs() <= 2.0 * OFF_HELIX;
    let jammed = !engaged && fell.abs() < 0.05 && went.abs() < 0.05;
    eprintln!(
        "started by hand: {} — {sunk:.2} over the bolt's end, leaning by {leans:.2} degrees; in the last quarter {went:.4} turns and {fell:.4} along the axis; wall {:.1} s",
        if engaged {
            "engaged"
        } else if jammed {
            "jammed"
        } else {
            "neither engaged nor jammed"
        },
        ended.summary.wall_s
    );
    assert!(engaged || jammed);
    assert!(ended.summary.energy_drift.unwrap() <= 0.01);
}
