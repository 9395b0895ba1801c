//! Contacts of a primitive with a model: which points of the two are nearest to each other, each
//! with the normal of its own place.
//!
//! `ball` knows balls and capsules, `solid` all other solids of revolution, with `spread` for what
//! lies flat, and `half_space` half-spaces.

mod ball;
mod half_space;
mod solid;
mod spread;

use cranny_geometry::Model;
use cranny_narrow_phase::Contact;

use crate::primitive::{Checked, Primitive, PrimitiveError};
use ball::{ball_contacts, capsule_contacts};
use half_space::half_space_contacts;
pub(crate) use half_space::lowest;
use solid::{deep_contact, revolved_contacts};

/// Contacts of a model (A) with a primitive (B) whose separation is at most `reach` (>= 0), all in
/// the model's frame, with normals from the model to the primitive. None where they are farther
/// apart.
///
/// There is a contact wherever the mesh is locally nearest to the primitive, and around each the
/// points that span what they share: at most a handful a direction. Features of the model name a
/// contact on its side, small numbers of the primitive's parts on the other. A primitive whose
/// middle is inside the material has the one contact that leads out through the nearest point.
///
/// # Errors
///
/// [`PrimitiveError`] where a number of the primitive is invalid.
pub fn contacts(
    model: &Model,
    primitive: &Primitive,
    reach: f64,
) -> Result<Vec<Contact>, PrimitiveError> {
    Ok(match (primitive.checked()?, primitive) {
        (Checked::HalfSpace(plane), _) => half_space_contacts(model, &plane, reach),
        (Checked::Round(_), Primitive::Ball(ball)) => {
            ball_contacts(model, ball.center, ball.radius, reach)
        }
        (Checked::Round(solid), Primitive::Capsule(capsule)) => {
            let mut found = capsule_contacts(model, capsule.ends, capsule.radius, reach);
            found.extend(deep_contact(model, &solid, &found));
            found
        }
        (Checked::Round(solid), _) => revolved_contacts(model, &solid, reach),
    })
}
