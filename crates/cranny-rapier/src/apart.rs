//! How far apart two shapes are, of which one is ours.

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::PairMemory;
use cranny_primitives::{Primitive, Rounded, Separation, rounded_separation, separation};
use rapier3d::parry::shape::Shape;

use crate::ask::logged;
use crate::pair::ours;
use crate::partners::{measured, rounded_polyhedron};

/// How far two shapes are apart, if no farther than `within`, in the first one's frame; `None`
/// where neither is ours, where parry must answer, or where the pose is invalid.
pub(crate) fn apart(
    pose: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    within: f64,
) -> Option<Separation> {
    let of_partner = |model: &Model, partner: &Primitive, model_from_partner: &Pose| {
        let partner = partner.moved(&model_from_partner.world_from_body());
        separation(model, &partner, within).ok()
    };
    match (ours(g1), ours(g2)) {
        (None, None) => return None,
        (Some(shape), None) => {
            if let Some(partner) = measured(g2) {
                return of_partner(shape.model(), &partner, pose);
            }
        }
        (None, Some(shape)) => {
            if let Some(partner) = measured(g1) {
                let found = of_partner(shape.model(), &partner, &pose.inverse())?;
                return Some(swapped(found, pose));
            }
        }
        (Some(_), Some(_)) => {}
    }
    let [r1, r2] = [rounded(g1)?, rounded(g2)?];
    logged(rounded_separation([&r1, &r2], pose, within, &mut PairMemory::default()))
}

/// Of the second shape to the first one, in the second one's frame, as of the first to the second.
fn swapped(found: Separation, first_from_second: &Pose) -> Separation {
    match found {
        Separation::Apart { distance, witnesses: [on_second, on_first] } => {
            let map = first_from_second.world_from_body();
            Separation::Apart { distance, witnesses: [on_first, on_second].map(|p| map.apply(p)) }
        }
        other => other,
    }
}

fn rounded(shape: &dyn Shape) -> Option<Rounded> {
    match ours(shape) {
        Some(shape) => Some(Rounded { model: shape.model().clone(), radius: 0.0 }),
        None => rounded_polyhedron(shape),
    }
}
