//! Bodies that the solver moves: it holds them back itself.

use bevy_app::App;
use bevy_ecs::lifecycle::Insert;
use bevy_ecs::prelude::*;

use super::{ContinuousSystems, HeldBack, begin_count};
use crate::body::Body;
use crate::clock::CrannyStep;
use crate::effects::EffectTable;
use crate::response::ResponseSystems;
use crate::solved::{RigidBodies, SolverBody};

pub(super) fn add(app: &mut App) {
    app.add_observer(name_new);
    app.configure_sets(
        CrannyStep,
        (
            ContinuousSystems::Sync.after(ResponseSystems::Sync),
            ContinuousSystems::Start.before(ResponseSystems::Advance),
            ContinuousSystems::Hold.after(ResponseSystems::Advance),
        ),
    );
    app.add_systems(
        CrannyStep,
        (
            name_bodies.run_if(resource_exists::<RigidBodies>).in_set(ContinuousSystems::Sync),
            count_held_back
                .run_if(resource_exists::<RigidBodies>)
                .in_set(ContinuousSystems::Report)
                .after(begin_count),
        ),
    );
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

/// Names all bodies again, where effects have changed.
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
    let count = bodies.simulation().held_back();
    held.bodies += count;
    held.total += count as u64;
}
