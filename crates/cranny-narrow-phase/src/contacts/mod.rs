//! Contacts for a solver: for each pair of patches that come near, their nearest points.
//!
//! A nut's contacts on its bolt are found here ([`near_patches`]; the search begins in `list`).
//!
//! A solver needs few contacts, each with the normal of its own point, spread over what touches,
//! and the same ones in the next step. So a pair of patches (`cranny_geometry::Patches`, pieces of
//! nearly one normal) yields the contact of least separation. A patch too large to be a place
//! yields as many as span it (`coarse`). Features make contacts only along directions that they
//! face in the full mesh (`facing`), and their normals are exact there (`feature_pair`). Where the
//! solids overlap, depths take the place of gaps (`overlap`, of the vertices `within`), and where
//! these do not say how deep, `walls` have the contacts of their region.
//!
//! The search hands over candidates, pairs of features with a lower bound of their distance; they
//! are listed by pairs of patches, and those that can still win their pair are evaluated, the last
//! query's winner first (`list`). While bodies move little, the list lasts.
//!
//! The answer is a function of models, poses and margin: memory holds what cannot be left out, and
//! where to begin.

mod coarse;
pub(crate) mod facing;
mod feature_pair;
mod list;
mod overlap;
#[cfg(test)]
mod tests;
mod walls;
mod wanted;
mod within;

use cranny_exact::Meeting;
use cranny_geometry::{Model, PatchId};

use self::coarse::Coarse;
use self::feature_pair::patch_index;
pub(crate) use self::list::ContactMemory;
use self::overlap::Overlaps;
use self::walls::contacts_of_walls;
pub(crate) use self::wanted::Wanted;
use crate::answer::{Contact, Feature, Surface};
use crate::coherent::Coherent;
use crate::pair::{Pair, Side};
use crate::reduce::reduce;
use crate::search::Meets;
use crate::surface::FacePair;
use crate::tally::Tally;

/// If one of two bodies has fewer faces, the contacts of an overlap come from its regions. Larger:
/// curves are traced although vertices and edges give the contacts; smaller: coarse bodies lose
/// contacts that regions alone show. A hook of 20 faces then keeps those at its tip, tips over and
/// slips off (`a_hook_holds_at_an_edge`).
const SMALL: usize = 64;

/// True if [`Demand::Contacts`](crate::Demand) takes the contacts of an overlap of two models from
/// its regions: both are closed, and at least one has fewer than 64 faces. (Regions of open
/// surfaces have no depth.)
#[must_use]
pub fn overlaps_by_regions(models: [&Model; 2]) -> bool {
    models.iter().all(|model| model.is_closed())
        && models.iter().any(|model| model.mesh().faces().len() < SMALL)
}

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
    /// Whether contacts of the overlap are left to regions ([`overlaps_by_regions`]).
    pub(crate) left_to_regions: bool,
}

/// Finds every pair of faces that meet, and the contacts of all pairs of patches that are wanted.
///
/// Cost: near-linear in the features that lie within the margin; where
/// solids overlap, a search of one nearest point for each vertex inside.
pub(crate) fn near_patches(
    pair: &Pair,
    wanted: &Wanted,
    (coherent, memory): (&mut Coherent, &mut ContactMemory),
    counters: &mut impl Tally,
) -> Near {
    let coarse = Coarse::of(pair);
    let (surface, meeting) = memory.search(pair, wanted, Meets::All, coherent, counters);
    let crosses = surface == Meeting::Cross;
    let left_to_regions = crosses && overlaps_by_regions(pair.models());
    let mut deep = match crosses && !left_to_regions {
        true => Overlaps::of(pair, coarse, &meeting, counters),
        false => Overlaps::none(pair, coarse),
    };
    let mut contacts = Vec::new();
    memory.each_group(pair, wanted, counters, |group| {
        let mut of_group = deep.take(group.patches());
        if coarse.holds(pair, group.patches()) {
            group.all(&mut of_group);
            contacts.extend(reduce(of_group));
        } else if of_group.is_empty() {
            contacts.extend(group.nearest());
        } else {
            contacts.extend(of_group);
        }
    });
    memory.end();
    let inside = std::mem::take(&mut deep.inside);
    for (patches, group) in deep.rest() {
        let spans = coarse.holds(pair, patches);
        contacts.extend(if spans { reduce(group) } else { group });
    }
    if crosses && !left_to_regions {
        let overlapping: Vec<Contact> =
            contacts.iter().copied().filter(|contact| contact.separation < 0.0).collect();
        // Where penetrations are wanted, they say how deep regions are.
        if !overlapping.iter().any(|contact| wanted.is_deep(contact)) {
            contacts.extend(contacts_of_walls(pair, &meeting, &overlapping, &inside));
        }
    }
    contacts.sort_by(nearer);
    Near { surface, meeting, contacts, left_to_regions }
}

/// All contacts of two surfaces across a gap of at most `margin`, in the pair's frame; in no order.
/// Where surfaces touch, gaps may be negative by rounding.
///
/// Cost: near-linear in the features within the margin; unlike [`near_patches`], it looks for no
/// vertices inside.
pub(crate) fn across_gaps(
    pair: &Pair,
    margin: f64,
    (coherent, memory): (&mut Coherent, &mut ContactMemory),
    counters: &mut impl Tally,
) -> Vec<Contact> {
    let mut all = Vec::new();
    let wanted = Wanted::within(margin);
    memory.search(pair, &wanted, Meets::None, coherent, counters);
    memory.each_group(pair, &wanted, counters, |group| group.all(&mut all));
    memory.end();
    all
}

fn patches_of(pair: &Pair, id: (Feature, Feature)) -> [PatchId; 2] {
    let of = |side, feature| PatchId(patch_index(pair.model(side), feature));
    [of(Side::First, id.0), of(Side::Second, id.1)]
}

impl Contact {
    /// The patches whose contact this is: what stays the same from step to step while the features
    /// change that lie nearest. `a` and `b` are the models that were queried.
    #[must_use]
    pub fn patches(&self, a: &Model, b: &Model) -> (PatchId, PatchId) {
        let of = |model: &Model, feature| PatchId(patch_index(model, feature));
        (of(a, self.id.0), of(b, self.id.1))
    }
}
