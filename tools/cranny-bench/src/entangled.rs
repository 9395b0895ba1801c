//! Pairs whose hulls overlap: ours warm and cold, parry's meshes and decompositions, and Coal.
//!
//! All contestants take turns on the same poses in one run. A frame is a step of one of our
//! simulations or a number of degrees of motion. Its time is the thread's CPU time, summed over its
//! pairs, at the best of some turns. A ratio divides medians over the frames of both contestants.

mod catalog;
mod check;
mod coal;
mod corpus;
mod demand;
mod digest;
mod kinematic;
mod ours;
mod parry;
mod recorded;
mod stage;
mod table;

use std::io;
use std::path::PathBuf;

use clap::Args;
use cranny_rapier::Detector;

use self::catalog::Case;
use self::coal::{Coal, CoalTurns};
use self::demand::DemandKind;
use self::ours::{Ours, Outcome};
use self::parry::{Parry, Shapes};
use self::recorded::Recordings;
use self::stage::Stage;
use self::table::Row;
use crate::progress;
use crate::report::Report;
use crate::turns::{Budget, Contestant, take_turns};

/// The cases to measure, and how.
#[derive(Clone, Debug, Args)]
pub(crate) struct EntangledArgs {
    /// Only cases whose name contains one of these; `pile of 500 late` and the like are named in
    /// full
    #[arg(value_name = "CASE")]
    cases: Vec<String>,

    /// Frames of each case, at most
    #[arg(long, value_name = "N")]
    frames: Option<usize>,

    /// Degrees a frame of the cases without a solver, in place of their own
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    degrees: Vec<f64>,

    /// Only these demands
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',')]
    demands: Vec<DemandKind>,

    /// Ratios only: no microseconds, counts and hashes
    #[arg(long)]
    ratios: bool,

    /// Lists the cases
    #[arg(long)]
    list: bool,

    /// Simulates the recorded cases anew
    #[arg(long)]
    record: bool,

    /// Folder of recorded poses; revisions that are compared share one [default: target/entangled]
    #[arg(long, value_name = "DIR")]
    recordings: Option<PathBuf>,
}

/// Frames of a quick look.
const QUICK_FRAMES: usize = 40;

/// A report, and the answers that differ where they must not.
pub(crate) struct Outcomes {
    pub(crate) report: Report,
    pub(crate) differences: Vec<String>,
}

/// Measures the named cases.
///
/// # Errors
///
/// No case of these names.
pub(crate) fn measure(quick: bool, args: &EntangledArgs) -> io::Result<Outcomes> {
    let cases: Vec<Case> =
        catalog::cases(&args.degrees).into_iter().filter(|c| c.is_wanted(&args.cases)).collect();
    if cases.is_empty() {
        return Err(io::Error::other("no case has such a name; `--list` alone lists them"));
    }
    if args.list {
        return Ok(Outcomes { report: table::list(&cases), differences: Vec::new() });
    }
    let mut bench = Bench {
        budget: Budget { rounds: if quick { 1 } else { 3 }, turn: if quick { 0.03 } else { 0.15 } },
        recordings: Recordings {
            folder: args.recordings.clone().unwrap_or_else(Recordings::default_folder),
            anew: args.record,
        },
        has_coal: Coal::is_found(),
        rows: Vec::new(),
        notes: Vec::new(),
        differences: Vec::new(),
        compared: [0; 2],
    };
    if !bench.has_coal {
        bench.notes.push(
            "Coal is not found: `pip install coal`, and name the interpreter in CRANNY_PYTHON"
                .into(),
        );
    }
    let most = args.frames.unwrap_or(if quick { QUICK_FRAMES } else { usize::MAX });
    for case in &cases {
        progress(&case.name);
        bench.measure(case, case.frames.min(most).max(1), &args.demands);
    }
    let [cold, coal] = bench.compared;
    bench.notes.push(format!(
        "answers compared: {cold} frames with cold ones, verdicts and distances of {coal} frames with Coal's; {} rows differ",
        bench.differences.len()
    ));
    let Bench { rows, notes, differences, .. } = bench;
    Ok(Outcomes { report: table::report(&rows, notes, args.ratios), differences })
}

