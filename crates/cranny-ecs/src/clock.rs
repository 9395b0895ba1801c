//! When things happen: the schedules of a step and of the end, and the simulated time.

use std::time::Duration;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use serde::Serialize;

/// One step: everything from the poses at its beginning to the poses at its end.
///
/// Run it by [`SceneApp::step`](crate::SceneApp::step), by
/// [`FixedUpdatePlugin`](crate::FixedUpdatePlugin), or with `World::run_schedule`. In an app that
/// never calls `App::update`, call `World::clear_trackers` after it, or removals of components are
/// kept for ever.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CrannyStep;

/// Runs once after the last step: what a step reports, for the final poses, and nothing moves.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CrannyEnd;

/// The order within [`CrannyStep`], and within [`CrannyEnd`] but for what moves bodies.
///
/// Until [`Advance`](Self::Advance), every `Transform` is the one at the beginning of the step:
/// contacts, recordings and pictures of a step all refer to it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepSystems {
    /// What was spawned becomes bodies, and changes of bodies are passed on.
    Admit,
    /// Systems that keep poses of their own take over what others moved.
    Sync,
    /// The solver finds contacts and the poses at the end of the step, and keeps them to itself.
    Solve,
    /// Pairs are detected.
    Detect,
    /// What was found is reported: resources, components, messages, events, sums.
    Report,
    /// Frames are recorded.
    Record,
    /// Pictures are drawn.
    Draw,
    /// Poses and the clock move on to the end of the step.
    Advance,
}

impl StepSystems {
    /// All of them, in the order in which they run.
    pub const ALL: [Self; 8] = [
        Self::Admit,
        Self::Sync,
        Self::Solve,
        Self::Detect,
        Self::Report,
        Self::Record,
        Self::Draw,
        Self::Advance,
    ];
}

/// What every scene runs.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoreSystems {
    /// Entities become bodies, and those that left are forgotten.
    Admit,
    /// Displacement and turns of what can move.
    Motion,
    /// The clock.
    Clock,
    /// What failed, to bevy's error handler.
    Failure,
}

/// Simulated time: it advances by one step at a time and knows no other clock.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct SimulatedTime {
    steps: u64,
    step: f64,
}

impl SimulatedTime {
    /// No step made yet; each will take `step` seconds.
    #[must_use]
    pub fn new(step: f64) -> Self {
        Self { steps: 0, step }
    }

    /// Steps completed: during a step, its number counted from 0.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Seconds a step.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Seconds since the start: steps x step, so no rounding adds up.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.steps as f64 * self.step
    }

    /// The same, to the nanosecond.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        Duration::try_from_secs_f64(self.seconds()).unwrap_or(Duration::MAX)
    }
}

/// Wall time spent so far, in milliseconds, by phase. No result depends on it.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PhaseTimes {
    /// Broad phase of the solver's step; the world's own is part of [`narrow`](Self::narrow).
    pub broad: f64,
    /// Narrow phase: of the solver's step, or of the world where there is no solver.
    pub narrow: f64,
    /// The rest of the solver's step.
    pub solver: f64,
    /// Detection for reports only, beside a solver that detects for itself.
    pub report: f64,
    /// Recording.
    pub record: f64,
    /// Drawing, encoding and saving pictures.
    pub render: f64,
}

/// Schedules and clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClockPlugin {
    /// Seconds a step.
    pub(crate) step: f64,
}

impl Plugin for ClockPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(SimulatedTime::new(self.step)).init_resource::<PhaseTimes>();
        app.add_schedule(schedule(CrannyStep)).add_schedule(schedule(CrannyEnd));
        app.add_systems(
            CrannyStep,
            advance_clock.in_set(StepSystems::Advance).in_set(CoreSystems::Clock),
        );
    }
}

/// Single-threaded: the order of equals is then the order of insertion, on every machine.
fn schedule(label: impl ScheduleLabel) -> Schedule {
    let mut schedule = Schedule::new(label);
    schedule.set_executor(SingleThreadedExecutor::new());
    let [admit, sync, solve, detect, report, record, draw, advance] = StepSystems::ALL;
    schedule.configure_sets((admit, sync, solve, detect, report, record, draw, advance).chain());
    schedule
}

fn advance_clock(mut time: ResMut<SimulatedTime>) {
    time.steps += 1;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_a_multiple_of_the_step() {
        let mut time = SimulatedTime::new(0.1);
        assert_eq!(time.elapsed(), Duration::ZERO);
        time.steps = 3;
        assert_eq!(time.seconds(), 3.0 * 0.1);
        assert_eq!(time.elapsed().as_nanos(), 300_000_000);
    }
}
