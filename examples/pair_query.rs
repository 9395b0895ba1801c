//! Two interlinked links of a chain, pulled apart little by little: how much play is left, and
//! where do they overlap once they cannot go farther?
//!
//! `cargo run --example pair_query`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use cranny::prelude::*;
use cranny::shapes::ChainLink;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (link, report) = Model::build(ChainLink::default().build()?, &BuildOptions::default())?;
    println!(
        "each link: {} faces, volume {:.4}\n",
        report.faces,
        report.volume.unwrap_or_default()
    );

    let first = Placed { model: &link, pose: Pose::IDENTITY };
    // Links are long along x; every other one is turned about x by 90 degrees.
    let rotation = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let mut memory = PairMemory::default();
    for x in [1.5, 1.6, 1.69, 1.72, 1.75] {
        let second =
            Placed { model: &link, pose: Pose { rotation, translation: DVec3::new(x, 0.0, 0.0) } };
        // Regions cost more than a verdict, so they are queried only where there are any.
        let distance = Query::of(Demand::Distance { below: None });
        let answer = query(first, second, &distance, &mut memory)?;
        let gap = answer.distance.unwrap_or_default();
        println!("x = {x:.2}: surfaces {:?}, distance {gap:.4}", answer.surface);
        if answer.solid {
            let everything = Query::of(Demand::Regions { margin: 0.0 });
            for region in query(first, second, &everything, &mut memory)?.regions {
                print_region(&region);
            }
        }
    }
    Ok(())
}

fn print_region(region: &Region) {
    let [nx, ny, nz] = region.normal.to_array();
    println!(
        "    region: depth {:.5}, area {:.5}, normal ({nx:.3}, {ny:.3}, {nz:.3})",
        region.depth.unwrap_or_default(),
        region.area.unwrap_or_default(),
    );
    println!(
        "            {} triangle pairs, closed curves: {}, contacts: {}",
        region.triangle_pairs,
        region.curves.iter().filter(|curve| curve.closed).count(),
        region.points.len(),
    );
}
