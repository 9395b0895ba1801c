//! What a certificate says.

use serde::{Deserialize, Serialize, Serializer};

use crate::direction::Parts;

/// How two surfaces meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SurfaceVerdict {
    /// They share no point.
    None,
    /// They share points, and no two triangles cross.
    Touch,
    /// Two triangles share a point that is inside both, and do not lie in one plane.
    Cross,
}

/// Which body lies in which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Contained {
    /// A in B.
    #[serde(rename = "A_in_B")]
    AInB,
    /// B in A.
    #[serde(rename = "B_in_A")]
    BInA,
}

/// What is claimed of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Claim {
    /// How the surfaces meet.
    pub surface: SurfaceVerdict,
    /// Whether the bodies share interior points.
    pub solid: bool,
    /// Which lies wholly in which.
    pub contained: Option<Contained>,
}

/// Whose frame everything is decided in: its vertices stay as filed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Frame {
    /// A's.
    A,
    /// B's.
    B,
}

/// A step through pairs of groups of faces. It begins with all faces of A and all of B; each step
/// is about the pair that was left latest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Step {
    /// Divides the group of A (1) or of B (2) in halves; two pairs take the place of one.
    Halve(u8),
    /// Parts the groups by planes at right angles to a direction.
    Direction(#[serde(serialize_with = "briefly")] [f64; 3]),
    /// Parts two single faces along the direction between parts of them.
    Parts(Parts),
    /// Parts the groups along the direction between parts of two faces.
    PartsOf {
        /// A face of A, one of B.
        faces: [u32; 2],
        /// Their parts.
        parts: Parts,
    },
    /// One of two single faces has no area, and so crosses nothing.
    Needle {
        /// Always true.
        needle: bool,
    },
}

/// Whole numbers without a point.
fn briefly<S: Serializer>(direction: &[f64; 3], serializer: S) -> Result<S::Ok, S::Error> {
    /// Up to here every whole number is a `f64`.
    const WHOLE: f64 = 9_007_199_254_740_992.0;
    if direction.iter().all(|x| x.fract() == 0.0 && x.abs() < WHOLE) {
        direction.map(|x| x as i64).serialize(serializer)
    } else {
        direction.serialize(serializer)
    }
}

/// What proves a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evidence {
    /// A face of A and one of B that cross; nothing else is needed then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crossing: Option<[u32; 2]>,
    /// A face of A and one of B that share a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub touching: Option<[u32; 2]>,
    /// Steps that part all faces of A from all of B.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub apart: Vec<Step>,
}

/// Where the bodies are, and what proves the verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// `world_from_a` and `world_from_b`, 16 numbers each, row by row.
    #[serde(with = "matrices")]
    pub poses: [[f64; 16]; 2],
    /// Whose frame everything is decided in.
    pub frame: Frame,
    /// Three rows of four: from the other body's frame to this one's.
    pub map: [f64; 12],
    /// The proof.
    pub evidence: Evidence,
}

mod matrices {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub(super) fn serialize<S: Serializer>(m: &[[f64; 16]; 2], s: S) -> Result<S::Ok, S::Error> {
        m.each_ref().map(|m| m.as_slice()).serialize(s)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<[[f64; 16]; 2], D::Error> {
        let found = <[Vec<f64>; 2]>::deserialize(d)?;
        let count = found.each_ref().map(Vec::len);
        let wrong =
            || D::Error::custom(format!("poses have {count:?} numbers, 16 each are needed"));
        let [a, b] = found.map(<[f64; 16]>::try_from);
        Ok([a.map_err(|_| wrong())?, b.map_err(|_| wrong())?])
    }
}
