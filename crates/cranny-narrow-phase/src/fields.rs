//! Which fields of an answer somebody reads, and the least demand that computes them.

use crate::query::Demand;

/// The fields of an [`Answer`](crate::Answer) that somebody reads.
///
/// What several readers read is their [`join`](Self::join). A reader does not care which question
/// brought the answer: [`held_by`](Self::held_by) says whether an answer that is there already will
/// do, as a solver's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fields {
    /// How the surfaces meet, whether the solids do, containment.
    pub verdict: bool,
    /// Distance of what is nearer than this, > 0, with witness points where surfaces do not cross;
    /// infinite for any distance.
    pub distance: Option<f64>,
    /// How deep the bodies overlap, where that is deeper than this, >= 0:
    /// [`Answer::depth`](crate::Answer::depth).
    pub depth: Option<f64>,
    /// Contacts up to this far apart, >= 0: those for a solver, or the points of regions where
    /// regions are read too.
    pub contacts: Option<f64>,
    /// Regions up to this far apart, >= 0: curves, depth, area, names.
    pub regions: Option<f64>,
}

impl Fields {
    /// Nobody reads anything.
    pub const NONE: Self =
        Self { verdict: false, distance: None, depth: None, contacts: None, regions: None };

    /// Contacts up to this far apart.
    #[must_use]
    pub const fn contacts(margin: f64) -> Self {
        Self { contacts: Some(margin), ..Self::NONE }
    }

    /// Regions up to this far apart.
    #[must_use]
    pub const fn regions(margin: f64) -> Self {
        Self { regions: Some(margin), ..Self::NONE }
    }

    /// What either reader reads, at the larger margin.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let either = |a: Option<f64>, b: Option<f64>, of_both: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(of_both(a, b)),
            (a, b) => a.or(b),
        };
        let farther = |a, b| either(a, b, f64::max);
        Self {
            verdict: self.verdict || other.verdict,
            distance: farther(self.distance, other.distance),
            depth: either(self.depth, other.depth, f64::min),
            contacts: farther(self.contacts, other.contacts),
            regions: farther(self.regions, other.regions),
        }
    }

    /// What is left to compute where the overlap is known to be this deep at most (below 0: where
    /// there is a gap): no depth, if only deeper ones are read.
    #[must_use]
    pub fn knowing_depth(self, at_most: f64) -> Self {
        Self {
            depth: self.depth.filter(|&deeper_than| at_most.is_nan() || at_most > deeper_than),
            ..self
        }
    }

    /// The least demand whose answer holds these fields.
    #[must_use]
    pub fn demand(&self) -> Demand {
        let of_flags =
            [(self.verdict, Demand::Intersects), (self.depth.is_some(), Demand::contacts(0.0))];
        let of_flags = of_flags.into_iter().filter(|(read, _)| *read).map(|(_, demand)| demand);
        let distance = self.distance.map(nearer_than);
        let contacts = self.contacts.map(Demand::contacts);
        let regions = self.regions.map(|margin| Demand::Regions { margin });
        of_flags.chain(distance).chain(contacts).chain(regions).fold(Demand::None, Demand::join)
    }

    /// Whether an answer to this demand holds these fields. What lies beyond a margin is the
    /// reader's to leave out.
    #[must_use]
    pub fn held_by(&self, demand: Demand) -> bool {
        let regions = match demand {
            Demand::Regions { margin } => Some(margin),
            _ => None,
        };
        let reaches = |have: Option<f64>, want: Option<f64>| {
            want.is_none_or(|want| have.is_some_and(|have| have >= want))
        };
        (!self.verdict || demand.covers(Demand::Intersects))
            && self.distance.is_none_or(|within| demand.covers(nearer_than(within)))
            && (self.depth.is_none() || demand.margin().is_some())
            && reaches(demand.margin(), self.contacts)
            && reaches(regions, self.regions)
    }
}

fn nearer_than(within: f64) -> Demand {
    Demand::Distance { below: within.is_finite().then_some(within) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISTANCE: Fields = Fields { distance: Some(f64::INFINITY), ..Fields::NONE };
    const NEAR: Fields = Fields { distance: Some(0.5), ..Fields::NONE };
    const DEPTH: Fields = Fields { depth: Some(0.0), ..Fields::NONE };
    const VERDICT: Fields = Fields { verdict: true, ..Fields::NONE };

    #[test]
    fn the_least_demand_tells_what_is_read_and_no_more() {
        let regions = |margin| Demand::Regions { margin };
        for (fields, demand) in [
            (Fields::NONE, Demand::None),
            (VERDICT, Demand::Intersects),
            (DISTANCE.join(VERDICT), Demand::Distance { below: None }),
            (NEAR.join(VERDICT), Demand::Distance { below: Some(0.5) }),
            (NEAR.join(DISTANCE), Demand::Distance { below: None }),
            (DEPTH.join(VERDICT), Demand::contacts(0.0)),
            (DEPTH.join(Fields::contacts(0.1)), Demand::contacts(0.1)),
            (DEPTH.join(Fields::regions(0.1)), regions(0.1)),
            (Fields::contacts(0.2).join(Fields::regions(0.1)), regions(0.2)),
            (Fields::contacts(0.1).join(DISTANCE), regions(0.1)),
        ] {
            assert_eq!(fields.demand(), demand, "{fields:?}");
            assert!(fields.held_by(demand));
        }
        assert_eq!(Fields::contacts(0.1).join(Fields::contacts(0.2)), Fields::contacts(0.2));
    }

    #[test]
    fn a_depth_is_left_out_where_it_is_known_to_be_no_deeper() {
        let deeper = Fields { depth: Some(0.5), verdict: true, ..Fields::NONE };
        assert_eq!(deeper.knowing_depth(0.5), VERDICT);
        assert_eq!(deeper.knowing_depth(-1.0), VERDICT);
        assert_eq!(deeper.knowing_depth(0.6), deeper);
        assert_eq!(DEPTH.knowing_depth(0.0), Fields::NONE);
        assert_eq!(deeper.join(DEPTH).depth, Some(0.0), "the lesser depth is read too");
    }

    #[test]
    fn a_solvers_contacts_tell_depth_and_contacts_as_far_as_they_reach() {
        let of_solver = Demand::contacts(0.1);
        let near = Fields::contacts(0.1).join(DEPTH).join(VERDICT);
        assert!(near.held_by(of_solver) && Fields::NONE.held_by(of_solver));
        assert!(near.held_by(Demand::Regions { margin: 0.1 }));
        for beyond in [Fields::contacts(0.11), Fields::regions(0.0), DISTANCE] {
            assert!(!beyond.held_by(of_solver), "{beyond:?}");
        }
        assert!(!DEPTH.held_by(Demand::Intersects) && !VERDICT.held_by(Demand::None));
    }
}
