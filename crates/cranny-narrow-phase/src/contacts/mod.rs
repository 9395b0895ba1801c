//! Contacts for a solver: for each pair of patches that come near, their nearest points.
//!
//! A nut's contacts on its bolt are found here ([`near_patches`]; the search begins in `list`).
//!
//! A solver needs few contacts, each with the normal of its own point, spread over what touches,
//! and the same ones in the next step. So a pair of patches (`cranny_geometry::Patches`, pieces of
//! nearly one normal) yields the contact of least separation. A patch too large to be a place
//! yields as many as span it (`coarse`). Features make contacts only along directions that they
//! face in the full mesh (`facing`), and their normals are exact there (`feature_pair`). Where
//! closed solids overlap, their regions say how deep (`regions`); where an open surface pierces a
//! solid, its vertices inside do (`pierced`, of the vertices `within`).
//!
//! The search hands over candidates, pairs of features with a lower bound of their distance; they
//! are listed by pairs of patches, and evaluated by ascending bounds until no other can win
//! (`list`). While bodies move little, the list lasts.
//!
//! The answer is a function of models, poses and margin: memory holds what cannot be left out, and
//! where to begin.

#[cfg(test)]
mod approaching;
mod coarse;
#[cfg(test)]
mod every_pair;
pub(crate) mod facing;
mod feature_pair;
mod list;
mod pierced;
mod wanted;
mod within;
#[cfg(test)]
mod wrenches;

use cranny_exact::Meeting;
use cranny_geometry::{Model, PatchId};

use self::coarse::Coarse;
use self::feature_pair::patch_index;
pub(crate) use self::list::ContactMemory;
use self::pierced::PiercedSolid;
pub(crate) use self::wanted::Wanted;
use crate::answer::{Contact, Counters, Feature, Surface};
use crate::coherent::Coherent;
use crate::pair::{Pair, Side};
use crate::reduce::reduce;
use crate::surface::FacePair;

/// Order of contacts: the nearest first, ties by lowest features.
pub(crate) fn nearer(x: &Contact, y: &Contact) -> std::cmp::Ordering {
    x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id))
}

/// What was found between two surfaces.
pub(crate) struct Near {
    pub(crate) surface: Surface,
    /// All pairs of faces that meet, by ascending ids.
    pub(crate) meeting: Vec<FacePair>,
    /// In the pair's frame; nearest first.
    pub(crate) contacts: Vec<Contact>,
}

/// Finds every pair of faces that meet, and the contacts across gaps of all pairs of patches that
/// are wanted; where an open surface pierces a solid, those of its vertices inside as well.
///
/// Cost: near-linear in the features that lie within the margin, and in the vertices of an open
/// surface inside.
pub(crate) fn near_patches(
    pair: &Pair,
    wanted: &Wanted,
    (coherent, memory): (&mut Coherent, &mut ContactMemory),
    counters: &mut Counters,
) -> Near {
    let coarse = Coarse::of(pair);
    let (surface, meeting) = memory.search(pair, wanted, coherent, counters);
    let mut contacts = Vec::new();
    let crossing = if surface == Meeting::Cross { &meeting[..] } else { &[] };
    let mut inside = PiercedSolid::of(pair, coarse, crossing, counters);
    memory.each_group(pair, wanted, counters, |group| {
        let mut of_group = inside.take(group.patches());
        if coarse.holds(pair, group.patches()) {
            group.all(&mut of_group);
            contacts.extend(if of_group.len() > 1 { reduce(of_group) } else { of_group });
        } else if of_group.is_empty() {
            contacts.extend(group.nearest());
        } else {
            contacts.extend(of_group);
        }
    });
    for (patches, group) in inside.rest() {
        contacts.extend(if coarse.holds(pair, patches) { reduce(group) } else { group });
    }
    contacts.sort_by(nearer);
    Near { surface, meeting, contacts }
}

/// All contacts of two surfaces across a gap of at most `margin`, in the pair's frame; in no order.
/// Where surfaces touch, gaps may be negative by rounding.
///
/// Cost: as of [`near_patches`], but near-linear in the features within the margin.
pub(crate) fn across_gaps(
    pair: &Pair,
    margin: f64,
    (coherent, memory): (&mut Coherent, &mut ContactMemory),
    counters: &mut Counters,
) -> Vec<Contact> {
    let mut all = Vec::new();
    let wanted = Wanted::within(margin);
    memory.list(pair, &wanted, coherent, counters);
    memory.each_group(pair, &wanted, counters, |group| group.all(&mut all));
    all
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
