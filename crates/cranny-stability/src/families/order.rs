//! The same bodies filed in another order, scaled or exchanged.

use cranny_exact::{DVec3, Meeting, Pose};
use cranny_geometry::Mesh;
use cranny_narrow_phase::{Answer, Demand, Placed};
use cranny_testkit::bodies::quarter_turns;

use super::DISTANCE_ERROR;
use crate::bodies::{hollows, mapped, small_bodies};
use crate::case::Case;
use crate::family::Family;
use crate::pair::{Truth, cold};
use crate::trial::Trial;

pub(super) const FAMILY: Family = Family {
    name: "order",
    asked: "Bodies touching, crossing or apart; then their vertices and faces in another order and each face from \
            another corner on, A and B exchanged, everything 2^-40 to 2^40 times as large.",
    made: "The first filing is judged by exact rationals; all others must agree with it.",
    fails: "another verdict or number of triangle pairs; a distance outside the first one's certified interval; \
            exchanged, any difference",
    figure: DISTANCE_ERROR,
    cases,
};

fn cases(trial: &mut Trial<'_>) {
    let (hollows, small, turns) = (hollows(), small_bodies(), quarter_turns());
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

fn shuffle<T>(trial: &mut Trial<'_>, items: &mut [T]) {
    for i in (1..items.len()).rev() {
        items.swap(i, trial.rng.below(i + 1));
    }
}

/// The same surface, filed in another order.
fn refiled(trial: &mut Trial<'_>, mesh: &Mesh) -> Mesh {
    let count = mesh.vertices().len();
    let mut order: Vec<usize> = (0..count).collect();
    shuffle(trial, &mut order);
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
    shuffle(trial, &mut faces);
    Mesh::new(vertices, faces).unwrap_or_else(|_| mesh.clone())
}

fn one(trial: &mut Trial<'_>, name: String, meshes: [Mesh; 2], pose: Pose) {
    let power = trial.rng.between(-40, 40);
    let scale = 2f64.powi(power);
    let refiled = [refiled(trial, &meshes[0]), refiled(trial, &meshes[1])];
    let scaled = meshes.each_ref().map(|mesh| mapped(mesh, |p| scale * p));
    let scaled_pose = Pose { translation: scale * pose.translation, ..pose };
    let filings = [
        ("as filed", meshes, pose, 1.0),
        ("refiled", refiled, pose, 1.0),
        ("scaled", scaled, scaled_pose, scale),
    ];
    let mut case = Case { name: format!("{name}, 2^{power}"), ..Case::default() };
    let mut first: Option<Answer> = None;
    for (what, [a, b], pose, scale) in filings {
        let (Some(a), Some(b)) = (trial.model(what, a), trial.model(what, b)) else { return };
        let placed_a = Placed { model: &a, pose: Pose::IDENTITY };
        let placed_b = Placed { model: &b, pose };
        let demand = Demand::Regions { margin: 0.0 };
        let pair = (cold(placed_a, placed_b, demand), cold(placed_b, placed_a, demand));
        let (Ok(answer), Ok(back)) = pair else {
            case.faults.push(format!("{what}: refused"));
            continue;
        };
        if back.swapped() != answer {
            case.faults.push(format!("{what}: differs with A and B exchanged"));
        }
        match &first {
            None => {
                let truth = Truth::of(placed_a, placed_b, None);
                let mut memory = Default::default();
                let told = format!("{name}, as filed");
                trial.pair_of_truth(told, placed_a, placed_b, &truth, &mut memory);
                first = Some(answer);
            }
            Some(first) => differences(&mut case, first, &answer, what, scale),
        }
    }
    if let Some(first) = first {
        case.truth = "as filed first".to_owned();
        case.told = format!("{:?}, {:?} apart", first.surface, first.distance);
        let size = DVec3::splat(4.0).length();
        case.figure = case.figure.map(|error| error / size);
        trial.push(case);
    }
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
