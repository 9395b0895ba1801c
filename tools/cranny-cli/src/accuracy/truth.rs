//! Exact answers, by which all others are judged.

use cranny_exact::{DVec3, Interval};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};

use super::motion::Motion;

/// What is so at a pose.
#[derive(Clone, Debug)]
pub(super) struct Truth {
    /// The bodies share a point.
    pub(super) meets: bool,
    /// They do, but their surfaces do not: one lies within the other.
    pub(super) contained: bool,
    /// Between the surfaces; 0 where they meet.
    pub(super) distance: f64,
    /// Holds that distance whatever was rounded.
    pub(super) held: Interval,
    /// Where surfaces that do not meet are nearest.
    pub(super) witnesses: Option<[DVec3; 2]>,
    /// Of each region that overlaps, half-way between the deepest contact's points.
    pub(super) contacts: Vec<DVec3>,
    /// How deep the bodies overlap, >= 0.
    pub(super) depth: f64,
}

impl Truth {
    /// Returns whether the bodies have a region in common, which has a depth.
    pub(super) fn overlaps(&self) -> bool {
        !self.contacts.is_empty()
    }
}

/// The truth at each pose.
///
/// # Errors
///
/// A pose that cannot be queried, in words.
pub(super) fn truths(motion: &Motion) -> Result<Vec<Truth>, String> {
    let mut memory = PairMemory::default();
    let question = Query::of(Demand::Regions { margin: 0.0 });
    let mut truth = |index: usize| -> Result<Truth, String> {
        if motion.begins(index) {
            memory = PairMemory::default();
        }
        let posed = motion.posed(index);
        let [a, b] = [0, 1].map(|i| Placed { model: posed.models[i], pose: posed.poses[i] });
        let answer =
            query(a, b, &question, &mut memory).map_err(|e| format!("pose {index}: {e}"))?;
        let surfaces_meet = answer.surface.meets();
        let distance = answer.distance.unwrap_or(f64::INFINITY);
        Ok(Truth {
            meets: answer.solid || surfaces_meet,
            contained: answer.solid && !surfaces_meet,
            distance,
            held: match answer.separation.contains(distance) {
                true => answer.separation,
                false => Interval::point(distance),
            },
            witnesses: answer.witnesses.filter(|_| !surfaces_meet).map(|w| w.map(|w| w.point)),
            contacts: answer
                .regions
                .iter()
                .map(|r| 0.5 * (r.deepest.point_a + r.deepest.point_b))
                .collect(),
            depth: answer.depth(),
        })
    };
    (0..motion.len()).map(&mut truth).collect()
}
