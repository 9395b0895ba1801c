//! Two bodies, queried in every way and judged by exact rationals.
//!
//! The oracle reads world coordinates, the product those in the frame of the pair's first body.
//! They are the same where posing rounds nothing: families use poses that turn axes to axes and
//! move by numbers with room to spare, or put the pair's first body where its mesh has it.

use cranny_certificate::verify;
use cranny_exact::{Interval, Meeting, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Answer, Containment, Demand, PairMemory, Placed, Query, QueryError, query,
};
use cranny_prover::{claim, filed, prove};
use cranny_testkit::{
    Contained, OracleVerdict, PosedMesh, Q, error_of_root, rational_gap_squared, rational_verdict,
};

use crate::case::{Case, PeerCase};
use crate::peer::PeerAnswer;
use crate::trial::Trial;

/// What is so of a pair.
pub(crate) struct Truth {
    verdict: OracleVerdict,
    /// Squared distance of the surfaces.
    gap: Q,
    /// Of the deepest region, where the case was made so that it is known.
    depth: Option<f64>,
    /// Diagonal of the larger body.
    size: f64,
    /// The largest length of the pair's arithmetic: both radii and the way between the origins.
    scale: f64,
}

/// What a posed coordinate or a constructed point may be off by, in scales: some hundred roundings.
const LENGTH_ERROR: f64 = 64.0 * f64::EPSILON;

/// A claimed interval of more than so many length errors says too little. One that is honest to
/// both sides takes two.
const WIDEST: f64 = 4.0;

/// Of a depth, in scales: where faces lie flush it is read beside there, 2^-28 to each side; twice
/// that passes.
const WIDEST_DEPTH: f64 = 1.0 / (1u64 << 26) as f64;

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
        let way = b.pose.translation.distance(a.pose.translation);
        let scale = a.model.radius() + b.model.radius() + way;
        Self { verdict, gap, depth, size, scale }
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
        words(self.verdict.surface, self.verdict.solid, self.contained(), Some(self.distance()))
    }
}

