//! The same bodies filed in another order, scaled or exchanged.

use cranny_exact::{Meeting, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::{Answer, Demand, Placed};
use cranny_testkit::bodies::quarter_turns;

use super::DISTANCE_ERROR;
use crate::bodies::{hollows, small_bodies};
use crate::case::Case;
use crate::family::Family;
use crate::pair::{cold, in_words};
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "order",
    question: "Bodies touching, crossing or apart; then their vertices and faces in another order and each face from \
            another corner on, A and B exchanged, everything 2^-40 to 2^40 times as large.",
    made: "The first filing is judged by exact rationals, as a case of its own; all others must agree with it.",
    fails: "a filing that is refused; another verdict or number of triangle pairs; a distance outside the first one's \
            certified interval; exchanged, any difference",
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let (hollows, small, turns) = (hollows(), small_bodies(trial), quarter_turns());
    for _ in 0..trial.variants {
        for _ in 0..24 {
            let (name_a, a) = trial.pick(&hollows).clone();
            let (name_b, b) = trial.pick(&small).clone();
            let rotation = *trial.pick(&turns);
            let pose = Pose { rotation, translation: trial.quarters(3) };
            one(trial, format!("{name_b} in {name_a}"), [a, b], pose);
        }
    }
}

/// The same surface, filed in another order.
fn refiled(trial: &mut Trial<'_>, name: &str, mesh: &Mesh) -> Option<Mesh> {
    let count = mesh.vertices().len();
    let mut order: Vec<usize> = (0..count).collect();
    trial.rng.shuffle(&mut order);
    let mut place = vec![0; count];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new as u32;
    }
    let vertices = order.iter().map(|&old| mesh.vertices()[old]).collect();
    let mut faces: Vec<[u32; 3]> =
        mesh.faces().iter().map(|face| face.map(|v| place[v as usize])).collect();
    for face in &mut faces {
        face.rotate_left(trial.rng.below(3));
    }
    trial.rng.shuffle(&mut faces);
    trial.meshed(name, vertices, faces)
}

fn one(trial: &mut Trial<'_>, name: String, [a, b]: [Mesh; 2], pose: Pose) {
    let power = trial.rng.between(-40, 40);
    let scale = 2f64.powi(power);
    let refiled = [refiled(trial, "refiled", &a), refiled(trial, "refiled", &b)];
    let scaled = [&a, &b].map(|mesh| trial.mapped("scaled", mesh, |p| scale * p));
    let scaled_pose = Pose { translation: scale * pose.translation, ..pose };
    let Some(first) = filed(trial, &format!("{name}, as filed"), [Some(a), Some(b)]) else {
        return;
    };
    let [placed_a, placed_b] = first.placed(pose);
    let as_filed = format!("{name}, as filed");
    trial.pair(as_filed, placed_a, placed_b, None, &mut Default::default());
    let others = [("refiled", refiled, pose, 1.0), ("scaled", scaled, scaled_pose, scale)];
    let others = others.map(|(what, meshes, pose, scale)| {
        (what, filed(trial, &format!("{name}, {what}"), meshes), pose, scale)
    });
    trial.case(format!("{name}, 2^{power}"), |_, case| {
        case.truth = "as filed first".to_owned();
        let Some(reference) = both_ways(case, "as filed", &first, pose) else { return };
        case.answer = in_words(&reference);
        for (what, filing, pose, scale) in others {
            let Some(filing) = filing else { continue };
            if let Some(answer) = both_ways(case, what, &filing, pose) {
                differences(case, &reference, &answer, what, scale);
            }
        }
        case.figure = case.figure.map(|error| error / first.size());
    });
}

/// Two models.
struct Filing([Model; 2]);

impl Filing {
    fn placed(&self, pose: Pose) -> [Placed<'_>; 2] {
        let [a, b] = &self.0;
        [Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose }]
    }

    /// The larger body's.
    fn size(&self) -> f64 {
        let [a, b] = self.0.each_ref().map(|model| model.bounds().diagonal());
        a.max(b)
    }
}

/// Models of what became meshes; `None`, and a case that failed, where one does not.
fn filed(trial: &mut Trial<'_>, name: &str, [a, b]: [Option<Mesh>; 2]) -> Option<Filing> {
    Some(Filing([trial.model(name, a?)?, trial.model(name, b?)?]))
}

/// The answer, which A and B exchanged must not change; a refusal is a fault.
fn both_ways(case: &mut Case, what: &str, filing: &Filing, pose: Pose) -> Option<Answer> {
    let [a, b] = filing.placed(pose);
    let demand = Demand::Regions { margin: 0.0 };
    let (Ok(answer), Ok(back)) = (cold(a, b, demand), cold(b, a, demand)) else {
        case.faults.push(format!("{what}: refused"));
        return None;
    };
    if back.swapped() != answer {
        case.faults.push(format!("{what}: differs with A and B exchanged"));
    }
    Some(answer)
}

fn differences(case: &mut Case, first: &Answer, other: &Answer, what: &str, scale: f64) {
    let verdict = |x: &Answer| (x.surface, x.solid, x.contained, x.triangle_pairs);
    if verdict(first) != verdict(other) {
        let (x, y) = (verdict(first), verdict(other));
        case.faults.push(format!("{what}: {y:?}, not {x:?}"));
    }
    let (Some(near), Some(far)) = (first.distance, other.distance) else { return };
    let far = far / scale;
    case.figure = Some(case.figure.unwrap_or(0.0).max((far - near).abs()));
    if first.surface == Meeting::None && !first.separation.contains(far) {
        case.faults.push(format!("{what}: {far:e} apart, not in {:?}", first.separation));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;
    use cranny_exact::DVec3;
    use cranny_testkit::bodies::cuboid;

    #[test]
    fn a_refused_filing_is_a_case_with_its_fault() {
        let mut trial = Trial::new("test", &Settings::DEFAULT, None);
        let cube = cuboid([0.0; 3], [1.0; 3]);
        one(&mut trial, "boxes".to_owned(), [cube.clone(), cube.clone()], Pose::at(DVec3::X));
        one(&mut trial, "nowhere".to_owned(), [cube.clone(), cube], Pose::at(DVec3::NAN));
        let cases = trial.finish().cases;
        assert_eq!(cases.iter().filter(|case| case.faults.is_empty()).count(), 2);
        let last = cases.last().expect("cases");
        assert!(last.name.starts_with("nowhere") && last.faults == ["as filed: refused"]);
    }
}
