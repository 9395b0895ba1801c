//! The direction along which a region of overlap parts, and how deep it is along it.

use cranny_exact::{DVec3, RigidMap};

use crate::answer::{Contact, Region};
use crate::depth::MeasuredRegion;
use crate::intersection::{Intersection, intersect};
use crate::pair::Pair;
use crate::pieces::cut;
use crate::special_position::{in_general_position, settled};
use crate::surface::FacePair;
use crate::tally::Tally;
use crate::way_out::{Others, way_out};

/// How two bodies overlap in one region: the least that is needed to lead them out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Unit direction from A to B, world. As [`Region::normal`].
    pub normal: DVec3,
    /// The deepest contact along it, world; its separation is below 0, or 0 on the curve.
    pub deepest: Contact,
}

impl Penetration {
    /// That of a region which has a depth: of one where closed solids overlap.
    #[must_use]
    pub fn of(region: &Region) -> Option<Self> {
        region.depth.map(|_| Self { normal: region.normal, deepest: region.deepest })
    }

    /// The same with the bodies' names exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self { normal: -self.normal, deepest: self.deepest.swapped() }
    }

    /// The same in another frame.
    #[must_use]
    pub fn moved(self, map: &RigidMap) -> Self {
        Self { normal: map.apply_vector(self.normal), deepest: self.deepest.moved(map) }
    }

    /// The least translation along the normal that parts the region, >= 0; where no short one does,
    /// how deep its deepest place lies, as [`Region::depth`].
    #[must_use]
    pub fn depth(&self) -> f64 {
        -self.deepest.separation
    }
}

/// The overlaps of two closed solids, a region each. In world coordinates and the caller's order.
pub(crate) fn overlaps(
    pair: &Pair,
    pairs: &[FacePair],
    counters: &mut impl Tally,
) -> Vec<Penetration> {
    let of_regions = |pair: &Pair, intersection: &Intersection| {
        let pieces = cut(pair, intersection);
        let of_region = |pieces| {
            let region = MeasuredRegion::of(pair, intersection, pieces);
            way_out(&region, Others::None).0
        };
        pieces.iter().map(of_region).collect()
    };
    let here = intersect(pair, pairs);
    let depth = |deepest: &Contact| -deepest.separation;
    let (found, _) = in_general_position(pair, &here, counters, of_regions, depth);
    let finish = |deepest: Contact| {
        let normal = pair.world_normal(deepest.normal);
        let deepest = if here.generic { deepest } else { settled(pair, deepest) };
        Penetration { normal, deepest: pair.world_contact(deepest) }
    };
    found.into_iter().map(finish).collect()
}
