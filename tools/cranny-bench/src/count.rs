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

use crate::deform::{Deformed, Place};
use crate::stopwatch::keep;
use crate::{broad, cloud, pairs, solid, walk};

/// Ready to be done: all that is only set-up is behind it.
pub(crate) type Work<'a> = Box<dyn FnMut() + 'a>;

/// A piece of work.
struct CountedWork {
    name: &'static str,
    /// Sets it up; `None` where its bodies cannot be made.
    made: fn(&mut Bodies) -> Option<Work<'_>>,
}

/// What pieces of work share: under the counter, making bodies takes much longer than the work.
/// Equal meshes have one model, as bodies of a scene do.
#[derive(Default)]
struct Bodies {
    models: Vec<(Mesh, Model)>,
    deformed: Option<Deformed>,
}

impl Bodies {
    fn model(&mut self, mesh: Mesh) -> Option<Model> {
        if let Some((_, model)) = self.models.iter().find(|(known, _)| *known == mesh) {
            return Some(model.clone());
        }
        let model = pairs::model_of(&mesh)?;
        // Preparation is counted by itself.
        model.clusters();
        self.models.push((mesh, model.clone()));
        Some(model)
    }

    fn pair(&mut self, name: &str) -> Option<([Model; 2], Vec<Pose>)> {
        let ([a, b], poses) = pairs::scene(name)?;
        Some(([self.model(a)?, self.model(b)?], poses))
    }

    fn deforming(&mut self, place: Place, count: usize) -> Option<Work<'_>> {
        if self.deformed.is_none() {
            self.deformed = Deformed::golf_ball(100_000);
        }
        self.deformed.as_mut()?.work(place, count)
    }
}

const DISTANCE: Demand = Demand::Distance { below: None };
const REGIONS: Demand = Demand::Regions { margin: 0.0 };

/// As far as the gap between the flanks of nut and bolt.
const THREAD: Demand = Demand::contacts(0.05);

/// Names have no spaces at their ends and stay as they are: figures are kept by them. Pieces of a
/// list may share bodies: they are counted in one process, in this order.
const CASES: &[&[CountedWork]] = &[
    &[
        CountedWork {
            name: "deform golf 100k, 10 in a pocket",
            made: |b| b.deforming(Place::Pocket, 10),
        },
        CountedWork {
            name: "deform golf 100k, 10 at a rim",
            made: |b| b.deforming(Place::Rim, 10),
        },
        CountedWork {
            name: "deform golf 100k, 10 outward",
            made: |b| b.deforming(Place::Outward, 10),
        },
        CountedWork {
            name: "deform golf 100k, 1 outward",
            made: |b| b.deforming(Place::Outward, 1),
        },
    ],
    &[
        CountedWork {
            name: "intersects nut 2 degrees",
            made: |b| warm(b, "nut on bolt, 2 degrees", Demand::Intersects, 8),
        },
        CountedWork {
            name: "contacts nut 1.5 degrees",
            made: |b| warm(b, "nut on bolt, 1.5 degrees", THREAD, 8),
        },
        CountedWork { name: "prepare bolt 28k", made: |_| Some(preparing(solid::bolt().ok()?)) },
        CountedWork { name: "load bolt 28k", made: |b| loading(b, solid::bolt().ok()?) },
        CountedWork {
            name: "concavities of bolt 28k",
            made: |b| making_concavities(b, solid::bolt().ok()?),
        },
    ],
    &[
        CountedWork {
            name: "intersects near golf 10k",
            made: |b| warm(b, "golf 10k near", Demand::Intersects, 100),
        },
        CountedWork {
            name: "distance near golf 10k",
            made: |b| warm(b, "golf 10k near", DISTANCE, 100),
        },
        CountedWork {
            name: "regions contact golf 10k",
            made: |b| warm(b, "golf 10k contact", REGIONS, 20),
        },
        CountedWork {
            name: "distance near torus 10k, cold",
            made: |b| cold(b, "torus 10k near", DISTANCE, 20),
        },
        CountedWork {
            name: "intersects contact torus 10k",
            made: |b| warm(b, "torus 10k contact", Demand::Intersects, 100),
        },
        CountedWork {
            name: "regions contact torus 10k",
            made: |b| warm(b, "torus 10k contact", REGIONS, 20),
        },
        CountedWork {
            name: "contacts contact torus 10k",
            made: |b| warm(b, "torus 10k contact", Demand::contacts(0.002), 20),
        },
    ],
    &[
        CountedWork {
            name: "prepare golf 1k",
            made: |_| Some(preparing(solid::golf_ball(1_000).ok()?)),
        },
        CountedWork {
            name: "concavities of golf 1k",
            made: |b| making_concavities(b, solid::golf_ball(1_000).ok()?),
        },
        CountedWork {
            name: "intersects near golf 1k",
            made: |b| warm(b, "golf 1k near", Demand::Intersects, 100),
        },
        CountedWork { name: "hull of 10k on a sphere", made: |_| hull() },
        CountedWork { name: "walk near 500 points", made: |_| walk::work(0.1, 500, 300) },
        CountedWork { name: "walk deep 500 points", made: |_| walk::work(-0.5, 500, 300) },
        CountedWork { name: "broad 2k, 1 in 100 moving", made: |_| broad::work(2_000, 100, 40) },
        CountedWork { name: "broad 2k, all moving 1 %", made: |_| broad::work(2_000, 1, 40) },
    ],
];

