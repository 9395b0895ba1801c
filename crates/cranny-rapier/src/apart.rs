//! How far apart two shapes are, of which one is ours.

use cranny_exact::{DVec3, Pose as ExactPose};
use cranny_geometry::Model;
use cranny_narrow_phase::revolved::nearest_face;
use cranny_narrow_phase::{Demand, PairMemory, Query};
use rapier3d::parry::shape::Shape;

use crate::ask::ask;
use crate::pair::{inverse, ours};
use crate::partners::{holds, revolved, rounded_polyhedron};

/// What there is between two shapes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Apart {
    /// They touch or overlap, or one lies inside the other.
    Meeting,
    /// So far, between these points of the first and the second, in the first one's frame.
    By(f64, [DVec3; 2]),
    /// Farther than was asked about.
    Farther,
}

/// How far two shapes are apart, if no farther than `within`; `None` where neither is ours, where parry must answer,
/// or where the pose is none.
pub(crate) fn apart(
    pose: &ExactPose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    within: f64,
) -> Option<Apart> {
    match (ours(g1), ours(g2)) {
        (None, None) => None,
        (Some(shape), None) => {
            of_round(shape.model(), pose, g2, within).or_else(|| of_polyhedra(pose, g1, g2, within))
        }
        (None, Some(shape)) => match of_round(shape.model(), &inverse(pose), g1, within) {
            Some(Apart::By(distance, [on_second, on_first])) => {
                let map = pose.world_from_body();
                Some(Apart::By(distance, [map.apply(on_first), map.apply(on_second)]))
            }
            Some(told) => Some(told),
            None => of_polyhedra(pose, g1, g2, within),
        },
        (Some(_), Some(_)) => of_polyhedra(pose, g1, g2, within),
    }
}

/// A model and what is round, at a pose in the model's frame.
fn of_round(
    model: &Model,
    model_from_partner: &ExactPose,
    partner: &dyn Shape,
    within: f64,
) -> Option<Apart> {
    let solid = revolved(partner, &model_from_partner.world_from_body())?;
    let found = nearest_face(model, &solid, within);
    if found.is_some_and(|nearest| nearest.distance <= 0.0) || holds(model, solid.middle()) {
        return Some(Apart::Meeting);
    }
    Some(found.map_or(Apart::Farther, |nearest| {
        Apart::By(nearest.distance, [nearest.on_model, nearest.on_solid])
    }))
}

/// Two polyhedra, each perhaps with a border radius.
fn of_polyhedra(pose: &ExactPose, g1: &dyn Shape, g2: &dyn Shape, within: f64) -> Option<Apart> {
    let core = |g: &dyn Shape| match ours(g) {
        Some(shape) => Some((shape.model().clone(), 0.0)),
        None => rounded_polyhedron(g),
    };
    let [(m1, r1), (m2, r2)] = [core(g1)?, core(g2)?];
    let demand = Demand::Distance { below: None };
    let answer = ask([&m1, &m2], *pose, &Query::of(demand), &mut PairMemory::default())?;
    if answer.solid || answer.surface.meets() {
        return Some(Apart::Meeting);
    }
    let ([a, b], between) = (answer.witnesses?.map(|w| w.point), answer.distance?);
    let distance = between - r1 - r2;
    if distance <= 0.0 && r1 + r2 > 0.0 {
        return Some(Apart::Meeting);
    }
    let way = (b - a).normalize_or_zero();
    let told = Apart::By(distance, [a + way * r1, b - way * r2]);
    Some(if distance <= within { told } else { Apart::Farther })
}
