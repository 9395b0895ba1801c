//! Ours and the peers, on the same configurations.

use std::io;

use cranny_world::{Arrangement, Wanted};
use serde_json::{Value, json};

use super::stage::RobotStage;
use crate::python::Python;
use crate::turns::{Contestant, Stopwatch};

/// What is found at a configuration: pairs of links by index.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// In ascending order.
    pub(super) hits: Vec<(usize, usize)>,
    pub(super) distance: Option<f64>,
}

/// Ours, as `cranny robot` checks: what is remembered of the configuration before is kept.
pub(super) struct RobotChecks<'a> {
    stage: &'a RobotStage<'a>,
    pub(super) wanted: Wanted,
    links: Arrangement,
    watch: Stopwatch,
    pub(super) found: Vec<Option<Found>>,
}

impl<'a> RobotChecks<'a> {
    pub(super) fn new(stage: &'a RobotStage<'a>, wanted: Wanted) -> Self {
        let (links, found) = (stage.cell.links(), vec![None; stage.poses.len()]);
        Self { stage, wanted, links, watch: Stopwatch::new(), found }
    }
}

impl Contestant for RobotChecks<'_> {
    fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>> {
        let Self { stage, wanted, links, watch, found } = self;
        let mut seconds = Vec::with_capacity(frames.len());
        for &frame in frames {
            let (spent, made) = watch.seconds(|| links.at(&stage.poses[frame], *wanted));
            let made = made.map_err(io::Error::other)?;
            let mut hits = made.meeting;
            hits.sort_unstable();
            found[frame] = Some(Found { hits, distance: made.nearest.map(|n| n.distance) });
            seconds.push(spent);
        }
        Ok(seconds)
    }
}

/// A library that is called from Python.
pub(super) struct Peer<'a> {
    pub(super) python: &'a mut Python,
    /// Name of the Python package.
    pub(super) library: &'static str,
    pub(super) wanted: Wanted,
    pub(super) found: Vec<Option<Found>>,
}

impl Contestant for Peer<'_> {
    fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>> {
        let what = match self.wanted {
            Wanted::Meeting => "meeting",
            Wanted::Nearest => "nearest",
        };
        let turn = json!({ "library": self.library, "what": what, "frames": frames });
        let answer = self.python.ask(&turn)?;
        let of = |key: &str| answer[key].as_array().filter(|all| all.len() == frames.len());
        let lists = || Some((of("seconds")?, of("hits")?, of("nearest")?));
        let (seconds, hits, nearest) = lists().ok_or_else(|| {
            io::Error::other("the peers' process returns another number of frames")
        })?;
        for (k, &frame) in frames.iter().enumerate() {
            let hits = hits[k].as_array().into_iter().flatten().filter_map(pair);
            let mut hits: Vec<_> = hits.collect();
            hits.sort_unstable();
            self.found[frame] = Some(Found { hits, distance: nearest[k][2].as_f64() });
        }
        Ok(seconds.iter().filter_map(Value::as_f64).collect())
    }
}

fn pair(value: &Value) -> Option<(usize, usize)> {
    let index = |k: usize| value[k].as_u64().map(|index| index as usize);
    Some((index(0)?, index(1)?))
}
