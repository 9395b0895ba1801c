//! Two bodies, asked about in every way and judged by exact rationals.
//!
//! The oracle reads world coordinates, the product those in the frame of the pair's first body. They are the
//! same where posing rounds nothing: families use poses that turn axes to axes and move by numbers with room
//! to spare, or put the pair's first body where its mesh has it.

use cranny_exact::{Meeting, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Answer, Containment, Demand, PairMemory, Placed, Query, QueryError, query,
};
use cranny_testkit::{
    Contained, OracleVerdict, PosedMesh, Q, error_of_root, rational_gap_squared, rational_verdict,
};

use crate::case::{Case, PeerCase};
use crate::peer::PeerAnswer;
use crate::trial::{Trial, caught};

/// What is so of a pair.
pub(crate) struct Truth {
    verdict: OracleVerdict,
    /// Squared distance of the surfaces.
    gap: Q,
    /// Of the deepest region, where the case was made so that it is known.
    depth: Option<f64>,
    /// Diagonal of the larger body.
    size: f64,
}

impl Truth {
    /// In rationals.
    pub(crate) fn of(a: Placed, b: Placed, depth: Option<f64>) -> Self {
        let verdict = rational_verdict(a.model.mesh(), &a.pose, b.model.mesh(), &b.pose);
        let posed = |p: Placed| PosedMesh::new(p.model.mesh(), &p.pose);
        let gap = match verdict.surface {
            Meeting::None => rational_gap_squared(&posed(a), &posed(b)),
            _ => Q::ZERO,
        };
        let size = a.model.bounds().diagonal().max(b.model.bounds().diagonal());
        Self { verdict, gap, depth, size }
    }

    fn contained(&self) -> Option<Containment> {
        // Coincident solids lie in each other; neither is wholly inside the other.
        match self.verdict.contained? {
            Contained::AInB => Some(Containment::AInB),
            Contained::BInA => Some(Containment::BInA),
            Contained::Coincident => None,
        }
    }

    fn distance(&self) -> f64 {
        self.gap.to_f64().value().sqrt()
    }

    /// Whether a detector of surfaces must say that they meet; `None` where they only touch.
    fn clear(&self) -> Option<bool> {
        match (self.verdict.surface, self.verdict.solid) {
            (Meeting::None, _) => Some(false),
            (Meeting::Touch, false) => None,
            (Meeting::Touch, true) | (Meeting::Cross, _) => Some(true),
        }
    }

    fn words(&self) -> String {
        words(self.verdict.surface, self.verdict.solid, self.contained(), self.distance())
    }
}

fn words(surface: Meeting, solid: bool, contained: Option<Containment>, distance: f64) -> String {
    let mut text = match surface {
        Meeting::None => format!("apart by {distance:.3e}"),
        Meeting::Touch => "touch".to_owned(),
        Meeting::Cross => "cross".to_owned(),
    };
    if solid {
        text += ", interiors meet";
    }
    match contained {
        Some(Containment::AInB) => text += ", A in B",
        Some(Containment::BInA) => text += ", B in A",
        None => {}
    }
    text
}

/// All of an answer that does not depend on history.
pub(crate) fn told(answer: Answer) -> Answer {
    Answer { counters: Default::default(), ..answer }
}

/// What may be asked about a pair.
pub(crate) const DEMANDS: [Demand; 4] = [
    Demand::Intersects,
    Demand::Distance { below: None },
    Demand::Contacts { margin: 0.0 },
    Demand::Regions { margin: 0.0 },
];

/// One that is asked without history.
pub(crate) fn cold(a: Placed, b: Placed, demand: Demand) -> Result<Answer, QueryError> {
    query(a, b, &Query::of(demand), &mut PairMemory::default()).map(told)
}

