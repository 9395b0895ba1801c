//! What can be wrong with a call, and what can be wrong with the structure.

use std::num::NonZeroUsize;

use cranny_broad_phase::BroadPhaseError;
use cranny_exact::PoseError;
use cranny_primitives::{PrimitiveError, ShapeQueryError};
use thiserror::Error;

use crate::body::BodyId;

/// A call that was refused; the world is as it was before.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum WorldError {
    /// No body of this id is present.
    #[error("there is no body {body}: it was removed, or comes from another world")]
    UnknownBody {
        /// The id requested.
        body: BodyId,
    },
    /// A body of this name is present already.
    #[error("there is a body named '{name}' already ({body}): names must be unique")]
    DuplicateName {
        /// The name requested.
        name: String,
        /// Who has it.
        body: BodyId,
    },
    /// Both bodies of a pair are the same one.
    #[error("a pair of body {body} with itself was asked for: a pair has two different bodies")]
    SameBody {
        /// The body.
        body: BodyId,
    },
    /// All 2^32 ids were given away.
    #[error("no id is left for body '{name}': a world numbers at most 2^32 bodies in its life")]
    NoIdLeft {
        /// The body that did not fit.
        name: String,
    },
    /// An id that the world has given away, or has passed by.
    #[error("body '{name}' cannot have the id {body}: ids ascend, and a later one was given away")]
    IdUsed {
        /// The body that wants it.
        name: String,
        /// The id.
        body: BodyId,
    },
    /// A distance of `Proximity` that is no length.
    #[error(
        "the distance `within` of Proximity of {owner} is {within}: it must be a finite length above zero"
    )]
    Proximity {
        /// Whose effect it is.
        owner: String,
        /// The value found.
        within: f64,
    },
    /// A margin of contacts that is no length.
    #[error(
        "the contact margin of {owner} is {margin}: it must be a finite length of at least zero"
    )]
    Margin {
        /// Whose effect it is.
        owner: String,
        /// The value found.
        margin: f64,
    },
    /// A parameter of an effect that must be a finite number above zero.
    #[error(
        "`{parameter}` of {effect} of {owner} is {value}: it must be a finite number above zero"
    )]
    Parameter {
        /// Name of the effect.
        effect: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Whose effect it is.
        owner: String,
        /// The value found.
        value: f64,
    },
    /// A pose outside the domain, or a rotation that is none.
    #[error("the pose of body '{name}' is refused: {source}")]
    Pose {
        /// The body.
        name: String,
        /// What is wrong with it.
        source: PoseError,
    },
    /// A primitive with a number that is none.
    #[error("the {what} of body '{name}' is refused: {source}")]
    Primitive {
        /// The body.
        name: String,
        /// The kind of primitive: "ball".
        what: &'static str,
        /// What is wrong with it.
        source: PrimitiveError,
    },
    /// There are no such threads.
    #[error("{threads} threads for pairs cannot be had: {why}")]
    Threads {
        /// How many were requested.
        threads: NonZeroUsize,
        /// What the system says, or which feature is missing.
        why: String,
    },
    /// The broad phase refused the body's box.
    #[error("body '{name}' does not fit the broad phase: {source}")]
    BroadPhase {
        /// The body.
        name: String,
        /// Why.
        source: BroadPhaseError,
    },
    /// The narrow phase refused a pair.
    #[error("the pair '{a}' and '{b}' cannot be queried: {source}")]
    Query {
        /// The first body's name.
        a: String,
        /// The second body's name.
        b: String,
        /// Why.
        source: ShapeQueryError,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for WorldError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// A broken invariant, found by [`World::validate`](crate::World::validate): a bug of this crate.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("world invariant broken: {what}")]
pub struct WorldInvariantError {
    /// Which invariant, and where.
    pub what: String,
}
