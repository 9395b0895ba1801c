//! Concavities, envelopes, deformations and the walk, by their public interfaces.

mod body;
mod concavities;
mod deform;
mod envelopes;
mod from_bytes;
mod leaf_sizes;
#[path = "../../../cranny-geometry/tests/suite/meshes.rs"]
mod meshes;
mod observe;
mod walk;

// Where the fuzz targets and the tests of cranny-scene have them, too.
use self::concavities::check;
use self::deform::equal;
