//! What a recording says of its run.

use std::collections::BTreeMap;

use cranny_ecs::Replay;
use cranny_record::{LogLevel, ReadError, Recording, StatsMessage, topic};

use super::plot::PlotSeries;

/// What a page says.
pub(super) struct Facts {
    pub(super) metadata: BTreeMap<String, String>,
    pub(super) stats: Vec<(f64, StatsMessage)>,
    /// Warnings and errors of the log.
    pub(super) warnings: Vec<String>,
    /// The text of the scene file.
    pub(super) scene: Option<String>,
    pub(super) deepest: Vec<Overlap>,
    /// Moving bodies, and others.
    pub(super) bodies: [usize; 2],
}

/// The deepest overlap of a pair.
#[derive(Clone, Debug)]
pub(super) struct Overlap {
    pub(super) a: String,
    pub(super) b: String,
    pub(super) depth: f64,
    pub(super) area: Option<f64>,
    pub(super) time: f64,
}

/// Pairs whose deepest overlap a page shows.
const OVERLAPS_SHOWN: usize = 3;

/// Phases that are no part of the simulation.
const BESIDE: [&str; 2] = [topic::MS_RECORD, topic::MS_RENDER];

/// A time of the log in seconds.
fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

impl Facts {
    pub(super) fn of(replay: &Replay) -> Result<Self, ReadError> {
        let recording = replay.recording();
        let stats = recording.stats()?.into_iter().map(|(at, found)| (seconds(at), found));
        let is_warning = |level: &LogLevel| *level >= LogLevel::Warning;
        let log = recording.log()?.into_iter().filter(|(_, (level, _))| is_warning(level));
        let bodies = recording.bodies()?.into_iter().map(|body| (body.name, body.kind));
        let bodies: BTreeMap<String, Option<String>> = bodies.collect();
        let moving = bodies.values().filter(|kind| kind.as_deref() != Some("fixed")).count();
        Ok(Self {
            metadata: recording.metadata(topic::METADATA).cloned().unwrap_or_default(),
            stats: stats.collect(),
            warnings: log.map(|(_, (_, text))| text).collect(),
            scene: scene_of(recording),
            deepest: deepest(replay),
            bodies: [moving, bodies.len() - moving],
        })
    }

    pub(super) fn fact(&self, key: &str) -> &str {
        self.metadata.get(key).map_or("", |value| value)
    }

    pub(super) fn last(&self) -> f64 {
        self.stats.last().map_or(0.0, |(time, _)| *time)
    }

    /// A number of every frame; `None` of a frame that has none.
    fn series(&self, name: &str, of: impl Fn(&StatsMessage) -> Option<f64>) -> PlotSeries {
        let points = self.stats.iter().filter_map(|(time, stats)| Some((*time, of(stats)?)));
        PlotSeries { name: name.to_owned(), points: points.collect() }
    }

    /// Whether contacts were reported, so that none means none. Recordings that name no effects
    /// are older than that: one contact is enough.
    pub(super) fn reports_contacts(&self) -> bool {
        let effects = self.fact(topic::EFFECTS_KEY);
        let some = || self.stats.iter().any(|(_, stats)| stats.contacts > 0);
        effects.split(", ").any(|name| name == "Contacts") || (effects.is_empty() && some())
    }

    /// Empty where none were reported.
    pub(super) fn contacts(&self) -> Vec<PlotSeries> {
        if !self.reports_contacts() {
            return Vec::new();
        }
        vec![
            self.series("contacts", |stats| Some(stats.contacts as f64)),
            self.series("pairs that touch", |stats| Some(stats.touching_pairs as f64)),
        ]
    }

    /// Empty where no contacts were reported.
    pub(super) fn depth(&self) -> Vec<PlotSeries> {
        if !self.reports_contacts() {
            return Vec::new();
        }
        let depth = |stats: &StatsMessage| Some(stats.deepest.as_ref().map_or(0.0, |d| d.depth));
        vec![self.series("deepest overlap", depth)]
    }

    /// Empty where no solver was there to move anything.
    pub(super) fn energy(&self) -> Vec<PlotSeries> {
        vec![self.series("energy", |stats| measure(stats, topic::ENERGY))]
    }

    /// Milliseconds a step, phase by phase of the simulation; those without cost are left out.
    pub(super) fn cost(&self) -> Vec<PlotSeries> {
        let simulated = topic::PHASES.iter().filter(|name| !BESIDE.contains(name));
        let phases = simulated.map(|name| {
            let words = name.trim_start_matches("ms_");
            self.series(words, |stats| measure(stats, name))
        });
        phases.filter(|series| series.points.iter().any(|point| point.1 > 0.0)).collect()
    }

    /// Milliseconds a step that recording and pictures took, mean over all frames.
    pub(super) fn beside(&self) -> [f64; 2] {
        let frames = self.stats.len().max(1) as f64;
        BESIDE.map(|name| {
            let all = self.stats.iter().filter_map(|(_, stats)| measure(stats, name));
            all.sum::<f64>() / frames
        })
    }

    /// Steps from frame to frame; 1 where there is a single one.
    pub(super) fn every(&self) -> u64 {
        let steps = self.stats.windows(2).map(|two| two[1].1.step.saturating_sub(two[0].1.step));
        steps.max().unwrap_or(1)
    }
}

fn measure(stats: &StatsMessage, name: &str) -> Option<f64> {
    stats.measures.iter().find(|measure| measure.name == name)?.value
}

fn scene_of(recording: &Recording) -> Option<String> {
    let attached = recording.attachments().iter().find(|file| file.name == "scene.ron")?;
    String::from_utf8(attached.data.clone()).ok()
}

/// The deepest overlap of each pair that has one; the deepest first.
fn deepest(replay: &Replay) -> Vec<Overlap> {
    let mut found: BTreeMap<(&str, &str), Overlap> = BTreeMap::new();
    for frame in replay.frames() {
        for pair in &frame.pairs {
            let depth = |region: &&cranny_record::RegionMessage| region.depth.unwrap_or(0.0);
            let regions = pair.regions.iter();
            let Some(region) = regions.max_by(|x, y| depth(x).total_cmp(&depth(y))) else {
                continue;
            };
            let depth = depth(&region);
            let key = (pair.a.as_str(), pair.b.as_str());
            if depth > found.get(&key).map_or(0.0, |overlap| overlap.depth) {
                let (a, b) = (pair.a.clone(), pair.b.clone());
                let overlap = Overlap { a, b, depth, area: region.area, time: frame.time };
                found.insert(key, overlap);
            }
        }
    }
    let mut all: Vec<Overlap> = found.into_values().collect();
    all.sort_by(|x, y| y.depth.total_cmp(&x.depth));
    all.truncate(OVERLAPS_SHOWN);
    all
}
