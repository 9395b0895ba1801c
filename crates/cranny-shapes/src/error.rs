//! What is accepted, and what is said about the rest.

use cranny_geometry::MeshError;
use thiserror::Error;

/// The shortest accepted length. Shorter bodies leave the sign predicates' comfortable range once
/// they are posed far from the origin.
pub const MIN_LENGTH: f64 = 1e-9;

/// The greatest accepted length.
pub const MAX_LENGTH: f64 = 1e9;

/// A wall, groove or other detail is at least this fraction of the body's size. Much thinner ones
/// (about 1e-15) would round away and leave coincident vertices.
pub const MIN_DETAIL: f64 = 1e-6;

/// The most triangles that a generator makes: 2^24.
pub const MAX_FACES: u64 = 1 << 24;

/// Why a shape cannot be built.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A parameter outside its range.
    #[error("{shape}: {parameter} is {value}, but must be from {low} to {high}: {reason}")]
    Parameter {
        /// The generator.
        shape: &'static str,
        /// Its parameter.
        parameter: &'static str,
        /// The value found.
        value: f64,
        /// Least accepted value, given the other parameters.
        low: f64,
        /// Greatest accepted value, given the other parameters.
        high: f64,
        /// Where the range comes from.
        reason: &'static str,
    },
    /// More than [`MAX_FACES`] triangles.
    #[error(
        "{shape}: these parameters make about {faces} triangles, at most {limit} are built: lower the segment counts"
    )]
    TooManyFaces {
        /// The generator.
        shape: &'static str,
        /// How many it would make.
        faces: u64,
        /// How many are accepted.
        limit: u64,
    },
    /// Too few triangles for a detail to show.
    #[error(
        "{shape}: {triangles} triangles are too few for every {detail} to hold a vertex: take about {enough}, or fewer and larger ones"
    )]
    TooCoarse {
        /// The generator.
        shape: &'static str,
        /// How many are wanted.
        triangles: u32,
        /// What does not show.
        detail: &'static str,
        /// How many would do, roughly.
        enough: u64,
    },
    /// The outline of a prism crosses itself.
    #[error("{shape}: with these parameters the outline crosses itself, so it bounds no solid")]
    Outline {
        /// The generator.
        shape: &'static str,
    },
    /// Parts of a solid touch along an edge or at a corner only.
    #[error(
        "{shape}: parts touch only along an edge or at a corner, near {}, {}, {}: let them overlap there, or keep them apart",
        at[0], at[1], at[2]
    )]
    Pinched {
        /// The generator.
        shape: &'static str,
        /// Where, before anything is bent or scaled.
        at: [f64; 3],
    },
    /// The mesh was refused.
    #[error("{shape}: {source}")]
    Mesh {
        /// The generator.
        shape: &'static str,
        /// What is wrong with the mesh.
        source: MeshError,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for ShapeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Checks the parameters of one generator.
pub(crate) struct Checked {
    pub(crate) shape: &'static str,
}

impl Checked {
    /// `low <= value <= high`; `reason` says where the bounds come from.
    pub(crate) fn within(
        &self,
        parameter: &'static str,
        value: f64,
        [low, high]: [f64; 2],
        reason: &'static str,
    ) -> Result<(), ShapeError> {
        if low <= value && value <= high {
            return Ok(());
        }
        Err(ShapeError::Parameter { shape: self.shape, parameter, value, low, high, reason })
    }

    /// A length that depends on no other parameter.
    pub(crate) fn length(&self, parameter: &'static str, value: f64) -> Result<(), ShapeError> {
        self.within(parameter, value, [MIN_LENGTH, MAX_LENGTH], "a length in scene units")
    }

    /// A detail of a body of the given size: neither lost in rounding nor larger than `most`.
    pub(crate) fn detail(
        &self,
        parameter: &'static str,
        value: f64,
        size: f64,
        most: f64,
        reason: &'static str,
    ) -> Result<(), ShapeError> {
        self.within(parameter, value, [MIN_DETAIL * size, most], reason)
    }

    /// A number of segments, teeth, and so on.
    pub(crate) fn count(
        &self,
        parameter: &'static str,
        value: u32,
        low: u32,
        high: u32,
    ) -> Result<(), ShapeError> {
        self.within(parameter, value.into(), [low.into(), high.into()], "a whole number")
    }

    /// The number of triangles, estimated before anything is allocated.
    pub(crate) fn faces(&self, faces: u64) -> Result<(), ShapeError> {
        if faces <= MAX_FACES {
            return Ok(());
        }
        Err(ShapeError::TooManyFaces { shape: self.shape, faces, limit: MAX_FACES })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_shape_parameter_value_and_range() {
        let checked = Checked { shape: "Cup" };
        let error = checked.detail("wall", 5.0, 2.0, 1.0, "thinner than the radius").unwrap_err();
        assert_eq!(
            error.to_string(),
            "Cup: wall is 5, but must be from 0.000002 to 1: thinner than the radius"
        );
        assert!(checked.length("radius", f64::NAN).is_err());
        assert!(checked.length("radius", f64::INFINITY).is_err());
        assert!(checked.faces(MAX_FACES).is_ok() && checked.faces(MAX_FACES + 1).is_err());
    }
}
