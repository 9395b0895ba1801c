//! Fixed pieces of work, whose instructions somebody else counts:
//! `cargo run -p xtask -- instructions`.
//!
//! A clock shows how busy a machine is as much as how much there was to do; the instructions of the
//! same work are the same to a thousandth, so that a slow-down is seen by comparing two numbers.

use std::hint::black_box;
use std::io::{self, Write};

use cranny_concavity::Concavities;
use cranny_exact::Pose;
use cranny_geometry::{BuildOptions, ConvexHull, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};

use crate::deform::{self, Place};
use crate::stopwatch::keep;
use crate::{broad, cloud, pairs, solid, walk};

/// Ready to be done: all that is only set-up is behind it.
pub(crate) type Work = Box<dyn FnMut()>;

/// A piece of work.
struct CountedWork {
    name: &'static str,
    /// Sets it up; `None` where its bodies cannot be made.
    made: fn() -> Option<Work>,
}

const DISTANCE: Demand = Demand::Distance { below: None };
const REGIONS: Demand = Demand::Regions { margin: 0.0 };

/// As far as the gap between the flanks of nut and bolt.
const THREAD: Demand = Demand::contacts(0.05);

/// Names have no spaces at their ends and stay as they are: figures are kept by them.
const CASES: &[CountedWork] = &[
    CountedWork {
        name: "prepare golf 1k",
        made: || Some(preparing(solid::golf_ball(1_000).ok()?)),
    },
    CountedWork { name: "prepare bolt 28k", made: || Some(preparing(solid::bolt().ok()?)) },
    CountedWork { name: "load bolt 28k", made: loading },
    CountedWork {
        name: "concavities of golf 1k",
        made: || making_concavities(solid::golf_ball(1_000).ok()?),
    },
    CountedWork {
        name: "concavities of bolt 28k",
        made: || making_concavities(solid::bolt().ok()?),
    },
    CountedWork {
        name: "deform golf 100k, 10 in a pocket",
        made: || deform::work(100_000, Place::Pocket, 10),
    },
    CountedWork {
        name: "deform golf 100k, 10 at a rim",
        made: || deform::work(100_000, Place::Rim, 10),
    },
    CountedWork {
        name: "deform golf 100k, 10 outward",
        made: || deform::work(100_000, Place::Outward, 10),
    },
    CountedWork {
        name: "deform golf 100k, 1 outward",
        made: || deform::work(100_000, Place::Outward, 1),
    },
    CountedWork { name: "hull of 10k on a sphere", made: hull },
    CountedWork { name: "walk near 500 points", made: || walk::work(0.1, 500, 300) },
    CountedWork { name: "walk deep 500 points", made: || walk::work(-0.5, 500, 300) },
    CountedWork {
        name: "intersects near golf 1k",
        made: || warm("golf 1k near", Demand::Intersects, 100),
    },
    CountedWork {
        name: "intersects near golf 10k",
        made: || warm("golf 10k near", Demand::Intersects, 100),
    },
    CountedWork { name: "distance near golf 10k", made: || warm("golf 10k near", DISTANCE, 100) },
    CountedWork {
        name: "distance near torus 10k, cold",
        made: || cold("torus 10k near", DISTANCE, 20),
    },
    CountedWork {
        name: "intersects contact torus 10k",
        made: || warm("torus 10k contact", Demand::Intersects, 100),
    },
    CountedWork {
        name: "regions contact torus 10k",
        made: || warm("torus 10k contact", REGIONS, 20),
    },
    CountedWork {
        name: "regions contact golf 10k",
        made: || warm("golf 10k contact", REGIONS, 20),
    },
    CountedWork {
        name: "contacts contact torus 10k",
        made: || warm("torus 10k contact", Demand::contacts(0.002), 20),
    },
    CountedWork {
        name: "intersects nut 2 degrees",
        made: || warm("nut on bolt, 2 degrees", Demand::Intersects, 8),
    },
    CountedWork {
        name: "contacts nut 1.5 degrees",
        made: || warm("nut on bolt, 1.5 degrees", THREAD, 8),
    },
    CountedWork { name: "broad 2k, 1 in 100 moving", made: || broad::work(2_000, 100, 40) },
    CountedWork { name: "broad 2k, all moving 1 %", made: || broad::work(2_000, 1, 40) },
];

/// Does the piece of work of that name; without a name, lists them.
///
/// # Errors
///
/// A name that there is not, work that cannot be set up; standard output that cannot be written.
pub(crate) fn count(name: Option<&str>) -> io::Result<()> {
    let Some(name) = name else {
        let mut out = io::stdout().lock();
        return CASES.iter().try_for_each(|case| writeln!(out, "{}", case.name));
    };
    let case = CASES.iter().find(|case| case.name == name).ok_or_else(|| {
        io::Error::other(format!("no piece of work is called {name:?}; `count` alone lists them"))
    })?;
    let mut work =
        (case.made)().ok_or_else(|| io::Error::other(format!("{name:?} cannot be set up")))?;
    counted(&mut *work);
    Ok(())
}

/// What happens in here is counted, and nothing else: the counter knows it by its name.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
    // Were the call the last thing here, it could become a jump out of the function.
    black_box(());
}

fn preparing(mesh: Mesh) -> Work {
    Box::new(move || keep(Model::build(mesh.clone(), &BuildOptions::default())))
}

fn making_concavities(mesh: Mesh) -> Option<Work> {
    let (model, _) = Model::build(mesh, &BuildOptions::default()).ok()?;
    Some(Box::new(move || keep(Concavities::of(&model))))
}

fn loading() -> Option<Work> {
    let (model, _) = Model::build(solid::bolt().ok()?, &BuildOptions::default()).ok()?;
    let bytes = model.encode();
    Some(Box::new(move || keep(Model::decode(&bytes))))
}

fn hull() -> Option<Work> {
    let points = cloud::sphere(10_000);
    Some(Box::new(move || keep(ConvexHull::of_points(&points))))
}

/// So many frames of a pair of meshes after its first.
fn warm(scene: &str, demand: Demand, frames: usize) -> Option<Work> {
    let ([a, b], poses) = pairs::models(scene)?;
    // Preparation is counted by itself.
    a.clusters();
    b.clusters();
    let mut memory = PairMemory::default();
    let mut ask = move |frame: usize| {
        let b = Placed { model: &b, pose: poses[frame] };
        keep(query(Placed { model: &a, pose: Pose::IDENTITY }, b, &Query::of(demand), &mut memory));
    };
    ask(0);
    Some(Box::new(move || (1..=frames).for_each(&mut ask)))
}

/// So many frames without memory.
fn cold(scene: &str, demand: Demand, frames: usize) -> Option<Work> {
    let ([a, b], poses) = pairs::models(scene)?;
    // Preparation is counted by itself.
    a.clusters();
    b.clusters();
    Some(Box::new(move || {
        for &pose in &poses[..frames] {
            let b = Placed { model: &b, pose };
            let memory = &mut PairMemory::default();
            keep(query(Placed { model: &a, pose: Pose::IDENTITY }, b, &Query::of(demand), memory));
        }
    }))
}
