//! What is asked about a pair.

use cranny_exact::Pose;
use cranny_geometry::Model;

/// A model at a pose.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// What.
    pub model: &'a Model,
    /// Where: world_from_body. Read as [`Pose::accepted`] returns it.
    pub pose: Pose,
}

/// How much is asked. Each demand does only its own work.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Demand {
    /// Nothing.
    #[default]
    None,
    /// Do they meet: surface verdict, solidity and containment.
    Intersects,
    /// The above, and the least distance between the surfaces with witness points.
    Distance {
        /// If given, distances of this much or more need not be found (the answer then says
        /// 'at least this').
        below: Option<f64>,
    },
    /// The verdict of `Intersects`, and contacts for a solver: for each pair of patches that come
    /// within the margin the nearest points, with the normal of their own place, or as many as span
    /// a patch that is large. No distance is measured, and regions are told only where solids
    /// overlap in a way that no vertex or edge can say.
    Contacts {
        /// Surfaces up to this far apart yield contacts, >= 0.
        margin: f64,
    },
    /// Everything: the distance as well.
    Regions {
        /// Surfaces up to this far apart yield regions of positive separation, >= 0.
        margin: f64,
    },
}

impl Demand {
    /// The least demand that answers both: the union of their work, at the larger margin.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        use Demand::{Contacts, Distance, Intersects, None, Regions};
        match (self, other) {
            (None, x) | (x, None) => x,
            (Intersects, x) | (x, Intersects) => x,
            (Distance { below: a }, Distance { below: b }) => {
                Distance { below: a.zip(b).map(|(a, b)| a.max(b)) }
            }
            (Distance { .. }, Contacts { margin }) | (Contacts { margin }, Distance { .. }) => {
                Regions { margin }
            }
            (Distance { .. }, x) | (x, Distance { .. }) => x,
            (Contacts { margin: a }, Contacts { margin: b }) => Contacts { margin: a.max(b) },
            (
                Regions { margin: a } | Contacts { margin: a },
                Regions { margin: b } | Contacts { margin: b },
            ) => Regions { margin: a.max(b) },
        }
    }

    /// Whether an answer to this demand tells all that the other asks. A larger margin covers a smaller
    /// one: what lies beyond is the reader's to leave out.
    #[must_use]
    pub fn covers(self, other: Self) -> bool {
        use Demand::{Contacts, Distance, Intersects, None, Regions};
        match (self, other) {
            (_, None) => true,
            (None, _) => false,
            (_, Intersects) | (Regions { .. }, Distance { .. }) => true,
            (Distance { below: have }, Distance { below: want }) => match (have, want) {
                (Option::None, _) => true,
                (Some(have), Some(want)) => have >= want,
                (Some(_), Option::None) => false,
            },
            (Contacts { margin: have }, Contacts { margin: want })
            | (Regions { margin: have }, Regions { margin: want }) => have >= want,
            _ => false,
        }
    }

    /// The margin up to which contacts are asked for, if they are.
    #[must_use]
    pub fn margin(&self) -> Option<f64> {
        match *self {
            Self::Contacts { margin } | Self::Regions { margin } => Some(margin),
            _ => None,
        }
    }
}

/// By which of two complete ways the faces that meet are found. The answer is the same; so is all that does not
/// need these faces: distances, and contacts for a solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// Trees of boxes over all faces, whose front is kept from query to query.
    #[default]
    Boxes,
    /// The parts of the hulls that meet; concavities that the other hull may reach, by the layers of their envelopes.
    /// Slower on nearly all that was measured (README), so never chosen unless asked for.
    Envelopes,
}

/// A question about a pair of placed models.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Query {
    /// How much is asked.
    pub demand: Demand,
    /// How faces that meet are found.
    pub method: Method,
}

impl Query {
    /// A query for this much.
    #[must_use]
    pub fn of(demand: Demand) -> Self {
        Self { demand, method: Method::default() }
    }

    /// The same, by a method.
    #[must_use]
    pub fn by(self, method: Method) -> Self {
        Self { method, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_covers_what_it_tells() {
        let (contacts, regions) =
            (Demand::Contacts { margin: 0.1 }, Demand::Regions { margin: 0.1 });
        let (whole, near) =
            (Demand::Distance { below: None }, Demand::Distance { below: Some(1.0) });
        for demand in [Demand::None, Demand::Intersects, whole, near, contacts, regions] {
            assert!(demand.covers(demand) && demand.covers(Demand::None));
            assert_eq!(Demand::None.covers(demand), demand == Demand::None);
            assert!(demand == Demand::None || demand.covers(Demand::Intersects));
        }
        assert!(regions.covers(whole) && whole.covers(near) && !near.covers(whole));
        // Regions are not drawn from patches, nor patches from regions.
        assert!(!regions.covers(contacts) && !contacts.covers(regions) && !contacts.covers(near));
        assert!(regions.covers(Demand::Regions { margin: 0.05 }));
        assert!(!regions.covers(Demand::Regions { margin: 0.2 }));
    }

    #[test]
    fn joining_takes_the_larger_demand_and_margin() {
        let contacts = Demand::Contacts { margin: 0.1 };
        assert_eq!(Demand::None.join(Demand::Intersects), Demand::Intersects);
        assert_eq!(
            contacts.join(Demand::Distance { below: None }),
            Demand::Regions { margin: 0.1 }
        );
        assert_eq!(
            contacts.join(Demand::Regions { margin: 0.05 }),
            Demand::Regions { margin: 0.1 }
        );
        assert_eq!(contacts.join(Demand::Contacts { margin: 0.2 }).margin(), Some(0.2));
        assert_eq!(
            Demand::Distance { below: Some(1.0) }.join(Demand::Distance { below: None }),
            Demand::Distance { below: None }
        );
    }
}