/// A verdict and a distance, where that is known, for people.
pub(crate) fn words(
    surface: Meeting,
    solid: bool,
    contained: Option<Containment>,
    distance: Option<f64>,
) -> String {
    let mut text = match (surface, distance) {
        (Meeting::None, Some(distance)) => format!("apart by {distance:.3e}"),
        (Meeting::None, None) => "apart".to_owned(),
        (Meeting::Touch, _) => "touch".to_owned(),
        (Meeting::Cross, _) => "cross".to_owned(),
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

/// An answer for people.
pub(crate) fn in_words(answer: &Answer) -> String {
    words(answer.surface, answer.solid, answer.contained, answer.distance)
}

/// All of an answer that does not depend on history.
pub(crate) fn without_counters(answer: Answer) -> Answer {
    Answer { counters: Default::default(), ..answer }
}

/// The demands of a pair.
pub(crate) const DEMANDS: [Demand; 4] = [
    Demand::Intersects,
    Demand::Distance { below: None },
    Demand::contacts(0.0),
    Demand::Regions { margin: 0.0 },
];

/// One query without history.
pub(crate) fn cold(a: Placed, b: Placed, demand: Demand) -> Result<Answer, QueryError> {
    query(a, b, &Query::of(demand), &mut PairMemory::default()).map(without_counters)
}

impl Trial<'_> {
    /// Queries a pair and keeps the case. `memory` is that of earlier cases, of whatever pairs.
    pub(crate) fn pair(
        &mut self,
        name: String,
        a: Placed,
        b: Placed,
        depth: Option<f64>,
        memory: &mut PairMemory,
    ) {
        self.case(name, |trial, case| {
            let truth = Truth::of(a, b, depth);
            trial.pair_of_truth(case, a, b, &truth, memory);
        });
    }

    fn pair_of_truth(
        &mut self,
        case: &mut Case,
        a: Placed,
        b: Placed,
        truth: &Truth,
        memory: &mut PairMemory,
    ) {
        case.truth = truth.words();
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
        if let Err(error) = judge(case, a, b, truth, memory) {
            case.faults.push(format!("refused: {error}"));
        }
    }

    fn peer_of_pair(
        &mut self,
        models: [&Model; 2],
        poses: [Pose; 2],
        truth: &Truth,
    ) -> Option<PeerCase> {
        let reply = self.peer.as_mut()?.surfaces(models, poses);
        Some(peer_case(reply, truth.clear(), truth.distance(), truth.size))
    }
}

/// A peer's answer beside the truth.
pub(crate) fn peer_case(
    reply: Result<PeerAnswer, String>,
    meets: Option<bool>,
    distance: f64,
    size: f64,
) -> PeerCase {
    match reply {
        Err(why) => PeerCase { answer: why, wrong: false, refused: true, figure: None },
        Ok(reply) => PeerCase {
            answer: match reply.meets {
                true => "meet".to_owned(),
                false => format!("apart by {:.3e}", reply.distance),
            },
            wrong: meets.is_some_and(|meets| meets != reply.meets),
            refused: false,
            figure: Some((reply.distance - distance).abs() / size),
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
        if found != expected {
            let found = in_words(&answer);
            case.faults.push(format!("{demand:?} says: {found}"));
        }
        // One body in one place, twice: exchanged, the question is the same.
        let exchanged = cold(b, a, demand)?;
        let back = if are_twins(a, b) { exchanged } else { exchanged.swapped() };
        if back != answer {
            case.faults.push(format!("{demand:?} differs with A and B exchanged"));
        }
        if without_counters(query(a, b, &Query::of(demand), memory)?) != answer {
            case.faults.push(format!("{demand:?} differs with memory"));
        }
        if answer.distance.is_some() {
            case.answer = in_words(&answer);
        }
        judge_lengths(case, &answer, demand, truth);
    }
    judge_certificate(case, a, b, &cold(a, b, Demand::Intersects)?);
    Ok(())
}

/// Whether nothing distinguishes the two: one model, one pose.
fn are_twins(a: Placed, b: Placed) -> bool {
    a.pose == b.pose && a.model.digest() == b.model.digest()
}

/// The verdict has a certificate, and that holds for the verifier.
fn judge_certificate(case: &mut Case, a: Placed, b: Placed, answer: &Answer) {
    let bodies = [a, b].map(|body| filed(body.model.mesh()));
    let bodies = bodies.each_ref();
    let claim = claim(answer.surface, answer.solid, answer.contained);
    match prove(&claim, [a, b], bodies) {
        Err(error) => case.faults.push(format!("no certificate: {error}")),
        Ok(certificate) => {
            if let Err(refusal) = verify(&claim, &certificate, bodies) {
                case.faults.push(format!("the certificate does not hold: {refusal}"));
            }
        }
    }
}

/// Distance, and depth where it is known, against the truth and against what is claimed of them.
fn judge_lengths(case: &mut Case, answer: &Answer, demand: Demand, truth: &Truth) {
    let Some(distance) = answer.distance else {
        if matches!(demand, Demand::Distance { .. } | Demand::Regions { .. }) {
            case.faults.push(format!("{demand:?} reports no distance"));
        }
        return;
    };
    if !distance.is_finite() {
        case.faults.push(format!("{demand:?} reports a distance of {distance}"));
        return;
    }
    let is_deep = truth.verdict.solid && truth.verdict.surface.meets();
    match (demand, truth.depth) {
        (Demand::Regions { .. }, Some(depth)) => judge_depth(case, answer, depth, truth.scale),
        // An interval of the depth of an overlap whose depth nobody knows.
        (Demand::Regions { .. }, None) if is_deep => {}
        _ => judge_distance(case, answer.separation, demand, distance, truth),
    }
    // The other way round, a gap far below the rounding of coordinates may be reported as 0.
    if truth.verdict.surface.meets() && distance != 0.0 {
        case.faults.push(format!("{demand:?} reports {distance:e} of surfaces that meet"));
    }
}

/// The squared gap lies between the squares of the ends, and the reported distance between the
/// ends.
fn judge_distance(case: &mut Case, claim: Interval, demand: Demand, distance: f64, truth: &Truth) {
    let square = |x: f64| Q::try_from(x.max(0.0)).map_or(Q::ZERO, |x| &x * &x);
    if truth.gap < square(claim.lo) || square(claim.hi) < truth.gap {
        case.faults.push(format!("{demand:?} claims {claim:?}"));
    }
    let error = error_of_root(distance, &truth.gap).abs();
    case.figure = Some(case.figure.unwrap_or(0.0).max(error / truth.size));
    let widest = WIDEST * LENGTH_ERROR * truth.scale;
    judge_claim(case, &format!("{demand:?}"), distance, error, claim, widest);
}

/// A depth that is known by construction.
fn judge_depth(case: &mut Case, answer: &Answer, depth: f64, scale: f64) {
    let claim = answer.separation;
    let Some(deepest) = answer.regions.iter().filter_map(|r| r.depth).reduce(f64::max) else {
        case.faults.push(format!("depth {depth:e}, but none is reported"));
        return;
    };
    if !claim.contains(-depth) {
        case.faults.push(format!("depth {depth:e} is not in {claim:?}, reported: {deepest:e}"));
    }
    let widest = (WIDEST * LENGTH_ERROR + WIDEST_DEPTH) * scale;
    judge_claim(case, "depth", -deepest, (deepest - depth).abs(), claim, widest);
}

/// The answer lies in its own interval, this is narrow, and the error is no larger than it
/// allows.
fn judge_claim(
    case: &mut Case,
    what: &str,
    reported: f64,
    error: f64,
    claim: Interval,
    widest: f64,
) {
    let width = claim.width();
    if !claim.contains(reported) {
        case.faults.push(format!("{what} reports {reported:e}, outside of {claim:?}"));
    }
    if width > widest || width.is_nan() {
        case.faults.push(format!("{what} claims a width of {width:e}, more than {widest:e}"));
    }
    let claimed = (claim.hi - reported).max(reported - claim.lo).max(0.0);
    let share = if error == 0.0 { 0.0 } else { error / claimed };
    case.of_claim = Some(case.of_claim.unwrap_or(0.0).max(share));
    if share > 1.0 || share.is_nan() {
        case.faults.push(format!("{what} is off by {error:e}, but claims {claimed:e}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::Settings;
    use cranny_exact::DVec3;
    use cranny_testkit::bodies::cuboid;

    /// The faults of lengths that are right but for what is altered in them.
    fn altered(height: f64, depth: Option<f64>, alter: impl Fn(&mut Answer)) -> Vec<String> {
        let mut trial = Trial::new("test", &Settings::DEFAULT, None);
        let boxes = [cuboid([0.0; 3], [4.0, 4.0, 1.0]), cuboid([0.0; 3], [1.0; 3])];
        let [a, b] = boxes.map(|mesh| trial.model("box", mesh).expect("boxes are models"));
        let a = Placed { model: &a, pose: Pose::IDENTITY };
        let b = Placed { model: &b, pose: Pose::at(DVec3::new(1.5, 1.5, height)) };
        let demand = Demand::Regions { margin: 0.0 };
        let mut answer = cold(a, b, demand).expect("plain poses");
        alter(&mut answer);
        let mut case = Case::default();
        judge_lengths(&mut case, &answer, demand, &Truth::of(a, b, depth));
        case.faults
    }

    fn is_reported(faults: &[String], what: &str) {
        assert!(faults.iter().any(|fault| fault.contains(what)), "{what}: {faults:?}");
    }

    /// A and B exchanged are the same question there, so the answer stays as it is.
    #[test]
    fn one_body_in_one_place_twice_is_no_fault() {
        let mut trial = Trial::new("test", &Settings::DEFAULT, None);
        let cube = trial.model("box", cuboid([0.0; 3], [1.0; 3])).expect("a box is a model");
        for pose in [Pose::IDENTITY, Pose::at(DVec3::new(0.5, -2.0, 3.0))] {
            let twin = Placed { model: &cube, pose };
            let mut case = Case::default();
            let truth = Truth::of(twin, twin, None);
            judge(&mut case, twin, twin, &truth, &mut PairMemory::default()).expect("a pose");
            assert_eq!(case.faults, [""; 0]);
        }
    }

    #[test]
    fn a_distance_is_told_in_a_narrow_interval_of_its_own() {
        assert_eq!(altered(1.25, None, |_| {}), [""; 0]);
        is_reported(&altered(1.25, None, |x| x.distance = None), "no distance");
        is_reported(&altered(1.25, None, |x| x.distance = Some(0.5)), "outside of");
        is_reported(&altered(1.25, None, |x| x.separation.lo = 0.0), "a width of");
        is_reported(&altered(1.25, None, |x| x.separation = Interval::WHOLE), "a width of");
        is_reported(&altered(1.25, None, |x| x.separation.hi = f64::NAN), "outside of");
        let near = 0.25f64.next_up();
        let too_sure = |x: &mut Answer| {
            (x.distance, x.separation) = (Some(near), Interval::point(near));
        };
        is_reported(&altered(1.25, None, too_sure), "but claims 0");
        is_reported(&altered(1.0, None, |x| x.separation.hi = 1.0), "a width of");
        is_reported(&altered(1.0, None, |x| x.separation = Interval::point(1.0)), "outside of");
    }

    #[test]
    fn the_depth_reported_is_judged_beside_its_interval() {
        let deepen = |by: f64| {
            altered(0.75, Some(0.25), |x| {
                for region in &mut x.regions {
                    region.depth = region.depth.map(|depth| by * depth);
                }
            })
        };
        assert_eq!(deepen(1.0), [""; 0]);
        for by in [0.0, 0.5, 2.0] {
            is_reported(&deepen(by), "outside of");
        }
        is_reported(&altered(0.75, Some(0.25), |x| x.regions.clear()), "none is reported");
        is_reported(&altered(0.75, Some(0.25), |x| x.separation.lo = -1.0), "a width of");
    }

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
        trial.case("case".to_owned(), |trial, case| {
            trial.pair_of_truth(case, a, at(height), &truth, &mut Default::default());
        });
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
        is_reported(&found, "claims");
    }

    #[test]
    fn a_depth_is_held_against_its_interval() {
        assert_eq!(faults(0.75, 0.75, Some(0.25)), [""; 0]);
        let found = faults(0.75, 0.75, Some(0.25 + 1e-3));
        assert!(found.iter().any(|fault| fault.contains("depth")), "{found:?}");
    }

    #[test]
    fn a_peer_may_say_either_of_what_only_touches() {
        let reply = |meets| Ok(PeerAnswer { meets, distance: 0.5 });
        let wrong = |meets, truth| peer_case(reply(meets), truth, 0.25, 2.0).wrong;
        assert!(wrong(true, Some(false)) && wrong(false, Some(true)));
        assert!(!wrong(true, None) && !wrong(false, None) && !wrong(true, Some(true)));
        assert_eq!(peer_case(reply(false), None, 0.25, 2.0).figure, Some(0.125));
        assert!(peer_case(Err("no".to_owned()), None, 0.25, 2.0).refused);
    }
}
