//! Numbers of a scene file, checked while their place is known.

use std::fmt::{self, Formatter};
use std::ops::RangeInclusive;

use cranny_exact::{DQuat, DVec3, Pose, PoseError, check_point};
use cranny_world::description::BodyColor;
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, Deserializer, SeqAccess, Unexpected, Visitor};

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

/// A quaternion (x, y, z, w) of unit length, or nearly.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "[f64; 4]")]
pub(super) struct Rotation {
    pub(super) unit: DQuat,
    /// Its length as filed, where that is off 1 by more than digits that were left out.
    pub(super) length: Option<f64>,
}

impl TryFrom<[f64; 4]> for Rotation {
    type Error = PoseError;

    fn try_from(numbers: [f64; 4]) -> Result<Self, PoseError> {
        let quaternion = DQuat::from_array(numbers);
        let unit = Pose::of_few_digits(quaternion, DVec3::ZERO)?.rotation;
        let is_precise = Pose::checked(quaternion, DVec3::ZERO).is_ok();
        Ok(Self { unit, length: (!is_precise).then(|| quaternion.length()) })
    }
}

/// Factors along the axes: one number stands for all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale(pub(super) DVec3);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ScaleVisitor)
    }
}

struct ScaleVisitor;

impl<'de> Visitor<'de> for ScaleVisitor {
    type Value = Scale;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("a factor, or three of them (x, y, z)")
    }

    fn visit_f64<E: de::Error>(self, factor: f64) -> Result<Scale, E> {
        Vector::try_from([factor; 3]).map(|factors| Scale(factors.0)).map_err(E::custom)
    }

    fn visit_i64<E: de::Error>(self, factor: i64) -> Result<Scale, E> {
        self.visit_f64(factor as f64)
    }

    fn visit_u64<E: de::Error>(self, factor: u64) -> Result<Scale, E> {
        self.visit_f64(factor as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, factors: A) -> Result<Scale, A::Error> {
        let factors = Vector::deserialize(SeqAccessDeserializer::new(factors))?;
        Ok(Scale(factors.0))
    }
}

/// A colour: `"#d08030"`, or channels from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColorFile(pub(super) BodyColor);

impl<'de> Deserialize<'de> for ColorFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColorVisitor)
    }
}

struct ColorVisitor;

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = ColorFile;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("a color: \"#d08030\", or three numbers from 0 to 1 (red, green, blue)")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<ColorFile, E> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
        let digits = digits.filter(|digits| digits.bytes().all(|byte| byte.is_ascii_hexdigit()));
        let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let [_, rgb @ ..] =
            number.ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))?.to_be_bytes();
        Ok(ColorFile(BodyColor(rgb)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, channels: A) -> Result<ColorFile, A::Error> {
        let channels = <[f64; 3]>::deserialize(SeqAccessDeserializer::new(channels))?;
        let color = BodyColor::of_shares(channels).map(ColorFile);
        color.ok_or_else(|| {
            de::Error::custom(format!(
                "expected red, green and blue from 0 to 1, found {channels:?}"
            ))
        })
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

/// Masses and densities that solvers hold in single precision, with room for inertia. Wider: a
/// scene passes that no solver takes; narrower: bodies as small as cells or as large as planets are
/// refused.
pub(super) const HELD: RangeInclusive<f64> = 1e-30..=1e30;

/// A density or a mass: greater than 0, and within what solvers hold.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Weight(pub(super) f64);

impl TryFrom<f64> for Weight {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        let Positive(value) = value.try_into()?;
        match HELD.contains(&value) {
            true => Ok(Self(value)),
            false => Err(format!(
                "expected a number from {:e} to {:e}, which solvers hold, found {value:e}",
                HELD.start(),
                HELD.end()
            )),
        }
    }
}

/// A coefficient of friction: at least 0, and within what solvers hold.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Grip(pub(super) f64);

impl TryFrom<f64> for Grip {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        let NotNegative(value) = value.try_into()?;
        match value <= *HELD.end() {
            true => Ok(Self(value)),
            false => Err(format!(
                "expected a number from 0 to {:e}, which solvers hold, found {value:e}",
                HELD.end()
            )),
        }
    }
}
