//! Bodies that touch exactly, both of them posed, judged by exact rationals: by the library and by
//! the command.

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Meeting};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Answer, Containment, Demand, PairMemory, Placed, Query, query};
use cranny_testkit::{Contained, OracleVerdict, Rng, rational_verdict};
use serde_json::{Value, json};

use crate::dyadic::{Placement, axis_rotations, quartered, solids};
use crate::harness::{Folder, run};

/// Feature contacts tried for each pair of solids.
const TRIES: usize = 36;

/// How a contact was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Made {
    /// A vertex, edge or face point of A on one of B's.
    Feature(Kind, Kind),
    /// The same solid in the same place, turned by a symmetry of the axes.
    Coincident,
    /// The solid and its quarter, brought together at a feature of each that correspond.
    Nested,
    /// As feature contacts, then slid along an axis.
    Slid,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Vertex,
    Edge,
    Face,
}

const KINDS: [Kind; 3] = [Kind::Vertex, Kind::Edge, Kind::Face];

struct Case {
    made: Made,
    a: Placement,
    b: Placement,
}

/// Two solids and how they are placed.
struct Trial {
    names: [&'static str; 2],
    meshes: [Mesh; 2],
    cases: Vec<Case>,
}

/// A point of a feature: a corner, the middle of a side, or a point inside a face.
fn feature_point(mesh: &Mesh, kind: Kind, face: usize, corner: usize) -> DVec3 {
    let corner_at = |i: usize| mesh.vertices()[mesh.faces()[face][i % 3] as usize];
    let [p, q, r] = [corner_at(corner), corner_at(corner + 1), corner_at(corner + 2)];
    match kind {
        Kind::Vertex => p,
        Kind::Edge => 0.5 * (p + q),
        Kind::Face => 0.25 * (2.0 * p + q + r),
    }
}

fn trials() -> Vec<Trial> {
    let mut rng = Rng::new(0x70c4);
    let solids = solids();
    let mut trials = Vec::new();
    for (i, (name_a, a)) in solids.iter().enumerate() {
        for (name_b, b) in &solids[..=i] {
            let cases = (0..TRIES).map(|n| feature_contact(a, b, n, &mut rng)).collect();
            let meshes = [a.clone(), b.clone()];
            trials.push(Trial { names: [name_a, name_b], meshes, cases });
        }
        let cases = axis_rotations()
            .into_iter()
            .step_by(4)
            .map(|turn| coincidence(a, Placement::turned(turn), &mut rng))
            .collect();
        trials.push(Trial { names: [name_a; 2], meshes: [a.clone(), a.clone()], cases });
        let small = quartered(a);
        let cases = (0..TRIES).map(|n| nesting(a, &small, n, &mut rng)).collect();
        trials.push(Trial { names: [name_a, "its quarter"], meshes: [a.clone(), small], cases });
    }
    trials
}

fn feature_contact(a: &Mesh, b: &Mesh, n: usize, rng: &mut Rng) -> Case {
    let kinds = [KINDS[n % 3], KINDS[n / 3 % 3]];
    let mut point =
        |mesh: &Mesh, kind| feature_point(mesh, kind, rng.below(mesh.faces().len()), rng.below(3));
    let (p, q) = (point(a, kinds[0]), point(b, kinds[1]));
    let (place_a, place_b) = (Placement::random(rng), Placement::random(rng));
    let place_b = place_b.bringing(q, place_a.apply(p));
    if n % 4 != 3 {
        return Case { made: Made::Feature(kinds[0], kinds[1]), a: place_a, b: place_b };
    }
    let axis = [DVec3::X, DVec3::Y, DVec3::Z][rng.below(3)];
    let by = f64::from(rng.between(-4, 4)) / 16.0 * axis;
    Case { made: Made::Slid, a: place_a, b: place_b.moved(by) }
}

/// Turns B about the centre of its box, so that symmetric solids coincide with themselves.
fn coincidence(mesh: &Mesh, turn: Placement, rng: &mut Rng) -> Case {
    let center = mesh.bounds().center();
    let world = Placement::random(rng);
    let turned = turn.bringing(center, center);
    Case { made: Made::Coincident, a: world, b: world.after(&turned) }
}

/// Shrinks A about one of its features: where A is convex around it, the quarter lies inside.
fn nesting(a: &Mesh, small: &Mesh, n: usize, rng: &mut Rng) -> Case {
    let (face, corner) = (rng.below(a.faces().len()), rng.below(3));
    let point = |mesh| feature_point(mesh, KINDS[n % 3], face, corner);
    let inner = Placement::IDENTITY.bringing(point(small), point(a));
    let world = Placement::random(rng);
    Case { made: Made::Nested, a: world, b: world.after(&inner) }
}

fn named(contained: Option<Containment>) -> Option<&'static str> {
    contained.map(|contained| match contained {
        Containment::AInB => "A_in_B",
        Containment::BInA => "B_in_A",
    })
}

fn exchanged(contained: Option<Containment>) -> Option<Containment> {
    contained.map(Containment::swapped)
}

/// What must be said where the oracle says this. Of two equal solids neither is *inside* the other.
fn expected(verdict: &OracleVerdict) -> Option<Containment> {
    match verdict.contained {
        Some(Contained::AInB) => Some(Containment::AInB),
        Some(Contained::BInA) => Some(Containment::BInA),
        Some(Contained::Coincident) | None => None,
    }
}

