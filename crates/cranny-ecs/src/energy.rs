//! Mechanical energy over a run, and how well motors held their joints.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use cranny_rapier::Energy;

use crate::clock::CrannyStep;
use crate::response::ResponseSystems;
use crate::solved::{self, RigidBodies};

/// Follows what a summary reports of the solver: a sum over all bodies at both ends of each step.
pub(crate) struct EnergyPlugin;

impl Plugin for EnergyPlugin {
    fn build(&self, app: &mut App) {
        let begin = begin_energy.in_set(ResponseSystems::Sync).after(solved::push_gravity);
        app.add_systems(CrannyStep, (begin, follow_energy.in_set(ResponseSystems::Tally)));
    }
}

fn begin_energy(mut bodies: ResMut<RigidBodies>) {
    bodies.begin_energy();
}

fn follow_energy(mut bodies: ResMut<RigidBodies>) {
    bodies.note_energy();
    bodies.note_joints();
}

/// Total mechanical energy over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyRange {
    /// Before the first step.
    pub start: f64,
    /// Now.
    pub now: f64,
    /// The highest so far.
    pub max: f64,
    /// The lowest so far.
    pub min: f64,
    /// The highest kinetic energy so far.
    pub kinetic_max: f64,
    /// The greatest change of potential energy since the start.
    pub potential_change_max: f64,
    potential_start: f64,
}

impl EnergyRange {
    pub(crate) fn starting(energy: Energy) -> Self {
        let Energy { kinetic, potential } = energy;
        let total = kinetic + potential;
        Self {
            start: total,
            now: total,
            max: total,
            min: total,
            kinetic_max: kinetic,
            potential_change_max: 0.0,
            potential_start: potential,
        }
    }

    pub(crate) fn note(&mut self, energy: Energy) {
        let Energy { kinetic, potential } = energy;
        self.now = kinetic + potential;
        self.max = self.max.max(self.now);
        self.min = self.min.min(self.now);
        self.kinetic_max = self.kinetic_max.max(kinetic);
        let change = (potential - self.potential_start).abs();
        self.potential_change_max = self.potential_change_max.max(change);
    }

    /// Bodies came or left: what they bring or take is no gain and no loss.
    pub(crate) fn shift(&mut self, before: Energy, after: Energy) {
        let (total, height) = (after.total() - before.total(), after.potential - before.potential);
        for energy in [&mut self.start, &mut self.now, &mut self.max, &mut self.min] {
            *energy += total;
        }
        self.potential_start += height;
    }

    /// What gains and losses are measured against: the larger of the highest kinetic energy and the
    /// greatest change of potential energy. It does not depend on where heights are counted from.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.kinetic_max.max(self.potential_change_max)
    }

    /// Whether all of them are finite numbers, so that gains and losses are.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let all = [self.start, self.now, self.max, self.min, self.scale()];
        all.iter().all(|energy| energy.is_finite())
    }

    /// The greatest gain over the start, relative to [`scale`](Self::scale); 0 where nothing moved.
    #[must_use]
    pub fn drift(&self) -> f64 {
        relative(self.max - self.start, self.scale())
    }

    /// What was lost by now (negative: gained), relative to [`scale`](Self::scale).
    #[must_use]
    pub fn loss(&self) -> f64 {
        relative(self.start - self.now, self.scale())
    }
}

fn relative(value: f64, scale: f64) -> f64 {
    if scale > 0.0 { value / scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(kinetic: f64, potential: f64) -> Energy {
        Energy { kinetic, potential }
    }

    #[test]
    fn drift_and_loss_do_not_depend_on_the_zero_of_height() {
        for zero in [0.0, -1e3] {
            let mut energy = EnergyRange::starting(of(1.0, 4.0 + zero));
            energy.note(of(3.0, 3.0 + zero));
            energy.note(of(2.0, 2.0 + zero));
            assert_eq!(energy.scale(), 3.0);
            assert!((energy.drift() - 1.0 / 3.0).abs() < 1e-12);
            assert!((energy.loss() - 1.0 / 3.0).abs() < 1e-12);
        }
        assert_eq!(EnergyRange::starting(of(0.0, 7.0)).drift(), 0.0);
    }

    #[test]
    fn energies_that_overflow_are_not_finite() {
        let mut energy = EnergyRange::starting(of(1.0, 0.0));
        energy.note(of(2.0, 1.0));
        assert!(energy.is_finite());
        energy.note(of(f64::NAN, 0.0));
        assert!(!energy.is_finite());
        assert!(!EnergyRange::starting(of(f64::INFINITY, 0.0)).is_finite());
    }

    #[test]
    fn what_comes_and_goes_is_no_gain() {
        let mut energy = EnergyRange::starting(of(0.0, 4.0));
        energy.note(of(1.0, 3.0));
        energy.shift(of(1.0, 3.0), of(6.0, 13.0));
        energy.note(of(6.0, 13.0));
        assert_eq!((energy.drift(), energy.loss()), (0.0, 0.0));
        energy.shift(of(6.0, 13.0), of(1.0, 3.0));
        assert_eq!((energy.start, energy.now), (4.0, 4.0));
    }
}
