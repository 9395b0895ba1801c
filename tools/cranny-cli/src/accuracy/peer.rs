//! parry's triangle meshes and convex decompositions, as rapier users have them.

use cranny_exact::Interval;
use cranny_geometry::Model;
use cranny_rapier::Detector;
use parry3d::math::{Pose as NarrowPose, Vector};
use parry3d::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher,
    closest_points,
};
use parry3d::shape::{Shape, SharedShape};

use super::method::{ContactAnswer, Method, Name, PoseAnswer};
use super::motion::{Motion, Posed};
use crate::parry::{double, single};

/// How far manifolds foresee, as a share of the smaller body's size: next to nothing, as
/// our regions do. Smaller: single precision loses surfaces that touch; larger: gaps count as
/// contacts.
const PREDICTION: f64 = 1e-4;

/// A kind of shape of parry's.
pub(super) struct Peer {
    kind: Detector,
    /// By pair.
    shapes: Vec<[SharedShape; 2]>,
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

    /// Prepares the shapes of all bodies.
    ///
    /// # Errors
    ///
    /// What the peer says, where it refuses a mesh.
    pub(super) fn new<'m>(kind: Detector, motion: &'m Motion) -> Result<Self, String> {
        let mut known: Vec<(&Model, SharedShape)> = Vec::new();
        let mut shape = |model: &'m Model| -> Result<SharedShape, String> {
            if let Some((_, shape)) = known.iter().find(|(other, _)| model.is_same(other)) {
                return Ok(shape.clone());
            }
            let shape = kind.shape(model, 0).map_err(|error| error.to_string())?;
            known.push((model, shape.clone()));
            Ok(shape)
        };
        let pairs = motion.pairs().iter();
        let shapes = pairs.map(|[a, b]| Ok([shape(a)?, shape(b)?])).collect::<Result<_, String>>();
        Ok(Self { kind, shapes: shapes? })
    }

    fn shapes(&self, posed: Posed) -> [&dyn Shape; 2] {
        self.shapes[posed.pair].each_ref().map(|shape| &**shape)
    }
}

impl Method for Peer {
    fn name(&self) -> Name {
        Self::name_of(self.kind)
    }

    fn distance(&mut self, posed: Posed) -> PoseAnswer {
        let Posed { models, poses, .. } = posed;
        let reach = 2.0 * (models[0].radius() + models[1].radius())
            + poses[0].translation.distance(poses[1].translation);
        let [p, q] = poses.map(single);
        let [a, b] = self.shapes(posed);
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

    fn contacts(&mut self, posed: Posed) -> ContactAnswer {
        let [p, q] = posed.poses.map(single);
        let [a, b] = self.shapes(posed);
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let relative = p.inv_mul(&q);
        let prediction = PREDICTION * posed.size();
        let found = DefaultQueryDispatcher.contact_manifolds(
            &relative,
            a,
            b,
            prediction as f32,
            &mut manifolds,
            &mut None,
        );
        if found.is_err() {
            return ContactAnswer::default();
        }
        let at = |pose: &NarrowPose, part: Option<&NarrowPose>, point: Vector| {
            double(*pose * part.map_or(point, |part| *part * point))
        };
        let (mut points, mut depth) = (Vec::new(), 0.0f64);
        for manifold in &manifolds {
            for contact in &manifold.points {
                let v = at(&p, manifold.subshape_pos1(), contact.local_p1);
                let w = at(&q, manifold.subshape_pos2(), contact.local_p2);
                points.push(0.5 * (v + w));
                depth = depth.max(f64::from(-contact.dist));
            }
        }
        let meets = Some(!points.is_empty());
        ContactAnswer { meets, points, depth: Some(Interval::point(depth)) }
    }
}
