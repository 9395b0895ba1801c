//! Ten cups on top of each other stand.

use cranny_ecs::RunOptions;
use cranny_exact::DVec3;

use crate::overlap::Judge;
use crate::run::{asset, body, tilt, watch};

/// Of each pair; the solver takes a wall's 0.09 for a metre and leaves 0.001 of that.
const OVERLAP: f64 = 2e-3;

#[test]
fn ten_cups_stand() {
    let mut scene = asset("stack_of_cups.ron").description;
    scene.effects.truncate(1); // the judge looks now and then; the whole run is judged by `tools/soak`
    let judge = Judge::of(&scene);
    let cups: Vec<usize> = (0..10).map(|k| body(&scene, &format!("cup_{k}"))).collect();
    let (mut most, mut deepest) = (0.0f64, 0.0f64);
    let under = |k: usize| if k == 0 { body(&scene, "table") } else { cups[k - 1] };
    // Their fall of 0.05 in all is over after 0.1 s.
    let options = RunOptions { duration: Some(1.0), ..RunOptions::default() };
    let ended = watch(&scene, &options, |now| {
        if now.step.is_multiple_of(40) {
            let depths = (0..10).map(|k| judge.overlap(&now.poses, cups[k], under(k)));
            deepest = depths.fold(deepest, f64::max);
        }
        let leans = cups.iter().map(|&k| tilt(DVec3::Z, &scene.bodies[k].pose, &now.poses[k]));
        most = leans.fold(most, f64::max);
    });
    for (k, &cup) in cups.iter().enumerate() {
        let at = ended.poses[cup].translation;
        let depth = judge.overlap(&ended.poses, cup, under(k));
        eprintln!("cup {k} at {at}, {depth:.2e} deep");
        // Each is 0.6 high and stands on the rim of the one below; what each may sink in adds up.
        let slack = OVERLAP * (k + 1) as f64;
        assert!((at.z - 0.6 * k as f64).abs() < slack, "cup {k} at {at}");
        assert!(at.truncate().length() < 0.01, "cup {k} at {at}");
        assert!(depth < OVERLAP, "cup {k}: {depth}");
    }
    eprintln!("tilt {most:.4}, deepest {deepest:.2e}, wall {:.1} s", ended.summary.wall_s);
    assert!(most < 0.5, "{most}");
    assert!(deepest < OVERLAP, "{deepest}");
    assert!(ended.summary.energy_drift.unwrap() < 0.01);
}
