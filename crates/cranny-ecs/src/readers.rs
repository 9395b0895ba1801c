//! Who reads what of the effect `Contacts`: nothing else of it is computed.

use std::collections::BTreeMap;

use bevy_ecs::prelude::Resource;
use cranny_world::ContactFields;

/// Readers of pairs that are asked for `Contacts`, by name; there is one resource where a scene
/// names the effect.
///
/// Each step computes what the readers of that moment read together, so whoever reads more than
/// [`PluginOptions::contact_fields`](crate::PluginOptions::contact_fields) says, or only now and
/// then, says so here before the step. Everybody is told the same answers: a reader may find fields
/// that only others read.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct ContactReaders(BTreeMap<&'static str, ContactFields>);

impl ContactReaders {
    /// The program that runs the scene.
    pub const PROGRAM: &'static str = "the program";
    /// [`RunSummary`](crate::RunSummary): a depth, and the points that it counts where there is no
    /// solver.
    pub const SUMMARY: &'static str = "the summary";
    /// A recording, which holds everything.
    pub const RECORDING: &'static str = "the recording";
    /// Pictures, which mark points, at the moments at which there is one.
    pub const PICTURES: &'static str = "the pictures";

    /// Says what a reader reads from the next step on, in place of what it read before.
    pub fn set(&mut self, reader: &'static str, fields: ContactFields) {
        self.0.insert(reader, fields);
    }

    /// What a reader reads.
    #[must_use]
    pub fn of(&self, reader: &str) -> ContactFields {
        self.0.get(reader).copied().unwrap_or(ContactFields::NONE)
    }

    /// What all of them read.
    #[must_use]
    pub fn fields(&self) -> ContactFields {
        self.0.values().fold(ContactFields::NONE, |all, &fields| all.join(fields))
    }

    /// Those that read anything, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, ContactFields)> {
        let readers = self.0.iter().map(|(&name, &fields)| (name, fields));
        readers.filter(|(_, fields)| *fields != ContactFields::NONE)
    }
}
