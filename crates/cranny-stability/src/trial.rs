//! A family at work: its random numbers, and the cases that it has reported.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_testkit::Rng;

use crate::case::{Case, Outcome};
use crate::family::Settings;
use crate::peer::Peer;

/// What comes of something that must not panic: a panic is a fault of whoever is judged.
pub(crate) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        format!("panicked: {}", text.unwrap_or("without a word"))
    })
}

/// What a family writes its cases into.
pub(crate) struct Trial<'p> {
    family: &'static str,
    pub(crate) rng: Rng,
    pub(crate) variants: u32,
    pub(crate) peer: Option<&'p mut dyn Peer>,
    cases: Vec<Case>,
    counts: BTreeMap<&'static str, u64>,
}

impl<'p> Trial<'p> {
    pub(crate) fn new(
        family: &'static str,
        settings: &Settings,
        peer: Option<&'p mut dyn Peer>,
    ) -> Self {
        // A family's numbers depend on its name, not on which families run before it.
        let name = family.bytes().fold(0u64, |sum, byte| sum.wrapping_mul(31) + u64::from(byte));
        Self {
            family,
            rng: Rng::new(settings.seed ^ name << 32),
            variants: settings.variants,
            peer,
            cases: Vec::new(),
            counts: BTreeMap::new(),
        }
    }

    pub(crate) fn push(&mut self, case: Case) {
        self.cases.push(case);
    }

    /// One case; whatever becomes of `judge`, be it a panic, it is kept.
    pub(crate) fn case(&mut self, name: String, judge: impl FnOnce(&mut Self, &mut Case)) {
        let mut case = Case { name, ..Case::default() };
        if let Err(fault) = caught(|| judge(self, &mut case)) {
            case.faults.push(fault);
        }
        self.push(case);
    }

    /// A case that could not even be posed.
    pub(crate) fn failed(&mut self, name: &str, fault: String) {
        self.push(Case { name: name.to_owned(), faults: vec![fault], ..Case::default() });
    }

    pub(crate) fn count(&mut self, what: &'static str, by: u64) {
        *self.counts.entry(what).or_default() += by;
    }

    pub(crate) fn finish(self) -> Outcome {
        let Self { family, cases, counts, .. } = self;
        Outcome { family, cases, counts, time: Duration::ZERO }
    }

    /// A model; a mesh that is refused is a case that failed.
    pub(crate) fn model(&mut self, name: &str, mesh: Mesh) -> Option<Model> {
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        let built = caught(|| Model::build(mesh, &options).map_err(|error| error.to_string()));
        match built.and_then(|built| built) {
            Ok((model, _)) => Some(model),
            Err(fault) => {
                self.failed(name, fault);
                None
            }
        }
    }

    /// The same faces over moved vertices; where these are no mesh, that is a case that failed.
    pub(crate) fn mapped(
        &mut self,
        name: &str,
        mesh: &Mesh,
        map: impl Fn(DVec3) -> DVec3,
    ) -> Option<Mesh> {
        let vertices = mesh.vertices().iter().map(|&p| map(p)).collect();
        self.meshed(name, vertices, mesh.faces().to_vec())
    }

    /// Turned and moved for good: coordinates are rounded here, and poses need round nothing.
    pub(crate) fn baked(
        &mut self,
        name: &str,
        mesh: &Mesh,
        turn: DMat3,
        by: DVec3,
    ) -> Option<Mesh> {
        self.mapped(name, mesh, |p| turn * p + by)
    }

    /// A mesh; one that is refused is a case that failed.
    pub(crate) fn meshed(
        &mut self,
        name: &str,
        vertices: Vec<DVec3>,
        faces: Vec<[u32; 3]>,
    ) -> Option<Mesh> {
        let refused = |error| self.failed(name, format!("no mesh: {error}"));
        Mesh::new(vertices, faces).map_err(refused).ok()
    }

    /// One of some.
    pub(crate) fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.rng.below(from.len())]
    }

    /// A multiple of a quarter of at most `reach` in each coordinate.
    pub(crate) fn quarters(&mut self, reach: i32) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| 0.25 * f64::from(self.rng.between(-4 * reach, 4 * reach))))
    }

    /// A turn by a small angle, to first order, about an axis of the frame, a diagonal or anything.
    pub(crate) fn tilt(&mut self, angle: f64) -> DQuat {
        let axis = match self.rng.below(4) {
            0 => DVec3::X,
            1 => DVec3::new(1.0, 1.0, 0.0).normalize(),
            2 => DVec3::new(0.6, 0.0, 0.8),
            _ => self.rng.direction(),
        };
        let half = 0.5 * angle * axis;
        DQuat::from_xyzw(half.x, half.y, half.z, 1.0).normalize()
    }

    /// An orthonormal frame, rounded.
    pub(crate) fn frame(&mut self) -> DMat3 {
        DMat3::from_quat(self.rng.rotation())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_testkit::bodies::cuboid;

    #[test]
    fn what_is_refused_or_panics_is_a_case_that_failed() {
        let mut trial = Trial::new("test", &Settings::DEFAULT, None);
        let cube = cuboid([0.0; 3], [1.0; 3]);
        assert!(trial.mapped("moved", &cube, |p| p + DVec3::X).is_some());
        assert!(trial.mapped("burst", &cube, |p| p / 0.0).is_none());
        trial.case("begun".to_owned(), |_, case| {
            case.answer = "half an answer".to_owned();
            panic!("halfway");
        });
        trial.case("next".to_owned(), |_, _| {});
        let outcome = trial.finish();
        assert_eq!((outcome.cases.len(), outcome.failed()), (3, 2));
        let [burst, begun, _] = &outcome.cases[..] else { panic!("three cases") };
        assert!(burst.name == "burst" && burst.faults[0].contains("no mesh"));
        assert!(begun.answer == "half an answer" && begun.faults[0].contains("halfway"));
    }
}