impl Trial<'_> {
    /// Asks about a pair and keeps the case. `memory` is that of earlier cases, of whatever pairs.
    pub(crate) fn pair(
        &mut self,
        name: String,
        a: Placed,
        b: Placed,
        depth: Option<f64>,
        memory: &mut PairMemory,
    ) {
        let truth = Truth::of(a, b, depth);
        self.pair_of_truth(name, a, b, &truth, memory);
    }

    pub(crate) fn pair_of_truth(
        &mut self,
        name: String,
        a: Placed,
        b: Placed,
        truth: &Truth,
        memory: &mut PairMemory,
    ) {
        let mut case = Case { name, truth: truth.words(), ..Case::default() };
        match caught(|| judge(&mut case, a, b, truth, memory)) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => case.faults.push(format!("refused: {error}")),
            Err(fault) => case.faults.push(fault),
        }
        self.count(
            match (truth.verdict.surface, truth.verdict.solid) {
                (Meeting::None, false) => "apart",
                (Meeting::None, true) => "one in the other",
                (Meeting::Touch, false) => "touching",
                (Meeting::Touch, true) => "touching, interiors meet",
                (Meeting::Cross, _) => "crossing",
            },
            1,
        );
        case.peer = self.peer_of_pair([a.model, b.model], [a.pose, b.pose], truth);
        self.push(case);
    }

    fn peer_of_pair(
        &mut self,
        models: [&Model; 2],
        poses: [Pose; 2],
        truth: &Truth,
    ) -> Option<PeerCase> {
        let told = self.peer.as_mut()?.surfaces(models, poses);
        Some(peer_case(told, truth.clear(), truth.distance(), truth.size))
    }
}

/// A peer's answer beside the truth.
pub(crate) fn peer_case(
    told: Result<PeerAnswer, String>,
    meets: Option<bool>,
    distance: f64,
    size: f64,
) -> PeerCase {
    match told {
        Err(why) => PeerCase { told: why, wrong: false, refused: true, figure: None },
        Ok(told) => PeerCase {
            told: match told.meets {
                true => "meet".to_owned(),
                false => format!("apart by {:.3e}", told.distance),
            },
            wrong: meets.is_some_and(|meets| meets != told.meets),
            refused: false,
            figure: Some((told.distance - distance).abs() / size),
        },
    }
}

/// Every demand, without history and with it, as given and with A and B exchanged.
fn judge(
    case: &mut Case,
    a: Placed,
    b: Placed,
    truth: &Truth,
    memory: &mut PairMemory,
) -> Result<(), QueryError> {
    let expected = (truth.verdict.surface, truth.verdict.solid, truth.contained());
    for demand in DEMANDS {
        let answer = cold(a, b, demand)?;
        let found = (answer.surface, answer.solid, answer.contained);
        let distance = answer.distance.unwrap_or_else(|| truth.distance());
        if found != expected {
            let found = words(found.0, found.1, found.2, distance);
            case.faults.push(format!("{demand:?} says: {found}"));
        }
        if cold(b, a, demand)?.swapped() != answer {
            case.faults.push(format!("{demand:?} differs with A and B exchanged"));
        }
        if told(query(a, b, &Query::of(demand), memory)?) != answer {
            case.faults.push(format!("{demand:?} differs with memory"));
        }
        if let Some(distance) = answer.distance {
            case.told = words(answer.surface, answer.solid, answer.contained, distance);
            judge_lengths(case, &answer, demand, distance, truth);
        }
    }
    Ok(())
}

