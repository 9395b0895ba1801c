//! Effects by name. A known effect that this version does not have gets another error than a
//! misspelt one.
//!
//! How to add an effect: CONTRIBUTING.md, 'An effect'. This file is its third step, the first is
//! `Effect` in `cranny_world::description`.

use std::fmt;

use cranny_world::description::Effect;
use serde::de::{self, EnumAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::values::{NotNegative, Positive};

/// What this version computes.
const AVAILABLE: [&str; 5] = ["Trigger", "Proximity", "Contacts", "Response", "Continuous"];

/// What later versions will.
const LATER: [&str; 4] = ["Penetration", "Deformation", "ForceFeedback", "Sound"];

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

struct EffectVisitor;

impl<'de> Visitor<'de> for EffectVisitor {
    type Value = EffectFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an effect, as Response()")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<EffectFile, A::Error> {
        let (name, content) = data.variant::<Name>()?;
        let effect = match name {
            Name::Trigger => content.struct_variant(&[], Nothing).map(|()| Effect::Trigger),
            Name::Response => content.struct_variant(&[], Nothing).map(|()| Effect::Response),
            Name::Continuous => content.struct_variant(&[], Nothing).map(|()| Effect::Continuous),
            Name::Proximity => content
                .struct_variant(&["within"], Proximity)
                .map(|within| Effect::Proximity { within }),
            Name::Contacts => content
                .struct_variant(&["margin"], Contacts)
                .map(|margin| Effect::Contacts { margin }),
        };
        effect.map(EffectFile)
    }
}

/// The name, judged before its content is read.
enum Name {
    Trigger,
    Proximity,
    Contacts,
    Response,
    Continuous,
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
            _ => {}
        }
        if LATER.contains(&name) {
            return Err(E::custom(format!(
                "effect {name} is known but not available in this version; available are {}",
                AVAILABLE.join(", ")
            )));
        }
        if let Some((_, how)) = ELSEWHERE.iter().find(|(known, _)| *known == name) {
            return Err(E::custom(format!("effect {name} is not listed: a scene has it {how}")));
        }
        Err(E::custom(format!(
            "unknown effect {name}; available are {}, and known but not available in this version are {}",
            AVAILABLE.join(", "),
            LATER.join(", ")
        )))
    }
}

/// An effect without parameters.
struct Nothing;

impl<'de> Visitor<'de> for Nothing {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no parameters")
    }

    fn visit_map<A: de::MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        match map.next_key::<String>()? {
            Some(field) => Err(de::Error::custom(format!(
                "unexpected parameter {field}: this effect has none"
            ))),
            None => Ok(()),
        }
    }
}

struct Proximity;

impl<'de> Visitor<'de> for Proximity {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the parameter within")
    }

    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<f64, A::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Parameters {
            within: Positive,
        }
        Parameters::deserialize(de::value::MapAccessDeserializer::new(map))
            .map(|parameters| parameters.within.0)
    }
}

struct Contacts;

impl<'de> Visitor<'de> for Contacts {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the parameter margin")
    }

    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<f64, A::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Fields {
            #[serde(default = "no_margin")]
            margin: NotNegative,
        }
        fn no_margin() -> NotNegative {
            NotNegative(0.0)
        }
        Fields::deserialize(de::value::MapAccessDeserializer::new(map))
            .map(|fields| fields.margin.0)
    }
}
