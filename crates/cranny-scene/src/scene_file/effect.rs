//! Effects by name. What a scene has by other means gets another error than a misspelt name.
//!
//! How to add an effect: CONTRIBUTING.md, 'An effect'. This file is its third step, the first is
//! `Effect` in `cranny_world::description`.

use std::fmt;
use std::marker::PhantomData;

use cranny_world::description::{Accuracy, Effect};
use serde::de::{
    self, DeserializeSeed, EnumAccess, IntoDeserializer, MapAccess, VariantAccess, Visitor,
};
use serde::{Deserialize, Deserializer};

use super::syntax::AccuracyFile;
use super::values::{NotNegative, Positive};

/// What this version computes.
const AVAILABLE: [&str; 10] = [
    "Trigger",
    "Proximity",
    "Contacts",
    "Penetration",
    "Response",
    "Continuous",
    "Sound",
    "Deformation",
    "ForceFeedback",
    "Tracking",
];

/// What a scene gets by other means: the effect and how.
const ELSEWHERE: [(&str, &str); 5] = [
    ("Friction", "by the `friction` of a body's `material`; Response uses it"),
    ("Restitution", "by the `restitution` of a body's `material`; Response uses it"),
    ("Joints", "by the scene's field `joints`; Response uses them"),
    ("Recording", "by the scene's field `record` and the command's flag --record"),
    ("Rendering", "by the scene's field `cameras` and the command's flags --frames and --preview"),
];

/// An effect as a scene file names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EffectFile(pub(super) Effect);

impl<'de> Deserialize<'de> for EffectFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("Effect", &AVAILABLE, EffectVisitor)
    }
}

/// Reads effects; one of them at several levels or distances may stand several times.
///
/// # Errors
///
/// An effect that is named twice with the same parameters.
pub(super) fn distinct<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<EffectFile>, D::Error> {
    let effects = Vec::<EffectFile>::deserialize(from)?;
    match (1..effects.len()).find(|&i| effects[..i].contains(&effects[i])) {
        None => Ok(effects),
        Some(i) => Err(de::Error::custom(format!(
            "the effect {} is named twice. Keep one of the two",
            effects[i].0.name()
        ))),
    }
}

struct EffectVisitor;

impl<'de> Visitor<'de> for EffectVisitor {
    type Value = EffectFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an effect, as Response()")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<EffectFile, A::Error> {
        let (name, content) = data.variant::<Name>()?;
        let effect = match name {
            Name::Trigger => content
                .struct_variant(
                    &["accuracy"],
                    Parameters::<TriggerFile>::new("the parameter accuracy"),
                )
                .map(|TriggerFile { accuracy }| Effect::Trigger { accuracy: level(accuracy) }),
            Name::Response => {
                content.struct_variant(&[], Nothing("Response")).map(|()| Effect::Response)
            }
            Name::Continuous => {
                content.struct_variant(&[], Nothing("Continuous")).map(|()| Effect::Continuous)
            }
            Name::Proximity => content
                .struct_variant(
                    &["within", "accuracy"],
                    Parameters::<ProximityFile>::new("the parameters within and accuracy"),
                )
                .map(|ProximityFile { within, accuracy }| Effect::Proximity {
                    within: within.0,
                    accuracy: level(accuracy),
                }),
            Name::Contacts => content
                .struct_variant(
                    &["margin"],
                    Parameters::<ContactsFile>::exact("Contacts", "the parameter margin"),
                )
                .map(|ContactsFile { margin }| Effect::Contacts { margin: margin.0 }),
            Name::Penetration => {
                content.struct_variant(&[], Nothing("Penetration")).map(|()| Effect::Penetration)
            }
            Name::Sound => content
                .struct_variant(
                    &["above"],
                    Parameters::<SoundFile>::exact("Sound", "the parameter above"),
                )
                .map(|SoundFile { above }| Effect::Sound { above: above.0 }),
            Name::Deformation => content
                .struct_variant(
                    &["hardness", "radius"],
                    Parameters::<DeformationFile>::exact(
                        "Deformation",
                        "the parameters hardness and radius",
                    ),
                )
                .map(|DeformationFile { hardness, radius }| Effect::Deformation {
                    hardness: hardness.0,
                    radius: radius.0,
                }),
            Name::ForceFeedback => content
                .struct_variant(
                    &["stiffness"],
                    Parameters::<ForceFeedbackFile>::exact(
                        "ForceFeedback",
                        "the parameter stiffness",
                    ),
                )
                .map(|ForceFeedbackFile { stiffness }| Effect::ForceFeedback {
                    stiffness: stiffness.0,
                }),
            Name::Tracking => content
                .struct_variant(
                    &["tolerance"],
                    Parameters::<TrackingFile>::exact("Tracking", "the parameter tolerance"),
                )
                .map(|TrackingFile { tolerance }| Effect::Tracking { tolerance: tolerance.0 }),
        };
        effect.map(EffectFile)
    }
}