/// Distance, and depth where it is known, against what is claimed of them.
fn judge_lengths(case: &mut Case, answer: &Answer, demand: Demand, distance: f64, truth: &Truth) {
    let claim = answer.separation;
    if !distance.is_finite() {
        case.faults.push(format!("{demand:?} tells a distance of {distance}"));
        return;
    }
    let meets = truth.verdict.surface.meets();
    let error = error_of_root(distance, &truth.gap).abs();
    // The other way round, a gap far below the rounding of coordinates may be told to be 0.
    if meets && distance != 0.0 {
        case.faults.push(format!("{demand:?} tells {distance:e} of surfaces that meet"));
    }
    if !meets {
        let square = |x: f64| Q::try_from(x.max(0.0)).map_or(Q::ZERO, |x| &x * &x);
        if truth.gap < square(claim.lo) || square(claim.hi) < truth.gap {
            case.faults.push(format!("{demand:?} claims {claim:?}"));
        }
        note_error(case, error, claim.hi - distance, truth.size);
    }
    if let (Demand::Regions { .. }, Some(depth)) = (demand, truth.depth) {
        let deepest = answer.regions.iter().filter_map(|region| region.depth).fold(0.0, f64::max);
        if !claim.contains(-depth) {
            case.faults.push(format!("depth {depth:e} is not in {claim:?}, told: {deepest:e}"));
        }
        let claimed = (0.5 * claim.width()).max(f64::MIN_POSITIVE);
        let share = (deepest - depth).abs() / claimed;
        case.of_claim = Some(case.of_claim.unwrap_or(0.0).max(share));
    }
}

/// Keeps the larger error.
fn note_error(case: &mut Case, error: f64, claimed: f64, size: f64) {
    case.figure = Some(case.figure.unwrap_or(0.0).max(error / size));
    let share = if claimed > 0.0 { error / claimed } else { 0.0 };
    case.of_claim = Some(case.of_claim.unwrap_or(0.0).max(share));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::Settings;
    use cranny_exact::DVec3;
    use cranny_testkit::bodies::cuboid;

    /// The faults of a case, judged by the truth of another height.
    fn faults(height: f64, truth_at: f64, depth: Option<f64>) -> Vec<String> {
        let mut trial = Trial::new("test", &Settings::DEFAULT, None);
        let [slab, cube] = [cuboid([0.0; 3], [4.0, 4.0, 1.0]), cuboid([0.0; 3], [1.0; 3])];
        let (Some(slab), Some(cube)) = (trial.model("slab", slab), trial.model("cube", cube))
        else {
            panic!("boxes are models");
        };
        let a = Placed { model: &slab, pose: Pose::IDENTITY };
        let at = |z| Placed { model: &cube, pose: Pose::at(DVec3::new(1.5, 1.5, z)) };
        let truth = Truth::of(a, at(truth_at), depth);
        trial.pair_of_truth("case".to_owned(), a, at(height), &truth, &mut Default::default());
        trial.finish().cases.remove(0).faults
    }

    #[test]
    fn right_answers_have_no_fault_and_wrong_ones_have() {
        let hair = 0.5f64.powi(50);
        for height in [1.0, 1.0 + hair, 1.0 - hair, 1.25] {
            assert_eq!(faults(height, height, None), [""; 0], "{height}");
        }
        for (height, truth_at) in [(1.0 + 4.0 * hair, 1.0), (1.0, 1.0 - hair), (1.0 - hair, 1.0)] {
            let found = faults(height, truth_at, None);
            assert!(found.iter().any(|fault| fault.contains("says")), "{found:?}");
        }
        let found = faults(1.25, 1.25 + 1e-12, None);
        assert!(found.iter().all(|fault| fault.contains("claims")) && !found.is_empty());
    }

    #[test]
    fn a_depth_is_held_against_its_interval() {
        assert_eq!(faults(0.75, 0.75, Some(0.25)), [""; 0]);
        let found = faults(0.75, 0.75, Some(0.25 + 1e-3));
        assert!(found.iter().any(|fault| fault.contains("depth")), "{found:?}");
    }

    #[test]
    fn a_peer_may_say_either_of_what_only_touches() {
        let told = |meets| Ok(PeerAnswer { meets, distance: 0.5 });
        let wrong = |meets, truth| peer_case(told(meets), truth, 0.25, 2.0).wrong;
        assert!(wrong(true, Some(false)) && wrong(false, Some(true)));
        assert!(!wrong(true, None) && !wrong(false, None) && !wrong(true, Some(true)));
        assert_eq!(peer_case(told(false), None, 0.25, 2.0).figure, Some(0.125));
        assert!(peer_case(Err("no".to_owned()), None, 0.25, 2.0).refused);
    }
}
