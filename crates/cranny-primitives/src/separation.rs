//! How far a primitive is from a model.

use std::cell::Cell;

use cranny_exact::DVec3;
use cranny_geometry::Model;

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

fn of_round(model: &Model, solid: &Revolved, within: f64) -> Separation {
    let found = nearest_face(model, solid, within);
    if found.is_some_and(|nearest| nearest.distance <= 0.0) || contains_point(model, solid.middle())
    {
        return Separation::Meeting;
    }
    found.map_or(Separation::Farther, |nearest| Separation::Apart {
        distance: nearest.distance,
        witnesses: [nearest.on_model, nearest.on_solid],
    })
}

fn of_half_space(model: &Model, plane: &Plane, within: f64) -> Separation {
    let Plane { normal, offset } = *plane;
    let best = Cell::new(within + offset);
    let mut nearest: Option<DVec3> = None;
    model.tree().visit(
        |b| lowest(b, normal) <= best.get(),
        |face| {
            for p in model.mesh().triangle(face) {
                let height = normal.dot(p);
                if height < best.get() || (nearest.is_none() && height <= best.get()) {
                    best.set(height);
                    nearest = Some(p);
                }
            }
        },
    );
    let Some(on_model) = nearest else { return Separation::Farther };
    let distance = best.get() - offset;
    if distance <= 0.0 {
        return Separation::Meeting;
    }
    Separation::Apart { distance, witnesses: [on_model, on_model - normal * distance] }
}
