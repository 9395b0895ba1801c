//! Concavities whose faces have moved, and nothing else about them has changed.
//!
//! No source: the sums are those of building, in the same order, over the concavities named. Cost:
//! with the function.

use super::input::{Input, twice_area_vector};
use super::{ConcavitySet, Measures};
use crate::features::Features;
use crate::ids::ConcavityId;
use cranny_geometry::Model;

impl ConcavitySet {
    /// Measures concavities again after faces off the hull have moved, none on it, and no corner of
    /// a cap; where anything has no lid, finds anew what lies in what.
    ///
    /// Cost: the faces and caps of these concavities; with voids or islands, those of all.
    pub(crate) fn remeasure(
        &mut self,
        model: &Model,
        features: &Features,
        changed: &[ConcavityId],
    ) {
        let input = Input::of(model, features);
        for &id in changed {
            let measures = self.measured(&input, id);
            self.records[id.index()].measures = measures;
        }
        input.name(self);
        input.nest(self);
    }

    /// What the sums over a concavity come to, added up in the order in which they were built.
    fn measured(&self, input: &Input<'_>, id: ConcavityId) -> Measures {
        let concavity = self.get(id);
        let mut measures = input.measures_of(concavity.faces);
        let mut caps = concavity.caps.to_vec();
        caps.sort_unstable();
        for cap in caps {
            let corners = input.cap_triangle(&self.caps, cap.index());
            let opening = 0.5 * twice_area_vector(corners);
            let is_negative = self.caps.negative.binary_search(&cap).is_ok();
            let sign = if is_negative { -1.0 } else { 1.0 };
            measures.cap_area += sign * opening.length();
            measures.pocket_volume += input.volume_below(corners);
            measures.opening += opening;
        }
        measures
    }
}
