//! `Tracking`: bodies whose poses a device reports, imprecise, late or not at all, and contacts of
//! theirs that begin and end where that is certain.
//!
//! Two things are kept apart. A [`Tracker`] makes one pose of those that come: in order, delayed,
//! smoothed, held or extrapolated. The effect then says of each pair what that pose is worth: with
//! a tolerance, [`Trigger`](crate::Trigger) begins where the exact depth is beyond it, and ends
//! where the exact gap is. In between nothing changes, so jitter within the tolerance neither makes
//! a contact nor breaks one.
//!
//! It filters poses and never distances: in a groove narrower than the jitter a body overlaps now
//! this side and now that, and the mean of those depths is a contact, while the mean of those poses
//! is none.

mod comparison;
mod device;
mod filter;
mod judged;
mod tracker;

use std::collections::BTreeSet;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::system::SystemParam;
use cranny_narrow_phase::Answer;
use cranny_world::{BodyId, PairAnswer};

pub use self::comparison::TrackingLog;
pub use self::device::{SimulatedTracker, SimulatedTrackersPlugin};
pub use self::judged::TrackedContacts;
pub use self::tracker::{PoseRefused, TrackedPose, Tracker, TrackerCounts};
use crate::body::{Bodies, Body};
use crate::clock::{CoreSystems, CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::detection::{Detected, DetectionSystems};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable, Pair};
use crate::paths::{Led, Steering};
use crate::trigger::{TriggerSystems, TriggeredPairs};

/// The systems of `Tracking`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrackingSystems {
    /// Simulated devices measure and report, at the beginning of the step. Only where there are
    /// some.
    Simulate,
    /// Poses to velocities, at the beginning of the step.
    Lead,
    /// Which pairs touch for certain.
    Decide,
    /// What simulated devices made of contacts. Only where there are some.
    Compare,
}

/// Pairs with `Tracking` and `Trigger` that touch.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct CertainPairs(BTreeSet<Pair>);

impl CertainPairs {
    pub(crate) fn iter(&self) -> impl Iterator<Item = Pair> {
        self.0.iter().copied()
    }
}

/// Leads bodies with a [`Tracker`], and decides when contacts of theirs begin and end.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackingPlugin;

impl Plugin for TrackingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<CertainPairs>().init_resource::<TriggeredPairs>();
        app.add_systems(
            CrannyStep,
            lead.run_if(any_with_component::<Tracker>)
                .in_set(TrackingSystems::Lead)
                .in_set(StepSystems::Admit)
                .after(CoreSystems::Admit),
        );
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                decide
                    .in_set(StepSystems::Report)
                    .in_set(TrackingSystems::Decide)
                    .after(DetectionSystems::Tally)
                    .before(TriggerSystems::Report),
            );
        }
    }
}

fn lead(
    mut tracked: Query<(Led, &mut Tracker)>,
    bodies: Res<Bodies>,
    time: Res<SimulatedTime>,
    steering: Steering,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Tracking);
    for (led, mut tracker) in &mut tracked {
        let reach = bodies.get(led.id()).map_or(0.0, |record| record.extent());
        let Some(shown) = tracker.advance(time.seconds() + time.step(), reach) else { continue };
        steering.lead(led, &shown.pose, shown.appears);
    }
}

/// What is known of pairs.
#[derive(SystemParam)]
struct Evidence<'w, 's> {
    effects: Res<'w, EffectTable>,
    bodies: Res<'w, Bodies>,
    triggered: Res<'w, TriggeredPairs>,
    trackers: Query<'w, 's, &'static Tracker, With<Body>>,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
}

impl Evidence<'_, '_> {
    /// Whether a pair with a tolerance touches: a contact begins or goes on.
    fn touches(&self, pair: &PairAnswer) -> bool {
        let (a, b, answer) = (pair.a, pair.b, &pair.answer);
        let Some(tolerance) = self.effects.tracked(a, b) else { return false };
        let certain = is_beyond(answer, tolerance) || self.presses(a, b);
        if self.triggered.touches((a, b)) {
            certain || is_near(answer, tolerance) || answer.touches()
        } else {
            certain && !self.is_lost(a) && !self.is_lost(b)
        }
    }

    fn is_lost(&self, body: BodyId) -> bool {
        let entity = self.bodies.entity(body);
        let tracker = entity.and_then(|entity| self.trackers.get(entity).ok());
        tracker.is_some_and(Tracker::is_lost)
    }

    /// What the solver moves for a contact is touched, however uncertain the pose.
    #[cfg(feature = "rapier")]
    fn presses(&self, a: BodyId, b: BodyId) -> bool {
        self.solver.as_ref().is_some_and(|solver| solver.impulse(a, b) > 0.0)
    }

    #[cfg(not(feature = "rapier"))]
    #[expect(clippy::unused_self, reason = "the solver presses")]
    fn presses(&self, _: BodyId, _: BodyId) -> bool {
        false
    }
}

/// Whether the surfaces are within a tolerance of each other, or cross. Contacts alone say so,
/// which `Tracking` has computed: regions are there only where somebody reads them.
fn is_near(answer: &Answer, tolerance: f64) -> bool {
    answer.contacts.iter().any(|contact| contact.separation <= tolerance)
}

/// Whether bodies overlap by more than a tolerance; the answer holds contacts up to it. One of them
/// is deeper, or a body is within the other and farther from its surface.
fn is_beyond(answer: &Answer, tolerance: f64) -> bool {
    let deep = answer.contacts.iter().any(|contact| -contact.separation > tolerance);
    deep || answer.contained.is_some() && !is_near(answer, tolerance)
}

fn decide(
    detected: Res<Detected>,
    evidence: Evidence,
    mut certain: ResMut<CertainPairs>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Tracking);
    let Some(report) = &detected.report else { return };
    // Pairs without an answer are farther apart than any tolerance.
    let touching = report.answers.iter().filter(|pair| evidence.touches(pair));
    certain.0 = touching.map(|pair| (pair.a, pair.b)).collect();
}
