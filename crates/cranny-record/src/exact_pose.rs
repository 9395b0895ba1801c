//! A pose in JSON, readable and to the bit.

use cranny_exact::{DQuat, DVec3, Pose};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::message::VectorMessage;

/// A pose whose JSON form keeps every bit.
///
/// The form has `rotation` and `translation` in decimals for people and viewers, and `bits`: the
/// same seven numbers as IEEE 754 bit patterns, 16 hexadecimal digits each, one after the other.
/// Reading takes the bits: decimals pass through parsers that may round.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Form", try_from = "Form")]
pub struct ExactPose(pub Pose);

#[derive(Serialize, Deserialize)]
struct Form {
    rotation: Quaternion,
    translation: VectorMessage,
    bits: String,
}

#[derive(Serialize, Deserialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

/// Hexadecimal digits of an `f64`.
const DIGITS: usize = 16;

#[derive(Debug, Error)]
#[error("pose bits '{bits}' are not seven times {DIGITS} hexadecimal digits")]
struct BitsError {
    bits: String,
}

impl From<ExactPose> for Form {
    fn from(ExactPose(pose): ExactPose) -> Self {
        let (q, t) = (pose.rotation, pose.translation);
        let numbers = [q.x, q.y, q.z, q.w, t.x, t.y, t.z];
        Self {
            rotation: Quaternion { x: q.x, y: q.y, z: q.z, w: q.w },
            translation: t.into(),
            bits: numbers.map(|x| format!("{:016x}", x.to_bits())).concat(),
        }
    }
}

impl TryFrom<Form> for ExactPose {
    type Error = BitsError;

    fn try_from(form: Form) -> Result<Self, BitsError> {
        let number = |i: usize| {
            let digits = form.bits.get(i * DIGITS..(i + 1) * DIGITS)?;
            let hexadecimal = digits.bytes().all(|d| d.is_ascii_hexdigit());
            let bits = u64::from_str_radix(digits, 16).ok().filter(|_| hexadecimal)?;
            Some(f64::from_bits(bits))
        };
        let numbers: Option<Vec<f64>> = (0..7).map(number).collect();
        match numbers.as_deref() {
            Some(&[x, y, z, w, tx, ty, tz]) if form.bits.len() == 7 * DIGITS => Ok(Self(Pose {
                rotation: DQuat::from_xyzw(x, y, z, w),
                translation: DVec3::new(tx, ty, tz),
            })),
            _ => Err(BitsError { bits: form.bits }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_survives() {
        let pose = Pose {
            rotation: DQuat::from_xyzw(0.1, -0.0, f64::MIN_POSITIVE / 8.0, 0.994_987_437_106_62),
            translation: DVec3::new(1.0 / 3.0, -1e300, 5e-324),
        };
        let text = serde_json::to_string(&ExactPose(pose)).unwrap();
        let ExactPose(read) = serde_json::from_str(&text).unwrap();
        assert_eq!(read.bits(), pose.bits());
        assert_eq!(read.rotation.y.to_bits(), (-0.0f64).to_bits());
    }

    #[test]
    fn damaged_bits_are_refused() {
        let good = serde_json::to_string(&ExactPose(Pose::IDENTITY)).unwrap();
        for (from, to) in [("3ff0", "3f0"), ("3ff0", "3fg0"), ("3ff0", "+ff0"), ("3ff0", "é0")] {
            let bad = good.replace(from, to);
            assert_ne!(bad, good);
            let error = serde_json::from_str::<ExactPose>(&bad).unwrap_err().to_string();
            assert!(error.contains("hexadecimal"), "{error}");
        }
    }
}
