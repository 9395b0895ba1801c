//! What each phase of a step and each effect costs, in an app that adds [`DiagnosticsPlugin`].
//!
//! Phases run one after the other, so marks between them give their costs, down to the last system.
//! An effect's cost is that of its own systems in the report: what it makes others do (detection,
//! the solver's step, a second query there) is in their phases, where effects share it.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;

use crate::clock::{CrannyStep, StepSystems};
use crate::effects::EffectKind;

/// Wall time of steps, by phases and effects. No result depends on it.
#[derive(Resource, Clone, Debug, Default)]
pub struct StepDiagnostics {
    /// Steps that were measured.
    pub steps: u64,
    /// Of the last step.
    pub last: StepCosts,
    /// Of all that were measured.
    pub total: StepCosts,
    /// When the last phase ended.
    mark: Option<Instant>,
}

/// What phases and effects cost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StepCosts {
    phases: [Duration; StepSystems::ALL.len()],
    effects: BTreeMap<EffectKind, Duration>,
}

impl StepCosts {
    /// Of a phase, with all systems in it.
    #[must_use]
    pub fn phase(&self, phase: StepSystems) -> Duration {
        let at = StepSystems::ALL.iter().position(|known| *known == phase);
        at.map_or(Duration::ZERO, |at| self.phases[at])
    }

    /// Of the whole step.
    #[must_use]
    pub fn step(&self) -> Duration {
        self.phases.iter().sum()
    }

    /// Of the systems by which an effect reports, within [`StepSystems::Report`]; `None` for an
    /// effect that has none, or is absent.
    #[must_use]
    pub fn effect(&self, effect: EffectKind) -> Option<Duration> {
        self.effects.get(&effect).copied()
    }
}

impl StepDiagnostics {
    fn begin(&mut self) {
        self.steps += 1;
        self.last = StepCosts::default();
        self.mark = Some(Instant::now());
    }

    fn end_of(&mut self, phase: usize) {
        let now = Instant::now();
        let spent = self.mark.replace(now).map_or(Duration::ZERO, |mark| now - mark);
        self.last.phases[phase] += spent;
        self.total.phases[phase] += spent;
    }

    fn add(&mut self, effect: EffectKind, spent: Duration) {
        for costs in [&mut self.last, &mut self.total] {
            *costs.effects.entry(effect).or_default() += spent;
        }
    }
}

/// Keeps [`StepDiagnostics`]. Add it after [`CrannyPlugins`](crate::CrannyPlugins), which make the
/// schedule; without it there is nothing of it, and no effect reads a clock.
///
/// ```
/// use bevy_app::App;
/// use cranny_ecs::{CrannyPlugins, CrannyStep, DiagnosticsPlugin, StepDiagnostics, StepSystems};
///
/// let mut app = App::new();
/// app.add_plugins((CrannyPlugins::new(1.0 / 60.0)?, DiagnosticsPlugin));
/// app.world_mut().run_schedule(CrannyStep);
/// let costs = app.world().resource::<StepDiagnostics>();
/// println!("a step took {:?}", costs.last.step());
/// println!("taking bodies in took {:?}", costs.last.phase(StepSystems::Admit));
/// # assert_eq!(costs.steps, 1);
/// # Ok::<(), cranny_ecs::SceneAppError>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct DiagnosticsPlugin;

impl Plugin for DiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<StepDiagnostics>();
        let begin = |mut costs: ResMut<StepDiagnostics>| costs.begin();
        app.add_systems(CrannyStep, begin.before(StepSystems::Admit));
        for (number, phase) in StepSystems::ALL.into_iter().enumerate() {
            let end = move |mut costs: ResMut<StepDiagnostics>| costs.end_of(number);
            match StepSystems::ALL.get(number + 1) {
                Some(next) => app.add_systems(CrannyStep, end.after(phase).before(*next)),
                None => app.add_systems(CrannyStep, end.after(phase)),
            };
        }
    }
}

/// Measures a system of an effect's, where the app has [`StepDiagnostics`].
#[derive(SystemParam)]
pub(crate) struct Stopwatch<'w> {
    costs: Option<ResMut<'w, StepDiagnostics>>,
}

impl Stopwatch<'_> {
    /// Counts for an effect from now on until what is returned is dropped.
    pub(crate) fn start(&mut self, effect: EffectKind) -> Running<'_> {
        Running(self.costs.as_deref_mut().map(|costs| (costs, effect, Instant::now())))
    }
}

/// A measurement that runs.
pub(crate) struct Running<'a>(Option<(&'a mut StepDiagnostics, EffectKind, Instant)>);

impl Drop for Running<'_> {
    fn drop(&mut self) {
        if let Some((costs, effect, start)) = &mut self.0 {
            costs.add(*effect, start.elapsed());
        }
    }
}
