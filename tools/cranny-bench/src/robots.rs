//! Links of robots against each other, as `cranny robot` checks them, beside FCL and Coal.
//!
//! All contestants look at the same poses and the same pairs of links, and take turns in one run.
//! The peers' broad phase is given to them, and the time of a call from Python is subtracted.

mod agreement;
mod contestants;
mod stage;

use std::io;
use std::path::Path;

use clap::Args;
use cranny_world::Wanted;

use self::agreement::{Agreement, compare};
use self::contestants::{Peer, RobotChecks};
use self::stage::{Course, RobotCell, RobotStage};
use crate::progress;
use crate::python::Python;
use crate::report::{Cell as Figure, Report, Table};
use crate::turns::{Budget, Contestant, Times, take_turns};

/// The robots to measure.
#[derive(Clone, Debug, Args)]
pub(crate) struct RobotsArgs {
    /// Robot files. `ROBOT.urdf,ROBOT.srdf` leaves out the pairs that the SRDF file disables
    #[arg(value_name = "URDF[,SRDF]", required = true)]
    robots: Vec<String>,

    /// Configurations of each robot
    #[arg(long, value_name = "N", default_value_t = 500)]
    configurations: usize,
}

/// Configurations of a quick look.
const QUICK_CONFIGURATIONS: usize = 60;

/// The process that calls the peers.
const SCRIPT: &str = include_str!("robots/peers.py");

/// Names of the peers, and of their Python packages.
const PEERS: [(&str, &str); 2] = [("FCL", "fcl"), ("Coal", "coal")];

/// Measures the robots.
///
/// # Errors
///
/// A file that is refused; a process that does not start.
pub(crate) fn measure(quick: bool, args: &RobotsArgs) -> io::Result<Report> {
    let count =
        if quick { args.configurations.min(QUICK_CONFIGURATIONS) } else { args.configurations };
    let mut bench = RobotBench {
        budget: Budget { rounds: if quick { 1 } else { 3 }, turn: if quick { 0.1 } else { 1.0 } },
        has: PEERS.map(|(_, package)| Python::has(package)),
        rows: Vec::new(),
        agreements: Vec::new(),
        notes: Vec::new(),
    };
    for ((name, _), has) in PEERS.iter().zip(bench.has) {
        if !has {
            bench.notes.push(format!("{name} is not found: `pip install python-fcl coal numpy`, and name the interpreter in CRANNY_PYTHON"));
        }
    }
    for robot in &args.robots {
        progress(robot);
        let (urdf, srdf) = robot.split_once(',').map_or((&**robot, None), |(u, s)| (u, Some(s)));
        let named = |error| io::Error::other(format!("{robot}: {error}"));
        let cell = RobotCell::read(Path::new(urdf), srdf.map(Path::new)).map_err(named)?;
        bench.robot(&cell, srdf.is_some(), count.max(1))?;
    }
    Ok(bench.report())
}

struct RobotBench {
    budget: Budget,
    has: [bool; 2],
    rows: Vec<Vec<Figure>>,
    agreements: Vec<Vec<Figure>>,
    notes: Vec<String>,
}

impl RobotBench {
    fn robot(&mut self, cell: &RobotCell, has_srdf: bool, count: usize) -> io::Result<()> {
        let name = format!("{}{}", cell.robot.name, if has_srdf { ", SRDF" } else { "" });
        for course in [Course::Random, Course::Motion] {
            let stage = RobotStage { cell, poses: cell.poses(course, count)? };
            let mut python = match self.has {
                [false, false] => None,
                _ => Some(Python::start(SCRIPT, &stage.given())?),
            };
            for wanted in [Wanted::Meeting, Wanted::Nearest] {
                self.row(&name, course, wanted, &stage, python.as_mut())?;
            }
        }
        Ok(())
    }

