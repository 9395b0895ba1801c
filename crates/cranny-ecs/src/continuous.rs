//! `Continuous`: bodies that pass through nothing, however fast they are. The solver sees to it;
//! here it learns whose bodies they are.

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Insert;
use bevy_ecs::prelude::*;

use crate::body::Body;
use crate::clock::{CrannyStep, StepSystems};
use crate::effects::EffectTable;
use crate::response::ResponseSystems;
use crate::solved::{RigidBodies, SolverBody};

/// The systems of `Continuous`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContinuousSystems {
    /// Who is named, to the solver.
    Sync,
    /// [`HeldBack`].
    Report,
}

/// How many bodies would have passed through another one in the last step, and were held back.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeldBack {
    /// In the last step; a body counts once in each part of it.
    pub bodies: usize,
    /// Since the start.
    pub total: u64,
}

/// Names bodies to the solver, and keeps [`HeldBack`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ContinuousPlugin;

impl Plugin for ContinuousPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<HeldBack>().add_observer(name_new);
        app.configure_sets(
            CrannyStep,
            (
                ContinuousSystems::Sync.in_set(StepSystems::Sync).after(ResponseSystems::Sync),
                ContinuousSystems::Report.in_set(StepSystems::Report),
            ),
        );
        app.add_systems(
            CrannyStep,
            (
                name_bodies.in_set(ContinuousSystems::Sync),
                count_held_back.in_set(ContinuousSystems::Report),
            ),
        );
    }
}

/// Names a body that comes.
fn name_new(
    inserted: On<Insert<SolverBody>>,
    known: Query<(&Body, &SolverBody)>,
    effects: Res<EffectTable>,
    mut bodies: ResMut<RigidBodies>,
) {
    if let Ok((body, solved)) = known.get(inserted.entity) {
        let continuous = effects.is_continuous(body.id);
        bodies.simulation_mut().set_continuous(solved.index, continuous);
    }
}

/// Names all bodies again, where what is asked has changed.
fn name_bodies(
    effects: Res<EffectTable>,
    known: Query<(&Body, &SolverBody)>,
    mut bodies: ResMut<RigidBodies>,
    mut revision: Local<Option<u64>>,
) {
    if revision.replace(effects.revision()) == Some(effects.revision()) {
        return;
    }
    for (body, solved) in &known {
        let continuous = effects.is_continuous(body.id);
        bodies.simulation_mut().set_continuous(solved.index, continuous);
    }
}

fn count_held_back(bodies: Res<RigidBodies>, mut held: ResMut<HeldBack>) {
    held.bodies = bodies.simulation().held_back();
    held.total += held.bodies as u64;
}