fn ask(models: [&Model; 2], poses: [Placement; 2], demand: Demand) -> Answer {
    let [a, b] = [0, 1].map(|i| Placed { model: models[i], pose: poses[i].pose() });
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

/// What the library gets wrong of a case; empty where nothing.
fn complaints(models: [&Model; 2], case: &Case, verdict: &OracleVerdict) -> Vec<String> {
    let demands =
        [Demand::Intersects, Demand::Distance { below: None }, Demand::Regions { margin: 0.0 }];
    let mut complaints = Vec::new();
    for demand in demands {
        let answer = ask(models, [case.a, case.b], demand);
        let back = ask([models[1], models[0]], [case.b, case.a], demand);
        let mut check = |what: &str, right: bool| {
            if !right {
                complaints.push(format!("{demand:?}: {what}: {answer:?}"));
            }
        };
        check("surface", answer.surface == verdict.surface);
        check("solid", answer.solid == verdict.solid);
        check("contained", answer.contained == expected(verdict));
        check("swapped surface", back.surface == answer.surface);
        check("swapped solid", back.solid == answer.solid);
        check("swapped contained", exchanged(back.contained) == answer.contained);
        check("swapped distance", back.distance == answer.distance);
        if let Some(distance) = answer.distance {
            check("distance", (distance == 0.0) == verdict.surface.meets());
        }
    }
    complaints
}

/// How many poses of each sort were met.
#[derive(Debug, Default)]
struct Census {
    touching: usize,
    touching_by: BTreeMap<Made, usize>,
    /// Touching, and one inside the other.
    nested: usize,
    /// Touching everywhere: equal solids.
    coincident: usize,
    /// Touching from outside.
    beside: usize,
}

impl Census {
    fn count(&mut self, made: Made, verdict: &OracleVerdict) {
        if verdict.surface != Meeting::Touch {
            return;
        }
        self.touching += 1;
        *self.touching_by.entry(made).or_default() += 1;
        match verdict.contained {
            Some(Contained::Coincident) => self.coincident += 1,
            Some(_) => self.nested += 1,
            None => self.beside += usize::from(!verdict.solid),
        }
    }

    fn assert_rich(&self) {
        println!("{self:?}");
        assert!(self.touching >= 200, "{self:?}");
        assert!(self.nested >= 20 && self.coincident >= 20 && self.beside >= 100, "{self:?}");
        for a in KINDS {
            for b in KINDS {
                assert!(self.touching_by[&Made::Feature(a, b)] >= 5, "{a:?} on {b:?}: {self:?}");
            }
        }
    }
}

#[test]
fn touching_bodies_are_judged_as_rationals_judge_them() {
    let mut census = Census::default();
    let mut wrong = Vec::new();
    for trial in trials() {
        let models = trial
            .meshes
            .each_ref()
            .map(|mesh| Model::build(mesh.clone(), &BuildOptions::default()).unwrap().0);
        let [mesh_a, mesh_b] = &trial.meshes;
        let mut verdicts = Vec::new();
        for case in &trial.cases {
            let verdict = rational_verdict(mesh_a, &case.a.pose(), mesh_b, &case.b.pose());
            census.count(case.made, &verdict);
            for complaint in complaints([&models[0], &models[1]], case, &verdict) {
                wrong.push(describe(&trial, case, &verdict, &complaint));
            }
            verdicts.push(verdict);
        }
        for (case, verdict, line) in command_lines(&trial, &verdicts) {
            let agrees = line["surface"] == surface_name(verdict.surface)
                && line["solid"] == verdict.solid
                && line["contained"] == json!(named(expected(verdict)));
            if !agrees {
                wrong.push(describe(&trial, case, verdict, &format!("command: {line}")));
            }
        }
    }
    census.assert_rich();
    assert!(wrong.is_empty(), "{} complaints:\n{}", wrong.len(), wrong.join("\n"));
}

/// The trial by the command.
fn command_lines<'a>(
    trial: &'a Trial,
    verdicts: &'a [OracleVerdict],
) -> Vec<(&'a Case, &'a OracleVerdict, Value)> {
    let folder = Folder::new();
    let a = folder.mesh("a.obj", &trial.meshes[0]);
    let b = folder.mesh("b.obj", &trial.meshes[1]);
    let entry = |case: &Case| json!({"a": case.a.row_major(), "b": case.b.row_major()});
    let poses: Vec<Value> = trial.cases.iter().map(entry).collect();
    let poses = folder.write("poses.json", Value::Array(poses).to_string());
    let outcome = run(&["query", &a, &b, "--poses", &poses, "--certificate"]);
    let lines = outcome.json_lines();
    assert_eq!(lines.len(), trial.cases.len());
    let verified = run(&["verify", &folder.write("certificates.jsonl", &outcome.stdout)]);
    assert_eq!(verified.code, Some(0), "{:?}: {verified:?}", trial.names);
    trial.cases.iter().zip(verdicts).zip(lines).map(|((c, v), line)| (c, v, line)).collect()
}

fn surface_name(surface: Meeting) -> &'static str {
    match surface {
        Meeting::None => "none",
        Meeting::Touch => "touch",
        Meeting::Cross => "cross",
    }
}

/// Enough to do it again.
fn describe(trial: &Trial, case: &Case, verdict: &OracleVerdict, complaint: &str) -> String {
    let (a, b) = (case.a.row_major(), case.b.row_major());
    let complaint: String = complaint.chars().take(400).collect();
    format!("{:?} {:?}\n  a {a:?}\n  b {b:?}\n  {verdict:?}\n  {complaint}", trial.names, case.made)
}
