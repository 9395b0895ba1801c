//! Rows of the table, and what they come to by demand.

use super::catalog::Case;
use super::demand::DemandKind;
use crate::report::{Cell, Report, Table, geometric_mean, times};
use crate::turns::Times;

/// A case with a demand.
pub(super) struct Row {
    pub(super) case: String,
    pub(super) kind: DemandKind,
    pub(super) warm: Times,
    pub(super) cold: Option<Times>,
    /// parry's meshes, its decompositions, Coal.
    pub(super) peers: [Option<Times>; 3],
    /// Percentage of the decompositions' verdicts that are wrong for the meshes.
    pub(super) otherwise: Option<f64>,
    /// Bytes of memory a pair.
    pub(super) bytes: usize,
    /// Mean tests a frame, with memory.
    pub(super) node_tests: u64,
    pub(super) triangle_tests: u64,
    /// Hashes of all answers and of all poses.
    pub(super) answers: u64,
    pub(super) poses: u64,
}

/// Ours without memory, and the peers.
const OTHERS: [&str; 4] = ["cold", "parry mesh", "parry decomposition", "Coal"];

impl Row {
    /// Medians of the [`OTHERS`] in multiples of our warm one.
    fn ratios(&self) -> [Option<f64>; 4] {
        let [mesh, decomposition, coal] = &self.peers;
        [&self.cold, mesh, decomposition, coal]
            .map(|times| times.as_ref().map(|times| times.over(&self.warm)))
    }

    fn spread(&self) -> f64 {
        self.warm.p99() / self.warm.median()
    }

    fn cells(&self, only_ratios: bool) -> Vec<Cell> {
        let micros = |seconds: f64| Cell::Micros(seconds * 1e6);
        let mut cells = vec![Cell::Text(self.case.clone()), Cell::Text(self.kind.name().into())];
        if only_ratios {
            cells.push(Cell::Ratio(self.spread()));
        } else {
            cells.extend([self.warm.median(), self.warm.p99()].map(micros));
            let cold = [Times::median, Times::p99].map(|of| self.cold.as_ref().map(of));
            cells.extend(cold.map(|cold| cold.map_or(Cell::Absent, micros)));
        }
        cells.extend(self.ratios().map(|ratio| ratio.map_or(Cell::Absent, Cell::Ratio)));
        cells
            .push(self.otherwise.map_or(Cell::Absent, |share| Cell::Text(format!("{share:.0} %"))));
        if !only_ratios {
            cells.push(Cell::Count(self.bytes / 1024));
            let counts = [self.node_tests, self.triangle_tests];
            cells.extend(counts.map(|count| Cell::Count(count as usize)));
            let hashes = [self.answers, self.poses];
            cells.extend(hashes.map(|hash| Cell::Text(format!("{:08x}", hash as u32))));
        }
        cells
    }
}

/// The table of all rows, then geometric means and least ratios by demand.
pub(super) fn report(rows: &[Row], mut notes: Vec<String>, only_ratios: bool) -> Report {
    let mut columns = vec!["case", "demand"];
    columns.extend(if only_ratios {
        &["p99 / warm"][..]
    } else {
        &["warm", "p99", "cold", "cold p99"]
    });
    columns.extend(OTHERS);
    columns.push("otherwise");
    if !only_ratios {
        columns.extend(["KiB", "nodes", "triangles", "answers", "poses"]);
    }
    let mut all = vec![
        "a frame, all pairs whose boxes overlap within the margin; thread CPU time, best of some turns, median over frames".into(),
        "p99: the 99th hundredth without the first frame; cold ones may be of fewer frames".into(),
        "warm: memory kept from frame to frame; cold: none; ratios of medians over the same frames: that column / warm".into(),
        "otherwise: share of the decompositions' verdicts that differ from the meshes'; there its times are of another question".into(),
        "Coal: in a process of its own, less the cost of the call from Python; below a microsecond its ratio is vague".into(),
        "KiB of memory a pair; nodes, triangles: pairs compared a frame, warm; answers, poses: hashes".into(),
    ];
    all.append(&mut notes);
    let means = DemandKind::ALL.into_iter().filter_map(|kind| mean_row(rows, kind)).collect();
    Report {
        title: "Entangled pairs",
        notes: all,
        tables: vec![
            Table {
                title: "A frame",
                columns,
                rows: rows.iter().map(|row| row.cells(only_ratios)).collect(),
            },
            Table {
                title: "Geometric mean (least) of all cases",
                columns: [&["demand", "cases", "p99 / warm, most"][..], &OTHERS].concat(),
                rows: means,
            },
        ],
    }
}

fn mean_row(rows: &[Row], kind: DemandKind) -> Option<Vec<Cell>> {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.kind == kind).collect();
    let most = rows.iter().map(|row| row.spread()).max_by(f64::total_cmp)?;
    let mut cells =
        vec![Cell::Text(kind.name().into()), Cell::Count(rows.len()), Cell::Ratio(most)];
    for other in 0..OTHERS.len() {
        let ratios: Vec<f64> = rows.iter().filter_map(|row| row.ratios()[other]).collect();
        let least = ratios.iter().copied().min_by(f64::total_cmp);
        cells.push(match least {
            Some(least) => {
                Cell::Text(format!("{} ({})", times(geometric_mean(&ratios)), times(least)))
            }
            None => Cell::Absent,
        });
    }
    Some(cells)
}

/// Names of cases.
pub(super) fn list(cases: &[Case]) -> Report {
    let row = |case: &Case| {
        let demands: Vec<&str> = case.demands.iter().map(|demand| demand.name()).collect();
        let when = if case.on_request { "on request" } else { "" };
        vec![
            Cell::Text(case.name.clone()),
            Cell::Text(demands.join(", ")),
            Cell::Count(case.frames),
            Cell::Text(when.into()),
        ]
    };
    Report {
        title: "Entangled pairs",
        notes: Vec::new(),
        tables: vec![Table {
            title: "Cases",
            columns: vec!["case", "demands", "frames", "runs"],
            rows: cases.iter().map(row).collect(),
        }],
    }
}
