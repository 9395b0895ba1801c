//! How far a primitive is from a model.

use std::cell::Cell;

use cranny_exact::DVec3;
use cranny_geometry::{Model, VertexId};
use cranny_narrow_phase::Feature;

use crate::between::WHOLE_PRIMITIVE;
use crate::contacts::lowest;
use crate::inside::contains_point;
use crate::primitive::{Checked, Plane, Primitive, PrimitiveError};
use crate::revolved::{Revolved, nearest_face};

/// How far two shapes are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Separation {
    /// They touch or overlap, or one lies inside the other.
    Meeting,
    /// They are apart.
    Apart {
        /// Least distance, > 0 but for rounding.
        distance: f64,
        /// A point of each that realises it: of the first (the model), of the second.
        witnesses: [DVec3; 2],
    },
    /// They are farther apart than the limit of the query.
    Farther,
}

/// How far a model and a primitive are apart, if by no more than `within` (>= 0, infinite for any
/// distance); witness points in the model's frame.
///
/// The verdict, the distance and the points are right to a few dozen units of rounding of the
/// largest length of the pair. A primitive wholly inside a closed component meets it.
///
/// # Errors
///
/// [`PrimitiveError`] where a number of the primitive is invalid.
pub fn separation(
    model: &Model,
    primitive: &Primitive,
    within: f64,
) -> Result<Separation, PrimitiveError> {
    found(model, primitive, within).map(Into::into)
}

impl From<Found> for Separation {
    fn from(found: Found) -> Self {
        match found {
            Found::Meeting | Found::Inside => Self::Meeting,
            Found::Farther => Self::Farther,
            Found::Apart { distance, points, .. } => Self::Apart { distance, witnesses: points },
        }
    }
}

/// The same, with what else is known.
pub(crate) enum Found {
    Meeting,
    /// The second lies wholly in the first.
    Inside,
    Apart {
        /// Least distance, > 0 but for rounding.
        distance: f64,
        /// Points of each that realise it.
        points: [DVec3; 2],
        /// What holds them.
        features: [Feature; 2],
    },
    Farther,
}

pub(crate) fn found(
    model: &Model,
    primitive: &Primitive,
    within: f64,
) -> Result<Found, PrimitiveError> {
    Ok(match primitive.checked()? {
        Checked::Round(solid) => of_round(model, &solid, within),
        Checked::HalfSpace(plane) => of_half_space(model, &plane, within),
    })
}

/// Whether a model and a primitive touch or overlap, or one lies inside the other.
///
/// # Errors
///
/// [`PrimitiveError`] where a number of the primitive is invalid.
pub fn meets(model: &Model, primitive: &Primitive) -> Result<bool, PrimitiveError> {
    Ok(separation(model, primitive, 0.0)? == Separation::Meeting)
}

fn of_round(model: &Model, solid: &Revolved, within: f64) -> Found {
    let found = nearest_face(model, solid, within);
    if found.is_some_and(|nearest| nearest.distance <= 0.0) {
        return Found::Meeting;
    }
    if contains_point(model, solid.middle()) {
        return Found::Inside;
    }
    found.map_or(Found::Farther, |nearest| Found::Apart {
        distance: nearest.distance,
        points: [nearest.on_model, nearest.on_solid],
        features: [nearest.feature, WHOLE_PRIMITIVE],
    })
}

fn of_half_space(model: &Model, plane: &Plane, within: f64) -> Found {
    let Plane { normal, offset } = *plane;
    let best = Cell::new(within + offset);
    let mut nearest: Option<VertexId> = None;
    model.tree().visit(
        |b| lowest(b, normal) <= best.get(),
        |face| {
            for vertex in model.mesh().corners(face) {
                let height = normal.dot(model.mesh().position(vertex));
                if height < best.get() || (nearest.is_none() && height <= best.get()) {
                    best.set(height);
                    nearest = Some(vertex);
                }
            }
        },
    );
    let Some(vertex) = nearest else { return Found::Farther };
    let distance = best.get() - offset;
    if distance <= 0.0 {
        return Found::Meeting;
    }
    let on_model = model.mesh().position(vertex);
    Found::Apart {
        distance,
        points: [on_model, on_model - normal * distance],
        features: [Feature::Vertex(vertex), WHOLE_PRIMITIVE],
    }
}
