//! Numbers over time.

use std::collections::BTreeMap;

use cranny_record::{StatsMessage, topic};

use crate::archetypes::Scalars;
use crate::error::RerunError;
use crate::source::Source;
use crate::stream::{Stream, path};

/// The group of all plots.
pub(crate) const GROUP: &str = "plots";

/// A number over log times.
pub(crate) type Series = Vec<(u64, f64)>;

/// Series by group and name.
pub(crate) type Groups<'a> = BTreeMap<&'a str, BTreeMap<&'a str, Series>>;

/// A group, a name, and what it counts.
type Count = (&'static str, &'static str, fn(&StatsMessage) -> f64);

/// What every frame counts. The deepest overlap is 0 where none is known.
const COUNTS: [Count; 10] = [
    ("contacts", "contacts", |stats| stats.contacts as f64),
    ("contacts", "regions", |stats| stats.regions as f64),
    ("contacts", "touching_pairs", |stats| stats.touching_pairs as f64),
    ("contacts", "queried_pairs", |stats| stats.queried_pairs as f64),
    ("depth", "deepest", |stats| stats.deepest.as_ref().map_or(0.0, |deepest| deepest.depth)),
    ("tests", "boxes", |stats| stats.box_tests as f64),
    ("tests", "nodes", |stats| stats.node_tests as f64),
    ("tests", "triangles", |stats| stats.triangle_tests as f64),
    ("tests", "points_inside", |stats| stats.inside_tests as f64),
    ("tests", "estimates", |stats| stats.estimate_tests as f64),
];

/// All series of a recording.
pub(crate) fn groups(stats: &[(u64, StatsMessage)]) -> Groups<'_> {
    let mut groups = Groups::new();
    let mut add = |group, name, time, value| {
        let series = groups.entry(group).or_default();
        series.entry(name).or_default().push((time, value));
    };
    for (time, stats) in stats {
        for (group, name, count) in COUNTS {
            add(group, name, *time, count(stats));
        }
        for measure in &stats.measures {
            let Some(value) = measure.value else { continue };
            let (group, name) = place(&measure.name);
            add(group, name, *time, value);
        }
    }
    groups
}

/// Where a measure stands.
fn place(name: &str) -> (&str, &str) {
    match name {
        topic::ENERGY => ("energy", name),
        _ => match name.strip_prefix("ms_").filter(|_| topic::PHASES.contains(&name)) {
            Some(phase) => ("milliseconds", phase),
            None => ("measures", name),
        },
    }
}

/// Writes all series.
pub(crate) fn tell(stream: &Stream, source: &Source) -> Result<(), RerunError> {
    for (group, series) in groups(&source.stats) {
        for (name, values) in series {
            stream.rows(&path(&[GROUP, group], name), &values, |rows| {
                let values = Scalars::new(rows.iter().map(|(_, value)| *value));
                Ok(values.columns_of_unit_batches()?.collect())
            })?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_have_their_places() {
        assert_eq!(place("ms_narrow"), ("milliseconds", "narrow"));
        assert_eq!(place("energy"), ("energy", "energy"));
        assert_eq!(place("ms_elsewhere"), ("measures", "ms_elsewhere"));
    }
}