    fn row(
        &mut self,
        name: &str,
        course: Course,
        wanted: Wanted,
        stage: &RobotStage<'_>,
        python: Option<&mut Python>,
    ) -> io::Result<()> {
        let what = if wanted == Wanted::Meeting { "hits" } else { "distance" };
        let case = format!("{name}, {}, {what}", course.name());
        let mut ours = RobotChecks::new(stage, wanted);
        let (own, peers) = self.race(&case, stage, &mut ours, python)?;
        let met = ours.found.iter().flatten().filter(|found| !found.hits.is_empty()).count();
        let mut cells = vec![
            Figure::Text(case),
            Figure::Count(stage.cell.pairs.len()),
            Figure::Text(format!("{:.0} %", 100.0 * met as f64 / stage.poses.len() as f64)),
            Figure::Micros(own.median() * 1e6),
            Figure::Micros(own.p99() * 1e6),
        ];
        let ratios = |of: fn(&Times, &Times) -> f64| {
            let ratio = |times: &Option<Times>| times.as_ref().map(|times| of(times, &own));
            peers.each_ref().map(|times| ratio(times).map_or(Figure::Absent, Figure::Ratio))
        };
        cells.extend(ratios(Times::over));
        cells.extend(ratios(mean_over));
        self.rows.push(cells);
        Ok(())
    }

    /// Ours takes turns with each peer; returns its times and theirs.
    fn race(
        &mut self,
        case: &str,
        stage: &RobotStage<'_>,
        ours: &mut RobotChecks<'_>,
        mut python: Option<&mut Python>,
    ) -> io::Result<(Times, [Option<Times>; 2])> {
        let (frames, wanted) = (stage.poses.len(), ours.wanted);
        let (mut own, mut peers) = (None, [None, None]);
        for (k, (peer_name, library)) in PEERS.iter().enumerate() {
            let Some(python) = python.as_deref_mut().filter(|_| self.has[k]) else { continue };
            let mut peer = Peer { python, library, wanted, found: vec![None; frames] };
            let contestants: &mut [&mut dyn Contestant] = &mut [&mut *ours, &mut peer];
            let mut times = take_turns(self.budget, frames, contestants).into_iter();
            own = times.next().flatten();
            peers[k] = times.next().flatten();
            self.agree(case, peer_name, compare(stage, &ours.found, &peer.found));
        }
        if own.is_none() {
            own = take_turns(self.budget, frames, &mut [&mut *ours]).pop().flatten();
        }
        let own = own.ok_or_else(|| io::Error::other(format!("{case}: our check fails")))?;
        Ok((own, peers))
    }

    /// Adds how a peer's answers compare with ours.
    fn agree(&mut self, case: &str, peer: &str, agreement: Agreement) {
        let Agreement { compared, inside, near, differences } = agreement;
        let counts = [compared, inside, near, differences.len()].map(Figure::Count);
        let names = [case, peer].map(|name| Figure::Text(name.into()));
        self.agreements.push(names.into_iter().chain(counts).collect());
        self.notes.extend(differences.iter().map(|what| format!("{case}, {peer}: {what}")));
    }

    fn report(self) -> Report {
        let mut notes = vec![
            "a configuration, all pairs; thread CPU time, best of some turns, median and 99th percentile over the configurations".into(),
            "ratios of medians, then of means, over the same configurations: that library / ours".into(),
            "the peers get the pairs whose boxes overlap, and the order of the boxes' distances, for nothing; calls from Python are subtracted".into(),
        ];
        notes.extend(self.notes);
        let times = Table {
            title: "A configuration",
            columns: vec![
                "robot",
                "pairs",
                "meet",
                "ours",
                "p99",
                "FCL",
                "Coal",
                "FCL, means",
                "Coal, means",
            ],
            rows: self.rows,
        };
        let agreements = Table {
            title: "Answers beside ours: hits of links inside others that a library does not see, hits of gaps below its tolerance, all other differences",
            columns: vec!["robot", "library", "compared", "inside", "near", "differences"],
            rows: self.agreements,
        };
        let tables = vec![times, agreements];
        Report { title: "Robots' links against each other", notes, tables }
    }
}

/// Returns the mean in multiples of ours, over the same configurations.
fn mean_over(times: &Times, own: &Times) -> f64 {
    let same: f64 = times.frames.iter().map(|&frame| own.seconds[frame]).sum();
    times.seconds.iter().sum::<f64>() / same
}
