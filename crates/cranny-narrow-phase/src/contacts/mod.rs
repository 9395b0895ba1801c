//! Contacts for a solver: for each pair of patches that come near, their nearest points.
//!
//! A solver needs few contacts, each with the normal of its own point, spread over what touches, and
//! the same ones in the next step. So surfaces are asked patch by patch (`cranny_geometry::Patches`,
//! pieces of nearly one normal): a pair of patches yields the contact of least separation, found by
//! branch and bound (`search`), begun from last step's. A patch too large to be a place yields
//! as many as span it. Features make contacts only along directions that they face in the full
//! mesh (`facing`), and their normals are exact there (`feature_pair`). Where the solids overlap,
//! depths take the place of gaps (`overlap`).
//!
//! The answer is a function of models, poses and margin: memory holds upper bounds only.

mod facet;
pub(crate) mod facing;
mod feature_pair;
mod overlap;
mod posed;
mod search;

use std::collections::BTreeMap;

use cranny_exact::Meeting;
use cranny_geometry::{Model, PatchId};

use self::feature_pair::{across_gap, patch_index};
use self::search::{Search, nearer};
use crate::answer::{Contact, Counters, Feature};
use crate::pair::{Pair, Side};
use crate::reduce::reduce;
use crate::surface::{FacePair, strongest};

/// What the last search found: the features of each pair of patches' nearest contact.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactMemory {
    digests: [[u8; 32]; 2],
    nearest: BTreeMap<[PatchId; 2], (Feature, Feature)>,
}

impl ContactMemory {
    /// Features are numbers of these two models; others' mean nothing.
    fn belong_to(&mut self, pair: &Pair) {
        let digests = Side::BOTH.map(|side| pair.model(side).digest());
        if self.digests != digests {
            *self = Self { digests, nearest: BTreeMap::new() };
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.nearest.len() * size_of::<([PatchId; 2], (Feature, Feature))>()
    }
}

/// What was found between two surfaces.
pub(crate) struct Near {
    /// All pairs of faces that meet, by ascending ids.
    pub(crate) meeting: Vec<FacePair>,
    /// In the pair's frame; nearest first.
    pub(crate) contacts: Vec<Contact>,
}

/// Finds every pair of faces that meet, and the contacts of all pairs of patches within `margin`.
///
/// Cost: near-linear in the faces that lie within the *nearest* gap of each pair of patches; where
/// solids overlap, a search of one nearest point for each vertex inside.
pub(crate) fn near_patches(
    pair: &Pair,
    margin: f64,
    memory: &mut ContactMemory,
    counters: &mut Counters,
) -> Near {
    memory.belong_to(pair);
    let mut search = Search::new(pair);
    let mut groups: BTreeMap<[PatchId; 2], Vec<Contact>> = BTreeMap::new();
    let mut nearest = BTreeMap::new();
    for patches in search.near_patches(margin, counters) {
        let known = memory.nearest.get(&patches).filter(|_| !search.is_coarse(patches));
        let bound = known.and_then(|&id| across_gap(pair, id, margin)).map(|c| c.separation);
        let mut found = match bound {
            Some(bound) => search.between(patches, bound.max(0.0), counters),
            None => Vec::new(),
        };
        // What memory names may be seen from no face of its patch, by rounding.
        if found.is_empty() {
            found = search.between(patches, margin, counters);
        }
        if let Some(first) = found.first() {
            nearest.insert(patches, first.id);
            groups.insert(patches, found);
        }
    }
    memory.nearest = nearest;
    let mut meeting = std::mem::take(&mut search.meeting);
    meeting.sort_unstable();
    meeting.dedup();
    if strongest(&meeting) == Meeting::Cross {
        for contact in overlap::overlaps(pair, &meeting, counters) {
            groups.entry(patches_of(pair, contact.id)).or_default().push(contact);
        }
    }
    let mut contacts: Vec<Contact> = Vec::new();
    for (patches, group) in groups {
        if search.is_coarse(patches) {
            contacts.extend(reduce(group));
        } else {
            contacts.extend(group.into_iter().min_by(nearer));
        }
    }
    contacts.sort_by(nearer);
    Near { meeting, contacts }
}

fn patches_of(pair: &Pair, id: (Feature, Feature)) -> [PatchId; 2] {
    let of = |side, feature| PatchId(patch_index(pair.model(side), feature));
    [of(Side::First, id.0), of(Side::Second, id.1)]
}

impl Contact {
    /// The patches whose contact this is: what stays the same from step to step while the features
    /// change that lie nearest. `a` and `b` are the models that were asked about.
    #[must_use]
    pub fn patches(&self, a: &Model, b: &Model) -> (PatchId, PatchId) {
        let of = |model: &Model, feature| PatchId(patch_index(model, feature));
        (of(a, self.id.0), of(b, self.id.1))
    }
}
