//! `Contacts`: points, curves and regions of the pairs that have this effect.

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Add, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_exact::Pose;
use cranny_narrow_phase::Answer;
use cranny_world::{BodyId, PairAnswer};

use crate::body::{Bodies, Body};
use crate::clock::{CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::detection::{Detected, DetectionSystems, Detector};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable};
use crate::penetration::{PenetrationPlugin, PenetrationSystems};
use crate::proximity::{ProximityPlugin, ProximitySystems};
use crate::trigger::{TriggerPlugin, TriggerSystems};

/// The systems of `Contacts`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContactsSystems {
    /// Detection, shared with other effects that need it.
    Detect,
    /// [`ContactReport`] and [`BodyContacts`].
    Report,
}

/// Contacts at the poses that the `Transform`s hold during a step: as much of them as somebody
/// [reads](crate::ContactReaders), all unless the program says less.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct ContactReport {
    /// Steps completed when the report was made.
    pub step: u64,
    /// One a pair with regions or contacts within its margin, sorted by body ids.
    pub pairs: Vec<ContactPair>,
}

/// Contacts of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPair {
    /// The body with the lower id: A of the answer.
    pub a: BodyId,
    /// The other: B.
    pub b: BodyId,
    /// From which the answer was computed, to the bit.
    pub poses: [Pose; 2],
    /// The frame in which it was computed; `None`: in the world's.
    pub frame: Option<QueryFrame>,
    /// World coordinates.
    pub answer: Answer,
}

/// A solver queries a pair in the frame of one body: the other one's pose in it, rounded as the
/// solver has it, is what decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryFrame {
    /// Whether the frame is that of `a`.
    pub first_is_a: bool,
    /// The other body's pose in it, to the bit.
    pub first_from_second: Pose,
}

/// A body's share of the [`ContactReport`], which holds what is read.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyContacts {
    /// Bodies that it touches or nearly touches.
    pub partners: u32,
    /// Contact points with them.
    pub points: u32,
    /// The deepest of its overlaps, >= 0, units of length.
    pub depth: f64,
}

/// Keeps [`ContactReport`] and [`BodyContacts`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactsPlugin;

impl Plugin for ContactsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ContactReport>();
        app.add_observer(|added: On<Add<Body>>, mut commands: Commands| {
            commands.entity(added.entity).insert(BodyContacts::default());
        });
        app.add_observer(|removed: On<Remove<Body>>, mut commands: Commands| {
            commands.entity(removed.entity).try_remove::<BodyContacts>();
        });
        // Order among effects that are there: naming a set would put it into the schedule.
        let beside_trigger = app.is_plugin_added::<TriggerPlugin>();
        let beside_proximity = app.is_plugin_added::<ProximityPlugin>();
        let beside_penetration = app.is_plugin_added::<PenetrationPlugin>();
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            if beside_trigger {
                app.configure_sets(label, ContactsSystems::Report.after(TriggerSystems::Report));
            }
            if beside_proximity {
                app.configure_sets(label, ContactsSystems::Report.after(ProximitySystems::Report));
            }
            if beside_penetration {
                let after = ContactsSystems::Report.after(PenetrationSystems::Report);
                app.configure_sets(label, after);
            }
            app.add_systems(
                label,
                (take_contacts, share_contacts)
                    .chain()
                    .in_set(StepSystems::Report)
                    .in_set(ContactsSystems::Report)
                    .after(DetectionSystems::Tally),
            );
        }
    }
}

/// Moves the answers that are contacts out of what was detected, and leaves out what is beyond the
/// margin (a solver may have looked farther).
fn take_contacts(
    mut detected: ResMut<Detected>,
    mut detector: ResMut<Detector>,
    effects: Res<EffectTable>,
    time: Res<SimulatedTime>,
    mut contacts: ResMut<ContactReport>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Contacts);
    contacts.step = time.steps();
    contacts.pairs.clear();
    let Some(report) = &mut detected.report else { return };
    let answers = std::mem::take(&mut report.answers);
    for PairAnswer { a, b, mut answer } in answers {
        let Some(margin) = effects.contact_margin(a, b) else {
            report.answers.push(PairAnswer { a, b, answer });
            continue;
        };
        answer.regions.retain(|region| region.deepest.separation <= margin);
        answer.contacts.retain(|contact| contact.separation <= margin);
        // A solver's answers carry contacts without regions.
        if !answer.regions.is_empty() || !answer.contacts.is_empty() {
            let (poses, frame) = detector.poses(a, b);
            contacts.pairs.push(ContactPair { a, b, poses, frame, answer });
        }
    }
    // They belong to this step's answers: at the end of a run no solver supplies new ones.
    detector.supplied_poses.clear();
}

fn share_contacts(
    contacts: Res<ContactReport>,
    bodies: Res<Bodies>,
    mut shares: Query<&mut BodyContacts, With<Body>>,
) {
    for mut share in &mut shares {
        *share = BodyContacts::default();
    }
    for pair in &contacts.pairs {
        let points = pair.answer.contacts.len();
        let depth = pair.answer.depth();
        for id in [pair.a, pair.b] {
            let Some(record) = bodies.get(id) else { continue };
            if let Ok(mut share) = shares.get_mut(record.entity) {
                share.partners += 1;
                share.points += points as u32;
                share.depth = share.depth.max(depth);
            }
        }
    }
}
