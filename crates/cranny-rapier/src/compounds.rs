//! Compounds, rapier's shapes of several parts: which pairs are taken apart, and rapier's questions
//! about them.
//!
//! parry goes through the parts and comes back here with each; what is no compound is answered in
//! `questions`. Contacts keep memory of each pair of parts, so `pair` goes through them itself.

use cranny_exact::Pose as ExactPose;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::{self, NonlinearRigidMotion, ShapeCastOptions};
use rapier3d::parry::query::{
    ClosestPoints, Contact, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection,
    Unsupported,
};
use rapier3d::parry::shape::{Compound, Shape};

use crate::convert::pose_from_rapier;
use crate::dispatcher::Dispatcher;
use crate::pair::ours;

/// A pair in which ours takes part.
enum Pair<'a> {
    First(&'a Compound),
    Second(&'a Compound),
    /// Neither is a compound, or ours takes no part.
    Whole,
}

impl<'a> Pair<'a> {
    fn of(g1: &'a dyn Shape, g2: &'a dyn Shape) -> Self {
        match (g1.as_compound(), g2.as_compound()) {
            (None, None) => Self::Whole,
            _ if !(involves_ours(g1) || involves_ours(g2)) => Self::Whole,
            (Some(c1), _) => Self::First(c1),
            (None, Some(c2)) => Self::Second(c2),
        }
    }
}

/// Whether a pair is taken apart: ours takes part in it, and one shape is a compound.
pub(crate) fn has_parts(g1: &dyn Shape, g2: &dyn Shape) -> bool {
    !matches!(Pair::of(g1, g2), Pair::Whole)
}

/// Whether a shape is ours, or a compound that holds one of ours.
pub(crate) fn involves_ours(shape: &dyn Shape) -> bool {
    match shape.as_compound() {
        Some(compound) => compound.shapes().iter().any(|(_, part)| involves_ours(&**part)),
        None => ours(shape).is_some(),
    }
}

/// The parts of a compound, each with its pose; any other shape is its own only part.
pub(crate) fn parts(shape: &dyn Shape) -> Vec<(ExactPose, &dyn Shape)> {
    match shape.as_compound() {
        Some(compound) => {
            let parts = compound.shapes().iter();
            parts.map(|(pose, part)| (pose_from_rapier(pose), &**part)).collect()
        }
        None => vec![(ExactPose::IDENTITY, shape)],
    }
}

impl QueryDispatcher for Dispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        match Pair::of(g1, g2) {
            Pair::First(c1) => {
                Ok(details::intersection_test_composite_shape_shape(self, pos12, c1, g2))
            }
            Pair::Second(c2) => {
                Ok(details::intersection_test_shape_composite_shape(self, pos12, g1, c2))
            }
            Pair::Whole => self.whole_intersection(pos12, g1, g2),
        }
    }

    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        match Pair::of(g1, g2) {
            Pair::First(c1) => Ok(details::distance_composite_shape_shape(self, pos12, c1, g2)),
            Pair::Second(c2) => Ok(details::distance_shape_composite_shape(self, pos12, g1, c2)),
            Pair::Whole => self.whole_distance(pos12, g1, g2),
        }
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        within: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        match Pair::of(g1, g2) {
            Pair::First(c1) => {
                Ok(details::contact_composite_shape_shape(self, pos12, c1, g2, within))
            }
            Pair::Second(c2) => {
                Ok(details::contact_shape_composite_shape(self, pos12, g1, c2, within))
            }
            Pair::Whole => self.whole_contact(pos12, g1, g2, within),
        }
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        within: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        match Pair::of(g1, g2) {
            Pair::First(c1) => {
                Ok(details::closest_points_composite_shape_shape(self, pos12, c1, g2, within))
            }
            Pair::Second(c2) => {
                Ok(details::closest_points_shape_composite_shape(self, pos12, g1, c2, within))
            }
            Pair::Whole => self.whole_closest_points(pos12, g1, g2, within),
        }
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        velocity: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        match Pair::of(g1, g2) {
            Pair::First(c1) => Ok(details::cast_shapes_composite_shape_shape(
                self, pos12, velocity, c1, g2, options,
            )),
            Pair::Second(c2) => Ok(details::cast_shapes_shape_composite_shape(
                self, pos12, velocity, g1, c2, options,
            )),
            Pair::Whole => self.whole_cast(pos12, velocity, g1, g2, options),
        }
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        begin: Real,
        end: Real,
        stop: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        match Pair::of(g1, g2) {
            Pair::First(c1) => Ok(details::cast_shapes_nonlinear_composite_shape_shape(
                self, motion1, c1, motion2, g2, begin, end, stop,
            )),
            Pair::Second(c2) => Ok(details::cast_shapes_nonlinear_shape_composite_shape(
                self, motion1, g1, motion2, c2, begin, end, stop,
            )),
            Pair::Whole => {
                self.whole_nonlinear_cast([motion1, motion2], [g1, g2], begin..end, stop)
            }
        }
    }
}
