//! Polyhedra with rounded edges: a model and all that lies within a radius of it.

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Contact, Demand, PairMemory, Placed, Query, QueryError, query};

use crate::separation::Separation;

/// All that lies within a radius of a model.
#[derive(Clone, Debug)]
pub struct Rounded {
    /// What is rounded.
    pub model: Model,
    /// By how much, >= 0; 0 for the model itself.
    pub radius: f64,
}

/// How far two rounded models are apart, if by no more than `within` (>= 0, infinite for any
/// distance); witness points in the first one's frame. Exact between models, as the pair query is;
/// of rounded ones, to rounding.
///
/// # Errors
///
/// [`QueryError`] where the pose is invalid.
pub fn rounded_separation(
    pair: [&Rounded; 2],
    first_from_second: &Pose,
    within: f64,
    memory: &mut PairMemory,
) -> Result<Separation, QueryError> {
    let [r1, r2] = pair.map(|rounded| rounded.radius);
    let demand = Demand::Distance { below: None };
    let answer = query_pair(pair.map(|r| &r.model), first_from_second, demand, memory)?;
    if answer.touches() {
        return Ok(Separation::Meeting);
    }
    let (Some([a, b]), Some(between)) = (answer.witnesses, answer.distance) else {
        return Ok(Separation::Farther);
    };
    let (a, b, distance) = (a.point, b.point, between - r1 - r2);
    if distance <= 0.0 && r1 + r2 > 0.0 {
        return Ok(Separation::Meeting);
    }
    let way = (b - a).normalize_or_zero();
    let apart = Separation::Apart { distance, witnesses: [a + way * r1, b - way * r2] };
    Ok(if distance <= within { apart } else { Separation::Farther })
}

/// Contacts of two rounded models whose separation is at most `reach` (>= 0), in the first one's
/// frame: those of the models ([`Demand::Contacts`]), moved onto the rounded surfaces.
///
/// # Errors
///
/// [`QueryError`] where the pose is invalid.
pub fn rounded_contacts(
    pair: [&Rounded; 2],
    first_from_second: &Pose,
    reach: f64,
    memory: &mut PairMemory,
) -> Result<Vec<Contact>, QueryError> {
    let radii = pair.map(|rounded| rounded.radius);
    let demand = Demand::contacts(reach + radii[0] + radii[1]);
    let answer = query_pair(pair.map(|r| &r.model), first_from_second, demand, memory)?;
    Ok(answer.contacts.iter().map(|contact| rounded(contact, radii)).collect())
}

/// A contact of two models as one of the same models grown by a radius each.
#[must_use]
pub fn rounded(contact: &Contact, [first, second]: [f64; 2]) -> Contact {
    Contact {
        point_a: contact.point_a + first * contact.normal,
        point_b: contact.point_b - second * contact.normal,
        separation: contact.separation - first - second,
        ..*contact
    }
}

/// The answer about two models in the first one's frame.
pub(crate) fn query_pair(
    models: [&Model; 2],
    first_from_second: &Pose,
    demand: Demand,
    memory: &mut PairMemory,
) -> Result<Answer, QueryError> {
    let [a, b] = placed(models, first_from_second);
    query(a, b, &Query::of(demand), memory)
}

/// Two models in the first one's frame.
pub(crate) fn placed<'a>(models: [&'a Model; 2], first_from_second: &Pose) -> [Placed<'a>; 2] {
    let [first, second] = models;
    [
        Placed { model: first, pose: Pose::IDENTITY },
        Placed { model: second, pose: *first_from_second },
    ]
}
