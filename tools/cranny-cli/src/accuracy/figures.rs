//! One method's figures over all poses: its answers, judged by what is so.

use cranny_exact::DVec3;
use serde::Serialize;

use super::method::{ContactAnswer, Name, PoseAnswer};
use super::motion::Judged;
use super::panel::Panel;
use super::series::Reply;
use super::truth::Truth;

/// A row of the report. Lengths are in units of the meshes; `None`: nothing that could be said or
/// judged.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MethodFigures {
    #[serde(flatten)]
    pub(super) name: Name,
    pub(super) poses: usize,
    pub(super) median_us: Option<f64>,
    pub(super) p99_us: Option<f64>,
    pub(super) tests_mean: Option<f64>,
    pub(super) false_negatives: usize,
    pub(super) false_positives: usize,
    pub(super) open: usize,
    /// Intervals that do not hold the distance.
    pub(super) outside: usize,
    pub(super) width_mean: Option<f64>,
    pub(super) width_max: Option<f64>,
    pub(super) distance_error_mean: Option<f64>,
    pub(super) distance_error_max: Option<f64>,
    pub(super) witness_error_mean: Option<f64>,
    pub(super) witness_error_max: Option<f64>,
    /// Poses at which bodies are in contact, and where that is was demanded.
    pub(super) contact_poses: usize,
    pub(super) contact_median_us: Option<f64>,
    pub(super) contact_p99_us: Option<f64>,
    /// Places reported, a pose.
    pub(super) contacts_mean: Option<f64>,
    /// Regions of contact at poses where no place was reported.
    pub(super) contacts_missed: usize,
    pub(super) contact_error_mean: Option<f64>,
    pub(super) contact_error_max: Option<f64>,
    /// Distances, where bodies are apart.
    pub(super) apart: Panel,
    /// Depths, where they overlap.
    pub(super) overlapping: Panel,
    /// Why there are no figures.
    pub(super) note: Option<String>,
}

impl MethodFigures {
    /// Of a method that could not be run.
    pub(super) fn none(name: Name, note: String) -> Self {
        Self { note: Some(note), ..Self::of(name, &[], &[]) }
    }

    /// Judges answers about distances, and about contacts.
    pub(super) fn judged(
        judged: &Judged,
        name: Name,
        distances: &[Reply<PoseAnswer>],
        contacts: &[Reply<ContactAnswer>],
    ) -> Self {
        let truths = &judged.truths;
        let row = Self {
            apart: Panel::of_distances(judged, distances),
            overlapping: Panel::of_depths(judged, contacts),
            ..Self::of(name, distances, contacts)
        };
        row.with_verdicts(truths, distances)
            .with_lengths(truths, distances)
            .with_contacts(truths, contacts)
    }

    /// With times only.
    fn of(name: Name, distances: &[Reply<PoseAnswer>], contacts: &[Reply<ContactAnswer>]) -> Self {
        let (times, contact_times) = (micros(distances), micros(contacts));
        Self {
            name,
            poses: distances.len(),
            median_us: quantile(&times, 50),
            p99_us: quantile(&times, 99),
            tests_mean: mean(distances.iter().filter_map(|r| Some(r.found.tests? as f64))),
            false_negatives: 0,
            false_positives: 0,
            open: 0,
            outside: 0,
            width_mean: None,
            width_max: None,
            distance_error_mean: None,
            distance_error_max: None,
            witness_error_mean: None,
            witness_error_max: None,
            contact_poses: contacts.len(),
            contact_median_us: quantile(&contact_times, 50),
            contact_p99_us: quantile(&contact_times, 99),
            contacts_mean: mean(contacts.iter().map(|reply| reply.found.points.len() as f64)),
            contacts_missed: 0,
            contact_error_mean: None,
            contact_error_max: None,
            apart: Panel::default(),
            overlapping: Panel::default(),
            note: None,
        }
    }

    fn with_verdicts(mut self, truths: &[Truth], replies: &[Reply<PoseAnswer>]) -> Self {
        for (truth, found) in beside_truth(truths, replies) {
            match found.meets {
                None => self.open += 1,
                Some(false) if truth.meets => self.false_negatives += 1,
                Some(true) if !truth.meets => self.false_positives += 1,
                Some(_) => {}
            }
            let held = found.held.unwrap_or(truth.held);
            self.outside += usize::from(held.lo > truth.held.hi || held.hi < truth.held.lo);
        }
        self
    }

