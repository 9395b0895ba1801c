//! What a run ends with.

use serde::Serialize;

use crate::clock::PhaseTimes;
use crate::tracking::TrackedContacts;

/// Summary of a run. Its JSON is the last line that `cranny run --format json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunSummary {
    /// Of this format: 1.
    pub version: u32,
    /// The scene's name.
    pub scene: String,
    /// Hash of the scene's text (if it came from one) and of every body's prepared geometry.
    pub scene_hash: String,
    /// Who detected contacts.
    pub detector: String,
    /// How exactly: the levels that the scene's effects have, the coarsest first, "hulls, exact";
    /// `None` for rapier's own detectors, which state nothing.
    pub accuracy: Option<String>,
    /// Elementary tests that a step may take for triggers and distances; `None`: as many as they
    /// need.
    pub budget: Option<u64>,
    /// Threads used.
    pub threads: u32,
    /// The scene's seed.
    pub seed: u64,
    /// Steps completed.
    pub steps: u64,
    /// Seconds a step.
    pub dt: f64,
    /// Simulated seconds.
    pub simulated_s: f64,
    /// Wall time of all steps and of the end, seconds; not of the preparation.
    pub wall_s: f64,
    /// Simulated seconds a second of wall time.
    pub real_time_factor: f64,
    /// Where the wall time went, milliseconds in all.
    pub time_ms: PhaseTimes,
    /// Pairs examined in a step.
    pub pairs: CountSummary,
    /// Pairs of a step whose contacts our detector carried on for the solver, and searched; `None`
    /// without it or a solver.
    pub pairs_found: Option<PairsFound>,
    /// Steps that the solver made in parts; `None` without our detector or a solver.
    pub parts: Option<PartsSummary>,
    /// Elementary tests of a step for the pairs that our detector examines, where no solver
    /// detects; `None` with one.
    pub tests: Option<CountSummary>,
    /// Of pairs known at a level or within the budget; `None` where there were none.
    pub estimates: Option<EstimateSummary>,
    /// Contact points of a step: those that the solver got, or those reported where there is none.
    pub contacts: CountSummary,
    /// The deepest overlap of the polyhedra, from exact answers at the poses at the beginning of
    /// each step, and at the end where a scene has `Contacts`: of regions where somebody
    /// [reads](crate::ContactReaders) them, otherwise of contacts. Pairs with a sensor do not
    /// count. A pair that cannot be deeper than the deepest so far is not searched for it. Depth 0
    /// and no names where nothing overlapped; `None` where no exact answer has depths.
    pub deepest: Option<DeepestSummary>,
    /// The first overlap of all, deepest of its step or not; `None` where there was none, or no
    /// exact answer has depths.
    pub first_overlap: Option<DeepestSummary>,
    /// Pairs with `Trigger` that touched, by ids.
    pub triggers: Vec<TriggerSummary>,
    /// Contacts of tracked bodies whose device is simulated, by ids.
    pub tracking: Vec<TrackingSummary>,
    /// Dynamic bodies that left the world: a box about all bodies where they were put, grown by its
    /// own diagonal.
    pub left: Vec<LeftSummary>,
    /// Bodies that lay wholly within another's material, which has no depth; `None` if none did,
    /// or where there is no exact answer.
    pub contained: Option<ContainedSummary>,
    /// The greatest gain of mechanical energy over the start, relative to [`EnergySummary::scale`];
    /// 0 or more. `None` without a solver, and where energies are not finite.
    pub energy_drift: Option<f64>,
    /// Energies, where there is a solver and they are finite.
    pub energy: Option<EnergySummary>,
    /// Why a solver's energies are not known; `None` where they are, or there is no solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_unknown: Option<String>,
    /// How many bodies would have passed through another one and were held back, summed over the
    /// steps; `None` without `Continuous`.
    pub held_back: Option<u64>,
    /// Hash of the final poses and velocities, bit for bit, in the order of bodies.
    pub state_hash: String,
    /// Motion of each body that can move.
    pub motion: Vec<MotionSummary>,
    /// How far each joint that a motor holds was off its position.
    pub joints: Vec<JointSummary>,
    /// Screw motion of each nut on its bolt.
    pub helices: Vec<HelixSummary>,
    /// Links of a chain; `None` where no rings were linked at the start.
    pub links: Option<LinkSummary>,
    /// Files and folders written.
    pub outputs: Vec<String>,
    /// What was requested and not done.
    pub skipped: Vec<Skipped>,
    /// Whether the run was broken off.
    pub interrupted: bool,
}

/// A count over the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CountSummary {
    /// Mean.
    pub mean: f64,
    /// Maximum.
    pub max: u64,
}

/// What was known at a level or within a budget, a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EstimateSummary {
    /// Pairs.
    pub pairs: CountSummary,
    /// Of these, pairs with a certain verdict.
    pub certain: f64,
    /// Pairs with an open verdict, which counts as touching.
    pub open: CountSummary,
    /// Pairs that a larger budget would have narrowed.
    pub unsettled: CountSummary,
    /// Elementary tests that they took.
    pub tests: CountSummary,
}

