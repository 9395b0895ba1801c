//! How a model is prepared, what refuses to be, and what is reported meanwhile.

use cranny_exact::Tolerance;
use thiserror::Error;

use crate::flatness::Flatness;
use crate::mesh::Mesh;
use crate::repair::Repair;
use crate::repair::proof::ProofError;
use crate::resolution::default_weld_distance;

/// How to prepare a model.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Faces per leaf of the tree, at least 1. Default: [`BuildOptions::DEFAULT_LEAF_SIZE`].
    pub leaf_size: usize,
    /// What may be mended. Default: [`Repair::None`], which keeps the surface as it was filed.
    pub repair: Repair,
    /// What 'the same place' means for findings and repairs: at most
    /// [`BuildOptions::LARGEST_WELD_SHARE`] of the mesh's diagonal. Default: `None`, chosen from
    /// how finely the coordinates were stored: twice the step of a grid that holds them all, in any
    /// unit, or eight times the step of single precision (also where [`flatness`](Self::flatness)
    /// says that) or double precision at the largest coordinate, but never more than a
    /// ten-thousandth of the diagonal.
    pub tolerance: Option<Tolerance>,
    /// Whether faces that cross, touch or overlap each other are searched for. Default: yes.
    pub self_intersections: bool,
    /// How flat is flat. Default: [`Flatness::Auto`].
    pub flatness: Flatness,
}

impl BuildOptions {
    /// One face a leaf made cold queries fastest on tori and threads; more than four slows them.
    pub const DEFAULT_LEAF_SIZE: usize = 1;

    /// The largest weld distance, as a share of the mesh's diagonal. Larger, and everything is near
    /// everything: repairs mean nothing and searches take quadratic time.
    pub const LARGEST_WELD_SHARE: f64 = 0.01;
}

/// The weld distance given, or the default for a mesh.
pub(super) fn weld_distance(
    tolerance: Option<Tolerance>,
    flatness: Flatness,
    mesh: &Mesh,
) -> Result<f64, BuildError> {
    let Some(Tolerance { weld_distance }) = tolerance else {
        return Ok(default_weld_distance(mesh, flatness == Flatness::Single));
    };
    let limit = BuildOptions::LARGEST_WELD_SHARE * mesh.bounds().diagonal();
    match (0.0..=limit).contains(&weld_distance) {
        true => Ok(weld_distance),
        false => Err(BuildError::WeldDistance { weld_distance, limit }),
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            leaf_size: Self::DEFAULT_LEAF_SIZE,
            repair: Repair::None,
            tolerance: None,
            self_intersections: true,
            flatness: Flatness::default(),
        }
    }
}

/// That no face of so many has an area, in words.
pub(crate) fn no_area(faces: usize) -> String {
    match faces {
        1 => "the only face has zero area".to_owned(),
        n => format!("all {n} faces have zero area"),
    }
}

/// A model that cannot be prepared.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The mesh holds no triangle with an area.
    #[error("{}: a body needs at least one triangle with an area", no_area(*.faces))]
    OnlyDegenerateFaces {
        /// Number of faces.
        faces: usize,
    },
    /// A weld distance that is negative, no number, or too large for the mesh.
    #[error(
        "the weld distance {weld_distance:?} is not between 0 and {limit:?}, a hundredth of the mesh's diagonal"
    )]
    WeldDistance {
        /// The distance.
        weld_distance: f64,
        /// The largest for this mesh.
        limit: f64,
    },
    /// A tree whose leaves would hold no face.
    #[error("a leaf size of 0 faces: at least 1 is needed")]
    LeafSize,
    /// A repair whose proof does not hold: an error of this crate. Build with [`Repair::None`].
    #[error("the repaired mesh could not be proved to be the same surface: {0}")]
    NotProved(#[from] ProofError),
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for BuildError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// A stage of preparation, reported to whoever measures times (this crate reads no clock).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Weld, repair, adjacency.
    Repair,
    /// The box tree over all faces, and patches.
    Trees,
    /// Scan for findings.
    Scan,
    /// Convex hull.
    Hull,
    /// All done.
    Done,
}