    fn with_lengths(self, truths: &[Truth], replies: &[Reply<PoseAnswer>]) -> Self {
        let widths: Vec<f64> = replies.iter().filter_map(|r| Some(r.found.held?.width())).collect();
        let of = |error: fn(&Truth, &PoseAnswer) -> Option<f64>| -> Vec<f64> {
            beside_truth(truths, replies).filter_map(|(truth, found)| error(truth, found)).collect()
        };
        let (distances, witnesses) = (of(distance_error), of(witness_error));
        Self {
            width_mean: mean(widths.iter().copied()),
            width_max: most(&widths),
            distance_error_mean: mean(distances.iter().copied()),
            distance_error_max: most(&distances),
            witness_error_mean: mean(witnesses.iter().copied()),
            witness_error_max: most(&witnesses),
            ..self
        }
    }

    /// How far each region's deepest contact is from the nearest place reported.
    fn with_contacts(mut self, truths: &[Truth], replies: &[Reply<ContactAnswer>]) -> Self {
        let mut errors = Vec::new();
        for reply in replies {
            let regions = &truths[reply.pose].contacts;
            if reply.found.points.is_empty() {
                self.contacts_missed += regions.len();
                continue;
            }
            let nearest = |p: &DVec3| {
                reply.found.points.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min)
            };
            errors.extend(regions.iter().map(nearest));
        }
        self.contact_error_mean = mean(errors.iter().copied());
        self.contact_error_max = most(&errors);
        self
    }
}

fn beside_truth<'a>(
    truths: &'a [Truth],
    replies: &'a [Reply<PoseAnswer>],
) -> impl Iterator<Item = (&'a Truth, &'a PoseAnswer)> {
    replies.iter().map(|reply| (&truths[reply.pose], &reply.found))
}

/// Of the distance between the surfaces. Who takes bodies for solids reports 0 where one lies
/// within the other, which is no error.
fn distance_error(truth: &Truth, found: &PoseAnswer) -> Option<f64> {
    let distance = found.distance?;
    let is_of_solids = truth.contained && distance == 0.0;
    (!is_of_solids).then(|| (distance - truth.distance).abs())
}

/// How far witness points are from the exact ones, the farther of the two.
pub(super) fn witness_error(truth: &Truth, found: &PoseAnswer) -> Option<f64> {
    let ([p, q], [v, w]) = (truth.witnesses?, found.witnesses?);
    Some(p.distance(v).max(q.distance(w)))
}

/// Ascending.
fn micros<T>(replies: &[Reply<T>]) -> Vec<f64> {
    let mut micros: Vec<f64> = replies.iter().map(Reply::micros).collect();
    micros.sort_unstable_by(f64::total_cmp);
    micros
}

/// Of sorted values.
pub(super) fn quantile(sorted: &[f64], percent: usize) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    sorted.get((sorted.len() * percent / 100).min(last)).copied()
}

pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), x| (sum + x, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

pub(super) fn most(values: &[f64]) -> Option<f64> {
    values.iter().copied().reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use cranny_exact::{Interval, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};

    use super::*;
    use crate::accuracy::motion::Motion;

    #[test]
    fn quantiles_means_and_greatest() {
        let sorted: Vec<f64> = (0..100).map(f64::from).collect();
        assert_eq!((quantile(&sorted, 50), quantile(&sorted, 99)), (Some(50.0), Some(99.0)));
        assert_eq!((quantile(&[7.0], 99), quantile(&[], 50)), (Some(7.0), None));
        assert_eq!((mean([1.0, 2.0, 6.0].into_iter()), mean([].into_iter())), (Some(3.0), None));
        assert_eq!((most(&[1.0, 3.0, 2.0]), most(&[])), (Some(3.0), None));
    }

    /// Apart by 2; meeting; one in the other, 0.5 from its wall.
    pub(in crate::accuracy) fn judged_three() -> Judged {
        let tetrahedron = || {
            let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
            let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            let mesh = Mesh::new(corners, faces).unwrap();
            Model::build(mesh, &BuildOptions::default()).unwrap().0
        };
        let motion = Motion::of_pair([tetrahedron(), tetrahedron()], &[[Pose::IDENTITY; 2]; 3]);
        Judged { motion, truths: truths() }
    }

    fn truths() -> Vec<Truth> {
        let apart = Truth {
            meets: false,
            contained: false,
            distance: 2.0,
            held: Interval::around(2.0, 1e-15),
            witnesses: Some([DVec3::ZERO, 2.0 * DVec3::X]),
            contacts: Vec::new(),
            depth: 0.0,
        };
        let meeting = Truth {
            meets: true,
            distance: 0.0,
            held: Interval::point(0.0),
            witnesses: None,
            contacts: vec![DVec3::ZERO, DVec3::Y],
            depth: 0.25,
            ..apart.clone()
        };
        let within = Truth {
            contained: true,
            distance: 0.5,
            held: Interval::point(0.5),
            contacts: Vec::new(),
            depth: 0.0,
            ..meeting.clone()
        };
        vec![apart, meeting, within]
    }

    fn judged(found: [PoseAnswer; 3], contacts: Vec<Vec<DVec3>>) -> MethodFigures {
        let reply = |pose, found| Reply { pose, time: Duration::from_micros(7), found };
        let replies: Vec<_> =
            found.into_iter().enumerate().map(|(pose, found)| reply(pose, found)).collect();
        let time = Duration::from_micros(9);
        let contacts: Vec<_> = contacts
            .into_iter()
            .map(|points| {
                let depth = Some(Interval::point(0.25 * points.len() as f64));
                Reply {
                    pose: 1,
                    time,
                    found: ContactAnswer { meets: Some(!points.is_empty()), points, depth },
                }
            })
            .collect();
        MethodFigures::judged(&judged_three(), Name::of_peer("it"), &replies, &contacts)
    }

    fn found(meets: Option<bool>, distance: f64) -> PoseAnswer {
        PoseAnswer { meets, distance: Some(distance), ..PoseAnswer::default() }
    }

    #[test]
    fn verdicts_are_judged_one_by_one() {
        let row =
            judged([found(Some(true), 2.0), found(Some(false), 0.0), found(None, 0.5)], Vec::new());
        assert_eq!((row.false_negatives, row.false_positives, row.open), (1, 1, 1));
        assert_eq!((row.poses, row.median_us, row.p99_us), (3, Some(7.0), Some(7.0)));
        assert_eq!(row.distance_error_max, Some(0.0));
    }

    #[test]
    fn intervals_that_do_not_hold_the_distance_are_counted() {
        let holding = |lo, hi| PoseAnswer { held: Some(Interval { lo, hi }), ..found(None, hi) };
        let row = judged([holding(1.0, 1.5), holding(0.0, 0.75), holding(0.25, 0.5)], Vec::new());
        assert_eq!((row.outside, row.width_mean, row.width_max), (1, Some(0.5), Some(0.75)));
        let row = judged([holding(2.5, 3.0), holding(0.0, 0.0), holding(0.0, 1.0)], Vec::new());
        assert_eq!(row.outside, 1);
    }

    #[test]
    fn solids_in_each_other_have_no_distance_and_hollow_ones_do() {
        let apart = found(Some(false), 2.25);
        let solid = judged([apart.clone(), found(Some(true), 0.0), found(Some(true), 0.0)], vec![]);
        assert_eq!(
            (solid.distance_error_max, solid.distance_error_mean),
            (Some(0.25), Some(0.125))
        );
        let hollow = judged([apart, found(Some(true), 0.0), found(Some(false), 1.5)], vec![]);
        assert_eq!(hollow.distance_error_max, Some(1.0));
        assert_eq!(hollow.false_negatives, 1);
    }

    #[test]
    fn witnesses_are_compared_where_bodies_are_apart() {
        let with = |points| PoseAnswer { witnesses: Some(points), ..found(None, 0.0) };
        let points = [3.0 * DVec3::Y, DVec3::X];
        let row = judged([with(points), with(points), with(points)], Vec::new());
        assert_eq!((row.witness_error_mean, row.witness_error_max), (Some(3.0), Some(3.0)));
    }

    #[test]
    fn regions_near_which_nothing_was_found_are_missed_not_passed_over() {
        let nothing = [found(None, 0.0), found(None, 0.0), found(None, 0.0)];
        let row = judged(nothing, vec![vec![DVec3::ZERO, 0.5 * DVec3::Y], Vec::new()]);
        assert_eq!((row.contact_poses, row.contacts_missed), (2, 2));
        assert_eq!((row.contacts_mean, row.contact_median_us), (Some(1.0), Some(9.0)));
        assert_eq!((row.contact_error_mean, row.contact_error_max), (Some(0.25), Some(0.5)));
    }
}
