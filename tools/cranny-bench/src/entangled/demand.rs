//! The demands that are measured.

use clap::ValueEnum;
use cranny_narrow_phase::Demand;

use super::stage::Motion;

/// A demand without its margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DemandKind {
    /// Do the bodies meet
    Verdict,
    /// The least distance
    Distance,
    /// Contacts for a solver
    Contacts,
    /// Regions of contact
    Regions,
}

impl DemandKind {
    pub(super) const ALL: [Self; 4] =
        [Self::Verdict, Self::Distance, Self::Contacts, Self::Regions];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Verdict => "verdict",
            Self::Distance => "distance",
            Self::Contacts => "contacts",
            Self::Regions => "regions",
        }
    }

    /// Returns the demand with the margins of a motion.
    pub(super) fn of(self, motion: &Motion) -> Demand {
        match self {
            Self::Verdict => Demand::Intersects,
            Self::Distance => Demand::Distance { below: None },
            Self::Contacts => Demand::contacts(motion.contact_margin),
            Self::Regions => Demand::Regions { margin: motion.region_margin },
        }
    }
}
