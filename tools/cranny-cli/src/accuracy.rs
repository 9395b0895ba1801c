//! `cranny accuracy`: what certainty costs in time, and what haste costs in certainty.
//!
//! Every method is asked at the same poses, in this process and on this thread, and judged by exact answers:
//! `truth` has those, `ours` and `peer` are the methods, `figures` what is told of each, `chart` the drawing.

mod chart;
mod figures;
mod ours;
mod peer;
mod truth;

use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Model};

use crate::args::{AccuracyArgs, Format};
use crate::failure::Failure;
use crate::model_file::load;
use crate::output::Output;
use crate::paths::{make_folder, write};
use crate::pose_file::{PosePair, read_poses};
use crate::progress;
use figures::{Figures, measured};
use ours::Ours;
use peer::Peer;
use truth::Truth;

/// Two bodies and where they are asked about.
struct Scene<'a> {
    models: [&'a Model; 2],
    poses: &'a [PosePair],
    truths: Vec<Truth>,
}

/// What a method told at one pose.
#[derive(Clone, Debug, Default)]
struct Told {
    /// Whether the bodies share a point; `None`: it does not say.
    meets: Option<bool>,
    /// Its distance, or the upper end of where that lies.
    distance: Option<f64>,
    /// Width of the interval that certainly holds the distance, of those who tell one.
    width: Option<f64>,
    witnesses: Option<[DVec3; 2]>,
    tests: Option<u64>,
}

/// Runs the command.
///
/// # Errors
///
/// Wrong meshes, poses or options; files or standard output that cannot be written.
pub(crate) fn accuracy(args: &AccuracyArgs, format: Option<Format>) -> Result<(), Failure> {
    let poses = read_poses(&args.poses)?;
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let a = load(&args.pair.mesh_a, args.pair.scale_a, &options)?;
    let b = load(&args.pair.mesh_b, args.pair.scale_b, &options)?;
    make_folder(&args.out)?;
    let truths = truth::truths([&a, &b], &poses)
        .map_err(|error| Failure::input(format!("pose file {}: {error}", args.poses.display())))?;
    let scene = Scene { models: [&a, &b], poses: &poses, truths };

    let format = format.unwrap_or(Format::Text);
    let mut output = Output::new();
    if format == Format::Text {
        output.line(&figures::heading())?;
    }
    let mut all: Vec<Figures> = Vec::new();
    let mut tell = |figures: Figures| {
        let told = match format {
            Format::Json => output.json(&figures),
            Format::Text => output.line(&figures.text()),
        };
        all.push(figures);
        told
    };
    let methods = Ours::all();
    let bar = progress::bar(methods.len() as u64, "measuring");
    for mut method in methods {
        tell(measured(&scene, &mut method))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let peers = if args.no_peers { &[][..] } else { &Peer::KINDS[..] };
    for kind in peers {
        let spinner = progress::spinner(format!("preparing {}", kind.name()));
        let peer = Peer::new(*kind, scene.models);
        spinner.finish_and_clear();
        match peer {
            Ok(mut peer) => tell(measured(&scene, &mut peer))?,
            Err(error) => tracing::warn!("{} is left out: {error}", kind.name()),
        }
    }
    write(&args.out.join("accuracy.csv"), &figures::csv(&all))?;
    let size = a.bounds().diagonal().min(b.bounds().diagonal());
    let chart = chart::drawn(&all, size)?;
    write(&args.out.join("accuracy.svg"), &chart)
}
