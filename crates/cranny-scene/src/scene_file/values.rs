//! Numbers of a scene file, checked while their place is known.

use cranny_exact::{DQuat, DVec3, check_point};
use serde::Deserialize;

/// Three numbers inside the coordinate domain.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "[f64; 3]")]
pub(super) struct Vector(pub(super) DVec3);

impl TryFrom<[f64; 3]> for Vector {
    type Error = String;

    fn try_from(numbers: [f64; 3]) -> Result<Self, String> {
        let vector = DVec3::from_array(numbers);
        check_point(vector).map_err(|error| error.to_string())?;
        Ok(Self(vector))
    }
}

/// A unit quaternion (x, y, z, w).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "[f64; 4]")]
pub(super) struct Rotation(pub(super) DQuat);

impl TryFrom<[f64; 4]> for Rotation {
    type Error = String;

    fn try_from(numbers: [f64; 4]) -> Result<Self, String> {
        let quaternion = DQuat::from_array(numbers);
        let pose = cranny_exact::Pose::checked(quaternion, DVec3::ZERO);
        pose.map(|pose| Self(pose.rotation)).map_err(|error| error.to_string())
    }
}

/// A direction: normalised.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Vector")]
pub(super) struct Axis(pub(super) DVec3);

impl TryFrom<Vector> for Axis {
    type Error = String;

    fn try_from(vector: Vector) -> Result<Self, String> {
        let axis = vector.0.try_normalize();
        axis.map(Self).ok_or_else(|| format!("an axis must have a length, found {}", vector.0))
    }
}

macro_rules! ranges {
    ($($name:ident: $what:literal, $test:expr;)*) => {$(
        #[doc = $what]
        #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
        #[serde(try_from = "f64")]
        pub(super) struct $name(pub(super) f64);

        impl TryFrom<f64> for $name {
            type Error = String;

            fn try_from(value: f64) -> Result<Self, String> {
                let test: fn(f64) -> bool = $test;
                if test(value) { Ok(Self(value)) } else { Err(format!("expected {}, found {value}", $what)) }
            }
        }
    )*};
}

ranges! {
    Positive: "a finite number greater than 0", |x| x > 0.0 && x.is_finite();
    NotNegative: "a finite number of at least 0", |x| x >= 0.0 && x.is_finite();
    Fraction: "a number from 0 to 1", |x| (0.0..=1.0).contains(&x);
    FaceAngle: "a number of radians from 0 to π", |x| (0.0..=std::f64::consts::PI).contains(&x);
    Finite: "a finite number", f64::is_finite;
}