struct Bench {
    budget: Budget,
    recordings: Recordings,
    has_coal: bool,
    rows: Vec<Row>,
    notes: Vec<String>,
    differences: Vec<String>,
    /// Frames whose warm answers were compared with cold ones, and with Coal's.
    compared: [usize; 2],
}

impl Bench {
    fn measure(&mut self, case: &Case, frames: usize, demands: &[DemandKind]) {
        let stage = case.motion(frames, &self.recordings).and_then(Stage::new);
        let stage = match stage {
            Ok(stage) => stage,
            Err(why) => return self.notes.push(format!("{}: skipped: {why}", case.name)),
        };
        // What a model makes at its first query is nobody's turn.
        stage.models.iter().for_each(|model| _ = model.clusters());
        let shapes = [Detector::RapierTrimesh, Detector::RapierDecomposition]
            .map(|detector| Shapes::new(&stage, detector));
        let mut coal = self.has_coal.then(|| Coal::start(&stage).ok()).flatten();
        for &kind in case.demands {
            if demands.is_empty() || demands.contains(&kind) {
                self.row(case, &stage, kind, &shapes, coal.as_mut());
            }
        }
    }

    fn row(
        &mut self,
        case: &Case,
        stage: &Stage,
        kind: DemandKind,
        shapes: &[Option<Shapes>; 2],
        coal: Option<&mut Coal>,
    ) {
        let demand = kind.of(&stage.motion);
        let mut warm = Ours::new(stage, demand, true);
        let mut cold = Ours::new(stage, demand, false);
        let mut parry = shapes
            .each_ref()
            .map(|shapes| shapes.as_ref().map(|shapes| Parry::new(stage, shapes, kind)));
        let mut coal = coal.map(|coal| CoalTurns {
            coal,
            kind,
            margin: demand.margin().unwrap_or(0.0),
            answers: vec![None; stage.len()],
        });
        let mut contestants: Vec<&mut dyn Contestant> = vec![&mut warm, &mut cold];
        let present = [parry[0].is_some(), parry[1].is_some(), coal.is_some()];
        contestants.extend(parry.iter_mut().flatten().map(|p| p as &mut dyn Contestant));
        contestants.extend(coal.as_mut().map(|c| c as &mut dyn Contestant));
        let mut times = take_turns(self.budget, stage.len(), &mut contestants).into_iter();
        let (Some(Some(first)), second) = (times.next(), times.next()) else {
            return self.differences.push(format!("{}: our query fails", case.name));
        };
        let peers = present.map(|present| if present { times.next().flatten() } else { None });
        self.compared[0] += check::compared(&warm.outcomes, &cold.outcomes);
        if let (Some(coal), DemandKind::Verdict | DemandKind::Distance) = (&coal, kind) {
            self.compared[1] += check::compared(&warm.outcomes, &coal.answers);
        }
        let failures = [
            check::warm_beside_cold(&warm.outcomes, &cold.outcomes),
            coal.as_ref().and_then(|c| check::beside_coal(stage, kind, &warm.outcomes, &c.answers)),
        ];
        let at = format!("{}, {}", case.name, kind.name());
        self.differences.extend(failures.into_iter().flatten().map(|what| format!("{at}: {what}")));
        let mut answers = digest::Digest::default();
        let mut tests = [0, 0];
        for Outcome { digest, counters, .. } in warm.outcomes.iter().flatten() {
            answers.word(*digest);
            tests[0] += counters.node_tests + counters.front_tested;
            tests[1] += counters.triangle_tests;
        }
        let [node_tests, triangle_tests] = tests.map(|tests| tests / stage.len() as u64);
        self.rows.push(Row {
            case: case.name.clone(),
            kind,
            warm: first,
            cold: second.flatten(),
            peers,
            otherwise: parry[1]
                .as_ref()
                .and_then(|parry| check::otherwise(&warm.outcomes, &parry.meets)),
            bytes: warm.bytes(),
            node_tests,
            triangle_tests,
            answers: answers.value(),
            poses: stage.pose_hash(),
        });
    }
}
