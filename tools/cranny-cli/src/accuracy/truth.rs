//! Exact answers, by which all others are judged.

use cranny_exact::{DVec3, Interval};
use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};

use crate::pose_file::PosePair;

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
}

/// The truth at each pose.
///
/// # Errors
///
/// A pose that cannot be queried, in words.
pub(super) fn truths([a, b]: [&Model; 2], poses: &[PosePair]) -> Result<Vec<Truth>, String> {
    let mut memory = PairMemory::default();
    let question = Query::of(Demand::Regions { margin: 0.0 });
    let truth = |(index, &[pose_a, pose_b]): (usize, &PosePair)| -> Result<Truth, String> {
        let (a, b) = (Placed { model: a, pose: pose_a }, Placed { model: b, pose: pose_b });
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
        })
    };
    poses.iter().enumerate().map(truth).collect()
}
