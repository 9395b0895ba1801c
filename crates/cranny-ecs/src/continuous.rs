//! `Continuous`: bodies that pass through nothing, however fast they are. The solver sees to those
//! that it moves, and learns here who they are; [`unsolved`] to those that follow their velocities.

#[cfg(feature = "rapier")]
mod solved;
mod unsolved;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;

use crate::clock::{CrannyStep, StepSystems};
use crate::kinematics::KinematicsSystems;

/// The systems of `Continuous`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContinuousSystems {
    /// Who is named, to the solver.
    Sync,
    /// [`HeldBack`].
    Report,
    /// Where bodies are, before anything moves.
    Start,
    /// Kinematic bodies that no solver moves are held back.
    Hold,
}

/// How many bodies would have passed through another one in the last step, and were held back.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeldBack {
    /// In the last step; a body counts once in each part of it.
    pub bodies: usize,
    /// Since the start.
    pub total: u64,
}

/// Names bodies to the solver, holds back those that no solver moves, and keeps [`HeldBack`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ContinuousPlugin;

impl Plugin for ContinuousPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<HeldBack>();
        app.init_resource::<unsolved::Starts>().init_resource::<unsolved::KnownCores>();
        app.configure_sets(
            CrannyStep,
            (
                ContinuousSystems::Sync.in_set(StepSystems::Sync),
                ContinuousSystems::Report.in_set(StepSystems::Report),
                ContinuousSystems::Start
                    .in_set(StepSystems::Advance)
                    .before(KinematicsSystems::Move),
                ContinuousSystems::Hold.in_set(StepSystems::Advance).after(KinematicsSystems::Move),
            ),
        );
        app.add_systems(
            CrannyStep,
            (
                begin_count.in_set(ContinuousSystems::Report),
                unsolved::note_starts.in_set(ContinuousSystems::Start),
                unsolved::hold_back.in_set(ContinuousSystems::Hold),
            ),
        );
        #[cfg(feature = "rapier")]
        solved::add(app);
    }
}

fn begin_count(mut held: ResMut<HeldBack>) {
    held.bodies = 0;
}
