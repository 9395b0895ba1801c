//! Contacts for a solver: for each pair of patches that come near, their nearest points.
//!
//! A solver needs few contacts, each with the normal of its own point, spread over what touches, and
//! the same ones in the next step. So surfaces are asked patch by patch (`cranny_geometry::Patches`,
//! pieces of nearly one normal): a pair of patches yields the contact of least separation, found by
//! branch and bound (`search`), begun from last step's. A patch too large to be a place yields
//! as many as span it. Features make contacts only along directions that they face in the full
//! mesh (`facing`; of two edges `gauss_map` tells mostly), and their normals are exact there (`feature_pair`). Where the solids overlap,
//! depths take the place of gaps (`overlap`, of the vertices `within`). From which face a feature is looked at stands in `ownership`.
//!
//! While bodies move little, only what was near is looked at (`candidates`, by `gather`).
//!
//! The answer is a function of models, poses and margin: memory holds upper bounds, what
//! these two models alone say, and what cannot have come near.

mod candidates;
mod close_faces;
mod coarse;
mod cut;
mod facet;
pub(crate) mod facing;
mod feature_pair;
mod features;
mod gather;
mod gauss_map;
mod kept;
mod leaf;
mod oriented;
mod overlap;
mod ownership;
mod posed;
mod quest;
mod search;
mod within;
#[cfg(test)]
mod wrenches;

use std::collections::BTreeMap;

use cranny_exact::Meeting;
use cranny_geometry::{Model, PatchId};

use self::candidates::Candidates;
use self::coarse::Coarse;
use self::feature_pair::patch_index;
pub(crate) use self::kept::Kept;
use self::quest::{Wanted, nearer};
use self::search::Search;
use crate::answer::{Contact, Counters, Feature};
use crate::pair::{Pair, Side};
use crate::reduce::reduce;
use crate::surface::{FacePair, strongest};

/// What searches keep for the next one.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactMemory {
    kept: Kept,
    candidates: Candidates,
}

impl ContactMemory {
    /// Lets go of what is of use only while bodies are near each other.
    pub(crate) fn let_go(&mut self) {
        self.kept.let_go();
        self.candidates = Candidates::default();
    }

    pub(crate) fn bytes(&self) -> usize {
        self.kept.bytes() + self.candidates.bytes()
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
    let coarse = Coarse::of(pair);
    let wanted = |patches| if coarse.holds(pair, patches) { Wanted::All } else { Wanted::Nearest };
    let mut groups = BTreeMap::new();
    let meeting = each_near(pair, (margin, true), wanted, memory, counters, |patches, found| {
        if !found.is_empty() {
            groups.insert(patches, found);
        }
    });
    if strongest(&meeting) == Meeting::Cross {
        for contact in overlap::overlaps(pair, &meeting, counters) {
            groups.entry(patches_of(pair, contact.id)).or_default().push(contact);
        }
    }
    let mut contacts: Vec<Contact> = Vec::new();
    for (patches, group) in groups {
        if coarse.holds(pair, patches) {
            contacts.extend(reduce(group));
        } else {
            contacts.extend(group.into_iter().min_by(nearer));
        }
    }
    contacts.sort_by(nearer);
    Near { meeting, contacts }
}

/// All contacts of two surfaces across a gap of at most `margin`, in the pair's frame; in no order. Where surfaces touch, gaps may be
/// negative by rounding.
///
/// Cost: as of [`near_patches`], but near-linear in the faces within the margin.
pub(crate) fn across_gaps(
    pair: &Pair,
    margin: f64,
    memory: &mut ContactMemory,
    counters: &mut Counters,
) -> Vec<Contact> {
    let mut all = Vec::new();
    let wanted = |_| Wanted::All;
    each_near(pair, (margin, false), wanted, memory, counters, |_, found| all.extend(found));
    all
}

/// Tells the contacts of each pair of patches within `margin`; faces that meet, by ascending ids, if asked for.
fn each_near(
    pair: &Pair,
    (margin, meets): (f64, bool),
    wanted: impl Fn([PatchId; 2]) -> Wanted,
    memory: &mut ContactMemory,
    counters: &mut Counters,
    told: impl FnMut([PatchId; 2], Vec<Contact>),
) -> Vec<FacePair> {
    if !memory.kept.belong_to(pair) {
        memory.candidates = Candidates::default();
    }
    memory.kept.reserve(pair);
    let mut search = Search::new(pair, std::mem::take(&mut memory.kept));
    let mut meeting = Vec::new();
    let asked = (margin, meets);
    memory.candidates.each(&mut search, asked, wanted, &mut meeting, counters, told);
    memory.kept = search.end();
    in_order(&mut meeting);
    meeting
}

/// Faces that meet by ascending ids, each pair once: patches searched twice tell twice.
fn in_order(meeting: &mut Vec<FacePair>) {
    meeting.sort_unstable();
    meeting.dedup();
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
