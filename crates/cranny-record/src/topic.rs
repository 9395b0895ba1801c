//! Names of the topics and of the records beside them: a contract with whoever reads the files.

/// `foxglove.SceneUpdate`, once: an entity a body, in the body's own frame.
pub const BODIES: &str = "/scene/bodies";
/// `foxglove.FrameTransforms`, every frame: `world` from each body.
pub const TRANSFORMS: &str = "/tf";
/// `foxglove.SceneUpdate`, every frame: contact points, normals and curves, an entity a pair.
pub const CONTACT_SCENE: &str = "/contacts/scene";
/// `foxglove.PointCloud`, every frame: contact points with their separation.
pub const CONTACT_POINTS: &str = "/contacts/points";
/// `foxglove.PosesInFrame`, every frame: contact points with x along the normal.
pub const CONTACT_NORMALS: &str = "/contacts/normals";
/// `cranny.Contacts` (JSON), every frame: everything about pairs, poses to the bit.
pub const CONTACTS: &str = "/contacts";
/// `cranny.PairEvents` (JSON), every frame.
pub const EVENTS: &str = "/events";
/// `cranny.StepStats` (JSON), every frame.
pub const STATS: &str = "/stats";
/// `foxglove.Log`.
pub const LOG: &str = "/log";

/// What topics of cameras begin with.
pub(crate) const CAMERAS: &str = "/camera/";

/// `foxglove.CompressedImage`, every rendered frame of the camera.
#[must_use]
pub fn camera(name: &str) -> String {
    format!("{CAMERAS}{name}")
}

/// The frame that all bodies' transforms start from.
pub const WORLD_FRAME: &str = "world";

/// Metadata record at the file's start: what was run.
pub const METADATA: &str = "cranny";
/// Metadata record at the file's end: how it ended. Absent where the run was killed.
pub const METADATA_END: &str = "cranny.end";

/// Key of a body's metadata: the digest of its model, hexadecimal.
pub const MODEL_KEY: &str = "model";
/// Key of a body's metadata: the primitive that it is, in words.
pub const PRIMITIVE_KEY: &str = "primitive";
/// Key of a body's metadata: `fixed`, `kinematic` or `dynamic`.
pub const KIND_KEY: &str = "kind";
/// Key of a body's metadata: `#rrggbb`, where somebody chose its color.
pub const COLOR_KEY: &str = "color";
/// Key of a body's metadata: its number in the run.
pub const NUMBER_KEY: &str = "number";
/// Key of a body's metadata: `true` for a sensor; absent for other bodies.
pub const SENSOR_KEY: &str = "sensor";

/// Name of the attachment that holds the scene's text.
pub const SCENE: &str = "scene.ron";

/// Name of the attachment that holds a model which differs from what is drawn.
#[must_use]
pub fn model(digest: &str) -> String {
    format!("models/{digest}.cranny")
}

/// Key of the metadata record [`METADATA`]: names of the effects that the scene has.
pub const EFFECTS_KEY: &str = "effects";

/// Key of the same record: the scene's cameras, a line each; absent where it names none.
pub const CAMERAS_KEY: &str = "cameras";

/// Key of the same record: elementary tests that a step may take for triggers and distances; absent
/// where they take as many as they need.
pub const BUDGET_KEY: &str = "budget";

/// Measure of `/stats`: milliseconds a step, mean since the frame before.
pub const MS_BROAD: &str = "ms_broad";
/// As [`MS_BROAD`], of the narrow phase.
pub const MS_NARROW: &str = "ms_narrow";
/// As [`MS_BROAD`], of the rest of the solver's step.
pub const MS_SOLVER: &str = "ms_solver";
/// As [`MS_BROAD`], of detection for reports only.
pub const MS_REPORT: &str = "ms_report";
/// As [`MS_BROAD`], of recording.
pub const MS_RECORD: &str = "ms_record";
/// As [`MS_BROAD`], of pictures.
pub const MS_RENDER: &str = "ms_render";
/// The phases of a step, in order.
pub const PHASES: [&str; 6] = [MS_BROAD, MS_NARROW, MS_SOLVER, MS_REPORT, MS_RECORD, MS_RENDER];
/// Measure of `/stats`: mechanical energy of all that moves, where a solver moves it.
pub const ENERGY: &str = "energy";