/// How our detector found the solver's contacts: pairs a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PairsFound {
    /// Computed anew from the features of an earlier search.
    pub carried: CountSummary,
    /// Searched.
    pub searched: CountSummary,
}

/// Steps that the solver made in parts, since something moved far in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PartsSummary {
    /// Parts of a step at most, as the scene or the program says.
    pub most_parts: u64,
    /// Steps that were made in more than one part.
    pub divided: u64,
    /// Parts of any step at most; 0 where there was no step.
    pub max: u64,
}

/// The deepest overlap of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DeepestSummary {
    /// Units of length.
    pub depth: f64,
    /// Name of a body.
    pub a: String,
    /// Name of another.
    pub b: String,
    /// Steps completed at that time.
    pub step: u64,
}

/// A pair with `Trigger` that touched.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TriggerSummary {
    /// Name of a body.
    pub a: String,
    /// Name of the other.
    pub b: String,
    /// How often the two began to touch.
    pub times: u64,
    /// Of these, those with an open verdict, at their level or within the budget.
    pub open: u64,
    /// Steps completed when they first did.
    pub step: u64,
}

/// What tracking made of a body's contacts, with all others together.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TrackingSummary {
    /// Its name.
    pub body: String,
    /// Contacts of the true motion. With another body whose device is simulated they are those of
    /// both true motions, and count for the body of the lower id.
    pub truth: usize,
    /// Of the poses as they came, without filtering.
    pub raw: TrackedContacts,
    /// Of the filtered poses, within the tolerance: what [`CollisionStart`](crate::CollisionStart)
    /// and [`CollisionEnd`](crate::CollisionEnd) say.
    pub filtered: TrackedContacts,
    /// Poses that came.
    pub poses: u64,
    /// Of them those that were too late.
    pub late: u64,
    /// Of them those that were refused for other reasons.
    pub refused: u64,
    /// Poses that never came.
    pub missing: u64,
    /// How often it was lost.
    pub lost: u64,
    /// Other bodies with which nothing is compared, since the solver moves them: where they were
    /// without the device's errors is not known.
    pub uncompared: usize,
}

/// A body that left the world.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftSummary {
    /// Its name.
    pub body: String,
    /// Steps completed when it was first outside.
    pub step: u64,
}

/// Bodies that lay wholly within another's material.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ContainedSummary {
    /// In how many steps.
    pub steps: u64,
    /// Name of a body of the first pair.
    pub a: String,
    /// Name of the other.
    pub b: String,
    /// Steps completed when it was first so.
    pub step: u64,
}

/// Mechanical energy over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Before the first step; heights are counted from z = 0.
    pub start: f64,
    /// After the last.
    pub end: f64,
    /// The highest.
    pub max: f64,
    /// The larger of the highest kinetic energy and the greatest change of potential energy: what
    /// drift and loss are relative to.
    pub scale: f64,
    /// What was lost by the end (negative: gained), relative to `scale`.
    pub loss: f64,
}

/// How a body moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionSummary {
    /// Its name.
    pub body: String,
    /// From start to end, of the body's origin.
    pub displacement: [f64; 3],
    /// The axis of its spin at the start; `None` where it did not spin.
    pub axis: Option<[f64; 3]>,
    /// Turns about that axis.
    pub turns: Option<f64>,
}

/// How well a motor held a joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointSummary {
    /// Its name.
    pub joint: String,
    /// The position that its motor holds at the end, radians or units.
    pub held: f64,
    /// How far off the joint was at the end.
    pub off: f64,
    /// The farthest that it was off after any step.
    pub off_max: f64,
    /// In how many steps its motor was at its greatest effort, and could not do what was required.
    pub strained: u64,
}

/// How a nut moved on its bolt.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HelixSummary {
    /// The one with the outer thread.
    pub bolt: String,
    /// The one with the inner thread.
    pub nut: String,
    /// Of both threads.
    pub pitch: f64,
    /// Of the nut about the bolt's axis.
    pub turns: f64,
    /// Of the nut along the bolt's axis.
    pub advance: f64,
    /// The greatest |advance − pitch x turns|.
    pub deviation_max: f64,
}

/// What became of rings that were linked at the start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LinkSummary {
    /// Pairs that were linked.
    pub at_start: usize,
    /// Those that did not stay so.
    pub parted: Vec<PartedSummary>,
}

/// Two rings that were linked, and then were not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartedSummary {
    /// Name of a ring.
    pub a: String,
    /// Name of the other.
    pub b: String,
    /// Steps completed when that was first seen.
    pub step: u64,
}

/// Something that was requested and not done.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// What.
    pub what: String,
    /// Why not.
    pub why: String,
}
