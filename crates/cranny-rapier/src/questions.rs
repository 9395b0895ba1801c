//! rapier's questions about two shapes of which neither is a compound: intersection, distance,
//! contact, closest points and casts.
//!
//! Polyhedra and primitives beside ours are answered here, all others by parry with the mesh of the
//! same triangles, but that a shape wholly inside our solid is seen.

use std::ops::Range;

use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, PairMemory, Query};
use cranny_primitives::{Separation, contains_point};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{NonlinearRigidMotion, ShapeCastOptions};
use rapier3d::parry::query::{
    ClosestPoints, Contact, DefaultQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance,
    ShapeIntersection, Unsupported,
};
use rapier3d::parry::shape::Shape;

use crate::apart::apart;
use crate::ask::ask;
use crate::casts::{Cast, InitialOverlap, together};
use crate::convert::{narrow, pose_from_rapier, wide};
use crate::dispatcher::Dispatcher;
use crate::pair::{PairWorkspace, Reach, for_parry, ours};
use crate::partners::{measured, polyhedron, rounded_polyhedron};
use crate::round_casts::RoundCast;

/// The models of two shapes that are polyhedra, one of them ours.
fn models(g1: &dyn Shape, g2: &dyn Shape) -> Option<[Model; 2]> {
    if ours(g1).is_none() && ours(g2).is_none() {
        return None;
    }
    let model = |g: &dyn Shape| ours(g).map(|s| s.model().clone()).or_else(|| polyhedron(g));
    Some([model(g1)?, model(g2)?])
}

/// Whether [`apart`] knows a pair of shapes. It has no answer about them at an invalid pose.
fn is_known(g1: &dyn Shape, g2: &dyn Shape) -> bool {
    let known = |g: &dyn Shape| {
        ours(g).is_some() || measured(g).is_some() || rounded_polyhedron(g).is_some()
    };
    (ours(g1).is_some() || ours(g2).is_some()) && known(g1) && known(g2)
}

