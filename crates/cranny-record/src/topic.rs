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

/// `foxglove.CompressedImage`, every rendered frame of the camera.
#[must_use]
pub fn camera(name: &str) -> String {
    format!("/camera/{name}")
}

/// The frame that all bodies' transforms start from.
pub const WORLD_FRAME: &str = "world";

/// Metadata record at the file's start: what was run.
pub const METADATA: &str = "cranny";
/// Metadata record at the file's end: how it ended. Absent where the run was killed.
pub const METADATA_END: &str = "cranny.end";

/// Key of a body's metadata: the digest of its model, hexadecimal.
pub const MODEL_KEY: &str = "model";
/// Key of a body's metadata: `fixed`, `kinematic` or `dynamic`.
pub const KIND_KEY: &str = "kind";

/// Name of the attachment that holds a model which differs from what is drawn.
#[must_use]
pub fn model(digest: &str) -> String {
    format!("models/{digest}.cranny")
}
