//! A method and its questions, or why it could not be run.

use std::time::Duration;

use cranny_rapier::Detector;

use super::figures::MethodFigures;
use super::method::{ContactAnswer, Method, Name, PoseAnswer};
use super::motion::{Judged, Motion};
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
    contacts: Series<ContactAnswer>,
}

impl MethodContestant {
    /// Ours: a panic of it is a bug, and ends the command.
    pub(super) fn ours(judged: &Judged, method: Ours, patience: Duration) -> Self {
        Self { name: method.name(), state: Ok(Measured::planned(judged, method, patience)) }
    }

    /// A peer, prepared. Where it refuses a mesh, or panics, its row will say so.
    pub(super) fn peer(judged: &Judged, kind: Detector, patience: Duration) -> Self {
        let state = quietly(|| {
            Peer::new(kind, &judged.motion).map(|peer| Measured::planned(judged, peer, patience))
        });
        Self { name: Peer::name_of(kind), state }
    }

    /// Answers everything once more.
    pub(super) fn run(&mut self, motion: &Motion) {
        let Ok(measured) = &mut self.state else { return };
        if self.name.is_ours() {
            measured.run(motion);
        } else if let Err(note) = quietly(|| {
            measured.run(motion);
            Ok(())
        }) {
            self.state = Err(note);
        }
    }

    /// Its answers, judged.
    pub(super) fn figures(&self, judged: &Judged) -> MethodFigures {
        let name = self.name.clone();
        match &self.state {
            Err(note) => MethodFigures::none(name, note.clone()),
            Ok(Measured { distances, contacts, .. }) => {
                MethodFigures::judged(judged, name, &distances.replies, &contacts.replies)
            }
        }
    }

    /// Its answer at each pose.
    pub(super) fn replies(&self) -> (&Name, &[Reply<PoseAnswer>]) {
        (&self.name, self.state.as_ref().map_or(&[], |measured| &measured.distances.replies))
    }
}

impl Measured {
    fn planned(judged: &Judged, mut method: impl Method + 'static, patience: Duration) -> Self {
        let motion = &judged.motion;
        let all: Vec<usize> = (0..motion.len()).collect();
        let in_contact: Vec<usize> =
            all.iter().copied().filter(|&pose| judged.truths[pose].overlaps()).collect();
        Self {
            distances: Series::planned(
                motion,
                &mut method,
                |method, posed| method.distance(posed),
                &all,
                patience,
            ),
            contacts: Series::planned(
                motion,
                &mut method,
                |method, posed| method.contacts(posed),
                &in_contact,
                patience,
            ),
            method: Box::new(method),
        }
    }

    fn run(&mut self, motion: &Motion) {
        self.distances.run(motion, &mut *self.method);
        self.contacts.run(motion, &mut *self.method);
    }
}