/// Whether a shape that is no polyhedron lies inside the other one, ours, given that the surfaces
/// do not meet.
fn encloses(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> bool {
    match (ours(g1), ours(g2)) {
        (Some(shape), None) => holds_partner(shape.model(), pos12, g2),
        (None, Some(shape)) => holds_partner(shape.model(), &pos12.inverse(), g1),
        _ => false,
    }
}

/// Whether two shapes are no farther apart than a gap, or one lies inside the other.
fn begins_together(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape, gap: Real) -> bool {
    match apart(&pose_from_rapier(pos12), g1, g2, gap.into()) {
        Some(Separation::Meeting) => true,
        Some(Separation::Apart { distance, .. }) => distance <= f64::from(gap),
        Some(Separation::Farther) => false,
        None => encloses(pos12, g1, g2),
    }
}

/// Whether one of two shapes lies inside the other, and their surfaces do not meet.
fn begins_inside(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> bool {
    let surfaces = || DefaultQueryDispatcher.intersection_test(pos12, for_parry(g1), for_parry(g2));
    begins_together(pos12, g1, g2, 0.0) && surfaces().is_ok_and(|found| !found.intersecting)
}

/// One point of a connected shape decides for all of it.
fn holds_partner(model: &Model, model_from_partner: &Pose, partner: &dyn Shape) -> bool {
    if partner.as_support_map().is_none() {
        return false; // a half-space or a surface: nothing encloses it
    }
    let middle = partner.compute_local_aabb().center();
    let point = partner.project_local_point(middle, true).point;
    let map = pose_from_rapier(model_from_partner).world_from_body();
    contains_point(model, map.apply(wide(point)))
}

impl Dispatcher {
    pub(crate) fn whole_intersection(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        let pose = pose_from_rapier(pos12);
        let models = models(g1, g2);
        if models.is_none()
            && let Some(found) = apart(&pose, g1, g2, 0.0)
        {
            return Ok(ShapeIntersection::new(found == Separation::Meeting));
        }
        let parry = DefaultQueryDispatcher.intersection_test(pos12, for_parry(g1), for_parry(g2));
        let Some([m1, m2]) = models else {
            let parry = parry?;
            let intersecting = parry.intersecting || encloses(pos12, g1, g2);
            return Ok(ShapeIntersection { intersecting, ..parry });
        };
        let answer =
            ask([&m1, &m2], pose, &Query::of(Demand::Intersects), &mut PairMemory::default())
                .ok_or(Unsupported)?;
        let intersecting = answer.touches();
        // parry knows which of a composite's parts it is; the verdict is ours.
        Ok(ShapeIntersection {
            intersecting,
            ..parry.unwrap_or_else(|_| ShapeIntersection::new(intersecting))
        })
    }

    pub(crate) fn whole_distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        let distance = match apart(&pose_from_rapier(pos12), g1, g2, f64::INFINITY) {
            Some(Separation::Meeting) => 0.0,
            Some(Separation::Apart { distance, .. }) => distance as Real,
            Some(Separation::Farther) => return Err(Unsupported),
            None if is_known(g1, g2) => return Err(Unsupported),
            None => {
                let parry = DefaultQueryDispatcher.distance(pos12, for_parry(g1), for_parry(g2))?;
                let distance = if encloses(pos12, g1, g2) { 0.0 } else { parry.distance };
                return Ok(ShapeDistance { distance, ..parry });
            }
        };
        Ok(ShapeDistance { distance, subshape1: 0, subshape2: 0 })
    }

    pub(crate) fn whole_contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        within: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        let (pose, reach) = (pose_from_rapier(pos12), f64::from(within));
        let Some(found) =
            PairWorkspace::for_question(g1, g2).found(&pose, g1, g2, Reach::all(reach))
        else {
            return DefaultQueryDispatcher.contact(pos12, for_parry(g1), for_parry(g2), within);
        };
        let inverse = pose.world_from_body().inverse();
        let deepest = found.contacts.iter().min_by(|x, y| x.separation.total_cmp(&y.separation));
        Ok(deepest.map(|c| Contact {
            point1: narrow(c.on_first),
            point2: narrow(inverse.apply(c.on_second)),
            normal1: narrow(c.normal),
            normal2: narrow(inverse.apply_vector(-c.normal)),
            dist: c.separation as Real,
            subshape1: 0,
            subshape2: 0,
        }))
    }

    pub(crate) fn whole_closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        within: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        let pose = pose_from_rapier(pos12);
        match apart(&pose, g1, g2, within.into()) {
            Some(Separation::Meeting) => Ok(ClosestPoints::Intersecting),
            Some(Separation::Farther) => Ok(ClosestPoints::Disjoint),
            Some(Separation::Apart { witnesses: [a, b], .. }) => {
                let b = pose.world_from_body().inverse().apply(b);
                Ok(ClosestPoints::WithinMargin(narrow(a), narrow(b)))
            }
            None if is_known(g1, g2) => Err(Unsupported),
            None if encloses(pos12, g1, g2) => Ok(ClosestPoints::Intersecting),
            None => {
                let (g1, g2) = (for_parry(g1), for_parry(g2));
                DefaultQueryDispatcher.closest_points(pos12, g1, g2, within)
            }
        }
    }

    pub(crate) fn whole_cast(
        &self,
        pos12: &Pose,
        velocity: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        if let Some([m1, m2]) = models(g1, g2).filter(|_| options.target_distance <= 0.0) {
            let seconds = options.max_time_of_impact;
            let cast = Cast::straight([&m1, &m2], pos12, velocity, seconds);
            if let Some(hit) = cast.meet(|| InitialOverlap {
                always: options.stop_at_penetration,
                contact: self.touching(pos12, g1, g2, &cast),
            }) {
                return Ok(hit);
            }
        }
        let gap = options.target_distance.max(0.0);
        let initially = || {
            let within = gap + Real::EPSILON * pos12.translation.length();
            let contact = self.contact(pos12, g1, g2, within).ok().flatten();
            together(contact, 0.0)
        };
        // What keeps a gap and slides along is a character, whose controller counts on parry's
        // steps.
        let keeps_off = gap > 0.0 && !options.stop_at_penetration;
        if !keeps_off
            && let Some(cast) = RoundCast::of(pos12, velocity, g1, g2)
            && let Some(hit) = cast.meet(&options, initially)
        {
            return Ok(hit);
        }
        // From outside a solid its surface is met first, which parry knows.
        let is_met = match options.stop_at_penetration {
            true => begins_together(pos12, g1, g2, gap),
            false => begins_inside(pos12, g1, g2),
        };
        if is_met {
            return Ok(Some(initially()));
        }
        let (g1, g2) = (for_parry(g1), for_parry(g2));
        DefaultQueryDispatcher.cast_shapes(pos12, velocity, g1, g2, options)
    }

    pub(crate) fn whole_nonlinear_cast(
        &self,
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        [g1, g2]: [&dyn Shape; 2],
        time: Range<Real>,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let Range { start, end } = time;
        if let Some([m1, m2]) = models(g1, g2) {
            let cast = Cast::turning([&m1, &m2], [motion1, motion2], start, end);
            if let Some(hit) = cast.meet(|| {
                let [pose1, pose2] = [motion1, motion2].map(|m| m.position_at_time(start));
                let pos12 = pose1.inv_mul(&pose2);
                let contact = self.touching(&pos12, g1, g2, &cast);
                InitialOverlap { always: stop_at_penetration, contact }
            }) {
                return Ok(hit);
            }
        }
        let [pose1, pose2] = [motion1, motion2].map(|m| m.position_at_time(start));
        let pos12 = pose1.inv_mul(&pose2);
        if stop_at_penetration && begins_together(&pos12, g1, g2, 0.0) {
            let contact = self.contact(&pos12, g1, g2, 0.0).ok().flatten();
            return Ok(Some(together(contact, start)));
        }
        let (g1, g2) = (for_parry(g1), for_parry(g2));
        DefaultQueryDispatcher.cast_shapes_nonlinear(
            motion1,
            g1,
            motion2,
            g2,
            start,
            end,
            stop_at_penetration,
        )
    }

    /// Where bodies meet that a cast finds together at its beginning.
    fn touching(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        cast: &Cast,
    ) -> Option<Contact> {
        self.contact(pos12, g1, g2, cast.tolerance() as Real).ok().flatten()
    }
}
