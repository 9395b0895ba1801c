//! parry's triangle meshes and convex decompositions, as rapier users have them.

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_rapier::Detector;
use parry3d::math::{Pose as NarrowPose, Vector};
use parry3d::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher,
    closest_points,
};
use parry3d::shape::SharedShape;

use super::method::{Method, Name, PoseAnswer};
use super::smaller_size;
use crate::parry::{double, single};
use crate::pose_file::PosePair;

/// How far manifolds foresee, as a share of the smaller body's size: next to nothing, as
/// our regions do. Smaller: single precision loses surfaces that touch; larger: gaps count as
/// contacts.
const PREDICTION: f64 = 1e-4;

/// A kind of shape of parry's.
pub(super) struct Peer {
    kind: Detector,
    shapes: [SharedShape; 2],
}

impl Peer {
    /// Those that are queried.
    pub(super) const KINDS: [Detector; 2] =
        [Detector::RapierTrimesh, Detector::RapierDecomposition];

    /// What one of a kind is called.
    pub(super) fn name_of(kind: Detector) -> Name {
        Name::of_peer(match kind {
            Detector::RapierDecomposition => "parry-decomposition",
            _ => "parry-trimesh",
        })
    }

    /// Prepares both shapes.
    ///
    /// # Errors
    ///
    /// What the peer says, where it refuses a mesh.
    pub(super) fn new(kind: Detector, [a, b]: [&Model; 2]) -> Result<Self, String> {
        let shape = |model: &Model| kind.shape(model, 0).map_err(|error| error.to_string());
        let first = shape(a)?;
        let second = if a.is_same(b) { first.clone() } else { shape(b)? };
        Ok(Self { kind, shapes: [first, second] })
    }
}

impl Method for Peer {
    fn name(&self) -> Name {
        Self::name_of(self.kind)
    }

    fn ask(&mut self, models: [&Model; 2], poses: PosePair) -> PoseAnswer {
        let reach = 2.0 * (models[0].radius() + models[1].radius())
            + poses[0].translation.distance(poses[1].translation);
        let [p, q] = poses.map(single);
        let [a, b] = self.shapes.each_ref().map(|shape| &**shape);
        // One call returns verdict, distance and points.
        match closest_points(&p, a, &q, b, reach as f32) {
            Ok(ClosestPoints::Intersecting) => {
                PoseAnswer { meets: Some(true), distance: Some(0.0), ..PoseAnswer::default() }
            }
            Ok(ClosestPoints::WithinMargin(v, w)) => {
                let witnesses = [double(v), double(w)];
                let distance = witnesses[0].distance(witnesses[1]);
                PoseAnswer {
                    meets: Some(distance == 0.0),
                    distance: Some(distance),
                    witnesses: Some(witnesses),
                    ..PoseAnswer::default()
                }
            }
            Ok(ClosestPoints::Disjoint) => {
                PoseAnswer { meets: Some(false), ..PoseAnswer::default() }
            }
            Err(_) => PoseAnswer::default(),
        }
    }

    fn contacts(&mut self, models: [&Model; 2], poses: PosePair) -> Vec<DVec3> {
        let [p, q] = poses.map(single);
        let [a, b] = self.shapes.each_ref().map(|shape| &**shape);
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let relative = p.inv_mul(&q);
        let prediction = PREDICTION * smaller_size(models);
        let found = DefaultQueryDispatcher.contact_manifolds(
            &relative,
            a,
            b,
            prediction as f32,
            &mut manifolds,
            &mut None,
        );
        if found.is_err() {
            return Vec::new();
        }
        let at = |pose: &NarrowPose, part: Option<&NarrowPose>, point: Vector| {
            double(*pose * part.map_or(point, |part| *part * point))
        };
        let middles = manifolds.iter().flat_map(|manifold| {
            manifold.points.iter().map(|contact| {
                let v = at(&p, manifold.subshape_pos1(), contact.local_p1);
                let w = at(&q, manifold.subshape_pos2(), contact.local_p2);
                0.5 * (v + w)
            })
        });
        middles.collect()
    }
}
