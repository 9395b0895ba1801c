//! A query: what of a pair is computed.

use cranny_exact::Pose;
use cranny_geometry::{Model, check_crease_angle};

use crate::evaluate::QueryError;

use crate::approach::Approach;

/// A model at a pose.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// What.
    pub model: &'a Model,
    /// Where: world_from_body. Read as [`Pose::accepted`] returns it.
    pub pose: Pose,
}

/// How much is computed. Each demand does only its own work.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Demand {
    /// Nothing.
    #[default]
    None,
    /// Do they meet: surface verdict, solidity and containment.
    Intersects,
    /// The above, and the least distance between the surfaces, with witness points unless they
    /// cross.
    Distance {
        /// If given, distances of this much or more need not be found (the answer then says
        /// 'at least this').
        below: Option<f64>,
    },
    /// The verdict of `Intersects`, and contacts for a solver: for each pair of patches that come
    /// within the margin the nearest points, with the normal of their own place, or as many as span
    /// a patch that is large. Where solids overlap, the ways out of the vertices inside and the
    /// depths of edges that cross, and where walls have dug into each other, far deeper than these
    /// say, contacts along their region's normal; where a body has fewer than 64 faces, the
    /// contacts of regions. No distance is measured, and regions are reported only where solids
    /// overlap in a way that no vertex or edge can say.
    Contacts {
        /// Surfaces up to this far apart yield contacts, >= 0.
        margin: f64,
        /// Whose normals the contacts have. Which contacts there are, their points and separations
        /// do not depend on it, nor do regions.
        normals: Normals,
    },
    /// Everything: the distance as well.
    Regions {
        /// Surfaces up to this far apart yield regions of positive separation, >= 0.
        margin: f64,
    },
}

/// Whose normals the contacts for a solver have.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Normals {
    /// Those of the meshes: of a face, of two edges, of the way across a gap.
    #[default]
    Flat,
    /// Those of the curved surfaces that the meshes stand for, see
    /// [`smooth_normal`](crate::smooth_normal). A separation is still the meshes', and measured
    /// along their own normal.
    Smooth {
        /// Edges between normals that differ by less are smooth: radians, 0 to π.
        crease_angle: f64,
    },
}

impl Normals {
    /// Of two wishes about the same contacts. The mesh's own come first: what is smooth is no
    /// longer known exactly. Of two creases, the one that leaves more of it.
    fn join(self, other: Self) -> Self {
        match (self, other) {
            (Self::Smooth { crease_angle: a }, Self::Smooth { crease_angle: b }) => {
                Self::Smooth { crease_angle: a.min(b) }
            }
            _ => Self::Flat,
        }
    }
}

impl Demand {
    /// Checks the numbers of the demand.
    ///
    /// # Errors
    ///
    /// [`QueryError::Length`] and [`QueryError::Crease`], as [`query`](crate::query()).
    pub fn check(&self) -> Result<(), QueryError> {
        if let Self::Contacts { normals: Normals::Smooth { crease_angle }, .. } = *self {
            check_crease_angle(crease_angle)?;
        }
        let (what, value) = match *self {
            Self::Distance { below: Some(value) } => ("below", value),
            Self::Contacts { margin, .. } | Self::Regions { margin } => ("margin", margin),
            _ => return Ok(()),
        };
        check_length(what, value)
    }

    /// Contacts with the normals of the meshes.
    #[must_use]
    pub const fn contacts(margin: f64) -> Self {
        Self::Contacts { margin, normals: Normals::Flat }
    }

    /// The least demand that answers both: the union of their work, at the larger margin. Of
    /// contacts that are wanted with different normals, those of the meshes.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        use Demand::{Contacts, Distance, Intersects, None, Regions};
        match (self, other) {
            (None, x) | (x, None) => x,
            (Intersects, x) | (x, Intersects) => x,
            (Distance { below: a }, Distance { below: b }) => {
                Distance { below: a.zip(b).map(|(a, b)| a.max(b)) }
            }
            (Distance { .. }, Contacts { margin, .. })
            | (Contacts { margin, .. }, Distance { .. }) => Regions { margin },
            (Distance { .. }, x) | (x, Distance { .. }) => x,
            (Contacts { margin: a, normals: m }, Contacts { margin: b, normals: n }) => {
                Contacts { margin: a.max(b), normals: m.join(n) }
            }
            (
                Regions { margin: a } | Contacts { margin: a, .. },
                Regions { margin: b } | Contacts { margin: b, .. },
            ) => Regions { margin: a.max(b) },
        }
    }

    /// Whether an answer to this demand holds all that the other demands. A larger margin covers a
    /// smaller one: what lies beyond is the reader's to leave out.
    #[must_use]
    pub fn covers(self, other: Self) -> bool {
        use Demand::{Contacts, Distance, Intersects, None, Regions};
        match (self, other) {
            (_, None) => true,
            (None, _) => false,
            (_, Intersects) | (Regions { .. }, Distance { .. }) => true,
            (Distance { below: have }, Distance { below: want }) => {
                have.is_none_or(|have| want.is_some_and(|want| have >= want))
            }
            (Contacts { margin: have, normals: m }, Contacts { margin: want, normals: n }) => {
                have >= want && m == n
            }
            (Regions { margin: have }, Regions { margin: want }) => have >= want,
            _ => false,
        }
    }

    /// The margin up to which contacts are demanded, if they are.
    #[must_use]
    pub fn margin(&self) -> Option<f64> {
        match *self {
            Self::Contacts { margin, .. } | Self::Regions { margin } => Some(margin),
            _ => None,
        }
    }
}

