//! `docs/scenes.md` names every field and variant that the reader accepts, and has an example of
//! each that holds a value.
//!
//! The reader's own types say what these are: a [`Tracer`] is a source of values that records what
//! a type expects. It follows a path of names into [`SceneFile`] and stops at its end, so each path
//! of the format is one run.

use std::collections::{BTreeSet, VecDeque};
use std::fmt::{self, Display};
use std::fs;
use std::path::Path;

use serde::de::{
    self, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess,
    VariantAccess, Visitor,
};
use serde::{Deserialize, forward_to_deserialize_any};

use super::syntax::SceneFile;

type Names = &'static [&'static str];

/// What a type expects.
#[derive(Clone, Copy, Debug)]
enum Found {
    /// A number, a text, a variant without content.
    Value,
    Fields(&'static str, Names),
    Variants(&'static str, Names),
    /// The fields of a variant.
    Content(Names),
}

/// The end of a run: a value is never made.
#[derive(Debug)]
struct Stop {
    /// The fields that an unknown one was answered with.
    expected: Option<Names>,
}

impl Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stop")
    }
}

impl std::error::Error for Stop {}

impl de::Error for Stop {
    fn custom<T: Display>(_: T) -> Self {
        Self { expected: None }
    }

    fn unknown_field(_: &str, expected: Names) -> Self {
        Self { expected: Some(expected) }
    }
}

fn stop<T>() -> Result<T, Stop> {
    Err(Stop { expected: None })
}

/// A name that no type has.
const UNKNOWN: &str = "zzz";

/// Follows the path, then records what stands at its end.
struct Tracer<'a> {
    path: &'a [&'static str],
    found: &'a mut Found,
}

impl<'de> Deserializer<'de> for Tracer<'_> {
    type Error = Stop;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Stop> {
        stop()
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: Names,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        if self.path.is_empty() {
            *self.found = Found::Fields(name, fields);
            return stop();
        }
        visitor.visit_map(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: Names,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        if self.path.is_empty() {
            *self.found = Found::Variants(name, variants);
            return stop();
        }
        visitor.visit_enum(self)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        visitor.visit_some(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        visitor.visit_seq(self)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        let path = &[&[UNKNOWN], self.path].concat();
        visitor.visit_map(Tracer { path, found: self.found })
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        visitor.visit_newtype_struct(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct tuple tuple_struct identifier ignored_any
    }
}

impl<'de> SeqAccess<'de> for Tracer<'_> {
    type Error = Stop;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Stop> {
        seed.deserialize(Tracer { path: self.path, found: self.found }).map(Some)
    }
}

impl<'de> MapAccess<'de> for Tracer<'_> {
    type Error = Stop;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Stop> {
        let name = self.path.first().copied().unwrap_or(UNKNOWN);
        seed.deserialize(name.into_deserializer()).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Stop> {
        let path = self.path.get(1..).unwrap_or_default();
        seed.deserialize(Tracer { path, found: self.found })
    }
}

impl<'de, 'a> EnumAccess<'de> for Tracer<'a> {
    type Error = Stop;
    type Variant = Tracer<'a>;

    fn variant_seed<V: DeserializeSeed<'de>>(
        self,
        seed: V,
    ) -> Result<(V::Value, Tracer<'a>), Stop> {
        let name: de::value::StrDeserializer<'_, Stop> = self.path[0].into_deserializer();
        Ok((seed.deserialize(name)?, Tracer { path: &self.path[1..], found: self.found }))
    }
}

impl<'de> VariantAccess<'de> for Tracer<'_> {
    type Error = Stop;

    fn unit_variant(self) -> Result<(), Stop> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Stop> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, Stop> {
        stop()
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: Names, visitor: V) -> Result<V::Value, Stop> {
        let Tracer { path, found } = self;
        let read = visitor.visit_map(Tracer { path, found: &mut *found });
        if path.is_empty() {
            let expected = read.as_ref().err().and_then(|stop| stop.expected);
            *found = Found::Content(expected.unwrap_or(fields));
        }
        read
    }
}

/// A type of the format, and the names of its fields or variants.
#[derive(Debug)]
struct Type {
    /// Of a variant's content: `Enum::Variant`.
    name: String,
    has_fields: bool,
    names: Names,
}

