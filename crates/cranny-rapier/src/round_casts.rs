//! Straight casts of balls, capsules, cylinders and the like.

use cranny_exact::{DVec3, Pose as ExactPose};
use cranny_primitives::{Primitive, PrimitiveCast, PrimitiveCastOptions, cast_primitive};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{ShapeCastHit, ShapeCastStatus};
use rapier3d::parry::shape::Shape;

use crate::casts::{earlier, nowhere};
use crate::convert::{narrow, pose_from_rapier, wide};
use crate::pair::ours;
use crate::partners::primitive;
use crate::shape::MeshShape;

/// A primitive that moves beside a mesh of ours.
pub(crate) struct RoundCast<'a> {
    shape: &'a MeshShape,
    /// In the mesh's frame.
    primitive: Primitive,
    /// Of the second shape in the first one's frame, and how it moves there.
    pose: ExactPose,
    velocity: DVec3,
    mesh_is_first: bool,
}

/// What a cast comes to; `None` where it is left to parry.
pub(crate) type CastFound = Option<Option<ShapeCastHit>>;

impl<'a> RoundCast<'a> {
    /// Of two shapes, one of them ours and the other a primitive.
    pub(crate) fn of(
        pos12: &Pose,
        velocity: Vector,
        g1: &'a dyn Shape,
        g2: &'a dyn Shape,
    ) -> Option<Self> {
        let (pose, velocity) = (pose_from_rapier(pos12), wide(velocity));
        let (shape, partner, mesh_is_first) = match (ours(g1), ours(g2)) {
            (Some(shape), None) => (shape, primitive(g2)?, true),
            (None, Some(shape)) => (shape, primitive(g1)?, false),
            _ => return None,
        };
        let place = if mesh_is_first { pose } else { pose.inverse() };
        let primitive = partner.moved(&place.world_from_body());
        Some(Self { shape, primitive, pose, velocity, mesh_is_first })
    }

    /// When the two meet, if they do; `initially` is what is known of those that meet at the
    /// beginning.
    pub(crate) fn meet(
        &self,
        options: &ShapeCastOptions,
        initially: impl FnOnce() -> ShapeCastHit,
    ) -> CastFound {
        let seconds = self.seconds(options.max_time_of_impact.into());
        let in_first = seconds * self.velocity;
        let travel = match self.mesh_is_first {
            true => in_first,
            false => -self.pose.inverse().world_from_body().apply_vector(in_first),
        };
        let wanted = PrimitiveCastOptions {
            gap: options.target_distance.max(0.0).into(),
            stops_at_overlap: options.stop_at_penetration,
        };
        let found = cast_primitive(self.shape.model(), &self.primitive, travel, &wanted);
        Some(match found {
            Ok(PrimitiveCast::Free) => None,
            Ok(PrimitiveCast::Initially) => Some(initially()),
            Ok(PrimitiveCast::Hit { time, on_model, on_primitive, normal }) => {
                Some(self.hit(time, seconds, [on_model, on_primitive], normal))
            }
            Err(error) => {
                tracing::debug!("a cast is left to parry: {error}");
                return None;
            }
        })
    }

    /// How long to look: beyond, the two have passed each other; callers state no end.
    fn seconds(&self, most: f64) -> f64 {
        let bounds = self.shape.model().bounds();
        let size = bounds.min.abs().max(bounds.max.abs()).length();
        let apart = self.primitive.radius_about(DVec3::ZERO);
        // The plane of a half-space is met at any distance.
        let past = match self.velocity.length() {
            0.0 => 0.0,
            speed => 2.0 * (size + apart) / speed,
        };
        most.min(past).min(f64::from(Real::MAX))
    }

    fn hit(
        &self,
        time: f64,
        seconds: f64,
        [on_model, on_primitive]: [DVec3; 2],
        normal: DVec3,
    ) -> ShapeCastHit {
        // The second shape in the first one's frame, then.
        let moved = self.pose.translation + time * seconds * self.velocity;
        let first_from_second = ExactPose { translation: moved, ..self.pose }.world_from_body();
        let second_from_first = first_from_second.inverse();
        let ([p, q], n) = match self.mesh_is_first {
            true => ([on_model, on_primitive], normal),
            false => {
                // In the mesh's frame, which stays; the first shape is where it is by then.
                let of_second = [on_primitive, on_model].map(|p| first_from_second.apply(p));
                (of_second, -first_from_second.apply_vector(normal))
            }
        };
        ShapeCastHit {
            time_of_impact: earlier(time * seconds),
            witness1: narrow(p),
            witness2: narrow(second_from_first.apply(q)),
            normal1: narrow(n),
            normal2: narrow(second_from_first.apply_vector(-n)),
            status: ShapeCastStatus::Converged,
            ..nowhere()
        }
    }
}