/// By which of two complete ways the faces that meet are found. The answer is the same; so is all
/// that does not need these faces: distances, and contacts for a solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// The search of the models' clusters, whose cut is kept from query to query.
    #[default]
    Boxes,
    /// The parts of the hulls that meet; concavities that the other hull may reach, by the layers
    /// of their envelopes. Slower on nearly all that was measured (`docs/notebook`), so off by
    /// default.
    Envelopes,
}

/// A question about a pair of placed models.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Query {
    /// How much is computed.
    pub demand: Demand,
    /// How faces that meet are found.
    pub method: Method,
    /// How bodies may move: of [`Demand::Contacts`], those beyond the margin as well that this
    /// closes. No other demand reads it.
    pub approach: Option<Approach>,
    /// Of [`Demand::Contacts`]: how deep a contact is from which on the
    /// [penetrations](crate::Answer::penetrations) are measured as well. No other demand reads it.
    pub penetrations_from: Option<f64>,
}

impl Query {
    /// Whether it can be answered.
    ///
    /// # Errors
    ///
    /// As [`query`](crate::query()), but for poses.
    pub(crate) fn check(&self) -> Result<(), QueryError> {
        self.demand.check()?;
        self.approach.as_ref().map_or(Ok(()), Approach::check)?;
        self.penetrations_from.map_or(Ok(()), |depth| check_length("penetrations_from", depth))
    }

    /// A query for this much.
    #[must_use]
    pub fn of(demand: Demand) -> Self {
        Self { demand, ..Self::default() }
    }

    /// The same, and contacts that bodies may come to beyond the margin.
    #[must_use]
    pub fn approaching(self, approach: Approach) -> Self {
        Self { approach: Some(approach), ..self }
    }

    /// The same, and how deep regions are along their normals where a contact is so deep (>= 0).
    #[must_use]
    pub fn penetrations_from(self, depth: f64) -> Self {
        Self { penetrations_from: Some(depth), ..self }
    }

    /// The same, by a method.
    #[must_use]
    pub fn by(self, method: Method) -> Self {
        Self { method, ..self }
    }
}

fn check_length(what: &'static str, value: f64) -> Result<(), QueryError> {
    match value >= 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(QueryError::Length { what, value }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_covers_what_it_tells() {
        let (contacts, regions) = (Demand::contacts(0.1), Demand::Regions { margin: 0.1 });
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
    fn smooth_contacts_are_others() {
        let smooth = |margin, crease_angle| Demand::Contacts {
            margin,
            normals: Normals::Smooth { crease_angle },
        };
        let flat = Demand::contacts(0.1);
        assert!(!flat.covers(smooth(0.1, 0.5)) && !smooth(0.1, 0.5).covers(flat));
        assert!(smooth(0.1, 0.5).covers(smooth(0.05, 0.5)));
        assert!(!smooth(0.1, 0.5).covers(smooth(0.1, 0.4)));
        assert_eq!(smooth(0.2, 0.5).join(flat), Demand::contacts(0.2));
        assert_eq!(smooth(0.1, 0.5).join(smooth(0.2, 0.4)), smooth(0.2, 0.4));
        assert_eq!(smooth(0.1, 0.5).join(Demand::Distance { below: None }).margin(), Some(0.1));
    }

    #[test]
    fn joining_takes_the_larger_demand_and_margin() {
        let contacts = Demand::contacts(0.1);
        assert_eq!(Demand::None.join(Demand::Intersects), Demand::Intersects);
        assert_eq!(
            contacts.join(Demand::Distance { below: None }),
            Demand::Regions { margin: 0.1 }
        );
        assert_eq!(
            contacts.join(Demand::Regions { margin: 0.05 }),
            Demand::Regions { margin: 0.1 }
        );
        assert_eq!(contacts.join(Demand::contacts(0.2)).margin(), Some(0.2));
        assert_eq!(
            Demand::Distance { below: Some(1.0) }.join(Demand::Distance { below: None }),
            Demand::Distance { below: None }
        );
    }
}
