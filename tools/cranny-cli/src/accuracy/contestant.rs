//! A method and its questions, or why it could not be run.

use std::time::Duration;

use cranny_exact::DVec3;
use cranny_rapier::Detector;

use super::Scene;
use super::figures::MethodFigures;
use super::method::{Method, Name, PoseAnswer};
use super::ours::Ours;
use super::peer::Peer;
use super::series::{Reply, Series};
use crate::parry::quietly;

/// One of those that are compared.
pub(super) struct MethodContestant {
    name: Name,
    state: Result<Measured, String>,
}

struct Measured {
    method: Box<dyn Method>,
    distances: Series<PoseAnswer>,
    contacts: Series<Vec<DVec3>>,
}

impl MethodContestant {
    /// Ours: a panic of it is a bug, and ends the command.
    pub(super) fn ours(scene: &Scene, method: Ours, patience: Duration) -> Self {
        Self { name: method.name(), state: Ok(Measured::planned(scene, method, patience)) }
    }

    /// A peer, prepared. Where it refuses a mesh, or panics, its row will say so.
    pub(super) fn peer(scene: &Scene, kind: Detector, patience: Duration) -> Self {
        let state = quietly(|| {
            Peer::new(kind, scene.models).map(|peer| Measured::planned(scene, peer, patience))
        });
        Self { name: Peer::name_of(kind), state }
    }

    /// Asks everything once more.
    pub(super) fn run(&mut self, scene: &Scene) {
        let Ok(measured) = &mut self.state else { return };
        if self.name.is_ours() {
            measured.run(scene);
        } else if let Err(note) = quietly(|| {
            measured.run(scene);
            Ok(())
        }) {
            self.state = Err(note);
        }
    }

    /// Its answers, judged.
    pub(super) fn figures(&self, scene: &Scene) -> MethodFigures {
        let name = self.name.clone();
        match &self.state {
            Err(note) => MethodFigures::none(name, note.clone()),
            Ok(Measured { distances, contacts, .. }) => {
                MethodFigures::judged(&scene.truths, name, &distances.replies, &contacts.replies)
            }
        }
    }

    /// Its answer at each pose.
    pub(super) fn replies(&self) -> (&Name, &[Reply<PoseAnswer>]) {
        (&self.name, self.state.as_ref().map_or(&[], |measured| &measured.distances.replies))
    }
}

impl Measured {
    fn planned(scene: &Scene, mut method: impl Method + 'static, patience: Duration) -> Self {
        let all: Vec<usize> = (0..scene.poses.len()).collect();
        let in_contact: Vec<usize> =
            all.iter().copied().filter(|&pose| !scene.truths[pose].contacts.is_empty()).collect();
        let distance = |method: &mut dyn Method, scene: &Scene, pose: usize| {
            method.ask(scene.models, scene.poses[pose])
        };
        let contacts = |method: &mut dyn Method, scene: &Scene, pose: usize| {
            method.contacts(scene.models, scene.poses[pose])
        };
        Self {
            distances: Series::planned(scene, &mut method, distance, &all, patience),
            contacts: Series::planned(scene, &mut method, contacts, &in_contact, patience),
            method: Box::new(method),
        }
    }

    fn run(&mut self, scene: &Scene) {
        self.distances.run(scene, &mut *self.method);
        self.contacts.run(scene, &mut *self.method);
    }
}