/// Does the pieces of work of those names, in that order; without a name, lists them, an empty line
/// between lists.
///
/// # Errors
///
/// A name that there is not, work that cannot be set up; standard output that cannot be written.
pub(crate) fn count(names: &[String]) -> io::Result<()> {
    if names.is_empty() {
        let names = |list: &[CountedWork]| list.iter().map(|case| case.name).collect::<Vec<_>>();
        let lists: Vec<_> = CASES.iter().map(|list| names(list).join("\n")).collect();
        return writeln!(io::stdout(), "{}", lists.join("\n\n"));
    }
    let mut bodies = Bodies::default();
    names.iter().try_for_each(|name| set_up_and_counted(name, &mut bodies))
}

/// Sets a piece of work up and does it. Callgrind writes its counts down when this function
/// returns, and finds it by name.
#[inline(never)]
fn set_up_and_counted(name: &str, bodies: &mut Bodies) -> io::Result<()> {
    let case = CASES.iter().copied().flatten().find(|case| case.name == name).ok_or_else(|| {
        io::Error::other(format!("no piece of work is called {name:?}; `count` alone lists them"))
    })?;
    let mut work = (case.made)(bodies)
        .ok_or_else(|| io::Error::other(format!("{name:?} cannot be set up")))?;
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

fn preparing(mesh: Mesh) -> Work<'static> {
    Box::new(move || keep(Model::build(mesh.clone(), &BuildOptions::default())))
}

fn making_concavities(bodies: &mut Bodies, mesh: Mesh) -> Option<Work<'_>> {
    let model = bodies.model(mesh)?;
    Some(Box::new(move || keep(Concavities::of(&model))))
}

fn loading(bodies: &mut Bodies, mesh: Mesh) -> Option<Work<'_>> {
    let bytes = bodies.model(mesh)?.encode();
    Some(Box::new(move || keep(Model::decode(&bytes))))
}

fn hull() -> Option<Work<'static>> {
    let points = cloud::sphere(10_000);
    Some(Box::new(move || keep(ConvexHull::of_points(&points))))
}

/// So many frames of a pair of meshes after its first.
fn warm<'a>(bodies: &mut Bodies, scene: &str, demand: Demand, frames: usize) -> Option<Work<'a>> {
    let ([a, b], poses) = bodies.pair(scene)?;
    let mut memory = PairMemory::default();
    let mut ask = move |frame: usize| {
        let b = Placed { model: &b, pose: poses[frame] };
        keep(query(Placed { model: &a, pose: Pose::IDENTITY }, b, &Query::of(demand), &mut memory));
    };
    ask(0);
    Some(Box::new(move || (1..=frames).for_each(&mut ask)))
}

/// So many frames without memory.
fn cold<'a>(bodies: &mut Bodies, scene: &str, demand: Demand, frames: usize) -> Option<Work<'a>> {
    let ([a, b], poses) = bodies.pair(scene)?;
    Some(Box::new(move || {
        for &pose in &poses[..frames] {
            let b = Placed { model: &b, pose };
            let memory = &mut PairMemory::default();
            keep(query(Placed { model: &a, pose: Pose::IDENTITY }, b, &Query::of(demand), memory));
        }
    }))
}
