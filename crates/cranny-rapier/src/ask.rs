//! One question to the narrow phase about two models, the first at the origin.

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, PairMemory, Placed, Query, QueryError, query};

/// The answer in the first model's frame; `None`, with a word in the log, where the pose is none.
pub(crate) fn ask(
    models: [&Model; 2],
    pose: Pose,
    question: &Query,
    memory: &mut PairMemory,
) -> Option<Answer> {
    let a = Placed { model: models[0], pose: Pose::IDENTITY };
    let b = Placed { model: models[1], pose };
    logged(query(a, b, question, memory))
}

/// What was found; an error goes to the log.
pub(crate) fn logged<T>(found: Result<T, QueryError>) -> Option<T> {
    match found {
        Ok(found) => Some(found),
        Err(error) => {
            // rapier lets no error out of a step; it quarantines bodies whose pose is not finite.
            tracing::error!("pair left out of this step: {error}");
            None
        }
    }
}
