//! Who reads what of the effect `Contacts`: nothing else of it is computed.

use std::collections::BTreeMap;

use bevy_ecs::prelude::Resource;
use cranny_world::{BodyId, ContactFields};

use crate::effects::{Pair, ordered};

/// Readers of pairs with `Contacts`, by name; there is one resource where a scene names the effect.
///
/// Each step computes what the readers of that moment read together, so whoever reads more than
/// [`PluginOptions::contact_fields`](crate::PluginOptions::contact_fields) says, or only now and
/// then, says so here before the step, of all pairs or of one. Everybody gets the same answers: a
/// reader may find fields that only others read.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct ContactReaders {
    of_all: BTreeMap<&'static str, ContactFields>,
    of_pairs: BTreeMap<Pair, BTreeMap<&'static str, ContactFields>>,
}

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

    /// Says what a reader reads of all pairs from the next step on, in place of what it read of all
    /// before.
    pub fn set(&mut self, reader: &'static str, fields: ContactFields) {
        self.of_all.insert(reader, fields);
    }

    /// Says what a reader reads of one pair from the next step on, besides what is read of all, in
    /// place of what it read of that pair before; [`ContactFields::NONE`] ends it. The order of the
    /// bodies does not matter.
    pub fn set_of_pair(
        &mut self,
        reader: &'static str,
        (a, b): (BodyId, BodyId),
        fields: ContactFields,
    ) {
        let readers = self.of_pairs.entry(ordered(a, b)).or_default();
        if fields == ContactFields::NONE {
            readers.remove(reader);
        } else {
            readers.insert(reader, fields);
        }
        self.of_pairs.retain(|_, readers| !readers.is_empty());
    }

    /// What a reader reads of all pairs.
    #[must_use]
    pub fn of(&self, reader: &str) -> ContactFields {
        self.of_all.get(reader).copied().unwrap_or(ContactFields::NONE)
    }

    /// What all of them read of all pairs.
    #[must_use]
    pub fn fields(&self) -> ContactFields {
        joined(&self.of_all)
    }

    /// What is read of single pairs besides.
    pub(crate) fn fields_of_pairs(&self) -> BTreeMap<Pair, ContactFields> {
        self.of_pairs.iter().map(|(&pair, readers)| (pair, joined(readers))).collect()
    }

    /// The single pairs of which something is read besides.
    pub(crate) fn named_pairs(&self) -> impl Iterator<Item = Pair> {
        self.of_pairs.keys().copied()
    }

    /// Those that read anything of all pairs, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, ContactFields)> {
        let readers = self.of_all.iter().map(|(&name, &fields)| (name, fields));
        readers.filter(|(_, fields)| *fields != ContactFields::NONE)
    }

    /// Those that read anything of a pair, by name.
    pub fn iter_of_pair(
        &self,
        a: BodyId,
        b: BodyId,
    ) -> impl Iterator<Item = (&'static str, ContactFields)> {
        let mut readers = self.of_all.clone();
        for (&name, &fields) in self.of_pairs.get(&ordered(a, b)).into_iter().flatten() {
            let all = readers.entry(name).or_insert(ContactFields::NONE);
            *all = all.join(fields);
        }
        readers.into_iter().filter(|(_, fields)| *fields != ContactFields::NONE)
    }
}

fn joined(readers: &BTreeMap<&'static str, ContactFields>) -> ContactFields {
    readers.values().fold(ContactFields::NONE, |all, &fields| all.join(fields))
}
