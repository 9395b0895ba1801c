//! How deep solids overlap, region by region, for whoever needs no contacts and no curves.

use cranny_exact::DVec3;

use crate::answer::{Contact, Counters, Region};
use crate::intersection::{Intersection, intersect};
use crate::overlap::Overlap;
use crate::pair::{Pair, PosedVertices};
use crate::pieces::{RegionPieces, cut};
use crate::special_position::{in_general_position, settled};
use crate::surface::FacePair;

/// How two bodies overlap in one region: the least that is needed to lead them out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Unit direction from A to B, world: that of the deepest contact. It is [`Region::normal`]
    /// but where a nearest way out is deepest.
    pub normal: DVec3,
    /// The deepest contact, world; its separation is below 0, or 0 on the curve.
    pub deepest: Contact,
}

impl Penetration {
    /// That of a region which has a depth: of one where closed solids overlap.
    #[must_use]
    pub fn of(region: &Region) -> Option<Self> {
        region.depth.map(|_| Self { normal: region.deepest.normal, deepest: region.deepest })
    }

    /// The least translation along the normal that parts the region, >= 0.
    #[must_use]
    pub fn depth(&self) -> f64 {
        -self.deepest.separation
    }
}

/// The overlaps of two closed solids, a region each. In world coordinates and the caller's order.
pub(crate) fn overlaps(
    pair: &Pair,
    posed: &mut PosedVertices,
    pairs: &[FacePair],
    counters: &mut Counters,
) -> Vec<Penetration> {
    let of_regions = |pair: &Pair, intersection: &Intersection| {
        let pieces = cut(pair, intersection);
        let deepest = |pieces: &RegionPieces| Overlap::of(pair, intersection, pieces).contacts[0];
        pieces.iter().map(deepest).collect()
    };
    let here = intersect(pair, pairs);
    let depth = |deepest: &Contact| -deepest.separation;
    let (found, _) = in_general_position(pair, posed, &here, counters, of_regions, depth);
    let finish = |deepest| {
        let deepest = if here.generic { deepest } else { settled(pair, deepest) };
        let deepest = pair.world_contact(deepest);
        Penetration { normal: deepest.normal, deepest }
    };
    found.into_iter().map(finish).collect()
}