/// All types that a scene file may hold. Generators have a page of their own.
fn types() -> Vec<Type> {
    let (mut types, mut known) = (Vec::new(), BTreeSet::new());
    let mut paths = VecDeque::from([(Vec::new(), String::new())]);
    while let Some((path, owner)) = paths.pop_front() {
        let mut found = Found::Value;
        // Every run ends in an error, or at a variant without content.
        let _ = SceneFile::deserialize(Tracer { path: &path, found: &mut found });
        let (name, names, has_fields) = match found {
            Found::Value => continue,
            Found::Fields(name, names) => (name.to_owned(), names, true),
            Found::Variants(name, names) => (name.to_owned(), names, false),
            Found::Content(names) => (owner, names, true),
        };
        if !known.insert(name.clone()) {
            continue;
        }
        for step in names.iter().filter(|step| **step != "Generator") {
            paths.push_back(([&path[..], &[step]].concat(), format!("{name}::{step}")));
        }
        types.push(Type { name, has_fields, names });
    }
    types
}

/// In which section of the page a type is. Contents of variants are where their enum is.
const SECTIONS: [(&str, &str); 38] = [
    ("Scene", "Scene"),
    ("Record", "Scene"),
    ("Body", "Bodies"),
    ("Kind", "Bodies"),
    ("Velocity", "Bodies"),
    ("Material", "Bodies"),
    ("Normals", "Bodies"),
    ("Shape", "Shapes"),
    ("Units", "Shapes"),
    ("Repair", "Shapes"),
    ("Primitive", "Shapes"),
    ("Mass", "Masses"),
    ("Pose", "Poses"),
    ("Turn", "Poses"),
    ("Path", "Paths"),
    ("Keyframe", "Paths"),
    ("Interpolation", "Paths"),
    ("PathEnd", "Paths"),
    ("Tracker", "Trackers"),
    ("Smoothing", "Trackers"),
    ("Device", "Trackers"),
    ("Group", "Groups"),
    ("Pile", "Groups"),
    ("Grid", "Groups"),
    ("Region", "Groups"),
    ("Robot", "Robots"),
    ("Motor", "Robots"),
    ("SelfCollisions", "Robots"),
    ("Joint", "Joints"),
    ("JointKind", "Joints"),
    ("MotorPath", "Joints"),
    ("MotorKeyframe", "Joints"),
    ("Effect", "Effects"),
    ("Accuracy", "Accuracy"),
    ("Pair", "Pairs"),
    ("Camera", "Cameras"),
    ("Preset", "Cameras"),
    ("LookAt", "Cameras"),
];

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scenes.md");
    fs::read_to_string(path).unwrap()
}

/// What stands under the headline of a type, if the type has one.
fn section<'a>(page: &'a str, of: &str) -> Option<&'a str> {
    let name = of.split("::").next()?;
    let (_, section) = SECTIONS.iter().find(|(known, _)| *known == name)?;
    let (_, text) = page.split_once(&format!("\n## {section}\n"))?;
    text.split("\n## ").next()
}

/// Whether an example gives a field a value, or names a variant.
fn is_shown(examples: &str, name: &str, is_field: bool) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    examples.match_indices(name).any(|(at, _)| {
        let after = &examples[at + name.len()..];
        let ends = if is_field { after.starts_with(':') } else { !after.starts_with(is_word) };
        ends && !examples[..at].ends_with(is_word)
    })
}

#[test]
fn the_tracer_sees_the_types_of_every_kind() {
    let types = types();
    let names = |of: &str| types.iter().find(|known| known.name == of).map(|known| known.names);
    assert_eq!(names("Region"), Some(&["min", "max"][..]), "a field of a variant's newtype");
    assert_eq!(names("Effect::Proximity"), Some(&["within", "accuracy"][..]), "by hand");
    assert_eq!(names("MotorKeyframe"), Some(&["time", "position"][..]), "in a map's value");
    assert_eq!(names("Turn"), Some(&["axis", "degrees"][..]), "of a type that is converted");
    assert!(names("Preset").is_some_and(|presets| presets.contains(&"Top")), "in an option");
}

#[test]
fn the_page_names_all_that_the_reader_accepts_and_has_examples() {
    let page = page();
    let examples: String =
        page.split("```ron").skip(1).filter_map(|block| block.split("```").next()).collect();
    let types = types();
    let has_content = |variant: &str| types.iter().any(|known| known.name == variant);
    let mut lacks = Vec::new();
    for Type { name, has_fields, names } in &types {
        let Some(section) = section(&page, name) else {
            lacks.push(format!("{name} has no section: name one in SECTIONS"));
            continue;
        };
        for of in *names {
            let ways = [format!("`{of}`"), format!("`{of}("), format!("{of}:")];
            if !ways.iter().any(|way| section.contains(way.as_str())) {
                lacks.push(format!("{name}: its section does not name `{of}`"));
            }
            // A variant without content is used as it is named.
            let needs_example = *has_fields || has_content(&format!("{name}::{of}"));
            if needs_example && !is_shown(&examples, of, *has_fields) {
                lacks.push(format!("{name}: no example has `{of}`"));
            }
        }
    }
    assert!(lacks.is_empty(), "docs/scenes.md: {}", lacks.join("\n"));
}