/// The name, judged before its content is read.
enum Name {
    Trigger,
    Proximity,
    Contacts,
    Penetration,
    Response,
    Continuous,
    Sound,
    Deformation,
    ForceFeedback,
    Tracking,
}

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_identifier(NameVisitor)
    }
}

struct NameVisitor;

impl Visitor<'_> for NameVisitor {
    type Value = Name;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the name of an effect")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Name, E> {
        match name {
            "Trigger" => return Ok(Name::Trigger),
            "Proximity" => return Ok(Name::Proximity),
            "Contacts" => return Ok(Name::Contacts),
            "Response" => return Ok(Name::Response),
            "Continuous" => return Ok(Name::Continuous),
            "Penetration" => return Ok(Name::Penetration),
            "Sound" => return Ok(Name::Sound),
            "Deformation" => return Ok(Name::Deformation),
            "ForceFeedback" => return Ok(Name::ForceFeedback),
            "Tracking" => return Ok(Name::Tracking),
            _ => {}
        }
        if let Some((_, how)) = ELSEWHERE.iter().find(|(known, _)| *known == name) {
            return Err(E::custom(format!("effect {name} is not listed: a scene has it {how}")));
        }
        Err(E::custom(format!("unknown effect {name}; available are {}", AVAILABLE.join(", "))))
    }
}

/// An effect without parameters, by its name.
struct Nothing(&'static str);

impl<'de> Visitor<'de> for Nothing {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        match map.next_key::<String>()? {
            Some(field) if field == "accuracy" => Err(has_no_level(self.0)),
            Some(field) => Err(de::Error::custom(format!(
                "unexpected parameter {field}: this effect has none"
            ))),
            None => Ok(()),
        }
    }
}

fn has_no_level<E: de::Error>(effect: &str) -> E {
    E::custom(format!(
        "effect {effect} is always exact, so it has no `accuracy`: Trigger and Proximity have one"
    ))
}

/// Parameters by name, as a structure has them.
struct Parameters<T> {
    expected: &'static str,
    /// The effect's name, where it has no level.
    exact: Option<&'static str>,
    of: PhantomData<T>,
}

impl<T> Parameters<T> {
    fn new(expected: &'static str) -> Self {
        Self { expected, exact: None, of: PhantomData }
    }

    /// Of an effect that is always exact.
    fn exact(effect: &'static str, expected: &'static str) -> Self {
        Self { exact: Some(effect), ..Self::new(expected) }
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Parameters<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        match self.exact {
            None => T::deserialize(de::value::MapAccessDeserializer::new(map)),
            Some(effect) => {
                T::deserialize(de::value::MapAccessDeserializer::new(WithoutLevel { map, effect }))
            }
        }
    }
}

/// Parameters among which `accuracy` gets an error of its own.
struct WithoutLevel<A> {
    map: A,
    effect: &'static str,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for WithoutLevel<A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, A::Error> {
        match self.map.next_key::<String>()? {
            None => Ok(None),
            Some(key) if key == "accuracy" => Err(has_no_level(self.effect)),
            Some(key) => seed.deserialize(key.into_deserializer()).map(Some),
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.map.next_value_seed(seed)
    }
}

fn level(accuracy: Option<AccuracyFile>) -> Option<Accuracy> {
    accuracy.map(AccuracyFile::level)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TriggerFile {
    #[serde(default)]
    accuracy: Option<AccuracyFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProximityFile {
    within: Positive,
    #[serde(default)]
    accuracy: Option<AccuracyFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactsFile {
    #[serde(default = "no_margin")]
    margin: NotNegative,
}

fn no_margin() -> NotNegative {
    NotNegative(0.0)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SoundFile {
    above: Positive,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DeformationFile {
    hardness: Positive,
    radius: Positive,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ForceFeedbackFile {
    stiffness: Positive,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TrackingFile {
    tolerance: Positive,
}
